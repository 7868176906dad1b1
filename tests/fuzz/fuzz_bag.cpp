// Bags of ROS 1.
#include "hosts/io/sources/bags/ros1_bag.hpp"
#include "tests/fuzz/fuzz_bags.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return posefusion::fuzz::read_recording(data, size, posefusion::fuzz::open_bag<posefusion::Ros1Bag>);
}
