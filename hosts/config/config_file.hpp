#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "hosts/config/option_table.hpp"

namespace posefusion {

/// Sets options from a YAML file: `tracking: {icp: false}` and `tracking.icp: false` mean the same, lists are written
/// [10, 5, 4]. @throws Error naming file, line and key for a file that cannot be read, an unknown key or a bad value
void load_config(const std::filesystem::path& file, const std::vector<Option>& options);

/// All options as a YAML text that load_config() reads back to the same values; units and meaning as comments.
[[nodiscard]] std::string config_yaml(const std::vector<Option>& options);

}  // namespace posefusion
