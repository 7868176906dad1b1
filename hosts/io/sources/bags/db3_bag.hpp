#pragma once
#include <memory>
#include <mutex>
#include <string>

#include "hosts/io/sources/bags/message_bag.hpp"

struct sqlite3;

/// rosbag2's .db3 files: an SQLite database with the tables `topics` and `messages`.
///
/// Opened read only, and as a file that nobody writes, so that one on a read-only disk can be read. Where a recording
/// was interrupted, the rest of it may be in NAME.db3-wal, which SQLite takes into account (it puts NAME.db3-shm beside
/// it meanwhile); a half-written NAME.db3-journal must be undone by the user, who is told how.
namespace posefusion {

class Db3Bag final : public MessageBag {
public:
    /// @param name  of the recording, for messages
    /// Throws Error: no database, not one of rosbag2, damaged before the first message, no messages of ROS.
    Db3Bag(const std::filesystem::path& file, const std::string& name);
    explicit Db3Bag(const std::filesystem::path& file) : Db3Bag(file, file.string()) {}
    ~Db3Bag() override;

private:
    struct Close {
        void operator()(sqlite3* database) const;
    };

    [[nodiscard]] ByteBuffer read_bytes(const Message& message, std::size_t at_most) const override;

    void open(const std::filesystem::path& file);
    void read_topics();
    void read_messages();
    [[noreturn]] void fail(const std::string& what) const;

    std::unique_ptr<sqlite3, Close> database_;
    mutable std::mutex mutex_;  ///< guards the database
};

}  // namespace posefusion
