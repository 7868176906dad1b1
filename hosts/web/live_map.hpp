#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hosts/web/map_pieces.hpp"

namespace posefusion {

/// The map of a run that goes on, cut into cubes of a metre, each a piece of its own: what the camera does not see
/// stays as it is and goes to a browser once.
class LiveMap {
public:
    struct Cell {
        std::size_t id = 0;         ///< stays, even if the cell becomes empty for a while
        std::uint64_t version = 0;  ///< another one whenever the bytes are others
        std::size_t surfels = 0;
        std::shared_ptr<const std::string> bytes;  ///< of an EncodedPiece
    };

    /// Encodes the cells that have changed, those first that have waited longest, until `most` surfels are encoded.
    /// @param surfels  the whole map @return whether all cells are as in `surfels` now
    bool update(const std::vector<Surfel>& surfels, std::size_t most);

    /// Those with surfels, in an order that is always the same.
    [[nodiscard]] std::vector<Cell> cells() const;
    [[nodiscard]] const MapCoding& coding() const { return coding_; }

private:
    using Place = std::array<int, 3>;
    struct Content {
        Cell cell;
        std::uint64_t checksum = 0;  ///< of the surfels that were encoded
        std::uint64_t updated = 0;   ///< number of the update that encoded it; 0 = none
    };
    MapCoding coding_ = coding_of_unknown_map();
    std::map<Place, Content> cells_;
    std::uint64_t updates_ = 0, versions_ = 0;
};

}  // namespace posefusion
