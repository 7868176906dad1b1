#include "hosts/io/sources/raw_stream.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "tests/hosts/io/sources/frames.hpp"

namespace posefusion::test {
namespace {

const std::string kFirstLine = "posefusion-raw 1\n";

template <class Number>
std::string number(Number value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}
std::string block(const std::string& bytes) { return number(static_cast<std::uint32_t>(bytes.size())) + bytes; }

template <class Pixels>
std::string bytes_of(const Pixels& image) {
    return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(*image.data())};
}

std::string begin(const std::string& more = "") {
    return kFirstLine +
           block("{fx: 30.25, fy: 30.5, cx: 15.5, cy: 11.125, width: 32, height: 24, depth_scale: 1000" + more + "}");
}

std::string frame_of(const RawFrame& frame, const std::string& color, const std::string& depth) {
    const auto stamp = static_cast<std::uint64_t>(frame.stamp.count());
    return block(number(stamp) + number(stamp + 5'000'000) + block(color) + depth);
}
std::string raw(int i) {
    const RawFrame frame = make_frame(i);
    return frame_of(frame, bytes_of(frame.color), bytes_of(frame.depth));
}

class RawStream : public testing::Test {
protected:
    ~RawStream() override {
        if (descriptor_ >= 0) close(descriptor_);
    }
    std::unique_ptr<FrameSource> open(const std::string& content, const SourceOptions& options = {}) {
        if (descriptor_ >= 0) close(descriptor_);
        descriptor_ = ::open(folder.write("stream", content).c_str(), O_RDONLY | O_CLOEXEC);
        return open_raw_stream(descriptor_, "raw:-", options);
    }
    std::string fault(const std::string& content) {
        return message_of<Error>([&] { (void)open(content); });
    }
    /// Of the first frame.
    std::string read_fault(const std::string& content) {
        return message_of<Error>([&] { (void)open(content)->read(0); });
    }
    TempFolder folder;

private:
    int descriptor_ = -1;
};

TEST_F(RawStream, GivesTheFramesAndThenItsEnd) {
    const auto source = open(begin() + raw(0) + raw(1) + raw(2));
    EXPECT_TRUE(source->facts().live);
    EXPECT_TRUE(is_camera("raw:-")) << "its frames come once";
    EXPECT_EQ(source->size(), FrameSource::kEndless);
    EXPECT_EQ(source->camera().intrinsics, test_camera().intrinsics);
    EXPECT_EQ(source->camera().depth_scale, 1000);
    for (const int i : {0, 1, 2}) {
        const RawFrame frame = source->read(0);
        EXPECT_EQ(frame.stamp, make_frame(i).stamp);
        EXPECT_EQ(frame.depth_delay, std::chrono::milliseconds(5));
        EXPECT_EQ(bytes_of(frame.color), bytes_of(make_frame(i).color));
        EXPECT_EQ(bytes_of(frame.depth), bytes_of(make_frame(i).depth));
    }
    for (int i = 0; i < 2; ++i) EXPECT_THROW((void)source->read(0), SourceEnded);
}

TEST_F(RawStream, ImagesMayBeEncoded) {
    const RawFrame frame = make_frame(4);
    write_raw_depth(folder / "d.png", frame.depth);
    const auto source = open(begin() + frame_of(frame, encode_png(frame.color), read_all(folder / "d.png")));
    const RawFrame read = source->read(0);
    EXPECT_EQ(bytes_of(read.color), bytes_of(frame.color));
    EXPECT_EQ(bytes_of(read.depth), bytes_of(frame.depth));
}

TEST_F(RawStream, DepthOfAnotherCameraIsRegistered) {
    const auto source = open(
        begin(", depth_width: 16, depth_height: 12") +
        frame_of(make_frame(0), bytes_of(make_frame(0).color), bytes_of(std::vector<std::uint16_t>(16 * 12, 2000))));
    const RawFrame frame = source->read(0);
    ASSERT_EQ(frame.depth.width(), kWidth);
    for (const std::uint16_t d : frame.depth) EXPECT_EQ(d, 2000);
}

TEST_F(RawStream, TheCameraMayComeFromAFile) {
    EXPECT_TRUE(has(fault(kFirstLine + block("") + raw(0)), "does not say its camera; give it with --camera FILE"));
    SourceOptions options;
    options.camera_file = folder / "c.yaml";
    write_camera_file(options.camera_file, test_camera());
    EXPECT_EQ(bytes_of(open(kFirstLine + block("") + raw(0), options)->read(0).depth), bytes_of(make_frame(0).depth));
}

TEST_F(RawStream, OneThatIsNoneIsRefused) {
    for (const std::string content : {"", "posefusion-raw 1", "something else entirely"})
        EXPECT_TRUE(has(fault(content), "does not begin with the line 'posefusion-raw 1'")) << content;
    EXPECT_TRUE(has(fault(kFirstLine), "ends before its camera"));
    EXPECT_TRUE(has(fault(kFirstLine + "ab"), "ends within a camera"));
    EXPECT_TRUE(has(fault(kFirstLine + block("fx: 1").substr(0, 6)), "ends within a camera"));
    EXPECT_TRUE(has(fault(kFirstLine + number(~std::uint32_t{0})), "announces a camera of 4294967295 bytes"));
    EXPECT_TRUE(has(fault(kFirstLine + block("fx: 30, gx: [")), "raw:-, camera: is not YAML"));
    EXPECT_TRUE(has(fault(kFirstLine + block("{fx: 30, fy: 30, cx: 15, cy: 11, width: 32}")), "raw:-, camera: "));
    EXPECT_TRUE(has(open_fault("raw:somewhere"), "write raw:-"));
}

TEST_F(RawStream, IsLostWhereItIsCutOffOrOutOfStep) {
    const std::string whole = begin() + raw(0);
    for (std::size_t size = begin().size() + 1; size < whole.size(); size += 37) {
        EXPECT_THROW((void)open(whole.substr(0, size))->read(0), SourceLost) << size;
        EXPECT_TRUE(has(read_fault(whole.substr(0, size)), "ends within a frame")) << size;
    }
    EXPECT_THROW((void)open(begin() + "out of step")->read(0), SourceLost);
    EXPECT_TRUE(has(read_fault(begin() + "out of step"), "announces a frame of 544503151 bytes, more than the"));
    // memory is not taken for what is only announced
    EXPECT_TRUE(has(read_fault(begin() + number(~std::uint32_t{0})), "announces a frame of 4294967295 bytes"));
    EXPECT_TRUE(has(read_fault(begin() + block(number(~std::uint64_t{0}) + number(std::uint64_t{0}) + block(""))),
                    "frame 0: its time stamp is no time in nanoseconds"));
}

TEST_F(RawStream, AFrameThatCannotBeReadLeavesTheOthers) {
    const RawFrame bad = make_frame(1);
    const std::string content = begin() + raw(0) + frame_of(bad, "no image", bytes_of(bad.depth)) +
                                frame_of(bad, bytes_of(bad.color), "no image") + block("short") + raw(1) + raw(5);
    const auto source = open(content);
    (void)source->read(0);
    std::string faults;
    int read = 0;
    try {
        for (;;) {
            try {
                (void)source->read(0);
                ++read;
            } catch (const SourceLost&) {
                throw;
            } catch (const Error& error) {
                faults += std::string(error.what()) + "\n";
            }
        }
    } catch (const SourceEnded&) {
    }
    EXPECT_EQ(read, 1) << faults;
    EXPECT_TRUE(has(faults, "raw:-, frame 1, colour: ")) << faults;
    EXPECT_TRUE(has(faults, "raw:-, frame 2: its time stamp is not later than the one before it")) << faults;
    EXPECT_TRUE(has(faults, "raw:-, frame 3: is damaged: it ends within a record")) << faults;
}

/// A wait ends at once, not when patience does, wherever the stream falls silent.
TEST(RawStreamPipe, WaitingCanBeCancelled) {
    const auto interrupted_after = [](const std::string& content) {
        int ends[2];
        EXPECT_EQ(pipe(ends), 0);
        EXPECT_EQ(write(ends[1], content.data(), content.size()), static_cast<ssize_t>(content.size()));
        std::atomic<bool> cancelled = false;
        SourceOptions options;
        options.cancelled = [&] { return cancelled.load(); };
        Stamp end{};
        std::thread interrupter([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            end = std::chrono::steady_clock::now().time_since_epoch();
            cancelled = true;
        });
        EXPECT_THROW(
            {
                const auto source = open_raw_stream(ends[0], "raw:-", options);
                for (;;) (void)source->read(0);
            },
            SourceCancelled);
        const Stamp late = std::chrono::steady_clock::now().time_since_epoch();
        interrupter.join();
        for (const int descriptor : ends) close(descriptor);
        return late - end;
    };
    const std::string whole = begin() + raw(0);
    for (const std::string& content : {std::string(), begin(), whole, whole.substr(0, whole.size() - 7)})
        EXPECT_LT(interrupted_after(content), std::chrono::seconds(1)) << content.size() << " bytes";
}

TEST(RawStreamPipe, WaitsForFramesThatComeInPieces) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    std::thread feeder([&] {
        for (const char byte : begin() + raw(0)) ASSERT_EQ(write(ends[1], &byte, 1), 1);
        close(ends[1]);
    });
    const auto source = open_raw_stream(ends[0], "raw:-", {});
    EXPECT_EQ(bytes_of(source->read(0).color), bytes_of(make_frame(0).color));
    EXPECT_THROW((void)source->read(0), SourceEnded);
    feeder.join();
    close(ends[0]);
}

}  // namespace
}  // namespace posefusion::test
