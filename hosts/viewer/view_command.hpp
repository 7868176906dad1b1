#pragma once
#include <filesystem>

#include "hosts/config/run_config.hpp"
#include "hosts/viewer/window.hpp"

namespace posefusion {

struct ViewOptions {
    WindowSize window{1280, 720};
    std::filesystem::path script;  ///< steps to perform, see view_script.hpp; empty = interactive
};

/// A run in a window; writes only what it is asked to save. Returns the exit code, throws Error.
int view_command(const std::filesystem::path& recording, RunConfig& config, const ViewOptions& options);

}  // namespace posefusion
