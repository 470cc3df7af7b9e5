// Portals of infinite lights: directions, their density, and pictures. docs/rendering.md, "Lights".
#include "render/light/portal.h"

#include "tests/transport/chi_square.h"
#include "tests/transport/numbers.h"
#include "tests/transport/one_picture.h"

namespace latent::render::testing {
namespace {

// In the plane z = 1; its outside is +z.
const std::array<Vec3d, 4> kCorners = {Vec3d{-1, -1, 1}, {-1, 0.5, 1}, {2, 0.5, 1}, {2, -1, 1}};

// In cells of the rectangle, whose solid angles are integrated. The points are before it, beside it, close to it, and far away,
// where points are drawn by area.
TEST(Portal, DirectionsFollowTheirDensityAndLeaveByThePortal) {
    const Portal portal(kCorners);
    EXPECT_EQ(portal.outwards(), Vec3d(0, 0, 1));
    for (const Vec3f& from : {Vec3f(0, 0, 0), Vec3f(3, 1, -0.5f), Vec3f(0.5f, -0.2f, 0.6f), Vec3f(40, -30, -200)}) {
        SCOPED_TRACE(from.z);
        constexpr int kCells = 10, kFine = 40, kCount = 100'000;
        std::vector<double> expected(kCells * kCells, 0.0), counted(expected);
        const Vec3d x = (kCorners[3] - kCorners[0]) / kCells, y = (kCorners[1] - kCorners[0]) / kCells;
        double whole = 0;
        for (int i = 0; i < kCells; ++i) {
            for (int j = 0; j < kCells; ++j) {
                double& sum = expected[static_cast<std::size_t>(i * kCells + j)];
                for (int k = 0; k < kFine * kFine; ++k) {
                    const Vec3d p = kCorners[0] + x * (i + (k % kFine + 0.5) / kFine) + y * (j + (k / kFine + 0.5) / kFine),
                                to = p - Vec3d(from);
                    const Vec3f w(normalize(to));
                    ASSERT_TRUE(portal.shows(from, w));
                    const double d = length(to);
                    sum +=
                        static_cast<double>(portal.pdf_omega(from, w)) * to.z / (d * d * d) * length(cross(x, y)) / (kFine * kFine);
                }
                whole += sum;
                sum *= kCount;
            }
        }
        EXPECT_NEAR(whole, 1, 2e-4);
        Numbers number(7);
        for (int n = 0; n < kCount; ++n) {
            Vec3f w;
            const Uniform u = number(), v = number();
            ASSERT_TRUE(portal.sample(from, u, v, w));
            EXPECT_NEAR(length(w), 1, 1e-6);
            const Vec3d p = Vec3d(from) + Vec3d(w) * ((1 - static_cast<double>(from.z)) / static_cast<double>(w.z));
            const auto cell = [&](double at, double low, double size) {
                EXPECT_GE(at, low - 1e-4);
                EXPECT_LE(at, low + size + 1e-4);
                return std::clamp(static_cast<int>((at - low) / size * kCells), 0, kCells - 1);
            };
            ++counted[static_cast<std::size_t>(cell(p.x, -1, 3) * kCells + cell(p.y, -1, 1.5))];
        }
        expect_counts_follow(counted, expected);
    }
}

TEST(Portal, ItsBackIsDark) {
    const Portal portal(kCorners);
    Vec3f w;
    EXPECT_FALSE(portal.sample({0, 0, 2}, {}, {}, w));
    EXPECT_EQ(portal.pdf_omega({0, 0, 2}, {0, 0, 1}), 0);
    EXPECT_FALSE(portal.shows({0, 0, 2}, {0, 0, 1}));
    EXPECT_FALSE(portal.shows({0, 0, 0}, {0, 0, -1}));
    EXPECT_TRUE(portal.shows({0, 0, 0}, {0, 0, 1}));
    EXPECT_FALSE(portal.shows({0, 0.6f, 0}, {0, 0, 1}));
    EXPECT_TRUE(portal.is_crossed({0, 0, 2}, {0, 0, 1}));
}

// Beside a window of 1 x 1 in the plane z = 2, through which the sun of the sky does not shine: it would leave what it lights but
// rarely with errors that 8 pictures cannot tell.
std::string room(const std::string& camera, const std::string& light, const std::string& walls) {
    return "Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 32\nIntegrator \"bdpt\" \"integer maxdepth\" 3\n" +
           camera + "WorldBegin\nAttributeBegin\nRotate 120 1 0 0\n" + light +
           "AttributeEnd\nMaterial \"diffuse\" \"rgb reflectance\" [.7 .6 .5]\n" + walls +
           "AttributeBegin\nTranslate .6 .4 .3\nMaterial \"diffuse\" \"rgb reflectance\" [.3 .5 .8]\nShape \"sphere\" \"float "
           "radius\" "
           ".4\nAttributeEnd\n";
}
const std::string kWindow = " \"point3 portal\" [-.5 .5 2  -.5 1.5 2  .5 1.5 2  .5 .5 2]";
// The cube from (-2, 0, -2) to (2, 2, 2), with the window in its wall z = 2.
std::string cube() {
    std::string text;
    const auto patch = [&](const std::string& points) { text += "Shape \"bilinearmesh\" \"point3 P\" [" + points + "]\n"; };
    patch("-2 0 -2  2 0 -2  -2 0 2  2 0 2");
    patch("-2 2 -2  2 2 -2  -2 2 2  2 2 2");
    patch("-2 0 -2  -2 2 -2  -2 0 2  -2 2 2");
    patch("2 0 -2  2 2 -2  2 0 2  2 2 2");
    patch("-2 0 -2  2 0 -2  -2 2 -2  2 2 -2");
    patch("-2 0 2  -.5 0 2  -2 2 2  -.5 2 2");
    patch(".5 0 2  2 0 2  .5 2 2  2 2 2");
    patch("-.5 0 2  .5 0 2  -.5 .5 2  .5 .5 2");
    patch("-.5 1.5 2  .5 1.5 2  -.5 2 2  .5 2 2");
    return text;
}
const std::string kSky = "LightSource \"infinite\" \"string filename\" \"sky.exr\"", kWhite = "LightSource \"infinite\"";
const std::string kInside = "LookAt -1.5 1.2 -1.6  .3 .7 1  0 1 0\nCamera \"perspective\" \"float fov\" 75\n";

TEST(PortalLight, APortalOverTheOnlyOpeningChangesNothing) {
    for (const std::string& light : {kSky, kWhite}) {
        SCOPED_TRACE(light);
        const Scene open = scene_under_sky(room(kInside, light + "\n", cube())),
                    portal = scene_under_sky(room(kInside, light + kWindow + "\n", cube()));
        const Estimate with = picture_of(portal, {.kind = IntegratorKind::kPath, .seed = 1}, 8192),
                       without = picture_of(open, {.kind = IntegratorKind::kPath, .seed = 50}, 65536);
        expect_same(with, without);
        double error = 0, error_without = 0;  // of as many samples
        for (std::size_t b = 0; b < 64; ++b)
            error += with.error.xyz[b][1], error_without += without.error.xyz[b][1] * std::sqrt(8.0);
        EXPECT_LT(error, error_without);
    }
}

// From inside, and from outside: what is outside of the portal stays dark, unless light comes back through it.
TEST(PortalLight, PathAndBdptMakeOnePicture) {
    const std::string outside =
        "LookAt 3 2 4.5  0 .5 1  0 1 0\nCamera \"perspective\" \"float fov\" 60 \"float lensradius\" .2 \"float focaldistance\" "
        "4\n";
    const std::string floor =
        "Shape \"bilinearmesh\" \"point3 P\" [-4 0 -4  4 0 -4  -4 0 6  4 0 6]\nShape \"bilinearmesh\" \"point3 P\" [-4 0 "
        "-1  4 0 -1  -4 3 -1  4 3 -1]\n";
    for (const std::string& light : {kSky, kWhite}) {
        SCOPED_TRACE(light);
        expect_agreement(scene_under_sky(room(kInside, light + kWindow + "\n", cube())), 8192);
        expect_agreement(scene_under_sky(room(outside, light + kWindow + "\n", floor)), 8192);
    }
}

// What comes in is pi times radiance and area, in rays from outside.
TEST(PortalLight, ItsRaysCarryWhatThePortalLetsIn) {
    const Scene scene = scene_from(room(kInside, kWhite + kWindow + "\n", cube()));
    const std::unique_ptr<World> world = scene.world();
    const Light& light = world->lights()[0];
    Numbers number(3);
    double sum = 0, squares = 0;
    constexpr int kCount = 200'000;
    for (int n = 0; n < kCount; ++n) {
        LightRay ray;
        const Uniform u = number(), v = number(), s = number(), t = number();
        light.sample_ray(u, v, s, t, ray);
        EXPECT_LT(ray.d.z, 0);
        const double flux = static_cast<double>(ray.profile / (ray.pdf_position * ray.pdf_direction));
        sum += flux;
        squares += flux * flux;
    }
    const double mean = sum / kCount, error = std::sqrt((squares / kCount - mean * mean) / kCount);
    EXPECT_NEAR(mean, std::numbers::pi, 5 * error);
}

}  // namespace
}  // namespace latent::render::testing
