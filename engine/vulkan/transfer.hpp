#pragma once
#include <algorithm>

#include "engine/core/byte_stream.hpp"
#include "engine/vulkan/sequence.hpp"

namespace posefusion::vulkan {

/// The first `bytes` of a device buffer. Waits.
[[nodiscard]] inline ByteArray read_back(Context& context, const Buffer& buffer, std::size_t bytes) {
    if (bytes == 0) return {};
    const Buffer staging(context, bytes, MemoryKind::Host, "read back");
    Sequence sequence(context);
    sequence.copy(buffer, staging, bytes);
    sequence.finish();
    sequence.run();
    const auto values = staging.host<std::byte>().first(bytes);
    return {values.begin(), values.end()};
}

/// Writes to the beginning of a device buffer. Waits.
inline void write(Context& context, std::span<const std::byte> values, const Buffer& buffer) {
    if (values.empty()) return;
    const Buffer staging(context, values.size(), MemoryKind::Host, "upload");
    std::copy(values.begin(), values.end(), staging.host<std::byte>().begin());
    Sequence sequence(context);
    sequence.copy(staging, buffer, values.size());
    sequence.finish();
    sequence.run();
}

}  // namespace posefusion::vulkan
