#include "base/near_names.h"

#include <gtest/gtest.h>

#include <vector>

namespace latent {
namespace {

const std::vector<std::string> kNames = {"lamp", "sky", "sun", "street lamp", "canon_eos_5d", "canon_eos_5ds"};

TEST(NearNames, AreFewLettersAwayNearestFirst) {
    EXPECT_EQ(near_names("lmap", kNames), "lamp");
    EXPECT_EQ(near_names("maps", kNames), "");  // two of four letters
    EXPECT_EQ(near_names("canon_5d", kNames), "canon_eos_5d, canon_eos_5ds");
    EXPECT_EQ(near_names("lamps", kNames), "lamp");
    EXPECT_EQ(near_names("skyy", kNames), "sky");
    EXPECT_EQ(near_names("Canon EOS 5D", kNames), "canon_eos_5d, canon_eos_5ds");
    EXPECT_EQ(near_names("moon", kNames), "");
    EXPECT_EQ(near_names("", kNames), "");
    EXPECT_EQ(near_names("lamp", {}), "");
    EXPECT_EQ(near_names(std::string(100000, 'x'), kNames), "");
}

TEST(NearNames, ContainTheNameOrAreContained) {
    EXPECT_EQ(near_names("street", kNames), "street lamp");
    EXPECT_EQ(near_names("the sun at noon", kNames), "sun");
}

TEST(NearNames, CaseAndSeparatorsMakeNoName) { EXPECT_EQ(folded_name("Canon EOS-5D_x"), "canoneos5dx"); }

}  // namespace
}  // namespace latent
