// Camera files, ours and those of others.
#include "hosts/io/camera_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    const fuzz::MemoryFile file(data, size);
    fuzz::expect_no_more_than_an_error([&] { (void)read_camera_description(file.path()); });
    return 0;
}
