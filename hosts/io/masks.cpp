#include "hosts/io/masks.hpp"

#include <algorithm>

#include "engine/core/error.hpp"
#include "hosts/io/association.hpp"
#include "hosts/io/image_file.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kMostPeople = 255;  ///< different labels of a label image

struct MaskFile {
    Stamp stamp;
    fs::path path;
};

std::optional<Stamp> stamp_in_name(const fs::path& file, TimeUnit unit) {
    return parse_stamp(file.stem().string(), unit);
}

/// PNG files whose name is a time stamp in some unit.
std::vector<fs::path> list_masks(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (entry.path().extension() == ".png" && stamp_in_name(entry.path(), kTimeUnits.back()))
            files.push_back(entry.path());
    return files;
}

/// The unit with which most names match frames: names alone are not reliable if only a few frames have masks.
TimeUnit unit_of_names(const std::vector<fs::path>& files, const Recording& recording) {
    std::vector<Stamp> frames;
    for (const FrameEntry& frame : recording.frames()) frames.push_back(frame.stamp);
    TimeUnit best = TimeUnit::Seconds;
    std::ptrdiff_t most = 0;
    for (const TimeUnit unit : kTimeUnits) {
        const auto known = std::count_if(files.begin(), files.end(), [&](const fs::path& file) {
            const auto stamp = stamp_in_name(file, unit);
            return stamp && nearest_stamp(frames, *stamp);
        });
        if (known > most) {
            most = known;
            best = unit;
        }
    }
    return best;
}

}  // namespace

MaskFolder::MaskFolder(const fs::path& folder, const Recording& recording, std::vector<int> classes)
    : recording_(recording), classes_(std::move(classes)) {
    if (classes_.size() > kMostPeople)
        throw Error("more than " + std::to_string(kMostPeople) + " classes of people are given; leave some out");
    if (!fs::is_directory(folder)) throw Error(folder.string() + ": mask folder not found");
    auto files = list_masks(folder);
    if (files.empty()) files = list_masks(folder / "masks");
    if (files.empty()) throw Error(folder.string() + ": holds no masks (expected <stamp of the colour image>.png)");
    const TimeUnit unit = unit_of_names(files, recording);
    std::vector<MaskFile> masks;
    for (fs::path& file : files)
        if (const auto stamp = stamp_in_name(file, unit)) masks.push_back({*stamp, std::move(file)});
    std::sort(masks.begin(), masks.end(), [](const MaskFile& a, const MaskFile& b) {
        return a.stamp != b.stamp ? a.stamp < b.stamp : a.path < b.path;
    });
    for (MaskFile& mask : masks) {
        stamps_.push_back(mask.stamp);
        files_.push_back(std::move(mask.path));
    }
}

std::optional<LabelImage> MaskFolder::load(Stamp stamp) const {
    const auto index = nearest_stamp(stamps_, stamp);
    if (!index) return std::nullopt;
    const Intrinsics& source = recording_.camera().intrinsics;
    const auto values = read_wide_labels(files_[*index], {source.width, source.height});
    LabelImage labels(values.width(), values.height());
    std::transform(values.begin(), values.end(), labels.begin(), [&](std::uint16_t value) { return person(value); });
    return recording_.labels_from_source(labels);
}

std::size_t MaskFolder::frames_without() const {
    const auto& frames = recording_.frames();
    return static_cast<std::size_t>(std::count_if(
        frames.begin(), frames.end(), [&](const FrameEntry& frame) { return !nearest_stamp(stamps_, frame.stamp); }));
}

std::uint8_t MaskFolder::person(std::uint16_t value) const {
    if (classes_.empty())
        return static_cast<std::uint8_t>(value <= kMostPeople ? value : 1 + (value - 1) % kMostPeople);
    const auto found = std::find(classes_.begin(), classes_.end(), value);
    return static_cast<std::uint8_t>(found == classes_.end() ? 0 : found - classes_.begin() + 1);
}

void write_mask(const fs::path& folder, const std::string& stamp_text, const LabelImage& labels,
                const Recording& recording) {
    write_labels(folder / (stamp_text + ".png"), recording.labels_to_source(labels));
}

}  // namespace posefusion
