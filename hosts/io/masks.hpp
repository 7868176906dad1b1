#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/sequence.hpp"

/// Person masks as files: <stamp of the colour image>.png, 8 bit, 0 static, 1..n person, in the geometry of the
/// recording's own images (not undistorted, not shrunk): they can be compared and reused whatever the run's options.
namespace posefusion {

class MaskFolder {
public:
    /// @param folder    with the masks, or with a folder `masks` in it. Throws Error when there are none.
    /// @param sequence  must outlive this object
    MaskFolder(const std::filesystem::path& folder, const Sequence& sequence);

    [[nodiscard]] std::size_t size() const { return files_.size(); }
    /// The mask nearest to the stamp within 20 ms, brought to the geometry of Sequence::load's images; nullopt if there
    /// is none. May be called from several threads. Throws Error when the file cannot be used.
    [[nodiscard]] std::optional<LabelImage> load(double stamp) const;

private:
    const Sequence& sequence_;
    std::vector<double> stamps_;
    std::vector<std::filesystem::path> files_;
};

/// Writes folder/<stamp_text>.png (atomically). Throws Error.
/// @param labels  in the geometry of Sequence::load's images
void write_mask(const std::filesystem::path& folder, const std::string& stamp_text, const LabelImage& labels,
                const Sequence& sequence);

}  // namespace posefusion
