#include <fmt/format.h>

#include "engine/core/number_text.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/run/console.hpp"
#include "hosts/run/signals.hpp"

namespace posefusion {

int synth_command(const SynthConfig& config) {
    Console console;
    const int frames = synthesize(config, [&](int done, int total) {
        console.progress(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
        return !interrupted();
    });
    console.end_progress();
    fmt::print("{}: {} of {} x {}, {}\n", config.out.string(), counted(frames, "frame"), config.width, config.height,
               counted(config.people, "person", "people"));
    if (frames == config.frames) return kExitOk;
    console.warning(fmt::format("interrupted after {} of {} frames", frames, config.frames));
    return kExitInterrupted;
}

}  // namespace posefusion
