#pragma once
#include <bit>
#include <string>
#include <string_view>
#include <vector>

#include "engine/vulkan/buffer.hpp"
#include "engine/vulkan/shader.hpp"

/// Arguments of a kernel: buffers and numbers, each by its name in the shader.
namespace posefusion::vulkan {

struct NamedBuffer {
    std::string_view name;
    const Buffer* buffer;

    NamedBuffer(const char* name_in_shader, const Buffer& value) : name(name_in_shader), buffer(&value) {}
};
using NamedBuffers = std::vector<NamedBuffer>;

/// A push constant or a specialisation constant.
struct NamedValue {
    std::string_view name;
    ValueKind kind;
    std::uint32_t bits;

    NamedValue(const char* name_in_shader, std::uint32_t value)
        : name(name_in_shader), kind(ValueKind::Whole), bits(value) {}
    NamedValue(const char* name_in_shader, int value)
        : name(name_in_shader), kind(ValueKind::Whole), bits(static_cast<std::uint32_t>(value)) {}
    NamedValue(const char* name_in_shader, float value)
        : name(name_in_shader), kind(ValueKind::Real), bits(std::bit_cast<std::uint32_t>(value)) {}
};
using NamedValues = std::vector<NamedValue>;

/// The given buffers in the order in which the shader declares its own. Throws Error for a name that the shader does
/// not know, that is missing or that is given twice. @param kernel  its name, for errors
[[nodiscard]] std::vector<const Buffer*> in_order(const std::string& kernel, const NamedBuffers& given,
                                                  std::span<const ShaderBuffer> declared);
/// Likewise the values, as bits; also throws Error for a float where an integer is expected, or the other way round.
/// @param what  "push constant" or "specialisation constant", for errors
[[nodiscard]] std::vector<std::uint32_t> in_order(const std::string& kernel, const std::string& what,
                                                  const NamedValues& given, std::span<const ShaderValue> declared);

}  // namespace posefusion::vulkan
