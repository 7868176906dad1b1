#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/cli/time_table.hpp"
#include "hosts/run/run_session.hpp"

namespace posefusion {

namespace {

void print_table(const RunRecord& record, const Intrinsics& camera) {
    constexpr double kMebi = 1024.0 * 1024.0;
    const FrameResult& last = record.frames.back().result;
    fmt::print("{} of {} x {}, people: {}\n\n{}\n", counted(record.frames.size(), "frame"), camera.width, camera.height,
               record.people_description, time_table(record));
    fmt::print("peak resident memory {:.0f} MiB, device memory {:.0f} MiB, {} surfels\n",
               static_cast<double>(record.peak_memory_bytes) / kMebi, static_cast<double>(last.device_bytes) / kMebi,
               last.surfels);
}

void print_json(const RunRecord& record, const Intrinsics& camera) {
    using Json = nlohmann::ordered_json;
    const auto medians = [](const std::vector<StageSeries>& stages) {
        Json out = Json::object();
        for (const StageSeries& stage : stages) {
            const TimeSummary time = summarize(stage.milliseconds);
            if (time.count > 0) out[stage.name] = time.median;
        }
        return out;
    };
    const Json out = {{"frames", record.frames.size()},
                      {"width", camera.width},
                      {"height", camera.height},
                      {"device", {{"name", record.device.name}, {"driver", record.device.driver}}},
                      {"frame_ms", record.intervals()},
                      {"host_median_ms", medians(record.host_stages())},
                      {"gpu_median_ms", medians(record.gpu_stages())}};
    fmt::print("{}\n", out.dump(2));
}

}  // namespace

int bench_command(const std::filesystem::path& recording, RunConfig& config, bool json) {
    config.checkpoint_every = 0;
    config.resume = false;
    RunSession session(recording, config);
    Console console;
    RunRecord record = session.run(console, [](const ScheduledFrame&) {});
    if (!record.error.empty()) throw Error(record.error);
    if (!record.frames.empty()) {
        (json ? print_json : print_table)(record, session.recording().intrinsics());
    }
    record.judge();
    if (!record.error.empty()) throw Error(record.error);
    return record.status == RunStatus::Interrupted ? kExitInterrupted : kExitOk;
}

}  // namespace posefusion
