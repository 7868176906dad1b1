#pragma once
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <vector>

#include "engine/core/byte_stream.hpp"

/// Arrays of the device's structures as bytes, and back.
namespace posefusion {

/// The first elements, at most `count` of them; an incomplete one at the end is left out.
template <class Element>
[[nodiscard]] std::vector<Element> elements_of(const ByteArray& bytes,
                                               std::size_t count = std::numeric_limits<std::size_t>::max()) {
    std::vector<Element> list(std::min(count, bytes.size() / sizeof(Element)));
    if (!list.empty()) std::memcpy(list.data(), bytes.data(), list.size() * sizeof(Element));
    return list;
}

template <class Element>
[[nodiscard]] ByteArray bytes_of(const std::vector<Element>& list) {
    ByteArray bytes(list.size() * sizeof(Element));
    if (!list.empty()) std::memcpy(bytes.data(), list.data(), bytes.size());
    return bytes;
}

}  // namespace posefusion
