#include "hosts/python/forked_child.hpp"

#include <pthread.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <mutex>

namespace posefusion::python {
namespace {

void end_at_once(int status, void*) {
    std::fflush(nullptr);
    _exit(status);
}

/// Handlers run in the reverse order of their registration, destructors of libraries among them.
void in_child() { on_exit(&end_at_once, nullptr); }

}  // namespace

void prepare_for_forks() {
    static std::once_flag once;
    std::call_once(once, [] { pthread_atfork(nullptr, nullptr, &in_child); });
}

}  // namespace posefusion::python
