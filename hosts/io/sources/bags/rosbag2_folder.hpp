#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "hosts/io/sources/bags/message_bag.hpp"

/// A folder as rosbag2 records it: metadata.yaml and the files of the bag, .db3 or .mcap, one or several after another.
namespace posefusion {

/// Whether there is a file of a bag in it, or the metadata of one.
[[nodiscard]] bool is_rosbag2_folder(const std::filesystem::path& folder);

/// The messages of all files in the folder as one bag. A recording that was interrupted has no metadata.yaml and is
/// read without; of one that has it, files that it names and that are not there are told.
class Rosbag2Folder final : public MessageBag {
public:
    /// Throws Error: no files of a bag, none of them can be read.
    explicit Rosbag2Folder(const std::filesystem::path& folder);

private:
    [[nodiscard]] ByteBuffer read_bytes(const Message& message, std::size_t at_most) const override;

    void add_file(const std::filesystem::path& file);

    std::vector<std::unique_ptr<MessageBag>> files_;
};

}  // namespace posefusion
