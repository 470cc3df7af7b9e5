// Light that wanders below a surface: a ball of it in an even light gives back what its reflectance says.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "render/bsdf/fresnel.h"
#include "tests/transport/picture_mean.h"

namespace latent::render::testing {
namespace {

// The whole ball, in a film that it touches.
Scene scene_of_ball(const std::string& material) {
    return scene_from(
        "LookAt 0 0 -3  0 0 0  0 1 0\nCamera \"orthographic\" \"float screenwindow\" [-1 1 -1 1]\n"
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nWorldBegin\n"
        "LightSource \"infinite\" \"spectrum L\" [360 1 830 1]\nMaterial \"subsurface\" " +
        material + "\nShape \"sphere\"\n");
}

// Share of the light from everywhere that the ball gives back. The background has the radiance 1, and pi / 4 of the film is the
// ball.
struct Albedo {
    double value, error;
};
Albedo albedo_of(const std::string& material, IntegratorKind kind, std::uint64_t samples) {
    const Scene scene = scene_of_ball(material);
    EXPECT_EQ(scene.description.max_depth, kUnlimited);
    const Mean mean = mean_of_picture(scene, {.kind = kind, .max_depth = kUnlimited, .seed = 1}, samples);
    return {1 - (1 - mean.xyz[1]) * 4 / std::numbers::pi, mean.error[1] * 4 / std::numbers::pi};
}

// Within 4.5 standard errors, which are small.
void expect_albedo(const std::string& material, double expected, double tolerance) {
    const Albedo albedo = albedo_of(material, IntegratorKind::kPath, 30'000);
    EXPECT_NEAR(albedo.value, expected, tolerance + 4.5 * albedo.error) << material;
    EXPECT_LT(albedo.error, 0.015) << material;
}

// What a surface reflects of light from everywhere outside.
double outer_reflectance(double eta) {
    double sum = 0;
    constexpr int kSteps = 1000;
    for (int i = 0; i < kSteps; ++i) {
        const double mu = (i + 0.5) / kSteps;
        sum += 2 * mu * static_cast<double>(fresnel_dielectric(static_cast<float>(mu), static_cast<float>(eta))) / kSteps;
    }
    return sum;
}

// The share F that the surface itself reflects, and A of the rest. The fit of A holds to a few percent.
TEST(Subsurface, GivesBackItsReflectance) {
    for (const double eta : {1.0, 1.33}) {
        for (const double reflectance : {0.2, 0.5, 0.8}) {
            const double surface = eta > 1 ? outer_reflectance(eta) : 0;
            expect_albedo(
                fmt::format("\"float eta\" {0} \"spectrum reflectance\" [360 {1} 830 {1}] \"float scale\" .01", eta, reflectance),
                surface + (1 - surface) * reflectance, 0.05 * reflectance);
        }
    }
}

// What absorbs nothing gives everything back, whatever it scatters like: also after many hundreds of scatterings.
TEST(Subsurface, LosesNothingThatItDoesNotAbsorb) {
    for (const char* material :
         {"\"string name\" \"Spectralon\" \"float scale\" .2",
          "\"spectrum sigma_a\" [360 0 830 0] \"spectrum sigma_s\" [360 15 830 15]",
          "\"spectrum sigma_a\" [360 0 830 0] \"spectrum sigma_s\" [360 9 830 9] \"float g\" .7 \"float eta\" 1.5"})
        expect_albedo(material, 1, 0.002);
}

TEST(Subsurface, BothKindsOfSubpathAgree) {
    const std::string material = "\"spectrum reflectance\" [360 .5 830 .5] \"float scale\" .3";
    const Albedo path = albedo_of(material, IntegratorKind::kPath, 30'000),
                 bdpt = albedo_of(material, IntegratorKind::kBdpt, 60'000);
    EXPECT_NEAR(bdpt.value, path.value, 4.5 * std::hypot(path.error, bdpt.error));
    EXPECT_LT(bdpt.error, 0.02);
}

// `scale` lengthens the mean free path. As long as that is short, it does not matter.
TEST(Subsurface, AThinBallLetsLightThroughThatAThickOneReturns) {
    const auto luminance = [](double scale) {
        const Scene scene = scene_of_ball(fmt::format("\"spectrum reflectance\" [360 .3 830 .3] \"float scale\" {}", scale));
        return mean_of_picture(scene, {.max_depth = kUnlimited, .seed = 1}, 4'000);
    };
    const Mean thick = luminance(0.02), thicker = luminance(0.01), thin = luminance(20);
    EXPECT_NEAR(thick.xyz[1], thicker.xyz[1], 0.01 + 4.5 * std::hypot(thick.error[1], thicker.error[1]));
    EXPECT_GT(thin.xyz[1], thick.xyz[1] + 0.2);
}

TEST(Subsurface, MeasuredMatterIsAbsorbedByItsNameAndScale) {
    const auto medium = [](const std::string& material) { return scene_of_ball(material).description.media.at(0); };
    const MediumDescription skin = medium("\"string name\" \"Skin1\" \"float scale\" 10"), milk = medium("");
    EXPECT_EQ(skin.scale, 10);
    EXPECT_GT(skin.sigma_a(450), 3 * skin.sigma_a(650));
    EXPECT_LT(milk.sigma_a(550), 0.01);
    EXPECT_NEAR(milk.sigma_s(550), 3.2, 0.3);
}

}  // namespace
}  // namespace latent::render::testing
