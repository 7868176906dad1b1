// Meshes that are evaluated.
#include "tests/fuzz/fuzz_input.hpp"
#include "tools/evaluate_mesh/mesh_input.hpp"
#include "tools/evaluate_objects/object_truth.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    const fuzz::MemoryFile file(data, size);
    fuzz::expect_no_more_than_an_error([&] { (void)read_exported_glb(file.path()); });
    fuzz::expect_no_more_than_an_error([&] { (void)read_true_mesh(file.path()); });
    return 0;
}
