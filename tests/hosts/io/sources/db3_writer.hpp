#pragma once
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// Writes .db3 files of rosbag2 (schema version 3), good ones and such as no program should write.
namespace posefusion::test {

class Db3Writer {
public:
    explicit Db3Writer(const std::filesystem::path& file) {
        EXPECT_EQ(sqlite3_open(file.c_str(), &database_), SQLITE_OK);
        run("PRAGMA synchronous=OFF; BEGIN;"
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
            " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,"
            " data BLOB NOT NULL);"
            "CREATE INDEX timestamp_idx ON messages (timestamp ASC); COMMIT;");
    }
    ~Db3Writer() { sqlite3_close(database_); }
    Db3Writer(const Db3Writer&) = delete;
    Db3Writer& operator=(const Db3Writer&) = delete;

    void run(const std::string& statements) {
        EXPECT_EQ(sqlite3_exec(database_, statements.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
            << sqlite3_errmsg(database_);
    }

    /// @param recorded  nanoseconds
    void add(const std::string& topic, const std::string& type, std::uint64_t recorded, const std::string& message) {
        std::size_t number = 0;
        while (number < topics_.size() && topics_[number] != topic) ++number;
        if (number == topics_.size()) {
            topics_.push_back(topic);
            run("INSERT INTO topics VALUES(" + std::to_string(number + 1) + ", '" + topic + "', '" + type +
                "', 'cdr', '')");
        }
        sqlite3_stmt* insert = nullptr;
        const std::string text = "INSERT INTO messages(topic_id, timestamp, data) VALUES(" +
                                 std::to_string(number + 1) + ", " + std::to_string(recorded) + ", ?)";
        EXPECT_EQ(sqlite3_prepare_v2(database_, text.c_str(), -1, &insert, nullptr), SQLITE_OK);
        sqlite3_bind_blob(insert, 1, message.data(), static_cast<int>(message.size()), SQLITE_STATIC);
        EXPECT_EQ(sqlite3_step(insert), SQLITE_DONE);
        sqlite3_finalize(insert);
    }

private:
    sqlite3* database_ = nullptr;
    std::vector<std::string> topics_;
};

}  // namespace posefusion::test
