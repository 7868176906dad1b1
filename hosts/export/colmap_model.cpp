#include "hosts/export/colmap_model.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <ostream>
#include <type_traits>
#include <utility>

#include "engine/core/number_text.hpp"
#include "hosts/export/view.hpp"
#include "hosts/io/output_file.hpp"

namespace posefusion {
namespace {

static_assert(std::endian::native == std::endian::little, "COLMAP's files are written without swapping bytes");

constexpr std::uint32_t kCamera = 1;  ///< its number

struct ColmapCamera {
    std::int32_t model;
    const char* name;
    std::vector<float> parameters;
};

ColmapCamera camera_of(const Camera& camera) {
    const Intrinsics& K = camera.intrinsics;
    const auto [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
    ColmapCamera result{1, "PINHOLE", {K.fx, K.fy, K.cx + kPixelCentre, K.cy + kPixelCentre}};
    if (!camera.distorted()) return result;
    result.parameters.insert(result.parameters.end(), {k1, k2, p1, p2});
    result.model = 4;
    result.name = "OPENCV";
    if (k3 == 0 && k4 == 0 && k5 == 0 && k6 == 0) return result;
    result.parameters.insert(result.parameters.end(), {k3, k4, k5, k6});
    result.model = 6;
    result.name = "FULL_OPENCV";
    return result;
}

/// Where a point is seen.
struct TrackElement {
    std::uint32_t image;  ///< number
    std::uint32_t place;  ///< among the points of the image
};

std::vector<std::vector<TrackElement>> tracks_of(const ColmapModel& model) {
    std::vector<std::vector<TrackElement>> tracks(model.points.size());
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        const auto& points = model.images[i].points;
        for (std::size_t k = 0; k < points.size(); ++k)
            tracks[points[k].point].push_back({static_cast<std::uint32_t>(i + 1), static_cast<std::uint32_t>(k)});
    }
    return tracks;
}

/// World to camera, as COLMAP has it: qw qx qy qz tx ty tz.
std::array<double, 7> pose_of(const ColmapImage& image) {
    const Eigen::Isometry3d T_camera_world = image.T_world_camera.inverse();
    const Eigen::Quaterniond q(T_camera_world.linear());
    const Eigen::Vector3d t = T_camera_world.translation() + Eigen::Vector3d::Zero();  // 0 instead of -0
    return {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()};
}

Eigen::Vector2f corner_position(const Eigen::Vector2f& pixel) { return pixel.array() + kPixelCentre; }

class Binary {
public:
    explicit Binary(std::ostream& out) : out_(out) {}
    template <class T>
    void put(T value) {
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        out_.write(bytes, sizeof value);
    }

private:
    std::ostream& out_;
};

void write_cameras_binary(std::ostream& out, const ColmapModel& model) {
    const ColmapCamera camera = camera_of(model.camera);
    Binary file(out);
    file.put(std::uint64_t{1});
    file.put(kCamera);
    file.put(camera.model);
    file.put(static_cast<std::uint64_t>(model.camera.intrinsics.width));
    file.put(static_cast<std::uint64_t>(model.camera.intrinsics.height));
    for (const float parameter : camera.parameters) file.put(static_cast<double>(parameter));
}

void write_images_binary(std::ostream& out, const ColmapModel& model) {
    Binary file(out);
    file.put(static_cast<std::uint64_t>(model.images.size()));
    std::uint32_t number = 0;
    for (const ColmapImage& image : model.images) {
        file.put(++number);
        for (const double value : pose_of(image)) file.put(value);
        file.put(kCamera);
        out.write(image.name.c_str(), static_cast<std::streamsize>(image.name.size() + 1));  // with its 0
        file.put(static_cast<std::uint64_t>(image.points.size()));
        for (const auto& point : image.points) {
            const Eigen::Vector2d at = corner_position(point.pixel).cast<double>();
            file.put(at.x());
            file.put(at.y());
            file.put(std::uint64_t{point.point} + 1);
        }
    }
}

void write_points_binary(std::ostream& out, const ColmapModel& model) {
    const auto tracks = tracks_of(model);
    Binary file(out);
    file.put(static_cast<std::uint64_t>(model.points.size()));
    for (std::size_t i = 0; i < model.points.size(); ++i) {
        const ColmapPoint& point = model.points[i];
        file.put(static_cast<std::uint64_t>(i + 1));
        for (int k = 0; k < 3; ++k) file.put(static_cast<double>(point.position[k]));
        for (const std::uint8_t channel : {point.color.r, point.color.g, point.color.b}) file.put(channel);
        file.put(0.0);  // error
        file.put(static_cast<std::uint64_t>(tracks[i].size()));
        for (const TrackElement& seen : tracks[i]) {
            file.put(seen.image);
            file.put(seen.place);
        }
    }
}

/// Values behind each other, with spaces in between.
class TextLine {
public:
    template <class T>
    TextLine& add(const T& value) {
        if (!line_.empty()) line_ += ' ';
        if constexpr (std::is_arithmetic_v<T>)
            line_ += shortest_text(value);
        else
            line_ += value;
        return *this;
    }
    [[nodiscard]] std::string end() const { return line_ + '\n'; }

private:
    std::string line_;
};

void write_cameras_text(std::ostream& out, const ColmapModel& model) {
    const ColmapCamera camera = camera_of(model.camera);
    out << "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n";
    TextLine line;
    line.add(kCamera).add(camera.name).add(model.camera.intrinsics.width).add(model.camera.intrinsics.height);
    for (const float parameter : camera.parameters) line.add(parameter);
    out << line.end();
}

void write_images_text(std::ostream& out, const ColmapModel& model) {
    out << "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME (world to camera)\n# POINTS2D[] as X Y POINT3D_ID\n";
    std::uint32_t number = 0;
    for (const ColmapImage& image : model.images) {
        TextLine line, points;
        line.add(++number);
        for (const double value : pose_of(image)) line.add(value);
        line.add(kCamera).add(image.name);
        for (const auto& point : image.points) {
            const Eigen::Vector2f at = corner_position(point.pixel);
            points.add(at.x()).add(at.y()).add(point.point + 1);
        }
        out << line.end() << points.end();
    }
}

void write_points_text(std::ostream& out, const ColmapModel& model) {
    const auto tracks = tracks_of(model);
    out << "# POINT3D_ID X Y Z R G B ERROR TRACK[] as IMAGE_ID POINT2D_IDX\n";
    for (std::size_t i = 0; i < model.points.size(); ++i) {
        const ColmapPoint& point = model.points[i];
        TextLine line;
        line.add(i + 1);
        for (int k = 0; k < 3; ++k) line.add(point.position[k]);
        line.add(unsigned{point.color.r}).add(unsigned{point.color.g}).add(unsigned{point.color.b}).add(0);
        for (const TrackElement& seen : tracks[i]) line.add(seen.image).add(seen.place);
        out << line.end();
    }
}

}  // namespace

void write_colmap_model(const std::filesystem::path& folder, const ColmapModel& model) {
    using Write = void(std::ostream&, const ColmapModel&);
    for (const auto& [name, write] : {std::pair<const char*, Write*>{"cameras.bin", write_cameras_binary},
                                      {"cameras.txt", write_cameras_text},
                                      {"images.bin", write_images_binary},
                                      {"images.txt", write_images_text},
                                      {"points3D.bin", write_points_binary},
                                      {"points3D.txt", write_points_text}})
        write_file_atomically(folder / name, [&, writer = write](std::ostream& out) { writer(out, model); });
}

}  // namespace posefusion
