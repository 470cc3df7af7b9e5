#include "color/named_spectra.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/parse.h"
#include "color/light_name.h"
#include "color/observer.h"

namespace latent::color {
namespace {

Spectrum named(const std::string& name) { return *named_spectrum(name); }

// Normal-incidence reflectance of a conductor.
double reflectance(const std::string& metal, double lambda_nm) {
    const double n = named("metal-" + metal + "-eta")(lambda_nm), k = named("metal-" + metal + "-k")(lambda_nm);
    return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
}

TEST(NamedSpectra, EveryNameGivesASpectrumOverTheWholeRange) {
    EXPECT_EQ(named_spectrum_names().size(), 10U + 14U + 16U);
    for (const std::string& name : named_spectrum_names()) {
        SCOPED_TRACE(name);
        const Result<Spectrum> s = named_spectrum(name);
        ASSERT_TRUE(s);
        EXPECT_GE(s->min_value(), 0);
        EXPECT_EQ((*s)(kLambdaMin - 300), s->values().front());
        EXPECT_EQ((*s)(kLambdaMax + 300), s->values().back());
        EXPECT_GE(s->lambda_nm().back(), 760);
    }
}

TEST(NamedSpectra, UnknownNamesAreAnsweredWithTheNearOnes) {
    EXPECT_THAT(named_spectrum("glass-F2").error().message, ::testing::HasSubstr("glass-BK7, glass-BAF10"));
    EXPECT_THAT(named_spectrum("metal-Ag").error().message, ::testing::HasSubstr("metal-Ag-eta"));
    EXPECT_THAT(named_spectrum("D65").error().message, ::testing::HasSubstr("stdillum-*"));
    EXPECT_EQ(named_spectrum("").error().code, ErrorCode::kNotFound);
}

// n_d at 587.6 nm and Abbe number (n_d - 1) / (n_F - n_C) of the catalogue [SCHOTT].
TEST(NamedSpectra, GlassesHaveTheirCatalogueIndexAndDispersion) {
    struct Glass {
        const char* name;
        double n_d, abbe;
    };
    for (const Glass& g : {Glass{"BK7", 1.51680, 64.17},
                           {"BAF10", 1.67003, 47.11},
                           {"FK51A", 1.48656, 84.47},
                           {"LASF9", 1.85025, 32.17},
                           {"SF5", 1.67271, 32.25},
                           {"SF10", 1.72828, 28.53},
                           {"SF11", 1.78472, 25.68},
                           {"F11", 1.78472, 25.68}}) {
        SCOPED_TRACE(g.name);
        const Spectrum n = named(std::string("glass-") + g.name);
        EXPECT_NEAR(n(587.5618), g.n_d, 5.1e-6);
        EXPECT_NEAR((n(587.5618) - 1) / (n(486.1327) - n(656.2725)), g.abbe, 0.0051);
    }
}

TEST(NamedSpectra, MetalsReflectAsMeasured) {
    EXPECT_NEAR(reflectance("Ag", 630), 0.968, 5e-4);
    EXPECT_NEAR(reflectance("Al", 630), 0.914, 5e-4);
    EXPECT_NEAR(reflectance("Au", 630), 0.932, 5e-4);
    EXPECT_NEAR(reflectance("Au", 450), 0.386, 5e-4);
    EXPECT_NEAR(reflectance("Cu", 630), 0.924, 5e-4);
    EXPECT_NEAR(reflectance("CuZn", 630), 0.877, 5e-4);
    EXPECT_NEAR(named("metal-CuZn-eta")(630), 0.445, 5e-4);
    EXPECT_NEAR(named("metal-MgO-eta")(589.3), 1.7374, 2e-4);  // [Stephens52]
    EXPECT_NEAR(named("metal-TiO2-eta")(590), 2.9, 0.02);      // the extraordinary ray
}

// Chromaticities of CIE 15 (four or five decimals) for the CIE 1931 observer; its sums run over 380..780 nm at 5 nm.
TEST(NamedSpectra, LampsHaveTheirPublishedChromaticities) {
    struct Lamp {
        const char* name;
        Chromaticity xy;
    };
    for (const Lamp& lamp : {Lamp{"stdillum-A", {0.44758, 0.40745}},
                             {"stdillum-D50", {0.34567, 0.35851}},
                             {"stdillum-D65", {0.31272, 0.32903}},
                             {"stdillum-F1", {0.3131, 0.3371}},
                             {"stdillum-F2", {0.3721, 0.3751}},
                             {"stdillum-F3", {0.4091, 0.3941}},
                             {"stdillum-F4", {0.4402, 0.4031}},
                             {"stdillum-F5", {0.3138, 0.3452}},
                             {"stdillum-F6", {0.3779, 0.3882}},
                             {"stdillum-F7", {0.3129, 0.3292}},
                             {"stdillum-F8", {0.3458, 0.3586}},
                             {"stdillum-F9", {0.3741, 0.3727}},
                             {"stdillum-F10", {0.3458, 0.3588}},
                             {"stdillum-F11", {0.3805, 0.3769}},
                             {"stdillum-F12", {0.4370, 0.4042}}}) {
        SCOPED_TRACE(lamp.name);
        const Spectrum s = named(lamp.name);
        Xyz sum;
        for (double lambda = 380; lambda <= 780; lambda += 5) {
            const auto f = Observer::cie1931().at(lambda);
            sum = {sum.x + f[0] * s(lambda), sum.y + f[1] * s(lambda), sum.z + f[2] * s(lambda)};
        }
        EXPECT_NEAR(chromaticity(sum).x, lamp.xy.x, 5.5e-5);
        EXPECT_NEAR(chromaticity(sum).y, lamp.xy.y, 5.5e-5);
    }
}

TEST(NamedLights, AreTheStandardIlluminantsAndHaveTheTemperaturesThatTheyAreSaidToHave) {
    EXPECT_EQ(named_lights().size(), 16U);  // with E
    for (const NamedLight& light : named_lights()) {
        SCOPED_TRACE(light.name);
        const Result<Spectrum> s = light_by_name(light.name);
        ASSERT_TRUE(s);
        const std::size_t comma = light.what.find(", ");
        if (comma == std::string_view::npos) continue;
        const std::string_view kelvin = light.what.substr(comma + 2, light.what.size() - comma - 4);
        const auto [x, y] = chromaticity(xyz_from_spectrum(*s, Observer::cie1931()));
        const double n = (x - 0.3320) / (0.1858 - y);  // McCamy's formula, within .5 % of the nearest blackbody
        EXPECT_NEAR(449 * n * n * n + 3525 * n * n + 6823.3 * n + 5520.33, *parse_number(kelvin), 0.01 * *parse_number(kelvin));
    }
}

TEST(NamedSpectra, DaylightsAreTheTablesOfTheCie) {
    const Spectrum d65 = named("stdillum-D65"), d50 = named("stdillum-D50");
    // Rows of CIE 15 (four and three decimals).
    for (const auto& [lambda, power] :
         {std::pair{300, 0.0341}, {560, 100.0}, {770, 66.8054}, {775, 65.0941}, {780, 63.3828}, {830, 60.3125}}) {
        EXPECT_NEAR(d65(lambda), power, 5.1e-5) << lambda;
    }
    for (const auto& [lambda, power] :
         {std::pair{300, 0.019}, {305, 1.035}, {310, 2.051}, {770, 82.923}, {775, 80.599}, {780, 78.274}}) {
        EXPECT_NEAR(d50(lambda), power, 5.5e-4) << lambda;
    }
    EXPECT_NEAR(named("stdillum-A")(775), 239.370, 5.1e-4);
    const Chromaticity aces = *daylight_chromaticity(6000);
    EXPECT_NEAR(aces.x, 0.32169, 5e-6);
    EXPECT_NEAR(aces.y, 0.33780, 5e-6);
    EXPECT_NEAR(named("illum-acesD60")(400), 72.1085, 5.1e-5);
}

TEST(NamedSpectra, DaylightOf6504KelvinIsD65) {
    const Chromaticity xy = *daylight_chromaticity(6504);
    EXPECT_NEAR(xy.x, 0.3127, 5e-5);
    EXPECT_NEAR(xy.y, 0.3291, 5e-5);
    EXPECT_TRUE(daylight_chromaticity(4000) && daylight_chromaticity(25000));
    for (const double kelvin : {3999.9, 25000.1, std::nan("")}) {
        EXPECT_EQ(daylight_chromaticity(kelvin).error().code, ErrorCode::kOutOfRange);
        EXPECT_FALSE(daylight(kelvin));
    }
    // The two branches of x meet at 7000 K to the rounding of their coefficients.
    EXPECT_NEAR(daylight_chromaticity(7000)->x, daylight_chromaticity(7000.001)->x, 5e-5);
}

}  // namespace
}  // namespace latent::color
