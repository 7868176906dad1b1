// rosbag2's databases. SQLite does not open files without a name: this one has one.
#include "hosts/io/sources/bags/db3_bag.hpp"
#include "tests/fuzz/fuzz_bags.hpp"

namespace {

std::filesystem::path database_file() {
    static const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("posefusion-fuzz-" + std::to_string(getpid()) + ".db3");
    return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    std::ofstream(database_file(), std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<long>(size));
    fuzz::expect_no_more_than_an_error([] {
        const auto source = fuzz::open_bag<Db3Bag>(database_file(), {});
        for (std::size_t i = 0; i < source->size(); ++i)
            fuzz::expect_no_more_than_an_error([&] { (void)source->read(i); });
    });
    std::filesystem::remove(database_file());
    return 0;
}
