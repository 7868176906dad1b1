// ROS bags.
#include "hosts/io/sources/bag_source.hpp"
#include "tests/fuzz/fuzz_recording.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return posefusion::fuzz::read_recording(data, size, posefusion::open_bag);
}
