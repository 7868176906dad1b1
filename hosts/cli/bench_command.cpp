#include <fmt/format.h>

#include "engine/core/error.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/cli/time_table.hpp"
#include "hosts/run/run_session.hpp"

namespace posefusion {

int bench_command(const std::filesystem::path& recording, RunConfig& config) {
    config.checkpoint_every = 0;
    config.resume = false;
    RunSession session(recording, config);
    Console console;
    const RunRecord record = session.run(console, [](const TrackedFrame&) {});
    if (!record.error.empty()) throw Error(record.error);
    if (!record.frames.empty()) {
        constexpr double kMebi = 1024.0 * 1024.0;
        const Intrinsics& camera = session.recording().intrinsics();
        const FrameResult& last = record.frames.back().result;
        fmt::print("{} frames of {} x {}, people: {}\n\n{}\n", record.frames.size(), camera.width, camera.height,
                   record.people_description, time_table(record));
        fmt::print("peak resident memory {:.0f} MiB, device memory {:.0f} MiB, {} surfels\n",
                   static_cast<double>(record.peak_memory_bytes) / kMebi,
                   static_cast<double>(last.device_bytes) / kMebi, last.surfels);
    }
    return record.status == RunStatus::Interrupted ? kExitInterrupted : kExitOk;
}

}  // namespace posefusion
