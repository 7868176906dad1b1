#include "tests/engine/support/kernel_harness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace posefusion::test {

using namespace vulkan;

namespace {

std::array<std::unique_ptr<Context>, 2>& contexts() {
    static std::array<std::unique_ptr<Context>, 2> both;
    return both;
}

/// Kernels are compiled once per program, as the tests launch them many times.
using KernelKey = std::tuple<const Context*, std::string, std::size_t, std::size_t, std::vector<std::uint32_t>>;
std::map<KernelKey, std::unique_ptr<Kernel>>& kernels() {
    static std::map<KernelKey, std::unique_ptr<Kernel>> all;
    return all;
}

const Kernel& kernel_of(Context& context, const std::string& shader, std::size_t bindings, std::size_t push_bytes,
                        const std::vector<std::uint32_t>& specialisation) {
    auto& kernel = kernels()[{&context, shader, bindings, push_bytes, specialisation}];
    if (!kernel) {
        kernel = std::make_unique<Kernel>(context, shader, static_cast<std::uint32_t>(bindings),
                                          static_cast<std::uint32_t>(push_bytes), specialisation);
    }
    return *kernel;
}

constexpr std::uint32_t kWriteGuard = 0x7fabab12;

void fill_words(std::span<std::byte> bytes, std::uint32_t word) {
    for (std::size_t i = 0; i + sizeof(word) <= bytes.size(); i += sizeof(word))
        std::memcpy(&bytes[i], &word, sizeof(word));
}

}  // namespace

std::string test_device() {
    const auto devices = list_devices();
    const bool has_lavapipe = std::any_of(devices.begin(), devices.end(), [](const DeviceInfo& d) {
        return d.name.find("llvmpipe") != std::string::npos && d.missing.empty();
    });
    return has_lavapipe ? "llvmpipe" : "";
}

Context& shared_context(bool int64_atomics) {
    auto& context = contexts()[int64_atomics];
    if (!context) {
        ContextOptions options;
        options.device = test_device();
        options.validation = true;
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

Launch::Launch(std::string shader, std::vector<std::uint32_t> specialisation, bool int64_atomics)
    : context_(shared_context(int64_atomics)), shader_(std::move(shader)), specialisation_(std::move(specialisation)) {}

Launch& Launch::bind(std::span<const std::byte> content, std::size_t bytes, bool reads, bool writes) {
    Slot slot{std::vector<std::byte>(bytes + kGuard), reads, writes};
    fill_words(slot.bytes, kUnwritten);
    // another NaN: what was read beyond an input must be told apart when written beyond an output
    if (writes) fill_words(std::span(slot.bytes).subspan(bytes), kWriteGuard);
    std::copy(content.begin(), content.end(), slot.bytes.begin());
    bindings_.push_back(slots_.size());
    slots_.push_back(std::move(slot));
    return *this;
}

Launch& Launch::same_as(std::size_t binding) {
    bindings_.push_back(bindings_[binding]);
    return *this;
}

void Launch::run_bytes(Groups groups, std::span<const std::byte> push) {
    const Kernel& kernel = kernel_of(context_, shader_, bindings_.size(), push.size(), specialisation_);
    std::vector<Buffer> host, device;
    for (const auto& slot : slots_) {
        host.emplace_back(context_, slot.bytes.size(), MemoryKind::Host, "test host");
        device.emplace_back(context_, slot.bytes.size(), MemoryKind::Device, "test device");
        std::copy(slot.bytes.begin(), slot.bytes.end(), host.back().host<std::byte>().begin());
    }
    std::vector<Access> accesses;
    for (const auto slot : bindings_) accesses.push_back({&device[slot], slots_[slot].reads, slots_[slot].writes});

    Sequence sequence(context_);
    for (std::size_t i = 0; i < slots_.size(); ++i) sequence.copy(host[i], device[i], slots_[i].bytes.size());
    // push constants come as bytes, Sequence::dispatch wants a type: the sizes there are
    struct Push4 {
        std::array<std::byte, 4> bytes;
    };
    struct Push8 {
        std::array<std::byte, 8> bytes;
    };
    struct Push12 {
        std::array<std::byte, 12> bytes;
    };
    struct Push16 {
        std::array<std::byte, 16> bytes;
    };
    const auto dispatch_as = [&]<class Push>(Push value) {
        std::copy(push.begin(), push.end(), value.bytes.begin());
        sequence.dispatch(kernel, accesses, value, groups);
    };
    switch (push.size()) {
        case 0:
            sequence.dispatch(kernel, accesses, groups);
            break;
        case 4:
            dispatch_as(Push4{});
            break;
        case 8:
            dispatch_as(Push8{});
            break;
        case 12:
            dispatch_as(Push12{});
            break;
        case 16:
            dispatch_as(Push16{});
            break;
        default:
            FAIL() << "push constants of " << push.size() << " bytes";
    }
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        if (slots_[i].writes) sequence.copy(device[i], host[i], slots_[i].bytes.size());
    }
    sequence.finish();
    sequence.run();

    for (std::size_t i = 0; i < slots_.size(); ++i) {
        if (!slots_[i].writes) continue;
        auto& bytes = slots_[i].bytes;
        const auto result = host[i].host<std::byte>();
        const bool intact = std::equal(bytes.end() - kGuard, bytes.end(),
                                       result.begin() + static_cast<std::ptrdiff_t>(bytes.size() - kGuard));
        EXPECT_TRUE(intact) << shader_ << " wrote beyond the end of a buffer, slot " << i;
        std::copy_n(result.begin(), bytes.size(), bytes.begin());
    }
}

std::vector<Intrinsics> test_cameras() {
    return {{131.25f, 131.25f, 79.5f, 59.5f, 160, 120},
            {31.0f, 33.5f, 15.25f, 15.5f, 36, 28},
            {140.0f, 128.0f, 101.0f, 50.0f, 164, 124}};
}

}  // namespace posefusion::test
