// Bit masks: one bit per pixel, MASK_WORD pixels of a row in a word; rows begin with a word of their own.
#ifndef POSEFUSION_MASK
#define POSEFUSION_MASK
#include "shared_constants.h"

uint mask_row_words(uint width) {
    return (width + MASK_WORD - 1u) / MASK_WORD;
}

// Whether the bit of pixel (u, v) is set in the buffer `uint mask[]`.
#define MASK_BIT(mask, u, v, width) \
    (((mask[uint(v) * mask_row_words(width) + uint(u) / MASK_WORD] >> (uint(u) % MASK_WORD)) & 1u) != 0u)

#endif
