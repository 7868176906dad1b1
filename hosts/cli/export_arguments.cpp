#include "hosts/cli/export_arguments.hpp"

#include <map>
#include <memory>
#include <string>

#include "engine/core/error.hpp"
#include "hosts/cli/commands.hpp"

namespace posefusion {
namespace {

const std::map<std::string, TrajectoryFormat> kFormats{
    {"tum", TrajectoryFormat::Tum}, {"euroc", TrajectoryFormat::Asl}, {"kitti", TrajectoryFormat::Kitti}};

constexpr int kLeastTexture = 256, kLargestTexture = 8192;  // the latter takes 740 MB

/// Options that are added from here on are shown under this heading of the help.
void begin_group(CLI::App& sub, const char* heading) { sub.option_defaults()->group(heading); }

void add_map_options(CLI::App& sub, ExportConfig& config) {
    begin_group(sub, "Map");
    sub.add_option("--mesh", config.mesh, "surface through the surfels, open where there are none")
        ->type_name("FILE.ply | FILE.obj | FILE.glb");
    sub.add_option("--cloud", config.cloud, "points with normals and colours")
        ->type_name("FILE.pcd | FILE.ply | FILE.xyz");
    sub.add_flag("--ascii", config.ascii, "write a .pcd as text");
    sub.add_option("--html", config.html, "page that shows the map, and the run in whose folder it is, in any browser")
        ->type_name("FILE.html");
    sub.add_option("--min-confidence", config.min_confidence, "surfels with less confidence are left out")
        ->default_str("those that are not stable")
        ->type_name("N");
    sub.add_option("--trim", config.reconstruction.trim,
                   "the mesh ends where it is farther than this from measured surface; larger closes holes")
        ->default_str("2 x resolution")
        ->type_name("m");
    sub.add_option("--max-triangles", config.reconstruction.max_triangles, "simplify the mesh to so many; 0 = all")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber.description(""))
        ->type_name("N");
    sub.add_flag("--texture", config.texture, "give the mesh a texture from the images of the run")
        ->needs(sub.get_option("--mesh"));
    sub.add_option("--texture-size", config.texturing.size, "most pixels per side of the texture")
        ->capture_default_str()
        ->check(CLI::Range(kLeastTexture, kLargestTexture).description(""))
        ->type_name("N");
    sub.add_option("--resolution", config.reconstruction.resolution, "size of the smallest detail of the mesh")
        ->capture_default_str()
        ->type_name("m");
}

void add_trajectory_options(CLI::App& sub, ExportConfig& config) {
    begin_group(sub, "Trajectory");
    sub.add_option("--trajectory", config.trajectory, "poses of the camera, camera to world, in metres")
        ->type_name("FILE");
    sub.add_option_function<std::string>(
           "--format", [&config](const std::string& name) { config.trajectory_format = kFormats.at(name); },
           "format of the trajectory; KITTI's has its time stamps in a file beside it, FILE_times.txt")
        ->check(CLI::IsMember(kFormats).description(""))
        ->default_str("euroc for FILE.csv, else tum")
        ->type_name("tum | euroc | kitti");
}

void add_view_options(CLI::App& sub, DataSetConfig& config) {
    begin_group(sub, "Views");
    sub.add_option("--nerfstudio", config.nerfstudio,
                   "views of a run with poses, depth, masks and points: transforms.json for nerfstudio")
        ->type_name("DIR");
    sub.add_option("--colmap", config.colmap, "the same views as a sparse model of COLMAP, text and binary")
        ->type_name("DIR");
    sub.add_option("--view-distance", config.keyframes.distance, "between views ...")
        ->capture_default_str()
        ->type_name("m");
    sub.add_option("--view-angle", config.keyframes.angle, "... or this much turned; the sharpest frame there is taken")
        ->capture_default_str()
        ->type_name("deg");
    sub.add_flag("--undistort", config.undistort,
                 "images as an ideal lens gives them, for programs without lens models");
    sub.add_option("--points", config.points, "most points of the map with the views")
        ->capture_default_str()
        ->check(CLI::PositiveNumber.description(""))
        ->type_name("N");
}

}  // namespace

void add_export_command(CLI::App& app, int& exit_code) {
    CLI::App* sub = app.add_subcommand("export", "map and trajectory of a run in the formats of other programs");
    const auto config = std::make_shared<ExportConfig>();
    sub->add_option("SOURCE", config->source,
                    "folder of `posefusion run`, its map.ply or trajectory.txt, or what --save-map wrote")
        ->required()
        ->type_name("");
    sub->add_option("--recording", config->recording, "of the run, for what needs its images")
        ->default_str("where it was when it was run")
        ->type_name("PATH");
    add_map_options(*sub, *config);
    add_trajectory_options(*sub, *config);
    add_view_options(*sub, config->views);
    sub->callback([config, &exit_code] {
        try {
            check(*config);
        } catch (const Error& error) {
            throw CLI::ValidationError(error.what());
        }
        exit_code = export_command(*config);
    });
}

}  // namespace posefusion
