#include "color/catalogue.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "color/named_spectra.h"
#include "color/observer.h"

namespace latent::color {
namespace {

using ::testing::HasSubstr;

double daylight_y(const Observer& observer) {
    return xyz_from_spectrum(illuminant_d65(), observer).y / xyz_from_spectrum(illuminant_d65(), Observer::cie1931()).y;
}

TEST(Catalogue, EveryNameIsFoundSeesDaylightAsOneAndHasASource) {
    std::set<std::string> names;
    for (const CatalogueEntry& entry : observer_catalogue()) {
        const Result<Observer> observer = Observer::by_name(entry.name);
        ASSERT_TRUE(observer) << entry.name;
        EXPECT_EQ(observer->name(), entry.name);
        EXPECT_NEAR(daylight_y(*observer), 1, 1e-12) << entry.name;
        EXPECT_FALSE(entry.what.empty() || entry.source.empty()) << entry.name;
        EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    }
    for (const char* name : {"cie1931", "cie2015-10", "canon_eos_5d", "nikon_d5100", "sigma_sd1_merrill", "kodak_trix_400",
                             "kodak_5222_double_x", "ilford_ortho_plus_80"})
        EXPECT_TRUE(names.contains(name)) << name;
}

TEST(Catalogue, MisspeltNamesLeadToNearOnes) {
    const auto message = [](const char* name) { return Observer::by_name(name).error().message; };
    EXPECT_EQ(Observer::by_name("CIE 1964")->name(), "cie1964");
    EXPECT_THAT(message("cie1932"), HasSubstr("did you mean cie1931"));
    EXPECT_THAT(message("canon_eos_5d_mk2"), HasSubstr("canon_eos_5d_mkii"));
    EXPECT_THAT(message("tri-x"), HasSubstr("kodak_trix_400"));
    EXPECT_THAT(message("nikon"), HasSubstr("nikon_d850"));
    EXPECT_THAT(message("xyzzy"), HasSubstr("--list-observers"));
    EXPECT_THAT(lens_filter("wratten25a").error().message, HasSubstr("wratten-25"));
}

// Published luminous transmittances and chromaticities under illuminant C are not at hand in the tree; these are the colours that
// photographers know the filters by.
TEST(Catalogue, FiltersPassTheirColor) {
    const auto pass = [](const char* name, double nm) { return (*lens_filter(name))(nm); };
    EXPECT_GT(pass("wratten-25", 650), 0.8);
    EXPECT_LT(pass("wratten-25", 550), 0.01);
    EXPECT_GT(pass("Wratten 58", 530), 0.5);
    EXPECT_LT(pass("wratten-58", 650), 0.01);
    EXPECT_GT(pass("wratten-47", 440), 0.4);
    EXPECT_LT(pass("wratten-47", 550), 0.01);
    for (const int hundredths : {5, 10, 20, 30, 40, 50}) {  // named for their density to green
        const std::string magenta = fmt::format("wratten-cc{:02}m", hundredths);
        EXPECT_NEAR(std::log10(pass(magenta.c_str(), 700) / pass(magenta.c_str(), 550)), hundredths / 100.0, 0.01) << magenta;
    }
    for (const CatalogueEntry& entry : lens_filter_catalogue()) {
        const Spectrum filter = *lens_filter(entry.name);
        EXPECT_GE(filter.min_value(), 0) << entry.name;
        EXPECT_LE(filter.max_value(), 1) << entry.name;
        EXPECT_GT(filter.max_value(), 0.3) << entry.name;
    }
}

TEST(Catalogue, FilmsSeeTheColorsThatTheyAreNamedFor) {
    for (const char* name : {"kodak_trix_400", "kodak_5222_double_x"}) {
        const Observer film = *Observer::by_name(name);
        EXPECT_EQ(film.kind(), ObserverKind::kFilm);
        EXPECT_GT(film.at(620)[1], 0.1 * film.at(450)[1]) << name;  // panchromatic
        EXPECT_EQ(film.at(700)[1], 0) << name;
        EXPECT_EQ(film.at(500)[0], film.at(500)[2]) << name;
        EXPECT_NEAR(film.neutral().x, 1.0 / 3, 1e-15);
    }
    const Observer ortho = *Observer::by_name("ilford_ortho_plus_80");
    EXPECT_EQ(ortho.at(600)[1], 0);
    // Its table is that of a wedge spectrogram under a lamp of 2850 K, which is divided out. Its first and last rows hold 0.104 and
    // 0.2031.
    const double first = ortho.lambda_nm().front(), last = ortho.lambda_nm().back();
    const auto planck = [](double nm) { return std::pow(nm, -5) / std::expm1(1.438776877e7 / (nm * 2850)); };
    const double expected = std::pow(10, 0.104 - 0.2031) * planck(last) / planck(first);
    EXPECT_NEAR(ortho.responses().front()[1] / ortho.responses().back()[1] / expected, 1, 1e-12);
}

// H = integral of P S T, and 1 for daylight without a filter.
TEST(Catalogue, AFilterInFrontMultipliesTheResponse) {
    const Observer film = *Observer::by_name("kodak_trix_400");
    const Spectrum red = *lens_filter("wratten-25");
    const Observer behind = film.behind(red, "wratten-25", 1);
    EXPECT_EQ(behind.name(), "kodak_trix_400 + wratten-25");
    for (double nm = 370; nm < 660; nm += 0.5)
        EXPECT_NEAR(behind.at(nm)[1], film.at(nm)[1] * red(nm), 2e-3 * film.at(570)[1]) << nm;
    EXPECT_LT(daylight_y(behind), 0.35);
    EXPECT_EQ(behind.neutral(), film.neutral());
    const double factor = 1 / daylight_y(behind);
    EXPECT_NEAR(daylight_y(film.behind(red, "wratten-25", factor)), 1, 1e-12);
    // In front of an eye, daylight is red, but neutral stays neutral.
    const Observer eye = Observer::cie1931().behind(red, "wratten-25", 1);
    EXPECT_FALSE(eye.is_cie1931());
    EXPECT_EQ(eye.neutral(), Observer::cie1931().neutral());
    EXPECT_GT(chromaticity(xyz_from_spectrum(illuminant_d65(), eye)).x, 0.6);
}

}  // namespace
}  // namespace latent::color
