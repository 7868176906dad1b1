#include "segmentation/segmenter.hpp"

#include <bitset>
#include <cstdint>
#include <limits>
#include <utility>

#include "engine/core/error.hpp"
#include "segmentation/image_segmenter.hpp"
#include "segmentation/paper_segmenter.hpp"

namespace posefusion {
namespace {

/// Rejects images of another size than the camera's, for both modes.
class CheckedSegmenter final : public Segmenter {
public:
    CheckedSegmenter(std::unique_ptr<Segmenter> inner, const Intrinsics& camera)
        : inner_(std::move(inner)), camera_(camera) {}

    Segmentation segment(const ColorImage& color, const DepthImage& depth, const std::optional<People>& people,
                         const Eigen::Isometry3f& T_previous_current) override {
        check("colour", color.width(), color.height());
        check("depth", depth.width(), depth.height());
        return inner_->segment(color, depth, people, T_previous_current);
    }

    ByteArray state() const override { return inner_->state(); }
    void restore(std::span<const std::byte> state) override { inner_->restore(state); }

private:
    void check(const std::string& name, int width, int height) const {
        if (width == camera_.width && height == camera_.height) return;
        throw Error("segmentation: the " + name + " image has " + std::to_string(width) + "x" + std::to_string(height) +
                    " pixels, the camera " + std::to_string(camera_.width) + "x" + std::to_string(camera_.height) +
                    ": give the intrinsics of these images");
    }

    std::unique_ptr<Segmenter> inner_;
    Intrinsics camera_;
};

}  // namespace

Segmentation segmentation_of(LabelImage labels) {
    std::bitset<std::numeric_limits<std::uint8_t>::max() + 1> present;
    for (const std::uint8_t label : labels) present.set(label);
    present.reset(0);
    Segmentation segmentation;
    segmentation.people = static_cast<int>(present.count());
    segmentation.labels = std::move(labels);
    return segmentation;
}

DepthImage remove_people(const DepthImage& depth, const LabelImage& labels) {
    DepthImage result = depth;
    for (std::size_t i = 0; i < labels.size(); ++i)
        if (labels[i] != 0) result[i] = 0;
    return result;
}

std::unique_ptr<Segmenter> make_segmenter(const SegmentationConfig& config, const Intrinsics& camera,
                                          const DepthNoise& noise) {
    if (!camera.valid()) throw Error("segmentation: focal lengths and image size of the camera must be positive");
    if (!(config.sigma > 0) || !(config.radius > 0)) throw Error("segmentation: sigma and radius must be positive");
    if (!(config.reach >= 0)) throw Error("segmentation: reach must not be negative");
    if (config.carry_frames < 0) throw Error("segmentation: carry_frames must not be negative");
    const bool paper = config.mode == SegmentationMode::Paper;
    return std::make_unique<CheckedSegmenter>(
        paper ? make_paper_segmenter(config, camera) : make_image_segmenter(config, camera, noise), camera);
}

}  // namespace posefusion
