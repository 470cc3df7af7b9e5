#include "base/size.h"

#include <gtest/gtest.h>

namespace latent {
namespace {

TEST(Size, IsWrittenInBinaryUnits) {
    EXPECT_EQ(format_size(1023), "1023 B");
    EXPECT_EQ(format_size(1536), "1.5 KiB");
    EXPECT_EQ(format_size(std::uint64_t{512} << 20), "512.0 MiB");
}

TEST(Size, DurationsAreWrittenToTheirLeadingUnits) {
    EXPECT_EQ(format_duration(4.2), "4.2s");
    EXPECT_EQ(format_duration(75), "1m15s");
    EXPECT_EQ(format_duration(93784), "26h03m");
}

TEST(Size, LargeCountsHaveThreeDigits) {
    EXPECT_EQ(format_count(0), "0");
    EXPECT_EQ(format_count(4), "4");
    EXPECT_EQ(format_count(0.25), "0.25");
    EXPECT_EQ(format_count(12.345), "12.3");
    EXPECT_EQ(format_count(999.4), "999");
    EXPECT_EQ(format_count(999.6), "1.00 K");
    EXPECT_EQ(format_count(1351), "1.35 K");
    EXPECT_EQ(format_count(26012), "26.0 K");
    EXPECT_EQ(format_count(523412), "523 K");
    EXPECT_EQ(format_count(1.5e6), "1.50 M");
    EXPECT_EQ(format_count(9e15), "9000 T");
}

TEST(Size, CountsAreOneThingOrSeveral) {
    EXPECT_EQ(counted(0, "record"), "0 records");
    EXPECT_EQ(counted(1, "record"), "1 record");
    EXPECT_EQ(counted(2, "record"), "2 records");
}

}  // namespace
}  // namespace latent
