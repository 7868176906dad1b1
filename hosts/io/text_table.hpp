#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The lines of the text files of the TUM layout, split into fields.
namespace posefusion {

struct TextLine {
    std::size_t number = 0;  ///< in the file, from 1
    std::string text;        ///< the whole line
    std::vector<std::string> fields;
    bool commas = false;  ///< between them
};

enum class Comments { Drop, Keep };

/// Lines with content: comments (#) unless they are kept, blank lines, a byte order mark and Windows line ends are
/// dropped, UTF-16 is converted; fields are separated by blanks, tabs or commas. Throws Error when the file cannot be
/// read or is too large for a list.
[[nodiscard]] std::vector<TextLine> read_text_table(const std::filesystem::path& file,
                                                    Comments comments = Comments::Drop);

/// The whole of `text` as a number; NaN and infinity count as numbers. nullopt if it is not one.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

}  // namespace posefusion
