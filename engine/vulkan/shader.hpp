#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace posefusion::vulkan {

/// A storage buffer of a shader. Its name is that of the block's only member, as used in the shader.
struct ShaderBuffer {
    std::string_view name;
    bool reads, writes;  ///< from the shader's readonly and writeonly; both without a qualifier
};

enum class ValueKind { Whole, Real };  ///< int or uint; float. All have 32 bits.

/// A push constant or a specialisation constant of a shader.
struct ShaderValue {
    std::string_view name;  ///< elements of an array are values of their own: "groups[0]", "groups[1]"
    std::uint32_t place;    ///< offset in bytes; or constant_id
    ValueKind kind;
};

/// A compiled shader: its code and its declarations. Read from the SPIR-V when the program is built
/// (embed_shader.cmake), so that no number has to be repeated in C++.
struct Shader {
    std::span<const std::uint32_t> code;  ///< SPIR-V
    std::array<std::uint32_t, 2>
        group_size;  ///< invocations of a workgroup along x and y; 1 for shaders without workgroups
    std::span<const ShaderBuffer> buffers;  ///< of bindings 0, 1, ...
    std::span<const ShaderValue> push_constants;
    std::span<const ShaderValue> constants;  ///< specialisation constants
};

/// Every compute shader of the engine. Name: folder and file without ending, e.g. "map/index_map"; shaders with a
/// depth test exist a second time, with 64-bit atomics, as ".int64". Throws Error for an unknown name.
[[nodiscard]] const Shader& shader_named(const std::string& name);

}  // namespace posefusion::vulkan
