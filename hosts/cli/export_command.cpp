#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/cli/child_process.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/cli/map_input.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/mesh/cloud_file.hpp"
#include "hosts/mesh/mesh_file.hpp"
#include "hosts/report/upright.hpp"
#include "hosts/run/console.hpp"
#include "hosts/run/signals.hpp"
#include "hosts/texture/run_views.hpp"
#include "hosts/web/read_scene.hpp"
#include "hosts/web/web_page.hpp"

namespace posefusion {
namespace {

/// Prints progress on the standard error stream.
void progress(const std::string& text) { fmt::print(stderr, "{}\n", text); }

/// The source itself, or the file of this name where it is the folder of a run.
std::filesystem::path source_file(const ExportConfig& config, const char* name) {
    return std::filesystem::is_directory(config.source) ? config.source / name : config.source;
}

std::filesystem::path map_file(const ExportConfig& config) { return source_file(config, "map.ply"); }
std::filesystem::path trajectory_file(const ExportConfig& config) { return source_file(config, "trajectory.txt"); }

}  // namespace

void check(const ExportConfig& config) {
    if (!config.wants_map() && config.trajectory.empty())
        throw Error(
            "nothing to export; give --mesh FILE, --cloud FILE, --html FILE, --trajectory FILE, --nerfstudio DIR or "
            "--colmap DIR");
    if (!config.mesh.empty()) check_mesh_name(config.mesh);
    if (config.texture) check_textured_mesh_name(config.mesh);
    if (!config.cloud.empty()) check_cloud_name(config.cloud);
    if (config.ascii && config.cloud.extension() != ".pcd")
        throw Error("--ascii is for --cloud FILE.pcd; .ply is always binary, .xyz always text");
    if (config.trajectory_format && config.trajectory.empty())
        throw Error("--format is that of a trajectory; give --trajectory FILE");
    for (const std::filesystem::path& file : {config.mesh, config.cloud, config.html, config.trajectory}) {
        std::error_code error;
        for (const std::filesystem::path& original : {map_file(config), trajectory_file(config)})
            if (std::filesystem::equivalent(file, original, error) && !error)
                throw Error(file.string() + ": is what is exported; choose another name");
    }
    check(config.views);
    const float resolution = config.reconstruction.resolution, confidence = config.min_confidence.value_or(0);
    if (!(resolution > 0) || !std::isfinite(resolution)) throw Error("the resolution must be a length above 0 m");
    const float trim = config.reconstruction.trim.value_or(resolution);
    if (!(trim > 0) || !std::isfinite(trim)) throw Error("--trim must be a length above 0 m");
    if (!(confidence >= 0)) throw Error("the least confidence must not be negative");
}

namespace {

void say_written(const std::filesystem::path& file, const std::string& content) {
    fmt::print("{}: {}\n", file.string(), content);
    std::fflush(stdout);
}

/// KITTI's poses have no stamps; its data sets have a times.txt with them, of as many lines.
std::filesystem::path times_file(const std::filesystem::path& poses) {
    return std::filesystem::path(poses).replace_filename(poses.stem().string() + "_times.txt");
}

void write_times(const std::filesystem::path& file, const Trajectory& poses) {
    std::string lines;
    for (const StampedPose& pose : poses) lines += seconds_text(pose.stamp) + '\n';
    write_file_atomically(file, lines);
}

void write_trajectory_of(const ExportConfig& config) {
    const TrajectoryFile read = read_trajectory_file(trajectory_file(config));
    for (const std::string& warning : read.warnings) progress("posefusion: warning: " + warning);
    const auto by_name = config.trajectory.extension() == ".csv" ? TrajectoryFormat::Asl : TrajectoryFormat::Tum;
    const TrajectoryFormat format = config.trajectory_format.value_or(by_name);
    const bool needs_stamps = format == TrajectoryFormat::Tum || format == TrajectoryFormat::Asl;
    if (needs_stamps && !read.unit)
        throw Error(trajectory_file(config).string() + ": has no time stamps, which " + name_of(format) +
                    " needs; give --format kitti");
    write_trajectory(config.trajectory, read.poses, format);
    say_written(config.trajectory, counted(read.poses.size(), "pose") + ", " + name_of(format));
    if (format != TrajectoryFormat::Kitti || !read.unit) return;
    const std::filesystem::path times = times_file(config.trajectory);
    write_times(times, read.poses);
    say_written(times, counted(read.poses.size(), "time stamp"));
}

void write_cloud_of(const ExportConfig& config, const std::vector<Surfel>& surfels) {
    write_cloud(config.cloud, surfels, config.ascii ? CloudEncoding::Text : CloudEncoding::Binary);
    say_written(config.cloud, counted(surfels.size(), "point"));
}

void write_page_of(const ExportConfig& config, const std::vector<Surfel>& surfels) {
    const auto remark = [](const std::string& text) { progress("posefusion: warning: " + text); };
    const WebScene scene = read_scene(config.source, surfels, config.recording, remark, interrupted);
    if (interrupted())
        return progress(fmt::format("posefusion: interrupted; {} was not written", config.html.string()));
    const std::string page = self_contained_page(scene);
    write_file_atomically(config.html, page);
    say_written(config.html, fmt::format("{}, {:.1f} MB", counted(surfels.size(), "surfel"),
                                         static_cast<double>(page.size()) / 1e6));
}

ViewObserver observer_on(Console& console) {
    ViewObserver observer;
    observer.progress = [&](const std::string& what, std::size_t done, std::size_t total) {
        console.progress(done, total, what);
    };
    observer.warning = [&](const std::string& text) { console.warning(text); };
    observer.cancelled = interrupted;
    return observer;
}

int write_views_of(const ExportConfig& config, const FinishedRun& run, const std::vector<Surfel>& surfels) {
    Console console;
    const ViewObserver observer = observer_on(console);
    const DataSet written = write_data_sets(run, surfels, config.views, observer);
    console.end_progress();
    for (const std::filesystem::path& folder : {config.views.nerfstudio, config.views.colmap}) {
        if (folder.empty()) continue;
        if (written.cancelled)
            progress("posefusion: interrupted; " + folder.string() + " was not written");
        else
            say_written(folder, fmt::format("{} of {}, {}", counted(written.views, "view"),
                                            counted(written.frames, "frame"), counted(written.points, "point")));
    }
    return written.cancelled ? kExitInterrupted : kExitOk;
}

/// From the world of the map to y up, which only .glb needs; without a trajectory the map alone says where that is.
Eigen::Quaternionf upright_rotation(const ExportConfig& config, const std::vector<Surfel>& surfels) {
    if (config.mesh.extension() != ".glb") return kCameraUpright;
    std::error_code error;
    const bool run =
        config.source != trajectory_file(config) && std::filesystem::exists(trajectory_file(config), error);
    const Trajectory trajectory = run ? read_trajectory(trajectory_file(config)) : Trajectory{StampedPose{}};
    const Eigen::Matrix3d axes = upright_axes(surfels, trajectory).linear();  // right, forward, up
    Eigen::Matrix3d R_upright_world;
    R_upright_world << axes.col(0).transpose(), axes.col(2).transpose(), -axes.col(1).transpose();
    return Eigen::Quaterniond(R_upright_world).cast<float>();
}

void write_textured_mesh_of(const ExportConfig& config, const Mesh& mesh, const FinishedRun& run,
                            const Eigen::Quaternionf& upright) {
    Console console;
    const ViewObserver observer = observer_on(console);
    const TextureViews views = views_of_run(run, config.views.keyframes, observer);
    const TexturedMesh textured = make_texture(mesh, views, config.texturing, {observer.progress, observer.warning});
    console.end_progress();
    write_mesh(config.mesh, textured, upright);
    constexpr float kMillimetres = 1000;
    say_written(config.mesh,
                fmt::format("{} vertices, {} triangles, texture of {} x {} with {:.1f} mm per pixel from {}",
                            textured.vertices.size(), textured.faces.size(), textured.texture.width(),
                            textured.texture.height(), kMillimetres * textured.texel, counted(textured.views, "view")));
}

/// @param run  of the texture; nullptr: there is none
int write_mesh_of(const ExportConfig& config, const std::vector<Surfel>& surfels, const FinishedRun* run) {
    const Mesh mesh = reconstruct_mesh(surfels, config.reconstruction, progress);
    const std::size_t most = config.reconstruction.max_triangles;
    if (most > 0 && mesh.faces.size() > most)
        progress("posefusion: warning: the mesh cannot be made simpler without closing holes or joining parts");
    const Eigen::Quaternionf upright = upright_rotation(config, surfels);
    if (run != nullptr) {
        write_textured_mesh_of(config, mesh, *run, upright);
        return kExitOk;
    }
    write_mesh(config.mesh, mesh, upright);
    say_written(config.mesh, fmt::format("{} vertices, {} triangles", mesh.vertices.size(), mesh.faces.size()));
    return kExitOk;
}

}  // namespace

int export_command(const ExportConfig& config) {
    std::optional<FinishedRun> run;  // what is wrong with it shows before the work begins
    if (config.views.wanted() || config.texture) run = read_finished_run(config.source, config.recording);
    if (!config.trajectory.empty()) write_trajectory_of(config);
    if (!config.wants_map()) return kExitOk;
    const std::vector<Surfel> surfels = read_wanted_surfels(map_file(config), config.min_confidence);
    const bool cloud = !config.cloud.empty() && !interrupted();
    if (cloud) write_cloud_of(config, surfels);
    if (!config.html.empty() && !interrupted()) write_page_of(config, surfels);
    int exit_code = interrupted() ? kExitInterrupted : kExitOk;
    // PCL's reconstruction cannot be interrupted, but its process can be killed
    if (!config.mesh.empty() && !interrupted())
        exit_code =
            run_in_child([&] { return write_mesh_of(config, surfels, config.texture ? &*run : nullptr); }, interrupted);
    if (exit_code == kExitInterrupted && !config.mesh.empty()) {
        remove_unfinished(config.mesh);
        progress(fmt::format("posefusion: interrupted; {} was not written{}", config.mesh.string(),
                             cloud ? ", " + config.cloud.string() + " was" : ""));
    }
    if (config.views.wanted() && exit_code == kExitOk) exit_code = write_views_of(config, *run, surfels);
    return exit_code;
}

}  // namespace posefusion
