// Lists of pairs, whose images are nowhere.
#include "hosts/io/sources/tum_source.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    const fuzz::MemoryFile file(data, size);
    SourceOptions options;
    options.camera_file = fuzz::camera_file();
    options.associations_file = file.path();
    fuzz::expect_no_more_than_an_error([&] { (void)open_tum_folder("/nowhere", options); });
    return 0;
}
