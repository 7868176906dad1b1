#include "hosts/io/sources/tum_source.hpp"

#include <utility>

#include "hosts/io/association.hpp"
#include "hosts/io/listed_path.hpp"
#include "hosts/io/sources/folder.hpp"
#include "hosts/io/sources/time_order.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// A line `stamp file` of rgb.txt or depth.txt.
struct ListedFile {
    Stamp stamp{};
    std::string stamp_text;
    std::string file;  ///< as written
};

/// rgb.txt, depth.txt or a list of pairs.
struct List {
    fs::path file;
    std::vector<TextLine> lines;
    TimeUnit unit = TimeUnit::Seconds;
};

List open_list(const fs::path& file, const SourceOptions& options, std::vector<std::string>& warnings) {
    List list{file, read_text_table(file)};
    std::vector<std::string_view> stamps;
    for (const TextLine& line : list.lines) stamps.push_back(line.fields.front());
    list.unit = recognise_time_unit(stamps, options.time_unit, file.string());
    if (list.unit != TimeUnit::Seconds)
        warnings.push_back(file.string() + ": time stamps are taken as " + symbol_of(list.unit));
    return list;
}

/// Takes the lines of a list for which `take` returns true; the others are worth a warning, a list without any an
/// error.
template <class Take>
void read_list(const List& list, const char* expected, std::vector<std::string>& warnings, Take take) {
    std::size_t bad = 0, good = 0, first_bad = 0;
    for (const TextLine& line : list.lines) {
        if (take(line))
            ++good;
        else if (bad++ == 0)
            first_bad = line.number;
    }
    if (good == 0 && bad == 0) throw Error(list.file.string() + ": is empty; expected lines: " + expected);
    if (good == 0)
        throw Error(list.file.string() + ": no line can be used (line " + std::to_string(first_bad) +
                    " first); expected lines: " + expected);
    if (bad > 0)
        warnings.push_back(list.file.string() + ": " + count_text(bad, "line") + " left out, the first is line " +
                           std::to_string(first_bad));
}

/// Ascending stamps, each once (the first line with it counts).
std::vector<ListedFile> read_file_list(const List& list, std::vector<std::string>& warnings) {
    std::vector<ListedFile> files;
    read_list(list, "timestamp filename", warnings, [&](const TextLine& line) {
        const auto stamp = line.fields.size() >= 2 ? parse_stamp(line.fields[0], list.unit) : std::nullopt;
        if (stamp) files.push_back({*stamp, line.fields[0], take_path(line, 1).path});
        return stamp.has_value();
    });
    if (say_nothing(stamps_of(files)))
        throw Error(list.file.string() +
                    ": most of its time stamps are alike, so colour and depth cannot be paired; "
                    "list the pairs in associations.txt");
    put_in_order(files, list.file.string(), "line", warnings);
    return files;
}

std::vector<FramePaths> pair_lists(const fs::path& folder, const SourceOptions& options,
                                   std::vector<std::string>& warnings) {
    const List color_list = open_list(folder / "rgb.txt", options, warnings);
    const List depth_list = open_list(folder / "depth.txt", options, warnings);
    const auto color = read_file_list(color_list, warnings);
    const auto depth = read_file_list(depth_list, warnings);
    if (color_list.unit != depth_list.unit)
        throw Error(folder.string() + ": the time stamps of rgb.txt look like " + symbol_of(color_list.unit) +
                    ", those of depth.txt like " + symbol_of(depth_list.unit) + "; say what they are with --time-unit");
    std::vector<FramePaths> frames;
    for (const auto& [c, d] : associate(stamps_of(color), stamps_of(depth)))
        frames.push_back({{color[c].stamp, color[c].stamp_text, depth[d].stamp - color[c].stamp},
                          resolve_path(folder, color[c].file),
                          resolve_path(folder, depth[d].file)});
    if (frames.empty())
        throw Error(folder.string() + ": no colour image of rgb.txt has a depth image in depth.txt within 20 ms");
    if (frames.size() < color.size())
        warnings.push_back(folder.string() + ": " + count_text(color.size() - frames.size(), "colour image") +
                           " without a depth image within 20 ms left out");
    return frames;
}

/// Some recordings (ICL-NUIM) list the depth image first.
bool names_depth(const std::string& file) { return file.find("depth") != std::string::npos; }

struct ListedPair {
    ListedFile color, depth;
};

/// `stamp file stamp file`, whatever comes after it.
std::optional<ListedPair> read_pair(const TextLine& line, TimeUnit unit) {
    constexpr std::size_t kFewestFields = 4;
    const auto& fields = line.fields;
    if (fields.size() < kFewestFields) return std::nullopt;
    for (const ListedPath& color : {take_path(line, 1), ListedPath{fields[1], 2}}) {
        if (color.next + 1 >= fields.size()) continue;
        const auto stamp = parse_stamp(fields[0], unit), depth_stamp = parse_stamp(fields[color.next], unit);
        if (stamp && depth_stamp)
            return ListedPair{{*stamp, fields[0], color.path},
                              {*depth_stamp, fields[color.next], take_path(line, color.next + 1).path}};
    }
    return std::nullopt;
}

/// Paths in the list are relative to `folder`.
std::vector<FramePaths> read_associations(const fs::path& file, const fs::path& folder, const SourceOptions& options,
                                          std::vector<std::string>& warnings) {
    const List list = open_list(file, options, warnings);
    std::vector<FramePaths> frames;
    read_list(list, "timestamp colour_file timestamp depth_file", warnings, [&](const TextLine& line) {
        auto pair = read_pair(line, list.unit);
        if (!pair) return false;
        if (names_depth(pair->color.file) && !names_depth(pair->depth.file)) std::swap(pair->color, pair->depth);
        frames.push_back({{pair->color.stamp, pair->color.stamp_text, pair->depth.stamp - pair->color.stamp},
                          resolve_path(folder, pair->color.file),
                          resolve_path(folder, pair->depth.file)});
        return true;
    });
    const auto stamp = [](const FramePaths& frame) { return frame.entry.stamp; };
    if (say_nothing(stamps_of(frames, stamp))) {
        for (std::size_t i = 0; i < frames.size(); ++i) frames[i].entry = entry_at(stamp_of_number(i));
        warnings.push_back(file.string() + ": its time stamps are all alike; 30 frames a second are assumed");
    }
    put_in_order(frames, file.string(), "frame", warnings, stamp);
    return frames;
}

}  // namespace

bool is_tum_folder(const fs::path& folder) {
    return fs::exists(folder / "associations.txt") || fs::exists(folder / "rgb.txt") ||
           fs::exists(folder / "depth.txt");
}

std::unique_ptr<FrameSource> open_tum_folder(const fs::path& folder, const SourceOptions& options) {
    std::vector<std::string> warnings;
    std::vector<FramePaths> frames;
    if (!options.associations_file.empty())
        frames = read_associations(options.associations_file, folder, options, warnings);
    else if (fs::exists(folder / "associations.txt"))
        frames = read_associations(folder / "associations.txt", folder, options, warnings);
    else if (fs::exists(folder / "rgb.txt") && fs::exists(folder / "depth.txt"))
        frames = pair_lists(folder, options, warnings);
    else
        throw Error(folder.string() +
                    ": is no recording in TUM layout (rgb.txt and depth.txt, or associations.txt, are missing)");
    return std::make_unique<ImageFiles>(folder, options, std::move(frames), std::move(warnings));
}

}  // namespace posefusion
