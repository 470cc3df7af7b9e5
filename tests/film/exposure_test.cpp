#include "color/film/exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "color/catalogue.h"
#include "color/film/spectra.h"
#include "color/power_of_ten.h"
#include "tests/film/reference.h"

namespace latent::film {
namespace {

// Exposures of a white card under a light, of Y = 1.
std::array<double, 3> exposures_of_white(const color::Observer& film, const char* light) {
    const color::Spectrum spectrum = light_spectrum(light);
    const double y = color::xyz_from_spectrum(spectrum, color::Observer::cie1931()).y;
    const color::Xyz h = color::xyz_from_spectrum(spectrum, film);
    return {h.x / y, h.y / y, h.z / y};
}

TEST(FilmExposure, AGreyCardUnderTheBalanceLightGivesEachLayerTenOverTheExposureIndex) {
    for (const Material& material : materials()) {
        if (!material.in_camera()) continue;
        SCOPED_TRACE(material.name);
        for (const double index : {material.exposure_index, 50.0}) {
            const Result<color::Observer> film = film_observer(material, index);
            ASSERT_TRUE(film);
            for (const double h : exposures_of_white(*film, material.balance.c_str())) EXPECT_NEAR(0.18 * h * index / 10, 1, 1e-12);
        }
    }
}

// The reference adds up over 380..780 nm; here integrals are exact over 360..830 nm, and blue layers see some ultraviolet.
TEST(FilmExposure, AgreesWithTheReference) {
    for (const auto& [key, expected] : reference().items()) {
        SCOPED_TRACE(key);
        const Material material = *find_material(ReferencePair(key).film, true);
        const color::Observer film = *film_observer(material, expected["exposure_index"]);
        const auto h = exposures_of_white(film, expected["taking_light"].get<std::string>().c_str());
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(std::log10(0.18 * h[c]), expected["grey"]["log10_exposure"][c].get<double>(), 0.002) << c;
    }
}

TEST(FilmExposure, DaylightFilmSeesLampsOrangeAndTungstenFilmSeesDaylightBlue) {
    const auto daylight_film = exposures_of_white(*film_observer(*find_material("portra-400", true), 400), "A");
    EXPECT_GT(daylight_film[0] / daylight_film[2], 3);
    const auto tungsten_film = exposures_of_white(*film_observer(*find_material("vision3-500t", true), 500), "D55");
    EXPECT_LT(tungsten_film[0] / tungsten_film[2], 0.5);
}

std::array<double, 3> behind(const char* filter, const char* name, const char* light) {
    const Material material = *find_material(name, true);
    const color::Observer film = *film_observer(material, material.exposure_index);
    return exposures_of_white(*filter == 0 ? film : film.behind(*color::lens_filter(filter), filter, 1), light);
}

// Wratten 80A turns light of 3200 K into 5500 K; Wratten 85 and the ideal filter of 131 mired do the reverse.
TEST(FilmExposure, ConversionFiltersMakeLightNeutralForTheFilmWithinAThirdOfAStop) {
    const auto stops_from_neutral = [](const char* name, const char* light, const char* filter) {
        const auto h = behind(filter, name, light);
        return std::max({std::abs(std::log2(h[0] / h[1])), std::abs(std::log2(h[2] / h[1])), std::abs(std::log2(h[0] / h[2]))});
    };
    EXPECT_GT(stops_from_neutral("portra-400", "3200K", ""), 1);
    EXPECT_LT(stops_from_neutral("portra-400", "3200K", "wratten-80A"), 1.0 / 3);
    EXPECT_GT(stops_from_neutral("vision3-500t", "D55", ""), 1);
    EXPECT_LT(stops_from_neutral("vision3-500t", "D55", "mired:131"), 1.0 / 3);
    for (const char* film : {"vision3-500t", "vision3-200t", "vision-320t"}) {
        EXPECT_GT(stops_from_neutral(film, "D55", ""), 1) << film;
        EXPECT_LT(stops_from_neutral(film, "D55", "wratten-85"), 1.0 / 3) << film;
    }
}

// The data sheet of Vision3 500T: EI 500 under lamps, and 320 in daylight with Wratten 85, to a third of a stop.
TEST(FilmExposure, AWratten85TakesAsMuchLightAsTheDataSheetSays) {
    EXPECT_NEAR(behind("wratten-85", "vision3-500t", "D55")[1] / behind("", "vision3-500t", "3200K")[1], 320.0 / 500,
                0.1 * 320 / 500);
}

TEST(FilmExposure, LogarithmsInvertPowers) {
    for (const double x : {-30.0, -3.7, -1e-9, 0.0, 0.25, 1.0, 12.345})
        EXPECT_NEAR(color::log10_of(color::power_of_ten(x)), x, 1e-14);
}

}  // namespace
}  // namespace latent::film
