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

/// docs/options.md shows the tables of options between two marks. POSEFUSION_UPDATE_DOCS=1 writes the present ones
/// there.
TEST(OptionsPage, ShowsTheOptionsAsTheyAre) {
    std::stringstream stream;
    stream << std::ifstream(OPTIONS_PAGE).rdbuf();
    std::string page = stream.str();
    const std::size_t begin = page.find(kBegin), end = page.find(kEnd);
    ASSERT_NE(begin, std::string::npos);
    ASSERT_NE(end, std::string::npos);

    RunConfig config;
    const std::string tables = option_table_markdown(option_table(config));
    const std::size_t first = begin + std::string(kBegin).size();
    const std::string shown = page.substr(first, end - first);
    if (std::getenv("POSEFUSION_UPDATE_DOCS") && shown != tables) {
        std::ofstream(OPTIONS_PAGE) << page.replace(first, end - first, tables);
        return;
    }
    std::istringstream shown_lines(shown), table_lines(tables);
    for (std::string is, should; std::getline(table_lines, should);) {
        std::getline(shown_lines, is);
        ASSERT_EQ(is, should) << "run this test once with POSEFUSION_UPDATE_DOCS=1";
    }
    EXPECT_EQ(shown.size(), tables.size()) << "docs/options.md shows options that no longer exist";
}

}  // namespace
}  // namespace posefusion
