#include <fmt/format.h>

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
    fmt::print("{}: {} frames of {} x {}, {} people\n", config.out.string(), frames, config.width, config.height,
               config.people);
    if (frames == config.frames) return kExitOk;
    console.warning(fmt::format("interrupted after {} of {} frames", frames, config.frames));
    return kExitInterrupted;
}

}  // namespace posefusion
