// Chromatic aberration (docs/scenes.md, "Extensions"): where each wavelength of a sample falls, and that both integrators agree.
#include <cmath>

#include "tests/transport/numbers.h"
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

std::string through_lens(const std::string& lens, const std::string& world) {
    return "LookAt 0 -3 1.2  0 0 .3  0 0 1\nCamera \"perspective\" \"float fov\" 50 \"float frameaspectratio\" 1 " + lens +
           "\nIntegrator \"path\" \"integer maxdepth\" 3\nWorldBegin\n" + world;
}
const std::string kSplit = "\"float lensradius\" .15 \"float latent:focaldistances\" [ 2 4 ]";
const std::string kSky = "LightSource \"infinite\" \"spectrum L\" [360 1 830 1]\n";

sampledb::Records records_of(const Scene& scene, IntegratorSettings settings, std::uint64_t samples) {
    const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
    sampledb::Records out;
    RadianceFaults faults;
    for (std::uint64_t n = 0; n < samples; ++n) integrator->trace(n, out, faults);
    EXPECT_EQ(faults.total(), 0u);
    return out;
}

// A point in focus in one wavelength is seen there through every point of the lens in that wavelength, and nowhere else in others.
TEST(ChromaticAberration, EachWavelengthIsInFocusAtItsOwnDistance) {
    const Camera camera = *Camera::make(scene_from(through_lens(kSplit, kSky)).description.camera);
    ASSERT_TRUE(camera.splits_wavelengths());
    Numbers number(5);
    for (const double lambda : {360.0, 450.0, 595.0, 830.0}) {
        const auto focal = static_cast<float>(2 + 2 * (lambda - 360) / 470);
        const Vec3f p = camera.center() + normalize(camera.axis() + Vec3f{0.1f, 0, 0.05f}) * focal;
        const Vec3f in_focus = camera.center() + (p - camera.center()) * (focal / dot(p - camera.center(), camera.axis()));
        const auto place = [&](float s, float t, double nm) {
            CameraPoint point;
            EXPECT_TRUE(camera.connect(in_focus, s, t, point));
            const Vec2f spread = camera.spread(point.lens);
            return Vec2f{point.u + spread.x * static_cast<float>(camera.defocus(nm)),
                         point.v + spread.y * static_cast<float>(camera.defocus(nm))};
        };
        const Vec2f centre = place(0.5f, 0.5f, lambda);
        for (int i = 0; i < 100; ++i) {
            const float s = number(), t = number();
            const Vec2f here = place(s, t, lambda), other = place(s, t, lambda < 600 ? 830 : 360);
            EXPECT_NEAR(here.x, centre.x, 1e-5);
            EXPECT_NEAR(here.y, centre.y, 1e-5);
            const Vec2f spread = camera.spread(camera.lens_point(s, t));
            if (std::hypot(spread.x, spread.y) > 0.02f) {
                EXPECT_GT(std::hypot(other.x - centre.x, other.y - centre.y), 5e-4f);
            }
        }
    }
}

// Under an even sky every wavelength is as bright everywhere, at the edges too: k records of a sample, with a share of 1 / k each.
TEST(ChromaticAberration, EveryWavelengthIsSpreadEvenlyOverTheFilm) {
    const Scene scene = scene_from(through_lens(kSplit, kSky));
    constexpr std::uint64_t kSamples = 3 * 4096;
    const sampledb::Records r = records_of(scene, {.seed = 2}, kSamples);
    ASSERT_EQ(r.size(), 28 * kSamples);
    std::vector<double> bands(3 * 64);  // shares: a third of the wavelengths, a cell of 8 x 8
    for (std::size_t i = 0; i < r.size(); ++i) {
        ASSERT_EQ(r.pairs[i], 1);
        ASSERT_LT(r.index[i], 28);
        ASSERT_EQ(r.share[i], 1 / 28.0f);
        const std::size_t cell = (r.v[i] >> 29) * 8 + (r.u[i] >> 29), band = r.index[i] < 9 ? 0 : r.index[i] < 19 ? 1 : 2;
        bands[band * 64 + cell] += static_cast<double>(r.share[i]);
    }
    for (std::size_t band = 0; band < 3; ++band) {
        const double expected = static_cast<double>(kSamples) / 64 * (band == 1 ? 10 : 9) / 28;
        // Positions are more even than random ones; nine wavelengths of a sample lie together.
        for (std::size_t cell = 0; cell < 64; ++cell)
            EXPECT_NEAR(bands[band * 64 + cell] / expected, 1, 4.5 / std::sqrt(static_cast<double>(kSamples) / 64)) << cell;
    }
}

TEST(ChromaticAberration, ALensWithOneFocalDistanceKeepsItsRecords) {
    const std::string world = kSky + "Material \"diffuse\"\nShape \"sphere\" \"float radius\" .5\n";
    const Scene one = scene_from(through_lens("\"float lensradius\" .15 \"float focaldistance\" 3", world)),
                both = scene_from(through_lens("\"float lensradius\" .15 \"float latent:focaldistances\" [ 3 3 ]", world));
    const sampledb::Records a = records_of(one, {.kind = IntegratorKind::kBdpt}, 500),
                            b = records_of(both, {.kind = IntegratorKind::kBdpt}, 500);
    EXPECT_EQ(a.u, b.u);
    EXPECT_EQ(a.power, b.power);
    EXPECT_EQ(a.share, b.share);
    // A pinhole is in focus everywhere.
    const Scene pinhole = scene_from(through_lens("\"float latent:focaldistances\" [ 2 4 ]", world));
    EXPECT_EQ(records_of(pinhole, {}, 100).size(), 100u);
    const auto refused = load(through_lens("\"float latent:focaldistances\" [ 2 0 ]", world));
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("latent:focaldistances: both distances must be between"), std::string::npos);
}

// A lamp beyond the left edge of the picture, as the others of this list: what leaves the film in one wavelength may enter in
// another.
TEST(ChromaticAberration, PathAndBdptMakeOnePicture) {
    const std::string floor =
        "Material \"diffuse\" \"rgb reflectance\" [.5 .4 .3]\nShape \"trianglemesh\" \"point3 P\" "
        "[-4 -4 -.8  4 -4 -.8  4 4 -.8  -4 4 -.8] \"integer indices\" [0 1 2 0 2 3]\n";
    const std::string lamp =
        "Translate -.9 .3 .4\nRotate 90 1 .3 0\nAreaLightSource \"diffuse\" \"blackbody L\" 4000 \"float scale\" 6 "
        "\"bool twosided\" true\nShape \"disk\" \"float radius\" .4\n";
    for (const std::string& rest : {floor + lamp, floor +
                                                      "Material \"dielectric\" \"spectrum eta\" \"glass-SF11\"\n"
                                                      "Shape \"sphere\" \"float radius\" .5\nMaterial \"diffuse\"\n" +
                                                      lamp}) {
        SCOPED_TRACE(rest);
        expect_path_and_bdpt_agree(
            scene_from(through_lens("\"float lensradius\" .3 \"float latent:focaldistances\" [ 1.5 5 ]", kSky + rest)), 4096, 3072);
    }
}

}  // namespace
}  // namespace latent::render::testing
