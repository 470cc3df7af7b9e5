#include "color/oklab.h"

#include <gtest/gtest.h>

namespace latent::color {
namespace {

// The table of examples of [Ottosson20].
TEST(Oklab, HasTheValuesOfItsAuthor) {
    struct Example {
        Xyz xyz;
        Oklab oklab;
    };
    for (const auto& [xyz, expected] : {Example{{0.950, 1, 1.089}, {1, 0, 0}}, Example{{1, 0, 0}, {0.450, 1.236, -0.019}},
                                        Example{{0, 1, 0}, {0.922, -0.671, 0.263}}, Example{{0, 0, 1}, {0.153, -1.415, -0.449}}}) {
        const Oklab got = oklab_from_xyz(xyz);
        EXPECT_NEAR(got.lightness, expected.lightness, 6e-4);
        EXPECT_NEAR(got.a, expected.a, 6e-4);
        EXPECT_NEAR(got.b, expected.b, 6e-4);
    }
}

}  // namespace
}  // namespace latent::color
