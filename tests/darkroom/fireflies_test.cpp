// Firefly control of a caustic: a glass ball between a bulb and a floor that the sky lights.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/darkroom/darkroom.h"

namespace latent::testing {
namespace {

constexpr int kWidth = 48, kHeight = 32;

class Fireflies : public Darkroom {
 protected:
    static std::string floor(bool with_bulb) {
        const std::string bulb = R"(AttributeBegin
  AreaLightSource "diffuse" "spectrum L" "stdillum-A" "float scale" 60
  Translate -2 3 0
  Shape "sphere" "float radius" 0.06
AttributeEnd
)";
        return R"(Film "rgb" "integer xresolution" 48 "integer yresolution" 32
Integrator "path" "integer maxdepth" 6
LookAt 2.6 2.0 -0.8  0.95 0 0  0 1 0
Camera "perspective" "float fov" 32
WorldBegin
LightSource "infinite" "spectrum L" "stdillum-D65" "float scale" 1
)" + (with_bulb ? bulb : "") +
               R"(Material "diffuse" "spectrum reflectance" [ 360 0.7 830 0.7 ]
Shape "bilinearmesh" "point3 P" [ -6 0 -6  6 0 -6  -6 0 6  6 0 6 ]
AttributeBegin
  Material "dielectric" "float eta" 1.5
  Translate 0 0.95 0
  Shape "sphere" "float radius" 0.5
AttributeEnd
)";
    }
    std::string samples(bool with_bulb, int per_pixel, int seed) {
        return render(
            std::to_string(per_pixel) + "-" + std::to_string(seed), floor(with_bulb),
            {"--record", "xyz", "--samples", "0:" + std::to_string(kWidth * kHeight * per_pixel), "--seed", std::to_string(seed)});
    }
    Picture developed(const std::string& file, bool dim) {
        std::vector<std::string> options = {"--size", "48x32", "--filter", "box"};
        if (dim) options.emplace_back("--dim-fireflies");
        return develop(file, options);
    }
};

double squared_error(const Picture& picture, const Picture& truth) {
    double sum = 0;
    for (const char* channel : {"R", "G", "B"}) {
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                const double d = static_cast<double>(picture.at(channel, x, y) - truth.at(channel, x, y));
                sum += d * d;
            }
        }
    }
    return sum / (3 * kWidth * kHeight);
}

// The brightest part of the caustic.
double caustic(const Picture& picture) { return mean_of(picture, "G", 20, 12, 27, 20).value; }

// At 64 samples per pixel, some 40 samples are dimmed in 16 pictures; the seeds are fixed.
TEST_F(Fireflies, DimmedTheyCostLittleLightAndLessOfItWithMoreSamples) {
    const Picture truth = developed(samples(true, 3072, 99), false);
    double plain = 0, dimmed = 0, last_share = 1;
    for (const auto& [per_pixel, seeds] : {std::pair{64, 16}, {256, 4}, {1024, 2}}) {
        SCOPED_TRACE(per_pixel);
        double taken = 0, kept = 0, all = 0;
        for (int seed = 1; seed <= seeds; ++seed) {
            const std::string file = samples(true, per_pixel, seed);
            const Picture before = developed(file, false), after = developed(file, true);
            if (per_pixel == 64) plain += squared_error(before, truth), dimmed += squared_error(after, truth);
            taken += mean_of(before, "G", 0, 0, kWidth, kHeight).value - mean_of(after, "G", 0, 0, kWidth, kHeight).value;
            all += mean_of(before, "G", 0, 0, kWidth, kHeight).value;
            kept += caustic(after) / caustic(truth) / seeds;
        }
        EXPECT_GT(kept, 0.95);
        EXPECT_LT(taken / all, last_share);
        last_share = taken / all;
    }
    EXPECT_GT(plain, 3 * dimmed) << plain / dimmed;
}

TEST_F(Fireflies, WhereThereAreNoneThePictureStays) {
    const std::string file = samples(false, 64, 1);
    const Picture before = developed(file, false), after = developed(file, true);
    for (const char* channel : {"R", "G", "B"}) {
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x)
                EXPECT_NEAR(after.at(channel, x, y) / before.at(channel, x, y), 1, 1e-3) << x << ' ' << y;
        }
    }
}

TEST_F(Fireflies, TheReportSaysWhatWasTaken) {
    const std::string file = samples(true, 64, 1);
    Outcome text, json;
    develop(file, {"--size", "48x32", "--dim-fireflies"}, &text);
    EXPECT_NE(text.out.find("fireflies: "), std::string::npos) << text.out;
    develop(file, {"--size", "48x32", "--dim-fireflies", "--json"}, &json);
    const auto report = nlohmann::json::parse(json.out);
    EXPECT_GT(report["fireflies"]["camera"]["samples"], 0);
    EXPECT_GT(report["fireflies"]["camera"]["share_of_light"], 0);
    EXPECT_EQ(report["fireflies"]["light"]["samples"], 0);
}

}  // namespace
}  // namespace latent::testing
