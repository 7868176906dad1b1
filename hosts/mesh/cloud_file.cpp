#include "hosts/mesh/cloud_file.hpp"

#include <array>
#include <bit>
#include <ostream>

#include "engine/core/error.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/ply.hpp"

namespace posefusion {
namespace {

static_assert(std::endian::native == std::endian::little, "PCD files are written without swapping bytes");

bool is_pcd(const std::filesystem::path& file) { return file.extension() == ".pcd"; }

/// https://pointclouds.org/documentation/tutorials/pcd_file_format.html
void write_pcd(std::ostream& out, const std::vector<Surfel>& surfels) {
    const std::string count = std::to_string(surfels.size());
    out << "# .PCD v0.7 - made by PoseFusion, metres\nVERSION 0.7\nFIELDS x y z normal_x normal_y normal_z rgb radius "
           "confidence\n"
           "SIZE 4 4 4 4 4 4 4 4 4\nTYPE F F F F F F F F F\nCOUNT 1 1 1 1 1 1 1 1 1\nWIDTH "
        << count << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << count << "\nDATA binary\n";
    for (const Surfel& s : surfels) {
        const std::uint32_t rgb =
            std::uint32_t{s.color.r} << 16 | std::uint32_t{s.color.g} << 8 | std::uint32_t{s.color.b};
        const std::array<float, 9> point{s.position.x(),
                                         s.position.y(),
                                         s.position.z(),
                                         s.normal.x(),
                                         s.normal.y(),
                                         s.normal.z(),
                                         std::bit_cast<float>(rgb),
                                         s.radius,
                                         s.confidence};
        out.write(reinterpret_cast<const char*>(point.data()), sizeof point);
    }
}

}  // namespace

void check_cloud_name(const std::filesystem::path& file) {
    if (file.extension() != ".ply" && !is_pcd(file))
        throw Error(file.string() + ": not a point cloud format; use a name that ends in .pcd or .ply");
}

void write_cloud(const std::filesystem::path& file, const std::vector<Surfel>& surfels) {
    check_cloud_name(file);
    if (is_pcd(file))
        write_file_atomically(file, [&](std::ostream& out) { write_pcd(out, surfels); });
    else
        write_ply(file, surfels);
}

}  // namespace posefusion
