#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hosts/config/run_config.hpp"

/// The single definition of the options of a run. Command line, configuration file, help, the configuration written
/// beside the results, manual page, completion and docs/options.md are all derived from it.
namespace posefusion {

/// The purpose of an option: the headings of the help, in this order.
enum class OptionSection {
    Input,
    Output,
    Maps,
    Masking,
    Tracking,
    Loops,
    Device,
    Advanced,  ///< shown by `--help-all` only: the defaults suit nearly everybody
};

/// One option, bound to its field of a RunConfig.
struct Option {
    enum class Kind { Switch, Number, Choice, List, Text };

    std::string key;  ///< as in the configuration file, dotted: "tracking.icp_max_distance"
    Kind kind = Kind::Number;
    std::string unit;     ///< "m", "px", ...; empty = none
    std::string help;     ///< what it means
    std::string allowed;  ///< the allowed values, in words: "true | false", "1 .. 15", "a folder"

    std::function<std::string()> get;  ///< the value as text; set() takes it back unchanged
    /// Parses and stores. @throws Error that names the allowed values; the caller adds where the value came from
    std::function<void(const std::string& text)> set;

    OptionSection section = OptionSection::Advanced;

    [[nodiscard]] std::string flag() const;   ///< "--tracking-icp-max-distance"
    [[nodiscard]] std::string group() const;  ///< "tracking"; empty for the options of the run itself
    [[nodiscard]] std::string name() const;   ///< "icp_max_distance"
    /// The heading of the help under which it is shown: "People", "Advanced: tracking".
    [[nodiscard]] std::string heading() const;
};

/// All options, bound to `config`, which must outlive them; those of a group are adjacent.
[[nodiscard]] std::vector<Option> option_table(RunConfig& config);

/// The option of that key; @throws Error naming the nearest key if there is none.
[[nodiscard]] const Option& find_option(const std::vector<Option>& options, std::string_view key);

/// Sorted as in the help: by section, and within it as in the table.
[[nodiscard]] std::vector<Option> in_help_order(std::vector<Option> options);

/// The options with their present values as Markdown tables, one per heading; docs/options.md shows the defaults.
[[nodiscard]] std::string option_table_markdown(const std::vector<Option>& options);

}  // namespace posefusion
