// Reads one pixel of a bit mask: needs `uint NAME[]` and the image width.
#ifndef POSEFUSION_MASK
#define POSEFUSION_MASK
#define MASK_BIT(name, u, v, width) (((name[uint(v) * (((width) + 31u) / 32u) + (uint(u) >> 5)] >> (uint(u) & 31u)) & 1u) != 0u)
#endif
