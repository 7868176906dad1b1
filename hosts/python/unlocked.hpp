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

/// For calls that wait for others: whether this one is to end, because Python does or because a signal handler has
/// raised an exception, as after Ctrl-C; that one is pending then, see interruptible(). Needs no GIL.
[[nodiscard]] bool is_to_end();

/// `call`, without the GIL. Throws what it throws, but rather the exception that is pending after is_to_end().
template <class Call>
auto interruptible(Call&& call) {
    try {
        const Unlocked unlocked;
        return call();
    } catch (...) {
        if (PyErr_Occurred() != nullptr) throw pybind11::error_already_set();
        throw;
    }
}

/// From now on, Python waits at its end until the calls that daemon threads have begun are done; further ones never
/// return.
void finish_calls_at_exit();

}  // namespace posefusion::python
