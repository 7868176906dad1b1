// Recordings with videos in them: Azure Kinect and Stray Scanner.
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hosts/io/output_file.hpp"
#include "hosts/io/sources/video/azure_calibration.hpp"
#include "hosts/io/sources/video/stray_source.hpp"
#include "hosts/io/sources/video/video_file.hpp"
#include "tests/hosts/io/sources/frames.hpp"
#include "tests/hosts/io/sources/mkv_writer.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A real device's, as https://github.com/panispani/3DReconstruct/blob/master/pointCloudGen/calib.md has it.
Json calibration() {
    const auto camera = [](const char* location, const Json& parameters, const Json& rotation, const Json& shift) {
        return Json{{"Location", location},
                    {"Intrinsics",
                     {{"ModelType", "CALIBRATION_LensDistortionModelBrownConrady"},
                      {"ModelParameterCount", 14},
                      {"ModelParameters", parameters}}},
                    {"Rt", {{"Rotation", rotation}, {"Translation", shift}}}};
    };
    const Json none{1, 0, 0, 0, 1, 0, 0, 0, 1};
    const Json depth =
        camera("CALIBRATION_CameraLocationD0",
               {0.5122697949409485, 0.49451231956481934, 0.4921168386936188, 0.4921667277812958, 3.1305770874023438,
                2.324939012527466, 0.1304156482219696, 3.458651542663574, 3.350114583969116, 0.6629416346549988, 0, 0,
                -0.0000511557373101823, 0.00008132171933539212},
               none, {0, 0, 0});
    const Json color =
        camera("CALIBRATION_CameraLocationPV0",
               {0.4967627227306366, 0.5108628273010254, 0.470907062292099, 0.6274453997612, 0.7227460145950317,
                -2.8855903148651123, 1.6327226161956787, 0.6021990180015564, -2.7196262781882, 1.565053105354309, 0, 0,
                -0.0001431911950930953, 0.0007828465895727277},
               none, {-0.032, -0.002, 0.004});
    return {{"CalibrationInformation", {{"Cameras", {depth, color}}}}};
}

TEST(AzureCalibration, HasTheValuesOfTheSdk) {  // of the same page
    const CameraDescription camera = parse_azure_calibration(calibration().dump(), {1920, 1080}, {640, 576}, "a.mkv");
    const Intrinsics& color = camera.camera.intrinsics;
    EXPECT_NEAR(color.fx, 904.141541f, 1e-3f);
    EXPECT_NEAR(color.fy, 903.521362f, 1e-3f);
    EXPECT_NEAR(color.cx, 953.284424f, 1e-3f);
    EXPECT_NEAR(color.cy, 555.142456f, 1e-3f);
    EXPECT_FLOAT_EQ(camera.camera.distortion[0], 0.722746f) << "k1";
    EXPECT_FLOAT_EQ(camera.camera.distortion[2], 0.00078284659f) << "p1";
    EXPECT_FLOAT_EQ(camera.camera.distortion[3], -0.0001431912f) << "p2";
    EXPECT_FLOAT_EQ(camera.camera.distortion[7], 1.565053f) << "k6";
    EXPECT_EQ(camera.camera.depth_scale, 1000);
    ASSERT_TRUE(camera.depth);
    EXPECT_NEAR(camera.depth->intrinsics.fx, 503.927643f, 1e-3f);
    EXPECT_NEAR(camera.depth->intrinsics.fy, 503.978729f, 1e-3f);
    EXPECT_NEAR(camera.depth->intrinsics.cx, 332.064270f, 1e-3f);
    EXPECT_NEAR(camera.depth->intrinsics.cy, 325.880615f, 1e-3f);
    EXPECT_TRUE(camera.depth->T_color_depth.translation().isApprox(Eigen::Vector3f(-0.032f, -0.002f, 0.004f)));
}

TEST(AzureCalibration, FaultsAreNamed) {
    const auto fault = [](const Json& json, ImageSize depth = {640, 576}) {
        const auto text = json.is_string() ? json.get<std::string>() : json.dump();
        return message_of<Error>([&] { (void)parse_azure_calibration(text, {1280, 720}, depth, "a.mkv"); });
    };
    EXPECT_TRUE(has(fault("{"), "a.mkv: calibration.json is damaged"));
    EXPECT_TRUE(has(fault(calibration(), {640, 480}), "of no mode of an Azure Kinect"));
    Json json = calibration();
    json["CalibrationInformation"]["Cameras"].erase(1);
    EXPECT_TRUE(has(fault(json), "lacks the camera of colour or depth"));
    json = calibration();
    Json& color = json["CalibrationInformation"]["Cameras"][1];
    color["Rt"]["Rotation"][0] = 2;
    EXPECT_TRUE(has(fault(json), "no rotation"));
    color["Intrinsics"]["ModelParameters"][10] = 0.1;
    EXPECT_TRUE(has(fault(json), "a lens model that is not known"));
    color["Intrinsics"]["ModelParameters"] = {1, 2};
    EXPECT_TRUE(has(fault(json), "damaged"));
}

class Video : public ::testing::Test {
protected:
    void SetUp() override {
        if (!has_video()) GTEST_SKIP() << "built without video";
    }
    TempFolder folder;
};

class AzureRecording : public Video {
protected:
    static constexpr ImageSize kColor{64, 36}, kDepth{320, 288};
    static constexpr int kFrames = 4;

    /// Colour of one shade, and a wall whose distance grows by 10 mm a frame; both as the device codes them.
    static MkvWriter recording(const std::string& fourcc = "b16g", const std::string& depth_name = "DEPTH",
                               const std::string& coding = "MJPG") {
        MkvWriter out;
        out.add_track("COLOR", coding, kColor.width, kColor.height);
        out.add_track(depth_name, fourcc, kDepth.width, kDepth.height);
        for (int i = 0; i < kFrames; ++i) {
            const auto time = static_cast<std::uint64_t>(33333 * i);
            out.add(1, time, coded(coding, shade(i)));
            std::string depth;
            for (int p = 0; p < kDepth.width * kDepth.height; ++p) {
                const auto low = static_cast<char>(millimetres(i)), high = static_cast<char>(millimetres(i) >> 8);
                depth += fourcc == "b16g" ? high : low;
                depth += fourcc == "b16g" ? low : high;
            }
            out.add(2, time + 2000, depth);
        }
        return out;
    }
    /// An image of one shade as the device gives it in each of its modes.
    static std::string coded(const std::string& coding, Rgb8 c) {
        if (coding == "MJPG") return encode_jpeg(ColorImage(kColor.width, kColor.height, c), 95);
        constexpr std::size_t kPixels = static_cast<std::size_t>(kColor.width) * kColor.height;
        const auto repeated = [](const std::string& bytes, std::size_t times) {
            std::string all;
            for (std::size_t i = 0; i < times; ++i) all += bytes;
            return all;
        };
        const auto text = [](std::initializer_list<double> values) {
            std::string bytes;
            for (const double value : values) bytes += static_cast<char>(std::lround(value));
            return bytes;
        };
        if (coding == "BGRA") return repeated(text({double(c.b), double(c.g), double(c.r), 255.0}), kPixels);
        // ITU-R BT.601, the range of video
        const double y = 16 + 0.257 * c.r + 0.504 * c.g + 0.098 * c.b,
                     u = 128 - 0.148 * c.r - 0.291 * c.g + 0.439 * c.b,
                     v = 128 + 0.439 * c.r - 0.368 * c.g - 0.071 * c.b;
        if (coding == "YUY2") return repeated(text({y, u, y, v}), kPixels / 2);
        return repeated(text({y}), kPixels) + repeated(text({u, v}), kPixels / 4);  // NV12
    }
    static Rgb8 shade(int i) { return {static_cast<std::uint8_t>(40 + 40 * i), 90, 160}; }
    static int millimetres(int i) { return 1500 + 10 * i; }

    void expect_frame(const RawFrame& frame, int i) const {
        EXPECT_EQ(frame.stamp, std::chrono::microseconds(33333 * i));
        EXPECT_EQ(frame.depth_delay, std::chrono::milliseconds(2));
        ASSERT_EQ(frame.color.width(), kColor.width);
        EXPECT_NEAR(frame.color(30, 20).r, shade(i).r, 3);
        EXPECT_NEAR(frame.color(30, 20).g, shade(i).g, 3);
        EXPECT_NEAR(frame.color(30, 20).b, shade(i).b, 3);
        ASSERT_EQ(frame.depth.width(), kColor.width) << "registered to colour";
        EXPECT_NEAR(frame.depth(32, 18), millimetres(i) + 4, 1) << "colour is 4 mm behind depth";
    }
};

TEST_F(AzureRecording, IsReadInAnyOrder) {
    for (const std::string fourcc : {"b16g", "Y16 "}) {
        MkvWriter out = recording(fourcc);
        out.attach("calibration.json", calibration().dump() + std::string(1, '\0'));
        const auto source = open_source(folder.write("room.mkv", out.finish()));
        ASSERT_EQ(source->size(), static_cast<std::size_t>(kFrames));
        EXPECT_EQ(source->facts().name, "room");
        for (const int i : {0, 1, 2, 3, 1, 0, 3}) expect_frame(source->read(static_cast<std::size_t>(i)), i);
    }
}

TEST_F(AzureRecording, EveryModeOfColourIsRead) {
    for (const std::string coding : {"NV12", "YUY2", "BGRA"}) {
        SCOPED_TRACE(coding);
        MkvWriter out = recording("b16g", "DEPTH", coding);
        out.attach("calibration.json", calibration().dump());
        const auto source = open_source(folder.write("room.mkv", out.finish()));
        ASSERT_EQ(source->size(), static_cast<std::size_t>(kFrames));
        for (const int i : {0, 1, 3, 2, 0}) expect_frame(source->read(static_cast<std::size_t>(i)), i);
    }
}

TEST_F(AzureRecording, RawColourThatIsCutOffCostsItsFrame) {
    for (const std::string coding : {"NV12", "YUY2", "BGRA"}) {
        SCOPED_TRACE(coding);
        MkvWriter out;
        out.add_track("COLOR", coding, kColor.width, kColor.height);
        out.add_track("DEPTH", "b16g", kDepth.width, kDepth.height);
        const std::string image = coded(coding, shade(0));
        for (int i = 0; i < 2; ++i) {
            out.add(1, static_cast<std::uint64_t>(33333 * i), i == 0 ? image.substr(0, image.size() / 2) : image);
            out.add(2, static_cast<std::uint64_t>(33333 * i), std::string(2UL * kDepth.width * kDepth.height, '\4'));
        }
        out.attach("calibration.json", calibration().dump());
        const auto source = open_source(folder.write("room.mkv", out.finish()));
        ASSERT_EQ(source->size(), 2u);
        EXPECT_TRUE(has(message_of<Error>([&] { (void)source->read(0); }), "image 0"));
        EXPECT_NEAR(source->read(1).color(30, 20).g, shade(0).g, 3);
    }
}

TEST_F(AzureRecording, FaultsAreNamed) {
    EXPECT_TRUE(has(open_fault(folder.write("a.mkv", "no video")), "is no video that can be read"));
    MkvWriter empty;
    empty.add_track("COLOR", "MJPG", kColor.width, kColor.height);
    empty.add(2, 0, "of no track");
    EXPECT_TRUE(has(open_fault(folder.write("a.mkv", empty.finish())), "holds no image"));
    EXPECT_TRUE(has(open_fault(folder.write("a.mkv", recording().finish())), "lacks calibration.json"));
    EXPECT_TRUE(has(open_fault(folder.write("a.mkv", recording("b16g", "IR").finish())), "no image of a track DEPTH"));
    MkvWriter other = recording("BGRA");
    other.attach("calibration.json", calibration().dump());
    const auto source = open_source(folder.write("a.mkv", other.finish()));
    EXPECT_TRUE(has(message_of<Error>([&] { (void)source->read(0); }), "is not an uncompressed image of 16 bit"));
}

TEST_F(AzureRecording, CutOffAnywhereIsUsedAsFarAsItGoes) {
    MkvWriter out = recording();
    out.attach("calibration.json", calibration().dump());
    const std::string whole = out.finish();
    const fs::path file = folder.write("a.mkv", whole.substr(0, whole.size() * 6 / 10));
    const auto source = open_source(file);
    ASSERT_EQ(source->size(), 2u);
    expect_frame(source->read(1), 1);
}

TEST_F(AzureRecording, NoDamageDoesHarm) {
    MkvWriter out;  // small
    out.add_track("COLOR", "MJPG", kWidth, kHeight);
    out.add_track("DEPTH", "b16g", 320, 288);
    out.attach("calibration.json", calibration().dump());
    out.add(1, 0, encode_jpeg(ColorImage(kWidth, kHeight, Rgb8{9, 90, 160}), 90));
    out.add(2, 0, std::string(16, '\1'));
    expect_no_harm_in_damage(folder.write("a.mkv", out.finish()), 97);
}

/// As the app writes it, with the video of tests/hosts/io/data/make_video.py.
class StrayRecording : public Video {
protected:
    static constexpr int kImages = 40, kShown = 30;
    static constexpr ImageSize kDepth{16, 12};

    fs::path recording() {
        const fs::path out = folder / "scan";
        for (const char* part : {"depth", "confidence"}) fs::create_directories(out / part);
        fs::copy_file(fs::path(POSEFUSION_TEST_DATA) / "hevc.mp4", out / "rgb.mp4",
                      fs::copy_options::overwrite_existing);
        write_bytes(out / "camera_matrix.csv", "52.5,0.0,31.5\n0.0,52.25,23.5\n0.0,0.0,1.0\n");
        std::string odometry = "timestamp, frame, x, y, z, qx, qy, qz, qw\n";
        for (int i = 0; i < kShown; ++i) {
            const std::string number = std::to_string(1000000 + i).substr(1);
            odometry += std::to_string(52.5 + i / 60.0) + ", " + number + ", " + std::to_string(0.01 * i) +
                        ", 0.5, 0, 0, 0, 0.6, 0.8\n";
            RawDepth depth(kDepth.width, kDepth.height, static_cast<std::uint16_t>(2000 + i));
            LabelImage confidence(kDepth.width, kDepth.height, 2);
            for (int v = 0; v < kDepth.height; ++v) confidence(0, v) = 0, confidence(1, v) = 1;
            write_raw_depth(out / "depth" / (number + ".png"), depth);
            write_labels(out / "confidence" / (number + ".png"), confidence);
        }
        write_bytes(out / "odometry.csv", odometry);
        return out;
    }
    static void expect_frame(const RawFrame& frame, int i) {
        EXPECT_NEAR(to_seconds(frame.stamp), 52.5 + i / 60.0, 1e-6);
        ASSERT_EQ(frame.color.width(), 64);
        EXPECT_NEAR(frame.color(32, 24).r, 20 + 5 * i, 6) << i;
        EXPECT_NEAR(frame.color(32, 24).g, 60, 6) << i;
        EXPECT_NEAR(frame.color(32, 24).b, 200 - 5 * i, 6) << i;
        ASSERT_EQ(frame.depth.width(), 64) << "of the size of colour";
        EXPECT_EQ(frame.depth(32, 24), 2000 + i);
        EXPECT_EQ(frame.depth(1, 24), 0) << "of the lowest confidence";
        EXPECT_EQ(frame.depth(6, 24), 2000 + i) << "of the next one";
    }
};

TEST_F(StrayRecording, IsReadInAnyOrder) {
    const auto source = open_source(recording());
    ASSERT_EQ(source->size(), static_cast<std::size_t>(kShown)) << "those with depth";
    EXPECT_EQ(source->facts().name, "scan");
    EXPECT_EQ(source->camera().intrinsics.fy, 52.25f);
    EXPECT_TRUE(source->facts().warnings.empty());
    for (const int i : {0, 1, 2, 3, 29, 5, 4, 12, 11, 25, 0})
        expect_frame(source->read(static_cast<std::size_t>(i)), i);
    const auto poses = source->groundtruth();
    ASSERT_TRUE(poses);
    ASSERT_EQ(poses->size(), static_cast<std::size_t>(kShown));
    EXPECT_NEAR(poses->back().T_world_camera.translation().x(), 0.29, 1e-9);
    EXPECT_NEAR(poses->back().T_world_camera.linear()(1, 0), 0.96, 1e-9) << "2 * 0.6 * 0.8";
}

TEST_F(StrayRecording, PartsThatAreMissingAreTold) {
    const fs::path out = recording();
    fs::remove(out / "depth" / "000003.png");
    fs::remove_all(out / "confidence");
    std::ofstream(out / "odometry.csv", std::ios::app) << "90, 000099, 0, 0, 0, 0, 0, 0, 1\nnonsense\n";
    const auto source = open_source(out);
    EXPECT_EQ(source->size(), static_cast<std::size_t>(kShown - 1));
    ASSERT_EQ(source->facts().warnings.size(), 2u);
    EXPECT_TRUE(has(source->facts().warnings[0], "1 line left out, the first is line 33"));
    EXPECT_TRUE(has(source->facts().warnings[1], "2 lines of odometry.csv without an image"));
    EXPECT_EQ(source->read(0).depth(1, 24), 2000) << "without confidence all is used";

    write_bytes(out / "camera_matrix.csv", "1 2 3\n");
    EXPECT_TRUE(has(open_fault(out), "camera_matrix.csv: is not a camera matrix"));
    write_bytes(out / "odometry.csv", "timestamp, frame\n");
    EXPECT_TRUE(has(open_fault(out), "odometry.csv: no line like"));
    write_bytes(out / "rgb.mp4", read_all(out / "rgb.mp4").substr(0, 100));
    EXPECT_TRUE(has(open_fault(out), "rgb.mp4: is no video"));
}

TEST_F(StrayRecording, ADamagedVideoDoesNoHarm) {
    const fs::path out = recording(), video = out / "rgb.mp4";
    const std::string good = read_all(video);
    for (std::size_t i = 0; i < good.size(); i += 197) {
        write_bytes(video, good.substr(0, i));
        read_whatever_is_there(out);
        std::string bad = good;
        bad[i] = '\x7F';
        write_bytes(video, bad);
        read_whatever_is_there(out);
    }
}

}  // namespace
}  // namespace posefusion::test
