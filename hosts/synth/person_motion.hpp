#pragma once
#include <vector>

#include "hosts/synth/motion_plan.hpp"
#include "hosts/synth/random.hpp"

/// The posture of the whole body at any time, from footsteps: the pelvis follows the feet, the legs reach from one to
/// the other, the arms swing against the legs, the trunk leans and turns.
namespace posefusion::synth {

class PersonMotion {
public:
    PersonMotion(const Proportions& body, MotionPlan plan, double duration, std::uint64_t seed);
    [[nodiscard]] Posture at(double t) const;
    [[nodiscard]] bool sitting(double t) const { return seated(t) > 0.5f; }

private:
    struct Trunk {
        Vector2f at = Vector2f::Zero();
        float yaw = 0, height = 0;
    };
    [[nodiscard]] FootPosture foot(int side, double t) const;
    [[nodiscard]] float reachable_height(const Vector2f& hips, float yaw, double t) const;
    [[nodiscard]] Trunk trunk(double t) const;
    /// 0 standing, 1 seated.
    [[nodiscard]] float seated(double t) const;
    [[nodiscard]] const Sitting* sitting_at(double t) const;
    void set_arms(Posture& posture, double t) const;

    Proportions body_;
    MotionPlan plan_;
    std::vector<Trunk> trunk_;  ///< sampled at kRate from -kLead on
    SmoothNoise sway_x_, sway_y_, look_, nod_, hand_left_, hand_right_, lean_;
    float arm_swing_, habit_;
};

}  // namespace posefusion::synth
