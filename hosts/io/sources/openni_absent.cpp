// In place of openni_source.cpp where OpenNI2 is not wanted (POSEFUSION_OPENNI=OFF).
#include "hosts/io/sources/openni_source.hpp"

namespace posefusion {

std::unique_ptr<FrameSource> open_openni_camera(const std::string& uri, const SourceOptions&) {
    throw Error("openni2:" + uri + ": this program was built without OpenNI2; build with POSEFUSION_OPENNI=ON");
}

bool has_openni() { return false; }

}  // namespace posefusion
