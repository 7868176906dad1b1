#include "hosts/pipeline/people_finder.hpp"

#include <cstddef>
#include <set>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/stopwatch.hpp"
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

    FoundPeople find(const Frame& frame, const std::function<Eigen::Isometry3f()>& T_previous_current) override {
        FoundPeople found;
        if (calls_++ % every_ == 0) {
            const Stopwatch watch;
            found.joints = detector_->detect(frame.color);  // eq. (1)
            found.joints_ms = watch.milliseconds();
        }
        const Eigen::Isometry3f motion = T_previous_current();
        const Stopwatch watch;
        found.segmentation = segmenter_->segment(frame.color, frame.depth, found.joints, motion);  // eq. (2) and (3)
        found.segmentation_ms = watch.milliseconds();
        return found;
    }

    std::string description() const override {
        return detector_->description() + (every_ == 1 ? "" : ", every " + std::to_string(every_) + " frames");
    }

    ByteArray state() const override {
        StateWriter out;
        out.put(std::uint64_t{calls_});
        const ByteArray segmentation = segmenter_->state();
        out.raw(segmentation.data(), segmentation.size());
        return out.take();
    }

    void restore(std::span<const std::byte> state) override {
        std::uint64_t calls = 0;
        StateReader(state, "the state of the people").raw(&calls, sizeof(calls));
        segmenter_->restore(state.subspan(sizeof(calls)));
        calls_ = calls;
    }

private:
    std::unique_ptr<JointDetector> detector_;
    std::unique_ptr<Segmenter> segmenter_;
    std::size_t every_, calls_ = 0;
};

/// Label images made elsewhere. A frame without one is taken to show nobody.
class MaskedPeople final : public PeopleFinder {
public:
    MaskedPeople(const RunConfig& config, const Recording& recording)
        : folder_(config.masks.string()), masks_(config.masks, recording, config.classes) {}

    FoundPeople find(const Frame& frame, const std::function<Eigen::Isometry3f()>&) override {
        FoundPeople found;
        std::optional<LabelImage> labels = masks_.load(frame.stamp);
        if (labels)
            found.segmentation = cut_out(frame.depth, std::move(*labels));
        else
            found.segmentation.static_depth = frame.depth;
        return found;
    }

    std::string description() const override {
        const std::size_t without = masks_.frames_without();
        return "masks from " + folder_ +
               (without == 0 ? ""
                             : " (" + std::to_string(without) + " frames without a mask: nobody is cut out there)");
    }

private:
    std::string folder_;
    MaskFolder masks_;
};

/// A network that outlines people itself. It looks at every frame: nothing carries its masks on.
class OutlinedPeople final : public PeopleFinder {
public:
    explicit OutlinedPeople(std::unique_ptr<PersonMasker> masker) : masker_(std::move(masker)) {}

    FoundPeople find(const Frame& frame, const std::function<Eigen::Isometry3f()>&) override {
        const Stopwatch watch;
        FoundPeople found;
        found.segmentation = cut_out(frame.depth, masker_->mask(frame.color));
        found.segmentation_ms = watch.milliseconds();
        return found;
    }
    std::string description() const override { return masker_->description(); }

private:
    std::unique_ptr<PersonMasker> masker_;
};

/// For comparison: plain dense SLAM.
class NoPeople final : public PeopleFinder {
public:
    FoundPeople find(const Frame& frame, const std::function<Eigen::Isometry3f()>&) override {
        FoundPeople found;
        found.segmentation.static_depth = frame.depth;
        return found;
    }
    std::string description() const override { return "off: everything is taken to be static"; }
};

}  // namespace

Segmentation cut_out(const DepthImage& depth, LabelImage labels) {
    if (labels.width() != depth.width() || labels.height() != depth.height()) {
        throw Error("the mask has " + std::to_string(labels.width()) + " x " + std::to_string(labels.height()) +
                    " pixels, the depth image " + std::to_string(depth.width()) + " x " +
                    std::to_string(depth.height()));
    }
    Segmentation out;
    out.static_depth = depth;
    std::set<std::uint8_t> people;
    for (std::size_t i = 0; i < labels.size(); ++i) {
        if (labels[i] == 0) continue;
        people.insert(labels[i]);
        out.static_depth[i] = 0;
    }
    out.people = static_cast<int>(people.size());
    out.labels = std::move(labels);
    return out;
}

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
