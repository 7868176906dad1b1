// Our reading of PNG and JPEG headers, and what is handed to the decoders after it: colour, depth, masks.
#include "hosts/io/image_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    const ImageSize image{fuzz::kWidth, fuzz::kHeight};
    const fuzz::MemoryFile file(data, size);
    fuzz::expect_no_more_than_an_error([&] { (void)image_size({data, size}, "image"); });
    fuzz::expect_no_more_than_an_error([&] { (void)decode_color({data, size}, "image", image); });
    fuzz::expect_no_more_than_an_error([&] { (void)decode_raw_depth({data, size}, "image", image); });
    fuzz::expect_no_more_than_an_error([&] { (void)read_labels(file.path(), image); });
    fuzz::expect_no_more_than_an_error([&] { (void)read_wide_labels(file.path(), image); });
    return 0;
}
