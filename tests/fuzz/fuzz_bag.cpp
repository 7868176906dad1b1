// ROS bags: opening, every frame.
#include "hosts/io/sources/bag_source.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    const fuzz::MemoryFile file(data, size);
    fuzz::expect_no_more_than_an_error([&] {
        const auto source = open_bag(file.path(), {});
        for (std::size_t i = 0; i < source->size(); ++i)
            fuzz::expect_no_more_than_an_error([&] { (void)source->read(i); });
    });
    return 0;
}
