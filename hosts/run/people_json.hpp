#pragma once
#include <cstddef>
#include <string>

#include "hosts/run/run_record.hpp"

namespace posefusion {

/// Who is seen less often is left out: mostly that is a false detection.
inline constexpr std::size_t kFewestSightings = 3;

/// The text of people.json: who was where, for each person the frames in which it was seen, with its joints in the
/// world of trajectory.txt, metres. Frames whose pose is not in trajectory.txt are left out. The layout is in
/// docs/files.md.
[[nodiscard]] std::string people_json(const RunRecord& record);

}  // namespace posefusion
