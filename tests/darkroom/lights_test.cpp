// Lights that are mixed after rendering against renders of scenes that have them so.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "color/camera.h"
#include "color/catalogue.h"
#include "color/named_spectra.h"
#include "tests/darkroom/darkroom.h"

namespace latent::testing {
namespace {

class Lights : public Darkroom {
 protected:
    // A corner with a ball, under a lamp and a sky: paths meet both.
    static std::string corner(double lamp, double sky) {
        return fmt::format(R"(Film "rgb" "integer xresolution" 6 "integer yresolution" 4
Integrator "path" "integer maxdepth" 4
LookAt 0.5 0.6 -2.4  0 0 0.4  0 1 0
Camera "perspective" "float fov" 50
WorldBegin
LightSource "infinite" "string name" "sky" "spectrum L" "stdillum-D65" "float scale" {1}
AttributeBegin
  Translate -0.7 0.8 -0.4
  AreaLightSource "diffuse" "string name" "lamp" "blackbody L" 2856 "float scale" {0}
  Shape "sphere" "float radius" 0.25
AttributeEnd
Material "diffuse" "spectrum reflectance" [ 360 0.1 500 0.3 600 0.7 830 0.8 ]
Shape "bilinearmesh" "point3 P" [ -3 -1 -3  3 -1 -3  -3 -1 1.5  3 -1 1.5 ]
Material "diffuse" "spectrum reflectance" [ 360 0.6 500 0.7 600 0.3 830 0.2 ]
Shape "bilinearmesh" "point3 P" [ -3 -1 1.5  3 -1 1.5  -3 3 1.5  3 3 1.5 ]
AttributeBegin
  Translate 0.4 -0.5 0.3
  Shape "sphere" "float radius" 0.5
AttributeEnd
)",
                           lamp, sky);
    }
    static std::vector<std::string> with(std::vector<std::string> options, const std::vector<std::string>& more) {
        options.insert(options.end(), more.begin(), more.end());
        return options;
    }
};

// 6 blocks of 16 x 16 pixels; the standard error of a block is that of its pixels, which hold their differences too.
TEST_F(Lights, MixedAfterRenderingAreThoseOfARenderWithTheirPowers) {
    for (const char* integrator : {"path", "bdpt"}) {
        SCOPED_TRACE(integrator);
        const std::vector<std::string> how = {"--samples", "0:786432", "--run-samples", "65536",
                                              "--record",  "xyz",      "--integrator",  integrator};
        const std::string groups =
            render(std::string(integrator) + "0", corner(4, 0.5), with(how, {"--light-groups", "--seed", "1"}));
        const std::string plain = render(std::string(integrator) + "1", corner(2, 1), with(how, {"--seed", "2"}));
        const std::vector<std::string> size = {"--size", "48x32", "--filter", "box"};
        const Picture mixed = develop(groups, with(size, {"--light", "lamp=0.5", "--light", "sky=2", "--halves"}));
        const Picture expected = develop(plain, with(size, {"--halves"}));
        const Picture lamp = develop(groups, with(size, {"--light", "sky=0"})),
                      sky = develop(groups, with(size, {"--light", "lamp=0"}));
        for (int block = 0; block < 6; ++block) {
            const int x = block % 3 * 16, y = block / 3 * 16;
            const auto mean = [&](const Picture& picture, const std::string& channel) {
                return mean_of(picture, channel, x, y, x + 16, y + 16).value;
            };
            // Of both images: pixels of the box filter share no samples, and halves none at all.
            const auto error = [&](const Picture& picture) {
                double squares = 0;
                for (int py = y; py < y + 16; ++py) {
                    for (int px = x; px < x + 16; ++px) {
                        const double d = static_cast<double>(picture.at("half0.G", px, py) - picture.at("half1.G", px, py));
                        squares += d * d / 4;
                    }
                }
                return std::sqrt(squares) / 256;
            };
            const double a = mean(mixed, "G"), b = mean(expected, "G"), both = std::hypot(error(mixed), error(expected));
            EXPECT_LT(std::abs(a - b), 4.5 * both) << block << ": " << a << " and " << b;
            EXPECT_LT(error(mixed), 0.005 * a) << block;
            EXPECT_GT(mean(lamp, "G"), 0.01 * a) << block;
            EXPECT_GT(mean(sky, "G"), 0.01 * a) << block;
        }
    }
}

TEST_F(Lights, AllAtOneAreThePlainPicture) {
    for (const char* integrator : {"path", "bdpt"}) {
        const std::vector<std::string> how = {"--samples",    "0:65536",  "--run-samples", "1024",
                                              "--integrator", integrator, "--precision",   "23"};
        const std::string groups = render(std::string(integrator) + "2", corner(4, 0.5), with(how, {"--light-groups"}));
        const std::string plain = render(std::string(integrator) + "3", corner(4, 0.5), how);
        const std::vector<std::string> size = {"--size", "24"};
        const Picture expected = develop(plain, size), as_it_is = develop(groups, size),
                      at_one = develop(groups, with(size, {"--light", "lamp=1", "--light", "sky=1"}));
        for (const char* channel : {"R", "G", "B"}) {
            const double largest = static_cast<double>(std::ranges::max(expected.channels.at(channel)));
            for (std::size_t i = 0; i < expected.channels.at(channel).size(); ++i) {
                EXPECT_NEAR(as_it_is.channels.at(channel)[i], expected.channels.at(channel)[i], 1e-6 * largest);
                EXPECT_EQ(at_one.channels.at(channel)[i], as_it_is.channels.at(channel)[i]);
            }
        }
    }
}

// One pass over the records gives what a pass for each group would. The picture is their sum.
TEST_F(Lights, AsLayersAreThePicturesOfEachGroupAlone) {
    struct Choice {
        std::string integrator, layers;  // other ones
        std::vector<std::string> options;
    };
    const Choice choices[] = {{"path", "", {}},
                              {"path", "", {"--filter", "box"}},
                              {"path", "", {"--filter", "quartic:-6,2"}},
                              {"path", "", {"--estimator", "ratio"}},
                              {"path", "", {"--spectral-bins", "7"}},
                              {"path", "variance,count,", {}},  // which add up the records of a sample first
                              {"bdpt", "", {}},
                              {"bdpt", "", {"--filter", "mitchell-separable", "--image", "light"}},
                              {"bdpt", "weight,", {"--observer", "canon_eos_5d", "--halves"}}};
    const char* const groups[] = {"unnamed", "sky", "lamp"};
    std::map<std::string, std::string> files;
    for (const std::string integrator : {"path", "bdpt"})
        files[integrator] = render(integrator, corner(4, 0.5),
                                   {"--samples", "0:32768", "--run-samples", "1024", "--integrator", integrator, "--light-groups"});
    for (const Choice& choice : choices) {
        SCOPED_TRACE(fmt::format("{} {}{}", choice.integrator, choice.layers, fmt::join(choice.options, " ")));
        const std::vector<std::string> how = with({"--size", "48"}, choice.options);
        const Picture layers = develop(files[choice.integrator], with(how, {"--layers", choice.layers + "lights"}));
        std::map<std::string, std::vector<double>> sums;
        for (const char* group : groups) {
            std::vector<std::string> alone = how;
            if (!choice.layers.empty()) alone = with(alone, {"--layers", choice.layers.substr(0, choice.layers.size() - 1)});
            for (const char* other : groups) {
                if (other != group) alone = with(alone, {"--light", fmt::format("{}=0", other)});
            }
            for (const auto& [channel, values] : develop(files[choice.integrator], alone).channels) {
                const std::string half = channel.starts_with("half") ? channel.substr(0, 6) : "";
                const auto layer = layers.channels.find(fmt::format("{}light.{}.{}", half, group, channel.substr(half.size())));
                if (layer == layers.channels.end()) continue;
                EXPECT_EQ(layer->second, values) << group << " " << channel;
                std::vector<double>& sum = sums[channel];
                sum.resize(values.size());
                for (std::size_t i = 0; i < values.size(); ++i) sum[i] += static_cast<double>(values[i]);
            }
        }
        EXPECT_EQ(sums.size(), (layers.channels.contains("R") ? 3u : 7u) * (layers.channels.contains("half0.R") ? 3 : 1));
        for (const auto& [channel, sum] : sums) {
            const std::vector<float>& values = layers.channels.at(channel);
            const double largest = static_cast<double>(std::ranges::max(values));
            for (std::size_t i = 0; i < sum.size(); ++i) EXPECT_NEAR(sum[i], values[i], 1e-6 * largest) << channel;
        }
    }
}

TEST_F(Lights, AsLayersArePartsOfTheMixHoweverItIsDeveloped) {
    const std::string file =
        render("mix", corner(4, 0.5), {"--samples", "0:262144", "--run-samples", "8192", "--integrator", "bdpt", "--light-groups"});
    for (const char* denoise : {"--denoise=0", "--denoise"}) {
        const std::vector<std::string> how = {"--size",          "600",     "--layers",       "lights",
                                              "--dim-fireflies", "--light", "lamp=6500K,0.5", "--light",
                                              "sky=wratten-80a", denoise};
        const Picture whole = develop(file, with(how, {"--threads", "1"}));
        for (const char* channel : {"R", "G", "B"}) {
            const std::vector<float>& mix = whole.channels.at(channel);
            const double largest = static_cast<double>(std::ranges::max(mix));
            double lamp = 0, sky = 0;
            for (std::size_t i = 0; i < mix.size(); ++i) {
                const auto of = [&](const char* group) {
                    return static_cast<double>(whole.channels.at(fmt::format("light.{}.{}", group, channel))[i]);
                };
                EXPECT_NEAR(of("unnamed") + of("sky") + of("lamp"), mix[i], 1e-6 * largest);
                lamp += of("lamp"), sky += of("sky");
            }
            EXPECT_GT(lamp, 0);
            EXPECT_GT(sky, 0);
        }
        EXPECT_EQ(develop(file, with(how, {"--threads", "2", "--memory", "64M"})).channels, whole.channels);
        const Picture crop = develop(file, with(how, {"--crop", "200,100,264,140"}));
        for (const auto& [channel, values] : crop.channels) {
            for (int y = 0; y < 40; ++y) {
                for (int x = 0; x < 64; ++x) EXPECT_EQ(crop.at(channel, x, y), whole.at(channel, 200 + x, 100 + y)) << channel;
            }
        }
    }
}

TEST_F(Lights, ReplacedOrFilteredAreWhatIntegrationSays) {
    const color::Spectrum d65 = *color::named_spectrum("stdillum-D65"), lamp = *color::Spectrum::blackbody(2856);
    const std::string light = R"(LightSource "distant" "string name" "the lamp" "blackbody L" 2856 "float scale" 3.14159265)"
                              "\n\"point3 from\" [ 0 0 0 ] \"point3 to\" [ 0 0 1 ]\n";
    const std::string file =
        render("lamp", wall(color::color_checker(), light), {"--samples", "0:131072", "--run-samples", "1024", "--light-groups"});
    const std::vector<std::string> size = {"--size", "6x4", "--filter", "box"};
    const color::Observer& eye = color::Observer::cie1931();
    const Picture replaced = develop(file, with(size, {"--light", "the lamp=D65,0.5"}));
    const Picture filtered = develop(file, with(size, {"--light", "the lamp=wratten-80a"}));
    const color::Spectrum blue = *color::lens_filter("wratten-80a");
    for (int i = 0; i < 24; ++i) {
        const color::Spectrum& patch = color::color_checker()[static_cast<std::size_t>(i)];
        const color::Xyz by_daylight = seen(patch, d65, eye), behind = seen(patch, lamp, eye.behind(blue, "blue", 1));
        EXPECT_NEAR(static_cast<double>(replaced.at("R", i % 6, i / 6)) / (0.5 * by_daylight.x), 1, 0.01) << i;
        EXPECT_NEAR(static_cast<double>(replaced.at("G", i % 6, i / 6)) / (0.5 * by_daylight.y), 1, 0.01) << i;
        EXPECT_NEAR(static_cast<double>(replaced.at("B", i % 6, i / 6)) / (0.5 * by_daylight.z), 1, 0.015) << i;
        EXPECT_NEAR(static_cast<double>(filtered.at("G", i % 6, i / 6)) / behind.y, 1, 0.01) << i;
    }
    // In bins too: 500 to 600 nm.
    const Picture bins = develop(file, with(size, {"--light", "the lamp=D65", "--spectral-bins", "500:600:100"}));
    double daylight = 0;
    for (double nm = 500.5; nm < 600; ++nm) daylight += d65(nm) / 100;
    double grey = 0;
    for (double nm = 500.5; nm < 600; ++nm) grey += color::color_checker()[19](nm) / 100;
    const double luminance = color::xyz_from_spectrum(d65, eye).y;
    EXPECT_NEAR(static_cast<double>(bins.at("S0.550,000nm", 1, 3)) / (grey * daylight / luminance / 683), 1, 0.01);
}

TEST_F(Lights, WhatCannotBeMixedIsRefusedInOneLine) {
    const std::vector<std::string> samples = {"--samples", "0:1024", "--run-samples", "1024"};
    const color::Spectrum grey = color::Spectrum::constant(0.5);
    const std::string sodium = R"(LightSource "distant" "string name" "sodium" "spectrum L" [ 586 0 588 1 590 1 592 0 ])"
                               "\n\"point3 from\" [ 0 0 0 ] \"point3 to\" [ 0 0 1 ]\n";
    const std::string file = render("sodium", wall({grey}, sodium), with(samples, {"--light-groups"}));
    const std::string plain = render("plain", wall({grey}, sodium), samples);
    const std::string xyz = render("xyz", wall({grey}, sodium), with(samples, {"--light-groups", "--record", "xyz"}));
    const auto message = [&](const std::string& in, const std::string& light) {
        const Outcome outcome = run({tool("latent-develop"), in, "-o", path("a.exr"), "--light", light});
        EXPECT_EQ(outcome.status, 2) << outcome.err;
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
        return outcome.err;
    };
    const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
    EXPECT_TRUE(has(message(file, "sodum=2"), "did you mean sodium?"));
    EXPECT_TRUE(has(message(file, "moon=2"), "choose from unnamed, sodium"));
    EXPECT_TRUE(has(message(file, "sodium=6500K"), "emit nothing at 360 nm"));
    EXPECT_TRUE(has(message(plain, "sodium=2"), "render the scene with --light-groups"));
    EXPECT_TRUE(has(message(xyz, "sodium=wratten-25"), "need spectral records"));
    for (const char* bad :
         {"sodium", "sodium=", "sodium=-1", "=2", "sodium=D65,A", "sodium=wratten-1000", "sodium=2,,3", "sodium=1e39"})
        message(file, bad);
    EXPECT_EQ(run({tool("latent-develop"), xyz, "-o", path("b.exr"), "--light", "sodium=2"}).status, 0);
    const Outcome none = run({tool("latent-develop"), plain, "-o", path("c.exr"), "--layers", "lights"});
    EXPECT_EQ(none.status, 2);
    EXPECT_TRUE(has(none.err, "--layers lights: the files have no light groups; render the scene with --light-groups")) << none.err;
    const Outcome unnamed = run({tool("latent-render"), path("none.pbrt"), "-o", path("none.latent"), "--light-groups"});
    EXPECT_NE(unnamed.status, 0);
}

// A candle has so little blue that a daylight made of it is noise.
TEST_F(Lights, CurvesThatMakeNoiseAreWarnedOf) {
    const std::vector<std::string> samples = {"--samples", "0:1024", "--run-samples", "1024", "--light-groups"};
    const std::string candle =
        "LightSource \"distant\" \"string name\" \"candle\" \"blackbody L\" 1200\n"
        "\"point3 from\" [ 0 0 0 ] \"point3 to\" [ 0 0 1 ]\n";
    const std::string file = render("candle", wall({color::Spectrum::constant(0.5)}, candle), samples);
    std::ofstream(path("20.csv")) << "nm,factor\n400,1\n700,20\n";
    std::ofstream(path("21.csv")) << "nm,factor\n400,1\n700,21\n";
    std::ofstream(path("1e300.csv")) << "400 1e300\n";
    std::ofstream(path("down.csv")) << "500,1\n400,1\n";
    const auto develop = [&](const std::string& setting) {
        return run({tool("latent-develop"), file, "-o", path("a.exr"), "--force", "--light", "candle=" + setting});
    };
    const auto warned = [&](const Outcome& outcome) { return outcome.err.find("and so is the noise") != std::string::npos; };
    for (const std::string& setting : {std::string("D65"), path("21.csv"), std::string("21"), path("20.csv") + ",1.1"})
        EXPECT_TRUE(warned(develop(setting))) << setting;
    for (const std::string& setting : {std::string("1500K"), path("20.csv"), std::string("20")})
        EXPECT_FALSE(warned(develop(setting))) << setting;
    const Outcome huge = develop(path("1e300.csv") + "," + path("1e300.csv"));
    EXPECT_EQ(huge.status, 1);
    EXPECT_NE(huge.err.find("not finite"), std::string::npos) << huge.err;
    const Outcome unsorted = develop(path("down.csv"));
    EXPECT_EQ(unsorted.status, 1);
    EXPECT_NE(unsorted.err.find("down.csv: line 2: wavelengths must increase"), std::string::npos) << unsorted.err;
}

}  // namespace
}  // namespace latent::testing
