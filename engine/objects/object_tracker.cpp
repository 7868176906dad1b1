#include "engine/objects/object_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/core/angle.hpp"
#include "engine/core/pinhole.hpp"

namespace posefusion {

using Eigen::Isometry3d;
using Eigen::Vector3f;

namespace {

// Lengths in metres, times in frames.

/// Models on the device at a time, and candidates among them.
constexpr std::size_t kMostObjects = 12, kMostCandidates = 3;
/// Cells of a region that is worth a model.
constexpr std::size_t kFewestCells = 40;
/// A region belongs to an object if they share so many cells, and this share of the smaller one.
constexpr int kFewestShared = 4;
constexpr double kSharedPart = 0.1;
/// How near a cell's depth is to that of an object which is expected there; of a pixel that is tracked with it while
/// its motion is not known well, and once it is.
constexpr float kReach = 0.2f, kYoungReach = 0.1f, kOldReach = 0.05f;
constexpr int kYoung = 4;
/// Weight of the motion that is expected, against that of the frame: the errors of normals make a plane say so much
/// about its motion within itself, of which it knows nothing.
constexpr float kYoungPrior = 0.001f, kOldPrior = 0.02f;
constexpr float kPriorSigma = 0.05f;
/// Neighbouring cells are one surface, and pixels that of their cell.
constexpr float kConnected = 0.06f;
/// Of the model's pixels where the frame measures its surface, or what is behind it: share that has to fit. And of all
/// of them, whatever hides them: what little there is to be seen of a thing behind another does not tell its pose.
constexpr float kFit = 0.65f, kFitOfAll = 0.45f;
constexpr float kFewestPixels = 0.0008f;  ///< of the image, that fit
/// Farther from where it was expected an object was not found, but something else.
constexpr double kFarthest = 0.12, kFarthestDeg = 20;
constexpr double kFarthestOld = 0.04;  ///< of the middle, once the motion is known: what the best brakes do in a frame
/// Comparisons of an earlier view with the current one: frames between them, and the way between the two hypotheses.
constexpr int kAnchorAge = 5, kNewAnchor = 20;
constexpr double kMoved = 0.03;
constexpr int kFewestCompared = 15;
/// Largest share of points that cannot be there, and how many more points fit than if the thing had stood still.
constexpr float kViolated = 0.15f, kBetter = 1.25f;
/// Comparisons in favour until a candidate is an object; against, until it is none.
constexpr int kConfirm = 5, kRefuse = 4;
constexpr int kPatience = 60;    ///< with a candidate of which nothing is known
constexpr int kLosing = 5;       ///< without tracking: an object is lost
constexpr int kLosingYoung = 3;  ///< ... a candidate is none
constexpr int kStanding = 15;    ///< without motion: it rests
constexpr double kStandingWay = 0.01;
constexpr double kNewShare = 0.5;  ///< of the newest motion in the mean
constexpr double kSlowing = 0.8;   ///< of the motion of what is not seen, per frame

Isometry3d between(const Isometry3d& a, const Isometry3d& b, double share) {
    Isometry3d T = Isometry3d::Identity();
    T.linear() =
        Eigen::Quaterniond(a.linear()).slerp(share, Eigen::Quaterniond(b.linear())).normalized().toRotationMatrix();
    T.translation() = (1 - share) * a.translation() + share * b.translation();
    return T;
}

bool is_near(const Isometry3d& a, const Isometry3d& b) {
    const Isometry3d step = a.inverse() * b;
    return step.translation().norm() <= kFarthest && Eigen::AngleAxisd(step.linear()).angle() <= radians(kFarthestDeg);
}

}  // namespace

ObjectTracker::ObjectTracker(std::shared_ptr<MotionJudge> judge, std::shared_ptr<vulkan::Context> context,
                             const Intrinsics& camera, const SlamConfig& config)
    : judge_(std::move(judge)),
      context_(std::move(context)),
      camera_(camera),
      noise_(config.noise),
      models_(*context_, camera, config) {}

LabelImage ObjectTracker::begin(const ColorImage& color, const DepthImage& depth, const LabelImage& people) {
    color_ = &color, depth_ = &depth, people_ = &people;
    attempts_.clear();
    regions_.clear();
    newest_.clear();
    const LabelImage movers = judge_->begin(color, depth, people);
    grid_ = make_depth_grid(depth, people, camera_, noise_);
    return labels_.empty() ? movers : labels_;
}

LabelImage ObjectTracker::find(const Eigen::Isometry3f& T_previous_current) {
    const LabelImage movers = judge_->find(T_previous_current);
    regions_ = regions_of(movers);
    expect(T_previous_current.cast<double>().inverse());
    assign(regions_);
    for (std::size_t i = 0; i < objects_.size(); ++i) {
        const Phase phase = objects_[i].phase;
        const bool active = phase == Phase::Candidate || phase == Phase::Tracked;
        if (active || attempts_[i].moves) track(i, movers);
    }
    for (std::size_t i = 0; i < objects_.size(); ++i)
        if (attempts_[i].tracked) grow(i);
    join(regions_);
    labels_ = movers;
    for (std::uint8_t& label : labels_) label = label != 0 ? kUnknownMoverLabel : std::uint8_t{0};
    for (std::size_t i = 0; i < objects_.size(); ++i)
        if (attempts_[i].tracked) claim(i, movers, labels_);
    if (std::all_of(labels_.begin(), labels_.end(), [](std::uint8_t label) { return label == 0; }))
        labels_ = LabelImage();
    return labels_;
}

std::vector<ObjectTracker::Region> ObjectTracker::regions_of(const LabelImage& movers) const {
    std::vector<Region> regions;
    if (movers.empty()) return regions;
    std::array<int, 256> number{};
    number.fill(-1);
    for (int y = 0; y < grid_.camera.height; ++y)
        for (int x = 0; x < grid_.camera.width; ++x) {
            const std::uint8_t label = movers(x * grid_.step, y * grid_.step);
            if (label == 0 || grid_.depth[grid_.index(x, y)] <= 0) continue;
            int& n = number[label];
            if (n < 0) {
                n = static_cast<int>(regions.size());
                regions.push_back({label, {}, -1});
            }
            regions[static_cast<std::size_t>(n)].cells.push_back(grid_.index(x, y));
        }
    return regions;
}

/// Where each object is, if it goes on as before.
void ObjectTracker::expect(const Isometry3d& T_current_previous) {
    attempts_.assign(objects_.size(), {});
    for (std::size_t i = 0; i < objects_.size(); ++i) {
        const Object& object = objects_[i];
        Attempt& attempt = attempts_[i];
        attempt.expected = T_current_previous * object.T_camera_object * object.step;
        attempt.footprint.assign(grid_.depth.size(), 0);
        const Eigen::Isometry3f T = attempt.expected.cast<float>();
        for (const Vector3f& point : object.surface) {
            const Vector3f p = T * point;
            if (!(p.z() > 0.1f)) continue;
            const Eigen::Vector2f at = project(p, grid_.camera);
            if (!in_image(at, grid_.camera)) continue;
            float& cell = attempt.footprint[grid_.index(static_cast<int>(std::lround(at.x())),
                                                        static_cast<int>(std::lround(at.y())))];
            if (cell == 0) ++attempt.cells;
            if (cell == 0 || p.z() < cell) cell = p.z();
        }
    }
}

/// Which object each moving cell is part of. Those that are being tracked come first.
void ObjectTracker::assign(std::vector<Region>& regions) {
    owners_.assign(grid_.depth.size(), -1);
    const auto meets = [&](std::size_t object, std::size_t cell) {
        const float z = attempts_[object].footprint[cell];
        return z > 0 && std::abs(z - grid_.depth[cell]) < kReach;
    };
    for (Region& region : regions) {
        for (const bool active : {true, false}) {
            std::vector<std::size_t> sharing;
            int most = 0;
            for (std::size_t i = 0; i < objects_.size(); ++i) {
                const Phase phase = objects_[i].phase;
                if ((phase == Phase::Candidate || phase == Phase::Tracked) != active) continue;
                const int shared = static_cast<int>(std::count_if(region.cells.begin(), region.cells.end(),
                                                                  [&](std::size_t cell) { return meets(i, cell); }));
                const double smaller = std::min(static_cast<double>(region.cells.size()), double(attempts_[i].cells));
                if (shared < kFewestShared || shared < kSharedPart * smaller) continue;
                sharing.push_back(i);
                if (shared > most) most = shared, region.owner = static_cast<int>(i);
            }
            for (const std::size_t i : sharing) attempts_[i].moves = true;
            if (sharing.empty()) continue;
            for (const std::size_t cell : region.cells) {
                int owner = region.owner;
                float nearest = kReach;
                for (const std::size_t i : sharing) {
                    const float off = std::abs(attempts_[i].footprint[cell] - grid_.depth[cell]);
                    if (attempts_[i].footprint[cell] > 0 && off < nearest) nearest = off, owner = static_cast<int>(i);
                }
                owners_[cell] = static_cast<std::int8_t>(owner);
            }
            break;
        }
    }
}

/// Cells which the judge takes for static, and where the surface was before, too, if it stood still: although the
/// object may be expected there, they are not its own. The floor below a door that swings looks the same if it turns
/// with it.
void ObjectTracker::find_still(std::size_t number, const LabelImage& movers) {
    const Object& object = objects_[number];
    Attempt& attempt = attempts_[number];
    attempt.still.assign(grid_.depth.size(), 0);
    const Anchor& anchor = object.anchor.age >= kAnchorAge ? object.anchor : object.earlier;
    if (anchor.depth.size() != grid_.depth.size()) return;
    const Isometry3d T_current_previous = attempt.expected * object.step.inverse() * object.T_camera_object.inverse();
    const Isometry3d T_static = (T_current_previous * anchor.T_now_then).inverse();
    const Isometry3d T_moved = anchor.T_object_then.inverse() * attempt.expected.inverse();
    DepthGrid then = grid_;
    then.depth = anchor.depth;
    for (std::size_t cell = 0; cell < grid_.depth.size(); ++cell) {
        const auto [x, y] = grid_.position(cell);
        if (grid_.depth[cell] <= 0 || (!movers.empty() && movers(x * grid_.step, y * grid_.step) != 0)) continue;
        const std::vector<Vector3f> point{grid_.point(x, y)};
        if (distance_between(point, T_static, T_moved) < kMoved) continue;
        attempt.still[cell] = agreement(point, T_static, then).fits > 0 ? 1 : 0;
    }
}

void ObjectTracker::track(std::size_t number, const LabelImage& movers) {
    Object& object = objects_[number];
    Attempt& attempt = attempts_[number];
    const auto own = static_cast<std::int8_t>(number);
    PixelRange range;
    for (int y = 0; y < grid_.camera.height; ++y)
        for (int x = 0; x < grid_.camera.width; ++x) {
            const std::size_t cell = grid_.index(x, y);
            if (attempt.footprint[cell] <= 0 && owners_[cell] != own) continue;
            const int u = x * grid_.step, v = y * grid_.step;
            range.include({u, v, std::min(u + grid_.step, camera_.width), std::min(v + grid_.step, camera_.height)});
        }
    if (range.empty()) return;
    find_still(number, movers);
    attempt.frame.view = ObjectView::around(range, camera_);
    const ObjectView& view = attempt.frame.view;
    attempt.frame.color = view.cut(*color_);
    attempt.frame.depth = view.cut(*depth_);
    attempt.frame.outside = LabelImage(view.camera.width, view.camera.height, 1);
    const bool young = object.tracked < kYoung || object.phase == Phase::Lost;
    const float reach = young ? kYoungReach : kOldReach;
    const auto is_expected = [&](int u, int v, float z) {
        const int x0 = u / grid_.step, y0 = v / grid_.step;
        for (int y = y0 - 1; y <= y0 + 1; ++y)
            for (int x = x0 - 1; x <= x0 + 1; ++x) {
                if (!grid_.contains(x, y)) continue;
                const float there = attempt.footprint[grid_.index(x, y)];
                if (there > 0 && std::abs(there - z) < reach) return true;
            }
        return false;
    };
    int pixels = 0;
    for (int y = 0; y < view.camera.height; ++y)
        for (int x = 0; x < view.camera.width; ++x) {
            const int u = view.u_of(x), v = view.v_of(y);
            if (!depth_->contains(u, v)) continue;
            const float z = (*depth_)(u, v);
            if (!(z > 0) || (!people_->empty() && (*people_)(u, v) != 0)) continue;
            const std::int8_t owner = owners_[grid_.index(u / grid_.step, v / grid_.step)];
            const bool moves = !movers.empty() && movers(u, v) != 0;
            const bool mine = moves && owner == own, others = moves && owner >= 0 && owner != own;
            const bool still = attempt.still[grid_.index(u / grid_.step, v / grid_.step)] != 0;
            if (!mine && (others || still || !is_expected(u, v, z))) continue;
            attempt.frame.outside(x, y) = 0;
            ++pixels;
        }
    if (pixels == 0) return;
    PosePrior prior{young ? kYoungPrior : kOldPrior, kPriorSigma, Vector3f::Zero(), 0};
    const auto surface = static_cast<float>(object.surface.size());
    for (const Vector3f& point : object.surface) prior.middle += point / surface;
    for (const Vector3f& point : object.surface) prior.radius += (point - prior.middle).squaredNorm() / surface;
    prior.radius = std::sqrt(prior.radius);
    const Eigen::Vector3d middle = prior.middle.cast<double>();
    prior.middle = (attempt.expected * middle).cast<float>();
    const ModelTracker::Result result = models_.track(*object.model, attempt.frame, attempt.expected.inverse(), prior);
    attempt.T_camera_object = result.T_object_camera.inverse();
    const double off = (attempt.T_camera_object * middle - attempt.expected * middle).norm();
    attempt.tracked = (young || off <= kFarthestOld) && fits(result, attempt.frame, attempt.expected);
    attempt.model_depth = result.model_depth;
}

bool ObjectTracker::fits(const ModelTracker::Result& result, const ObjectFrame& frame,
                         const Isometry3d& expected) const {
    if (!result.solved || !is_near(expected.inverse(), result.T_object_camera)) return false;
    float same = 0, through = 0, all = 0;
    const ObjectView& view = frame.view;
    for (int y = 0; y < view.camera.height; ++y)
        for (int x = 0; x < view.camera.width; ++x) {
            const float m = result.model_depth(x, y), z = frame.depth(x, y);
            if (m <= 0) continue;
            ++all;
            if (!(z > 0)) continue;
            if (!people_->empty() && (*people_)(view.u_of(x), view.v_of(y)) != 0) continue;
            const float sigma = noise_.sigma(m);
            if (std::abs(z - m) < same_depth(sigma)) ++same;
            if (z - m > other_depth(sigma)) ++through;
        }
    const auto stride = static_cast<float>(view.stride);
    const float least = kFewestPixels * static_cast<float>(camera_.width * camera_.height) / (stride * stride);
    return same >= least && same >= kFit * (same + through) && same >= kFitOfAll * all;
}

/// Parts of one thing: a region that no object explains, and that an object's motion takes to where its surface was.
void ObjectTracker::join(std::vector<Region>& regions) {
    for (Region& region : regions) {
        if (region.owner >= 0) continue;
        std::vector<Vector3f> points;
        for (const std::size_t cell : region.cells) {
            const auto [x, y] = grid_.position(cell);
            points.push_back(grid_.point(x, y));
        }
        int most = 0;
        for (std::size_t i = 0; i < objects_.size(); ++i) {
            const Object& object = objects_[i];
            if (!attempts_[i].tracked || object.anchor.age < kAnchorAge) continue;
            const Isometry3d T_then_object = object.anchor.T_object_then.inverse();
            const Isometry3d T_then_now = T_then_object * attempts_[i].T_camera_object.inverse();
            const Isometry3d T_static = object.anchor.T_now_then.inverse();
            if (distance_between(points, T_then_now, T_static) < kMoved) continue;
            DepthGrid then = grid_;
            then.depth = object.anchor.depth;
            const Agreement with = agreement(points, T_then_now, then), without = agreement(points, T_static, then);
            const bool same =
                with.fits >= 0.5 * static_cast<double>(points.size()) &&
                with.violated()<kViolated&& static_cast<float>(with.fits)> kBetter * static_cast<float>(without.fits);
            if (same && with.fits > most) most = with.fits, region.owner = static_cast<int>(i);
        }
        if (region.owner < 0) continue;
        for (const std::size_t cell : region.cells) owners_[cell] = static_cast<std::int8_t>(region.owner);
    }
}

/// Of the cells that move and are assigned to an object: those that are connected with what its model shows. The others
/// are something else that moves in front of it, behind it or beside it.
void ObjectTracker::grow(std::size_t number) {
    const auto own = static_cast<std::int8_t>(number);
    const Attempt& attempt = attempts_[number];
    const ObjectView& view = attempt.frame.view;
    std::vector<std::size_t> members;
    std::vector<std::uint8_t> reached(grid_.depth.size(), 0);
    for (std::size_t cell = 0; cell < owners_.size(); ++cell) {
        if (owners_[cell] != own) continue;
        const auto [x, y] = grid_.position(cell);
        const int column = (x * grid_.step - view.left) / view.stride, row = (y * grid_.step - view.top) / view.stride;
        const float z = grid_.depth[cell];
        const float m = attempt.model_depth.contains(column, row) ? attempt.model_depth(column, row) : 0.0f;
        if (m <= 0 || std::abs(z - m) > other_depth(noise_.sigma(z))) continue;
        reached[cell] = 1;
        members.push_back(cell);
    }
    for (std::size_t k = 0; k < members.size(); ++k)
        for (const std::size_t next : grid_.connected(members[k], kConnected))
            if (owners_[next] == own && reached[next] == 0) reached[next] = 1, members.push_back(next);
    Region rest;
    for (std::size_t cell = 0; cell < owners_.size(); ++cell)
        if (owners_[cell] == own && reached[cell] == 0) owners_[cell] = -1, rest.cells.push_back(cell);
    // what is left may be several things
    std::fill(reached.begin(), reached.end(), std::uint8_t{1});
    for (const std::size_t cell : rest.cells) reached[cell] = 0;
    for (const std::size_t first : rest.cells) {
        if (reached[first] != 0) continue;
        Region region;
        region.cells.push_back(first);
        reached[first] = 1;
        for (std::size_t k = 0; k < region.cells.size(); ++k)
            for (const std::size_t next : grid_.connected(region.cells[k], kConnected))
                if (reached[next] == 0) reached[next] = 1, region.cells.push_back(next);
        if (region.cells.size() >= kFewestCells) regions_.push_back(std::move(region));
    }
}

/// The pixels of a tracked object: where its model is seen, and what moves and is assigned to it.
void ObjectTracker::claim(std::size_t number, const LabelImage& movers, LabelImage& labels) {
    Attempt& attempt = attempts_[number];
    const auto own = static_cast<std::int8_t>(number);
    const std::uint8_t label = objects_[number].label;
    const ObjectView& view = attempt.frame.view;
    if (labels.empty()) labels = LabelImage(camera_.width, camera_.height);
    std::fill(attempt.frame.outside.begin(), attempt.frame.outside.end(), std::uint8_t{1});
    const auto near_own_cell = [&](int u, int v, float z) {
        const int x0 = u / grid_.step, y0 = v / grid_.step;
        for (int y = y0; y <= y0 + 1; ++y)
            for (int x = x0; x <= x0 + 1; ++x) {
                if (!grid_.contains(x, y)) continue;
                const std::size_t cell = grid_.index(x, y);
                if (owners_[cell] == own && (!(z > 0) || std::abs(z - grid_.depth[cell]) < kConnected)) return true;
            }
        return false;
    };
    const auto is_mine = [&](int u, int v, int x, int y) {
        if (!people_->empty() && (*people_)(u, v) != 0) return false;
        const float z = (*depth_)(u, v), m = attempt.model_depth(x, y);
        const bool moves = !movers.empty() && movers(u, v) != 0;
        if (!moves && attempt.still[grid_.index(u / grid_.step, v / grid_.step)] != 0) return false;
        if (m > 0 && (!(z > 0) || std::abs(z - m) < other_depth(noise_.sigma(m)))) return true;
        return moves && near_own_cell(u, v, z);
    };
    for (int y = 0; y < view.camera.height; ++y)
        for (int x = 0; x < view.camera.width; ++x)
            for (int dv = 0; dv < view.stride; ++dv)
                for (int du = 0; du < view.stride; ++du) {
                    const int u = view.u_of(x) + du, v = view.v_of(y) + dv;
                    if (!depth_->contains(u, v) || !is_mine(u, v, x, y)) continue;
                    std::uint8_t& given = labels(u, v);
                    if (given != 0 && given != kUnknownMoverLabel) continue;  // another object was first
                    if (label != 0) given = label;
                    ++attempt.pixels;
                    if (du == 0 && dv == 0) attempt.frame.outside(x, y) = 0;
                }
}

void ObjectTracker::end(const Eigen::Isometry3f& T_previous_current) {
    judge_->end(T_previous_current);
    const Isometry3d T_current_previous = T_previous_current.cast<double>().inverse();
    if (attempts_.size() != objects_.size()) expect(T_current_previous);
    for (std::size_t i = 0; i < objects_.size(); ++i) commit(objects_[i], attempts_[i], T_current_previous);
    std::erase_if(objects_, [&](Object& object) {
        const bool dead = is_dead(object);
        if (dead) models_.give_back(std::move(object.model));
        return dead;
    });
    for (const Region& region : regions_)
        if (region.owner < 0) give_birth(region);
}

void ObjectTracker::commit(Object& object, Attempt& attempt, const Isometry3d& T_current_previous) {
    const Isometry3d T_standing = T_current_previous * object.T_camera_object;
    object.T_camera_standing = T_current_previous * object.T_camera_standing;
    object.anchor.T_now_then = T_current_previous * object.anchor.T_now_then;
    object.earlier.T_now_then = T_current_previous * object.earlier.T_now_then;
    ++object.anchor.age, ++object.earlier.age;
    if (!attempt.tracked) {
        object.T_camera_object = attempt.expected;
        object.step = between(Isometry3d::Identity(), object.step, kSlowing);
        ++object.missing;
        if (object.phase == Phase::Tracked && object.missing >= kLosing) {
            object.phase = Phase::Lost;
            object.step = Isometry3d::Identity();
        }
        return;
    }
    if (object.phase == Phase::Lost || object.phase == Phase::Resting) object.phase = Phase::Tracked;
    const Isometry3d step = T_standing.inverse() * attempt.T_camera_object;
    object.step = object.tracked < kYoung ? step : between(object.step, step, kNewShare);
    object.T_camera_object = attempt.T_camera_object;
    ++object.tracked;
    object.missing = 0;
    // while it stands, nothing tells its rim from the floor beside it
    if (attempt.moves || object.standing == 0)
        models_.fuse(*object.model, attempt.frame, object.T_camera_object.inverse());
    remember(object, attempt);
    compare(object);
    settle(object, attempt);
    if (object.label != 0) newest_.push_back({object.label, object.T_camera_object, attempt.pixels});
}

/// Was the thing rigid since its anchor, and did it move?
void ObjectTracker::compare(Object& object) {
    Anchor& anchor = object.anchor;
    if (anchor.age < kAnchorAge) return;
    const Isometry3d T_rigid = object.T_camera_object * anchor.T_object_then;
    const Agreement moved = agreement(anchor.points, T_rigid, grid_);
    if (distance_between(anchor.points, T_rigid, anchor.T_now_then) >= kMoved && moved.seen() >= kFewestCompared) {
        const Agreement stood = agreement(anchor.points, anchor.T_now_then, grid_);
        if (moved.violated() > kViolated)
            ++object.bent;
        else if (static_cast<float>(moved.fits) > kBetter * static_cast<float>(stood.fits))
            ++object.rigid;
    }
    if (object.label == 0 && object.rigid >= kConfirm && object.rigid >= 3 * object.bent &&
        kFirstMoverLabel + labels_given_ < kUnknownMoverLabel)
        object.label = static_cast<std::uint8_t>(kFirstMoverLabel + labels_given_++);
    if (object.label != 0 && object.phase == Phase::Candidate) object.phase = Phase::Tracked;
    const bool turned_away = 2 * moved.seen() < static_cast<int>(anchor.points.size());
    if (anchor.age < kNewAnchor && !(turned_away && anchor.age >= 2 * kAnchorAge)) return;
    object.earlier = std::exchange(anchor, {});
}

/// What has stopped becomes part of the static scene, until it moves again.
void ObjectTracker::settle(Object& object, const Attempt& attempt) {
    if (distance_between(object.surface, object.T_camera_object, object.T_camera_standing) > kStandingWay) {
        object.T_camera_standing = object.T_camera_object;
        object.standing = 0;
        return;
    }
    ++object.standing;
    if (object.standing < kStanding || attempt.moves || object.phase != Phase::Tracked) return;
    object.phase = Phase::Resting;
    object.step = Isometry3d::Identity();
}

/// What of the object was visible.
void ObjectTracker::remember(Object& object, const Attempt& attempt) {
    const ObjectView& view = attempt.frame.view;
    const int every = std::max(1, grid_.step / view.stride);
    const Eigen::Isometry3f T_object_camera = object.T_camera_object.inverse().cast<float>();
    const auto is_inside = [&](int x, int y) {
        return attempt.frame.outside.contains(x, y) && attempt.frame.outside(x, y) == 0;
    };
    const bool anchor_here = object.anchor.points.empty();
    object.surface.clear();
    for (int y = 0; y < view.camera.height; y += every)
        for (int x = 0; x < view.camera.width; x += every) {
            if (!is_inside(x, y)) continue;
            const float z = frame_depth(attempt, x, y);
            if (!(z > 0)) continue;
            const Vector3f p = back_project(static_cast<float>(x), static_cast<float>(y), z, view.camera);
            object.surface.push_back(T_object_camera * p);
            const bool inner = is_inside(x - every, y) && is_inside(x + every, y) && is_inside(x, y - every) &&
                               is_inside(x, y + every);
            if (anchor_here && inner && attempt.frame.depth(x, y) > 0) object.anchor.points.push_back(p);
        }
    if (!anchor_here) return;
    object.anchor.T_object_then = object.T_camera_object.inverse();
    object.anchor.T_now_then = Isometry3d::Identity();
    object.anchor.depth = grid_.depth;
    object.anchor.age = 0;
}

float ObjectTracker::frame_depth(const Attempt& attempt, int x, int y) {
    const float m = attempt.model_depth.empty() ? 0.0f : attempt.model_depth(x, y);
    return m > 0 ? m : attempt.frame.depth(x, y);
}

bool ObjectTracker::is_dead(const Object& object) const {
    const bool bent = object.bent >= kRefuse && object.bent > object.rigid;
    if (object.label != 0) return bent;
    return bent || object.missing >= kLosingYoung || object.tracked >= kPatience;
}

void ObjectTracker::give_birth(const Region& region) {
    const auto candidates =
        std::count_if(objects_.begin(), objects_.end(), [](const Object& object) { return object.label == 0; });
    if (region.cells.size() < kFewestCells || objects_.size() >= kMostObjects ||
        static_cast<std::size_t>(candidates) >= kMostCandidates)
        return;
    Attempt attempt;
    PixelRange range;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    std::vector<std::uint8_t> inside(grid_.depth.size(), 0);
    for (const std::size_t cell : region.cells) {
        const auto [x, y] = grid_.position(cell);
        inside[cell] = 1;
        middle += grid_.point(x, y).cast<double>() / static_cast<double>(region.cells.size());
        const int u = x * grid_.step, v = y * grid_.step;
        range.include({u, v, std::min(u + grid_.step, camera_.width), std::min(v + grid_.step, camera_.height)});
    }
    attempt.frame.view = ObjectView::around(range, camera_);
    const ObjectView& view = attempt.frame.view;
    attempt.frame.color = view.cut(*color_);
    attempt.frame.depth = view.cut(*depth_);
    attempt.frame.outside = LabelImage(view.camera.width, view.camera.height, 1);
    for (int y = 0; y < view.camera.height; ++y)
        for (int x = 0; x < view.camera.width; ++x) {
            const int u = view.u_of(x), v = view.v_of(y);
            if (!depth_->contains(u, v) || labels_(u, v) != kUnknownMoverLabel) continue;
            if (!people_->empty() && (*people_)(u, v) != 0) continue;
            if (inside[grid_.index(u / grid_.step, v / grid_.step)] != 0) attempt.frame.outside(x, y) = 0;
        }
    Object object;
    object.T_camera_object.translation() = middle;
    object.T_camera_standing = object.T_camera_object;
    object.model = models_.model();
    models_.fuse(*object.model, attempt.frame, object.T_camera_object.inverse());
    object.tracked = 1;
    remember(object, attempt);
    objects_.push_back(std::move(object));
}

/// The camera's motion is not known: what is tracked now may be anywhere.
void ObjectTracker::restart() {
    judge_->restart();
    for (Object& object : objects_)
        if (object.label == 0) models_.give_back(std::move(object.model));
    std::erase_if(objects_, [](const Object& object) { return object.label == 0; });
    for (Object& object : objects_) {
        object.phase = Phase::Lost;
        object.step = Isometry3d::Identity();
        object.anchor = object.earlier = {};
    }
    attempts_.clear();
    regions_.clear();
    labels_ = LabelImage();
    newest_.clear();
}

void ObjectTracker::clear() {
    for (Object& object : objects_) models_.give_back(std::move(object.model));
    objects_.clear();
    labels_given_ = 0;
    restart();
}

std::vector<MovingObject> ObjectTracker::objects() const {
    std::vector<MovingObject> sorted = newest_;
    std::sort(sorted.begin(), sorted.end(),
              [](const MovingObject& a, const MovingObject& b) { return a.label < b.label; });
    return sorted;
}

std::vector<ObjectMap> ObjectTracker::maps(bool stable_only) const {
    std::vector<ObjectMap> maps;
    for (const Object& object : objects_)
        if (object.label != 0) maps.push_back({object.label, models_.surfels(*object.model, stable_only)});
    std::sort(maps.begin(), maps.end(), [](const ObjectMap& a, const ObjectMap& b) { return a.label < b.label; });
    return maps;
}

ByteArray ObjectTracker::state() const {
    StateWriter out;
    const ByteArray judge = judge_->state();
    out.put(std::uint64_t{judge.size()});
    out.raw(judge.data(), judge.size());
    out.put(labels_given_);
    const auto put_points = [&](const std::vector<Vector3f>& points) {
        out.list(points, [&](const Vector3f& point) { out.put(point); });
    };
    out.list(objects_, [&](const Object& object) {
        out.put(object.label);
        out.put(static_cast<std::uint8_t>(object.phase));
        for (const Isometry3d* T :
             {&object.T_camera_object, &object.step, &object.T_camera_standing, &object.anchor.T_object_then,
              &object.anchor.T_now_then, &object.earlier.T_object_then, &object.earlier.T_now_then})
            out.put(*T);
        for (const int value : {object.tracked, object.missing, object.standing, object.rigid, object.bent,
                                object.anchor.age, object.earlier.age})
            out.put(value);
        put_points(object.surface);
        put_points(object.anchor.points);
        for (const Anchor* anchor : {&object.anchor, &object.earlier})
            out.list(anchor->depth, [&](float z) { out.put(z); });
        models_.save(out, *object.model);
    });
    out.list(labels_, [&](std::uint8_t label) { out.put(label); });
    return out.take();
}

void ObjectTracker::restore(std::span<const std::byte> state) {
    StateReader in(state, "the state of the objects");
    const auto judge_bytes = in.get<std::uint64_t>();
    in.expect(judge_bytes);
    ByteArray judge(judge_bytes);
    in.raw(judge.data(), judge.size());
    const int labels_given = in.get<int>();
    if (labels_given < 0 || kFirstMoverLabel + labels_given > kUnknownMoverLabel) in.fail();
    const auto points = [&] { return in.list<Vector3f>(sizeof(Vector3f), [&] { return in.get_matrix<Vector3f>(); }); };
    std::vector<Object> objects = in.list<Object>(1, [&] {
        Object object;
        object.label = in.get<std::uint8_t>();
        object.phase = in.get_enum(Phase::Lost);
        for (Isometry3d* T :
             {&object.T_camera_object, &object.step, &object.T_camera_standing, &object.anchor.T_object_then,
              &object.anchor.T_now_then, &object.earlier.T_object_then, &object.earlier.T_now_then})
            *T = in.get_pose();
        for (int* value : {&object.tracked, &object.missing, &object.standing, &object.rigid, &object.bent,
                           &object.anchor.age, &object.earlier.age})
            *value = in.get<int>();
        object.surface = points();
        object.anchor.points = points();
        for (Anchor* anchor : {&object.anchor, &object.earlier})
            anchor->depth = in.list<float>(sizeof(float), [&] { return in.get<float>(); });
        object.model = models_.load(in);
        return object;
    });
    const auto labels = in.list<std::uint8_t>(1, [&] { return in.get<std::uint8_t>(); });
    LabelImage image = labels.empty() ? LabelImage() : LabelImage(camera_.width, camera_.height);
    if (labels.size() != image.size()) in.fail();
    std::copy(labels.begin(), labels.end(), image.begin());
    in.end();
    judge_->restore(judge);
    clear();
    judge_->restore(judge);
    labels_given_ = labels_given;
    objects_ = std::move(objects);
    labels_ = std::move(image);
}

}  // namespace posefusion
