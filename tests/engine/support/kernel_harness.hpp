#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/intrinsics.hpp"
#include "engine/slam/params.hpp"
#include "engine/vulkan/sequence.hpp"
#include "engine/vulkan/shared_types.hpp"

/// Runs single kernels on arrays of the host, with core and synchronization validation.
namespace posefusion::test {

/// The device tests run on: lavapipe where there is one, so that results compare from machine to machine; else the
/// best.
[[nodiscard]] std::string test_device();

/// One Context per program and kind of depth test, made on first use.
[[nodiscard]] vulkan::Context& shared_context(bool int64_atomics = true);
/// Validation messages of the shared contexts so far.
[[nodiscard]] std::uint32_t shared_validation_messages();
void destroy_shared_contexts();

/// Every test on the shared contexts ends with: validation had nothing to say.
class DeviceTest : public testing::Test {
protected:
    void SetUp() override { messages_before_ = shared_validation_messages(); }
    void TearDown() override {
        EXPECT_EQ(shared_validation_messages(), messages_before_) << "Vulkan validation has complained";
    }

private:
    std::uint32_t messages_before_ = 0;
};

/// One kernel with its buffers, bound in the order of the calls:
///   Launch launch("preprocess/gradients"); launch.input(params).input(intensity).output<vec4>(n); launch.run(groups,
///   push); launch.read<vec4>(2)
/// Behind every buffer lies a guard zone: reading beyond an input yields NaN, writing beyond an output fails the test.
class Launch {
public:
    explicit Launch(std::string shader, std::vector<std::uint32_t> specialisation = {}, bool int64_atomics = true);

    template <class T>
    Launch& input(std::span<const T> values) {
        return bind(std::as_bytes(values), values.size_bytes(), true, false);
    }
    template <class T>
    Launch& input(const std::vector<T>& values) {
        return input(std::span<const T>(values));
    }
    template <class T>
    requires std::is_trivially_copyable_v<T> Launch& input(const T& value) {
        return input(std::span<const T>(&value, 1));
    }
    /// Read and written; holds `values` before.
    template <class T>
    Launch& inout(const std::vector<T>& values) {
        return bind(std::as_bytes(std::span(values)), values.size() * sizeof(T), true, true);
    }
    template <class T>
    requires std::is_trivially_copyable_v<T> Launch& inout(const T& value) {
        return bind(std::as_bytes(std::span(&value, 1)), sizeof(T), true, true);
    }
    /// Written only; holds kUnwritten before.
    template <class T>
    Launch& output(std::size_t count) {
        return bind({}, count * sizeof(T), false, true);
    }
    /// The buffer of binding `binding` a second time (kernels that see a 64-bit buffer as two).
    Launch& same_as(std::size_t binding);

    void run(vulkan::Groups groups) { run_bytes(groups, {}); }
    template <class Push>
    requires std::is_trivially_copyable_v<Push>
    void run(vulkan::Groups groups, const Push& push) { run_bytes(groups, std::as_bytes(std::span(&push, 1))); }
    /// Contents of a binding after the run.
    template <class T>
    [[nodiscard]] std::vector<T> read(std::size_t binding) const {
        const auto& bytes = slots_[bindings_[binding]].bytes;
        std::vector<T> values((bytes.size() - kGuard) / sizeof(T));
        std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
        return values;
    }

    static constexpr std::uint32_t kUnwritten = 0x7fcdcdcd;  ///< as float a NaN
    static constexpr std::size_t kGuard = 4096;              ///< bytes

private:
    struct Slot {
        std::vector<std::byte> bytes;
        bool reads, writes;
    };
    Launch& bind(std::span<const std::byte> content, std::size_t bytes, bool reads, bool writes);
    void run_bytes(vulkan::Groups groups, std::span<const std::byte> push);

    vulkan::Context& context_;
    std::string shader_;
    std::vector<std::uint32_t> specialisation_;
    std::vector<Slot> slots_;
    std::vector<std::size_t> bindings_;  ///< slot of each binding
};

/// Parameters as Slam makes them of a configuration.
[[nodiscard]] inline gpu::Params make_params(const Intrinsics& camera) { return posefusion::make_params(camera, {}); }

/// Cameras of odd shapes: widths that are no multiples of 32, principal points off the centre, fx != fy.
[[nodiscard]] std::vector<Intrinsics> test_cameras();

[[nodiscard]] inline vulkan::Groups groups_of(std::size_t items, std::uint32_t size) {
    return vulkan::Groups::covering(static_cast<std::uint32_t>(items), size);
}

}  // namespace posefusion::test
