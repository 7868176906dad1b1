#include <nlohmann/json.hpp>

#include "engine/core/number_text.hpp"
#include "hosts/export/view_writer.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/ply.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr float kMillimetre = 1000;            ///< depth image value of one metre; nerfstudio's default
constexpr const char* kPoints = "points.ply";  ///< where Gaussian splatting begins

/// OpenGL's camera looks along -z, with y up.
Json rows_of(const Eigen::Isometry3d& T_world_camera) {
    Eigen::Matrix4d M = T_world_camera.matrix();
    M.middleCols<2>(1) *= -1;
    M += Eigen::Matrix4d::Zero();  // 0 instead of -0
    Json rows = Json::array();
    for (Eigen::Index row = 0; row < M.rows(); ++row) rows.push_back({M(row, 0), M(row, 1), M(row, 2), M(row, 3)});
    return rows;
}

/// A float without the extra digits of its conversion to double.
Json shortest(float value) { return Json::parse(shortest_text(value)); }

Json camera_json(const Camera& camera) {
    const Intrinsics& K = camera.intrinsics;
    const auto [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
    return {{"camera_model", "OPENCV"},
            {"fl_x", shortest(K.fx)},
            {"fl_y", shortest(K.fy)},
            {"cx", static_cast<double>(K.cx + kPixelCentre)},
            {"cy", static_cast<double>(K.cy + kPixelCentre)},
            {"w", K.width},
            {"h", K.height},
            {"k1", shortest(k1)},
            {"k2", shortest(k2)},
            {"k3", shortest(k3)},
            {"p1", shortest(p1)},
            {"p2", shortest(p2)}};
}

class NerfstudioWriter final : public ViewWriter {
public:
    NerfstudioWriter(fs::path folder, const Scene& scene) : folder_(std::move(folder)), scene_(scene) {
        for (const char* part : {"images", "depth"}) prepare_output_folder(folder_ / part);
        if (scene_.masked) prepare_output_folder(folder_ / "masks");
    }

    void add(const View& view) override {
        const std::string file = view.name + ".png";
        write_png(folder_ / "images" / file, view.color);
        write_depth(folder_ / "depth" / file, view.depth, kMillimetre);
        Json frame = {{"file_path", "images/" + file}, {"depth_file_path", "depth/" + file}};
        if (scene_.masked) {
            write_labels(folder_ / "masks" / file, usable_pixels(view));
            frame["mask_path"] = "masks/" + file;
        }
        frame["transform_matrix"] = rows_of(view.T_world_camera);
        frames_.push_back(std::move(frame));
    }

    void finish() override {
        write_ply(folder_ / kPoints, scene_.points, {"made by PoseFusion, metres"});
        Json transforms = camera_json(scene_.camera);
        transforms["depth_unit_scale_factor"] = 1 / static_cast<double>(kMillimetre);
        transforms["ply_file_path"] = kPoints;
        transforms["frames"] = std::move(frames_);
        write_file_atomically(folder_ / "transforms.json", transforms.dump(1) + "\n");
    }

private:
    fs::path folder_;
    const Scene& scene_;
    Json frames_ = Json::array();
};

}  // namespace

bool nerfstudio_knows(const LensCoefficients& lens) { return lens[5] == 0 && lens[6] == 0 && lens[7] == 0; }

std::unique_ptr<ViewWriter> make_nerfstudio_writer(const fs::path& folder, const Scene& scene) {
    return std::make_unique<NerfstudioWriter>(folder, scene);
}

}  // namespace posefusion
