#include "hosts/io/sources/video/azure_calibration.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

using Json = nlohmann::json;

constexpr const char* kDepthCamera = "CALIBRATION_CameraLocationD0";
constexpr const char* kColorCamera = "CALIBRATION_CameraLocationPV0";
constexpr const char* kLensModel = "CALIBRATION_LensDistortionModelBrownConrady";
constexpr float kMillimetre = 1000;  ///< depth images count in millimetres
constexpr double kRotationTolerance = 1e-3;

/// The part of a sensor that an image shows, in pixels of the image.
struct Mode {
    float width, height;  ///< of the whole sensor
    float left, top;      ///< of the image
};

Mode color_mode(ImageSize image) {
    const float height = 0.75f * static_cast<float>(image.width);
    return {static_cast<float>(image.width), height, 0, (height - static_cast<float>(image.height)) / 2};
}

Mode depth_mode(ImageSize image, const std::string& name) {
    struct Known {
        ImageSize image;
        Mode mode;
    };
    constexpr std::array<Known, 4> kModes{{{{320, 288}, {512, 512, 96, 90}},      // narrow, binned
                                           {{640, 576}, {1024, 1024, 192, 180}},  // narrow
                                           {{512, 512}, {512, 512, 0, 0}},        // wide, binned
                                           {{1024, 1024}, {1024, 1024, 0, 0}}}};  // wide
    for (const Known& known : kModes)
        if (known.image == image) return known.mode;
    throw Error(name + ": depth images of " + size_text(image) + " are of no mode of an Azure Kinect");
}

struct SensorCamera {
    Intrinsics intrinsics;
    LensCoefficients lens{};
    Eigen::Isometry3d T_camera_reference = Eigen::Isometry3d::Identity();
};

template <std::size_t count>
std::array<double, count> numbers(const Json& list) {
    const auto values = list.get<std::array<double, count>>();
    for (const double value : values)
        if (!std::isfinite(value)) throw Error("not a number");
    return values;
}

SensorCamera camera_of(const Json& json, ImageSize image, const Mode& mode) {
    const Json& lens = json.at("Intrinsics");
    if (lens.at("ModelType").get<std::string>() != kLensModel) throw Error("a lens model that is not known");
    enum { Cx, Cy, Fx, Fy, K1, K2, K3, K4, K5, K6, Codx, Cody, P2, P1, kParameters };
    const auto p = numbers<kParameters>(lens.at("ModelParameters"));
    if (p[Codx] != 0 || p[Cody] != 0) throw Error("a lens model that is not known");
    SensorCamera camera;
    camera.intrinsics = {static_cast<float>(p[Fx]) * mode.width,
                         static_cast<float>(p[Fy]) * mode.height,
                         static_cast<float>(p[Cx]) * mode.width - mode.left - 0.5f,
                         static_cast<float>(p[Cy]) * mode.height - mode.top - 0.5f,
                         image.width,
                         image.height};
    if (!camera.intrinsics.valid()) throw Error("focal lengths that cannot be");
    constexpr std::array kOrder{K1, K2, P1, P2, K3, K4, K5, K6};
    for (std::size_t i = 0; i < kOrder.size(); ++i) camera.lens[i] = static_cast<float>(p[kOrder[i]]);

    const auto rotation = numbers<9>(json.at("Rt").at("Rotation"));
    const auto translation = numbers<3>(json.at("Rt").at("Translation"));
    const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data());
    if (!(R * R.transpose()).isIdentity(kRotationTolerance) || R.determinant() < 0) throw Error("no rotation");
    camera.T_camera_reference.linear() = R;
    camera.T_camera_reference.translation() = Eigen::Map<const Eigen::Vector3d>(translation.data());
    return camera;
}

}  // namespace

CameraDescription parse_azure_calibration(const std::string& text, ImageSize color, ImageSize depth,
                                          const std::string& name) {
    const Mode mode_of_depth = depth_mode(depth, name);
    std::optional<SensorCamera> of_color, of_depth;
    try {
        const Json json = Json::parse(text.substr(0, text.find_last_not_of('\0') + 1));
        for (const Json& camera : json.at("CalibrationInformation").at("Cameras")) {
            const auto location = camera.at("Location").get<std::string>();
            if (location == kColorCamera) of_color = camera_of(camera, color, color_mode(color));
            if (location == kDepthCamera) of_depth = camera_of(camera, depth, mode_of_depth);
        }
    } catch (const Json::exception&) {
        throw Error(name + ": calibration.json is damaged; give the camera with --camera");
    } catch (const Error& fault) {
        throw Error(name + ": calibration.json has " + fault.what() + "; give the camera with --camera");
    }
    if (!of_color || !of_depth)
        throw Error(name + ": calibration.json lacks the camera of colour or depth; give the camera with --camera");
    CameraDescription description;
    description.camera = {.intrinsics = of_color->intrinsics, .depth_scale = kMillimetre, .distortion = of_color->lens};
    description.says_depth_scale = true;
    description.depth =
        DepthCamera{of_depth->intrinsics, of_depth->lens,
                    (of_color->T_camera_reference * of_depth->T_camera_reference.inverse()).cast<float>()};
    return description;
}

}  // namespace posefusion
