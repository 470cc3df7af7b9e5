// Light whose amount is known exactly, where single precision or few random bits would spoil it. bench/closed_forms has larger
// sizes.
#include "tests/transport/closed_forms.h"

#include "tests/transport/picture_mean.h"

namespace latent::render::testing {
namespace {

// Fails unless Y of the picture is within `tolerance` of what it should be, by path and by bdpt.
void expect_exact(ClosedForm form, std::uint64_t samples, double tolerance) {
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        SCOPED_TRACE(form.name + (kind == IntegratorKind::kPath ? ", path" : ", bdpt"));
        form.settings.kind = kind;
        form.settings.seed = 5;
        EXPECT_NEAR(mean_of_picture(form.scene, form.settings, samples).xyz[1], form.y, tolerance * form.y);
    }
}

ClosedForm by_halton(ClosedForm form) {
    form.settings.positions.sampler = sampledb::PositionSampler::kHalton23;
    return form;
}

// One sample in 201 draws a point of the lamp. Its choice is spread out: 200,000 samples have a standard deviation of 0.3 %.
TEST(ClosedForms, ALampOfManyTrianglesShinesWhateverElseThereIsToChoose) {
    for (const std::uint32_t triangles : {1024u, 16'384u, 131'072u}) {
        expect_exact(lamp_among_large_triangles(triangles), 200'000, 0.012);
    }
    for (const double distance : {1e4, 1e5, 1e6}) expect_exact(lamp_among_large_triangles(1024, distance), 200'000, 0.012);
}

TEST(ClosedForms, ALidKeepsOffTheLightHoweverNearTheLampItIs) {
    for (const double gap : {9e-4, 1e-4, 2e-5}) expect_exact(lamp_behind_lid(gap), 20'000, 0);
}

TEST(ClosedForms, ALampIsInTheWayOfItselfFromNowhere) {
    for (const double distance : {1.0, 1e3, 1e5}) {
        for (const double cosine : {1.0, 0.1, 0.01}) expect_exact(lamp_far_away(distance, cosine), 20'000, 1e-3);
    }
}

// Alone, the pool and the beam of a spot have all of its power, however narrow it is.
TEST(ClosedForms, ANarrowSpotHasItsPower) {
    for (const double degrees : {20.0, 0.5, 0.1, 0.01}) expect_exact(narrow_spot(degrees), 200'000, 1e-3);
    for (const double degrees : {0.5, 0.1, 0.01}) expect_exact(narrow_beam(degrees), 200'000, 3e-3);
}

// Pixels about the poles of the map and elsewhere, the poles upright and at 50 degrees from that. Halton's numbers are spread over
// the whole film, so that fewer samples tell its mean.
TEST(ClosedForms, AnyPixelOfAnInfiniteLightIsAsBrightAsItIs) {
    for (const std::string rotation : {"", "Rotate 50 1 2 0"}) {
        for (const std::uint32_t x : {1023u, 1024u})
            expect_exact(by_halton(infinite_light_of_one_pixel(2048, x, 1024, rotation)), 20'000, 3e-4);
        expect_exact(by_halton(infinite_light_of_one_pixel(2048, 1300, 900, rotation)), 20'000, 3e-4);
    }
    for (const std::string rotation : {"Rotate 180 1 2 0", "Rotate 130 1 2 0"}) {
        expect_exact(by_halton(infinite_light_of_one_pixel(2048, 0, 0, rotation)), 20'000, 3e-4);
        expect_exact(by_halton(infinite_light_of_one_pixel(2048, 1, 2046, rotation)), 20'000, 3e-4);
    }
}

}  // namespace
}  // namespace latent::render::testing
