#pragma once
#include <pybind11/pybind11.h>

namespace posefusion::python {

/// Releases the GIL for as long as it lives. A thread that is inside when Python ends would be torn out of our
/// code at the end of this scope; so Python waits for it, see finish_calls_at_exit().
class Unlocked {
public:
    Unlocked();
    ~Unlocked();
    Unlocked(const Unlocked&) = delete;
    Unlocked& operator=(const Unlocked&) = delete;

private:
    PyThreadState* state_;
};

/// From now on, Python waits at its end until the calls that daemon threads have begun are done; further ones never
/// return.
void finish_calls_at_exit();

}  // namespace posefusion::python
