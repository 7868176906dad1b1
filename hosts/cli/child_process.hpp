#pragma once
#include <functional>

namespace posefusion {

/// Runs `work` in a child process, for work that cannot be stopped otherwise: it is killed as soon as `stop` returns
/// true. Its output and files are kept, its changes in memory are not. Only to be called while the program has one
/// thread.
/// @return the exit code that `work` returned, or that of an exception it threw (which has been printed);
///         kExitInterrupted when it was stopped
/// Throws Error: the system could not start another process, or killed it.
int run_in_child(const std::function<int()>& work, const std::function<bool()>& stop);

}  // namespace posefusion
