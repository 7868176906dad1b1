#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/recording.hpp"

/// Person masks as files: <stamp of the colour image>.png, in seconds or whatever smaller unit fits the recording, or
/// <number of the frame>.png, as the images are numbered or else counted from 0 or 1; of these meanings that counts in
/// which the most frames have a mask. Grey, 8 or 16 bit, in the geometry of the recording's own images (not
/// undistorted, not shrunk): they can be compared and reused whatever the run's options.
namespace posefusion {

class MaskFolder {
public:
    /// @param folder    with the masks, or with a sub-folder `masks`. Throws Error when there are none.
    /// @param recording  must outlive this object
    /// @param classes   label values that are people; a pixel gets the place of its value in this list, from 1. Empty:
    ///                  0 is static and every other value a person (values above 255 are folded into 1..255).
    MaskFolder(const std::filesystem::path& folder, const Recording& recording, std::vector<int> classes = {});

    [[nodiscard]] std::size_t size() const { return files_.size(); }
    /// Frames of the recording without a mask within 20 ms; 0 for a camera.
    [[nodiscard]] std::size_t frames_without() const;
    /// The mask nearest to the stamp within 20 ms, brought to the geometry of Recording::load's images; nullopt if
    /// there is none. May be called from several threads. Throws Error when there is one that cannot be used.
    [[nodiscard]] std::optional<LabelImage> load(Stamp stamp) const;
    /// The same in the geometry of the recording's own images.
    [[nodiscard]] std::optional<LabelImage> load_as_recorded(Stamp stamp) const;
    /// Whether there is one within 20 ms.
    [[nodiscard]] bool has(Stamp stamp) const;

private:
    [[nodiscard]] std::uint8_t person(std::uint16_t value) const;

    const Recording& recording_;
    std::vector<int> classes_;
    std::vector<Stamp> stamps_;
    std::vector<std::filesystem::path> files_;
};

/// Writes folder/<stamp_text>.png (atomically). Throws Error.
/// @param labels  in the geometry of Recording::load's images
void write_mask(const std::filesystem::path& folder, const std::string& stamp_text, const LabelImage& labels,
                const Recording& recording);

}  // namespace posefusion
