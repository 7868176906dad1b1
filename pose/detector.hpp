#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "engine/core/byte_stream.hpp"
#include "engine/core/image.hpp"
#include "pose/image_rotation.hpp"
#include "pose/joints.hpp"

namespace posefusion {

enum class PoseRuntime { OnnxRuntime, OpenCvDnn };
enum class PoseNetwork { MoveNet, OpenPose };

/// Pixel values that an OpenPose network expects, in the order B, G, R.
enum class OpenPosePixels {
    Auto,     ///< Centred for .caffemodel (CMU's own), Bytes for .onnx
    Bytes,    ///< 0..255
    Centred,  ///< -0.5..0.5: value / 255 - 0.5
};

/// The configuration of the detector.
struct PoseConfig {
    PoseNetwork network = PoseNetwork::MoveNet;
    PoseRuntime runtime = PoseRuntime::OnnxRuntime;
    std::filesystem::path model;     ///< .onnx, or .caffemodel (OpenCV only); empty = the network installed at set-up
    std::filesystem::path prototxt;  ///< Caffe only
    OpenPosePixels openpose_pixels = OpenPosePixels::Auto;
    int input_long_side = 0;         ///< long side of the network's input, pixels; rounded to the network's
                                     ///< stride; 0 = the network's usual size: 256 for MoveNet, 320 for OpenPose
    float person_threshold = 0.28f;  ///< people with a lower score (certainty of person and joints) are dropped, [0, 1]
    float joint_threshold = 0.2f;    ///< joints less certain than this get p = 0, [0, 1]
    std::optional<ImageRotation> rotate;  ///< of images before the network, which finds upright people; nullopt =
                                          ///< the rotation in which people are seen best
    int threads = 2;                      ///< CPU threads of the network
};

/// Step 1 of the paper: colour image -> [people x 18] entries (u, v, p), eq. (1). Same images, same results.
class JointDetector {
public:
    virtual ~JointDetector() = default;
    [[nodiscard]] virtual People detect(const ColorImage& color) = 0;
    [[nodiscard]] virtual std::string description() const = 0;  ///< network, runtime and input size, for reports

    /// What is remembered of earlier images; after restore(), a detector of the same configuration continues with the
    /// same results. Nothing by default.
    [[nodiscard]] virtual ByteArray state() const { return {}; }
    /// Throws Error if the bytes are no such state.
    virtual void restore(std::span<const std::byte> state) {
        StateReader(state, "the state of the pose network").end();
    }
};

/// The default model is looked for in the folder that the environment variable POSEFUSION_MODEL_DIR names, else where
/// it was installed along with this program or library, else where tools/setup put it. The model is run on a black
/// image first, so that one of another kind fails at once. Throws Error if the model cannot be found, read or
/// understood.
[[nodiscard]] std::unique_ptr<JointDetector> make_joint_detector(const PoseConfig& config);

}  // namespace posefusion
