// Laws of cameras: a ray and the way back agree, and the density of rays is the Jacobian of that map.
#include "render/camera/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/transport/chi_square.h"
#include "tests/transport/numbers.h"

namespace latent::render::testing {
namespace {

struct CameraCase {
    std::string name;
    CameraDescription description;
};

std::vector<CameraCase> cameras() {
    CameraDescription d;
    const Vec3d z = normalize(Vec3d{0.3, -0.2, 1}), x = normalize(cross(Vec3d{0, 1, 0}, z)), y = cross(z, x);
    d.world_from_camera = Affined(x, y, z, {1, 2, -3});
    d.x0 = -0.8, d.x1 = 0.7, d.y0 = -0.5, d.y1 = 0.55;
    std::vector<CameraCase> list{{"pinhole", d}};
    d.lens_radius = 0.3, d.focal_distance = 4;
    list.push_back({"thin lens", d});
    d.world_from_camera.x = -d.world_from_camera.x;
    list.push_back({"thin lens, mirrored", d});
    d.world_from_camera = Affined(x * 2, y * 2, z * 2, {1, 2, -3});
    d.lens_radius = 0;
    d.kind = CameraKind::kOrthographic;
    list.push_back({"orthographic, scaled", d});
    d.kind = CameraKind::kSpherical;
    list.push_back({"equal-area", d});
    d.mapping = SphericalMapping::kEquirectangular;
    list.push_back({"equirectangular", d});
    return list;
}

TEST(Camera, APointOnARayIsSeenWhereTheRayStarted) {
    for (const CameraCase& c : cameras()) {
        SCOPED_TRACE(c.name);
        const Camera camera = *Camera::make(c.description);
        Numbers number(1);
        for (int n = 0; n < 2000; ++n) {
            const float u = number(), v = number(), s = number(), t = number();
            Vec3f o, d;
            camera.ray(static_cast<double>(u), static_cast<double>(v), camera.lens_point(s, t), o, d);
            const float distance = 0.5f + 8 * number();
            CameraPoint point;
            ASSERT_TRUE(camera.connect(o + d * distance, s, t, point)) << u << " " << v;
            EXPECT_NEAR(point.u, u, 2e-5);
            EXPECT_NEAR(point.v, v, 2e-5);
            EXPECT_NEAR(point.distance, distance, 1e-4);
            EXPECT_NEAR(dot(point.w, d), 1, 1e-5);
            if (camera.has_lens()) {
                // The same ray, backwards, falls through the lens onto the same point of the film.
                CameraPoint hit;
                ASSERT_TRUE(camera.hit_lens(o + d * distance, -d, 2 * distance, hit));
                EXPECT_NEAR(hit.u, u, 1e-4);
                EXPECT_NEAR(hit.v, v, 1e-4);
                EXPECT_NEAR(hit.lens.x, camera.lens_point(s, t).x, 1e-3);
                EXPECT_NEAR(hit.lens.y, camera.lens_point(s, t).y, 1e-3);
                EXPECT_NEAR(hit.jacobian, point.jacobian, 1e-4f * point.jacobian);
                EXPECT_FALSE(camera.hit_lens(o + d * distance, -d, distance * 0.99f, hit));
                EXPECT_FALSE(camera.hit_lens(o - d * distance, d, 2 * distance, hit));  // from behind
            }
        }
    }
}

// Rays leave the lens evenly, by area: cells of 8 rings and 16 sectors.
TEST(Camera, RaysStartEvenlyOnTheLens) {
    for (const CameraCase& c : cameras()) {
        const Camera camera = *Camera::make(c.description);
        if (!camera.has_lens()) continue;
        SCOPED_TRACE(c.name);
        constexpr int kRings = 8, kSectors = 16, kCount = 100'000;
        const double radius = std::sqrt(static_cast<double>(camera.lens_area()) / std::numbers::pi);
        const Frame lens = Frame::from_z(camera.axis());
        std::vector<double> counted(static_cast<std::size_t>(kRings * kSectors));
        Numbers number(3);
        for (int n = 0; n < kCount; ++n) {
            const float s = number(), t = number();
            Vec3f o, d;
            camera.ray(0.3, 0.6, camera.lens_point(s, t), o, d);
            const Vec3f from_center = o - camera.center();
            const double x = static_cast<double>(dot(from_center, lens.x)) / radius,
                         y = static_cast<double>(dot(from_center, lens.y)) / radius;
            ASSERT_NEAR(static_cast<double>(dot(from_center, camera.axis())), 0, 1e-6);
            ASSERT_LE(x * x + y * y, 1 + 1e-5);
            const int ring = std::min(static_cast<int>((x * x + y * y) * kRings), kRings - 1);
            const int sector = static_cast<int>((std::atan2(y, x) / (2 * std::numbers::pi) + 0.5) * kSectors) % kSectors;
            ++counted[static_cast<std::size_t>(ring * kSectors + sector)];
        }
        double chi2 = 0;
        constexpr double kExpected = static_cast<double>(kCount) / (kRings * kSectors);
        for (const double count : counted) chi2 += (count - kExpected) * (count - kExpected) / kExpected;
        EXPECT_GT(chi_square_tail(chi2, kRings * kSectors - 1), 1e-4) << chi2;
    }
}

// d(u, v) / d omega (orthographic: per area) by finite differences, with the lens point kept.
TEST(Camera, JacobianIsThatOfTheMap) {
    for (const CameraCase& c : cameras()) {
        SCOPED_TRACE(c.name);
        const Camera camera = *Camera::make(c.description);
        Numbers number(2);
        for (int n = 0; n < 500; ++n) {
            const double u = 0.05 + 0.9 * static_cast<double>(number()), v = 0.05 + 0.9 * static_cast<double>(number()), h = 2e-3;
            const float s = number(), t = number();
            const auto at = [&](double a, double b) {
                Vec3f o, d;
                camera.ray(a, b, camera.lens_point(s, t), o, d);
                return Vec3d(camera.parallel() ? o : d);
            };
            const Vec3d du = (at(u + h, v) - at(u - h, v)) / (2 * h), dv = (at(u, v + h) - at(u, v - h)) / (2 * h);
            if (c.name == "equal-area" && (std::abs(std::abs(u - 0.5) + std::abs(v - 0.5) - 0.5) < 0.01 ||
                                           std::abs(u - 0.5) < 0.01 || std::abs(v - 0.5) < 0.01)) {
                continue;  // the map has creases
            }
            Vec3f o, d;
            camera.ray(u, v, camera.lens_point(s, t), o, d);
            EXPECT_NEAR(static_cast<double>(camera.jacobian(d)) * length(cross(du, dv)), 1, 5e-3) << u << " " << v;
        }
    }
}

TEST(Camera, RefusesWhatItCannotMap) {
    CameraDescription d;
    d.world_from_camera.x = {2, 0, 0};
    EXPECT_FALSE(Camera::make(d));
    d.world_from_camera.x = {1, 0, 0};
    d.kind = CameraKind::kOrthographic;
    d.lens_radius = 0.1;
    EXPECT_FALSE(Camera::make(d));
}

}  // namespace
}  // namespace latent::render::testing
