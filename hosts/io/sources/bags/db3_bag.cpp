#include "hosts/io/sources/bags/db3_bag.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>

#include "engine/core/error.hpp"
#include "hosts/io/sources/bags/packing.hpp"
#include "hosts/io/sources/bags/ros2_names.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic("SQLite format 3\0", 16);

bool has_content(const fs::path& file) {
    std::error_code error;
    const auto size = fs::file_size(file, error);
    return !error && size > 0;
}

fs::path beside(fs::path file, const char* suffix) { return file += suffix; }

/// The size that its header says (https://www.sqlite.org/fileformat.html); 0 = it does not say.
std::uint64_t size_said(const InputFile& file) {
    constexpr std::size_t kHeaderBytes = 100;
    if (file.size() < kHeaderBytes) return kHeaderBytes;
    const ByteBuffer header = file.read(0, kHeaderBytes);
    const auto number = [&](std::size_t at, std::size_t bytes) {
        return std::accumulate(header.begin() + static_cast<std::ptrdiff_t>(at),
                               header.begin() + static_cast<std::ptrdiff_t>(at + bytes), std::uint64_t{0},
                               [](std::uint64_t value, std::uint8_t byte) { return value << 8 | byte; });
    };
    const std::uint64_t page_bytes = number(16, 2) == 1 ? 65536 : number(16, 2);
    const bool valid = number(24, 4) == number(92, 4);
    return valid ? number(28, 4) * page_bytes : 0;
}

/// The path as SQLite's URI has it (https://www.sqlite.org/uri.html).
std::string uri_of(const fs::path& file, const char* parameters) {
    std::string uri = "file:";
    for (const char c : fs::absolute(file).string()) {
        constexpr const char* kDigits = "0123456789ABCDEF";
        const auto byte = static_cast<unsigned char>(c);
        if (c == '?' || c == '#' || c == '%')
            uri += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
        else
            uri += c;
    }
    return uri + parameters;
}

/// A query, row by row.
class Query {
public:
    Query(sqlite3* database, const std::string& text) {
        result_ = sqlite3_prepare_v2(database, text.c_str(), -1, &statement_, nullptr);
    }
    ~Query() { sqlite3_finalize(statement_); }
    Query(const Query&) = delete;
    Query& operator=(const Query&) = delete;

    /// @return false when there is no further row, or none that can be read
    [[nodiscard]] bool next() {
        if (result_ == SQLITE_OK || result_ == SQLITE_ROW) result_ = sqlite3_step(statement_);
        return result_ == SQLITE_ROW;
    }
    [[nodiscard]] bool failed() const {
        return result_ != SQLITE_OK && result_ != SQLITE_ROW && result_ != SQLITE_DONE;
    }
    [[nodiscard]] std::int64_t number(int column) const { return sqlite3_column_int64(statement_, column); }
    [[nodiscard]] std::string text(int column) const {
        const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, column));
        const int count = sqlite3_column_bytes(statement_, column);
        return bytes == nullptr ? "" : printable(ByteView(bytes, static_cast<std::size_t>(count)));
    }

private:
    sqlite3_stmt* statement_ = nullptr;
    int result_;
};

}  // namespace

void Db3Bag::Close::operator()(sqlite3* database) const { sqlite3_close(database); }

Db3Bag::~Db3Bag() = default;

Db3Bag::Db3Bag(const fs::path& file, const std::string& name) : MessageBag(name) {
    open(file);
    read_topics();
    read_messages();
    finish();
}

/// In SQLite's words.
void Db3Bag::fail(const std::string& what) const {
    throw Error(name() + ": " + what + " (" + printable(std::string(sqlite3_errmsg(database_.get()))) + ")");
}

void Db3Bag::open(const fs::path& file) {
    const InputFile head(file, name());
    const ByteBuffer start = head.read(0, std::min<std::size_t>(kMagic.size(), head.size()));
    if (!std::equal(start.begin(), start.end(), kMagic.begin(), kMagic.end()))
        throw Error(name() + ": is not an SQLite database as rosbag2 writes it");
    if (has_content(beside(file, "-journal")))
        throw Error(name() + ": its recording was interrupted while it was written; `sqlite3 " + name() +
                    " 'PRAGMA user_version'` undoes what is incomplete");
    const bool unclosed = has_content(beside(file, "-wal"));
    if (!unclosed && size_said(head) > head.size())
        add_warning(name() + ": ends early; is the copy complete? What can be read of it is used");
    sqlite3* database = nullptr;
    const int result = sqlite3_open_v2(uri_of(file, unclosed ? "?mode=ro" : "?mode=ro&immutable=1").c_str(), &database,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(database);
    if (result != SQLITE_OK) fail("cannot be opened");
    // A recording may come from anywhere: https://www.sqlite.org/security.html
    sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_exec(database, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr);
    sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxChunkBytes));
    for (const char* table : {"topics", "messages"}) {
        Query query(database, std::string("SELECT type FROM sqlite_schema WHERE name = '") + table + "'");
        const bool found = query.next() && query.text(0) == "table";
        if (query.failed() && unclosed)
            fail("its recording was not closed and the rest of it, in " + beside(name(), "-wal").string() +
                 ", cannot be read; copy both to where you may write");
        if (query.failed()) fail("is damaged");
        if (!found) throw Error(name() + ": is not a bag of rosbag2: it has no table '" + table + "'");
    }
    if (unclosed)
        add_warning(name() + ": was not closed, as when its recording was interrupted; what is in " +
                    beside(name(), "-wal").string() + " is used, too");
}

void Db3Bag::read_topics() {
    std::string foreign;
    Query query(database_.get(), "SELECT id, name, type, serialization_format FROM topics");
    while (query.next()) {
        const std::string encoding = query.text(3);
        if (encoding == "cdr")
            add_connection(static_cast<std::uint32_t>(query.number(0)),
                           {query.text(1), short_type(query.text(2)), RosEncoding::Cdr});
        else
            foreign = encoding;
    }
    if (query.failed()) fail("is damaged: its topics cannot be read");
    if (connections().empty() && !foreign.empty())
        throw Error(name() + ": its messages are of encoding '" + foreign + "'; those of ROS 2 can be read (cdr)");
}

void Db3Bag::read_messages() {
    Query query(database_.get(), "SELECT id, topic_id, timestamp FROM messages");
    while (query.next())
        add_message({static_cast<std::uint32_t>(query.number(1)), 0, static_cast<std::uint64_t>(query.number(0)),
                     static_cast<std::uint64_t>(query.number(2))});
    if (!query.failed()) return;
    const std::string reason = sqlite3_errmsg(database_.get());
    if (messages().empty()) fail("is damaged: its messages cannot be read");
    add_warning(name() + ": is damaged (" + printable(reason) + "); the messages that can be read are used");
}

ByteBuffer Db3Bag::read_bytes(const Message& message, std::size_t at_most) const {
    const std::lock_guard lock(mutex_);
    sqlite3_blob* opened = nullptr;
    const int result = sqlite3_blob_open(database_.get(), "main", "messages", "data",
                                         static_cast<sqlite3_int64>(message.place), 0, &opened);
    const std::unique_ptr<sqlite3_blob, decltype(&sqlite3_blob_close)> blob(opened, &sqlite3_blob_close);
    if (result != SQLITE_OK) fail("is damaged: a message cannot be read");
    ByteBuffer bytes(std::min(at_most, static_cast<std::size_t>(sqlite3_blob_bytes(blob.get()))));
    if (sqlite3_blob_read(blob.get(), bytes.data(), static_cast<int>(bytes.size()), 0) != SQLITE_OK)
        fail("is damaged: a message cannot be read");
    return bytes;
}

}  // namespace posefusion
