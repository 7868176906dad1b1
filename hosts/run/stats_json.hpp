#pragma once
#include <optional>
#include <string>
#include <vector>

#include "hosts/config/option_table.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/run/run_record.hpp"

namespace posefusion {

/// The text of stats.json: summary, time per stage (median, mean, 95th percentile), a record per frame, device and
/// configuration. Units are part of the names.
[[nodiscard]] std::string stats_json(const RunRecord& record, const Recording& recording,
                                     const std::vector<Option>& options, const std::optional<Evaluation>& evaluation);

/// The same of a run that could not begin.
[[nodiscard]] std::string failure_json(const std::string& recording, const std::string& error,
                                       const std::vector<Option>& options);

}  // namespace posefusion
