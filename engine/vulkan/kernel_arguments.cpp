#include "engine/vulkan/kernel_arguments.hpp"

#include <algorithm>

#include "engine/core/error.hpp"

namespace posefusion::vulkan {
namespace {

/// The given argument for each declared name.
template <class Given, class Declared>
std::vector<const Given*> matched(const std::string& kernel, const std::string& what, const std::vector<Given>& given,
                                  std::span<const Declared> declared) {
    const auto refuse = [&](std::string_view name, const std::string& problem) {
        throw Error("kernel " + kernel + ": " + what + " '" + std::string(name) + "' " + problem);
    };
    std::vector<const Given*> result(declared.size(), nullptr);
    for (const Given& one : given) {
        const auto found = std::ranges::find(declared, one.name, &Declared::name);
        if (found == declared.end()) {
            std::string names;
            for (const Declared& known : declared) names += (names.empty() ? "" : ", ") + std::string(known.name);
            refuse(one.name, "is not in the shader, which has " + (names.empty() ? "none" : names));
        }
        const Given*& place = result[static_cast<std::size_t>(found - declared.begin())];
        if (place) refuse(one.name, "is given twice");
        place = &one;
    }
    for (std::size_t i = 0; i < declared.size(); ++i) {
        if (!result[i]) refuse(declared[i].name, "is missing");
    }
    return result;
}

}  // namespace

std::vector<const Buffer*> in_order(const std::string& kernel, const NamedBuffers& given,
                                    std::span<const ShaderBuffer> declared) {
    std::vector<const Buffer*> buffers;
    for (const NamedBuffer* named : matched(kernel, "buffer", given, declared)) buffers.push_back(named->buffer);
    return buffers;
}

std::vector<std::uint32_t> in_order(const std::string& kernel, const std::string& what, const NamedValues& given,
                                    std::span<const ShaderValue> declared) {
    std::vector<std::uint32_t> bits;
    for (const NamedValue* value : matched(kernel, what, given, declared)) {
        const ValueKind wanted = declared[bits.size()].kind;
        if (value->kind != wanted) {
            throw Error("kernel " + kernel + ": " + what + " '" + std::string(value->name) + "' must be " +
                        (wanted == ValueKind::Whole ? "a whole number" : "a float"));
        }
        bits.push_back(value->bits);
    }
    return bits;
}

}  // namespace posefusion::vulkan
