#pragma once
#include <string>

#include "hosts/run/run_record.hpp"

namespace posefusion {

/// Table of the time between frames, per stage on the host and per stage on the GPU.
[[nodiscard]] std::string time_table(const RunRecord& record);

}  // namespace posefusion
