#include "base/size.h"

#include <gtest/gtest.h>

namespace latent {
namespace {

TEST(Size, BinaryUnitsOfEitherCase) {
    EXPECT_EQ(parse_size("512M").value(), 536870912u);
    EXPECT_EQ(parse_size("4g").value(), std::uint64_t{4} << 30);
    EXPECT_EQ(parse_size("1000").value(), 1000u);
    EXPECT_EQ(parse_size("16777215T").value(), std::uint64_t{16777215} << 40);
}

TEST(Size, SignsFractionsWordsAndOverflowAreRefused) {
    for (const char* text : {"", "-5", "+5", "1.5G", "M", "5MB", "12 M", "16777216T", "99999999999999999999"}) {
        EXPECT_FALSE(parse_size(text)) << text;
    }
}

TEST(Duration, SecondsMinutesHours) {
    EXPECT_DOUBLE_EQ(parse_duration("90").value(), 90);
    EXPECT_DOUBLE_EQ(parse_duration("1.5h").value(), 5400);
    EXPECT_DOUBLE_EQ(parse_duration("10m").value(), 600);
    for (const char* text : {"", "-1s", "0", "0h", "nan", "inf", "10x", "m"}) EXPECT_FALSE(parse_duration(text)) << text;
}

}  // namespace
}  // namespace latent
