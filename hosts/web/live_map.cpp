#include "hosts/web/live_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace posefusion {
namespace {

constexpr float kCell = 1.0f;  // m: a room has a hundred of them

/// SplitMix64 (Steele et al., 2014).
std::uint64_t mixed(std::uint64_t number) {
    number += 0x9e3779b97f4a7c15;
    number = (number ^ number >> 30) * 0xbf58476d1ce4e5b9;
    number = (number ^ number >> 27) * 0x94d049bb133111eb;
    return number ^ number >> 31;
}

std::uint64_t two(std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32 | b; }
std::uint64_t two(float a, float b) { return two(std::bit_cast<std::uint32_t>(a), std::bit_cast<std::uint32_t>(b)); }

/// Sums of it do not depend on the order of the surfels, which the engine changes when it closes gaps.
std::uint64_t checksum(const Surfel& s) {
    std::uint64_t sum = mixed(two(s.position.x(), s.position.y()));
    sum = mixed(sum ^ two(s.position.z(), s.confidence));
    sum = mixed(sum ^ two(s.normal.x(), s.normal.y()));
    sum = mixed(sum ^ two(s.normal.z(), s.radius));
    sum = mixed(sum ^ two(s.created, s.last_seen));
    return mixed(sum ^ (std::uint64_t{s.color.r} << 16 | std::uint64_t{s.color.g} << 8 | s.color.b));
}

}  // namespace

bool LiveMap::update(const std::vector<Surfel>& surfels, std::size_t most) {
    struct Found {
        std::vector<std::size_t> surfels;
        std::uint64_t checksum = 0;
    };
    std::map<Place, Found> found;
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        Place place{};
        for (int axis = 0; axis < 3; ++axis)
            place[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor(surfels[i].position[axis] / kCell));
        Found& cell = found[place];
        cell.surfels.push_back(i);
        cell.checksum += checksum(surfels[i]);
    }
    for (auto& [place, content] : cells_) {
        if (content.cell.surfels == 0 || found.contains(place)) continue;
        content = {{content.cell.id, ++versions_, 0, std::make_shared<const std::string>()}, 0, updates_};
    }
    std::vector<std::pair<Content*, const Found*>> changed;
    for (const auto& [place, cell] : found) {
        const auto [at, fresh] = cells_.try_emplace(place);
        if (fresh) at->second.cell.id = cells_.size() - 1;
        if (at->second.updated == 0 || at->second.checksum != cell.checksum) changed.emplace_back(&at->second, &cell);
    }
    std::stable_sort(changed.begin(), changed.end(),
                     [](const auto& a, const auto& b) { return a.first->updated < b.first->updated; });
    ++updates_;
    std::size_t encoded = 0;
    for (const auto& [content, cell] : changed) {
        if (encoded >= most) return false;
        EncodedPiece piece = encode_piece(coding_, surfels, cell->surfels);
        encoded += piece.surfels;
        content->cell.version = ++versions_;
        content->cell.surfels = piece.surfels;
        content->cell.bytes = std::make_shared<const std::string>(std::move(piece.bytes));
        content->checksum = cell->checksum;
        content->updated = updates_;
    }
    return true;
}

std::vector<LiveMap::Cell> LiveMap::cells() const {
    std::vector<Cell> cells;
    for (const auto& [place, content] : cells_)
        if (content.cell.surfels > 0) cells.push_back(content.cell);
    return cells;
}

}  // namespace posefusion
