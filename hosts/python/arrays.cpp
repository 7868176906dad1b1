#include "hosts/python/arrays.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/io/image_file.hpp"
#include "pose/people.hpp"

namespace posefusion::python {
namespace {

constexpr py::ssize_t kTrajectoryColumns = 8, kJointColumns = 3;
constexpr double kRigidTolerance = 1e-3;  ///< of R^T R - I: a pose read from text has at least three digits

[[noreturn]] void refuse(const py::array& array, const std::string& expected) {
    throw Error("expected an array of " + expected + ", got " + py::str(array.dtype()).cast<std::string>() +
                " of shape " + py::str(array.attr("shape")).cast<std::string>());
}

template <class Number>
bool holds(const py::array& array) {
    return py::isinstance<py::array_t<Number>>(array);
}

/// The array itself where it is packed, else a packed copy.
template <class Number>
py::array_t<Number, py::array::c_style> packed(const py::array& array) {
    return py::array_t<Number, py::array::c_style>::ensure(array);
}

/// Any number type; the shape is checked by the caller.
py::array_t<double, py::array::c_style> numbers(const py::array& array) {
    return py::array_t<double, py::array::c_style | py::array::forcecast>(array);
}

template <class Pixel, class Number>
Image<Pixel> copy_image(const py::array& array) {
    const auto source = packed<Number>(array);
    Image<Pixel> image(static_cast<int>(source.shape(1)), static_cast<int>(source.shape(0)));
    static_assert(std::is_trivially_copyable_v<Pixel>);
    std::memcpy(static_cast<void*>(image.data()), source.data(), static_cast<std::size_t>(source.nbytes()));
    return image;
}

/// Python owns `object` from now on, and with it the memory of the array.
template <class Object>
py::capsule hand_over(std::unique_ptr<Object> object) {
    return py::capsule(object.release(), [](void* owned) { delete static_cast<Object*>(owned); });
}

template <class Number, class Pixel>
py::array array_of_image(Image<Pixel> image, std::vector<py::ssize_t> shape) {
    auto owned = std::make_unique<Image<Pixel>>(std::move(image));
    const auto* pixels = reinterpret_cast<const Number*>(owned->data());
    return py::array_t<Number>(std::move(shape), pixels, hand_over(std::move(owned)));
}

}  // namespace

ColorImage color_of(const py::array& array) {
    if (!holds<std::uint8_t>(array) || array.ndim() != 3 || array.shape(2) != 3)
        refuse(array, "uint8 of shape (height, width, 3)");
    return copy_image<Rgb8, std::uint8_t>(array);
}

LabelImage labels_of(const py::array& array) {
    if (array.ndim() == 2 && holds<bool>(array)) return copy_image<std::uint8_t, bool>(array);
    if (array.ndim() != 2 || !holds<std::uint8_t>(array)) refuse(array, "uint8 or bool of shape (height, width)");
    return copy_image<std::uint8_t, std::uint8_t>(array);
}

DepthImage depth_of(const py::array& array, float depth_scale) {
    const std::string expected = "uint16 or floating point numbers of shape (height, width)";
    if (array.ndim() != 2) refuse(array, expected);
    if (holds<std::uint16_t>(array)) return to_metres(copy_image<std::uint16_t, std::uint16_t>(array), depth_scale);
    if (!holds<float>(array) && !holds<double>(array)) refuse(array, expected);
    DepthImage depth = copy_image<float, float>(py::array_t<float, py::array::c_style | py::array::forcecast>(array));
    for (float& metres : depth) {
        if (!std::isfinite(metres) || metres < 0) metres = 0;
    }
    return depth;
}

Eigen::Isometry3d pose_of(const py::array& array) {
    if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) refuse(array, "numbers of shape (4, 4)");
    const auto values = numbers(array);
    Eigen::Isometry3d pose;
    pose.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
    const Eigen::Matrix3d R = pose.linear();
    const bool rigid = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kRigidTolerance &&
                       R.determinant() > 0;
    if (!pose.matrix().allFinite() || !rigid || pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
        throw Error("the pose is no rigid motion: its upper left 3 x 3 must be a rotation and its last row 0 0 0 1");
    }
    return pose;
}

Trajectory trajectory_of(const py::array& array) {
    if (array.ndim() != 2 || array.shape(1) != kTrajectoryColumns)
        refuse(array, "numbers of shape (n, 8): stamp tx ty tz qx qy qz qw");
    const auto values = numbers(array);
    Trajectory trajectory;
    for (py::ssize_t i = 0; i < values.shape(0); ++i) {
        const double* row = values.data(i, 0);
        const Eigen::Quaterniond q(row[7], row[4], row[5], row[6]);
        const bool finite = std::all_of(row, row + kTrajectoryColumns, [](double x) { return std::isfinite(x); });
        if (!finite || q.norm() == 0 || (!trajectory.empty() && stamp_of(row[0]) <= trajectory.back().stamp)) {
            throw Error("row " + std::to_string(i) +
                        " of the trajectory is no pose: expected finite numbers, ascending stamps and a quaternion");
        }
        StampedPose pose;
        pose.stamp = stamp_of(row[0]);
        pose.T_world_camera = Eigen::Translation3d(row[1], row[2], row[3]) * q.normalized();
        trajectory.push_back(pose);
    }
    return trajectory;
}

People people_of(const py::array& joints) {
    if (joints.ndim() != 3 || joints.shape(1) != kJointCount || joints.shape(2) != kJointColumns)
        refuse(joints, "numbers of shape (people, 18, 3): u v p");
    const auto values = numbers(joints);
    People people;
    for (py::ssize_t i = 0; i < values.shape(0); ++i) {
        Person person;
        for (py::ssize_t j = 0; j < kJointCount; ++j) {
            const double* row = values.data(i, j, 0);
            person.joints[static_cast<std::size_t>(j)] = {static_cast<float>(row[0]), static_cast<float>(row[1]),
                                                          static_cast<float>(row[2])};
        }
        person.score = mean_certainty_of_best_joints(person, kJointCount);
        person.box = box_of_joints(person);
        people.push_back(person);
    }
    return people;
}

py::array array_of(ColorImage image) {
    const std::vector<py::ssize_t> shape{image.height(), image.width(), 3};
    return array_of_image<std::uint8_t>(std::move(image), shape);
}

py::array array_of(DepthImage image) {
    const std::vector<py::ssize_t> shape{image.height(), image.width()};
    return array_of_image<float>(std::move(image), shape);
}

py::array array_of(LabelImage image) {
    const std::vector<py::ssize_t> shape{image.height(), image.width()};
    return array_of_image<std::uint8_t>(std::move(image), shape);
}

py::array array_of(const Eigen::Isometry3d& pose) {
    py::array_t<double> array({4, 4});
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(array.mutable_data()) = pose.matrix();
    return array;
}

py::array array_of(const Trajectory& trajectory) {
    py::array_t<double> array({static_cast<py::ssize_t>(trajectory.size()), kTrajectoryColumns});
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
        const Eigen::Vector3d t = trajectory[i].T_world_camera.translation();
        const Eigen::Quaterniond q(trajectory[i].T_world_camera.rotation());
        const double row[kTrajectoryColumns] = {
            to_seconds(trajectory[i].stamp), t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
        std::copy(std::begin(row), std::end(row), array.mutable_data(static_cast<py::ssize_t>(i), 0));
    }
    return array;
}

py::array array_of(const People& people) {
    py::array_t<float> array({static_cast<py::ssize_t>(people.size()), py::ssize_t{kJointCount}, kJointColumns});
    float* to = array.mutable_data();
    for (const Person& person : people) {
        for (const JointObservation& joint : person.joints) {
            for (const float value : {joint.u, joint.v, joint.p}) *to++ = value;
        }
    }
    return array;
}

py::array array_of(std::vector<Surfel> surfels) {
    static_assert(std::is_standard_layout_v<Surfel>);
    struct Field {
        const char* name;
        const char* type;
        std::size_t offset;
    };
    const Field fields[] = {
        {"position", "(3,)f4", offsetof(Surfel, position)}, {"normal", "(3,)f4", offsetof(Surfel, normal)},
        {"color", "(3,)u1", offsetof(Surfel, color)},       {"radius", "f4", offsetof(Surfel, radius)},
        {"confidence", "f4", offsetof(Surfel, confidence)}, {"created", "u4", offsetof(Surfel, created)},
        {"last_seen", "u4", offsetof(Surfel, last_seen)}};
    py::list names, types, offsets;
    for (const Field& field : fields) {
        names.append(field.name);
        types.append(py::dtype(field.type));
        offsets.append(field.offset);
    }
    const py::dtype record(names, types, offsets, sizeof(Surfel));
    auto owned = std::make_unique<std::vector<Surfel>>(std::move(surfels));
    const auto* data = owned->data();
    const auto count = static_cast<py::ssize_t>(owned->size());
    return py::array(record, {count}, data, hand_over(std::move(owned)));
}

}  // namespace posefusion::python
