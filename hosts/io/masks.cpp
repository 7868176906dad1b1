#include "hosts/io/masks.hpp"

#include <algorithm>
#include <charconv>
#include <functional>
#include <set>
#include <utility>

#include "engine/core/error.hpp"
#include "hosts/io/association.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/sources/time_order.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kMostPeople = 255;               ///< different labels of a label image
constexpr std::size_t kMostNumber = 1'000'000'000;  ///< of a frame: a year at 30 Hz

struct MaskFile {
    Stamp stamp;
    fs::path path;
};

/// What the number in the name of a mask means: a frame, by its time; nullopt: none.
using Meaning = std::function<std::optional<Stamp>(const std::string& number)>;

std::optional<std::size_t> whole_number(const std::string& text) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return number;
}

/// All that it may mean, the likelier ones first.
std::vector<Meaning> meanings(const Recording& recording) {
    std::vector<Meaning> all;
    for (const TimeUnit unit : kTimeUnits)
        all.push_back([unit](const std::string& number) { return parse_stamp(number, unit); });
    // the number that images without stamps have in their names
    all.push_back([](const std::string& number) -> std::optional<Stamp> {
        const auto n = whole_number(number);
        if (!n || *n > kMostNumber) return std::nullopt;
        return stamp_of_number(*n);
    });
    for (const std::size_t first : {0u, 1u})
        all.push_back([first, &recording](const std::string& number) -> std::optional<Stamp> {
            const auto n = whole_number(number);
            const FrameEntry* frame = n && *n >= first ? recording.frame_at(*n - first) : nullptr;
            return frame == nullptr ? std::nullopt : std::optional(frame->stamp);
        });
    return all;
}

/// PNG files whose name is a number.
std::vector<fs::path> list_masks(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (entry.path().extension() == ".png" && parse_stamp(entry.path().stem().string(), kTimeUnits.back()))
            files.push_back(entry.path());
    return files;
}

std::vector<MaskFile> with_stamps(const std::vector<fs::path>& files, const Meaning& meaning) {
    std::vector<MaskFile> masks;
    for (const fs::path& file : files)
        if (const auto stamp = meaning(file.stem().string())) masks.push_back({*stamp, file});
    std::sort(masks.begin(), masks.end(), [](const MaskFile& a, const MaskFile& b) {
        return a.stamp != b.stamp ? a.stamp < b.stamp : a.path < b.path;
    });
    return masks;
}

/// Frames that are the nearest one of a mask.
std::size_t frames_with_mask(const std::vector<MaskFile>& masks, const std::vector<Stamp>& frames) {
    std::set<std::size_t> found;
    for (const MaskFile& mask : masks)
        if (const auto frame = nearest_stamp(frames, mask.stamp)) found.insert(*frame);
    return found.size();
}

/// In the meaning with which most frames have a mask: names alone are not reliable if only a few frames have masks.
std::vector<MaskFile> match_masks(const std::vector<fs::path>& files, const Recording& recording) {
    const std::vector<Stamp> stamps = stamps_of(recording.frames());
    std::vector<MaskFile> best;
    std::size_t most = 0;
    for (const Meaning& meaning : meanings(recording)) {
        std::vector<MaskFile> masks = with_stamps(files, meaning);
        const std::size_t matched = frames_with_mask(masks, stamps);
        if (matched <= most && !best.empty()) continue;
        most = matched;
        best = std::move(masks);
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
    if (files.empty())
        throw Error(folder.string() + ": holds no masks (expected <stamp or number of the colour image>.png)");
    std::vector<MaskFile> masks = match_masks(files, recording);
    for (MaskFile& mask : masks) {
        stamps_.push_back(mask.stamp);
        files_.push_back(std::move(mask.path));
    }
    if (!recording.live() && frames_without() == recording.size())
        throw Error(folder.string() + ": no mask belongs to a frame of " + recording.location() +
                    "; name them by the stamps of the colour images (" + recording.frames().front().stamp_text +
                    ".png)");
}

std::optional<LabelImage> MaskFolder::load(Stamp stamp) const {
    const auto labels = load_as_recorded(stamp);
    return labels ? std::optional(recording_.labels_from_source(*labels)) : std::nullopt;
}

bool MaskFolder::has(Stamp stamp) const { return nearest_stamp(stamps_, stamp).has_value(); }

std::optional<LabelImage> MaskFolder::load_as_recorded(Stamp stamp) const {
    const auto index = nearest_stamp(stamps_, stamp);
    if (!index) return std::nullopt;
    const Intrinsics& source = recording_.camera().intrinsics;
    const auto values = read_wide_labels(files_[*index], {source.width, source.height});
    LabelImage labels(values.width(), values.height());
    std::transform(values.begin(), values.end(), labels.begin(), [&](std::uint16_t value) { return person(value); });
    return labels;
}

std::size_t MaskFolder::frames_without() const {
    const auto& frames = recording_.frames();
    return static_cast<std::size_t>(
        std::count_if(frames.begin(), frames.end(), [&](const FrameEntry& frame) { return !has(frame.stamp); }));
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
