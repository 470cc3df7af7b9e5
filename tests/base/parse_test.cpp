#include "base/parse.h"

#include <gtest/gtest.h>

#include <limits>

namespace latent {
namespace {

constexpr std::uint64_t kMax = std::numeric_limits<std::uint64_t>::max();

TEST(Count, UnitsArePowersOf1000AndWithAnIOf1024) {
    EXPECT_EQ(parse_count("0").value(), 0u);
    EXPECT_EQ(parse_count("1048576").value(), 1048576u);
    EXPECT_EQ(parse_count("1M").value(), 1000000u);
    EXPECT_EQ(parse_count("1Mi").value(), 1048576u);
    EXPECT_EQ(parse_count("64k").value(), 64000u);
    EXPECT_EQ(parse_count("64ki").value(), 65536u);
    EXPECT_EQ(parse_count("3G").value(), 3000000000u);
    EXPECT_EQ(parse_count("2T").value(), 2000000000000u);
    EXPECT_EQ(parse_count("2Ti").value(), std::uint64_t{2} << 40);
    EXPECT_EQ(parse_count("18446744073709551615").value(), kMax);
    EXPECT_EQ(parse_count("18446744T").value(), 18446744'000'000'000'000u);
}

TEST(Count, AFractionOfAUnitIsExactWhereItIsWhole) {
    EXPECT_EQ(parse_count("1.07G").value(), 1070000000u);
    EXPECT_EQ(parse_count("0.5K").value(), 500u);
    EXPECT_EQ(parse_count("1.0000000001T").value(), 1000000000100u);
    EXPECT_EQ(parse_count("1.5Ki").value(), 1536u);
    EXPECT_EQ(parse_count("1.0006K").value(), 1001u);
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const std::string digits = std::to_string(1000 + i).substr(1);
        EXPECT_EQ(parse_count("7." + digits + "K").value(), 7000 + i);
        EXPECT_EQ(parse_count("7." + digits + "T").value(), (7000 + i) * 1'000'000'000);
    }
}

TEST(Count, APowerOfTenIsExact) {
    EXPECT_EQ(parse_count("1e6").value(), 1000000u);
    EXPECT_EQ(parse_count("2.5E9").value(), 2500000000u);
    EXPECT_EQ(parse_count("9e15").value(), 9'000'000'000'000'000u);
}

TEST(Count, WhatIsNoWholeNumberBelow2To64IsRefused) {
    for (const char* text : {"",          "-5",         "+5",
                             "M",         "Ki",         "i",
                             "5Mb",       "5B",         "12 M",
                             " 12",       "12 ",        "1.5",
                             "1.",        "1.K",        ".5K",
                             "1.5.5K",    "1.5e0",      "1e-1",
                             "-1e3",      "1e6K",       "1e16",
                             "e6",        "1e",         "inf",
                             "nan",       "1.5e3K",     "0x10",
                             "1_000",     "1,000",      "18446744073709551616",
                             "18446745T", "16777216Ti", "16777215.9999999999999Ti"}) {
        EXPECT_FALSE(parse_count(text)) << text;
    }
}

TEST(Size, IsBinaryEitherWay) {
    EXPECT_EQ(parse_size("512M").value(), 536870912u);
    EXPECT_EQ(parse_size("512Mi").value(), 536870912u);
    EXPECT_EQ(parse_size("4g").value(), std::uint64_t{4} << 30);
    EXPECT_EQ(parse_size("1.5G").value(), std::uint64_t{3} << 29);
    EXPECT_EQ(parse_size("1000").value(), 1000u);
    EXPECT_EQ(parse_size("16777215T").value(), std::uint64_t{16777215} << 40);
    for (const char* text : {"", "-5", "M", "5MB", "16777216T"}) EXPECT_FALSE(parse_size(text)) << text;
}

TEST(Number, IsFiniteAndMayHaveAUnit) {
    EXPECT_EQ(parse_number("-0.5").value(), -0.5);
    EXPECT_EQ(parse_number("1e3").value(), 1000);
    EXPECT_EQ(parse_number("1.5K").value(), 1500);
    EXPECT_EQ(parse_number("2Ki").value(), 2048);
    for (const char* text : {"", "K", "nan", "inf", "-inf", "1e400", "1e308T", "1 ", "1x", "1.5.5", "--1"})
        EXPECT_FALSE(parse_number(text)) << text;
}

TEST(Duration, AddsUpDaysHoursMinutesAndSeconds) {
    EXPECT_DOUBLE_EQ(parse_duration("90").value(), 90);
    EXPECT_DOUBLE_EQ(parse_duration("90s").value(), 90);
    EXPECT_DOUBLE_EQ(parse_duration("1.5h").value(), 5400);
    EXPECT_DOUBLE_EQ(parse_duration("10m").value(), 600);
    EXPECT_DOUBLE_EQ(parse_duration("1h30m").value(), 5400);
    EXPECT_DOUBLE_EQ(parse_duration("2d1h0.5s").value(), 2 * 86400 + 3600 + 0.5);
    for (const char* text :
         {"", "-1s", "0", "0h", "nan", "inf", "infs", "10x", "m", "1h30", "30m1h", "1m1m", "1h-5m", "1h 5m", "1e400s"})
        EXPECT_FALSE(parse_duration(text)) << text;
}

TEST(Pair, IsTwoCounts) {
    EXPECT_EQ(parse_pair("0:1M", ':'), std::pair(std::uint64_t{0}, std::uint64_t{1000000}));
    EXPECT_EQ(parse_pair("4Kix2Ki", 'x'), std::pair(std::uint64_t{4096}, std::uint64_t{2048}));
    for (const char* text : {"", ":", "1:", ":1", "1", "1:2:3", "-1:2", "1/2"}) EXPECT_FALSE(parse_pair(text, ':')) << text;
}

TEST(Numbers, HaveSingleCommasBetweenThem) {
    EXPECT_EQ(parse_numbers("1,-2.5,1e-3"), (std::vector<double>{1, -2.5, 1e-3}));
    EXPECT_EQ(parse_numbers("1"), std::vector<double>{1});
    for (const char* text : {"", ",", "1,", ",1", "1,,2", "1, 2", "1;2", "1,nan"}) EXPECT_FALSE(parse_numbers(text)) << text;
}

TEST(Crop, IsARectangleThatIsNotEmpty) {
    EXPECT_EQ(parse_crop("1,2,30,40").value(), (std::array{1, 2, 30, 40}));
    EXPECT_EQ(parse_crop("-10,-2,0,4").value(), (std::array{-10, -2, 0, 4}));
    EXPECT_EQ(parse_crop("0,1Ki,1K,1.5K").value(), (std::array{0, 1024, 1000, 1500}));
    for (const char* text :
         {"", "1,2,3", "1,2,3,4,", "1,2,3,4,5", "5,0,5,1", "0,5,1,4", "0,0,1,2147483648", "0,0,1.5,2", "a,0,1,1"})
        EXPECT_FALSE(parse_crop(text)) << text;
}

}  // namespace
}  // namespace latent
