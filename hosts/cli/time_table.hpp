#pragma once
#include <string>

#include "hosts/run/run_record.hpp"

namespace posefusion {

/// Time between frames, per stage on the host and per stage on the GPU, for people to read.
[[nodiscard]] std::string time_table(const RunRecord& record);

}  // namespace posefusion
