#include "color/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "color/catalogue.h"
#include "color/difference.h"
#include "color/named_spectra.h"
#include "color/observer.h"
#include "color/rgb_space.h"

namespace latent::color {
namespace {

std::vector<Observer> all_cameras() {
    std::vector<Observer> cameras;
    for (const CatalogueEntry& entry : observer_catalogue()) {
        Observer observer = *Observer::by_name(entry.name);
        if (observer.kind() == ObserverKind::kCamera) cameras.push_back(std::move(observer));
    }
    return cameras;
}

Xyz seen_under_d65(const Spectrum& reflectance, const Observer& observer) {
    const auto seen = [&](double lambda) { return reflectance(lambda) * illuminant_d65()(lambda); };
    return xyz_from_spectrum(Spectrum::from_function(seen, Outside::kZero), observer);
}

std::string csv_of(const Observer& observer, const Matrix3& mixture, const char* header) {
    std::ostringstream csv;
    csv.precision(17);
    csv << header;
    for (std::size_t i = 0; i < observer.lambda_nm().size(); ++i) {
        const auto f = mixture * observer.responses()[i];
        csv << observer.lambda_nm()[i] << ',' << f[0] << ',' << f[1] << ',' << f[2] << '\n';
    }
    return csv.str();
}

TEST(Camera, EachCountsDaylightAsOneOneOne) {
    const double eye = xyz_from_spectrum(illuminant_d65(), Observer::cie1931()).y;
    EXPECT_EQ(all_cameras().size(), 19u);
    for (const Observer& camera : all_cameras()) {
        const Xyz seen = xyz_from_spectrum(illuminant_d65(), camera);
        EXPECT_NEAR(seen.x / eye, 1, 1e-12) << camera.name();
        EXPECT_NEAR(seen.y / eye, 1, 1e-12) << camera.name();
        EXPECT_NEAR(seen.z / eye, 1, 1e-12) << camera.name();
        EXPECT_EQ(camera.neutral(), Observer::cie1931().neutral()) << camera.name();
    }
}

// The source's numbers, of which only the common scale is gone.
TEST(Camera, UnbalancedItKeepsTheRatiosOfItsTable) {
    const Observer camera = Observer::by_name("Canon-EOS-5D")->unbalanced();
    const auto f = camera.at(400);
    EXPECT_NEAR(f[0] / f[1], 0.0006975715999999995 / 0.0018686632000000014, 1e-12);
    EXPECT_NEAR(f[2] / f[1], 0.010820649800000009 / 0.0018686632000000014, 1e-12);
    EXPECT_EQ(f[1], Observer::by_name("canon_eos_5d")->at(400)[1]);  // green decides the scale
}

TEST(Camera, TheMatrixMakesDaylightExactAndColorsNear) {
    const Xyz eye = xyz_from_spectrum(illuminant_d65(), Observer::cie1931());
    for (const Observer& camera : all_cameras()) {
        SCOPED_TRACE(camera.name());
        const Result<CameraFit> fit = fit_camera(camera);
        ASSERT_TRUE(fit);
        const auto white = fit->xyz_from_rgb * std::array<double, 3>{1, 1, 1};
        EXPECT_NEAR(white[0], eye.x / eye.y, 1e-12);
        EXPECT_NEAR(white[1], 1, 1e-12);
        EXPECT_NEAR(white[2], eye.z / eye.y, 1e-12);
        EXPECT_LT(fit->mean_difference, camera.name().starts_with("sigma") ? 4.0 : 2.0);
        EXPECT_GT(fit->mean_difference, 0.3);  // no camera is an eye
        EXPECT_GE(fit->largest_difference, fit->mean_difference);
    }
}

// No matrix that keeps white has a smaller sum of squares: steps that leave M (1,1,1) alone all lead uphill.
TEST(Camera, TheMatrixIsTheBestThatKeepsWhite) {
    const Observer camera = *Observer::by_name("nikon_d5100");
    const Matrix3 best = fit_camera(camera)->xyz_from_rgb;
    const auto squares = [&](const Matrix3& m) {
        double sum = 0;
        for (const Spectrum& patch : color_checker()) {
            const Xyz c = seen_under_d65(patch, camera), e = seen_under_d65(patch, Observer::cie1931());
            const auto seen = m * std::array{c.x, c.y, c.z};
            sum += (seen[0] - e.x) * (seen[0] - e.x) + (seen[1] - e.y) * (seen[1] - e.y) + (seen[2] - e.z) * (seen[2] - e.z);
        }
        return sum;
    };
    for (int row = 0; row < 3; ++row) {
        for (const std::array<double, 3>& step : {std::array{1e-3, -1e-3, 0.0}, std::array{0.0, 1e-3, -1e-3}}) {
            for (const double sign : {1.0, -1.0}) {
                Matrix3 other = best;
                for (int c = 0; c < 3; ++c) other.m[row][c] += sign * step[c];
                EXPECT_GT(squares(other), squares(best));
            }
        }
    }
}

TEST(Camera, AsAnEyeItSeesWhatTheMatrixMakesOfItsChannels) {
    const Observer camera = *Observer::by_name("nikon_d850");
    const Matrix3 m = fit_camera(camera)->xyz_from_rgb;
    const Observer eye = camera.as_eye(m);
    EXPECT_EQ(eye.kind(), ObserverKind::kEye);
    for (const Spectrum& patch : color_checker()) {
        const Xyz rgb = seen_under_d65(patch, camera), xyz = seen_under_d65(patch, eye);
        const auto expected = m * std::array{rgb.x, rgb.y, rgb.z};
        EXPECT_NEAR(xyz.x / expected[0], 1, 1e-9);
        EXPECT_NEAR(xyz.y / expected[1], 1, 1e-9);
        EXPECT_NEAR(xyz.z / expected[2], 1, 1e-9);
    }
}

// A camera whose curves are mixtures of the eye's (Luther's condition) is that eye.
TEST(Camera, ThatSeesWithMixturesOfTheEyesCurvesIsTheEye) {
    const Observer& cie = Observer::cie1931();
    const std::string csv = csv_of(cie, {{{{1.5, 0.25, 0.125}, {0.5, 2, 0.25}, {0, 0.25, 3}}}}, "wavelength_nm,r,g,b\n");
    const Observer camera = *Observer::from_csv(csv, "luther");
    const CameraFit fit = *fit_camera(camera);
    const Observer eye = camera.as_eye(fit.xyz_from_rgb);
    for (double lambda = 380; lambda <= 780; lambda += 2.5) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(eye.at(lambda)[c], cie.at(lambda)[c], 2e-6);
    }
    EXPECT_LT(fit.largest_difference, 1e-5);
}

TEST(Camera, OnlyColumnsCalledRgbAreACamera) {
    const Observer& cie = Observer::cie1931();
    EXPECT_EQ(Observer::from_csv(csv_of(cie, {}, ""), "plain")->kind(), ObserverKind::kEye);
    EXPECT_EQ(Observer::from_csv(csv_of(cie, {}, "nm,x,y,z\n"), "xyz")->kind(), ObserverKind::kEye);
    EXPECT_EQ(Observer::from_csv(csv_of(cie, {}, "nm,r,g,b\n"), "rgb")->kind(), ObserverKind::kCamera);
}

TEST(Camera, WhoseChannelsDoNotDifferHasNoMatrix) {
    const Observer grey =
        *Observer::from_csv(csv_of(Observer::cie1931(), {{{{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}}}, "nm,r,g,b\n"), "grey");
    EXPECT_THAT(fit_camera(grey).error().message, ::testing::HasSubstr("must differ"));
}

}  // namespace
}  // namespace latent::color
