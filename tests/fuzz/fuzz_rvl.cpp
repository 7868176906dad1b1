// RVL depth.
#include "hosts/io/rvl.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    fuzz::expect_no_more_than_an_error([&] { (void)decode_rvl({data, size}, {fuzz::kWidth, fuzz::kHeight}, "depth"); });
    return 0;
}
