#pragma once

/// Exit codes of the program.
namespace posefusion {

inline constexpr int kExitOk = 0;
inline constexpr int kExitError = 1;          ///< the reason is one line on the standard error stream
inline constexpr int kExitUsage = 2;          ///< the command line is wrong
inline constexpr int kExitInterrupted = 130;  ///< Ctrl-C; everything computed so far has been written

}  // namespace posefusion
