// MCAP files.
#include "hosts/io/sources/bags/mcap_bag.hpp"
#include "tests/fuzz/fuzz_bags.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return posefusion::fuzz::read_recording(data, size, posefusion::fuzz::open_bag<posefusion::McapBag>);
}
