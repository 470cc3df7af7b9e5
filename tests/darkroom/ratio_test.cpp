// The ratio estimator [R06 3.3.6]: bounds, the limit, and what it does not take.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "color/camera.h"
#include "tests/darkroom/darkroom.h"

namespace latent::testing {
namespace {

class Ratio : public Darkroom {
 protected:
    static color::Spectrum flat(double value) {
        return *color::Spectrum::from_samples({360, 830}, {value, value}, color::Outside::kClamped);
    }
    // A white wall under equal energy: radiance 1 (in Y) at every wavelength.
    std::string white(const std::string& samples) const {
        return render("white", wall(std::vector<color::Spectrum>(24, flat(1)), distant_light(spectrum_parameter("L", flat(1)), 1)),
                      {"--samples", samples, "--run-samples", "1024", "--precision", "23", "--wavelengths", "4"});
    }
    static constexpr const char* kChannels[3] = {"R", "G", "B"};
};

TEST_F(Ratio, WhiteIsExactFromTheFirstSampleOn) {
    const std::string file = white("0:96");
    const std::vector<std::string> how = {"--size", "12x8", "--filter", "box"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.end(), how.begin(), how.end());
        return more;
    };
    const Picture ratio = develop(file, with({"--estimator", "ratio", "--halves", "--layers", "variance"})),
                  standard = develop(file, with({"--estimator", "standard"}));
    double largest = 0;
    int met = 0;
    const color::Xyz white_point = seen(flat(1), flat(1), color::Observer::cie1931());
    for (const char* channel : kChannels) {
        const auto& values = ratio.channels.at(channel);
        const double expected = *channel == 'R' ? white_point.x : *channel == 'G' ? white_point.y : white_point.z;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (values[i] == 0) continue;  // a pixel without a record
            ++met;
            EXPECT_NEAR(values[i], expected, 2e-5) << channel << i;
            EXPECT_NEAR(ratio.channels.at(std::string("variance.") + channel)[i], 0, 1e-6);  // differences of float32
            for (const char* half : {"half0.", "half1."}) {
                const auto value = static_cast<double>(ratio.channels.at(std::string(half) + channel)[i]);
                EXPECT_TRUE(value == 0 || std::abs(value - expected) < 2e-5) << half << channel << value;
            }
            largest = std::max(largest, std::abs(static_cast<double>(standard.channels.at(channel)[i]) - expected));
        }
    }
    EXPECT_GT(met, 200);
    EXPECT_GT(largest, 0.01);  // what is exact here is noise there
}

// Of any number of samples, and any filter without negative weights.
TEST_F(Ratio, NoPixelIsBrighterThanTheBrightestWavelength) {
    const color::Spectrum edge =
        *color::Spectrum::from_samples({360, 569, 571, 830}, {0.9, 0.9, 0.1, 0.1}, color::Outside::kClamped);
    const std::string file =
        render("edge", wall(std::vector<color::Spectrum>(24, edge), distant_light(spectrum_parameter("L", flat(1)), 1)),
               {"--samples", "0:384", "--run-samples", "1024", "--precision", "23", "--wavelengths", "4"});
    const std::vector<std::string> how = {"--size", "24x16"};
    std::vector<std::string> by_ratio = how;
    by_ratio.insert(by_ratio.end(), {"--estimator", "ratio"});
    const Picture ratio = develop(file, by_ratio), standard = develop(file, how);
    const auto largest = [](const Picture& picture) { return std::ranges::max(picture.channels.at("B")); };
    const color::Xyz white_point = seen(flat(1), flat(1), color::Observer::cie1931());
    EXPECT_LE(largest(ratio), 0.9 * white_point.z * 1.00002);
    EXPECT_GT(largest(standard), 0.91f);
}

TEST_F(Ratio, TendsToTheIntegral) {
    const color::Observer& eye = color::Observer::cie1931();
    const std::string file = render("checker", wall(color::color_checker(), distant_light("\"spectrum L\" \"stdillum-A\"", 1)),
                                    {"--samples", "0:65536", "--run-samples", "1024"});
    const Picture picture = develop(file, {"--size", "6x4", "--filter", "box", "--estimator", "ratio"});
    const color::Spectrum lamp = *color::Spectrum::blackbody(2856);
    for (int i = 0; i < 24; ++i) {
        const color::Xyz expected = seen(color::color_checker()[static_cast<std::size_t>(i)], lamp, eye);
        EXPECT_NEAR(static_cast<double>(picture.at("R", i % 6, i / 6)) / expected.x, 1, 0.005) << i;
        EXPECT_NEAR(static_cast<double>(picture.at("G", i % 6, i / 6)) / expected.y, 1, 0.005) << i;
        EXPECT_NEAR(static_cast<double>(picture.at("B", i % 6, i / 6)) / expected.z, 1, 0.01) << i;
    }
}

// 32 pictures of 24 pixels: the variance between them has 744 degrees of freedom, so its standard error is 5 %.
TEST_F(Ratio, TheVarianceLayerIsTheSpreadOfPictures) {
    constexpr int kPictures = 32, kSamples = 1024;
    const std::string file =
        render("checker", wall(color::color_checker(), distant_light("\"spectrum L\" \"stdillum-A\"", 1)),
               {"--wavelengths", "4", "--samples", fmt::format("0:{}", kPictures * kSamples), "--run-samples", "1024"});
    std::vector<Picture> pictures;
    for (int i = 0; i < kPictures; ++i) {
        pictures.push_back(develop(file, {"--size", "6x4", "--filter", "box", "--estimator", "ratio", "--layers", "variance",
                                          "--samples", fmt::format("{}:{}", i * kSamples, (i + 1) * kSamples), "--force"}));
    }
    double spread = 0, predicted = 0;
    for (std::size_t p = 0; p < 24; ++p) {
        double sum = 0, squares = 0;
        for (const Picture& picture : pictures) {
            const auto value = static_cast<double>(picture.channels.at("R")[p]);
            sum += value;
            squares += value * value;
            predicted += static_cast<double>(picture.channels.at("variance.R")[p]) / kPictures;
        }
        spread += (squares - sum * sum / kPictures) / (kPictures - 1);
    }
    EXPECT_GT(spread, 0);
    // Film positions and wavelengths of a slice are well distributed, so it may vary less than independent samples do.
    EXPECT_LT(spread, 1.2 * predicted);
}

TEST_F(Ratio, RecordsThatItCannotDivideAreRefusedInOneLine) {
    const std::string scene = wall({flat(0.5)}, distant_light("\"spectrum L\" \"stdillum-A\"", 1));
    const std::vector<std::string> samples = {"--samples", "0:1024", "--run-samples", "1024"};
    std::vector<std::string> as_xyz = samples;
    as_xyz.insert(as_xyz.end(), {"--record", "xyz"});
    const std::string spectral = render("spectral", scene, samples), xyz = render("xyz", scene, as_xyz);
    const auto refusal = [&](const std::string& file, std::vector<std::string> more) {
        std::vector<std::string> command = {tool("latent-develop"), file, "-o", path("a.exr"), "--estimator", "ratio"};
        command.insert(command.end(), more.begin(), more.end());
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.status, 2) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(path("a.exr")));
        return outcome.err;
    };
    EXPECT_NE(refusal(xyz, {}).find("--estimator ratio: needs spectral records"), std::string::npos);
    EXPECT_NE(refusal(spectral, {"--spectral-bins", "10"}).find("excludes"), std::string::npos);
    EXPECT_NE(refusal(spectral, {"--observer", "canon_eos_5d", "--camera-output", "xyz"}).find("negative"), std::string::npos);
}

}  // namespace
}  // namespace latent::testing
