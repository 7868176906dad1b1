#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "hosts/config/option_table.hpp"

namespace posefusion {
namespace {

constexpr const char* kBegin = "<!-- options: begin -->\n";
constexpr const char* kEnd = "<!-- options: end -->\n";

/// README.md shows the table of options between two marks. POSEFUSION_UPDATE_README=1 writes the present one there.
TEST(Readme, ShowsTheOptionsAsTheyAre) {
    std::stringstream stream;
    stream << std::ifstream(README_FILE).rdbuf();
    std::string readme = stream.str();
    const std::size_t begin = readme.find(kBegin), end = readme.find(kEnd);
    ASSERT_NE(begin, std::string::npos);
    ASSERT_NE(end, std::string::npos);

    RunConfig config;
    const std::string table = option_table_markdown(option_table(config));
    const std::size_t first = begin + std::string(kBegin).size();
    const std::string shown = readme.substr(first, end - first);
    if (std::getenv("POSEFUSION_UPDATE_README") && shown != table) {
        std::ofstream(README_FILE) << readme.replace(first, end - first, table);
        return;
    }
    std::istringstream shown_lines(shown), table_lines(table);
    for (std::string is, should; std::getline(table_lines, should);) {
        std::getline(shown_lines, is);
        ASSERT_EQ(is, should) << "run this test once with POSEFUSION_UPDATE_README=1";
    }
    EXPECT_EQ(shown.size(), table.size()) << "README.md shows options that are no more";
}

}  // namespace
}  // namespace posefusion
