#pragma once
#include <filesystem>
#include <memory>

#include "hosts/io/frame_source.hpp"
#include "hosts/io/sources/bags/message_bag.hpp"

/// Recognises bags: which kind a file or folder is.
namespace posefusion {

/// By its name: .bag, .mcap, .db3, the last two also packed as a whole (.mcap.zstd, .db3.zst).
[[nodiscard]] bool is_bag_file(const std::filesystem::path& file);

/// Throws Error: not a bag of that kind, damaged before the first message, no messages.
[[nodiscard]] std::unique_ptr<MessageBag> open_bag_file(const std::filesystem::path& file);

/// A bag file, or a folder of them as rosbag2 makes it. Throws Error as frames_of_bag() does.
[[nodiscard]] std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& location,
                                                    const SourceOptions& options);

}  // namespace posefusion
