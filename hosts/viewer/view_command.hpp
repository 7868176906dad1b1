#pragma once
#include <filesystem>

#include "hosts/config/run_config.hpp"
#include "hosts/viewer/window.hpp"

namespace posefusion {

struct ViewOptions {
    WindowSize window{1280, 720};
    std::filesystem::path script;  ///< what to do, see view_script.hpp; empty = what the user does
};

/// A run with a window around it; writes only what it is asked to save. Returns the exit code, throws Error.
int view_command(const std::filesystem::path& recording, RunConfig& config, const ViewOptions& options);

}  // namespace posefusion
