#include "hosts/io/sequence.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/error.hpp"
#include "hosts/io/association.hpp"
#include "hosts/io/image_file.hpp"
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

std::vector<FrameEntry> pair_lists(const fs::path& folder, std::vector<std::string>& warnings) {
    const auto color = read_file_list(folder / "rgb.txt", warnings);
    const auto depth = read_file_list(folder / "depth.txt", warnings);
    std::vector<FrameEntry> frames;
    for (const auto& [c, d] : associate(stamps_of(color), stamps_of(depth)))
        frames.push_back({color[c].stamp, color[c].stamp_text, folder / color[c].file, folder / depth[d].file});
    if (frames.empty())
        throw Error(folder.string() + ": no colour image of rgb.txt has a depth image in depth.txt within 20 ms");
    if (frames.size() < color.size())
        warnings.push_back(folder.string() + ": " + count(color.size() - frames.size(), "colour image") +
                           " without a depth image within 20 ms left out");
    return frames;
}

/// Some recordings (ICL-NUIM) list the depth image first.
bool names_depth(const std::string& file) { return file.find("depth") != std::string::npos; }

std::vector<FrameEntry> read_associations(const fs::path& folder, std::vector<std::string>& warnings) {
    const fs::path list = folder / "associations.txt";
    std::vector<FrameEntry> frames;
    read_list(list, "timestamp colour_file timestamp depth_file", warnings, [&](const TextLine& line) {
        if (line.fields.size() < 4) return false;
        const auto stamp = parse_stamp(line.fields[0]), depth_stamp = parse_stamp(line.fields[2]);
        if (!stamp || !depth_stamp) return false;
        const FrameEntry entry{*stamp, line.fields[0], folder / line.fields[1], folder / line.fields[3]};
        const bool swapped = names_depth(line.fields[1]) && !names_depth(line.fields[3]);
        frames.push_back(swapped ? FrameEntry{*depth_stamp, line.fields[2], entry.depth, entry.color} : entry);
        return true;
    });
    const auto by_stamp = [](const FrameEntry& a, const FrameEntry& b) { return a.stamp < b.stamp; };
    if (!std::is_sorted(frames.begin(), frames.end(), by_stamp)) {
        warnings.push_back(list.string() + ": time stamps are not in order; they have been sorted");
        std::stable_sort(frames.begin(), frames.end(), by_stamp);
    }
    return frames;
}

std::vector<FrameEntry> list_frames(const fs::path& folder, std::vector<std::string>& warnings) {
    if (!fs::exists(folder)) throw Error(folder.string() + ": sequence folder not found");
    if (!fs::is_directory(folder)) throw Error(folder.string() + ": is not a folder; give the folder of the sequence");
    const bool lists = fs::exists(folder / "rgb.txt") && fs::exists(folder / "depth.txt");
    if (fs::exists(folder / "associations.txt")) return read_associations(folder, warnings);
    if (!lists)
        throw Error(folder.string() +
                    ": is no sequence in TUM layout (rgb.txt and depth.txt, or associations.txt, are missing)");
    return pair_lists(folder, warnings);
}

std::string folder_name(const fs::path& folder) {
    fs::path full = fs::weakly_canonical(folder);
    return full.has_filename() ? full.filename().string() : full.parent_path().filename().string();
}

Camera find_camera(const fs::path& folder, const fs::path& camera_file) {
    if (!camera_file.empty()) return read_camera_file(camera_file);
    if (fs::exists(folder / "camera.yaml")) return read_camera_file(folder / "camera.yaml");
    if (const auto camera = tum_camera(folder_name(folder))) return *camera;
    throw Error(
        folder.string() +
        ": the camera is not known: there is no camera.yaml and the folder name has no fr1, fr2 or fr3; give one with "
        "--camera FILE (fx fy cx cy width height depth_scale)");
}

bool has_depth(const DepthImage& depth) {
    return std::any_of(depth.begin(), depth.end(), [](float d) { return d > 0; });
}

bool is_black(const ColorImage& color) {
    constexpr std::uint8_t kDarkest = 8;  // sensor noise in the dark stays below this grey level
    return std::none_of(color.begin(), color.end(), [](Rgb8 c) { return std::max({c.r, c.g, c.b}) > kDarkest; });
}

}  // namespace

Sequence::Sequence(const fs::path& folder, const SequenceOptions& options) : folder_(folder) {
    frames_ = list_frames(folder, warnings_);
    camera_ = find_camera(folder, options.camera_file);
    geometry_ = ImageGeometry(camera_, options.scale);
}

std::string Sequence::name() const { return folder_name(folder_); }

Frame Sequence::load(std::size_t i) const {
    const FrameEntry& entry = frames_.at(i);
    const ImageSize size{camera_.intrinsics.width, camera_.intrinsics.height};
    Frame frame;
    frame.index = i;
    frame.stamp = entry.stamp;
    frame.stamp_text = entry.stamp_text;
    frame.color = geometry_.from_source(read_color(entry.color, size));
    if (is_black(frame.color))
        throw Error(entry.color.string() + ": colour image is black, nobody could be found in it");
    frame.depth = geometry_.from_source(read_depth(entry.depth, size, camera_.depth_scale));
    if (!has_depth(frame.depth)) throw Error(entry.depth.string() + ": depth image holds no measurement");
    return frame;
}

LabelImage Sequence::labels_from_source(const LabelImage& labels) const { return geometry_.from_source(labels); }
LabelImage Sequence::labels_to_source(const LabelImage& labels) const { return geometry_.to_source(labels); }

std::optional<Trajectory> Sequence::groundtruth() const {
    const fs::path file = folder_ / "groundtruth.txt";
    if (!fs::exists(file)) return std::nullopt;
    return read_trajectory(file);
}

std::string BadFrames::bad(const std::string& reason) {
    ++bad_;
    if (good_ == 0 && bad_ >= total_) throw Error("no frame of the sequence can be used; the last fault: " + reason);
    if (good_ == 0 && bad_ >= patience_)
        throw Error("none of the first " + std::to_string(bad_) + " frames can be used; the last fault: " + reason);
    return "frame skipped: " + reason;
}

}  // namespace posefusion
