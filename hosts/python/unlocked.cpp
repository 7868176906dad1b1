#include "hosts/python/unlocked.hpp"

#include <pthread.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <thread>

namespace posefusion::python {
namespace {

namespace py = pybind11;

constexpr std::chrono::milliseconds kLook{1};  ///< between two looks at the calls that are still running

/// Guarded by the GIL.
int running_calls = 0;
std::optional<std::thread::id> ending_thread;

[[noreturn]] void wait_for_the_end_of_the_process() {
    PyEval_SaveThread();
    for (;;) pause();
}

void finish_calls() {
    ending_thread = std::this_thread::get_id();
    while (running_calls > 0) {
        const py::gil_scoped_release others_go_on;
        std::this_thread::sleep_for(kLook);
    }
}

}  // namespace

Unlocked::Unlocked() {
    if (ending_thread && *ending_thread != std::this_thread::get_id()) wait_for_the_end_of_the_process();
    ++running_calls;
    state_ = PyEval_SaveThread();
}

Unlocked::~Unlocked() {
    PyEval_RestoreThread(state_);
    --running_calls;
}

bool is_to_end() {
    const py::gil_scoped_acquire locked;
    return ending_thread.has_value() || PyErr_CheckSignals() != 0;
}

void finish_calls_at_exit() {
    pthread_atfork(nullptr, nullptr, [] { running_calls = 0; });  // a child has none of its parent's threads
    py::module_::import("atexit").attr("register")(py::cpp_function(&finish_calls));
}

}  // namespace posefusion::python
