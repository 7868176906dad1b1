#include "hosts/viewer/view_command.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/run/exit_code.hpp"
#include "hosts/run/run_session.hpp"
#include "hosts/run/signals.hpp"
#include "hosts/viewer/viewer.hpp"

namespace posefusion {

int view_command(const std::filesystem::path& recording, RunConfig& config, const ViewOptions& options) {
    std::optional<std::vector<ScriptStep>> script;
    if (!options.script.empty()) script = load_view_script(options.script);
    Window window("PoseFusion", options.window);
    DeviceSharing sharing;
    sharing.instance_extensions = window.instance_extensions();
    sharing.device_extensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
    sharing.graphics = true;
    config.checkpoint_every = 0;
    config.resume = false;
    RunSession session(recording, config, sharing);
    Viewer viewer(window, session, config, std::move(script));
    viewer.run();

    const RunRecord& record = viewer.background().record();
    const std::string dropped = record.dropped ? fmt::format(" ({} dropped)", *record.dropped) : "";
    fmt::print("{}{} in {:.1f} s; {} drawn, {:.1f} ms each on the device (median)\n",
               counted(record.frames.size(), "frame"), dropped, record.wall_seconds,
               counted(viewer.frames_drawn(), "frame"), viewer.median_draw_ms());
    if (!record.error.empty()) throw Error(record.error);
    return interrupted() ? kExitInterrupted : kExitOk;
}

}  // namespace posefusion
