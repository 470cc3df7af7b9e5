#include "color/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "color/named_spectra.h"
#include "color/observer.h"
#include "tests/support/paths.h"

namespace latent::color {
namespace {

std::string text_of(const std::string& path) {
    std::ifstream file(latent::testing::in_tree(path));
    EXPECT_TRUE(file) << path;
    return {std::istreambuf_iterator<char>(file), {}};
}

// The 24 patches of a ColorChecker as spectra.
std::vector<Spectrum> color_checker() {
    std::istringstream lines(text_of("tests/color/data/colorchecker_ohta1997_5nm.csv"));
    std::vector<double> lambda_nm;
    std::vector<std::vector<double>> patches(24);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] < '0' || line[0] > '9') continue;
        std::istringstream fields(line);
        std::string field;
        std::getline(fields, field, ',');
        lambda_nm.push_back(std::stod(field));
        for (auto& patch : patches) {
            std::getline(fields, field, ',');
            patch.push_back(std::stod(field));
        }
    }
    std::vector<Spectrum> out;
    for (auto& patch : patches) out.push_back(*Spectrum::from_samples(lambda_nm, patch, Outside::kClamped));
    return out;
}

Xyz seen_under_d65(const Spectrum& reflectance, const Observer& observer) {
    const auto seen = [&](double lambda) { return reflectance(lambda) * illuminant_d65()(lambda); };
    return xyz_from_spectrum(Spectrum::from_function(seen, Outside::kZero), observer);
}

// CIE 1976 L*a*b* [CIE15].
std::array<double, 3> lab(Xyz c, Xyz white) {
    const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : 841.0 / 108 * t + 4.0 / 29; };
    const double x = f(c.x / white.x), y = f(c.y / white.y), z = f(c.z / white.z);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

TEST(Camera, SeesAColorCheckerNearlyAsTheEyeDoes) {
    const Observer camera = *Observer::from_csv(text_of("scenes/observers/nikon-d5100.csv"), "nikon-d5100");
    const Xyz white = xyz_from_spectrum(illuminant_d65(), Observer::cie1931());
    double sum = 0, worst = 0;
    for (const Spectrum& patch : color_checker()) {
        const auto a = lab(seen_under_d65(patch, camera), white), b = lab(seen_under_d65(patch, Observer::cie1931()), white);
        const double difference = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
        sum += difference;
        worst = std::max(worst, difference);
    }
    EXPECT_LT(sum / 24, 1.75);
    EXPECT_LT(worst, 5.5);
}

TEST(Camera, DaylightIsExact) {
    const Observer camera = *Observer::from_csv(text_of("scenes/observers/nikon-d5100.csv"), "nikon-d5100");
    const Xyz seen = xyz_from_spectrum(illuminant_d65(), camera), eye = xyz_from_spectrum(illuminant_d65(), Observer::cie1931());
    EXPECT_NEAR(seen.x / eye.x, 1, 1e-5);  // the condition holds for sums over integer nm, the integrals are those between them
    EXPECT_NEAR(seen.y / eye.y, 1, 1e-12);
    EXPECT_NEAR(seen.z / eye.z, 1, 1e-5);
}

// A camera whose curves are mixtures of the eye's (Luther's condition) is that eye.
TEST(Camera, ThatSeesWithMixturesOfTheEyesCurvesIsTheEye) {
    const Observer& cie = Observer::cie1931();
    const Matrix3 mixture{{{{1.5, 0.25, 0.125}, {0.5, 2, 0.25}, {0, 0.25, 3}}}};
    std::string csv = "wavelength_nm,r,g,b\n";
    for (int i = 0; i < kIntegerNmCount; ++i) {
        const auto f = mixture * cie.responses()[i];
        std::ostringstream line;
        line.precision(17);
        line << kLambdaMin + i << ',' << f[0] << ',' << f[1] << ',' << f[2] << '\n';
        csv += line.str();
    }
    const Observer camera = *Observer::from_csv(csv, "luther");
    for (double lambda = 380; lambda <= 780; lambda += 2.5) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(camera.at(lambda)[c], cie.at(lambda)[c], 2e-6);
    }
}

TEST(Camera, OnlyColumnsCalledRgbAreCombined) {
    const std::string rows = "400,1,2,3\n500,2,3,4\n600,4,1,2\n";
    const Observer plain = *Observer::from_csv(rows, "plain"), xyz = *Observer::from_csv("nm,x,y,z\n" + rows, "xyz");
    EXPECT_EQ(plain.at(500), xyz.at(500));
    EXPECT_NE(plain.at(500), (*Observer::from_csv("nm,r,g,b\n" + rows, "rgb")).at(500));
    EXPECT_THAT(Observer::from_csv("nm,r,g,b\n400,1,1,1\n600,1,1,1\n", "flat").error().message,
                ::testing::HasSubstr("must differ"));
}

TEST(Camera, TheFilmBesideItReadsToo) {
    const Observer film = *Observer::from_csv(text_of("scenes/observers/kodak-tri-x-400.csv"), "kodak-tri-x-400");
    EXPECT_EQ(film.at(500)[0], film.at(500)[2]);
    EXPECT_EQ(film.at(700)[1], 0);  // panchromatic film does not see deep red
    EXPECT_GT(film.at(400)[1], film.at(650)[1]);
}

}  // namespace
}  // namespace latent::color
