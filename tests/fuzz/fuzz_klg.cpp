// ElasticFusion logs: opening, every frame.
#include "hosts/io/sources/klg_source.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    const fuzz::MemoryFile file(data, size);
    SourceOptions options;
    options.camera_file = fuzz::camera_file();
    fuzz::expect_no_more_than_an_error([&] {
        const auto source = open_klg(file.path(), options);
        for (std::size_t i = 0; i < source->size(); ++i)
            fuzz::expect_no_more_than_an_error([&] { (void)source->read(i); });
    });
    return 0;
}
