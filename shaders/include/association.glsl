#ifndef POSEFUSION_ASSOCIATION
#define POSEFUSION_ASSOCIATION

const uint NO_SURFEL = 0xffffffffu;   // the pixel has no static depth or no normal
const uint DUPLICATE_SURFEL = 0xfffffffeu;  // in place of an owner: the surfel is a second one of the same surface
const uint NEW_SURFEL = 0xfffffffeu;  // the pixel sees something the map does not hold

// Squared distance (in half cells, below 1024) first, then the pixel (below 2^22).
uint owner_key(uint distance, uint pixel) {
    return (min(distance, 1023u) << 22) | pixel;
}

#endif
