// What we read ourselves of recordings with videos: calibration.json of an Azure Kinect, the tables of Stray Scanner.
#include "hosts/io/sources/video/azure_calibration.hpp"
#include "hosts/io/sources/video/stray_source.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    const std::string text(reinterpret_cast<const char*>(data), size);
    fuzz::expect_no_more_than_an_error([&] { (void)parse_azure_calibration(text, {1280, 720}, {640, 576}, "fuzz"); });
    const fuzz::MemoryFile file(data, size);
    fuzz::expect_no_more_than_an_error([&] {
        std::vector<std::string> warnings;
        (void)read_stray_odometry(file.path(), warnings);
    });
    fuzz::expect_no_more_than_an_error([&] { (void)read_stray_camera(file.path(), {1920, 1440}); });
    return 0;
}
