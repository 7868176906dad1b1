#include "tests/engine/support/kernel_harness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string_view>
#include <tuple>

namespace posefusion::test {

using namespace vulkan;

namespace {

std::array<std::unique_ptr<Context>, 2>& contexts() {
    static std::array<std::unique_ptr<Context>, 2> both;
    return both;
}

/// Kernels are compiled once per program, as the tests launch them many times.
using KernelKey = std::tuple<const Context*, std::string, std::map<std::string_view, std::uint32_t>>;
std::map<KernelKey, std::unique_ptr<Kernel>>& kernels() {
    static std::map<KernelKey, std::unique_ptr<Kernel>> all;
    return all;
}

const Kernel& kernel_of(Context& context, const std::string& shader, const NamedValues& constants) {
    std::map<std::string_view, std::uint32_t> values;
    for (const NamedValue& constant : constants) values[constant.name] = constant.bits;
    auto& kernel = kernels()[{&context, shader, values}];
    if (!kernel) kernel = std::make_unique<Kernel>(context, shader, constants);
    return *kernel;
}

bool has_validation_layer() {
    std::uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
        return std::string_view(layer.layerName) == "VK_LAYER_KHRONOS_validation";
    });
}

constexpr std::uint32_t kWriteGuard = 0x7fabab12;

void fill_words(std::span<std::byte> bytes, std::uint32_t word) {
    for (std::size_t i = 0; i + sizeof(word) <= bytes.size(); i += sizeof(word))
        std::memcpy(&bytes[i], &word, sizeof(word));
}

}  // namespace

std::string test_device() {
    if (const char* wanted = std::getenv("POSEFUSION_TEST_DEVICE")) return wanted;
    const auto devices = list_devices();
    const bool has_lavapipe = std::any_of(devices.begin(), devices.end(), [](const DeviceInfo& d) {
        return d.name.find("llvmpipe") != std::string::npos && d.missing.empty();
    });
    return has_lavapipe ? "llvmpipe" : "";
}

bool wants_validation() {
    const char* wish = std::getenv("POSEFUSION_TEST_VALIDATION");
    return wish == nullptr || std::string_view(wish) != "optional" || has_validation_layer();
}

Context& shared_context(bool int64_atomics) {
    auto& context = contexts()[int64_atomics];
    if (!context) {
        ContextOptions options;
        options.device = test_device();
        options.validation = wants_validation();
        options.allow_int64_atomics = int64_atomics;
        context = std::make_unique<Context>(options);
    }
    return *context;
}

std::uint32_t shared_validation_messages() {
    std::uint32_t messages = 0;
    for (const auto& context : contexts()) messages += context ? context->validation_messages() : 0;
    return messages;
}

void destroy_shared_contexts() {
    kernels().clear();
    for (auto& context : contexts()) context.reset();
}

Launch::Launch(std::string shader, NamedValues constants, bool int64_atomics)
    : context_(shared_context(int64_atomics)), kernel_(kernel_of(context_, shader, constants)) {}

Launch& Launch::bind(const char* name, std::span<const std::byte> content, std::size_t bytes, bool written) {
    for (const ShaderBuffer& buffer : kernel_.shader().buffers) {
        if (buffer.name != name) continue;
        EXPECT_EQ(buffer.writes, written) << kernel_.name() << ": is '" << name << "' an input?";
    }
    Slot slot{std::vector<std::byte>(bytes + kGuard), written};
    fill_words(slot.bytes, kUnwritten);
    // another NaN: what was read beyond an input must be told apart when written beyond an output
    if (written) fill_words(std::span(slot.bytes).subspan(bytes), kWriteGuard);
    std::copy(content.begin(), content.end(), slot.bytes.begin());
    EXPECT_TRUE(bindings_.emplace(name, slots_.size()).second) << kernel_.name() << ": '" << name << "' is bound twice";
    slots_.push_back(std::move(slot));
    return *this;
}

Launch& Launch::same(const char* name, const char* other) {
    bindings_[name] = bindings_.at(other);
    return *this;
}

void Launch::run(Groups groups, const NamedValues& push_constants) {
    std::vector<Buffer> host, device;
    for (const auto& slot : slots_) {
        host.emplace_back(context_, slot.bytes.size(), MemoryKind::Host, "test host");
        device.emplace_back(context_, slot.bytes.size(), MemoryKind::Device, "test device");
        std::copy(slot.bytes.begin(), slot.bytes.end(), host.back().host<std::byte>().begin());
    }
    NamedBuffers buffers;
    for (const auto& [name, slot] : bindings_) buffers.emplace_back(name.c_str(), device[slot]);

    Sequence sequence(context_);
    for (std::size_t i = 0; i < slots_.size(); ++i) sequence.copy(host[i], device[i], slots_[i].bytes.size());
    sequence.dispatch(kernel_, buffers, push_constants, groups);
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        if (slots_[i].written) sequence.copy(device[i], host[i], slots_[i].bytes.size());
    }
    sequence.finish();
    sequence.run();

    for (const auto& [name, index] : bindings_) {
        Slot& slot = slots_[index];
        if (!slot.written) continue;
        const auto result = host[index].host<std::byte>();
        const bool intact = std::equal(slot.bytes.end() - kGuard, slot.bytes.end(),
                                       result.begin() + static_cast<std::ptrdiff_t>(slot.bytes.size() - kGuard));
        EXPECT_TRUE(intact) << kernel_.name() << " wrote beyond the end of '" << name << "'";
        std::copy_n(result.begin(), slot.bytes.size(), slot.bytes.begin());
    }
}

std::vector<Intrinsics> test_cameras() {
    return {{131.25f, 131.25f, 79.5f, 59.5f, 160, 120},
            {31.0f, 33.5f, 15.25f, 15.5f, 36, 28},
            {140.0f, 128.0f, 101.0f, 50.0f, 164, 124}};
}

}  // namespace posefusion::test
