#include "pose/openpose.hpp"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr int kHeatChannels = kJointCount + 1;
constexpr int kBackground = kJointCount;
constexpr int kLimbCount = 19;
constexpr int kPafChannels = 2 * kLimbCount;

/// Limb of a part affinity field: from joint to joint, and the channel of the field's x (y follows).
struct PafLimb {
    int from, to, channel;
};

/// OpenPose's POSE_COCO_PAIRS with POSE_COCO_MAP_IDX, less the 19 heat maps that precede the fields there.
constexpr std::array<PafLimb, kLimbCount> kPafLimbs{{
    {Neck, RightHip, 0},
    {RightHip, RightKnee, 2},
    {RightKnee, RightAnkle, 4},
    {Neck, LeftHip, 6},
    {LeftHip, LeftKnee, 8},
    {LeftKnee, LeftAnkle, 10},
    {Neck, RightShoulder, 12},
    {RightShoulder, RightElbow, 14},
    {RightElbow, RightWrist, 16},
    {RightShoulder, RightEar, 18},
    {Neck, LeftShoulder, 20},
    {LeftShoulder, LeftElbow, 22},
    {LeftElbow, LeftWrist, 24},
    {LeftShoulder, LeftEar, 26},
    {Neck, Nose, 28},
    {Nose, RightEye, 30},
    {Nose, LeftEye, 32},
    {RightEye, RightEar, 34},
    {LeftEye, LeftEar, 36},
}};

/// A candidate joint; position in cells, whole numbers being the centres of cells.
struct Peak {
    int joint = 0;
    float x = 0, y = 0;
    float certainty = 0;
};

struct Link {
    int limb = 0;
    int from = 0, to = 0;  ///< indices of peaks
    float score = 0;
};

Tensor slice(const Tensor& stack, int first, int count) {
    Tensor part(count, stack.height(), stack.width());
    std::copy(stack.plane(first), stack.plane(first) + part.values.size(), part.values.begin());
    return part;
}

float mean_of_plane(const Tensor& stack, int channel) {
    const auto size = static_cast<std::ptrdiff_t>(stack.height()) * stack.width();
    return std::accumulate(stack.plane(channel), stack.plane(channel) + size, 0.0f) / static_cast<float>(size);
}

OpenPoseMaps split_concatenated(const Tensor& stack) {
    constexpr float kLeastBackground = 0.5f;
    const float heat_first = mean_of_plane(stack, kBackground);
    const float paf_first = mean_of_plane(stack, kPafChannels + kBackground);
    if (std::max(heat_first, paf_first) < kLeastBackground) {
        throw Error("the 57 maps of the network are not OpenPose's: none of them is a background map");
    }
    if (heat_first > paf_first) return {slice(stack, 0, kHeatChannels), slice(stack, kHeatChannels, kPafChannels)};
    return {slice(stack, kPafChannels, kHeatChannels), slice(stack, 0, kPafChannels)};
}

/// Offset of the peak of the parabola through three neighbouring values from the middle one, at most half a cell.
float parabola_top(float before, float middle, float after) {
    const float curvature = before - 2 * middle + after;
    return curvature < 0 ? std::clamp(0.5f * (before - after) / curvature, -0.5f, 0.5f) : 0.0f;
}

/// The larger of two neighbours before the cell or at least as large after it: a plateau has one peak.
bool is_peak(const Tensor& heat, int joint, int x, int y) {
    const float value = heat.at(joint, y, x);
    for (int ny = std::max(0, y - 1); ny <= std::min(heat.height() - 1, y + 1); ++ny) {
        for (int nx = std::max(0, x - 1); nx <= std::min(heat.width() - 1, x + 1); ++nx) {
            const bool before = ny < y || (ny == y && nx < x);
            if (before ? heat.at(joint, ny, nx) >= value : heat.at(joint, ny, nx) > value) return false;
        }
    }
    return true;
}

Peak refined_peak(const Tensor& heat, int joint, int x, int y) {
    const float value = heat.at(joint, y, x);
    Peak peak{joint, static_cast<float>(x), static_cast<float>(y), std::min(value, 1.0f)};
    if (x > 0 && x + 1 < heat.width())
        peak.x += parabola_top(heat.at(joint, y, x - 1), value, heat.at(joint, y, x + 1));
    if (y > 0 && y + 1 < heat.height())
        peak.y += parabola_top(heat.at(joint, y - 1, x), value, heat.at(joint, y + 1, x));
    return peak;
}

std::vector<Peak> find_peaks(const Tensor& heat, int joint, const OpenPoseDecoding& decoding) {
    std::vector<Peak> peaks;
    for (int y = 0; y < heat.height(); ++y) {
        for (int x = 0; x < heat.width(); ++x) {
            if (heat.at(joint, y, x) < decoding.peak_threshold || !is_peak(heat, joint, x, y)) continue;
            peaks.push_back(refined_peak(heat, joint, x, y));
        }
    }
    std::stable_sort(peaks.begin(), peaks.end(),
                     [](const Peak& a, const Peak& b) { return a.certainty > b.certainty; });
    if (peaks.size() > static_cast<std::size_t>(decoding.peaks_per_joint)) peaks.resize(decoding.peaks_per_joint);
    return peaks;
}

/// Bilinear, with the border repeated.
float sample(const Tensor& field, int channel, float x, float y) {
    x = std::clamp(x, 0.0f, static_cast<float>(field.width() - 1));
    y = std::clamp(y, 0.0f, static_cast<float>(field.height() - 1));
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, field.width() - 1), y1 = std::min(y0 + 1, field.height() - 1);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const float above = (1 - fx) * field.at(channel, y0, x0) + fx * field.at(channel, y0, x1);
    const float below = (1 - fx) * field.at(channel, y1, x0) + fx * field.at(channel, y1, x1);
    return (1 - fy) * above + fy * below;
}

/// Mean of the field along the line between two joints (eq. 10 and 11 of Cao et al.); nothing if too few points agree.
std::optional<float> link_score(const Tensor& paf, int channel, const Peak& from, const Peak& to,
                                const OpenPoseDecoding& decoding) {
    const float dx = to.x - from.x, dy = to.y - from.y, length = std::hypot(dx, dy);
    if (length == 0) return std::nullopt;
    float sum = 0;
    int agreeing = 0;
    for (int i = 0; i < decoding.link_samples; ++i) {
        const float t = (static_cast<float>(i) + 0.5f) / static_cast<float>(decoding.link_samples);
        const float x = from.x + t * dx, y = from.y + t * dy;
        const float along = (sample(paf, channel, x, y) * dx + sample(paf, channel + 1, x, y) * dy) / length;
        sum += along;
        if (along >= decoding.sample_threshold) ++agreeing;
    }
    const auto samples = static_cast<float>(decoding.link_samples);
    if (static_cast<float>(agreeing) < decoding.agreeing_share * samples) return std::nullopt;
    const float longest = decoding.longest_limb * static_cast<float>(std::max(paf.width(), paf.height()));
    return sum / samples + std::min(longest / length - 1, 0.0f);
}

/// All links that the fields support, best first.
std::vector<Link> find_links(const Tensor& paf, const std::vector<Peak>& peaks, const OpenPoseDecoding& decoding) {
    std::vector<Link> links;
    const int count = static_cast<int>(peaks.size());
    for (int limb = 0; limb < kLimbCount; ++limb) {
        for (int from = 0; from < count; ++from) {
            if (peaks[from].joint != kPafLimbs[limb].from) continue;
            for (int to = 0; to < count; ++to) {
                if (peaks[to].joint != kPafLimbs[limb].to) continue;
                const auto score = link_score(paf, kPafLimbs[limb].channel, peaks[from], peaks[to], decoding);
                if (score && *score >= decoding.sample_threshold) links.push_back({limb, from, to, *score});
            }
        }
    }
    std::stable_sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.score > b.score; });
    return links;
}

/// Which peaks are of one body: disjoint sets, each with at most one peak per joint.
class Bodies {
public:
    explicit Bodies(const std::vector<Peak>& peaks)
        : parent_(peaks.size()), joints_(peaks.size()), used_(peaks.size()) {
        std::iota(parent_.begin(), parent_.end(), 0);
        for (std::size_t i = 0; i < peaks.size(); ++i) joints_[i].set(peaks[i].joint);
    }

    /// Adds the link unless one of its ends has such a link already or the merged body would have a joint twice.
    bool join(const Link& link) {
        if (used_[link.from][link.limb] || used_[link.to][link.limb]) return false;
        const int a = body_of(link.from), b = body_of(link.to);
        if (a != b && (joints_[a] & joints_[b]).any()) return false;
        parent_[b] = a;
        joints_[a] |= joints_[b];
        used_[link.from].set(link.limb);
        used_[link.to].set(link.limb);
        return true;
    }

    [[nodiscard]] int body_of(int peak) const {
        while (parent_[peak] != peak) peak = parent_[peak];
        return peak;
    }

private:
    std::vector<int> parent_;
    std::vector<std::bitset<kJointCount>> joints_;
    std::vector<std::bitset<kLimbCount>> used_;
};

/// Cells to pixels of the colour image, centre to centre.
struct OpenPoseScale {
    float u = 1, v = 1;
    [[nodiscard]] JointObservation joint(const Peak& peak) const {
        return {(peak.x + 0.5f) * u - 0.5f, (peak.y + 0.5f) * v - 0.5f, peak.certainty};
    }
};

/// A body and the scores of its links, best first.
struct Candidate {
    Person person;
    std::vector<float> links;
};

std::vector<Candidate> assemble(const std::vector<Peak>& peaks, const std::vector<Link>& links, OpenPoseScale scale) {
    Bodies bodies(peaks);
    std::vector<Link> taken;
    std::copy_if(links.begin(), links.end(), std::back_inserter(taken),
                 [&](const Link& link) { return bodies.join(link); });

    std::vector<Candidate> candidates(peaks.size());  // indexed by the peak that stands for the body
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        candidates[bodies.body_of(static_cast<int>(i))].person.joints[peaks[i].joint] = scale.joint(peaks[i]);
    }
    for (const Link& link : taken) candidates[bodies.body_of(link.from)].links.push_back(link.score);
    std::erase_if(candidates, [](const Candidate& candidate) { return candidate.links.empty(); });
    return candidates;
}

float mean_of_best_links(const std::vector<float>& links, int count) {
    const auto taken = std::min<std::ptrdiff_t>(count, static_cast<std::ptrdiff_t>(links.size()));
    return std::min(std::accumulate(links.begin(), links.begin() + taken, 0.0f) / static_cast<float>(count), 1.0f);
}

}  // namespace

OpenPoseMaps openpose_maps(std::vector<Tensor> outputs) {
    std::string found;
    Tensor *heat = nullptr, *paf = nullptr;
    for (Tensor& output : outputs) {
        if (!output.is_map_stack()) continue;
        if (output.channels() == kHeatChannels + kPafChannels) return split_concatenated(output);
        if (output.channels() == kHeatChannels) heat = &output;
        if (output.channels() == kPafChannels) paf = &output;
        found += (found.empty() ? "" : ", ") + std::to_string(output.channels());
    }
    if (!heat || !paf || heat->width() != paf->width() || heat->height() != paf->height()) {
        throw Error("the network is not an OpenPose network of 18 joints: its outputs have " +
                    (found.empty() ? std::string("no") : found) + " maps, 19 and 38 or 57 are expected");
    }
    return {std::move(*heat), std::move(*paf)};
}

People decode_openpose(const OpenPoseMaps& maps, int image_width, int image_height, const OpenPoseDecoding& decoding) {
    std::vector<Peak> peaks;
    for (int joint = 0; joint < kJointCount; ++joint) {
        const std::vector<Peak> found = find_peaks(maps.heat, joint, decoding);
        peaks.insert(peaks.end(), found.begin(), found.end());
    }
    const OpenPoseScale scale{static_cast<float>(image_width) / static_cast<float>(maps.heat.width()),
                              static_cast<float>(image_height) / static_cast<float>(maps.heat.height())};
    People people;
    for (auto& [person, links] : assemble(peaks, find_links(maps.paf, peaks, decoding), scale)) {
        person.score = std::sqrt(mean_certainty_of_best_joints(person, decoding.score_joints) *
                                 mean_of_best_links(links, decoding.score_joints - 1));
        drop_joints_below(person, decoding.joint_threshold);
        person.box = box_of_joints(person);
        const bool believed = person.score >= decoding.person_threshold && joints_found(person) >= decoding.min_joints;
        if (believed) people.push_back(person);
    }
    return best_people(std::move(people), decoding.duplicate);
}

}  // namespace posefusion
