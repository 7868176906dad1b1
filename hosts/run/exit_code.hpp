#pragma once

/// What the program tells the shell that started it.
namespace posefusion {

inline constexpr int kExitOk = 0;
inline constexpr int kExitError = 1;          ///< one line on the standard error stream says why
inline constexpr int kExitUsage = 2;          ///< the command line is wrong
inline constexpr int kExitInterrupted = 130;  ///< Ctrl-C; what was computed has been written

}  // namespace posefusion
