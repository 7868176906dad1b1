// Least-key-wins test in a buffer: key << 32 | index, one 64-bit atomicMin; equal keys: lower index. The key of the
// index map is the depth's bits, that of the prediction disc_key().
// Without 64-bit atomics (INT64_ATOMICS undefined) two passes: pass 0 finds the least key, pass 1 the least index
// there. A cell in which nothing was drawn holds EMPTY_CELL, index and key.
#ifndef POSEFUSION_DEPTH_TEST
#define POSEFUSION_DEPTH_TEST

#ifdef INT64_ATOMICS
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#define DEPTH_TEST_BUFFERS buffer Cells { uint64_t cells[]; };
#define DEPTH_TEST(cell, key, index) atomicMin(cells[cell], (uint64_t(key) << 32) | uint64_t(index))
#else
#define DEPTH_TEST_BUFFERS                 \
    buffer CellKeys { uint cell_keys[]; }; \
    buffer CellIndices { uint cell_indices[]; };
#define DEPTH_TEST(cell, key, index)                                             \
    {                                                                            \
        if (pass == 0u) atomicMin(cell_keys[cell], key);                         \
        else if (cell_keys[cell] == (key)) atomicMin(cell_indices[cell], index); \
    }
#endif

#endif
