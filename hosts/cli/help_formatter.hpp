#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "hosts/config/option_table.hpp"

/// The text of `--help` and `--help-all`.
namespace posefusion {

/// Heading of options that a command accepts because it shares them with `run`, but that have no effect there.
inline constexpr const char* kWithoutEffect = "Accepted, without effect here";

/// `--help` shows the headings of the basic options, `--help-all` all of them; long lines are broken.
class HelpFormatter : public CLI::Formatter {
public:
    HelpFormatter() { column_width(kMeaningColumn); }
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
    std::string make_option_desc(const CLI::Option* option) const override;

private:
    [[nodiscard]] std::string option_groups(const CLI::App* app, bool with_advanced) const;

    static constexpr std::size_t kMeaningColumn = 40;  ///< column at which the meaning of an option begins
    static constexpr std::size_t kWidth = 120;         ///< of a line
};

/// "--no-report" for "--report"; empty for an option that is a negation itself.
[[nodiscard]] std::string negation(const Option& option);

/// The placeholder for the value of an option.
[[nodiscard]] std::string placeholder(const Option& option);

/// "meaning [default 0.1 m; 0.001 .. 10]", "meaning [on; --no-report turns it off]"
[[nodiscard]] std::string description(const Option& option);

}  // namespace posefusion
