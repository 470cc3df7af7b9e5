#include "color/difference.h"

#include <gtest/gtest.h>

namespace latent::color {
namespace {

// Pairs that exercise every branch of the formula [Sharma05, table 1].
TEST(Difference, OfThePublishedPairsIsAsPublished) {
    struct Pair {
        Lab p, q;
        double difference;
    };
    for (const Pair& pair : {Pair{{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
                             {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
                             {{50, 2.8361, -74.0200}, {50, 0, -82.7485}, 3.4412},
                             {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
                             {{50, 0, 0}, {50, -1, 2}, 2.3669},
                             {{50, 2.49, -0.001}, {50, -2.49, 0.0009}, 7.1792},
                             {{50, 2.5, 0}, {50, 0, -2.5}, 4.3065},
                             {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
                             {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
                             {{50, 2.5, 0}, {56, -27, -3}, 31.9030},
                             {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
                             {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
                             {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.2630},
                             {{22.7233, 20.0904, -46.6940}, {23.0331, 14.9730, -42.5619}, 2.0373},
                             {{90.9257, -0.5406, -0.9208}, {88.6381, -0.8985, -0.7239}, 1.5381},
                             {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082}}) {
        EXPECT_NEAR(ciede2000(pair.p, pair.q), pair.difference, 5.1e-5) << pair.difference;
        EXPECT_NEAR(ciede2000(pair.q, pair.p), pair.difference, 5.1e-5) << pair.difference;
    }
}

TEST(Difference, LabOfWhiteIsOneHundredAndOfGreysHasNoColor) {
    const Xyz white{0.95047, 1, 1.08883};
    const Lab w = lab_from_xyz(white, white), dark = lab_from_xyz({0.0095047 / 5, 0.002, 0.0108883 / 5}, white);
    EXPECT_NEAR(w.l, 100, 1e-12);
    EXPECT_NEAR(w.a, 0, 1e-12);
    EXPECT_NEAR(dark.l, 0.002 * 24389 / 27, 1e-9);
    EXPECT_NEAR(dark.b, 0, 1e-12);
}

}  // namespace
}  // namespace latent::color
