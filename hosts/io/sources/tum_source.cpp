#include "hosts/io/sources/tum_source.hpp"

#include <algorithm>
#include <cmath>

#include "hosts/io/association.hpp"
#include "hosts/io/sources/folder.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// A line `stamp file` of rgb.txt or depth.txt.
struct ListedFile {
    double stamp = 0;
    std::string stamp_text;
    fs::path file;
};

std::string count(std::size_t n, const char* what) { return std::to_string(n) + " " + what + (n == 1 ? "" : "s"); }

std::optional<double> parse_stamp(const std::string& text) {
    const auto stamp = parse_number(text);
    return stamp && std::isfinite(*stamp) ? stamp : std::nullopt;
}

/// Takes the lines of a list for which `take` returns true; the others are worth a warning, a list without any an
/// error.
template <class Take>
void read_list(const fs::path& list, const char* expected, std::vector<std::string>& warnings, Take take) {
    std::size_t bad = 0, good = 0, first_bad = 0;
    for (const TextLine& line : read_text_table(list)) {
        if (take(line))
            ++good;
        else if (bad++ == 0)
            first_bad = line.number;
    }
    if (good == 0 && bad == 0) throw Error(list.string() + ": is empty; expected lines: " + expected);
    if (good == 0)
        throw Error(list.string() + ": no line can be used (line " + std::to_string(first_bad) +
                    " first); expected lines: " + expected);
    if (bad > 0)
        warnings.push_back(list.string() + ": " + count(bad, "line") + " left out, the first is line " +
                           std::to_string(first_bad));
}

/// Ascending stamps, each once (the first line with it counts).
std::vector<ListedFile> read_file_list(const fs::path& list, std::vector<std::string>& warnings) {
    std::vector<ListedFile> files;
    read_list(list, "timestamp filename", warnings, [&](const TextLine& line) {
        const auto stamp = line.fields.size() >= 2 ? parse_stamp(line.fields[0]) : std::nullopt;
        if (stamp) files.push_back({*stamp, line.fields[0], line.fields[1]});
        return stamp.has_value();
    });
    const auto by_stamp = [](const ListedFile& a, const ListedFile& b) { return a.stamp < b.stamp; };
    if (!std::is_sorted(files.begin(), files.end(), by_stamp)) {
        warnings.push_back(list.string() + ": time stamps are not in order; they have been sorted");
        std::stable_sort(files.begin(), files.end(), by_stamp);
    }
    const auto same = [](const ListedFile& a, const ListedFile& b) { return a.stamp == b.stamp; };
    const auto end = std::unique(files.begin(), files.end(), same);
    if (end != files.end()) {
        warnings.push_back(list.string() + ": " +
                           count(static_cast<std::size_t>(files.end() - end), "repeated time stamp") + " left out");
        files.erase(end, files.end());
    }
    return files;
}

std::vector<double> stamps_of(const std::vector<ListedFile>& files) {
    std::vector<double> stamps;
    stamps.reserve(files.size());
    for (const ListedFile& f : files) stamps.push_back(f.stamp);
    return stamps;
}

std::vector<FramePaths> pair_lists(const fs::path& folder, std::vector<std::string>& warnings) {
    const auto color = read_file_list(folder / "rgb.txt", warnings);
    const auto depth = read_file_list(folder / "depth.txt", warnings);
    std::vector<FramePaths> frames;
    for (const auto& [c, d] : associate(stamps_of(color), stamps_of(depth)))
        frames.push_back({{color[c].stamp, color[c].stamp_text}, folder / color[c].file, folder / depth[d].file});
    if (frames.empty())
        throw Error(folder.string() + ": no colour image of rgb.txt has a depth image in depth.txt within 20 ms");
    if (frames.size() < color.size())
        warnings.push_back(folder.string() + ": " + count(color.size() - frames.size(), "colour image") +
                           " without a depth image within 20 ms left out");
    return frames;
}

/// Some recordings (ICL-NUIM) list the depth image first.
bool names_depth(const std::string& file) { return file.find("depth") != std::string::npos; }

/// Paths in the list are relative to `folder`.
std::vector<FramePaths> read_associations(const fs::path& list, const fs::path& folder,
                                          std::vector<std::string>& warnings) {
    std::vector<FramePaths> frames;
    read_list(list, "timestamp colour_file timestamp depth_file", warnings, [&](const TextLine& line) {
        if (line.fields.size() < 4) return false;
        const auto stamp = parse_stamp(line.fields[0]), depth_stamp = parse_stamp(line.fields[2]);
        if (!stamp || !depth_stamp) return false;
        const FramePaths pair{{*stamp, line.fields[0]}, folder / line.fields[1], folder / line.fields[3]};
        const bool swapped = names_depth(line.fields[1]) && !names_depth(line.fields[3]);
        frames.push_back(swapped ? FramePaths{{*depth_stamp, line.fields[2]}, pair.depth, pair.color} : pair);
        return true;
    });
    const auto by_stamp = [](const FramePaths& a, const FramePaths& b) { return a.entry.stamp < b.entry.stamp; };
    if (!std::is_sorted(frames.begin(), frames.end(), by_stamp)) {
        warnings.push_back(list.string() + ": time stamps are not in order; they have been sorted");
        std::stable_sort(frames.begin(), frames.end(), by_stamp);
    }
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
        frames = read_associations(options.associations_file, folder, warnings);
    else if (fs::exists(folder / "associations.txt"))
        frames = read_associations(folder / "associations.txt", folder, warnings);
    else if (fs::exists(folder / "rgb.txt") && fs::exists(folder / "depth.txt"))
        frames = pair_lists(folder, warnings);
    else
        throw Error(folder.string() +
                    ": is no recording in TUM layout (rgb.txt and depth.txt, or associations.txt, are missing)");
    return std::make_unique<ImageFiles>(folder, options, std::move(frames), std::move(warnings));
}

}  // namespace posefusion
