// Streams of frames.
#include <fcntl.h>

#include "hosts/io/sources/raw_stream.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    const fuzz::MemoryFile file(data, size);
    const int descriptor = open(file.path().c_str(), O_RDONLY);
    fuzz::expect_no_more_than_an_error([&] {
        const auto source = open_raw_stream(descriptor, "raw", {});
        for (;;) {
            try {
                (void)source->read(0);
            } catch (const SourceLost&) {
                break;
            } catch (const Error&) {
            }
        }
    });
    close(descriptor);
    return 0;
}
