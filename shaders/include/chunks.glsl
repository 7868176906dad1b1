#ifndef POSEFUSION_CHUNKS
#define POSEFUSION_CHUNKS

const uint CHUNK = 16u;  // items that one invocation counts and then writes in order: stable, no atomic counter

#endif
