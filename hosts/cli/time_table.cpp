#include "hosts/cli/time_table.hpp"

#include <fmt/format.h>

namespace posefusion {
namespace {

std::string line(const std::string& name, const TimeSummary& time) {
    return fmt::format("  {:<26}{:>9.1f}{:>9.1f}{:>9.1f}{:>8}\n", name, time.median, time.mean, time.p95, time.count);
}

std::string block(const std::string& title, const std::vector<StageSeries>& stages) {
    std::string text = title + "\n";
    for (const StageSeries& stage : stages) {
        const TimeSummary time = summarize(stage.milliseconds);
        if (time.count > 0) text += line(stage.name, time);
    }
    return text;
}

}  // namespace

std::string time_table(const RunRecord& record) {
    return fmt::format("{:<28}{:>9}{:>9}{:>9}{:>8}\n", "milliseconds", "median", "mean", "95 %", "frames") +
           line("whole frame", summarize(record.intervals())) + block("host (stages overlap)", record.host_stages()) +
           block("GPU, on " + record.device.name, record.gpu_stages());
}

}  // namespace posefusion
