// Films in the camera: exposures that develop writes against integration of the layers over rendered spectra.
#include <fmt/format.h>

#include <cmath>

#include "color/camera.h"
#include "color/catalogue.h"
#include "color/film/exposure.h"
#include "color/named_spectra.h"
#include "tests/darkroom/darkroom.h"

namespace latent::testing {
namespace {

class Films : public Darkroom {
 protected:
    static std::vector<color::Spectrum> patches() { return color::color_checker(); }
    // 6 x 4 patches of 8 x 8 pixels each.
    static Mean patch(const Picture& picture, int c, int i) {
        const int x = i % 6 * 8, y = i / 6 * 8;
        return mean_of(picture, std::string(1, "RGB"[c]), x, y, x + 8, y + 8);
    }
    static std::vector<std::string> on(const std::string& film, std::vector<std::string> more = {}) {
        more.insert(more.end(), {"--film", film, "--size", "48x32", "--filter", "box"});
        return more;
    }
    std::string chart(const std::string& light) const {
        return render("chart_" + light, wall(patches(), distant_light(fmt::format("\"spectrum L\" \"{}\"", light), 1)),
                      {"--samples", "0:262144", "--run-samples", "65536"});
    }
};

TEST_F(Films, LayersAreExposedAsIntegrationSays) {
    for (const char* name : {"stdillum-D65", "stdillum-F2"}) {
        const color::Spectrum light = *color::named_spectrum(name);
        const std::string file = chart(name);
        for (const char* film : {"portra-400", "velvia-50", "vision3-500t"}) {
            SCOPED_TRACE(fmt::format("{} {}", name, film));
            const film::Material material = *film::find_material(film, true);
            const color::Observer layers = *film::film_observer(material, material.exposure_index);
            const Picture picture = develop(file, on(film));
            for (int i = 0; i < 24; ++i) {
                const color::Xyz expected = seen(patches()[static_cast<std::size_t>(i)], light, layers);
                const double layer[] = {expected.x, expected.y, expected.z};
                for (int c = 0; c < 3; ++c) EXPECT_NEAR(patch(picture, c, i).value / layer[c], 1, 0.01) << i << "RGB"[c];
            }
        }
    }
}

TEST_F(Films, HalfTheExposureIndexIsOneStopMore) {
    const std::string file = chart("stdillum-D65");
    const Picture box = develop(file, on("portra-400")), half = develop(file, on("portra-400", {"--ei", "200"}));
    for (const char* channel : {"R", "G", "B"}) {
        for (std::size_t i = 0; i < box.channels.at(channel).size(); ++i)
            ASSERT_NEAR(half.channels.at(channel)[i] / box.channels.at(channel)[i], 2, 1e-5);
    }
}

// Wratten 85, and an ideal filter from 5000 K to the 3200 K of the film: 1e6 / 3200 - 1e6 / 5000 = 112 mired. Daylight is not a
// blackbody, so grey is not quite neutral.
TEST_F(Films, ATungstenFilmSeesDaylightThroughAConversionFilterAsNearlyNeutral) {
    const std::string file = chart("stdillum-D50");
    const auto blue_over_red = [&](const std::vector<std::string>& options) {
        const Picture picture = develop(file, options);
        return patch(picture, 2, 21).value / patch(picture, 0, 21).value;  // a grey patch
    };
    EXPECT_GT(blue_over_red(on("vision3-500t")), 2);
    for (const char* filter : {"wratten-85", "mired:112"}) {
        const color::Observer layers =
            film::film_observer(*film::find_material("vision3-500t", true), 500)->behind(*color::lens_filter(filter), "", 1);
        const color::Xyz expected = seen(patches()[21], *color::named_spectrum("stdillum-D50"), layers);
        EXPECT_NEAR(expected.z / expected.x, 1, 0.2) << filter;
        EXPECT_NEAR(
            blue_over_red(on("vision3-500t", {"--lens-filter", filter, "--filter-factor", "auto"})) / (expected.z / expected.x), 1,
            0.01)
            << filter;
    }
}

TEST_F(Films, OptionsThatDoNotGoTogetherAreRefused) {
    const std::string file = chart("stdillum-D65");
    for (const auto& [option, value, message] : {std::tuple{"--observer", "cie1964", "--observer"},
                                                 {"--film", "porta-400", "portra-400"},
                                                 {"--push", "3", "from -1 to 2"}}) {
        std::vector<std::string> arguments{tool("latent-develop"), file, "-o", path("refused.exr"), option, value};
        if (std::string(option) != "--film") arguments.insert(arguments.end(), {"--film", "portra-400"});
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.status, 2);
        EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
    }
}

}  // namespace
}  // namespace latent::testing
