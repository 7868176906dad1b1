#include "hosts/cli/help_formatter.hpp"

#include <fmt/format.h>

#include <sstream>
#include <utility>
#include <vector>

namespace posefusion {
namespace {

bool is_advanced(const std::string& group) { return group.starts_with("Advanced") || group == kWithoutEffect; }

std::string broken_into_lines(const std::string& text, std::size_t width) {
    std::string lines;
    std::size_t length = 0;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        if (length > 0) {
            const bool fits = length + 1 + word.size() <= width;
            lines += fits ? ' ' : '\n';
            length = fits ? length + 1 : 0;
        }
        lines += word;
        length += word.size();
    }
    return lines;
}

}  // namespace

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
    if (mode == CLI::AppFormatMode::Sub) return make_expanded(app);
    return make_description(app) + make_usage(app, std::move(name)) + make_positionals(app) +
           option_groups(app, mode == CLI::AppFormatMode::All) + make_subcommands(app, mode) + '\n' + make_footer(app);
}

std::string HelpFormatter::option_groups(const CLI::App* app, bool with_advanced) const {
    std::string text;
    std::size_t hidden = 0;
    for (const std::string& group : app->get_groups()) {
        const std::vector<const CLI::Option*> options = app->get_options(
            [&](const CLI::Option* option) { return option->get_group() == group && option->nonpositional(); });
        if (group.empty() || options.empty()) continue;
        if (with_advanced || !is_advanced(group))
            text += make_group(group, false, options);
        else
            hidden += group == kWithoutEffect ? 0 : options.size();
    }
    if (hidden > 0) text += fmt::format("\n{} advanced options: posefusion {} --help-all\n", hidden, app->get_name());
    return text;
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
    return broken_into_lines(option->get_description(), kWidth - kMeaningColumn);
}

std::string negation(const Option& option) {
    const std::string flag = option.flag();
    return option.kind != Option::Kind::Switch || flag.starts_with("--no-") ? "" : "--no-" + flag.substr(2);
}

std::string placeholder(const Option& option) {
    switch (option.kind) {
        case Option::Kind::Switch:
            return "";
        case Option::Kind::Number:
            return "N";
        case Option::Kind::List:
            return "A,B,...";
        case Option::Kind::Choice:
            return "NAME";
        case Option::Kind::Text:
            return option.allowed == "a file" || option.allowed == "a folder" ? "PATH" : "TEXT";
    }
    return "";
}

std::string description(const Option& option) {
    const std::string value = option.get();
    if (option.kind == Option::Kind::Switch)
        return option.help + (value == "true" ? " [on; " + negation(option) + " turns it off]" : "");
    if (option.kind == Option::Kind::Text) return option.help + (value.empty() ? "" : " [default " + value + "]");
    const std::string shown = value.empty() ? "none" : value;
    return option.help + " [default " + shown + (option.unit.empty() ? "" : " " + option.unit) + "; " + option.allowed +
           "]";
}

}  // namespace posefusion
