#include "hosts/mesh/cloud_file.hpp"

#include <array>
#include <bit>
#include <ostream>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/ply.hpp"

namespace posefusion {
namespace {

static_assert(std::endian::native == std::endian::little, "PCD files are written without swapping bytes");

constexpr std::size_t kNumbersOfPcd = 9;

std::uint32_t pcd_color(Rgb8 c) { return std::uint32_t{c.r} << 16 | std::uint32_t{c.g} << 8 | std::uint32_t{c.b}; }

/// With single spaces, and a line end.
template <class... Numbers>
std::string text_line(const Numbers&... numbers) {
    std::string line;
    ((line += shortest_text(numbers) + ' '), ...);
    line.back() = '\n';
    return line;
}

/// https://pointclouds.org/documentation/tutorials/pcd_file_format.html
/// The bits of rgb are those of a number: binary files call it a float, as PCL's own do; as text it has to be unsigned.
std::string pcd_header(std::size_t points, CloudEncoding encoding) {
    const std::string count = std::to_string(points);
    const bool text = encoding == CloudEncoding::Text;
    return std::string("# .PCD v0.7 - made by PoseFusion, metres\nVERSION 0.7\n") +
           "FIELDS x y z normal_x normal_y normal_z rgb radius confidence\nSIZE 4 4 4 4 4 4 4 4 4\nTYPE F F F F F F " +
           (text ? "U" : "F") + " F F\nCOUNT 1 1 1 1 1 1 1 1 1\nWIDTH " + count +
           "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA " + (text ? "ascii" : "binary") + "\n";
}

void write_pcd(std::ostream& out, const std::vector<Surfel>& surfels, CloudEncoding encoding) {
    out << pcd_header(surfels.size(), encoding);
    for (const Surfel& s : surfels) {
        const Eigen::Vector3f &p = s.position, &n = s.normal;
        if (encoding == CloudEncoding::Text) {
            out << text_line(p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), pcd_color(s.color), s.radius, s.confidence);
            continue;
        }
        const std::array<float, kNumbersOfPcd> point{
            p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), std::bit_cast<float>(pcd_color(s.color)), s.radius, s.confidence};
        out.write(reinterpret_cast<const char*>(point.data()), sizeof point);
    }
}

void write_xyz(std::ostream& out, const std::vector<Surfel>& surfels) {
    for (const Surfel& s : surfels) {
        const Eigen::Vector3f &p = s.position, &n = s.normal;
        out << text_line(p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), unsigned{s.color.r}, unsigned{s.color.g},
                         unsigned{s.color.b});
    }
}

}  // namespace

void check_cloud_name(const std::filesystem::path& file) {
    for (const char* known : {".ply", ".pcd", ".xyz"})
        if (file.extension() == known) return;
    throw Error(file.string() + ": not a point cloud format; use a name that ends in .pcd, .ply or .xyz");
}

void write_cloud(const std::filesystem::path& file, const std::vector<Surfel>& surfels, CloudEncoding encoding) {
    check_cloud_name(file);
    if (file.extension() == ".ply") return write_ply(file, surfels);
    write_file_atomically(file, [&](std::ostream& out) {
        file.extension() == ".pcd" ? write_pcd(out, surfels, encoding) : write_xyz(out, surfels);
    });
}

}  // namespace posefusion
