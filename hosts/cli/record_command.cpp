#include <fmt/format.h>

#include <algorithm>

#include "engine/core/number_text.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/io/depth_unit.hpp"
#include "hosts/run/console.hpp"
#include "hosts/run/signals.hpp"

namespace posefusion {

int record_command(const std::filesystem::path& source, const std::filesystem::path& out, const SourceOptions& reading,
                   const RecordOptions& writing) {
    SourceOptions options = reading;
    options.cancelled = interrupted;
    const auto frames = open_source(source, options);
    Console console;
    for (const std::string& text : frames->facts().warnings) console.warning(text);
    if (const auto warning = check_depth_unit(*frames)) console.warning(*warning);
    const std::size_t total = writing.max_frames == 0 ? frames->size() : std::min(writing.max_frames, frames->size());
    RecordObserver observer;
    observer.progress = [&](std::size_t done) { console.progress(done, total); };
    observer.warning = [&](const std::string& text) { console.warning(text); };
    observer.cancelled = interrupted;
    const Recorded recorded = record(*frames, out, writing, observer);
    console.end_progress();
    const Intrinsics& camera = frames->camera().intrinsics;
    fmt::print("{}: {} of {} x {}{}\n", out.string(), counted(recorded.frames, "frame"), camera.width, camera.height,
               recorded.skipped == 0 ? "" : fmt::format(", {} skipped", recorded.skipped));
    // Ctrl-C is the normal way to end a recording from a camera
    return interrupted() && frames->seekable() ? kExitInterrupted : kExitOk;
}

}  // namespace posefusion
