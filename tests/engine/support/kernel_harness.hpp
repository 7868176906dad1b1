#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <map>
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

/// The device tests run on: the one of POSEFUSION_TEST_DEVICE (empty: the best); else lavapipe where there is one, so
/// that results compare from machine to machine.
[[nodiscard]] std::string test_device();
/// Always, but where POSEFUSION_TEST_VALIDATION is "optional" and there is no validation layer.
[[nodiscard]] bool wants_validation();

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

/// One kernel and its buffers, by the names they have in the shader:
///   Launch launch("preprocess/gradients");
///   launch.input("params", params).input("intensity", intensity).output<vec4>("photometric", n);
///   launch.run_over(n, {{"level", 0}});
///   launch.read<vec4>("photometric");
/// Behind every buffer lies a guard zone: reading beyond an input yields NaN, writing beyond an output fails the test.
class Launch {
public:
    explicit Launch(std::string shader, vulkan::NamedValues constants = {}, bool int64_atomics = true);

    template <class T>
    Launch& input(const char* name, std::span<const T> values) {
        return bind(name, std::as_bytes(values), values.size_bytes(), false);
    }
    template <class T>
    Launch& input(const char* name, const std::vector<T>& values) {
        return input(name, std::span<const T>(values));
    }
    template <class T>
    requires std::is_trivially_copyable_v<T> Launch& input(const char* name, const T& value) {
        return input(name, std::span<const T>(&value, 1));
    }
    /// Read and written; holds `values` before.
    template <class T>
    Launch& inout(const char* name, const std::vector<T>& values) {
        return bind(name, std::as_bytes(std::span(values)), values.size() * sizeof(T), true);
    }
    template <class T>
    requires std::is_trivially_copyable_v<T> Launch& inout(const char* name, const T& value) {
        return bind(name, std::as_bytes(std::span(&value, 1)), sizeof(T), true);
    }
    /// Written only; holds kUnwritten before.
    template <class T>
    Launch& output(const char* name, std::size_t count) {
        return bind(name, {}, count * sizeof(T), true);
    }
    /// The buffer `other` under a second name (kernels that see a 64-bit buffer as two).
    Launch& same(const char* name, const char* other);

    void run(vulkan::Groups groups, const vulkan::NamedValues& push_constants = {});
    /// With as many workgroups as it takes.
    void run_over(std::size_t invocations, const vulkan::NamedValues& push_constants = {}) {
        run(groups_for(invocations, 1), push_constants);
    }
    void run_over(std::size_t invocations_x, std::size_t invocations_y) {
        run(groups_for(invocations_x, invocations_y));
    }
    /// Contents of a buffer after the run.
    template <class T>
    [[nodiscard]] std::vector<T> read(const std::string& name) const {
        const auto& bytes = slots_[bindings_.at(name)].bytes;
        std::vector<T> values((bytes.size() - kGuard) / sizeof(T));
        std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
        return values;
    }

    static constexpr std::uint32_t kUnwritten = 0x7fcdcdcd;  ///< as float a NaN
    static constexpr std::size_t kGuard = 4096;              ///< bytes

private:
    struct Slot {
        std::vector<std::byte> bytes;
        bool written;
    };
    [[nodiscard]] vulkan::Groups groups_for(std::size_t x, std::size_t y) const {
        return kernel_.groups_for(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
    }
    Launch& bind(const char* name, std::span<const std::byte> content, std::size_t bytes, bool written);

    vulkan::Context& context_;
    const vulkan::Kernel& kernel_;
    std::vector<Slot> slots_;
    std::map<std::string, std::size_t> bindings_;  ///< slot of each buffer
};

/// Parameters as Slam makes them of a configuration.
[[nodiscard]] inline gpu::Params make_params(const Intrinsics& camera) { return posefusion::make_params(camera, {}); }

/// Cameras of odd shapes: widths that are no multiples of 32, principal points off the centre, fx != fy.
[[nodiscard]] std::vector<Intrinsics> test_cameras();

}  // namespace posefusion::test
