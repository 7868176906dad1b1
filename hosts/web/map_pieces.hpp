#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/map/surfel.hpp"

/// The map as a browser gets it: pieces of compressed bytes, each a sample of the whole room, so that the first one
/// already shows it all and every further one makes it denser.
namespace posefusion {

/// How the numbers in the pieces are read.
struct MapCoding {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< position with the codes 0 0 0, metres
    double step = 0;                   ///< metres per code: positions are within half of it on each axis
    double least_radius = 0;           ///< metres, code 0
    double radius_growth = 0;          ///< ratio of the radii of two neighbouring codes
    double confidence_scale = 0;       ///< confidence = 2^(code * scale) - 1
    std::size_t bytes_per_surfel = 0;  ///< before compression
};

struct EncodedPiece {
    std::size_t surfels = 0;
    std::string bytes;  ///< gzip
};

struct EncodedMap {
    MapCoding coding;
    std::vector<EncodedPiece> pieces;
};

/// A piece, uncompressed, is one row of n bytes after the other, n its number of surfels:
///   x, y, z        3 rows each, least significant byte first: (position - origin) / step
///   normal         2 rows: octahedral map, -1 .. 1 as 1 .. 255 (Cigolle et al., JCGT 2014)
///   red green blue 3 rows
///   radius         1 row, logarithmic, within 1.2 %
///   confidence     1 row, logarithmic
///   created        3 rows: frame number
///   last seen      3 rows: frame number
/// Rows of equal kind and the order of a space-filling curve are what makes them compressible.
/// The same surfels give the same bytes. Throws Error for a map wider than 8 km.
[[nodiscard]] EncodedMap encode_map(const std::vector<Surfel>& surfels);

/// For pieces of a map that is not known yet: room for 4 km in every direction, confidences up to 65 000 and frames up
/// to 16 million; what is beyond is cut off.
[[nodiscard]] MapCoding coding_of_unknown_map();

/// Some of the surfels as one piece. Throws Error where the coding has no room for their positions.
[[nodiscard]] EncodedPiece encode_piece(const MapCoding& coding, const std::vector<Surfel>& surfels,
                                        std::span<const std::size_t> chosen);

}  // namespace posefusion
