#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hosts/config/run_config.hpp"

/// The one place where the options of a run have names. Command line, configuration file, help, the configuration
/// written beside the results and the table in README.md are all made from it.
namespace posefusion {

/// One option, bound to its field of a RunConfig.
struct Option {
    enum class Kind { Switch, Number, Choice, List, Text };

    std::string key;  ///< as in the configuration file, dotted: "tracking.icp_max_distance"
    Kind kind = Kind::Number;
    std::string unit;     ///< "m", "px", ...; empty = none
    std::string help;     ///< what it means
    std::string allowed;  ///< the values it may take, in words: "true | false", "1 .. 15", "a folder"

    std::function<std::string()> get;  ///< the value as text; set() takes it back unchanged
    /// Parses and stores. @throws Error that names the allowed values; the caller adds where the value came from
    std::function<void(const std::string& text)> set;

    [[nodiscard]] std::string flag() const;   ///< "--tracking-icp-max-distance"
    [[nodiscard]] std::string group() const;  ///< "tracking"; empty for the options of the run itself
    [[nodiscard]] std::string name() const;   ///< "icp_max_distance"
};

/// All options, bound to `config`, which must outlive them; those of a group stand together.
[[nodiscard]] std::vector<Option> option_table(RunConfig& config);

/// The option of that key; @throws Error naming the nearest key if there is none.
[[nodiscard]] const Option& find_option(const std::vector<Option>& options, std::string_view key);

/// The options with their present values as a Markdown table; README.md shows it for the defaults.
[[nodiscard]] std::string option_table_markdown(const std::vector<Option>& options);

}  // namespace posefusion
