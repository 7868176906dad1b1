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

}  // namespace posefusion
