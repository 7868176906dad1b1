#include "pose/movenet.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/error.hpp"
#include "pose/people.hpp"

namespace posefusion {
namespace {

constexpr int kCocoJoints = 17;

enum CocoJoint : int { CocoLeftShoulder = 5, CocoRightShoulder = 6 };

/// For each of our joints the COCO-17 joint; the neck, which COCO lacks, is the middle of the shoulders.
constexpr int kNoCocoJoint = -1;
constexpr std::array<int, kJointCount> kCocoOfJoint{0,  kNoCocoJoint, 6,  8,  10, 5, 7, 9, 12,
                                                    14, 16,           11, 13, 15, 2, 1, 4, 3};

struct Cell {
    int y = 0, x = 0;
};

/// A position or an extent in cells.
struct CellPoint {
    float y = 0, x = 0;
};

struct CellBox {
    CellPoint low, high;
};

/// The cells [first, end) whose positions are in [low, high).
struct CellRange {
    int first, end;
    CellRange(float low, float high)
        : first(static_cast<int>(std::ceil(low))), end(static_cast<int>(std::ceil(high))) {}
};

struct CellJoint {
    CellPoint position;
    float probability = 0;
};

float sigmoid(float value) { return 1.0f / (1.0f + std::exp(-value)); }

CellPoint pair_at(const Tensor& map, int pair, Cell cell) {
    return {map.at(2 * pair, cell.y, cell.x), map.at(2 * pair + 1, cell.y, cell.x)};
}

CellPoint shifted(Cell cell, CellPoint offset) {
    return {static_cast<float>(cell.y) + offset.y, static_cast<float>(cell.x) + offset.x};
}

/// Strict against cells before it, so that a plateau has one peak.
bool is_peak(const Tensor& map, Cell cell, int radius) {
    const float value = map.at(0, cell.y, cell.x);
    for (int y = std::max(0, cell.y - radius); y <= std::min(map.height() - 1, cell.y + radius); ++y) {
        for (int x = std::max(0, cell.x - radius); x <= std::min(map.width() - 1, cell.x + radius); ++x) {
            const bool before = y < cell.y || (y == cell.y && x < cell.x);
            if (before ? map.at(0, y, x) >= value : map.at(0, y, x) > value) return false;
        }
    }
    return true;
}

std::vector<Cell> find_centers(const Tensor& center, const MoveNetDecoding& decoding) {
    std::vector<Cell> cells;
    for (int y = 0; y < center.height(); ++y) {
        for (int x = 0; x < center.width(); ++x) {
            if (sigmoid(center.at(0, y, x)) < decoding.center_threshold) continue;
            if (is_peak(center, {y, x}, decoding.peak_window / 2)) cells.push_back({y, x});
        }
    }
    return cells;
}

CellBox box_at(const MoveNetMaps& maps, Cell cell) {
    const CellPoint middle = shifted(cell, pair_at(maps.box_offset, 0, cell));
    const CellPoint size = pair_at(maps.box_scale, 0, cell);
    const float half_height = std::max(size.y, 0.0f) / 2, half_width = std::max(size.x, 0.0f) / 2;
    const auto rows = static_cast<float>(maps.center.height()), columns = static_cast<float>(maps.center.width());
    return {{std::clamp(middle.y - half_height, 0.0f, rows), std::clamp(middle.x - half_width, 0.0f, columns)},
            {std::clamp(middle.y + half_height, 0.0f, rows), std::clamp(middle.x + half_width, 0.0f, columns)}};
}

/// Tolerance for the distance of joints from where the centre expects them, squared cells.
float joint_fade(const Tensor& heat, const CellBox& box, const MoveNetDecoding& decoding) {
    const float by_box = decoding.box_spread * std::hypot(box.high.y - box.low.y, box.high.x - box.low.x);
    return std::max(decoding.joint_spread * static_cast<float>(std::min(heat.height(), heat.width())), by_box * by_box);
}

/// The best cell of the heat map inside the person's box, near where the centre expects the joint.
CellJoint find_joint(const MoveNetMaps& maps, int joint, Cell center, const CellBox& box, float fade) {
    const Tensor& heat = maps.kpt_heatmap;
    const CellPoint expected = shifted(center, pair_at(maps.kpt_regress, joint, center));
    Cell best;
    float best_probability = 0;
    const CellRange rows(box.low.y, box.high.y), columns(box.low.x, box.high.x);
    for (int y = rows.first; y < rows.end; ++y) {
        for (int x = columns.first; x < columns.end; ++x) {
            const float dy = static_cast<float>(y) - expected.y, dx = static_cast<float>(x) - expected.x;
            const float probability = sigmoid(heat.at(joint, y, x)) * std::exp(-(dy * dy + dx * dx) / fade);
            if (probability > best_probability) {
                best_probability = probability;
                best = {y, x};
            }
        }
    }
    return {shifted(best, pair_at(maps.kpt_offset, joint, best)), best_probability};
}

/// The network counts from the corner of the image, we from the centre of the first pixel.
constexpr float kCornerToCentre = -0.5f;

/// Cells to pixels of the colour image.
struct MoveNetScale {
    float u = 1, v = 1;
    [[nodiscard]] JointObservation joint(const CellJoint& joint) const {
        return {joint.position.x * u + kCornerToCentre, joint.position.y * v + kCornerToCentre, joint.probability};
    }
    [[nodiscard]] PixelBox box(const CellBox& box) const {
        return {box.low.x * u + kCornerToCentre, box.low.y * v + kCornerToCentre, box.high.x * u + kCornerToCentre,
                box.high.y * v + kCornerToCentre};
    }
};

JointObservation neck_between(const JointObservation& left, const JointObservation& right) {
    return {(left.u + right.u) / 2, (left.v + right.v) / 2, std::min(left.p, right.p)};
}

Person decode_person(const MoveNetMaps& maps, Cell center, MoveNetScale scale, const MoveNetDecoding& decoding) {
    Person person;
    const CellBox box = box_at(maps, center);
    const float fade = joint_fade(maps.kpt_heatmap, box, decoding);
    person.box = scale.box(box);
    std::array<JointObservation, kCocoJoints> coco;
    for (int joint = 0; joint < kCocoJoints; ++joint) {
        coco[joint] = scale.joint(find_joint(maps, joint, center, box, fade));
    }
    for (int joint = 0; joint < kJointCount; ++joint) {
        const int source = kCocoOfJoint[joint];
        JointObservation& found = person.joints[joint];
        found = source == kNoCocoJoint ? neck_between(coco[CocoLeftShoulder], coco[CocoRightShoulder]) : coco[source];
    }
    person.score = std::sqrt(sigmoid(maps.center.at(0, center.y, center.x)) *
                             mean_certainty_of_best_joints(person, decoding.score_joints));
    drop_joints_below(person, decoding.joint_threshold);
    return person;
}

}  // namespace

const std::vector<std::string>& movenet_outputs() {
    static const std::vector<std::string> names{"center",      "box_scale",   "box_offset",
                                                "kpt_heatmap", "kpt_regress", "kpt_offset"};
    return names;
}

MoveNetMaps movenet_maps(std::vector<Tensor> outputs) {
    constexpr std::array<int, 6> kChannels{1, 2, 2, kCocoJoints, 2 * kCocoJoints, 2 * kCocoJoints};
    bool fits = outputs.size() == kChannels.size();
    for (std::size_t i = 0; fits && i < outputs.size(); ++i) {
        fits = outputs[i].is_map_stack() && outputs[i].channels() == kChannels[i] &&
               outputs[i].height() == outputs[0].height() && outputs[i].width() == outputs[0].width();
    }
    if (!fits)
        throw Error(
            "the outputs of the network are not those of MoveNet MultiPose: convert it with tools/convert_movenet");
    return {std::move(outputs[0]), std::move(outputs[1]), std::move(outputs[2]),
            std::move(outputs[3]), std::move(outputs[4]), std::move(outputs[5])};
}

People decode_movenet(const MoveNetMaps& maps, int image_width, int image_height, const MoveNetDecoding& decoding) {
    const MoveNetScale scale{static_cast<float>(image_width) / static_cast<float>(maps.center.width()),
                             static_cast<float>(image_height) / static_cast<float>(maps.center.height())};
    People people;
    for (const Cell center : find_centers(maps.center, decoding)) {
        Person person = decode_person(maps, center, scale, decoding);
        const bool believed = person.score >= decoding.person_threshold && joints_found(person) >= decoding.min_joints;
        if (believed) people.push_back(person);
    }
    return best_people(std::move(people), decoding.duplicate);
}

}  // namespace posefusion
