// Reading side of depth_test.glsl. Kernels that read cells declare the buffers `uint cell_keys[]` and `uint
// cell_indices[]`, or the one of the two that they need, and `layout(constant_id = 0) const uint CELL_STRIDE`:
//   1  keys and indices are two buffers of 32 bits
//   2  both are the one buffer of 64 bits, bound under both names; little-endian: index first, key second
#ifndef POSEFUSION_DEPTH_TEST_READ
#define POSEFUSION_DEPTH_TEST_READ

#define CELL_INDEX(cell) cell_indices[(cell) * CELL_STRIDE]
#define CELL_KEY(cell) cell_keys[(cell) * CELL_STRIDE + CELL_STRIDE - 1u]

#endif
