// Spectral pictures: absolute values, the observer's integral over them, and both images in one unit.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "color/camera.h"
#include "color/named_spectra.h"
#include "tests/darkroom/darkroom.h"

namespace latent::testing {
namespace {

std::string channel_at(double nm) {
    std::string name = fmt::format("S0.{:.3f}nm", nm);
    std::ranges::replace(name, '.', ',');
    name[name.find(',')] = '.';
    return name;
}

using Spectral = Darkroom;

// Luminance 1 cd/m^2 of equal energy: L = 1 / (683 x 106.856917) = 1.370184e-5 W m^-2 sr^-1 nm^-1 at every wavelength.
TEST_F(Spectral, BinsHoldWattsPerNanometre) {
    const color::Spectrum white = *color::Spectrum::from_samples({360, 830}, {1, 1}, color::Outside::kClamped);
    const std::string file =
        render("white", wall(std::vector<color::Spectrum>(24, white), distant_light(spectrum_parameter("L", white), 1)),
               {"--samples", "0:65536", "--run-samples", "1024"});
    const Picture picture = develop(file, {"--size", "6x4", "--filter", "box", "--spectral-bins", "400:700:50"});
    EXPECT_EQ(picture.channels.size(), 6u);
    for (const double nm : {425.0, 475.0, 525.0, 575.0, 625.0, 675.0}) {
        const Mean mean = mean_of(picture, channel_at(nm), 0, 0, 6, 4);
        EXPECT_NEAR(mean.value / 1.370184e-5, 1, 0.01) << nm;
    }
}

TEST_F(Spectral, TheObserversIntegralOverNarrowBinsIsItsPicture) {
    const color::Observer& eye = color::Observer::cie1931();
    for (const char* light : {"stdillum-D65", "stdillum-A"}) {
        const std::string file =
            render(light, wall(color::color_checker(), distant_light(fmt::format("\"spectrum L\" \"{}\"", light), 1)),
                   {"--samples", "0:65536", "--run-samples", "1024"});
        const std::vector<std::string> how = {"--size", "6x4", "--filter", "box"};
        std::vector<std::string> in_bins = how;
        in_bins.insert(in_bins.end(), {"--spectral-bins", "360:830:5"});
        const Picture xyz = develop(file, how), bins = develop(file, in_bins);
        for (int i = 0; i < 24; ++i) {
            double sum[3] = {};
            for (double nm = 362.5; nm < 830; nm += 5) {
                // A bin's mean radiance times the integral of the response over the bin.
                std::array<double, 3> response{};
                for (double l = nm - 2; l < nm + 2.5; ++l) {
                    for (int c = 0; c < 3; ++c) response[static_cast<std::size_t>(c)] += eye.at(l)[static_cast<std::size_t>(c)];
                }
                const double radiance = 683 * static_cast<double>(bins.at(channel_at(nm), i % 6, i / 6));
                for (int c = 0; c < 3; ++c) sum[c] += radiance * response[static_cast<std::size_t>(c)];
            }
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(sum[c] / static_cast<double>(xyz.at(std::string(1, "RGB"[c]), i % 6, i / 6)), 1, 0.005)
                    << light << i << c;
        }
    }
}

// The camera image and the light image of a bidirectional render add up to what a path tracer sees.
TEST_F(Spectral, CameraAndLightImageAddUpInEveryBin) {
    const std::string scene =
        wall(color::color_checker(), "LightSource \"point\" \"spectrum I\" \"stdillum-A\" \"point3 from\" [ 0 0 0 ]\n");
    const std::vector<std::string> samples = {"--samples", "0:262144", "--run-samples", "65536"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.end(), samples.begin(), samples.end());
        return more;
    };
    const std::string path_file = render("path", scene, with({"--integrator", "path"}));
    const std::string bdpt_file = render("bdpt", scene, with({"--integrator", "bdpt", "--seed", "2"}));
    const std::vector<std::string> how = {"--size", "48x32", "--filter", "box", "--spectral-bins", "420:700:70"};
    const Picture path_picture = develop(path_file, how), both = develop(bdpt_file, how);
    std::vector<std::string> light_alone = how;
    light_alone.insert(light_alone.end(), {"--image", "light"});
    const Picture light = develop(bdpt_file, light_alone);
    for (const double nm : {455.0, 525.0, 595.0, 665.0}) {
        const std::string channel = channel_at(nm);
        for (int i = 0; i < 24; ++i) {
            const int x = i % 6 * 8, y = i / 6 * 8;
            const Mean p = mean_of(path_picture, channel, x, y, x + 8, y + 8), b = mean_of(both, channel, x, y, x + 8, y + 8);
            EXPECT_LT(std::abs(p.value - b.value), 4.5 * std::hypot(p.error, b.error)) << channel << i;
            EXPECT_LT(std::hypot(p.error, b.error), 0.05 * p.value);
            EXPECT_GT(mean_of(light, channel, x, y, x + 8, y + 8).value, 0.005 * p.value);
        }
    }
}

}  // namespace
}  // namespace latent::testing
