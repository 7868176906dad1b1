#include "hosts/config/option_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <type_traits>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

/// Shortest text that reads back as the same number, whatever the locale.
template <class Number>
std::string to_text(Number value) {
    char buffer[64];
    const auto result = std::to_chars(std::begin(buffer), std::end(buffer), value);
    return {buffer, result.ptr};
}

template <class Number>
bool parse(std::string_view text, Number& value) {
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

[[noreturn]] void refuse(const std::string& text, const std::string& allowed) {
    throw Error("'" + text + "' is not allowed here; give " + allowed);
}

template <class Number>
struct Range {
    Number least, most;
    [[nodiscard]] std::string words(const std::string& unit) const {
        return to_text(least) + " .. " + to_text(most) + (unit.empty() ? "" : " " + unit);
    }
    [[nodiscard]] Number read(std::string_view text, const std::string& unit) const {
        Number value{};
        bool good = parse(text, value);
        if constexpr (std::is_floating_point_v<Number>) good = good && std::isfinite(value);
        if (!good || value < least || value > most) {
            const char* kind = std::is_integral_v<Number> ? "a whole number, " : "a number, ";
            refuse(std::string(text), kind + words(unit));
        }
        return value;
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
            [&field] { return to_text(field); },
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

/// Whole numbers written 10,5,4; nothing for none.
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
    for (const int value : values) joined += (joined.empty() ? "" : ",") + to_text(value);
    return joined;
}

/// A fixed number of them.
template <std::size_t N>
Option list(std::string key, std::string unit, std::string help, int (&field)[N], int least, int most) {
    const Range<int> range{least, most};
    const std::string allowed = to_text(N) + " whole numbers a,b,..., each " + range.words("");
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

/// Any number of them.
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

void add_run_options(std::vector<Option>& table, RunConfig& c) {
    table.push_back(
        text("out", "a folder", "where the results go; made if missing, files of an earlier run are replaced", c.out));
    table.push_back(number("max_frames", "frames", "stop after so many; 0 = all", c.max_frames, 0, 100'000'000));
    table.push_back(on_off("no_people", "treat everything as static: no joints, no masks", c.no_people));
    table.push_back(on_off("no_loops", "close no loops: the trajectory is what tracking alone gives", c.no_loops));
    table.push_back(text("masks", "a folder",
                         "use the label images STAMP.png in it (0 static, 1..n person) instead of the network",
                         c.masks));
    table.push_back(text("mask_network", "a file",
                         "find people with this .onnx instance segmentation network (Mask R-CNN as torchvision exports "
                         "it) instead of joints",
                         c.mask_network));
    table.push_back(number("mask_threshold", "", "of mask_network: finds less certain than this are dropped",
                           c.mask_threshold, 0, 1));
    table.push_back(list("classes", "",
                         "label values that are people: of masks (empty = all but 0), of mask_network (empty = 1)",
                         c.classes, 0, 65535));
    table.push_back(
        on_off("save_masks", "write masks/STAMP.png, by colour time stamp (0 static, 1..n person)", c.save_masks));
    table.push_back(text("device", "name or index",
                         "Vulkan device, as listed by `posefusion devices`; empty = the best one", c.device));
    table.push_back(text("camera", "a file",
                         "camera.yaml (fx fy cx cy width height depth_scale) to use instead of the recording's own",
                         c.camera));
    table.push_back(text("associations", "a file",
                         "list of image pairs (stamp path stamp path) to use instead of the folder's own",
                         c.associations));
    table.push_back(
        text("color_topic", "a topic", "colour images of a bag; empty = the most likely topic", c.color_topic));
    table.push_back(
        text("depth_topic", "a topic", "depth images of a bag; empty = the most likely topic", c.depth_topic));
    table.push_back(on_off("flip_colors", "exchange red and blue of a .klg log", c.flip_colors));
    table.push_back(number("scale", "", "shrink images and camera by this factor first", c.scale, 0.05f, 1.0f));
    table.push_back(on_off("all_surfels", "write unstable surfels to map.ply, too", c.all_surfels));
    table.push_back(on_off("sequential", "run the stages one after the other instead of at the same time; same results",
                           c.sequential));
    table.push_back(on_off(
        "real_time",
        "play at the recorded rate, as a camera always does; frames that there is no time for are dropped, and counted",
        c.real_time));
    table.push_back(on_off("report", "write report.html", c.report));
    table.push_back(text("save_map", "a file", "write the whole map there at the end, for load_map", c.save_map));
    table.push_back(text(
        "load_map", "a file",
        "go on in the map that save_map wrote: the camera is found in it first, nothing is fused before", c.load_map));
    table.push_back(
        on_off("localise_only", "with load_map: follow the camera without changing the map", c.localise_only));
    table.push_back(number("checkpoint_every", "frames", "write OUT/checkpoint.bin every so often; 0 = never",
                           c.checkpoint_every, 0, 100'000'000));
    table.push_back(on_off(
        "resume", "go on from OUT/checkpoint.bin; ends with the results of a run that was not interrupted", c.resume));
}

void add_pose_options(std::vector<Option>& table, RunConfig& run) {
    PoseConfig& c = run.pose;
    table.push_back(choice("pose.runtime", "what runs the network", c.runtime,
                           {{"onnxruntime", PoseRuntime::OnnxRuntime}, {"opencv", PoseRuntime::OpenCvDnn}}));
    table.push_back(choice("pose.network", "kind of network: MoveNet MultiPose, or 18 joints with part affinity fields",
                           c.network, {{"movenet", PoseNetwork::MoveNet}, {"openpose", PoseNetwork::OpenPose}}));
    table.push_back(text("pose.model", "a file",
                         ".onnx, or .caffemodel with pose.runtime opencv; empty = the network installed by tools/setup",
                         c.model));
    table.push_back(text("pose.prototxt", "a file", "the description that belongs to a .caffemodel", c.prototxt));
    table.push_back(number("pose.every", "frames", "run the network on every n-th frame; masks are carried between",
                           run.pose_every, 1, 1000));
    table.push_back(number("pose.input_long_side", "px",
                           "the image is shrunk to this before the network; 0 = what suits the network",
                           c.input_long_side, 0, 2048));
    table.push_back(choice(
        "pose.openpose_pixels", "what an openpose network takes: 0..255, or -0.5..0.5 (auto: .caffemodel)",
        c.openpose_pixels,
        {{"auto", OpenPosePixels::Auto}, {"bytes", OpenPosePixels::Bytes}, {"centred", OpenPosePixels::Centred}}));
    table.push_back(
        number("pose.person_threshold", "", "people less certain than this are dropped", c.person_threshold, 0, 1));
    table.push_back(
        number("pose.joint_threshold", "", "joints less certain than this are dropped", c.joint_threshold, 0, 1));
    table.push_back(number("pose.threads", "threads", "CPU threads of the network", c.threads, 1, 256));
}

void add_segmentation_options(std::vector<Option>& table, SegmentationConfig& c) {
    table.push_back(choice("segmentation.mode",
                           "min-cut on the image grid, or eq. 2 and 3 of the paper to the letter (slow)", c.mode,
                           {{"image", SegmentationMode::Image}, {"paper", SegmentationMode::Paper}}));
    table.push_back(
        number("segmentation.sigma", "m", "paper mode, eq. 2: length scale of smoothness", c.sigma, 0.001f, 10));
    table.push_back(number("segmentation.radius", "m",
                           "paper mode, eq. 3: distance from the skeleton at which background wins", c.radius, 0.01f,
                           5));
    table.push_back(number("segmentation.paper_step", "px",
                           "paper mode: the cloud takes one point of so many pixels in each direction", c.paper_step, 1,
                           64));
    table.push_back(number("segmentation.carry_frames", "frames",
                           "image mode: how long a mask lives on when the network misses a person", c.carry_frames, 0,
                           10'000));
}

void add_preprocess_options(std::vector<Option>& table, PreprocessConfig& c, DepthNoise& n) {
    table.push_back(number("preprocess.depth_min", "m", "nearest depth used", c.depth_min, 0, 100));
    table.push_back(number("preprocess.depth_max", "m", "farthest depth used", c.depth_max, 0.1f, 100));
    table.push_back(
        number("preprocess.bilateral_radius", "px", "window radius of the depth filter", c.bilateral_radius, 0, 16));
    table.push_back(number("preprocess.bilateral_space", "px", "depth filter: standard deviation in the image",
                           c.bilateral_space, 0.1f, 100));
    table.push_back(number("preprocess.bilateral_range", "sigma",
                           "depth filter: standard deviation in depth, in those of the depth noise", c.bilateral_range,
                           0.1f, 100));
    table.push_back(number("preprocess.normal_radius", "px", "window radius of the plane fit, at half resolution",
                           c.normal_radius, 1, 16));
    table.push_back(number("preprocess.mask_dilation", "px", "people's masks grow by this, at 640 px image width",
                           c.mask_dilation, 0, 100));

    table.push_back(number("noise.a", "m", "standard deviation of the depth: a + b (z - c)^2", n.a, 0, 1));
    table.push_back(number("noise.b", "1/m", "standard deviation of the depth: a + b (z - c)^2", n.b, 0, 1));
    table.push_back(number("noise.c", "m", "standard deviation of the depth: a + b (z - c)^2", n.c, 0, 100));
    table.push_back(number("noise.lateral", "px", "standard deviation across the line of sight", n.lateral, 0, 100));
    table.push_back(number("noise.floor", "m", "calibration error that no averaging removes", n.floor, 0, 1));
}

void add_tracking_options(std::vector<Option>& table, TrackingConfig& c) {
    table.push_back(list("tracking.iterations", "steps", "most Gauss-Newton steps at full, half and quarter resolution",
                         c.iterations, 0, 1000));
    table.push_back(number("tracking.full_resolution_step", "pixels", "at full resolution every n-th pixel is used",
                           c.full_resolution_step, 1, 2));
    table.push_back(number("tracking.so3_iterations", "steps", "most steps of the rotation-only pre-alignment; 0 = off",
                           c.so3_iterations, 0, 1000));
    table.push_back(on_off("tracking.icp", "use the geometric term", c.icp));
    table.push_back(on_off("tracking.photometric", "use the photometric term", c.photometric));
    table.push_back(
        number("tracking.icp_max_distance", "m", "between associated points", c.icp_max_distance, 0.001f, 10));
    table.push_back(
        number("tracking.icp_max_angle_deg", "deg", "between associated normals", c.icp_max_angle_deg, 1, 90));
    table.push_back(
        number("tracking.icp_robust", "sigma", "Cauchy scale of the geometric residual", c.icp_robust, 0.1f, 1000));
    table.push_back(number("tracking.photometric_weight", "",
                           "of the photometric term, relative to its statistical weight", c.photometric_weight, 0,
                           1000));
    table.push_back(number("tracking.photometric_robust", "sigma", "Cauchy scale of the photometric residual",
                           c.photometric_robust, 0.1f, 1000));
    table.push_back(number("tracking.min_gradient", "1/px",
                           "pixels with less texture have no photometric residual (intensity is 0 .. 1)",
                           c.min_gradient, 0, 1));
    table.push_back(number("tracking.converged_translation", "m", "a level ends when a step moves less ...",
                           c.converged_translation, 0, 1));
    table.push_back(number("tracking.converged_rotation", "rad", "... and rotates less", c.converged_rotation, 0, 1));
    table.push_back(
        number("tracking.min_inlier_ratio", "",
               "of the pixels with static depth; with fewer inliers tracking has failed and the pose is held",
               c.min_inlier_ratio, 0, 1));
    table.push_back(number("tracking.max_icp_rmse", "m", "RMS distance of the surfaces above which tracking has failed",
                           c.max_icp_rmse, 0.001f, 100));
    table.push_back(number("tracking.max_translation_sigma", "m",
                           "standard deviation of the pose above which tracking has failed", c.max_translation_sigma,
                           1e-5f, 100));
    table.push_back(number("tracking.max_rotation_sigma", "rad",
                           "standard deviation of the pose above which tracking has failed", c.max_rotation_sigma,
                           1e-5f, 100));
    table.push_back(number("tracking.max_translation", "m", "per frame; more is implausible, tracking has failed",
                           c.max_translation, 0.001f, 100));
    table.push_back(number("tracking.max_rotation_deg", "deg", "per frame, likewise", c.max_rotation_deg, 0.1f, 180));
}

void add_map_options(std::vector<Option>& table, MapConfig& c) {
    table.push_back(
        number("map.index_map_scale", "", "cells of the index map per pixel and axis", c.index_map_scale, 1, 8));
    table.push_back(number("map.association_depth", "m",
                           "between a pixel and the surfel it is fused into, along the ray ...", c.association_depth,
                           0.001f, 10));
    table.push_back(number("map.association_sigmas", "sigma",
                           "... or so many standard deviations of the depth noise, whichever is more",
                           c.association_sigmas, 0, 100));
    table.push_back(
        number("map.association_angle_deg", "deg", "between their normals", c.association_angle_deg, 1, 90));
    table.push_back(number("map.stable_confidence", "", "a surfel is stable from this confidence on",
                           c.stable_confidence, 0, 1e6f));
    table.push_back(number("map.predict_confidence", "", "surfels below this are not part of the predicted model",
                           c.predict_confidence, 0, 1e6f));
    table.push_back(
        number("map.max_weight", "", "of a surfel's running means, in observations at 1 m", c.max_weight, 1, 1e6f));
    table.push_back(number("map.unstable_timeout", "frames", "unstable surfels not seen for so long are removed",
                           c.unstable_timeout, 1, 1'000'000));
    table.push_back(number("map.free_space_margin", "m",
                           "static depth this much behind a surfel proves that it is not there ...",
                           c.free_space_margin, 0, 10));
    table.push_back(number("map.free_space_sigmas", "sigma", "... or so many standard deviations, whichever is more",
                           c.free_space_sigmas, 0, 100));
    table.push_back(number("map.free_space_decay", "", "factor on the confidence of such a surfel, per frame",
                           c.free_space_decay, 0, 1));
    table.push_back(number("map.duplicate_spacing", "radii",
                           "of two stable surfels of one surface that are nearer than this one is removed; 0 = off",
                           c.duplicate_spacing, 0, 10));
    table.push_back(number("map.duplicate_age", "frames", "between their creation: of one visit both stay",
                           c.duplicate_age, 0, 1'000'000));
    table.push_back(number("map.duplicate_depth", "m",
                           "surfels are of one surface if less lies between them along the normal ...",
                           c.duplicate_depth, 0, 10));
    table.push_back(number("map.duplicate_sigmas", "sigma", "... or so many standard deviations, whichever is more",
                           c.duplicate_sigmas, 0, 100));
    table.push_back(number("map.speed_scale", "m, rad", "camera motion per frame from which on fusion weighs half",
                           c.speed_scale, 1e-4f, 100));
    table.push_back(number("map.initial_capacity", "surfels", "room in the map at the start; it doubles when full",
                           c.initial_capacity, 1024u, 1u << 30));
    table.push_back(
        number("map.max_capacity", "surfels", "a larger map stops the run", c.max_capacity, 1024u, 1u << 30));
}

void add_loop_options(std::vector<Option>& table, SlamConfig& slam) {
    LoopConfig& c = slam.loops;
    table.push_back(number("loops.time_window", "frames",
                           "surfels not seen for so long are the inactive model that loops are closed with",
                           c.time_window, 10, 1'000'000));
    table.push_back(number("loops.interval", "frames", "a loop is looked for every so often", c.interval, 1, 100'000));
    table.push_back(number("loops.min_inactive", "1/px", "inactive surfels in view from which on a local loop is tried",
                           c.min_inactive, 0, 100));
    table.push_back(number("loops.min_overlap", "",
                           "share of the image that must show the older model, near the present pose ...",
                           c.min_overlap, 0, 1));
    table.push_back(number("loops.min_overlap_elsewhere", "",
                           "... and at a keyframe that place recognition has proposed", c.min_overlap_elsewhere, 0, 1));
    table.push_back(number("loops.ample_overlap", "",
                           "share of the image at which a loop is closed without waiting for a better view",
                           c.ample_overlap, 0, 1));
    table.push_back(number("loops.patience", "frames", "longest wait for a better view", c.patience, 0, 1'000'000));
    table.push_back(number("loops.min_discrepancy", "m",
                           "mean displacement below which the map is not bent, only taken up again", c.min_discrepancy,
                           0, 10));
    table.push_back(number("loops.max_drift", "m/m",
                           "what a loop corrects can be drift up to so much per metre travelled since ...", c.max_drift,
                           0, 100));
    table.push_back(number("loops.max_drift_at_rest", "m", "... and so much more; beyond, two places look alike",
                           c.max_drift_at_rest, 0, 1000));
    table.push_back(number("loops.retry_after", "frames", "until a keyframe that turned out not to fit is tried again",
                           c.retry_after, 0, 1'000'000));
    table.push_back(number("loops.relative_constraints", "", "kept from each loop for later ones",
                           c.relative_constraints, 0, 1000));
    table.push_back(number("loops.ferns", "", "comparisons a view is recognised by", c.ferns.ferns, 10, 100'000));
    table.push_back(number("loops.fern_seed", "", "of the random ferns", c.ferns.seed, 0u, 4'000'000'000u));
    table.push_back(
        number("loops.fern_shrink", "", "views are coded at 1 / so much of the image size", c.ferns.shrink, 4, 16));
    table.push_back(number("loops.keyframe_dissimilarity", "",
                           "share of differing ferns that makes a view a new keyframe", c.ferns.keyframe_dissimilarity,
                           0, 1));
    table.push_back(number("loops.query_similarity", "", "least share of equal ferns of a keyframe that is tried",
                           c.ferns.query_similarity, 0, 1));
    table.push_back(number("loops.min_good", "", "share of the ferns that must have depth", c.ferns.min_good, 0, 1));

    AlignmentConfig& a = slam.alignment;
    table.push_back(number("alignment.wide_distance", "m", "between associated points in the rough alignment",
                           a.wide_distance, 0.001f, 10));
    table.push_back(number("alignment.wide_angle_deg", "deg", "between associated normals in the rough alignment",
                           a.wide_angle_deg, 1, 90));
    table.push_back(number("alignment.min_inlier_ratio", "", "inliers of the overlap", a.min_inlier_ratio, 0, 1));
    table.push_back(number("alignment.max_icp_rmse", "m", "RMS distance of the surfaces", a.max_icp_rmse, 0, 10));
    table.push_back(number("alignment.max_photometric_rmse", "", "RMS difference of the intensities (0 .. 1)",
                           a.max_photometric_rmse, 0, 1));
    table.push_back(number("alignment.min_correlation", "", "of live and model intensities, where both have contrast",
                           a.min_correlation, -1, 1));
    table.push_back(number("alignment.max_translation_sigma", "m", "standard deviation of the pose",
                           a.max_translation_sigma, 0, 10));
    table.push_back(
        number("alignment.max_rotation_sigma", "rad", "standard deviation of the pose", a.max_rotation_sigma, 0, 10));
    table.push_back(number("alignment.max_correction", "m, rad", "between the proposed and the found pose",
                           a.max_correction, 0, 100));

    RelocalisationConfig& r = slam.relocalisation;
    table.push_back(
        on_off("relocalisation.enabled", "after tracking was lost, find the camera by place recognition", r.enabled));
    table.push_back(number("relocalisation.lost_after", "frames", "without tracking until the camera counts as lost",
                           r.lost_after, 1, 1'000'000));
    table.push_back(number("relocalisation.recover_inlier_ratio", "",
                           "inliers that tracking needs to go on after a failure", r.recover_inlier_ratio, 0, 1));
    table.push_back(
        number("relocalisation.min_overlap", "", "share of the image that must show the model", r.min_overlap, 0, 1));
    table.push_back(number("relocalisation.proposals", "",
                           "keyframes that are tried, one a frame, between two tries at the last pose", r.proposals, 0,
                           1000));
    table.push_back(number("relocalisation.retry_after", "frames",
                           "a keyframe that did not fit is not tried again for so many", r.retry_after, 0, 1'000'000));

    DeformationConfig& d = slam.deformation;
    table.push_back(
        number("deformation.node_spacing", "m", "between the nodes of the graph", d.node_spacing, 0.01f, 100));
    table.push_back(number("deformation.temporal_window", "frames",
                           "without being seen that count like a distance of node_spacing", d.temporal_window, 1,
                           1'000'000));
    table.push_back(
        number("deformation.neighbours", "", "earlier nodes that each node is tied to", d.neighbours, 1, 64));
    table.push_back(number("deformation.camera_interval", "frames", "between cameras that are nodes", d.camera_interval,
                           1, 1'000'000));
    table.push_back(number(
        "deformation.odometry_weight", "1/m^2, 1/rad^2",
        "of the ties between successive cameras and what they saw first, where tracking is as certain as in the median",
        d.odometry_weight, 1e-3f, 1e9f));
    table.push_back(number("deformation.covisibility_weight", "1/m^2, 1/rad^2",
                           "of the ties between cameras that see the same", d.covisibility_weight, 0, 1e9f));
    table.push_back(number("deformation.step_translation_sigma", "m",
                           "standard deviation of a step that tracking says nothing about", d.step_translation_sigma,
                           1e-4f, 100));
    table.push_back(number("deformation.step_rotation_sigma", "rad", "likewise", d.step_rotation_sigma, 1e-4f, 100));
    table.push_back(number("deformation.correlated_pixels", "pixels", "so many tell tracking what one alone would",
                           d.correlated_pixels, 0.01f, 1e6f));
    table.push_back(number("deformation.rotation_weight", "1/rad^2", "of the difference of neighbours' rotations",
                           d.rotation_weight, 0, 1e6f));
    table.push_back(number("deformation.regularisation_weight", "1/m^2", "of neighbours torn apart",
                           d.regularisation_weight, 0, 1e6f));
    table.push_back(
        number("deformation.constraint_weight", "1/m^2", "of the constraints", d.constraint_weight, 0, 1e9f));
    table.push_back(number("deformation.iterations", "steps", "most Gauss-Newton steps", d.iterations, 1, 1000));
    table.push_back(number("deformation.max_constraint_error", "m",
                           "mean distance after the solve above which it is rejected", d.max_constraint_error, 0, 10));
    table.push_back(number("deformation.max_edge_error", "m",
                           "distance between torn neighbours above which it is rejected", d.max_edge_error, 0, 10));
}

void add_engine_options(std::vector<Option>& table, SlamConfig& c) {
    table.push_back(on_off("engine.int64_atomics",
                           "use 64-bit atomics where the device has them, else two 32-bit passes", c.int64_atomics));
    table.push_back(
        on_off("engine.validation", "run with Vulkan's core and synchronization validation (slow)", c.validation));
}

/// Levenshtein distance: how many letters differ.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
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

std::string Option::name() const {
    const std::size_t dot = key.find('.');
    return dot == std::string::npos ? key : key.substr(dot + 1);
}

std::vector<Option> option_table(RunConfig& config) {
    std::vector<Option> table;
    add_run_options(table, config);
    add_pose_options(table, config);
    add_segmentation_options(table, config.segmentation);
    add_preprocess_options(table, config.slam.preprocess, config.slam.noise);
    add_tracking_options(table, config.slam.tracking);
    add_map_options(table, config.slam.map);
    add_loop_options(table, config.slam);
    add_engine_options(table, config.slam);
    return table;
}

const Option& find_option(const std::vector<Option>& options, std::string_view key) {
    const auto nearest = std::min_element(options.begin(), options.end(), [&](const Option& a, const Option& b) {
        return edit_distance(a.key, key) < edit_distance(b.key, key);
    });
    if (nearest->key == key) return *nearest;
    throw Error("unknown option '" + std::string(key) + "'; the nearest is '" + nearest->key +
                "', `posefusion run --help` lists all");
}

std::string option_table_markdown(const std::vector<Option>& options) {
    const auto cell = [](std::string value) {
        for (std::size_t at = 0; (at = value.find('|', at)) != std::string::npos; at += 2) value.insert(at, "\\");
        return value;
    };
    std::string table = "| option | key in the file | default | unit | values | meaning |\n|---|---|---|---|---|---|\n";
    for (const Option& option : options) {
        table += "| `" + option.flag() + "` | `" + option.key + "` | " + option.get() + " | " + option.unit + " | " +
                 cell(option.allowed) + " | " + cell(option.help) + " |\n";
    }
    return table;
}

}  // namespace posefusion
