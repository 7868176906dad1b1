#include "segmentation/motion_segmenter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/pinhole.hpp"
#include "segmentation/convex_patches.hpp"
#include "segmentation/grid_cut.hpp"
#include "segmentation/heaviest_region.hpp"
#include "segmentation/node_grid.hpp"
#include "segmentation/refinement.hpp"
#include "segmentation/view_history.hpp"

namespace posefusion {
namespace {

/// Log-odds of "moves" against "static", in the units of the cut: 1 is an edge between equal neighbours.
struct MotionConfig {
    int views = 2;           ///< so many views have to agree
    float came = 1.0f;       ///< a point where there was free space
    float stayed = -0.1f;    ///< a point where there was this surface all the time
    float known = 0.9f;      ///< memory's share from frame to frame where a point is seen again
    float uncovered = 0.7f;  ///< ... where what hid it for a while is gone
    float unknown = 0.98f;   ///< ... where the views say nothing
    float accused = 1.5f;    ///< at least, of what tracking fits better without: some frames until it is forgotten
    float least = -0.3f, most = 3;
    float patch_share = 0.05f;  ///< of a patch's nodes that came: more, and the whole patch moves
    int patch_nodes = 12;       ///< and at least so many
    float patch = 1.0f;         ///< weight for moving of the others
    int face_nodes = 150;       ///< a face this large must show itself that it moves
    float face_share = 0.02f;   ///< of its nodes that came: more, and it moves with its patch
    float bias = -0.5f;         ///< a single frame proves nothing
    float person = -3;          ///< people are cut elsewhere
    float same_point =
        0.05f;             ///< a node remembers the one that was this near in the frame before, metres, beyond noise
    int thing_nodes = 25;  ///< fewer are noise
    int thing_came = 6;    ///< of a thing, that came or were remembered to move
};

/// How well frames fit the map lately.
class UsualFit {
public:
    /// In the first frames nothing is usual.
    [[nodiscard]] bool is_exceeded_by(const TrackingFit& fit) const {
        if (frames_ < kFewest) return true;
        return icp_scale_ <= kRough &&
               (fit.icp_scale > kMuch * icp_scale_ || fit.photometric_rmse > kMuch * photometric_rmse_);
    }
    void add(const TrackingFit& fit) {
        const float share = std::max(kShare, 1 / static_cast<float>(++frames_));
        const auto add_to = [&](float& mean, float value) {
            const float most =
                frames_ > kFewest ? kMuch * mean : value;  // an exception does not become the rule at once
            mean += share * (std::min(value, most) - mean);
        };
        add_to(icp_scale_, fit.icp_scale);
        add_to(photometric_rmse_, fit.photometric_rmse);
    }

    void save(StateWriter& out) const {
        out.put(frames_);
        out.put(icp_scale_);
        out.put(photometric_rmse_);
    }
    void load(StateReader& in) {
        frames_ = in.get<std::int32_t>();
        icp_scale_ = in.get<float>();
        photometric_rmse_ = in.get<float>();
        if (frames_ < 0 || !std::isfinite(icp_scale_) || !std::isfinite(photometric_rmse_)) in.fail();
    }

private:
    static constexpr std::int32_t kFewest = 5;  ///< frames
    static constexpr float kMuch = 1.12f, kShare = 0.05f;
    static constexpr float kRough = 1.6f;  ///< standard deviations: then other errors than noise are usual

    std::int32_t frames_ = 0;
    float icp_scale_ = 0, photometric_rmse_ = 0;
};

struct Odds {
    Eigen::Vector3f point = Eigen::Vector3f::Zero();  ///< camera coordinates; zero = no depth
    float log_odds = 0;
};

class MotionSegmenter final : public MotionJudge {
public:
    MotionSegmenter(const Intrinsics& camera, const DepthNoise& noise)
        : camera_(camera), noise_(noise), step_(node_step(camera)), history_({}) {}

    LabelImage begin(const ColorImage& color, const DepthImage& depth, const LabelImage& people) override {
        color_ = &color, depth_ = &depth;
        grid_ = make_node_grid(color, depth, camera_, noise_, step_);
        look_at_pixels(people);
        accused_.clear();
        return movers_;
    }

    LabelImage suspect(const TrackingFit& fit) override {
        const bool unusual = usual_.is_exceeded_by(fit);
        usual_.add(fit);
        if (!unusual) return {};
        const std::vector<std::uint8_t> region = find_heaviest_region(
            grid_, [&](std::size_t i) { return person_[i] == 0 && (movers_.empty() || at_node(movers_, i) == 0); });
        if (region.empty()) return {};
        LabelImage labels(camera_.width, camera_.height);
        for (int v = 0; v < camera_.height; ++v)
            for (int u = 0; u < camera_.width; ++u) labels(u, v) = region[grid_.index(u / step_, v / step_)];
        return labels;
    }

    void accuse(const LabelImage& suspect) override {
        accused_.resize(grid_.nodes.size());
        for (std::size_t i = 0; i < accused_.size(); ++i) accused_[i] = at_node(suspect, i);
    }

    LabelImage find(const Eigen::Isometry3f& T_previous_current) override {
        const std::vector<Sightings> sightings = history_.look_back(grid_, nearest_, T_previous_current);
        recall(sightings, T_previous_current);
        const std::vector<float> preference = preferences(sightings);
        movers_ = LabelImage();
        if (std::none_of(preference.begin(), preference.end(), [](float value) { return value > 0; })) return movers_;
        std::vector<std::uint8_t> labels = cut_grid(grid_, preference, {});
        if (!keep_things(labels, sightings)) return movers_;
        movers_ = refine_labels(grid_, labels, *color_, *depth_, {});
        return movers_;
    }

    void end(const Eigen::Isometry3f& T_previous_current) override {
        history_.add(grid_, nearest_, T_previous_current);
        if (odds_.size() != grid_.nodes.size()) odds_.assign(grid_.nodes.size(), config_.least);
        remembered_.resize(grid_.nodes.size());
        for (std::size_t i = 0; i < grid_.nodes.size(); ++i) remembered_[i] = {grid_.nodes[i].point, odds_[i]};
        odds_.clear();
    }

    void restart() override {
        history_.clear();
        remembered_.clear();
        odds_.clear();
        movers_ = LabelImage();
        usual_ = {};
    }

    [[nodiscard]] ByteArray state() const override {
        StateWriter out;
        history_.save(out);
        out.list(remembered_, [&](const Odds& odds) {
            out.put(odds.point);
            out.put(odds.log_odds);
        });
        out.list(movers_, [&](std::uint8_t label) { out.put(label); });
        usual_.save(out);
        return out.take();
    }

    void restore(std::span<const std::byte> state) override {
        StateReader in(state, "the state of what moves");
        const auto blocks = [&](int pixels) { return static_cast<std::size_t>((pixels + step_ - 1) / step_); };
        const std::size_t nodes = blocks(camera_.width) * blocks(camera_.height);
        history_.load(in, nodes);
        remembered_ = in.list<Odds>(sizeof(Odds), [&] {
            Odds odds;
            odds.point = in.get_matrix<Eigen::Vector3f>();
            odds.log_odds = in.get<float>();
            return odds;
        });
        if (!remembered_.empty() && remembered_.size() != nodes) in.fail();
        const auto labels = in.list<std::uint8_t>(1, [&] { return in.get<std::uint8_t>(); });
        movers_ = labels.empty() ? LabelImage() : LabelImage(camera_.width, camera_.height);
        if (labels.size() != movers_.size()) in.fail();
        std::copy(labels.begin(), labels.end(), movers_.begin());
        usual_.load(in);
        in.end();
    }

private:
    /// The nearest pixel of each node, and the share of people.
    void look_at_pixels(const LabelImage& people) {
        nearest_.assign(grid_.nodes.size(), 0);
        person_.assign(grid_.nodes.size(), 0);
        for (int y = 0; y < grid_.height; ++y)
            for (int x = 0; x < grid_.width; ++x) {
                const std::size_t i = grid_.index(x, y);
                float least = grid_.nodes[i].depth;
                int persons = 0;
                for (int v = y * step_; v < std::min((y + 1) * step_, camera_.height); ++v)
                    for (int u = x * step_; u < std::min((x + 1) * step_, camera_.width); ++u) {
                        const float z = (*depth_)(u, v);
                        if (z > 0 && z < least) least = z;
                        persons += !people.empty() && people(u, v) != 0;
                    }
                nearest_[i] = least;
                if (persons > 0) mark_person(x, y);
            }
    }

    void mark_person(int x, int y) {
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
                if (grid_.contains(x + dx, y + dy)) person_[grid_.index(x + dx, y + dy)] = 1;
    }

    [[nodiscard]] std::uint8_t at_node(const LabelImage& labels, std::size_t i) const {
        const auto n = static_cast<int>(i);
        return labels(n % grid_.width * step_, n / grid_.width * step_);
    }

    [[nodiscard]] bool came(const Sightings& seen) const { return seen.free + seen.left >= config_.views; }

    /// Log-odds of this frame: those of the same point in the frame before, and what the views say now.
    void recall(const std::vector<Sightings>& sightings, const Eigen::Isometry3f& T_previous_current) {
        odds_.assign(grid_.nodes.size(), config_.least);
        for (std::size_t i = 0; i < odds_.size(); ++i) {
            const Node& node = grid_.nodes[i];
            if (node.depth <= 0 || person_[i]) continue;
            const float before = before_of(node, T_previous_current);
            const Sightings& seen = sightings[i];
            float odds = before * config_.unknown;
            if (came(seen))
                odds = before * config_.known + config_.came;
            else if (seen.was_hidden)
                odds = before * config_.uncovered + config_.stayed;
            else if (seen.free + seen.left == 0 && seen.there >= config_.views)
                odds = before * config_.known + config_.stayed;
            if (!accused_.empty() && accused_[i] != 0) odds = std::max(odds, config_.accused);
            odds_[i] = std::clamp(odds, config_.least, config_.most);
        }
    }

    [[nodiscard]] float before_of(const Node& node, const Eigen::Isometry3f& T_previous_current) const {
        if (remembered_.size() != grid_.nodes.size()) return 0;
        const Eigen::Vector3f p = T_previous_current * node.point;
        if (!(p.z() > 0.1f)) return 0;
        const Eigen::Vector2f at = project(p, grid_.camera);
        if (!(at.x() > -1 && at.y() > -1 && at.x() < static_cast<float>(grid_.width) &&
              at.y() < static_cast<float>(grid_.height)))
            return 0;
        const int x0 = static_cast<int>(std::lround(at.x())), y0 = static_cast<int>(std::lround(at.y()));
        float nearest = config_.same_point + 2 * grid_.noise.sigma(node.depth);
        float odds = 0;
        for (int y = y0 - 2; y <= y0 + 2; ++y)
            for (int x = x0 - 2; x <= x0 + 2; ++x) {
                if (!grid_.contains(x, y)) continue;
                const Odds& kept = remembered_[grid_.index(x, y)];
                const float distance = (kept.point - p).norm();
                if (kept.point.z() <= 0 || distance >= nearest) continue;
                nearest = distance;
                odds = kept.log_odds;
            }
        return odds;
    }

    [[nodiscard]] std::vector<float> preferences(const std::vector<Sightings>& sightings) const {
        const ConvexPatches patches = find_convex_patches(grid_);
        Evidence of_patch(patches.count), of_face(patches.face_count);
        for (std::size_t i = 0; i < odds_.size(); ++i) {
            if (patches.patch[i] < 0 || person_[i]) continue;
            const bool moved = sightings[i].free + sightings[i].left > 0 || odds_[i] > -config_.bias;
            of_patch.add(patches.patch[i], moved);
            of_face.add(patches.face[i], moved);
        }
        std::vector<float> preference(odds_.size(), 0);
        for (std::size_t i = 0; i < odds_.size(); ++i) {
            preference[i] = person_[i] ? config_.person : odds_[i] + config_.bias;
            if (grid_.nodes[i].depth <= 0 && !person_[i]) preference[i] = 0;
            if (patches.patch[i] < 0 || person_[i]) continue;
            const auto p = static_cast<std::size_t>(patches.patch[i]), f = static_cast<std::size_t>(patches.face[i]);
            const bool moves = of_patch.moved[p] >= config_.patch_nodes && of_patch.share(p) > config_.patch_share;
            // What seems to be a convex edge may be the gap between a door and the floor that it swings over.
            if (moves && (of_face.nodes[f] < config_.face_nodes || of_face.share(f) > config_.face_share))
                preference[i] += config_.patch;
        }
        return preference;
    }

    /// Of regions of the grid: their nodes, and how many of these say that they move.
    struct Evidence {
        explicit Evidence(int regions) : nodes(static_cast<std::size_t>(regions), 0), moved(nodes) {}
        void add(int region, bool moves) {
            ++nodes[static_cast<std::size_t>(region)];
            moved[static_cast<std::size_t>(region)] += moves ? 1 : 0;
        }
        [[nodiscard]] float share(std::size_t region) const {
            return static_cast<float>(moved[region]) / static_cast<float>(nodes[region]);
        }
        std::vector<int> nodes, moved;
    };

    /// Numbers the connected things that are large enough, removes the others. Returns whether there are any.
    bool keep_things(std::vector<std::uint8_t>& labels, const std::vector<Sightings>& sightings) const {
        std::vector<std::uint8_t> things(labels.size(), 0);
        std::vector<std::size_t> members;
        int next = kFirstMoverLabel;
        for (std::size_t first = 0; first < labels.size(); ++first) {
            if (labels[first] != 1) continue;
            members.assign(1, first);
            labels[first] = 2;  // visited
            int evidence = 0, seen = 0;
            for (std::size_t k = 0; k < members.size(); ++k) {
                const std::size_t i = members[k];
                evidence += came(sightings[i]) || odds_[i] > -config_.bias;
                seen += grid_.nodes[i].depth > 0;
                const int x = static_cast<int>(i % static_cast<std::size_t>(grid_.width)),
                          y = static_cast<int>(i / static_cast<std::size_t>(grid_.width));
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) {
                        if (!grid_.contains(x + dx, y + dy)) continue;
                        const std::size_t j = grid_.index(x + dx, y + dy);
                        if (labels[j] != 1) continue;
                        labels[j] = 2;
                        members.push_back(j);
                    }
            }
            if (seen < config_.thing_nodes || evidence < config_.thing_came) continue;
            for (const std::size_t i : members) things[i] = static_cast<std::uint8_t>(next);
            next = std::min(next + 1, 255);
        }
        labels = std::move(things);
        return next > kFirstMoverLabel;
    }

    Intrinsics camera_;
    DepthNoise noise_;
    int step_;  ///< pixels per node
    MotionConfig config_;
    ViewHistory history_;
    std::vector<Odds> remembered_;  ///< per node of the frame before; empty = none
    LabelImage movers_;             ///< of the newest find()
    UsualFit usual_;

    // of the frame between begin() and end()
    const ColorImage* color_ = nullptr;
    const DepthImage* depth_ = nullptr;
    NodeGrid grid_;
    std::vector<float> nearest_;        ///< per node, least depth, metres; 0 = unknown
    std::vector<std::uint8_t> person_;  ///< per node, 1 = a person or next to one
    std::vector<float> odds_;
    std::vector<std::uint8_t> accused_;  ///< per node; empty: nothing is
};

}  // namespace

std::unique_ptr<MotionJudge> make_motion_segmenter(const Intrinsics& camera, const DepthNoise& noise) {
    if (!camera.valid()) throw Error("movers: focal lengths and image size of the camera must be positive");
    return std::make_unique<MotionSegmenter>(camera, noise);
}

}  // namespace posefusion
