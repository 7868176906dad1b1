#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace posefusion {

/// One line of a script for the viewer.
struct ScriptStep {
    std::size_t line = 0;  ///< in the file, the first is 1
    std::string verb;
    std::vector<std::string> words;  ///< the arguments of the verb
    std::string where;               ///< "FILE:LINE", for messages
};

/// A script is a text file of one step per line; '#' begins a comment. With one, the viewer starts paused and performs
/// its steps, each when the previous one is complete. view_script_help() lists the verbs. Throws Error with file and
/// line: unreadable, unknown verb, wrong number of words, a word that should be a number.
[[nodiscard]] std::vector<ScriptStep> load_view_script(const std::filesystem::path& file);
[[nodiscard]] std::vector<ScriptStep> parse_view_script(const std::string& text, const std::string& name);
[[nodiscard]] std::string view_script_help();

/// The value of an argument that the parser has checked to be a number.
[[nodiscard]] double script_number(const std::string& word);

}  // namespace posefusion
