// One file, many observers: what develop makes of rendered spectra against integration of the spectra.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "color/camera.h"
#include "color/catalogue.h"
#include "color/difference.h"
#include "color/named_spectra.h"
#include "tests/darkroom/darkroom.h"

namespace latent::testing {
namespace {

using color::Observer;

class Observers : public Darkroom {
 protected:
    static std::vector<color::Spectrum> patches() { return color::color_checker(); }
    // One pixel for each patch.
    static std::vector<std::string> pixels(std::vector<std::string> more) {
        more.insert(more.end(), {"--size", "6x4", "--filter", "box"});
        return more;
    }
    static color::Xyz pixel(const Picture& picture, std::size_t i) {
        const auto at = [&](const char* channel) {
            return static_cast<double>(picture.at(channel, static_cast<int>(i % 6), static_cast<int>(i / 6)));
        };
        return {at("R"), at("G"), at("B")};
    }
};

// The standard error of a patch is below 0.1: between two halves of the samples, patches differ by 0.05 on average.
TEST_F(Observers, SeeAColorCheckerAsIntegrationDoes) {
    for (const char* name : {"stdillum-D65", "stdillum-A"}) {
        const color::Spectrum light = *color::named_spectrum(name);
        const std::string file = render(name, wall(patches(), distant_light(fmt::format("\"spectrum L\" \"{}\"", name), 1)),
                                        {"--samples", "0:65536", "--run-samples", "1024"});
        for (const char* observer : {"cie1931", "cie1964"}) {
            SCOPED_TRACE(std::string(name) + " " + observer);
            const Observer eye = *Observer::by_name(observer);
            const color::Xyz white = color::xyz_from_spectrum(light, eye);
            const color::Xyz unit_white{white.x / white.y, 1, white.z / white.y};
            const Picture all = develop(file, pixels({"--observer", observer}));
            const Picture first = develop(file, pixels({"--observer", observer, "--samples", "0:32768"}));
            const Picture second = develop(file, pixels({"--observer", observer, "--samples", "32768:65536"}));
            double between = 0;
            for (std::size_t i = 0; i < 24; ++i) {
                const auto lab = [&](color::Xyz c) { return color::lab_from_xyz(c, unit_white); };
                EXPECT_LT(ciede2000(lab(pixel(all, i)), lab(seen(patches()[i], light, eye))), 0.3) << i;
                between += ciede2000(lab(pixel(first, i)), lab(pixel(second, i))) / 24;
            }
            EXPECT_LT(between, 0.1);
        }
        for (const char* observer : {"canon_eos_5d", "nikon_d850"}) {
            SCOPED_TRACE(std::string(name) + " " + observer);
            const Observer camera = *Observer::by_name(observer);
            const Picture all = develop(file, pixels({"--observer", observer}));
            for (std::size_t i = 0; i < 24; ++i) {
                const color::Xyz a = pixel(all, i), b = seen(patches()[i], light, camera);
                EXPECT_NEAR(a.x / b.x, 1, 0.01) << i;
                EXPECT_NEAR(a.y / b.y, 1, 0.01) << i;
                EXPECT_NEAR(a.z / b.z, 1, 0.01) << i;
            }
        }
    }
}

// Two lights that no RGB can hold. 6 x 4 patches of 8 x 8 pixels each; the standard error of a patch is that of its 64 pixels.
TEST_F(Observers, OfOneFileSeeWhatRendersMadeForThemSee) {
    const color::Spectrum sodium =
        *color::Spectrum::from_samples({586.5, 588.5, 590.5, 592.5}, {0, 1, 1, 0}, color::Outside::kZero);
    const color::Spectrum lamp = *color::Spectrum::blackbody(2856);
    const std::string scene =
        wall(patches(), distant_light(spectrum_parameter("L", sodium), 0.5) + distant_light("\"blackbody L\" 2856", 1));
    const std::vector<std::string> options = {"--samples", "0:524288", "--run-samples", "65536"};
    const auto with_seed = [&](const char* seed) {
        std::vector<std::string> all = options;
        all.insert(all.end(), {"--seed", seed});
        return all;
    };
    const std::string one = render("one", scene, with_seed("1"));
    for (const auto& [name, seed] : {std::pair{"cie1931", "2"}, {"kodak_trix_400", "3"}, {"nikon_d5100", "4"}}) {
        SCOPED_TRACE(name);
        const Observer observer = *Observer::by_name(name);
        const std::vector<std::string> how = {"--observer", name, "--size", "48x32", "--filter", "box"};
        const Picture a = develop(one, how), b = develop(render(seed, scene, with_seed(seed)), how);
        for (int i = 0; i < 24; ++i) {
            const color::Xyz by_sodium = seen(patches()[static_cast<std::size_t>(i)], sodium, observer);
            const color::Xyz by_lamp = seen(patches()[static_cast<std::size_t>(i)], lamp, observer);
            const double expected[] = {0.5 * by_sodium.x + by_lamp.x, 0.5 * by_sodium.y + by_lamp.y, 0.5 * by_sodium.z + by_lamp.z};
            for (int c = 0; c < 3; ++c) {
                const std::string channel(1, "RGB"[c]);
                const int x = i % 6 * 8, y = i / 6 * 8;
                const Mean p = mean_of(a, channel, x, y, x + 8, y + 8), q = mean_of(b, channel, x, y, x + 8, y + 8);
                EXPECT_LT(p.error, 0.005 * p.value) << i << channel;
                EXPECT_LT(std::abs(p.value - q.value), 4.5 * std::hypot(p.error, q.error)) << i << channel;
                EXPECT_NEAR(p.value / expected[c], 1, 0.005) << i << channel;
            }
        }
    }
}

TEST_F(Observers, AFilterTakesItsShareAndTheFactorGivesItBack) {
    const std::string file = render("grey",
                                    wall({*color::Spectrum::from_samples({360, 830}, {1, 1}, color::Outside::kClamped)},
                                         distant_light("\"spectrum L\" \"stdillum-D65\"", 1)),
                                    {"--samples", "0:65536", "--run-samples", "1024"});
    const auto pixel_of = [&](const std::vector<std::string>& options, Outcome* outcome = nullptr) {
        return static_cast<double>(develop(file, pixels(options), outcome).at("G", 0, 0));
    };
    EXPECT_NEAR(pixel_of({"--observer", "kodak_trix_400"}), 1, 0.01);
    const double red = pixel_of({"--observer", "kodak_trix_400", "--lens-filter", "wratten-25"});
    EXPECT_LT(red, 0.35);
    Outcome outcome;
    EXPECT_NEAR(pixel_of({"--observer", "kodak_trix_400", "--lens-filter", "wratten-25", "--filter-factor", "auto"}, &outcome), 1,
                0.02);
    EXPECT_NE(outcome.out.find("filter factor "), std::string::npos) << outcome.out;
    EXPECT_NEAR(pixel_of({"--observer", "kodak_trix_400", "--lens-filter", "wratten-25", "--filter-factor", "2"}) / red, 2, 1e-5);
    // Balanced channels of a camera, and their ratios as the sensor counts them.
    const Picture balanced = develop(file, pixels({"--observer", "canon_eos_5d"}), &outcome);
    EXPECT_NE(outcome.out.find("24 ColorChecker patches"), std::string::npos) << outcome.out;
    const Picture raw = develop(file, pixels({"--observer", "canon_eos_5d", "--raw-balance", "none"}));
    const Picture xyz = develop(file, pixels({"--observer", "canon_eos_5d", "--camera-output", "xyz"}));
    EXPECT_NEAR(balanced.at("R", 0, 0), 1, 0.01);
    EXPECT_NEAR(balanced.at("B", 0, 0), 1, 0.01);
    EXPECT_EQ(raw.at("G", 0, 0), balanced.at("G", 0, 0));
    EXPECT_GT(std::abs(raw.at("R", 0, 0) - 1), 0.1);
    EXPECT_NEAR(xyz.at("R", 0, 0), 0.9505, 0.01);
    EXPECT_NEAR(xyz.at("B", 0, 0), 1.089, 0.015);
}

}  // namespace
}  // namespace latent::testing
