// Reading side of depth_test.glsl. Needs `layout(constant_id = 0) const uint CELL_STRIDE` and the buffers `uint cell_keys[]`
// and `uint cell_indices[]`, or the one of them that is read.
#ifndef POSEFUSION_DEPTH_TEST_READ
#define POSEFUSION_DEPTH_TEST_READ

const uint EMPTY_CELL = 0xffffffffu;
// stride 2: one buffer of 64-bit keys, little-endian: index first, key second
#define CELL_INDEX(cell) cell_indices[(cell) * CELL_STRIDE]
#define CELL_KEY(cell) cell_keys[(cell) * CELL_STRIDE + CELL_STRIDE - 1u]

#endif
