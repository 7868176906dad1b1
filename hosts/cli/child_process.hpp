#pragma once
#include <functional>

namespace posefusion {

/// Calls `work` in a process of its own, for what cannot be stopped in another way: ended at once when `stop` turns
/// true. What `work` prints and writes counts, what it changes in memory does not. Only while the program has one
/// thread.
/// @return the exit code that `work` returned, or that an exception of it stands for (its line has been printed);
///         kExitInterrupted when it was stopped
/// Throws Error: the system has no room for another process, or killed it.
int run_in_child(const std::function<int()>& work, const std::function<bool()>& stop);

}  // namespace posefusion
