#include "hosts/io/stamp.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using namespace std::chrono_literals;
using test::message_of;

std::optional<std::int64_t> nanoseconds(std::string_view text, TimeUnit unit = TimeUnit::Seconds) {
    const auto stamp = parse_stamp(text, unit);
    return stamp ? std::optional(stamp->count()) : std::nullopt;
}

TEST(Stamp, IsReadToTheLastDigit) {
    EXPECT_EQ(nanoseconds("1305031102.175304"), 1305031102175304000);
    EXPECT_EQ(nanoseconds("1403636579763555584", TimeUnit::Nanoseconds), 1403636579763555584);
    EXPECT_EQ(nanoseconds("1403636579763555.584", TimeUnit::Microseconds), 1403636579763555584);
    EXPECT_EQ(nanoseconds("1403636579763.555584", TimeUnit::Milliseconds), 1403636579763555584);
    EXPECT_EQ(nanoseconds("1.403636579763555584e+18", TimeUnit::Nanoseconds), 1403636579763555584) << "numpy.savetxt";
    EXPECT_EQ(nanoseconds("1403636579763555584.000000", TimeUnit::Nanoseconds), 1403636579763555584);
    EXPECT_EQ(nanoseconds("-0.5"), -500000000);
    EXPECT_EQ(nanoseconds("+2"), 2000000000);
    EXPECT_EQ(nanoseconds(".25"), 250000000);
    EXPECT_EQ(nanoseconds("0.00000025"), 250);
    EXPECT_EQ(nanoseconds("000"), 0);
    EXPECT_EQ(nanoseconds("0.0333333333333333"), 33333333) << "what is below a nanosecond is rounded";
    EXPECT_EQ(nanoseconds("0.0000000006"), 1);
    EXPECT_EQ(nanoseconds("0.00000000004"), 0);
    EXPECT_EQ(nanoseconds("1e-300"), 0);
}

TEST(Stamp, NothingElseIsOne) {
    for (const char* text : {"", "-", ".", "nan", "inf", "1.2.3", "12a", "1e", "1e+", "1,5", "0x10", " 1", "1 ", "1e99",
                             "1e999999999999", "4611686019", "-1e10"})
        EXPECT_FALSE(parse_stamp(text)) << text;
    EXPECT_FALSE(parse_stamp(std::string(100000, '1')));
    EXPECT_EQ(parse_stamp("4611686018.427387904"), kFarthestStamp);
}

TEST(Stamp, IsTheDoubleThatItsTextIs) {
    for (const char* text : {"1305031102.175304", "1341846315.733985", "0.033333", "1403636579.763555584", "-7.000001"})
        EXPECT_EQ(to_seconds(*parse_stamp(text)), std::strtod(text, nullptr)) << text;
}

TEST(Stamp, OfADoubleHasTheDigitsThatAreMeant) {
    EXPECT_EQ(stamp_of(1305031102.175304), 1305031102175304us) << "and not the 64 ns that the double is off";
    EXPECT_EQ(stamp_of(0.1), 100ms);
    EXPECT_EQ(stamp_of(-2), -2s);
    EXPECT_EQ(stamp_of(1e9), 1000000000s);
    for (const double none : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e30})
        EXPECT_NE(message_of<Error>([&] { (void)stamp_of(none); }).find("is no time; give seconds"), std::string::npos);
}

TEST(Stamp, IsWrittenWithSixDecimalsOrNine) {
    EXPECT_EQ(seconds_text(1305031102175304us), "1305031102.175304");
    EXPECT_EQ(seconds_text(Stamp{1403636579763555584}), "1403636579.763555584");
    EXPECT_EQ(seconds_text(0s), "0.000000");
    EXPECT_EQ(seconds_text(5ms), "0.005000");
    EXPECT_EQ(seconds_text(5ns), "0.000000005");
    EXPECT_EQ(seconds_text(-5ms), "-0.005000");
    EXPECT_EQ(seconds_text(-1500ms), "-1.500000");
    EXPECT_EQ(seconds_text(Stamp::min()), "-9223372036.854775808");
}

TEST(TimeUnit, OfStampsSince1970IsToldByTheirSize) {
    const auto unit = [](std::string_view stamp) { return recognise_time_unit({stamp}, std::nullopt, ""); };
    EXPECT_EQ(unit("1305031102.175304"), TimeUnit::Seconds);
    EXPECT_EQ(unit("1305031102"), TimeUnit::Seconds);
    EXPECT_EQ(unit("1305031102175"), TimeUnit::Milliseconds);
    EXPECT_EQ(unit("1305031102175.304"), TimeUnit::Milliseconds);
    EXPECT_EQ(unit("1305031102175304"), TimeUnit::Microseconds);
    EXPECT_EQ(unit("1305031102175304000"), TimeUnit::Nanoseconds);
    EXPECT_EQ(unit("1.305031102175304e+18"), TimeUnit::Nanoseconds);
    EXPECT_EQ(recognise_time_unit({"1305031102175304"}, TimeUnit::Seconds, ""), TimeUnit::Microseconds)
        << "in the year 41 million nothing is recorded, whatever the user says";
}

TEST(TimeUnit, OfWholeNumbersIsToldByTheirIntervals) {
    const auto unit = [](const std::vector<std::string_view>& stamps) {
        return recognise_time_unit(stamps, std::nullopt, "");
    };
    EXPECT_EQ(unit({"0", "33", "67", "100"}), TimeUnit::Milliseconds);
    EXPECT_EQ(unit({"0", "33333", "66667", "100000"}), TimeUnit::Microseconds);
    EXPECT_EQ(unit({"0", "33333333", "66666667"}), TimeUnit::Nanoseconds);
    EXPECT_EQ(unit({"100", "0", "33", "0", "67"}), TimeUnit::Milliseconds) << "in any order, with repetitions";
    EXPECT_EQ(unit({"0", "5", "10"}), TimeUnit::Milliseconds) << "motion capture at 200 Hz";
    EXPECT_EQ(unit({"1", "2", "3"}), TimeUnit::Seconds) << "ICL-NUIM";
    EXPECT_EQ(unit({"1", "2", "3", "9000000"}), TimeUnit::Seconds) << "a jump says nothing";
    EXPECT_EQ(unit({"0", "33.5", "67"}), TimeUnit::Seconds) << "a fraction is one of seconds";
    EXPECT_EQ(unit({"hello", "nan", "7"}), TimeUnit::Seconds);
    EXPECT_EQ(unit({}), TimeUnit::Seconds);
    EXPECT_EQ(recognise_time_unit({"0", "33", "67"}, TimeUnit::Nanoseconds, ""), TimeUnit::Nanoseconds);
}

/// A clock that runs since the device was switched on has as many digits after hours or weeks as one of 1970.
TEST(TimeUnit, OfALongUptimeIsToldByTheIntervals) {
    const auto unit = [](const std::vector<std::string_view>& stamps) {
        return recognise_time_unit(stamps, std::nullopt, "");
    };
    EXPECT_EQ(unit({"1000000000584", "1000033333584", "1000066667584"}), TimeUnit::Nanoseconds) << "17 minutes";
    EXPECT_EQ(unit({"1000000584", "1000033584", "1000067584"}), TimeUnit::Microseconds) << "17 minutes";
    EXPECT_EQ(unit({"1305031102175", "1305031102208", "1305031102242"}), TimeUnit::Milliseconds) << "since 1970";
    EXPECT_EQ(unit({"1305031102175.5", "1305031112175.5"}), TimeUnit::Milliseconds) << "since 1970, far apart";
    EXPECT_EQ(unit({"1305031102175304000", "1305031112175304000"}), TimeUnit::Nanoseconds) << "there is none below";
    const std::vector<std::string_view> weeks{"1305031102175", "1305031135508", "1305031168842"};
    EXPECT_NE(message_of<Error>([&] {
                  (void)unit(weeks);
              }).find("may be milliseconds since 1970, far apart, or microseconds; say which with --time-unit"),
              std::string::npos);
    EXPECT_EQ(recognise_time_unit(weeks, TimeUnit::Microseconds, ""), TimeUnit::Microseconds);
}

TEST(TimeUnit, IsAskedForWhereTwoArePossible) {
    const std::vector<std::string_view> stamps{"1305031102", "1305031132", "1305031162"};
    EXPECT_NE(message_of<Error>([&] { (void)recognise_time_unit(stamps, std::nullopt, "truth.txt"); })
                  .find("truth.txt: the time stamps may be seconds since 1970, far apart, or milliseconds; say which "
                        "with --time-unit"),
              std::string::npos);
    EXPECT_EQ(recognise_time_unit(stamps, TimeUnit::Seconds, ""), TimeUnit::Seconds);
    EXPECT_EQ(recognise_time_unit(stamps, TimeUnit::Milliseconds, ""), TimeUnit::Milliseconds);
}

TEST(TimeUnit, HasASymbol) {
    for (const char* symbol : {"s", "ms", "us", "ns"}) EXPECT_STREQ(symbol_of(*time_unit(symbol)), symbol);
    EXPECT_FALSE(time_unit("minutes"));
}

}  // namespace
}  // namespace posefusion
