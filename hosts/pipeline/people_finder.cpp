#include "hosts/pipeline/people_finder.hpp"

#include <cstddef>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/masks.hpp"
#include "pose/detector.hpp"
#include "pose/mask_rcnn.hpp"

namespace posefusion {
namespace {

/// The method of the paper.
class NetworkPeople final : public PeopleFinder {
public:
    NetworkPeople(const RunConfig& config, const Intrinsics& camera)
        : detector_(make_joint_detector(config.pose)),
          segmenter_(make_segmenter(config.segmentation, camera, config.slam.noise)),
          every_(static_cast<std::size_t>(config.pose_every)) {}

    std::optional<People> find_joints(const Frame& frame) override {
        if (calls_++ % every_ != 0) return std::nullopt;
        return detector_->detect(frame.color);  // eq. (1)
    }

    Segmentation segment(const Frame& frame, const std::optional<People>& joints,
                         const Eigen::Isometry3f& T_previous_current) override {
        return segmenter_->segment(frame.color, frame.depth, joints, T_previous_current);  // eq. (2) and (3)
    }

    std::string description() const override {
        return detector_->description() + (every_ == 1 ? "" : ", every " + std::to_string(every_) + " frames");
    }

    ByteArray state() const override {
        StateWriter out;
        out.put(std::uint64_t{calls_});
        const ByteArray detection = detector_->state(), segmentation = segmenter_->state();
        out.list(detection, [&](std::byte byte) { out.raw(&byte, 1); });
        out.raw(segmentation.data(), segmentation.size());
        return out.take();
    }

    void restore(std::span<const std::byte> state) override {
        StateReader in(state, "the state of the people");
        const auto calls = in.get<std::uint64_t>(), detection_bytes = in.get<std::uint64_t>();
        in.expect(static_cast<std::size_t>(detection_bytes));
        const auto rest = state.subspan(sizeof(calls) + sizeof(detection_bytes));
        segmenter_->restore(rest.subspan(static_cast<std::size_t>(detection_bytes)));
        detector_->restore(rest.first(static_cast<std::size_t>(detection_bytes)));
        calls_ = calls;
    }

private:
    std::unique_ptr<JointDetector> detector_;
    std::unique_ptr<Segmenter> segmenter_;
    std::size_t every_, calls_ = 0;
};

/// Label images from elsewhere. A frame without one is assumed to show no people.
class MaskedPeople final : public PeopleFinder {
public:
    MaskedPeople(const RunConfig& config, const Recording& recording)
        : folder_(config.masks.string()), masks_(config.masks, recording, config.classes) {}

    Segmentation segment(const Frame& frame, const std::optional<People>&, const Eigen::Isometry3f&) override {
        std::optional<LabelImage> labels = masks_.load(frame.stamp);
        return labels ? segmentation_of(std::move(*labels)) : Segmentation{};
    }

    std::string description() const override {
        const std::size_t without = masks_.frames_without();
        return "masks from " + folder_ +
               (without == 0 ? "" : " (" + counted(without, "frame") + " without a mask: no people are cut out there)");
    }

private:
    std::string folder_;
    MaskFolder masks_;
};

/// A network that segments people itself. It runs on every frame: its masks are not carried over.
class OutlinedPeople final : public PeopleFinder {
public:
    explicit OutlinedPeople(std::unique_ptr<PersonMasker> masker) : masker_(std::move(masker)) {}

    Segmentation segment(const Frame& frame, const std::optional<People>&, const Eigen::Isometry3f&) override {
        return segmentation_of(masker_->mask(frame.color));
    }
    std::string description() const override { return masker_->description(); }

private:
    std::unique_ptr<PersonMasker> masker_;
};

/// For comparison: plain dense SLAM.
class NoPeople final : public PeopleFinder {
public:
    Segmentation segment(const Frame&, const std::optional<People>&, const Eigen::Isometry3f&) override { return {}; }
    std::string description() const override { return "off: everything is taken to be static"; }
};

}  // namespace

std::unique_ptr<PeopleFinder> make_people_finder(const RunConfig& config, const Intrinsics& camera) {
    if (!config.masks.empty())
        throw Error("a folder of masks belongs to a recording; give each frame its mask instead");
    if (config.no_people) return std::make_unique<NoPeople>();
    if (!config.mask_network.empty()) {
        MaskRcnnConfig network{config.mask_network, config.mask_threshold, config.classes, config.pose.threads};
        return std::make_unique<OutlinedPeople>(make_mask_rcnn(network));
    }
    return std::make_unique<NetworkPeople>(config, camera);
}

std::unique_ptr<PeopleFinder> make_people_finder(const RunConfig& config, const Recording& recording) {
    if (!config.no_people && !config.masks.empty()) return std::make_unique<MaskedPeople>(config, recording);
    return make_people_finder(config, recording.intrinsics());
}

}  // namespace posefusion
