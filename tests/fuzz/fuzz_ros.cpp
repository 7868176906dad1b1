// Messages of ROS 1 and 2, each taken for every kind that is read.
#include "hosts/io/sources/bags/ros_messages.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace {

using namespace posefusion;

void read_as_every_kind(const RosMessage& message) {
    const ImageSize image{fuzz::kWidth, fuzz::kHeight};
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
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    for (const RosEncoding encoding : {RosEncoding::Ros1, RosEncoding::Cdr})
        read_as_every_kind({encoding, ByteBuffer(data, data + size)});
    return 0;
}
