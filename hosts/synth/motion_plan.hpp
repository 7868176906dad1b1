#pragma once
#include <array>
#include <vector>

#include "hosts/synth/room.hpp"
#include "hosts/synth/skeleton.hpp"

/// The actions of a person as footsteps in time. All other motion follows from the feet, so that feet never slide.
namespace posefusion::synth {

/// Where a foot stands: the ankle's place on the floor plan and the foot's heading (unwrapped, rad).
struct Footprint {
    Vector2f at = Vector2f::Zero();
    float yaw = 0;
};

/// One foot moves from where it stood to `to`, in the air from lift to land (seconds).
struct Footstep {
    double lift = 0, land = 0;
    Footprint to;
};

/// Sitting down from `down` to `seated`, standing up from `rise` to `up` (seconds).
struct Sitting {
    double down = 0, seated = 0, rise = 0, up = 0;
    Vector2f hips = Vector2f::Zero();  ///< floor plan, middle of the hips on the seat
};

/// Hands raised while talking.
struct Gesture {
    double start = 0, end = 0;
    std::array<float, 2> lift{};  ///< of each hand, 0..1
};

class MotionPlan {
public:
    MotionPlan(const Proportions& body, const Vector2f& at, float yaw);

    // Each call adds to the end of the plan.
    void walk(const std::vector<Vector2f>& route, float pace);
    void turn_to(float yaw);
    void stand(double seconds);
    void talk(double seconds, const std::array<float, 2>& lift);
    void carry() { gestures_.push_back({-1, end_ + 1, {1, 1}}); }  ///< both hands before the body, all the time so far
    /// @param hips  where the hips come to rest; the person must stand in front of it with the back to it
    void sit(const Vector2f& hips, double seconds);

    [[nodiscard]] double end() const { return end_; }
    [[nodiscard]] Vector2f place() const { return 0.5f * (last(Left).at + last(Right).at); }
    [[nodiscard]] float yaw() const { return 0.5f * (last(Left).yaw + last(Right).yaw); }

    /// The step that a foot made last before `t`, -1 if none.
    [[nodiscard]] int step_before(int side, double t) const;
    [[nodiscard]] Footprint print_after(int side, int step) const;
    [[nodiscard]] const std::vector<Footstep>& steps(int side) const { return steps_[static_cast<std::size_t>(side)]; }
    [[nodiscard]] const std::vector<Sitting>& sittings() const { return sittings_; }
    [[nodiscard]] const std::vector<Gesture>& gestures() const { return gestures_; }
    /// The pose of a foot at any time, moving smoothly through its steps.
    [[nodiscard]] Footprint foot(int side, double t) const;
    /// Approximate position of the body, for keeping people apart.
    [[nodiscard]] Vector2f place_at(double t) const;

private:
    [[nodiscard]] Footprint last(int side) const { return print_after(side, static_cast<int>(steps(side).size()) - 1); }
    void step(int side, double start, double duration, const Footprint& to);
    [[nodiscard]] Footprint print_beside(int side, const Vector2f& middle, float yaw) const;
    float half_gait_;  ///< ankles from the middle line, metres
    float step_length_;
    std::array<Footprint, 2> start_;
    std::array<std::vector<Footstep>, 2> steps_;
    std::vector<Sitting> sittings_;
    std::vector<Gesture> gestures_;
    double end_ = 0;
};

}  // namespace posefusion::synth
