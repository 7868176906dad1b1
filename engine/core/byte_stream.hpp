#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"

/// State as bytes, little-endian, for files from which a later run continues. Numbers come back as the same bits.
namespace posefusion {

static_assert(std::endian::native == std::endian::little, "bytes are written as they lie in memory");

using ByteArray = std::vector<std::byte>;

template <class T>
concept PlainNumber = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;

class StateWriter {
public:
    template <PlainNumber T>
    void put(T value) {
        raw(&value, sizeof(value));
    }
    void put(bool value) { put(std::uint8_t{value}); }
    void put(const std::string& text) {
        put(std::uint64_t{text.size()});
        raw(text.data(), text.size());
    }
    template <class Scalar, int Rows, int Columns>
    void put(const Eigen::Matrix<Scalar, Rows, Columns>& matrix) {
        raw(matrix.data(), sizeof(Scalar) * static_cast<std::size_t>(matrix.size()));
    }
    void put(const Eigen::Isometry3d& pose) { put(pose.matrix()); }
    /// The number of items, then put_one(item) for each.
    template <class List, class PutOne>
    void list(const List& items, PutOne&& put_one) {
        put(std::uint64_t{items.size()});
        for (const auto& item : items) put_one(item);
    }
    void raw(const void* data, std::size_t bytes) {
        const auto* begin = static_cast<const std::byte*>(data);
        bytes_.insert(bytes_.end(), begin, begin + bytes);
    }
    [[nodiscard]] ByteArray take() { return std::move(bytes_); }

private:
    ByteArray bytes_;
};

/// Reads what StateWriter wrote. Never beyond the end, never allocates more than the bytes can hold.
class StateReader {
public:
    /// @param what  named by the errors: "room.pfmap: the trajectory"
    StateReader(std::span<const std::byte> bytes, std::string what) : bytes_(bytes), what_(std::move(what)) {}

    template <PlainNumber T>
    [[nodiscard]] T get() {
        T value;
        raw(&value, sizeof(value));
        return value;
    }
    [[nodiscard]] bool get_bool() { return get<std::uint8_t>() != 0; }
    /// @param the largest value of the enumeration, which begins at 0
    template <class Enum>
    [[nodiscard]] Enum get_enum(Enum last) {
        const auto value = get<std::uint8_t>();
        if (value > static_cast<std::uint8_t>(last)) fail();
        return static_cast<Enum>(value);
    }
    [[nodiscard]] std::string get_text() {
        std::string text(count(1), '\0');
        raw(text.data(), text.size());
        return text;
    }
    template <class Matrix>
    [[nodiscard]] Matrix get_matrix() {
        Matrix matrix;
        raw(matrix.data(), sizeof(typename Matrix::Scalar) * static_cast<std::size_t>(matrix.size()));
        return matrix;
    }
    [[nodiscard]] Eigen::Isometry3d get_pose() {
        Eigen::Isometry3d pose;
        pose.matrix() = get_matrix<Eigen::Matrix4d>();
        return pose;
    }
    /// Calls get_one() once for each item. @param least_bytes  least size of one item
    template <class T, class GetOne>
    [[nodiscard]] std::vector<T> list(std::size_t least_bytes, GetOne&& get_one) {
        const std::size_t n = count(least_bytes);
        std::vector<T> items;
        items.reserve(std::min(n, bytes_.size() / sizeof(T)));  // no more than the bytes can hold
        for (std::size_t i = 0; i < n; ++i) items.push_back(get_one());
        return items;
    }
    void raw(void* data, std::size_t bytes) {
        expect(bytes);
        if (bytes > 0) std::memcpy(data, bytes_.data(), bytes);
        bytes_ = bytes_.subspan(bytes);
    }
    /// Throws Error unless this many bytes are left.
    void expect(std::size_t bytes) const {
        if (bytes > bytes_.size()) fail();
    }
    [[noreturn]] void fail() const { throw Error(what_ + " is damaged; use another file"); }
    /// Throws Error if bytes are left.
    void end() const {
        if (!bytes_.empty()) fail();
    }

private:
    [[nodiscard]] std::size_t count(std::size_t least_bytes) {
        const auto n = get<std::uint64_t>();
        if (n > bytes_.size() / least_bytes) fail();
        return static_cast<std::size_t>(n);
    }
    std::span<const std::byte> bytes_;
    std::string what_;
};

}  // namespace posefusion
