#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

#include "hosts/io/text_table.hpp"

/// Names of image files in lists as people write them: with blanks, commas, quotation marks, backslashes.
namespace posefusion {

struct ListedPath {
    std::string path;      ///< as written, without quotation marks
    std::size_t next = 0;  ///< the field of the line that comes after it
};

/// The path that begins with that field: up to the quotation mark, if it begins with one; else up to the first field
/// that ends like the name of an image; else, where none does, that field alone. @param first  a field of the line
[[nodiscard]] ListedPath take_path(const TextLine& line, std::size_t first);

/// `path`, in `folder` unless it is absolute. Backslashes part folders where no file has them in its name.
[[nodiscard]] std::filesystem::path resolve_path(const std::filesystem::path& folder, const std::string& path);

}  // namespace posefusion
