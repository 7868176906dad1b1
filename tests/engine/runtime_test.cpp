#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <string>
#include <thread>

#include "engine/core/error.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"

// The Vulkan runtime: order of commands, validation as a guard, errors in one line.
namespace posefusion::test {
namespace {

using namespace vulkan;

/// The message of the Error that `action` throws.
template <class Action>
std::string error_of(Action action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    ADD_FAILURE() << "no Error was thrown";
    return {};
}

void expect_one_line(const std::string& message) {
    EXPECT_GT(message.size(), 10u);
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0) << message;
}

/// Validation messages of a chain of two kernels: pack labels to bits, dilate the bits. @param packing  the first one
std::uint32_t messages_of_chain(const Shader& packing) {
    ContextOptions options;
    options.device = test_device();
    options.validation = true;
    Context context(options);
    const Intrinsics camera = test_cameras()[0];
    const std::uint32_t words = 5 * 120;
    const Buffer params = host_buffer<gpu::Params>(context, 1, "params");
    params.host<gpu::Params>()[0] = make_params(camera);
    const Buffer color = device_buffer<std::uint32_t>(context, 160 * 120, "colour");
    const Buffer mask = device_buffer<std::uint32_t>(context, words, "mask");
    const Buffer dilated = device_buffer<std::uint32_t>(context, words, "dilated");
    const Kernel pack(context, "pack", packing), dilate(context, "preprocess/mask_dilate");
    Sequence sequence(context);
    sequence.fill(color, 0, color.bytes());
    sequence.dispatch(pack, {{"params", params}, {"color", color}, {"mask", mask}}, pack.groups_for(words));
    sequence.dispatch(dilate, {{"params", params}, {"mask", mask}, {"dilated_mask", dilated}},
                      dilate.groups_for(words));
    sequence.finish();
    sequence.run();
    return context.validation_messages();
}

TEST(Validation, IsSilentWhenEveryAccessIsDeclared) {
    EXPECT_EQ(messages_of_chain(shader_named("preprocess/mask_pack")), 0u);
}

TEST(Validation, SeesABarrierThatAWrongDeclarationLeavesOut) {
    // lavapipe runs commands in order: without this guard a missing barrier would only show on another GPU
    Shader wrong = shader_named("preprocess/mask_pack");
    std::vector<ShaderBuffer> buffers(wrong.buffers.begin(), wrong.buffers.end());
    for (ShaderBuffer& buffer : buffers) buffer.writes = false;
    wrong.buffers = buffers;
    EXPECT_GT(messages_of_chain(wrong), 0u);
}

// ------------------------------------------------------------------------------------------------ what shaders declare

const ShaderBuffer& buffer_of(const Shader& shader, std::string_view name) {
    const auto found = std::ranges::find(shader.buffers, name, &ShaderBuffer::name);
    if (found == shader.buffers.end()) throw Error("no buffer " + std::string(name));
    return *found;
}

TEST(ShaderInterface, TellsHowEachBufferIsUsed) {
    const Shader& fuse = shader_named("map/fuse");
    EXPECT_EQ(fuse.buffers.front().name, "params");
    EXPECT_TRUE(buffer_of(fuse, "owner").reads && !buffer_of(fuse, "owner").writes);  // readonly
    EXPECT_TRUE(buffer_of(fuse, "appearance").reads && buffer_of(fuse, "appearance").writes);
    const Shader& gradients = shader_named("preprocess/gradients");
    EXPECT_TRUE(!buffer_of(gradients, "photometric").reads && buffer_of(gradients, "photometric").writes);  // writeonly
    EXPECT_EQ(buffer_of(shader_named("map/splat.int64"), "cells").name, "cells");
    EXPECT_EQ(buffer_of(shader_named("map/splat"), "cell_indices").name, "cell_indices");
}

TEST(ShaderInterface, TellsConstantsAndTheSizeOfAWorkgroup) {
    const Shader& begin = shader_named("tracking/track_begin");
    ASSERT_EQ(begin.push_constants.size(), 4u);
    EXPECT_EQ(begin.push_constants[3].name, "level_groups[2]");
    EXPECT_EQ(begin.push_constants[3].place, 12u);
    const Shader& associate = shader_named("map/associate");
    const auto scale = std::ranges::find(associate.constants, "INDEX_SCALE", &ShaderValue::name);
    ASSERT_NE(scale, associate.constants.end());
    EXPECT_EQ(scale->place, 1u);
    EXPECT_EQ(scale->kind, ValueKind::Whole);
    EXPECT_EQ(shader_named("loops/deform").push_constants.front().kind, ValueKind::Real);
    EXPECT_EQ(shader_named("preprocess/bilateral").group_size, (std::array{16u, 4u}));
}

class Runtime : public DeviceTest {};

TEST_F(Runtime, SequenceMayRunManyTimesAndReadsNewInputEachTime) {
    Context& context = shared_context();
    const Buffer input = host_buffer<std::uint32_t>(context, 256, "input");
    const Buffer middle = device_buffer<std::uint32_t>(context, 256, "middle");
    const Buffer output = host_buffer<std::uint32_t>(context, 256, "output");
    Sequence sequence(context);
    sequence.stage("there");
    sequence.copy(input, middle, 1024);
    sequence.stage("back");
    sequence.copy(middle, output, 1024);
    sequence.finish();
    for (std::uint32_t round = 0; round < 5; ++round) {
        for (auto& word : input.host<std::uint32_t>()) word = round * 7 + 1;
        sequence.run();
        for (const auto word : output.host<std::uint32_t>()) ASSERT_EQ(word, round * 7 + 1);
        const auto times = sequence.times();
        if (context.timestamp_mask() == 0) continue;
        ASSERT_EQ(times.size(), 2u);
        EXPECT_EQ(times[0].stage, "there");
        EXPECT_EQ(times[1].stage, "back");
        for (const auto& time : times)
            EXPECT_TRUE(time.milliseconds >= 0 && time.milliseconds < 10000) << time.milliseconds;
    }
}

TEST_F(Runtime, AskingForTimesDoesNotWaitForTheWorkOfOthers) {
    Context& context = shared_context();
    constexpr std::size_t kBytes = std::size_t{16} << 20;
    const Buffer small = device_buffer<std::uint32_t>(context, 1, "small");
    Sequence mine(context);
    mine.stage("mine");
    mine.fill(small, 1, sizeof(std::uint32_t));
    mine.finish();
    mine.run();
    std::atomic<bool> enough = false;
    std::atomic<int> rounds = 0;
    std::vector<std::thread> others;  // several, so that the device never rests
    for (int t = 0; t < 3; ++t) {
        others.emplace_back([&] {
            const Buffer large = device_buffer<std::byte>(context, kBytes, "large");
            Sequence work(context);
            for (std::uint32_t i = 0; i < 10; ++i) work.fill(large, i, kBytes);
            work.finish();
            for (; !enough; ++rounds) work.run();
        });
    }
    while (rounds < 6) std::this_thread::yield();
    const int before = rounds;
    constexpr int kQuestions = 30;
    for (int i = 0; i < kQuestions; ++i) EXPECT_EQ(mine.times().size(), context.timestamp_mask() == 0 ? 0u : 1u);
    EXPECT_LT(rounds - before, kQuestions / 2);
    enough = true;
    for (std::thread& other : others) other.join();
}

TEST_F(Runtime, CopiesAndFillsStayWithinTheirRange) {
    Context& context = shared_context();
    const Buffer source = host_buffer<std::uint32_t>(context, 64, "source"),
                 target = host_buffer<std::uint32_t>(context, 64, "target");
    for (std::uint32_t i = 0; i < 64; ++i) source.host<std::uint32_t>()[i] = i;
    Sequence sequence(context);
    sequence.fill(target, 99, 256);
    sequence.copy(source, target, 16, 40, 80);
    sequence.finish();
    sequence.run();
    for (std::uint32_t i = 0; i < 64; ++i) {
        EXPECT_EQ(target.host<std::uint32_t>()[i], i >= 20 && i < 24 ? i - 10 : 99u);
    }
}

TEST_F(Runtime, IndirectDispatchOfNoGroupsDoesNothing) {
    Context& context = shared_context();
    const auto camera = test_cameras()[0];
    const Buffer params = host_buffer<gpu::Params>(context, 1, "params");
    params.host<gpu::Params>()[0] = make_params(camera);
    const Buffer color = host_buffer<std::uint32_t>(context, 160 * 120, "colour");
    const Buffer mask = host_buffer<std::uint32_t>(context, 600, "mask");
    const Buffer arguments = host_buffer<gpu::DispatchArguments>(context, 2, "arguments");
    arguments.host<gpu::DispatchArguments>()[0] = {0, 1, 1};
    arguments.host<gpu::DispatchArguments>()[1] = {10, 1, 1};
    std::fill(color.host<std::uint32_t>().begin(), color.host<std::uint32_t>().end(), 1u << 24);
    const Kernel pack(context, "preprocess/mask_pack");
    for (std::uint32_t slot = 0; slot < 2; ++slot) {
        std::fill(mask.host<std::uint32_t>().begin(), mask.host<std::uint32_t>().end(), 5u);
        Sequence sequence(context);
        sequence.dispatch_indirect(pack, {{"params", params}, {"color", color}, {"mask", mask}}, arguments, slot);
        sequence.finish();
        sequence.run();
        for (const auto word : mask.host<std::uint32_t>()) ASSERT_EQ(word, slot == 0 ? 5u : ~0u);
    }
}

/// The message of the error is one line and names all of `words`.
template <class Action>
void expect_error_naming(std::initializer_list<std::string> words, Action action) {
    const std::string message = error_of(action);
    expect_one_line(message);
    for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
}

TEST_F(Runtime, UnknownShaderIsAnErrorInOneLine) {
    expect_error_naming({"map/no_such_kernel"}, [] { Kernel(shared_context(), "map/no_such_kernel"); });
}

TEST_F(Runtime, BuffersMustBeThoseOfTheShader) {
    Context& context = shared_context();
    const Buffer buffer = device_buffer<std::uint32_t>(context, 4096, "buffer");
    const Kernel pack(context, "preprocess/mask_pack");
    const auto dispatch = [&](const NamedBuffers& buffers) {
        return [&, buffers] { Sequence(context).dispatch(pack, buffers, 1); };
    };
    expect_error_naming({"preprocess/mask_pack", "'colour'", "color"},
                        dispatch({{"params", buffer}, {"colour", buffer}, {"mask", buffer}}));
    expect_error_naming({"preprocess/mask_pack", "'mask'", "missing"},
                        dispatch({{"params", buffer}, {"color", buffer}}));
    expect_error_naming({"preprocess/mask_pack", "'color'", "twice"},
                        dispatch({{"params", buffer}, {"color", buffer}, {"mask", buffer}, {"color", buffer}}));
}

TEST_F(Runtime, PushConstantsMustBeThoseOfTheShader) {
    Context& context = shared_context();
    const Buffer buffer = device_buffer<std::uint32_t>(context, 4096, "buffer");
    const Kernel gradients(context, "preprocess/gradients");
    const auto dispatch = [&](const NamedValues& push_constants) {
        return [&, push_constants] {
            Sequence(context).dispatch(gradients, {{"params", buffer}, {"intensity", buffer}, {"photometric", buffer}},
                                       push_constants, 1);
        };
    };
    expect_error_naming({"preprocess/gradients", "'scale'", "level"}, dispatch({{"level", 1}, {"scale", 1}}));
    expect_error_naming({"preprocess/gradients", "'level'", "missing"}, dispatch({}));
    expect_error_naming({"preprocess/gradients", "'level'", "twice"}, dispatch({{"level", 1}, {"level", 1}}));
    expect_error_naming({"preprocess/gradients", "'level'", "whole"}, dispatch({{"level", 1.0f}}));
}

TEST_F(Runtime, SpecialisationConstantsMustBeThoseOfTheShader) {
    const auto make = [](const NamedValues& constants) {
        return [constants] { Kernel(shared_context(), "preprocess/bilateral", constants); };
    };
    expect_error_naming({"preprocess/bilateral", "'WIDTH'", "RADIUS"}, make({{"RADIUS", 2}, {"WIDTH", 2}}));
    expect_error_naming({"preprocess/bilateral", "'RADIUS'", "missing"}, make({}));
    expect_error_naming({"preprocess/bilateral", "'RADIUS'", "twice"}, make({{"RADIUS", 2}, {"RADIUS", 2}}));
    expect_error_naming({"preprocess/bilateral", "'RADIUS'", "whole"}, make({{"RADIUS", 2.0f}}));
}

TEST_F(Runtime, SequenceOfManyDispatchesNeedsNoCountInAdvance) {
    Context& context = shared_context();
    const Buffer params = host_buffer<gpu::Params>(context, 1, "params");
    params.host<gpu::Params>()[0] = make_params(test_cameras()[0]);
    params.host<gpu::Params>()[0].dilation = 1;
    const Buffer a = device_buffer<std::uint32_t>(context, 600, "a"),
                 b = device_buffer<std::uint32_t>(context, 600, "b");
    const Buffer seed = host_buffer<std::uint32_t>(context, 600, "seed"),
                 result = host_buffer<std::uint32_t>(context, 600, "result");
    std::fill(seed.host<std::uint32_t>().begin(), seed.host<std::uint32_t>().end(), 0u);
    seed.host<std::uint32_t>()[0] = 1;  // the top-left pixel
    const Kernel dilate(context, "preprocess/mask_dilate");
    Sequence sequence(context);
    sequence.copy(seed, a, 2400);
    for (int i = 0; i < 100; ++i) {  // more than one descriptor pool holds
        sequence.dispatch(dilate, {{"params", params}, {"mask", i % 2 ? b : a}, {"dilated_mask", i % 2 ? a : b}},
                          dilate.groups_for(600));
    }
    sequence.copy(a, result, 2400);
    sequence.finish();
    sequence.run();
    // one step by a disc of radius 1 moves along rows and columns: after k steps all pixels within city distance k are
    // set
    for (int v = 0; v < 120; ++v) {
        for (int u = 0; u < 160; ++u) {
            const bool set = result.host<std::uint32_t>()[static_cast<std::size_t>(v * 5 + u / 32)] >> (u % 32) & 1u;
            ASSERT_EQ(set, u + v <= 100) << u << ' ' << v;
        }
    }
}

TEST(Device, ListedDevicesSayWhatTheyLack) {
    const auto devices = list_devices();
    ASSERT_FALSE(devices.empty());
    for (std::size_t i = 0; i < devices.size(); ++i) {
        EXPECT_EQ(devices[i].index, static_cast<int>(i));
        EXPECT_FALSE(devices[i].name.empty());
        EXPECT_FALSE(devices[i].kind.empty());
        EXPECT_TRUE(devices[i].memory_bytes > 0 || !devices[i].missing.empty());
    }
}

TEST(Device, IsFoundByPartOfItsNameInAnyCaseAndByIndex) {
    const auto devices = list_devices();
    const auto usable =
        std::find_if(devices.begin(), devices.end(), [](const DeviceInfo& d) { return d.missing.empty(); });
    ASSERT_NE(usable, devices.end());
    std::string upper = usable->name.substr(0, 6);
    std::transform(upper.begin(), upper.end(), upper.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    ContextOptions options;
    options.device = upper;
    EXPECT_EQ(Context(options).info().name.substr(0, 6), usable->name.substr(0, 6));
    options.device = std::to_string(usable->index);
    EXPECT_EQ(Context(options).info().index, usable->index);
}

TEST(Device, UnknownNameOrIndexIsAnErrorThatNamesIt) {
    for (const std::string wanted : {"no such gpu", "97"}) {
        ContextOptions options;
        options.device = wanted;
        const auto message = error_of([&] { Context context(options); });
        expect_one_line(message);
        EXPECT_NE(message.find(wanted), std::string::npos) << message;
    }
}

}  // namespace
}  // namespace posefusion::test
