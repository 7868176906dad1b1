// Recordings of OpenNI2.
#include "hosts/io/sources/oni_source.hpp"
#include "tests/fuzz/fuzz_recording.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return posefusion::fuzz::read_recording(data, size, posefusion::open_oni, posefusion::fuzz::camera_file());
}
