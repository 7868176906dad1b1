// Reading side of depth_test.glsl. Needs `layout(constant_id = 0) const uint CELL_STRIDE`.
#ifndef POSEFUSION_DEPTH_TEST_READ
#define POSEFUSION_DEPTH_TEST_READ

const uint EMPTY_CELL = 0xffffffffu;
#define CELL_BUFFERS(b0, b1)                                                       \
    layout(std430, binding = b0) readonly buffer CellKeys { uint cell_keys[]; };     \
    layout(std430, binding = b1) readonly buffer CellIndices { uint cell_indices[]; };
// stride 2: one buffer of 64-bit keys, little-endian: index first, key second
#define CELL_INDEX(cell) cell_indices[(cell) * CELL_STRIDE]
#define CELL_KEY(cell) cell_keys[(cell) * CELL_STRIDE + CELL_STRIDE - 1u]

#endif
