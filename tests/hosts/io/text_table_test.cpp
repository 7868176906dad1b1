#include "hosts/io/text_table.hpp"

#include <gtest/gtest.h>

#include "hosts/io/text_file.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::TempFolder;

std::string utf16(const std::u16string& text, bool big_endian) {
    std::string bytes = big_endian ? "\xFE\xFF" : "\xFF\xFE";
    for (const char16_t c : text) {
        const char low = static_cast<char>(c & 0xFF), high = static_cast<char>(c >> 8);
        bytes += big_endian ? std::string{high, low} : std::string{low, high};
    }
    return bytes;
}

TEST(TextTable, EveryEncodingOfWindowsIsRead) {
    const TempFolder folder;
    const std::u16string list = u"# Liste\r\n1.5 rgb/\u00E4\u4E2D\U0001F600.png\r\n2.5 rgb/b.png\r\n";
    for (const std::string& bytes :
         {utf16(list, false), utf16(list, true),
          std::string("\xEF\xBB\xBF# Liste\r\n1.5 rgb/\u00E4\u4E2D\U0001F600.png\r\n2.5 rgb/b.png\r\n")}) {
        const auto lines = read_text_table(folder.write("list.txt", bytes));
        ASSERT_EQ(lines.size(), 2u);
        EXPECT_EQ(lines[0].number, 2u);
        EXPECT_EQ(lines[0].fields, (std::vector<std::string>{"1.5", "rgb/\u00E4\u4E2D\U0001F600.png"}));
        EXPECT_EQ(lines[1].fields.back(), "rgb/b.png");
    }
}

TEST(TextFile, BrokenUtf16BecomesReplacementCharacters) {
    EXPECT_EQ(to_utf8(utf16(std::u16string(1, char16_t{0xD800}) + u"a", false)), "\uFFFDa");
    EXPECT_EQ(to_utf8(utf16(u"a", false) + "x"), "a") << "half a character at the end";
    EXPECT_EQ(to_utf8(""), "");
    EXPECT_EQ(to_utf8("\xFF"), "\xFF");
}

}  // namespace
}  // namespace posefusion
