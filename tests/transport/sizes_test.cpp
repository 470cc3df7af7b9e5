// A file of bidirectional samples through the real tools: a picture developed in parts is the picture, at every size it shows the
// same light, and light images, that are normalised by the number of light paths, have the same energy whatever their pixels.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "image/exr_reader.h"
#include "tests/render/scenes.h"
#include "tests/support/paths.h"

namespace latent::render::testing {
namespace {

using latent::testing::Outcome;
using latent::testing::run;
using latent::testing::tool;

// Luminance and all of a developed picture.
struct Picture {
    int width = 0, height = 0;
    std::array<std::vector<float>, 3> xyz;

    // Mean of Y over block (i, j) of side x side equal ones.
    double mean(int side, int i, int j) const {
        double sum = 0;
        for (int y = j * height / side; y < (j + 1) * height / side; ++y) {
            for (int x = i * width / side; x < (i + 1) * width / side; ++x)
                sum += static_cast<double>(xyz[1][static_cast<std::size_t>(y * width + x)]);
        }
        return sum * side * side / (static_cast<double>(width) * height);
    }
};

class Sizes : public ::testing::Test {
 protected:
    // The samples of `scene` with this seed, as a file.
    std::string rendered(const std::string& scene, int seed, int samples) const {
        const std::string file = (folder_ / fmt::format("{}.latent", seed)).string();
        const Outcome outcome = run({tool("latent-render"), scene, "-o", file, "--integrator", "bdpt", "--record", "xyz", "--seed",
                                     std::to_string(seed), "--samples", fmt::format("0:{}", samples), "--threads", "1", "--force"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return file;
    }
    Picture developed(const std::string& file, const std::string& image, int size,
                      const std::vector<std::string>& more = {}) const {
        const std::string exr = (folder_ / "picture.exr").string();
        std::vector<std::string> command{
            tool("latent-develop"), file, "-o", exr, "--size", std::to_string(size), "--image", image, "--threads", "1", "--force"};
        command.insert(command.end(), more.begin(), more.end());
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        Picture picture;
        const Result<image::ExrReader> reader = image::ExrReader::open(exr);
        if (!reader) throw std::runtime_error(reader.error().message);
        const image::Rect window = reader->image().data_window;
        picture.width = window.width();
        picture.height = window.height();
        for (auto& plane : picture.xyz) plane.resize(window.pixels());
        image::ExrReader::Scratch scratch;
        const Status read = reader->read(window, {picture.xyz[0].data(), picture.xyz[1].data(), picture.xyz[2].data()},
                                         static_cast<std::size_t>(picture.width), scratch);
        if (!read) throw std::runtime_error(read.error().message);
        return picture;
    }
    const Folder folder_{};
};

// Splats across the cut are in both parts: light paths do not know of crops.
TEST_F(Sizes, TwoHalvesOfABidirectionalPictureAreThePictureBitForBit) {
    const std::string file = rendered(latent::testing::in_tree("scenes/cornell.pbrt"), 3, 20'000);
    for (const std::string image : {"camera", "light", "both"}) {
        const Picture whole = developed(file, image, 60);
        ASSERT_EQ(whole.width, 60);
        ASSERT_GT(*std::max_element(whole.xyz[1].begin(), whole.xyz[1].end()), 0);
        for (const int cut : {30, 7}) {
            SCOPED_TRACE(image + ", cut at " + std::to_string(cut));
            const Picture left = developed(file, image, 60, {"--crop", fmt::format("0,0,{},60", cut)});
            const Picture right = developed(file, image, 60, {"--crop", fmt::format("{},0,60,60", cut)});
            ASSERT_EQ(left.width, cut);
            ASSERT_EQ(right.width, 60 - cut);
            int different = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                for (int i = 0; i < 60 * 60; ++i) {
                    const int x = i % 60, y = i / 60;
                    const float part = x < cut ? left.xyz[c][static_cast<std::size_t>(y * cut + x)]
                                               : right.xyz[c][static_cast<std::size_t>(y * (60 - cut) + x - cut)];
                    different += part != whole.xyz[c][static_cast<std::size_t>(i)];
                }
            }
            EXPECT_EQ(different, 0);
        }
    }
}

// A glass sphere before a small lamp: the caustic is nearly all of the light image.
constexpr const char* kCaustic =
    "Film \"rgb\" \"integer xresolution\" 96 \"integer yresolution\" 96\nIntegrator \"bdpt\" \"integer maxdepth\" 6\n"
    "LookAt 0 2.5 -3  0 0.2 0  0 1 0\nCamera \"perspective\" \"float fov\" 45\nWorldBegin\n"
    "AttributeBegin Translate 1.5 3 0 AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" \"float scale\" 60\n"
    "Shape \"sphere\" \"float radius\" 0.15 AttributeEnd\n"
    "Material \"diffuse\" \"spectrum reflectance\" [360 0.7 830 0.7]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-5 0 -5  5 0 -5  5 0 5  -5 0 5] \"integer indices\" [0 2 1 0 3 2]\n"
    "Material \"dielectric\" \"float eta\" 1.5\nTranslate 0.2 0.7 0 Shape \"sphere\" \"float radius\" 0.5\n";

struct Statistic {
    double mean, error;
    double t() const { return mean / error; }
};
Statistic statistic_of(const std::vector<double>& x) {
    const double n = static_cast<double>(x.size());
    double mean = 0, squares = 0;
    for (const double v : x) mean += v / n;
    for (const double v : x) squares += (v - mean) * (v - mean);
    return {mean, std::sqrt(squares / (n - 1) / n)};
}

// 16 independent files at 24, 48 and 96 pixels, and the 16 blocks of a 4 x 4 grid of film areas. With a pixel's own square as the
// filter every light record is in one pixel of one block at each size, so that block means agree but for the rounding of floats.
// Camera records are averaged, not added, in pixels that hold 9 to 144 of them: differences between sizes have mean zero but for
// the spread of these counts. With the default filter light crosses the border of blocks, but not the film's: the whole light image
// has the same energy. Judged by Student's t of 15 degrees of freedom: |t| > 6.5 is met by chance once in 10^5, 34 times asked.
TEST_F(Sizes, AFileOfACausticShowsTheSameLightAtEverySizeInBothImages) {
    const std::string scene = folder_.write("caustic.pbrt", kCaustic).string();
    constexpr int kSizes[] = {24, 48, 96}, kSide = 4, kBlocks = kSide * kSide;
    constexpr double kLargestT = 6.5;
    std::vector<double> camera[2][kBlocks], energy[2], light_mean, camera_mean;  // differences of the larger sizes from the first
    for (int seed = 1; seed <= 16; ++seed) {
        const std::string file = rendered(scene, seed, 82'944);  // 144 of a pixel of 24 x 24
        double of_first_camera[kBlocks] = {}, of_first_light[kBlocks] = {}, first_energy = 0;
        for (int s = 0; s < 3; ++s) {
            const Picture c = developed(file, "camera", kSizes[s], {"--filter", "box"});
            const Picture l = developed(file, "light", kSizes[s], {"--filter", "box"});
            const double filtered = developed(file, "light", kSizes[s]).mean(1, 0, 0);
            if (s == 0) {
                first_energy = filtered;
                light_mean.push_back(l.mean(1, 0, 0));
                camera_mean.push_back(c.mean(1, 0, 0));
            } else {
                energy[s - 1].push_back(filtered / first_energy - 1);
            }
            for (int b = 0; b < kBlocks; ++b) {
                const double camera_block = c.mean(kSide, b % kSide, b / kSide), light_block = l.mean(kSide, b % kSide, b / kSide);
                if (s == 0) {
                    of_first_camera[b] = camera_block;
                    of_first_light[b] = light_block;
                } else {
                    camera[s - 1][b].push_back(camera_block / of_first_camera[b] - 1);
                    EXPECT_NEAR(light_block, of_first_light[b], 1e-5 * of_first_light[b]) << kSizes[s] << ", block " << b;
                }
            }
        }
    }
    const Statistic light = statistic_of(light_mean), direct = statistic_of(camera_mean);
    EXPECT_GT(light.mean, 0.02 * direct.mean);
    for (int s = 0; s < 2; ++s) {
        double worst = 0, largest_error = 0;
        for (const auto& differences : camera[s]) {
            const Statistic difference = statistic_of(differences);
            worst = std::max(worst, std::abs(difference.t()));
            largest_error = std::max(largest_error, difference.error);
        }
        EXPECT_LT(worst, kLargestT);
        EXPECT_LT(largest_error, 0.005);
        const Statistic difference = statistic_of(energy[s]);
        EXPECT_LT(std::abs(difference.t()), kLargestT) << difference.mean << " +- " << difference.error;
        EXPECT_LT(difference.error, 0.002);
        fmt::print(
            "    {0} against 24 pixels: blocks of the camera image within {1:.1f} standard errors of at most {2:.3f} %; energy of "
            "the "
            "light image {3:+.3f} % +- {4:.3f} %\n",
            kSizes[s + 1], worst, 100 * largest_error, 100 * difference.mean, 100 * difference.error);
    }
    fmt::print("    Y of the light image {:.4f} +- {:.4f}, of the camera image {:.4f} +- {:.4f}\n", light.mean, light.error,
               direct.mean, direct.error);
}

}  // namespace
}  // namespace latent::render::testing
