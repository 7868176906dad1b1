#include "hosts/io/sources/image_folder_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <ratio>
#include <span>
#include <string_view>

#include "hosts/io/association.hpp"
#include "hosts/io/sources/folder.hpp"
#include "hosts/io/sources/folder_camera.hpp"
#include "hosts/io/sources/time_order.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kColorWords{"color", "colour", "rgb"};
constexpr std::array<std::string_view, 5> kColorFolders{"rgb", "color", "colour", "image", "images"};
constexpr std::string_view kDepthWord = "depth";
constexpr std::string_view kReplicaColorWord = "frame";

struct NumberedFile {
    std::string number;  ///< as in the name
    fs::path path;
    Stamp stamp{};  ///< see set_stamps()
};

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

bool contains_any(const std::string& text, std::span<const std::string_view> words) {
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
    if (begin == end) return std::nullopt;
    return NumberedFile{stem.substr(begin, end - begin), path};
}

struct Listing {
    std::vector<NumberedFile> color, depth;
    std::size_t unnumbered = 0;
    bool time = false;  ///< the numbers are time stamps, not numbers of frames

    void take(const fs::path& file, std::vector<NumberedFile>& files) {
        if (auto image = numbered(file))
            files.push_back(std::move(*image));
        else
            ++unnumbered;
    }
};

std::vector<fs::path> entries_of(const fs::path& folder) {
    std::vector<fs::path> entries;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) entries.push_back(entry.path());
    if (error) throw Error(folder.string() + ": cannot be read: " + error.message());
    return entries;
}

/// Images of both kinds in one folder, told apart by words in their names.
void list_by_words(const fs::path& folder, std::span<const std::string_view> color_words, Listing& listing) {
    for (const fs::path& file : entries_of(folder)) {
        if (!has_image_ending(file)) continue;
        const std::string name = lower_case(file.filename().string());
        if (name.find(kDepthWord) != std::string::npos)
            listing.take(file, listing.depth);
        else if (contains_any(name, color_words))
            listing.take(file, listing.color);
    }
}

Listing list_images(const fs::path& folder) {
    Listing listing;
    if (is_replica_folder(folder)) {
        list_by_words(folder / "results", {&kReplicaColorWord, 1}, listing);
        return listing;
    }
    list_by_words(folder, kColorWords, listing);
    for (const fs::path& entry : entries_of(folder)) {
        if (!fs::is_directory(entry)) continue;
        const std::string name = lower_case(entry.filename().string());
        const bool color = std::find(kColorFolders.begin(), kColorFolders.end(), name) != kColorFolders.end();
        if (!color && name != kDepthWord) continue;
        for (const fs::path& file : entries_of(entry))
            if (has_image_ending(file)) listing.take(file, color ? listing.color : listing.depth);
    }
    return listing;
}

std::vector<std::string_view> numbers_of(const std::vector<NumberedFile>& files) {
    std::vector<std::string_view> numbers;
    for (const NumberedFile& file : files) numbers.push_back(file.number);
    return numbers;
}

/// Whether the numbers are times rather than frame numbers: they have a decimal point, count from 1970, or increase in
/// steps that are too long for frame numbers.
bool tells_time(const std::vector<std::string_view>& numbers) {
    constexpr double kLongestStride = 30;
    constexpr double kMillisecondsIn2001 = 1e12;
    const auto is_time = [](std::string_view number) {
        return number.find('.') != std::string_view::npos || parse_number(number).value_or(0) >= kMillisecondsIn2001;
    };
    return std::any_of(numbers.begin(), numbers.end(), is_time) || median_interval(numbers) >= kLongestStride;
}

/// Of these layouts it is known, whatever the steps.
bool has_numbers_of_frames(const fs::path& folder) { return is_replica_folder(folder) || is_scannet_folder(folder); }

/// Sets the stamps from the numbers in the names, in ascending order. Repeated numbers are reported in `warnings`.
void set_stamps(Listing& listing, const fs::path& folder, const SourceOptions& options,
                std::vector<std::string>& warnings) {
    const auto numbers = numbers_of(listing.color);
    listing.time = options.time_unit || (!has_numbers_of_frames(folder) && tells_time(numbers));
    const TimeUnit unit =
        listing.time ? recognise_time_unit(numbers, options.time_unit, folder.string()) : TimeUnit::Seconds;
    if (unit != TimeUnit::Seconds)
        warnings.push_back(folder.string() + ": the numbers in the names are taken as time stamps in " +
                           symbol_of(unit));
    for (auto [files, what] : {std::pair{&listing.color, "colour image"}, std::pair{&listing.depth, "depth image"}}) {
        for (NumberedFile& file : *files) {
            const auto stamp = parse_stamp(file.number, unit);
            if (!stamp) throw Error(file.path.string() + ": the number in the name is no time");
            file.stamp =
                listing.time ? *stamp : stamp_of_number(static_cast<std::size_t>(stamp->count() / std::nano::den));
        }
        std::sort(files->begin(), files->end(), [](const NumberedFile& a, const NumberedFile& b) {
            return a.stamp != b.stamp ? a.stamp < b.stamp : a.path < b.path;
        });
        put_in_order(*files, folder.string(), what, warnings);
    }
}

std::vector<FramePaths> pair_images(const Listing& listing) {
    std::vector<FramePaths> frames;
    for (const auto& [c, d] : associate(stamps_of(listing.color), stamps_of(listing.depth))) {
        const NumberedFile& color = listing.color[c];
        frames.push_back({{color.stamp, listing.time ? color.number : seconds_text(color.stamp),
                           listing.depth[d].stamp - color.stamp},
                          color.path,
                          listing.depth[d].path});
    }
    return frames;
}

}  // namespace

std::unique_ptr<FrameSource> open_image_folder(const fs::path& folder, const SourceOptions& options) {
    std::vector<std::string> warnings;
    Listing listing = list_images(folder);
    if (listing.color.empty() || listing.depth.empty())
        throw Error(folder.string() +
                    ": is no recording: neither lists (rgb.txt and depth.txt, or associations.txt) nor numbered colour "
                    "and depth images (in rgb/ and depth/, or with these words in their names)");
    set_stamps(listing, folder, options, warnings);
    std::vector<FramePaths> frames = pair_images(listing);
    if (frames.empty())
        throw Error(folder.string() + ": no colour image has a depth image of the same number (" +
                    listing.color.front().path.filename().string() + " and " +
                    listing.depth.front().path.filename().string() + " are the first of each)");
    const std::size_t alone = listing.color.size() + listing.depth.size() - 2 * frames.size() + listing.unnumbered;
    if (alone > 0)
        warnings.push_back(folder.string() + ": " + count_text(alone, "image") + " without partner left out");
    return std::make_unique<ImageFiles>(folder, options, std::move(frames), std::move(warnings));
}

}  // namespace posefusion
