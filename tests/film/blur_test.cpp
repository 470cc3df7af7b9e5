// How far light spreads in a film.
#include "color/film/blur.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace latent::film {
namespace {

TEST(FilmBlur, KeepsHalfTheContrastWhereTheSheetSaysSo) {
    int sharp = 0;
    for (const Material& film : materials()) {
        if (!film.in_camera() || film.mtf != "yes") continue;
        SCOPED_TRACE(film.name);
        const Result<Triple> half = half_contrast(film);
        ASSERT_TRUE(half) << half.error().message;
        const Columns sheet = **find_table(film, "mtf");
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_DOUBLE_EQ(contrast_left((*half)[c], (*half)[c]), 0.5);
            EXPECT_EQ(contrast_left((*half)[c], 0), 1);
            EXPECT_GT((*half)[c], 15);
            EXPECT_LT((*half)[c], 150);
            const auto& left = sheet[c == 0 ? "r" : c == 1 ? "g" : "b"];
            if (left.back() > 0.5) {
                EXPECT_NEAR(contrast_left((*half)[c], sheet.values[0].back()), left.back(), 1e-12);
            } else {
                EXPECT_NEAR(interpolated((*half)[c], sheet.values[0], left), 0.5, 1e-9);
            }
        }
        ++sharp;
    }
    EXPECT_GE(sharp, 20);
}

TEST(FilmBlur, LightReturnsInARingWhereTheBaseReflectsAllOfIt) {
    // 2 t tan(asin(1 / 1.48)), t = 125 um.
    const double ring = 250 * std::tan(std::asin(1 / 1.48));
    EXPECT_GT(returned_light(ring + 0.5), 20 * returned_light(ring - 0.5));
    for (double r = ring + 1; r < 999; r += 10) EXPECT_GT(returned_light(r), returned_light(r + 10));
    EXPECT_EQ(returned_light(1001), 0);
}

TEST(FilmBlur, FilmsWithoutABlackBackReturnMore) {
    for (const Material& film : materials()) {
        if (!film.in_camera()) continue;
        const Triple backed = returned_share(film, false), bare = returned_share(film, true);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_GT(bare[c], backed[c]);
        EXPECT_GE(backed[0], backed[1]);  // red is the layer next to the base
    }
}

}  // namespace
}  // namespace latent::film
