#include "hosts/config/option_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/nearest_name.hpp"
#include "engine/core/number_text.hpp"

namespace posefusion {
namespace {

[[noreturn]] void refuse(const std::string& text, const std::string& allowed) {
    throw Error("'" + text + "' is not allowed here; give " + allowed);
}

template <class Number>
struct Range {
    Number least, most;
    [[nodiscard]] std::string words(const std::string& unit) const {
        return shortest_text(least) + " .. " + shortest_text(most) + (unit.empty() ? "" : " " + unit);
    }
    [[nodiscard]] Number read(std::string_view text, const std::string& unit) const {
        const std::optional<Number> value = number_of<Number>(text);
        bool good = value.has_value();
        if constexpr (std::is_floating_point_v<Number>) good = good && std::isfinite(*value);
        if (!good || *value < least || *value > most) {
            const char* kind = std::is_integral_v<Number> ? "a whole number, " : "a number, ";
            refuse(std::string(text), kind + words(unit));
        }
        return *value;
    }
};

template <class Number>
Option number(std::string key, std::string unit, std::string help, Number& field, std::type_identity_t<Number> least,
              std::type_identity_t<Number> most) {
    const Range<Number> range{least, most};
    return {std::move(key),
            Option::Kind::Number,
            unit,
            std::move(help),
            range.words(""),
            [&field] { return shortest_text(field); },
            [&field, range, unit](const std::string& text) { field = range.read(text, unit); }};
}

Option on_off(std::string key, std::string help, bool& field) {
    const std::string allowed = "true | false";
    return {std::move(key),
            Option::Kind::Switch,
            "",
            std::move(help),
            allowed,
            [&field] { return field ? "true" : "false"; },
            [&field, allowed](const std::string& text) {
                if (text != "true" && text != "false") refuse(text, allowed);
                field = text == "true";
            }};
}

template <class Text>  // std::string or std::filesystem::path
Option text(std::string key, std::string allowed, std::string help, Text& field) {
    return {std::move(key),
            Option::Kind::Text,
            "",
            std::move(help),
            std::move(allowed),
            [&field] {
                if constexpr (std::is_same_v<Text, std::string>)
                    return field;
                else
                    return field.string();
            },
            [&field](const std::string& value) { field = value; }};
}

template <class Enum>
Option choice(std::string key, std::string help, Enum& field, std::vector<std::pair<std::string, Enum>> names) {
    std::string allowed;
    for (const auto& [name, value] : names) allowed += (allowed.empty() ? "" : " | ") + name;
    return {
        std::move(key),
        Option::Kind::Choice,
        "",
        std::move(help),
        allowed,
        [&field, names] {
            return std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.second == field; })->first;
        },
        [&field, names, allowed](const std::string& text) {
            const auto found = std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.first == text; });
            if (found == names.end()) refuse(text, allowed);
            field = found->second;
        }};
}

Option frame_start(std::string key, std::string help, FrameStart& field) {
    return {std::move(key),
            Option::Kind::Text,
            "",
            std::move(help),
            "a frame | seconds, as 1.5s",
            [&field] { return text_of(field); },
            [&field](const std::string& text) { field = parse_frame_start(text); }};
}

/// Parses whole numbers separated by commas, such as 10,5,4; empty for none.
std::vector<int> read_list(const std::string& text, const Range<int>& range) {
    std::vector<int> values;
    for (std::size_t begin = 0; !text.empty() && begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        values.push_back(range.read(std::string_view(text).substr(begin, end - begin), ""));
        begin = end + 1;
    }
    return values;
}

std::string list_text(std::span<const int> values) {
    std::string joined;
    for (const int value : values) joined += (joined.empty() ? "" : ",") + shortest_text(value);
    return joined;
}

/// A fixed number of whole numbers.
template <std::size_t N>
Option list(std::string key, std::string unit, std::string help, int (&field)[N], int least, int most) {
    const Range<int> range{least, most};
    const std::string allowed = shortest_text(N) + " whole numbers a,b,..., each " + range.words("");
    return {std::move(key),
            Option::Kind::List,
            unit,
            std::move(help),
            allowed,
            [&field] { return list_text(field); },
            [&field, range, allowed](const std::string& text) {
                const std::vector<int> values = read_list(text, range);
                if (values.size() != N) refuse(text, allowed);
                std::copy(values.begin(), values.end(), field);
            }};
}

/// Any number of whole numbers.
Option list(std::string key, std::string unit, std::string help, std::vector<int>& field, int least, int most) {
    const Range<int> range{least, most};
    return {std::move(key),
            Option::Kind::List,
            std::move(unit),
            std::move(help),
            "whole numbers a,b,..., each " + range.words(""),
            [&field] { return list_text(field); },
            [&field, range](const std::string& text) { field = read_list(text, range); }};
}

using Section = OptionSection;

class Table {
public:
    /// Adds an option that `--help` shows.
    void basic(Section section, Option option) {
        option.section = section;
        options_.push_back(std::move(option));
    }
    /// Adds an option that only `--help-all` shows.
    void advanced(Option option) { basic(Section::Advanced, std::move(option)); }

    [[nodiscard]] std::vector<Option> take() { return std::move(options_); }

private:
    std::vector<Option> options_;
};

void add_run_options(Table& table, RunConfig& c) {
    table.basic(Section::Output,
                text("out", "a folder",
                     "folder for the results; made if missing, results of an earlier run in it are replaced", c.out));
    table.basic(Section::Input,
                frame_start("start", "first frame that is used; the first of the recording is 0", c.selection.start));
    table.basic(Section::Input, number("every", "frames", "use every n-th frame of the recording only",
                                       c.selection.every, 1u, 1'000'000u));
    table.basic(Section::Input,
                number("max_frames", "frames", "number of frames to process; 0 = all", c.max_frames, 0, 100'000'000));
    table.basic(Section::Masking,
                on_off("no_people", "no pose network: people are left out only while they move", c.no_people));
    table.basic(Section::Masking, on_off("no_motion", "leave people out only, not whatever else moves", c.no_motion));
    table.advanced(
        on_off("objects",
               "give rigid things that move a model and a trajectory of their own: objects/N/trajectory.txt, "
               "objects/N/map.ply",
               c.objects));
    table.basic(Section::Loops,
                on_off("no_loops", "do not close loops: the trajectory is that of tracking alone", c.no_loops));
    table.basic(Section::Masking, text("masks", "a folder",
                                       "folder of label images STAMP.png (0 static, 1..n person) to use instead of the "
                                       "pose network",
                                       c.masks));
    table.basic(Section::Masking,
                text("mask_network", "a file",
                     "instance segmentation network (.onnx, Mask R-CNN as exported by torchvision) to "
                     "use instead of the pose network",
                     c.mask_network));
    table.advanced(number("mask_threshold", "", "--mask-network: detections with a lower score are ignored",
                          c.mask_threshold, 0, 1));
    table.basic(Section::Masking,
                list("classes", "",
                     "label values that are people: in --masks (empty = all but 0), from --mask-network (empty = 1)",
                     c.classes, 0, 65535));
    table.basic(
        Section::Output,
        on_off("save_masks", "write masks/STAMP.png, named by the colour stamp (0 static, 1..n person)", c.save_masks));
    table.advanced(on_off("final_adjust",
                          "at the end of a recording, bundle adjustment of keyframes corrects trajectory and map",
                          c.final_adjust));
    table.advanced(on_off("save_background",
                          "write background/, a recording of what the camera would have seen without people: the map "
                          "from the pose of each frame",
                          c.save_background));
    table.basic(Section::Device,
                text("device", "name or index",
                     "Vulkan device, as listed by `posefusion devices`; empty = the best one", c.device));
    table.basic(
        Section::Input,
        text("camera", "a file",
             "camera.yaml (fx fy cx cy width height depth_scale) to use instead of the recording's own", c.camera));
    table.basic(Section::Input,
                text("associations", "a file",
                     "list of image pairs (stamp path stamp path) to use instead of the folder's own", c.associations));
    table.basic(Section::Input,
                text("color_topic", "a topic", "topic of the colour images in a bag; empty = the most likely one",
                     c.color_topic));
    table.basic(Section::Input, text("depth_topic", "a topic",
                                     "topic of the depth images in a bag; empty = the most likely one", c.depth_topic));
    table.advanced(choice("time_unit", "unit of time stamps in lists and file names that do not tell it themselves",
                          c.time_unit,
                          {{"auto", std::nullopt},
                           {"s", TimeUnit::Seconds},
                           {"ms", TimeUnit::Milliseconds},
                           {"us", TimeUnit::Microseconds},
                           {"ns", TimeUnit::Nanoseconds}}));
    table.advanced(on_off("flip_colors", "swap red and blue of a .klg log", c.flip_colors));
    table.basic(Section::Input,
                number("scale", "", "shrink images and intrinsics by this factor first", c.scale, 0.05f, 1.0f));
    table.basic(Section::Output, on_off("all_surfels", "write unstable surfels to map.ply as well", c.all_surfels));
    table.advanced(on_off("sequential",
                          "run the stages one after the other instead of in parallel; the results are the same",
                          c.sequential));
    table.advanced(on_off(
        "sparse_start", "find the motion of the camera by features, too: tracking starts from it where steps are large",
        c.features.sparse_start));
    table.basic(Section::Input,
                on_off("real_time",
                       "play a recording at its recorded rate, as a camera always does; frames that arrive while the "
                       "pipeline is busy are dropped and counted",
                       c.real_time));
    table.basic(Section::Output, on_off("report", "write report.html", c.report));
    table.basic(Section::Maps, text("save_map", "a file",
                                    "write the complete map to this file at the end, for --load-map", c.save_map));
    table.basic(
        Section::Maps,
        text("load_map", "a file",
             "start from a map written by --save-map: nothing is fused until the camera has been localised in it",
             c.load_map));
    table.basic(Section::Maps, on_off("localise_only", "with --load-map: track the camera and leave the map unchanged",
                                      c.localise_only));
    table.basic(Section::Maps,
                number("checkpoint_every", "frames", "write OUT/checkpoint.bin at this interval; 0 = never",
                       c.checkpoint_every, 0, 100'000'000));
    table.basic(
        Section::Maps,
        on_off("resume", "continue from OUT/checkpoint.bin; the results are those of an uninterrupted run", c.resume));
}

void add_pose_options(Table& table, RunConfig& run) {
    PoseConfig& c = run.pose;
    table.basic(Section::Masking,
                choice("rotate",
                       "degrees by which images are rotated clockwise for the network, which finds people who are "
                       "upright in the image; auto = as people are seen best",
                       c.rotate,
                       {{"auto", std::nullopt},
                        {"0", ImageRotation::None},
                        {"90", ImageRotation::Clockwise90},
                        {"180", ImageRotation::Half},
                        {"270", ImageRotation::Clockwise270}}));
    table.advanced(choice("pose.runtime", "library that runs the network", c.runtime,
                          {{"onnxruntime", PoseRuntime::OnnxRuntime}, {"opencv", PoseRuntime::OpenCvDnn}}));
    table.basic(
        Section::Masking,
        choice("pose.network", "kind of pose network: MoveNet MultiPose, or OpenPose (18 joints, part affinity fields)",
               c.network, {{"movenet", PoseNetwork::MoveNet}, {"openpose", PoseNetwork::OpenPose}}));
    table.basic(Section::Masking,
                text("pose.model", "a file",
                     "network file: .onnx, or .caffemodel with --pose-runtime opencv; empty = the one "
                     "installed by tools/setup",
                     c.model));
    table.advanced(text("pose.prototxt", "a file", "network description that belongs to a .caffemodel", c.prototxt));
    table.basic(Section::Masking,
                number("pose.every", "frames", "run the network on every n-th frame; in between, masks are carried on",
                       run.pose_every, 1, 1000));
    table.advanced(number("pose.input_long_side", "px",
                          "long side to which the image is scaled for the network; 0 = the network's usual size",
                          c.input_long_side, 0, 2048));
    table.advanced(choice(
        "pose.openpose_pixels",
        "pixel values an OpenPose network expects: 0 .. 255 or -0.5 .. 0.5; auto = centred for .caffemodel, else bytes",
        c.openpose_pixels,
        {{"auto", OpenPosePixels::Auto}, {"bytes", OpenPosePixels::Bytes}, {"centred", OpenPosePixels::Centred}}));
    table.basic(Section::Masking,
                number("pose.person_threshold", "", "people with a lower score are ignored", c.person_threshold, 0, 1));
    table.advanced(
        number("pose.joint_threshold", "", "joints with a lower score are ignored", c.joint_threshold, 0, 1));
    table.advanced(number("pose.threads", "threads", "CPU threads of the network", c.threads, 1, 256));
}

void add_segmentation_options(Table& table, SegmentationConfig& c) {
    table.basic(
        Section::Masking,
        choice("segmentation.mode",
               "min-cut on the image grid, or eq. (2) and (3) of the paper to the letter on a point cloud (slow)",
               c.mode, {{"image", SegmentationMode::Image}, {"paper", SegmentationMode::Paper}}));
    table.basic(Section::Masking,
                number("segmentation.radius", "m",
                       "eq. (3): distance from the skeleton at which background wins; a smaller one cuts less",
                       c.radius, 0.01f, 5));
    table.basic(
        Section::Masking,
        number("segmentation.reach", "m",
               "image mode: things that move with a person and touch them (carried, pushed) are cut as well, up "
               "to this distance from the body; 0 = people alone",
               c.reach, 0, 10));
    table.advanced(number("segmentation.sigma", "m", "eq. (2): length over which neighbours are held together", c.sigma,
                          0.001f, 10));
    table.advanced(number("segmentation.paper_step", "px",
                          "paper mode: the point cloud takes every n-th pixel in each direction", c.paper_step, 1, 64));
    table.advanced(number("segmentation.carry_frames", "frames",
                          "how long a mask is kept when the network misses a person", c.carry_frames, 0, 10'000));
}

void add_feature_options(Table& table, FeatureConfig& c) {
    table.advanced(number("features.count", "", "most features per frame", c.count, 50, 5000));
}

void add_preprocess_options(Table& table, PreprocessConfig& c, DepthNoise& n) {
    table.advanced(number("preprocess.depth_min", "m", "nearer depth is ignored", c.depth_min, 0, 100));
    table.basic(Section::Tracking,
                number("preprocess.depth_max", "m", "farther depth is ignored", c.depth_max, 0.1f, 100));
    table.advanced(number("preprocess.bilateral_radius", "px", "window radius of the bilateral depth filter",
                          c.bilateral_radius, 0, 16));
    table.basic(Section::Masking,
                number("preprocess.mask_dilation", "px",
                       "dilation of the people's masks, in pixels of an image 640 wide", c.mask_dilation, 0, 100));

    table.advanced(number("noise.a", "m", "standard deviation of depth z: a + b (z - c)^2", n.a, 0, 1));
    table.advanced(number("noise.b", "1/m", "standard deviation of depth z: a + b (z - c)^2", n.b, 0, 1));
    table.advanced(number("noise.c", "m", "standard deviation of depth z: a + b (z - c)^2", n.c, 0, 100));
    table.advanced(number("noise.lateral", "px",
                          "standard deviation across the line of sight, in pixels of an image 640 wide", n.lateral, 0,
                          100));
    table.advanced(number("noise.floor", "m", "calibration error that averaging does not remove", n.floor, 0, 1));
}

void add_shutter_options(Table& table, RunConfig& config) {
    ShutterConfig& c = config.slam.shutter;
    table.basic(
        Section::Tracking,
        choice("sensor.timing",
               "rolling shutter and delay of depth: found in the first frames of a recording (auto), or as given",
               config.sensor_timing, {{"auto", SensorTimingMode::Auto}, {"given", SensorTimingMode::Given}}));
    table.advanced(choice("sensor.calibration",
                          "calibration of the camera: corrected by the first frames of a recording (auto), or as given",
                          config.sensor_calibration,
                          {{"auto", SensorCalibrationMode::Auto}, {"given", SensorCalibrationMode::Given}}));
    table.basic(Section::Tracking, number("sensor.color_readout_ms", "ms",
                                          "rolling shutter: time from the first row of a colour image to its last",
                                          c.color_readout_ms, 0, 200));
    table.advanced(number("sensor.depth_readout_ms", "ms", "the same of a depth image", c.depth_readout_ms, 0, 200));
    table.advanced(number("sensor.stamp_row", "", "what a time stamp is the time of: 0 first row, 0.5 middle, 1 last",
                          c.stamp_row, 0, 1));
    table.advanced(number("sensor.depth_delay_ms", "ms",
                          "depth is taken so much later than its time stamp says, compared to colour", c.depth_delay_ms,
                          -20, 20));
}

void add_tracking_options(Table& table, TrackingConfig& c) {
    table.basic(Section::Tracking, list("tracking.iterations", "steps",
                                        "maximum number of Gauss-Newton steps at full, half and quarter resolution",
                                        c.iterations, 0, 1000));
    table.advanced(number("tracking.full_resolution_step", "pixels", "at full resolution every n-th pixel is used",
                          c.full_resolution_step, 1, 2));
    table.advanced(number("tracking.so3_iterations", "steps",
                          "maximum number of steps of the rotation-only pre-alignment; 0 = off", c.so3_iterations, 0,
                          1000));
    table.advanced(on_off("tracking.icp", "use the geometric (point-to-plane) term", c.icp));
    table.advanced(on_off("tracking.photometric", "use the photometric term", c.photometric));
    table.advanced(number("tracking.icp_max_distance", "m", "maximum distance of associated points", c.icp_max_distance,
                          0.001f, 10));
    table.advanced(
        number("tracking.icp_robust", "sigma", "Cauchy scale of the geometric residual", c.icp_robust, 0.1f, 1000));
    table.advanced(number("tracking.photometric_weight", "",
                          "weight of the photometric term relative to its statistical weight", c.photometric_weight, 0,
                          1000));
    table.advanced(number("tracking.min_inlier_ratio", "",
                          "tracking fails, and the pose is held, with fewer inliers among the pixels with static depth",
                          c.min_inlier_ratio, 0, 1));
    table.advanced(number("tracking.max_icp_rmse", "m", "tracking fails above this RMS point-to-plane distance",
                          c.max_icp_rmse, 0.001f, 100));
    table.advanced(number("tracking.max_translation_sigma", "m",
                          "tracking fails above this standard deviation of the position", c.max_translation_sigma,
                          1e-5f, 100));
    table.advanced(number("tracking.max_rotation_sigma", "rad",
                          "tracking fails above this standard deviation of the orientation", c.max_rotation_sigma,
                          1e-5f, 100));
    table.advanced(number("tracking.max_translation", "m", "tracking fails above this translation per frame",
                          c.max_translation, 0.001f, 100));
    table.advanced(number("tracking.max_rotation_deg", "deg", "tracking fails above this rotation per frame",
                          c.max_rotation_deg, 0.1f, 180));
}

void add_map_options(Table& table, MapConfig& c) {
    table.advanced(
        number("map.index_map_scale", "", "cells of the index map per pixel and axis", c.index_map_scale, 1, 8));
    table.advanced(number("map.association_depth", "m",
                          "maximum distance along the ray between a pixel and the surfel it is fused into ...",
                          c.association_depth, 0.001f, 10));
    table.advanced(number("map.association_sigmas", "sigma",
                          "... or this many standard deviations of the depth noise, whichever is larger",
                          c.association_sigmas, 0, 100));
    table.basic(Section::Tracking, number("map.stable_confidence", "", "surfels are stable from this confidence on",
                                          c.stable_confidence, 0, 1e6f));
    table.advanced(number("map.predict_confidence", "",
                          "surfels with less confidence are not part of the predicted model", c.predict_confidence, 0,
                          1e6f));
    table.advanced(number("map.max_weight", "",
                          "limit on the weight of a surfel's running means, in observations at 1 m", c.max_weight, 1,
                          1e6f));
    table.advanced(
        number("map.free_space_margin", "m",
               "a surfel loses confidence when static depth is seen this far behind it, or farther where depth is "
               "noisier",
               c.free_space_margin, 0, 10));
    table.advanced(number("map.free_space_decay", "", "factor on the confidence of such a surfel, per frame",
                          c.free_space_decay, 0, 1));
    table.advanced(number("map.duplicate_spacing", "radii",
                          "of two stable surfels of one surface that are closer than this, one is removed; 0 = off",
                          c.duplicate_spacing, 0, 10));
    table.advanced(number("map.initial_capacity", "surfels", "capacity of the map at the start; it doubles when full",
                          c.initial_capacity, 1024u, 1u << 30));
    table.basic(Section::Tracking, number("map.max_capacity", "surfels", "the run ends when the map would grow larger",
                                          c.max_capacity, 1024u, 1u << 30));
}

void add_loop_options(Table& table, SlamConfig& slam) {
    LoopConfig& c = slam.loops;
    table.advanced(number("loops.time_window", "frames",
                          "surfels not seen for this long are inactive: loops are closed with them", c.time_window, 10,
                          1'000'000));
    table.advanced(number("loops.patience", "frames", "a loop waits at most this long for a better view", c.patience, 0,
                          1'000'000));
    table.advanced(number("loops.max_drift", "m/m",
                          "largest correction that counts as drift: this much per metre travelled since ...",
                          c.max_drift, 0, 100));
    table.advanced(number("loops.max_drift_at_rest", "m",
                          "... plus this; a larger one is taken for another place that looks alike",
                          c.max_drift_at_rest, 0, 1000));
    table.advanced(
        number("loops.ferns", "", "ferns (binary tests) that a view is encoded by", c.ferns.ferns, 10, 100'000));
    table.advanced(number("loops.fern_seed", "", "seed of the random ferns", c.ferns.seed, 0u, 4'000'000'000u));
    table.advanced(number("loops.query_similarity", "", "minimum share of equal ferns for a keyframe to be tried",
                          c.ferns.query_similarity, 0, 1));

    AlignmentConfig& a = slam.alignment;
    table.advanced(number("alignment.min_inlier_ratio", "",
                          "an alignment with a keyframe or old surfels needs this share of inliers in the overlap",
                          a.min_inlier_ratio, 0, 1));
    table.advanced(number("alignment.max_icp_rmse", "m", "maximum RMS point-to-plane distance of an alignment",
                          a.max_icp_rmse, 0, 10));
    table.advanced(number("alignment.max_photometric_rmse", "",
                          "maximum RMS intensity difference (intensity 0 .. 1) of an alignment", a.max_photometric_rmse,
                          0, 1));

    RelocalisationConfig& r = slam.relocalisation;
    table.advanced(
        on_off("relocalisation.enabled", "after tracking was lost, find the camera by place recognition", r.enabled));
    table.advanced(number("relocalisation.lost_after", "frames",
                          "the camera counts as lost after this many frames without tracking", r.lost_after, 1,
                          1'000'000));
    table.advanced(number("relocalisation.proposals", "",
                          "keyframes tried, one per frame, between two attempts at the last known pose", r.proposals, 0,
                          1000));

    table.advanced(number("pieces.begin_after", "frames",
                          "a new piece of map begins after this many frames without tracking; 0: never",
                          slam.pieces.begin_after, 0, 1'000'000));

    DeformationConfig& d = slam.deformation;
    table.advanced(number("deformation.node_spacing", "m", "distance of neighbouring nodes of the deformation graph",
                          d.node_spacing, 0.01f, 100));
}

void add_engine_options(Table& table, SlamConfig& c) {
    table.advanced(on_off("engine.int64_atomics",
                          "use 64-bit atomics where the device has them, else two 32-bit passes", c.int64_atomics));
    table.advanced(
        on_off("engine.validation", "run with Vulkan's core and synchronisation validation (slow)", c.validation));
}

}  // namespace

std::string Option::flag() const {
    std::string text = "--" + key;
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '.' || c == '_'; }, '-');
    return text;
}

std::string Option::group() const {
    const std::size_t dot = key.find('.');
    return dot == std::string::npos ? "" : key.substr(0, dot);
}

std::string Option::heading() const {
    switch (section) {
        case OptionSection::Input:
            return "Recording";
        case OptionSection::Output:
            return "Results";
        case OptionSection::Maps:
            return "Maps and checkpoints";
        case OptionSection::Masking:
            return "People";
        case OptionSection::Tracking:
            return "Depth, tracking and map";
        case OptionSection::Loops:
            return "Loops and lost cameras";
        case OptionSection::Device:
            return "Device and threads";
        case OptionSection::Advanced:
            return "Advanced: " + (group().empty() ? "run" : group());
    }
    return "";
}

std::string Option::name() const {
    const std::size_t dot = key.find('.');
    return dot == std::string::npos ? key : key.substr(dot + 1);
}

std::vector<Option> option_table(RunConfig& config) {
    Table table;
    add_run_options(table, config);
    add_pose_options(table, config);
    add_segmentation_options(table, config.segmentation);
    add_feature_options(table, config.features);
    add_preprocess_options(table, config.slam.preprocess, config.slam.noise);
    add_shutter_options(table, config);
    add_tracking_options(table, config.slam.tracking);
    add_map_options(table, config.slam.map);
    add_loop_options(table, config.slam);
    add_engine_options(table, config.slam);
    return table.take();
}

const Option& find_option(const std::vector<Option>& options, std::string_view key) {
    const auto nearest = std::min_element(options.begin(), options.end(), [&](const Option& a, const Option& b) {
        return edit_distance(a.key, key) < edit_distance(b.key, key);
    });
    if (nearest->key == key) return *nearest;
    throw Error("unknown option '" + std::string(key) + "'; the nearest is '" + nearest->key +
                "', `posefusion run --help-all` lists all");
}

std::vector<Option> in_help_order(std::vector<Option> options) {
    std::stable_sort(options.begin(), options.end(),
                     [](const Option& a, const Option& b) { return a.section < b.section; });
    return options;
}

std::string option_table_markdown(const std::vector<Option>& options) {
    const auto cell = [](std::string value) {
        for (std::size_t at = 0; (at = value.find('|', at)) != std::string::npos; at += 2) value.insert(at, "\\");
        return value;
    };
    std::string table, heading;
    for (const Option& option : in_help_order(options)) {
        if (option.heading() != heading) {
            table +=
                (heading.empty() ? "### " : "\n### ") + option.heading() +
                "\n\n| option | key in the file | default | unit | values | meaning |\n|---|---|---|---|---|---|\n";
            heading = option.heading();
        }
        table += "| `" + option.flag() + "` | `" + option.key + "` | " + option.get() + " | " + option.unit + " | " +
                 cell(option.allowed) + " | " + cell(option.help) + " |\n";
    }
    return table;
}

}  // namespace posefusion
