#include <functional>
#include <memory>

#include "tests/hosts/io/sources/cdr_writer.hpp"
#include "tests/hosts/io/sources/db3_writer.hpp"
#include "tests/hosts/io/sources/frames.hpp"
#include "tests/hosts/io/sources/mcap_writer.hpp"
#include "tests/hosts/io/sources/rvl_writer.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

// The names of RealSense's driver.
constexpr const char *kColorTopic = "/camera/color/image_raw",
                     *kDepthTopic = "/camera/aligned_depth_to_color/image_raw",
                     *kInfoTopic = "/camera/color/camera_info";
constexpr const char *kImage = "sensor_msgs/msg/Image", *kCompressed = "sensor_msgs/msg/CompressedImage",
                     *kInfo = "sensor_msgs/msg/CameraInfo";
const std::vector<double> kK{30.25, 0, 15.5, 0, 30.5, 11.125, 0, 0, 1};

template <class Pixels>
std::string bytes_of(const Pixels& image) {
    return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(*image.data())};
}

std::uint64_t nanoseconds(const RawFrame& frame) { return static_cast<std::uint64_t>(frame.stamp.count()); }

template <class Writer>
void add_camera(Writer& bag, bool big_endian = false) {
    bag.add(kInfoTopic, kInfo, 1, cdr_camera_info(kWidth, kHeight, kK, {}, "camera", big_endian));
}

/// @param header  the time that the driver writes
template <class Writer>
void add_color(Writer& bag, const RawFrame& frame, std::uint64_t header, bool big_endian = false) {
    bag.add(kColorTopic, kImage, nanoseconds(frame),
            cdr_image({header, kWidth, kHeight, "rgb8", bytes_of(frame.color)}, big_endian));
}
template <class Writer>
void add_depth(Writer& bag, const RawFrame& frame, std::uint64_t header, bool big_endian = false) {
    bag.add(kDepthTopic, kImage, nanoseconds(frame),
            cdr_image({header, kWidth, kHeight, "16UC1", bytes_of(frame.depth)}, big_endian));
}
template <class Writer>
void add_frame(Writer& bag, int i) {
    const RawFrame frame = make_frame(i);
    add_color(bag, frame, nanoseconds(frame));
    add_depth(bag, frame, nanoseconds(frame));
}

McapWriter good_mcap(const McapWriter::Options& options = {}, int frames = 3) {
    McapWriter bag(options);
    add_camera(bag);
    for (int i = 0; i < frames; ++i) {
        add_frame(bag, i);
        bag.end_chunk();
    }
    return bag;
}

fs::path write_db3(const fs::path& file, int first, int end) {
    Db3Writer bag(file);
    if (first == 0) add_camera(bag);
    for (int i = first; i < end; ++i) add_frame(bag, i);
    return file;
}

void expect_frames(const FrameSource& source, std::size_t count) {
    ASSERT_EQ(source.size(), count);
    EXPECT_EQ(source.camera().intrinsics.fy, 30.5f);
    EXPECT_EQ(source.camera().intrinsics.cy, 11.125f);
    EXPECT_EQ(source.camera().depth_scale, 1000);
    for (std::size_t i = count; i-- > 0;) expect_same(source.read(i), make_frame(static_cast<int>(i)));
}

void expect_no_warnings(const FrameSource& source) {
    EXPECT_TRUE(source.facts().warnings.empty()) << source.facts().warnings.front();
}

std::string all_warnings(const FrameSource& source) {
    std::string all;
    for (const std::string& warning : source.facts().warnings) all += warning + "\n";
    return all;
}

class Mcap : public testing::Test {
protected:
    fs::path write(const std::string& content) const { return folder.write("a.mcap", content); }
    std::string fault(const std::string& content) const { return open_fault(write(content)); }
    TempFolder folder;
};

class McapRoundTrip : public testing::TestWithParam<std::tuple<const char*, bool, bool>> {};

TEST_P(McapRoundTrip, GivesWhatWentIn) {
    const TempFolder folder;
    const auto [packing, indexed, closed] = GetParam();
    McapWriter::Options options;
    options.packing = packing;
    options.indexed = indexed;
    const auto source = open_source(folder.write("a.mcap", good_mcap(options).finish(closed)));
    expect_frames(*source, 3);
    EXPECT_EQ(source->facts().name, "a");
    if (closed) return expect_no_warnings(*source);
    EXPECT_TRUE(has(all_warnings(*source), "was not closed, as when its recording was interrupted; what comes before"));
}
INSTANTIATE_TEST_SUITE_P(All, McapRoundTrip,
                         testing::Combine(testing::Values("", "lz4", "zstd"), testing::Bool(), testing::Bool()));

TEST_F(Mcap, WithoutChunksIsRead) {
    McapWriter::Options options;
    options.chunked = false;
    for (const bool closed : {true, false}) expect_frames(*open_source(write(good_mcap(options).finish(closed))), 3);
}

/// As tools convert the bags of ROS 1.
TEST_F(Mcap, WithMessagesOfRos1IsRead) {
    McapWriter::Options options;
    options.encoding = "ros1";
    McapWriter bag(options);
    const auto ros1 = [](const std::string& cdr) { return McapWriter::number(std::uint32_t{7}) + cdr; };
    const auto text = [](const std::string& t) { return McapWriter::text(t); };
    const auto u32 = [](std::uint32_t n) { return McapWriter::number(n); };
    const RawFrame frame = make_frame(0);
    const std::uint64_t t = nanoseconds(frame);
    const std::string header = ros1(u32(static_cast<std::uint32_t>(t / 1'000'000'000)) +
                                    u32(static_cast<std::uint32_t>(t % 1'000'000'000)) + text("camera"));
    const auto image = [&](const char* encoding, const std::string& data) {
        return header + u32(kHeight) + u32(kWidth) + text(encoding) + '\0' +
               u32(static_cast<std::uint32_t>(data.size() / kHeight)) + text(data);
    };
    std::string info = header + u32(kHeight) + u32(kWidth) + text("plumb_bob") + u32(0);
    for (const double k : kK) info += McapWriter::number(k);
    info += std::string((9 + 12) * sizeof(double) + 25, '\0');
    bag.add(kInfoTopic, "sensor_msgs/CameraInfo", t, info);
    bag.add(kColorTopic, "sensor_msgs/Image", t, image("rgb8", bytes_of(frame.color)));
    bag.add(kDepthTopic, "sensor_msgs/Image", t, image("16UC1", bytes_of(frame.depth)));
    expect_frames(*open_source(write(bag.finish())), 1);
}

/// Whatever is cut off its end, the frames that are whole are read and the rest is told, or it is one line.
TEST_F(Mcap, CutOffAnywhereIsUsedAsFarAsItIsWhole) {
    for (const char* packing : {"", "lz4", "zstd"}) {
        McapWriter::Options options;
        options.packing = packing;
        std::vector<std::size_t> whole;  // bytes up to which so many frames are there
        for (const int frames : {1, 2, 3}) whole.push_back(good_mcap(options, frames).finish(false).size());
        const std::string content = good_mcap(options).finish();
        for (std::size_t size = whole[0]; size < content.size(); size += 41) {
            const auto source = open_source(write(content.substr(0, size)));
            const std::size_t frames = size >= whole[2] ? 3 : size >= whole[1] ? 2 : 1;
            // the indices behind a chunk may be cut off without harm
            ASSERT_GE(source->size(), frames) << packing << ", " << size;
            expect_frames(*source, source->size());
            const bool complete = size + McapWriter::magic().size() >= content.size();
            EXPECT_TRUE(complete || has(all_warnings(*source), "what comes before is used")) << size;
        }
        for (std::size_t size = 0; size < whole[0] - 400; size += 97)
            EXPECT_NE(fault(content.substr(0, size)), "") << packing << ", " << size;
    }
}

TEST_F(Mcap, OtherFilesAreRefused) {
    EXPECT_TRUE(has(fault(""), "is not an MCAP file"));
    EXPECT_TRUE(has(fault(std::string(5000, 'a')), "is not an MCAP file"));
    EXPECT_TRUE(has(fault("\x89MCAP1\r\n........"), "is not an MCAP file"));
    EXPECT_TRUE(has(fault(McapWriter::begin()), "was not closed"));
    EXPECT_TRUE(has(fault(McapWriter().finish()), "holds no messages"));
    McapWriter::Options options;
    options.encoding = "protobuf";
    EXPECT_TRUE(has(fault(good_mcap(options).finish()), "are of encoding 'protobuf'; those of ROS"));
    options = {};
    options.packing = "snappy";
    EXPECT_TRUE(has(fault(good_mcap(options).finish()), "packed in a way that is not known ('snappy')"));
}

TEST_F(Mcap, WrongLengthsAreFaults) {
    const auto with = [](const std::string& record) { return McapWriter::begin() + record; };
    const auto number = [](std::uint64_t n) { return McapWriter::number(n); };
    EXPECT_TRUE(has(fault(with("\x05" + number(~std::uint64_t{0}))), "ends early"));
    EXPECT_TRUE(has(fault(with(McapWriter::record(5, "ab"))), "ends within a record"));
    const auto chunk = [&](std::uint64_t bytes, const std::string& packing, std::uint64_t packed) {
        return with(McapWriter::record(6, number(0) + number(0) + number(bytes) + McapWriter::number(std::uint32_t{0}) +
                                              McapWriter::text(packing) + number(packed) + "tiny"));
    };
    EXPECT_TRUE(has(fault(chunk(4, "", 5)), "a chunk ends within its messages"));
    EXPECT_TRUE(has(fault(chunk(200U << 20, "zstd", 4)), "claims to be enormous"));
    EXPECT_TRUE(has(fault(chunk(200U << 20, "lz4", 4)), "claims to be enormous"));
    EXPECT_TRUE(has(fault(chunk(std::uint64_t{1} << 40, "zstd", 4)), "more than 256 MiB"));
    EXPECT_TRUE(has(fault(chunk(100, "zstd", 4)), "cannot be unpacked"));
    EXPECT_TRUE(has(fault(chunk(100, "lz4", 4)), "cannot be unpacked"));
}

TEST_F(Mcap, AChunkThatDoesNotFitItsChecksumIsDamaged) {
    McapWriter::Options options;
    options.packing = "lz4";
    std::string content = good_mcap(options).finish();
    const std::size_t second = content.find("lz4", content.find("lz4") + 1);
    content[second - 8] = static_cast<char>(content[second - 8] ^ 1);  // its checksum
    const auto source = open_source(write(content));
    ASSERT_EQ(source->size(), 2u);
    expect_same(source->read(1), make_frame(2));
    EXPECT_TRUE(has(all_warnings(*source), "the checksum of a chunk does not fit (1 message left out)"));
}

TEST_F(Mcap, NoDamageDoesHarm) {
    for (const char* packing : {"", "lz4", "zstd"}) {
        McapWriter::Options options;
        options.packing = packing;
        expect_no_harm_in_damage(write(good_mcap(options, 1).finish()), packing[0] == '\0' ? 151 : 73);
    }
}

class Db3 : public testing::Test {
protected:
    fs::path file() const { return folder / "a.db3"; }
    TempFolder folder;
};

TEST_F(Db3, RoundTripGivesWhatWentIn) {
    const auto source = open_source(write_db3(file(), 0, 3));
    expect_frames(*source, 3);
    expect_no_warnings(*source);
    EXPECT_EQ(source->facts().name, "a");
}

TEST_F(Db3, MayHaveAnyNameAndLieOnAReadOnlyDisk) {
    const fs::path odd = folder / "50% of #1?.db3";
    write_db3(odd, 0, 1);
    fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
    expect_frames(*open_source(odd), 1);
    fs::permissions(folder.path(), fs::perms::owner_all);
}

TEST_F(Db3, WhatAnInterruptedRecordingLeftInTheWriteAheadLogIsUsed) {
    const fs::path crashed = folder / "crashed.db3";
    {
        Db3Writer bag(file());
        bag.run("PRAGMA journal_mode=WAL; PRAGMA wal_autocheckpoint=0;");
        add_camera(bag);
        for (int i = 0; i < 3; ++i) add_frame(bag, i);
        fs::copy(file(), crashed);  // as the disk is when the recorder is killed now
        fs::copy(folder / "a.db3-wal", folder / "crashed.db3-wal");
    }
    const auto source = open_source(crashed);
    expect_frames(*source, 3);
    EXPECT_TRUE(has(all_warnings(*source), "crashed.db3-wal is used, too")) << all_warnings(*source);
    EXPECT_TRUE(fs::exists(folder / "crashed.db3-wal")) << "a recording is not changed by reading it";
}

TEST_F(Db3, AnUnfinishedTransactionIsTold) {
    write_db3(file(), 0, 1);
    folder.write("a.db3-journal", "half a page");
    const std::string fault = open_fault(file());
    EXPECT_TRUE(has(fault, "interrupted while it was written; `sqlite3 ")) << fault;
}

TEST_F(Db3, OtherDatabasesAndFilesAreRefused) {
    EXPECT_TRUE(has(open_fault(folder.write("a.db3", "")), "is not an SQLite database"));
    EXPECT_TRUE(has(open_fault(folder.write("a.db3", std::string(5000, 'a'))), "is not an SQLite database"));
    const auto spoilt = [&](const std::string& statements) {
        fs::remove(file());
        {
            Db3Writer bag(file());
            add_camera(bag);
            add_frame(bag, 0);
            bag.run(statements);
        }
        return open_fault(file());
    };
    EXPECT_EQ(spoilt(""), "");
    EXPECT_TRUE(has(spoilt("DROP TABLE messages"), "is not a bag of rosbag2: it has no table 'messages'"));
    EXPECT_TRUE(has(spoilt("DROP TABLE topics"), "is not a bag of rosbag2: it has no table 'topics'"));
    EXPECT_TRUE(
        has(spoilt("DROP TABLE messages; CREATE VIEW messages AS SELECT 1 AS id, 1 AS topic_id, 1 AS timestamp"),
            "no table 'messages'"));
    EXPECT_TRUE(has(spoilt("DELETE FROM messages"), "holds no messages"));
    EXPECT_TRUE(has(spoilt("UPDATE topics SET serialization_format = 'protobuf'"), "are of encoding 'protobuf'"));
    EXPECT_TRUE(has(spoilt("ALTER TABLE messages DROP COLUMN topic_id"), "its messages cannot be read"));
}

TEST_F(Db3, CutOffAnywhereIsUsedAsFarAsItCanBeRead) {
    write_db3(file(), 0, 12);
    const std::string content = read_all(file());
    std::size_t partly = 0;
    for (std::size_t size = 0; size < content.size(); size += 1531) {
        write_bytes(file(), content.substr(0, size));
        const std::string fault = open_fault(file());
        if (!fault.empty()) continue;
        ++partly;
        read_whatever_is_there(file());
        EXPECT_FALSE(open_source(file())->facts().warnings.empty()) << size;
    }
    EXPECT_GT(partly, 0u);
}

TEST_F(Db3, NoDamageDoesHarm) { expect_no_harm_in_damage(write_db3(file(), 0, 1), 211); }

class Rosbag2 : public testing::Test {
protected:
    fs::path bag() const { return folder / "bag"; }
    /// As rosbag2 closes a recording of these files.
    void write_metadata(const std::vector<std::string>& files) const {
        std::string text =
            "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n"
            "  relative_file_paths:\n";
        for (const std::string& name : files) text += "    - " + name + "\n";
        folder.write("bag/metadata.yaml", text);
    }
    void write_split_bag() const {
        write_metadata({"bag_0.db3", "bag_1.db3", "bag_10.mcap"});
        write_db3(bag() / "bag_0.db3", 0, 2);
        write_db3(bag() / "bag_1.db3", 2, 3);
        McapWriter last;
        for (int i = 3; i < 5; ++i) {
            const RawFrame frame = make_frame(i);  // the topics have other numbers than in the other files
            add_depth(last, frame, nanoseconds(frame));
            add_color(last, frame, nanoseconds(frame));
        }
        folder.write("bag/bag_10.mcap", last.finish());
    }
    TempFolder folder;
};

TEST_F(Rosbag2, AFolderOfSeveralFilesIsOneRecording) {
    write_split_bag();
    for (const fs::path& location : {bag(), bag() / ""}) {
        const auto source = open_source(location);
        expect_frames(*source, 5);
        expect_no_warnings(*source);
        EXPECT_EQ(source->facts().name, "bag");
    }
}

TEST_F(Rosbag2, FilesThatAreMissingOrDamagedAreTold) {
    write_split_bag();
    fs::remove(bag() / "bag_10.mcap");
    const auto source = open_source(bag());
    expect_frames(*source, 3);
    EXPECT_TRUE(has(all_warnings(*source), "bag_10.mcap: is named by metadata.yaml and is missing"));
    folder.write("bag/bag_1.db3", "rubbish");
    const auto less = open_source(bag());
    expect_frames(*less, 2);
    EXPECT_TRUE(
        has(all_warnings(*less), "bag_1.db3: is not an SQLite database as rosbag2 writes it; this file is left"));
    fs::remove(bag() / "bag_0.db3");
    EXPECT_TRUE(has(open_fault(bag()), "bag_1.db3: is not an SQLite database"));
    fs::remove(bag() / "bag_1.db3");
    EXPECT_TRUE(has(open_fault(bag()), "bag_0.db3: is named by metadata.yaml and is missing"));
}

TEST_F(Rosbag2, AnInterruptedRecordingHasNoMetadata) {
    write_split_bag();
    fs::remove(bag() / "metadata.yaml");
    const auto source = open_source(bag());
    expect_frames(*source, 5);
    EXPECT_TRUE(has(all_warnings(*source), "has no metadata.yaml, as when a recording was interrupted"));
    folder.write("bag/metadata.yaml", "rosbag2_bagfile_information: [");
    EXPECT_TRUE(has(all_warnings(*open_source(bag())), "metadata.yaml: is damaged"));
}

TEST_F(Rosbag2, PackedFilesAreUnpacked) {
    write_metadata({"bag_0.db3.zstd", "bag_1.mcap.zstd"});
    write_db3(folder / "plain.db3", 0, 2);
    folder.write("bag/bag_0.db3.zstd", pack_zstd(read_all(folder / "plain.db3")));
    McapWriter last;
    add_frame(last, 2);
    folder.write("bag/bag_1.mcap.zstd", pack_zstd(last.finish()));
    const auto source = open_source(bag());
    expect_frames(*source, 3);
    expect_no_warnings(*source);
    expect_frames(*open_source(bag() / "bag_0.db3.zstd"), 2);

    const std::string packed = read_all(bag() / "bag_0.db3.zstd");
    for (const std::size_t size : {std::size_t{0}, std::size_t{3}, packed.size() / 2, packed.size() - 1})
        EXPECT_NE(open_fault(folder.write("cut.db3.zstd", packed.substr(0, size))), "") << size;
    EXPECT_TRUE(has(open_fault(folder.write("cut.db3.zstd", packed.substr(0, packed.size() - 1))), "ends early"));
    EXPECT_TRUE(has(open_fault(folder.write("not.mcap.zstd", "something else")), "not.mcap.zstd: cannot be unpacked"));
}

/// What a bag of ROS 2 tells does not depend on the kind of file: McapWriter stands for all.
class Ros2Messages : public Mcap {};

TEST_F(Ros2Messages, MayBePackedOneByOne) {
    struct PackingWriter : McapWriter {
        void add(const std::string& topic, const std::string& type, std::uint64_t time, const std::string& message) {
            McapWriter::add(topic, type, time, pack_zstd(message));
        }
    } bag;
    add_camera(bag);
    for (int i = 0; i < 3; ++i) add_frame(bag, i);
    expect_frames(*open_source(write(bag.finish())), 3);
}

TEST_F(Ros2Messages, OfEitherByteOrderAreRead) {
    McapWriter bag;
    add_camera(bag, true);
    const RawFrame frame = make_frame(0);
    add_color(bag, frame, nanoseconds(frame), true);
    add_depth(bag, frame, nanoseconds(frame), true);
    expect_frames(*open_source(write(bag.finish())), 1);
}

TEST_F(Ros2Messages, PixelsMayBeInTheOtherByteOrder) {
    McapWriter bag;
    add_camera(bag);
    const RawFrame frame = make_frame(0);
    add_color(bag, frame, nanoseconds(frame));
    std::string swapped = bytes_of(frame.depth);
    for (std::size_t i = 0; i < swapped.size(); i += 2) std::swap(swapped[i], swapped[i + 1]);
    bag.add(kDepthTopic, kImage, nanoseconds(frame),
            cdr_image({nanoseconds(frame), kWidth, kHeight, "16UC1", swapped, "camera", true}));
    expect_frames(*open_source(write(bag.finish())), 1);
}

/// Texts of every length: what comes after them is aligned.
TEST_F(Ros2Messages, AreAligned) {
    for (const std::string frame_id : {"", "c", "ca", "cam", "camera", "camera_color_optical_frame"}) {
        McapWriter bag;
        bag.add(kInfoTopic, kInfo, 1, cdr_camera_info(kWidth, kHeight, kK, {0.1, 0, 0, 0, 0}, frame_id));
        const RawFrame frame = make_frame(0);
        const std::uint64_t t = nanoseconds(frame);
        bag.add(kColorTopic, kImage, t, cdr_image({t, kWidth, kHeight, "rgb8", bytes_of(frame.color), frame_id}));
        bag.add(kDepthTopic, kImage, t, cdr_image({t, kWidth, kHeight, "16UC1", bytes_of(frame.depth), frame_id}));
        const auto source = open_source(write(bag.finish()));
        expect_frames(*source, 1);
        EXPECT_EQ(source->camera().distortion[0], 0.1f);
    }
}

TEST_F(Ros2Messages, CompressedImagesAreRead) {
    const RawFrame frame = make_frame(1);
    const std::uint64_t t = nanoseconds(frame);
    write_raw_depth(folder / "d.png", frame.depth);
    const ByteBuffer stream = encode_rvl(frame.depth);
    const std::string png = read_all(folder / "d.png"), rvl = McapWriter::number(std::uint32_t{kWidth}) +
                                                              McapWriter::number(std::uint32_t{kHeight}) +
                                                              std::string(stream.begin(), stream.end());
    for (const auto& [format, packed] : {std::pair<std::string, std::string>{"16UC1; compressedDepth png", png},
                                         {"16UC1; compressedDepth rvl", rvl}}) {
        McapWriter bag;
        add_camera(bag);
        bag.add("/camera/color/image_raw/compressed", kCompressed, t,
                cdr_compressed_image(t, "rgb8; png compressed bgr8", encode_png(frame.color)));
        bag.add("/camera/aligned_depth_to_color/image_raw/compressedDepth", kCompressed, t,
                cdr_compressed_image(t, format, std::string(12, '\0') + packed));
        expect_same(open_source(write(bag.finish()))->read(0), frame);
    }
}

/// The depth that is aligned to colour goes before that of the depth camera, as in bags of ROS 1.
TEST_F(Ros2Messages, TopicsAreChosenAsInBagsOfRos1) {
    McapWriter bag = good_mcap();
    const RawFrame other = make_frame(7);
    bag.add("/camera/depth/camera_info", kInfo, 1,
            cdr_camera_info(kWidth, kHeight, {20, 0, 9, 0, 20, 9, 0, 0, 1}, {}, "depth"));
    bag.add("/camera/depth/image_rect_raw", kImage, nanoseconds(make_frame(0)),
            cdr_image({nanoseconds(make_frame(0)), kWidth, kHeight, "16UC1", bytes_of(other.depth), "depth"}));
    bag.add("/imu", "sensor_msgs/msg/Imu", 1, "rubbish");
    const auto source = open_source(write(bag.finish()));
    expect_frames(*source, 3);
    EXPECT_TRUE(has(all_warnings(*source), "not from /camera/depth/image_rect_raw")) << all_warnings(*source);
    SourceOptions options;
    options.depth_topic = "/camera/depth/image_rect_raw";
    EXPECT_EQ(open_source(folder / "a.mcap", options)->size(), 1u);
}

TEST_F(Ros2Messages, RawDepthIsRegisteredByItsCameraAndTf) {
    std::vector<std::uint16_t> depth(kWidth * kHeight, 2000);
    for (std::size_t i = 0; i < depth.size(); ++i)
        if (i % kWidth < 16) depth[i] = 0;  // nothing on the left
    McapWriter bag;
    const auto camera_info = [](double f, const char* frame) {
        return cdr_camera_info(kWidth, kHeight, {f, 0, 15.5, 0, f, 11.5, 0, 0, 1}, {}, frame);
    };
    bag.add("/cam/rgb/camera_info", kInfo, 5, camera_info(20, "rgb_frame"));
    bag.add("/cam/depth/camera_info", kInfo, 5, camera_info(20.2, "depth_frame"));
    bag.add("/cam/rgb/image_raw", kImage, 5,
            cdr_image({5, kWidth, kHeight, "rgb8", std::string(kWidth * kHeight * 3, 'c'), "rgb_frame"}));
    bag.add("/cam/depth/image_raw", kImage, 5,
            cdr_image({5, kWidth, kHeight, "16UC1", bytes_of(depth), "depth_frame"}));
    bag.add("/tf_static", "tf2_msgs/msg/TFMessage", 5, cdr_transform("rgb_frame", "depth_frame", -0.2));
    const auto source = open_source(write(bag.finish()));
    const RawDepth registered = source->read(0).depth;
    int u = 0;
    while (u < kWidth && registered(u, 12) == 0) ++u;
    EXPECT_EQ(u, 14) << "depth is 0.2 m left of colour: 2 pixels at 2 m";
    EXPECT_TRUE(has(all_warnings(*source), "and the transform between the cameras")) << all_warnings(*source);
}

TEST_F(Ros2Messages, WithoutHeaderStampsHaveTheTimesOfRecording) {
    McapWriter bag;
    add_camera(bag);
    for (int i = 0; i < 3; ++i) {
        add_color(bag, make_frame(i), 0);
        add_depth(bag, make_frame(i), 0);
    }
    const auto source = open_source(write(bag.finish()));
    expect_frames(*source, 3);
    EXPECT_TRUE(has(all_warnings(*source), "are all alike; the times of recording are used instead"));
}

TEST_F(Ros2Messages, OfOtherSerialisationsAreRefused) {
    const auto fault_of = [&](const std::string& encapsulation) {
        McapWriter bag;
        std::string info = cdr_camera_info(kWidth, kHeight, kK);
        bag.add(kInfoTopic, kInfo, 1, info.replace(0, 2, encapsulation));
        add_frame(bag, 0);
        return open_fault(write(bag.finish()));
    };
    EXPECT_EQ(fault_of(std::string("\0\1", 2)), "");
    EXPECT_TRUE(has(fault_of(std::string("\0\3", 2)), "is not serialised as ROS 2 does it"));
    EXPECT_TRUE(has(fault_of("ab"), "is not serialised as ROS 2 does it"));
}

}  // namespace
}  // namespace posefusion::test
