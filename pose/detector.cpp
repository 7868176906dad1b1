#include "pose/detector.hpp"

#include <cstdlib>
#include <functional>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/installed_file.hpp"
#include "pose/movenet.hpp"
#include "pose/network_input.hpp"
#include "pose/openpose.hpp"
#include "pose/rotating_detector.hpp"
#include "pose/runtime.hpp"

namespace posefusion {
namespace {

constexpr const char* kModelFolderVariable = "POSEFUSION_MODEL_DIR";
constexpr const char* kDefaultModelName = "movenet-multipose.onnx";
constexpr const char* kCaffeExtension = ".caffemodel";

/// What differs between the kinds of networks.
struct NetworkKind {
    std::string name;
    std::vector<std::string> outputs;  ///< empty = all
    int stride = 1;                    ///< sides of the input are multiples of this, pixels
    int long_side = 0;                 ///< of the input, pixels
    PixelFormat pixels;
    /// (outputs, width and height of the image) -> people
    std::function<People(std::vector<Tensor>, int, int)> decode;
};

NetworkKind movenet(const PoseConfig& config) {
    constexpr int kLongSide = 256;
    MoveNetDecoding decoding;
    decoding.person_threshold = config.person_threshold;
    decoding.joint_threshold = config.joint_threshold;
    return {.name = "MoveNet MultiPose",
            .outputs = movenet_outputs(),
            .stride = kMoveNetInputStride,
            .long_side = config.input_long_side > 0 ? config.input_long_side : kLongSide,
            .pixels = {.bgr = false, .scale = 1 / 127.5f, .offset = -1},
            .decode = [decoding](std::vector<Tensor> outputs, int width, int height) {
                return decode_movenet(movenet_maps(std::move(outputs)), width, height, decoding);
            }};
}

NetworkKind openpose(const PoseConfig& config) {
    constexpr int kLongSide = 320;
    const bool caffe = config.model.extension() == kCaffeExtension;
    const bool centred =
        config.openpose_pixels == OpenPosePixels::Centred || (config.openpose_pixels == OpenPosePixels::Auto && caffe);
    OpenPoseDecoding decoding;
    decoding.person_threshold = config.person_threshold;
    decoding.joint_threshold = config.joint_threshold;
    return {.name = "OpenPose",
            .outputs = {},
            .stride = kOpenPoseInputStride,
            .long_side = config.input_long_side > 0 ? config.input_long_side : kLongSide,
            .pixels = {.bgr = true, .scale = centred ? 1 / 255.0f : 1.0f, .offset = centred ? -0.5f : 0.0f},
            .decode = [decoding](std::vector<Tensor> outputs, int width, int height) {
                return decode_openpose(openpose_maps(std::move(outputs)), width, height, decoding);
            }};
}

class NetworkJointDetector final : public JointDetector {
public:
    NetworkJointDetector(NetworkKind kind, std::unique_ptr<NetworkRuntime> network)
        : kind_(std::move(kind)), network_(std::move(network)) {
        // A model of another kind fails here rather than at the first frame. The image is square, so that the network's
        // usual size is used.
        constexpr int kTrialSide = 512;
        detect(ColorImage(kTrialSide, kTrialSide));
    }

    People detect(const ColorImage& color) override {
        if (color.empty()) return {};
        const InputSize size =
            fit_network_input(color.width(), color.height(), network_->fixed_input(), kind_.long_side, kind_.stride);
        return kind_.decode(network_->run(make_network_input(color, size, kind_.pixels)), color.width(),
                            color.height());
    }

    std::string description() const override {
        const InputSize fixed = network_->fixed_input();
        const std::string size = fixed.width > 0 ? std::to_string(fixed.width) + " x " + std::to_string(fixed.height)
                                                 : "long side " + std::to_string(kind_.long_side);
        return kind_.name + ", " + size + " px, " + network_->description();
    }

private:
    NetworkKind kind_;
    std::unique_ptr<NetworkRuntime> network_;
};

std::filesystem::path default_model() {
    if (const char* const folder = std::getenv(kModelFolderVariable))
        return std::filesystem::path(folder) / kDefaultModelName;
    if (const auto installed = installed_file(&kDefaultModelName, std::filesystem::path("models") / kDefaultModelName))
        return *installed;
    return std::filesystem::path(POSEFUSION_DEFAULT_MODEL_DIR) / kDefaultModelName;
}

std::filesystem::path model_of(const PoseConfig& config) {
    if (!config.model.empty()) return config.model;
    if (config.network == PoseNetwork::MoveNet) return default_model();
    throw Error("no OpenPose network is named: give its .onnx or .caffemodel file as pose.model");
}

void require_file(const std::filesystem::path& path, const std::string& advice) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
        throw Error("no pose network at '" + path.string() + "': " + advice);
}

std::unique_ptr<NetworkRuntime> load(PoseRuntime runtime, const NetworkFile& file) {
    const bool caffe = file.model.extension() == kCaffeExtension;
    if (caffe && runtime != PoseRuntime::OpenCvDnn) {
        throw Error(file.model.string() + " is a Caffe model: choose OpenCV as pose.runtime");
    }
    if (caffe) require_file(file.prototxt, "a Caffe model needs its .prototxt, give it as pose.prototxt");
    return runtime == PoseRuntime::OpenCvDnn ? load_with_opencv(file) : load_with_onnx_runtime(file);
}

}  // namespace

std::unique_ptr<JointDetector> make_joint_detector(const PoseConfig& config) {
    const std::filesystem::path model = model_of(config);
    require_file(model, "run ./tools/setup, or name another as pose.model");
    NetworkKind kind = config.network == PoseNetwork::MoveNet ? movenet(config) : openpose(config);
    auto network = load(config.runtime, {model, config.prototxt, kind.outputs, config.threads});
    return make_rotating_detector(std::make_unique<NetworkJointDetector>(std::move(kind), std::move(network)),
                                  config.rotate);
}

}  // namespace posefusion
