#include "hosts/library/version.hpp"

namespace posefusion {

const char* version() { return POSEFUSION_VERSION; }

}  // namespace posefusion
