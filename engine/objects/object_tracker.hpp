#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/core/motion_judge.hpp"
#include "engine/objects/model_tracker.hpp"
#include "engine/objects/object_map.hpp"
#include "engine/objects/rigid_motion.hpp"
#include "engine/slam/slam_config.hpp"

namespace posefusion {

/// In the labels of an ObjectTracker: it moves, and is no rigid thing that is known.
inline constexpr std::uint8_t kUnknownMoverLabel = 255;

/// Makes objects of what moves as a rigid body: what another judge finds to move is given a model, tracked from frame
/// to frame relative to the camera (ModelTracker), and fused. A thing is a candidate until its first view has been
/// compared with later ones (rigid_motion.hpp): under the motion that was tracked its points have to be there, and to
/// be there clearly more than if it had stood still. Labels: one per object, the same in all frames, from
/// kFirstMoverLabel on; kUnknownMoverLabel for everything else that moves.
class ObjectTracker final : public MotionJudge {
public:
    /// @param judge  who finds what moves
    /// Throws Error if the device has not enough memory.
    ObjectTracker(std::shared_ptr<MotionJudge> judge, std::shared_ptr<vulkan::Context> context,
                  const Intrinsics& camera, const SlamConfig& config);

    LabelImage begin(const ColorImage& color, const DepthImage& depth, const LabelImage& people) override;
    LabelImage suspect(const TrackingFit& fit) override { return judge_->suspect(fit); }
    void accuse(const LabelImage& suspect) override { judge_->accuse(suspect); }
    LabelImage find(const Eigen::Isometry3f& T_previous_current) override;
    void end(const Eigen::Isometry3f& T_previous_current) override;
    void restart() override;
    [[nodiscard]] std::vector<MovingObject> objects() const override;
    [[nodiscard]] ByteArray state() const override;
    void restore(std::span<const std::byte> state) override;

    /// Forgets all objects.
    void clear();
    /// Of all objects so far, by label. Not while a frame is processed.
    [[nodiscard]] std::vector<ObjectMap> maps(bool stable_only) const;

private:
    enum class Phase : std::uint8_t { Candidate, Tracked, Resting, Lost };

    /// A view that later ones are compared with.
    struct Anchor {
        std::vector<Eigen::Vector3f> points;                              ///< of the object, camera coordinates then
        Eigen::Isometry3d T_object_then = Eigen::Isometry3d::Identity();  ///< camera then to object
        Eigen::Isometry3d T_now_then = Eigen::Isometry3d::Identity();     ///< motion of the camera since
        std::vector<float> depth;                                         ///< DepthGrid::depth of that frame
        int age = 0;                                                      ///< frames
    };

    struct Object {
        std::uint8_t label = 0;  ///< 0: a candidate
        Phase phase = Phase::Candidate;
        std::unique_ptr<ObjectModel> model;
        Eigen::Isometry3d T_camera_object = Eigen::Isometry3d::Identity();
        Eigen::Isometry3d step = Eigen::Isometry3d::Identity();  ///< its motion from frame to frame, in its frame
        Eigen::Isometry3d T_camera_standing = Eigen::Isometry3d::Identity();  ///< the pose, had it stood still lately
        int tracked = 0;                                                      ///< frames
        int missing = 0;                                                      ///< frames since
        int standing = 0;                                                     ///< frames since it moved
        int rigid = 0, bent = 0;               ///< comparisons that spoke for it, or against
        std::vector<Eigen::Vector3f> surface;  ///< samples of what was visible, in its frame
        Anchor anchor, earlier;                ///< the newest one, and that before it
    };

    /// What became of an object in a frame that is not ended yet.
    struct Attempt {
        Eigen::Isometry3d expected = Eigen::Isometry3d::Identity();  ///< T_camera_object
        std::vector<float> footprint;  ///< per cell, depth of the object if it is where it is expected; 0 = not there
        int cells = 0;                 ///< of the footprint
        std::vector<std::uint8_t> still;  ///< per cell, 1: the static scene explains it, as much as the object would
        bool moves = false;               ///< the judge says so of part of it
        bool tracked = false;
        Eigen::Isometry3d T_camera_object = Eigen::Isometry3d::Identity();
        ObjectFrame frame;  ///< `outside` as it will be fused
        PixelRange range;
        DepthImage model_depth;
        std::uint32_t pixels = 0;
    };

    /// Connected cells that the judge says move.
    struct Region {
        std::uint8_t label = 0;
        std::vector<std::size_t> cells;
        int owner = -1;  ///< object, by position; -1: none
    };

    [[nodiscard]] std::vector<Region> regions_of(const LabelImage& movers) const;
    void expect(const Eigen::Isometry3d& T_current_previous);
    void assign(std::vector<Region>& regions);
    void find_still(std::size_t number, const LabelImage& movers);
    void track(std::size_t number, const LabelImage& movers);
    [[nodiscard]] bool fits(const ModelTracker::Result& result, const ObjectFrame& frame,
                            const Eigen::Isometry3d& expected) const;
    void claim(std::size_t number, const LabelImage& movers, LabelImage& labels);
    void grow(std::size_t number);
    void join(std::vector<Region>& regions);
    void commit(Object& object, Attempt& attempt, const Eigen::Isometry3d& T_current_previous);
    void compare(Object& object);
    void settle(Object& object, const Attempt& attempt);
    void give_birth(const Region& region);
    void remember(Object& object, const Attempt& attempt);
    [[nodiscard]] static float frame_depth(const Attempt& attempt, int x, int y);
    [[nodiscard]] bool is_dead(const Object& object) const;

    std::shared_ptr<MotionJudge> judge_;
    std::shared_ptr<vulkan::Context> context_;
    Intrinsics camera_;
    DepthNoise noise_;
    ModelTracker models_;
    std::vector<Object> objects_;
    int labels_given_ = 0;
    LabelImage labels_;  ///< of the newest find()
    std::vector<MovingObject> newest_;

    // of the frame between begin() and end()
    const ColorImage* color_ = nullptr;
    const DepthImage* depth_ = nullptr;
    const LabelImage* people_ = nullptr;
    DepthGrid grid_;
    std::vector<Attempt> attempts_;
    std::vector<Region> regions_;
    std::vector<std::int8_t> owners_;  ///< per cell: object, by position; -1: none
};

}  // namespace posefusion
