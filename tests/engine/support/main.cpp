#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/engine/support/kernel_harness.hpp"

// The environment of the software GPU must be set before the Vulkan loader starts it. What the caller has set stays.
int main(int argc, char** argv) {
    setenv("LP_NUM_THREADS", "1", 0);
    setenv("MESA_SHADER_CACHE_DIR", POSEFUSION_SHADER_CACHE, 0);
    testing::InitGoogleTest(&argc, argv);
    const int result = RUN_ALL_TESTS();
    posefusion::test::destroy_shared_contexts();
    return result;
}
