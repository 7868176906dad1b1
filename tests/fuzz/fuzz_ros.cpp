// Messages of ROS, each taken for every kind that is read.
#include "hosts/io/sources/ros_messages.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    const ImageSize image{fuzz::kWidth, fuzz::kHeight};
    const ByteBuffer message(data, data + size);
    const std::string name = "message";
    for (const bool compressed : {false, true}) {
        fuzz::expect_no_more_than_an_error([&] { (void)ros_image_kind(message, compressed, name); });
        fuzz::expect_no_more_than_an_error([&] { (void)ros_color(message, compressed, name, image); });
        fuzz::expect_no_more_than_an_error([&] { (void)ros_depth(message, compressed, name, image); });
    }
    for (const bool rectified : {false, true})
        fuzz::expect_no_more_than_an_error([&] { (void)ros_camera(message, rectified, name); });
    fuzz::expect_no_more_than_an_error([&] { (void)ros_stamp(message, name); });
    fuzz::expect_no_more_than_an_error([&] { (void)ros_transform(message, name); });
    fuzz::expect_no_more_than_an_error([&] { (void)ros_transforms(message, name); });
    fuzz::expect_no_more_than_an_error([&] { (void)ros_float(message, name); });
    return 0;
}
