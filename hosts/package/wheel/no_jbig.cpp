// Stands in for JBIG-KIT, which libtiff needs and which is under the GPL, in the Python wheel: whatever is compressed
// by JBIG (two-level images of fax machines, never of a camera) cannot be read, and says so.
#include <cstddef>

namespace {
constexpr int kNotThere = 1;  // any status but 0 is an error
}

extern "C" {
void jbg_dec_init(void*) {}
int jbg_dec_in(void*, unsigned char*, std::size_t, std::size_t*) { return kNotThere; }
void jbg_dec_free(void*) {}
unsigned char* jbg_dec_getimage(const void*, int) { return nullptr; }
unsigned long jbg_dec_getsize(const void*) { return 0; }
const char* jbg_strerror(int) { return "compressed by JBIG, which is left out here"; }
int jbg_newlen(unsigned char*, std::size_t) { return kNotThere; }
void jbg_enc_init(void*, unsigned long, unsigned long, int, unsigned char**,
                  void (*)(unsigned char*, std::size_t, void*), void*) {}
void jbg_enc_out(void*) {}
void jbg_enc_free(void*) {}
}
