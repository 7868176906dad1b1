#include "pose/detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "engine/core/error.hpp"
#include "tests/pose/support.hpp"

namespace posefusion {
namespace {

using testing::exact_text;
using testing::largest_difference;
using testing::load_color;
using testing::read_file;
using testing::shared_data;
using testing::TemporaryFolder;
using testing::write_file;

std::filesystem::path photo(const std::string& number) {
    return shared_data() / "photos" / ("COCO_val2014_000000000" + number + ".jpg");
}
std::filesystem::path installed_model() {
    return std::filesystem::path(POSEFUSION_SOURCE_DIR) / ".deps" / "models" / "movenet-multipose.onnx";
}
std::filesystem::path lightweight_openpose() {
    return shared_data() / "pose_models" / "lightweight_openpose_240x320.onnx";
}
std::filesystem::path tf_pose() { return shared_data() / "pose_models" / "tfpose_mobilenet_v2_small_240x320.onnx"; }

PoseConfig openpose(const std::filesystem::path& model, PoseRuntime runtime = PoseRuntime::OnnxRuntime) {
    PoseConfig config;
    config.network = PoseNetwork::OpenPose;
    config.runtime = runtime;
    config.model = model;
    return config;
}

/// The line of the Error that loading throws; fails the test if there is none or it has several lines.
std::string error_of(const PoseConfig& config) {
    try {
        (void)make_joint_detector(config);
    } catch (const Error& error) {
        const std::string line = error.what();
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
        return line;
    }
    ADD_FAILURE() << "no error";
    return {};
}

bool says(const std::string& line, const std::string& part) { return line.find(part) != std::string::npos; }

/// Joints of someone upright: the head above the shoulders above the hips above the ankles.
void expect_upright(const Person& person) {
    const auto& joints = person.joints;
    for (const int j : {Nose, Neck, RightHip, LeftHip, RightAnkle, LeftAnkle}) ASSERT_GT(joints[j].p, 0) << j;
    EXPECT_LT(joints[Nose].v, joints[Neck].v);
    EXPECT_LT(joints[Neck].v, std::min(joints[LeftHip].v, joints[RightHip].v));
    EXPECT_LT(std::max(joints[LeftHip].v, joints[RightHip].v), std::min(joints[LeftAnkle].v, joints[RightAnkle].v));
}

TEST(Detector, FindsThePeopleOfPhotographs) {
    POSEFUSION_REQUIRE_DATA(photo("328"));
    const auto detector = make_joint_detector({});
    EXPECT_EQ(detector->detect(load_color(photo("328"))).size(), 3u) << "three sit on a bench";
    EXPECT_EQ(detector->detect(load_color(photo("459"))).size(), 1u) << "a man with a camera, close";
    EXPECT_EQ(detector->detect(load_color(photo("294"))).size(), 1u) << "a man in a kitchen, cut off";

    const People night = detector->detect(load_color(photo("589")));
    ASSERT_EQ(night.size(), 1u) << "one on a dark lawn";
    expect_upright(night[0]);
    EXPECT_GT(night[0].score, 0.6f);

    const People room = detector->detect(load_color(photo("241")));
    ASSERT_GE(room.size(), 3u) << "portrait format: one stands, two sit";
    expect_upright(room[0]);
    EXPECT_NEAR(room[0].joints[Nose].u, 199, 15);
    EXPECT_NEAR(room[0].joints[Nose].v, 75, 15);
}

TEST(Detector, BothRuntimesAgree) {
    POSEFUSION_REQUIRE_DATA(photo("241"));
    const auto onnx_runtime = make_joint_detector({});
    PoseConfig config;
    config.runtime = PoseRuntime::OpenCvDnn;
    const auto opencv = make_joint_detector(config);
    for (const char* const number : {"192", "241", "328", "459", "488"}) {
        const ColorImage image = load_color(photo(number));
        EXPECT_LT(largest_difference(onnx_runtime->detect(image), opencv->detect(image)), 0.5f) << number;
    }
}

TEST(Detector, ResultsDoNotDependOnThreads) {
    POSEFUSION_REQUIRE_DATA(photo("241"));
    const ColorImage image = load_color(photo("241"));
    for (const PoseRuntime runtime : {PoseRuntime::OnnxRuntime, PoseRuntime::OpenCvDnn}) {
        std::string expected;
        for (const int threads : {1, 2, 3, 4}) {
            PoseConfig config;
            config.runtime = runtime;
            config.threads = threads;
            const auto detector = make_joint_detector(config);
            const std::string text = exact_text(detector->detect(image));
            EXPECT_EQ(text, exact_text(detector->detect(image))) << "second run";
            if (expected.empty()) expected = text;
            EXPECT_EQ(text, expected) << threads << " threads, " << detector->description();
        }
    }
}

TEST(Detector, TakesAnyImageSize) {
    if (!std::filesystem::exists(installed_model())) GTEST_SKIP() << "no model at " << installed_model();
    const auto detector = make_joint_detector({});
    EXPECT_TRUE(detector->detect({}).empty());
    EXPECT_TRUE(detector->detect(ColorImage(1, 1)).empty());
    EXPECT_TRUE(detector->detect(ColorImage(1000, 7)).empty());
    EXPECT_TRUE(detector->detect(ColorImage(37, 411, Rgb8{255, 255, 255})).empty());
}

TEST(Detector, OpenPoseWithTwoOutputsFindsThePeople) {
    POSEFUSION_REQUIRE_DATA(lightweight_openpose());
    const auto detector = make_joint_detector(openpose(lightweight_openpose()));
    EXPECT_EQ(detector->detect(load_color(photo("328"))).size(), 3u);
    const People night = detector->detect(load_color(photo("589")));
    ASSERT_EQ(night.size(), 1u);
    expect_upright(night[0]);
    const auto opencv = make_joint_detector(openpose(lightweight_openpose(), PoseRuntime::OpenCvDnn));
    for (const char* const number : {"328", "589", "241"}) {
        const ColorImage image = load_color(photo(number));
        EXPECT_LT(largest_difference(detector->detect(image), opencv->detect(image)), 0.5f) << number;
    }
}

TEST(Detector, OpenPoseAgreesWithMoveNet) {
    POSEFUSION_REQUIRE_DATA(lightweight_openpose());
    const ColorImage image = load_color(photo("589"));
    const People paf = make_joint_detector(openpose(lightweight_openpose()))->detect(image);
    const People movenet = make_joint_detector({})->detect(image);
    EXPECT_LT(largest_difference(paf, movenet), 25.0f) << "left and right, order of joints and the scale are the same";
}

TEST(Detector, OpenPoseWithConcatenatedMapsFindsPeople) {
    POSEFUSION_REQUIRE_DATA(tf_pose());  // 57 maps; its Clip is OpenCV's dialect
    const auto detector = make_joint_detector(openpose(tf_pose(), PoseRuntime::OpenCvDnn));
    const People night = detector->detect(load_color(photo("589")));
    ASSERT_EQ(night.size(), 1u);
    expect_upright(night[0]);
    EXPECT_GE(detector->detect(load_color(photo("241"))).size(), 1u) << "portrait format in a network of a fixed size";
}

TEST(DetectorErrors, MissingModelSaysWhereAndWhatToDo) {
    PoseConfig config;
    config.model = "no/such/network.onnx";
    const std::string line = error_of(config);
    EXPECT_TRUE(says(line, "no/such/network.onnx")) << line;
    EXPECT_TRUE(says(line, "./tools/setup")) << line;
    EXPECT_TRUE(says(error_of(openpose({})), "pose.model"));
}

TEST(DetectorErrors, ModelFolderOfTheEnvironmentComesFirst) {
    const TemporaryFolder folder;
    ASSERT_EQ(setenv("POSEFUSION_MODEL_DIR", folder.path().c_str(), 1), 0);
    const std::string line = error_of({});
    unsetenv("POSEFUSION_MODEL_DIR");
    EXPECT_TRUE(says(line, folder.path().string())) << line;
}

class DetectorErrorsOfRuntime : public ::testing::TestWithParam<PoseRuntime> {
protected:
    PoseConfig config_for(const std::filesystem::path& model) {
        PoseConfig config;
        config.runtime = GetParam();
        config.model = model;
        return config;
    }
    TemporaryFolder folder_;
};

TEST_P(DetectorErrorsOfRuntime, DamagedModels) {
    if (!std::filesystem::exists(installed_model())) GTEST_SKIP() << "no model at " << installed_model();
    const std::string model = read_file(installed_model());
    const std::filesystem::path damaged = folder_.path() / "damaged.onnx";
    for (const std::string& bytes :
         {std::string(), std::string("this is not a network"), model.substr(0, model.size() / 2)}) {
        write_file(damaged, bytes);
        EXPECT_TRUE(says(error_of(config_for(damaged)), damaged.string())) << bytes.size() << " bytes";
    }
}

TEST_P(DetectorErrorsOfRuntime, ForeignModels) {
    POSEFUSION_REQUIRE_DATA(lightweight_openpose());
    const std::string not_movenet = error_of(config_for(lightweight_openpose()));
    EXPECT_TRUE(says(not_movenet, "no output 'center'")) << not_movenet;

    PoseConfig config = openpose(installed_model(), GetParam());
    const std::string not_openpose = error_of(config);
    EXPECT_TRUE(says(not_openpose, "19 and 38 or 57")) << not_openpose;
}

INSTANTIATE_TEST_SUITE_P(Both, DetectorErrorsOfRuntime,
                         ::testing::Values(PoseRuntime::OnnxRuntime, PoseRuntime::OpenCvDnn),
                         [](const auto& instance) -> std::string {
                             return instance.param == PoseRuntime::OnnxRuntime ? "OnnxRuntime" : "OpenCvDnn";
                         });

/// Protocol Buffers: field `number` holding `bytes`.
std::string field(int number, const std::string& bytes) {
    std::string key;
    for (std::uint64_t value :
         {static_cast<std::uint64_t>(number) << 3 | 2, static_cast<std::uint64_t>(bytes.size())}) {
        for (; value > 127; value >>= 7) key += static_cast<char>(value % 128 + 128);
        key += static_cast<char>(value);
    }
    return key + bytes;
}

std::string floats(const std::vector<float>& values) {
    return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

/// A Caffe network in OpenPose's format and its weights: one convolution of stride 8 whose background map is 1 and
/// whose others are 0.
void write_caffe_network(const std::filesystem::path& prototxt, const std::filesystem::path& caffemodel) {
    write_file(prototxt,
               "name: \"tiny\"\ninput: \"image\"\ninput_dim: 1\ninput_dim: 3\ninput_dim: 1\ninput_dim: 1\n"
               "layer { name: \"maps\" type: \"Convolution\" bottom: \"image\" top: \"net_output\"\n"
               "  convolution_param { num_output: 57 kernel_size: 1 stride: 8 } }\n");
    std::vector<float> bias(57, 0.0f);
    bias[18] = 1;
    const auto blob = [](const std::string& shape, const std::vector<float>& values) {
        return field(7, field(5, floats(values)) + field(7, field(1, shape)));  // LayerParameter.blobs
    };
    const std::string kernel_shape{57, 3, 1, 1}, bias_shape{57};
    write_file(caffemodel, field(100, field(1, "maps") + field(2, "Convolution") +
                                          blob(kernel_shape, std::vector<float>(57 * 3)) + blob(bias_shape, bias)));
}

TEST(Detector, LoadsCaffeNetworksOfAnyInputSize) {
    const TemporaryFolder folder;
    PoseConfig config = openpose(folder.path() / "tiny.caffemodel", PoseRuntime::OpenCvDnn);
    config.prototxt = folder.path() / "tiny.prototxt";
    write_caffe_network(config.prototxt, config.model);
    const auto detector = make_joint_detector(config);
    EXPECT_TRUE(detector->detect(ColorImage(640, 480)).empty());
    EXPECT_TRUE(detector->detect(ColorImage(300, 400)).empty());
}

TEST(DetectorErrors, CaffeNeedsOpenCvAndAPrototxt) {
    const TemporaryFolder folder;
    PoseConfig config = openpose(folder.path() / "tiny.caffemodel", PoseRuntime::OpenCvDnn);
    write_caffe_network(folder.path() / "tiny.prototxt", config.model);
    EXPECT_TRUE(says(error_of(config), "pose.prototxt"));
    config.prototxt = folder.path() / "tiny.prototxt";
    config.runtime = PoseRuntime::OnnxRuntime;
    EXPECT_TRUE(says(error_of(config), "pose.runtime"));
    config.runtime = PoseRuntime::OpenCvDnn;
    write_file(config.prototxt, "layer {");
    EXPECT_TRUE(says(error_of(config), "tiny.caffemodel"));
}

}  // namespace
}  // namespace posefusion
