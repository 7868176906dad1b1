#include "hosts/io/sources/image_folder_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <string_view>

#include "hosts/io/association.hpp"
#include "hosts/io/sources/folder.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr double kFramesPerSecond = 30;  ///< of images that are only numbered
constexpr std::array<std::string_view, 3> kColorWords{"color", "colour", "rgb"};
constexpr std::array<std::string_view, 5> kColorFolders{"rgb", "color", "colour", "image", "images"};
constexpr std::string_view kDepthWord = "depth";

struct NumberedFile {
    double number = 0;
    bool is_stamp = false;    ///< written with a decimal point
    std::string number_text;  ///< as in the name
    fs::path path;
};

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

bool is_image(const fs::path& file) {
    const std::string extension = lower_case(file.extension().string());
    return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

template <std::size_t N>
bool contains_any(const std::string& text, const std::array<std::string_view, N>& words) {
    return std::any_of(words.begin(), words.end(),
                       [&](std::string_view word) { return text.find(word) != std::string::npos; });
}

/// "1305031102.175304" of that name, "000012" of "frame-000012.color": the last digits, with a point between them.
std::optional<NumberedFile> numbered(const fs::path& path) {
    const std::string stem = path.stem().string();
    const auto is_digit = [&](std::size_t i) { return std::isdigit(static_cast<unsigned char>(stem[i])) != 0; };
    std::size_t end = stem.size();
    while (end > 0 && !is_digit(end - 1)) --end;
    std::size_t begin = end;
    bool point = false;
    while (begin > 0 &&
           (is_digit(begin - 1) || (stem[begin - 1] == '.' && !point && begin > 1 && is_digit(begin - 2)))) {
        --begin;
        point = point || stem[begin] == '.';
    }
    const std::string text = stem.substr(begin, end - begin);
    const auto number = parse_number(text);
    if (!number) return std::nullopt;
    return NumberedFile{*number, point, text, path};
}

struct Listing {
    std::vector<NumberedFile> color, depth;
    std::size_t unnumbered = 0;
};

void sort_by_number(std::vector<NumberedFile>& files) {
    std::sort(files.begin(), files.end(), [](const NumberedFile& a, const NumberedFile& b) {
        return a.number != b.number ? a.number < b.number : a.path < b.path;
    });
    files.erase(std::unique(files.begin(), files.end(),
                            [](const NumberedFile& a, const NumberedFile& b) { return a.number == b.number; }),
                files.end());
}

Listing list_images(const fs::path& folder) {
    Listing listing;
    const auto take = [&](const fs::path& file, std::vector<NumberedFile>& files) {
        if (auto image = numbered(file))
            files.push_back(std::move(*image));
        else
            ++listing.unnumbered;
    };
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = lower_case(entry.path().filename().string());
        if (entry.is_directory(error)) {
            const bool color = std::find(kColorFolders.begin(), kColorFolders.end(), name) != kColorFolders.end();
            if (!color && name != kDepthWord) continue;
            for (const auto& file : fs::directory_iterator(entry.path(), error))
                if (is_image(file.path())) take(file.path(), color ? listing.color : listing.depth);
        } else if (is_image(entry.path())) {
            if (name.find(kDepthWord) != std::string::npos)
                take(entry.path(), listing.depth);
            else if (contains_any(name, kColorWords))
                take(entry.path(), listing.color);
        }
    }
    if (error) throw Error(folder.string() + ": cannot be read: " + error.message());
    sort_by_number(listing.color);
    sort_by_number(listing.depth);
    return listing;
}

FrameEntry entry_of(const NumberedFile& color) {
    if (color.is_stamp) return {color.number, color.number_text};
    char text[64];
    std::snprintf(text, sizeof text, "%.6f", color.number / kFramesPerSecond);
    return {parse_number(text).value_or(color.number / kFramesPerSecond), text};
}

std::vector<FramePaths> pair_images(const Listing& listing) {
    const auto numbers = [](const std::vector<NumberedFile>& files) {
        std::vector<double> all;
        for (const NumberedFile& file : files) all.push_back(file.number);
        return all;
    };
    const bool stamps = !listing.color.empty() && listing.color.front().is_stamp;
    constexpr double kSameNumber = 0.5;  // of whole numbers
    std::vector<FramePaths> frames;
    for (const auto& [c, d] :
         associate(numbers(listing.color), numbers(listing.depth), stamps ? kMaxStampDifference : kSameNumber))
        frames.push_back({entry_of(listing.color[c]), listing.color[c].path, listing.depth[d].path});
    return frames;
}

}  // namespace

std::unique_ptr<FrameSource> open_image_folder(const fs::path& folder, const SourceOptions& options) {
    const Listing listing = list_images(folder);
    if (listing.color.empty() || listing.depth.empty())
        throw Error(folder.string() +
                    ": is no recording: neither lists (rgb.txt and depth.txt, or associations.txt) nor numbered colour "
                    "and depth images (in rgb/ and depth/, or with these words in their names)");
    std::vector<FramePaths> frames = pair_images(listing);
    if (frames.empty())
        throw Error(folder.string() + ": no colour image has a depth image of the same number (" +
                    listing.color.front().path.filename().string() + " and " +
                    listing.depth.front().path.filename().string() + " are the first of each)");
    std::vector<std::string> warnings;
    const std::size_t alone = listing.color.size() + listing.depth.size() - 2 * frames.size() + listing.unnumbered;
    if (alone > 0)
        warnings.push_back(folder.string() + ": " + std::to_string(alone) + " images without partner left out");
    return std::make_unique<ImageFiles>(folder, options, std::move(frames), std::move(warnings));
}

}  // namespace posefusion
