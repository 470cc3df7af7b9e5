// Tubes about curves: rays hit them where their definition says, and start and end clear of them.
#include "render/geometry/tube.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/render/built_geometry.h"

namespace latent::render {
namespace {

using testing::build;
using testing::Built;
using testing::first_hit;
using testing::Random;
using testing::share_passed;

constexpr const char* kBent =
    "Shape \"curve\" \"string type\" \"cylinder\" \"string basis\" \"bspline\" "
    "\"point3 P\" [-3 0 0  -2 .4 .1  -1 -.3 .2  0 .3 -.2  1 -.3 0  2 .2 .3  3 0 0] \"float width0\" .3 \"float width1\" .1\n";
constexpr const char* kStraight =
    "Shape \"curve\" \"string type\" \"cylinder\" \"point3 P\" [-3 0 0  -1 0 0  1 0 0  3 0 0] \"float width\" 1\n";

const MeshDescription& mesh_of(const Built& scene) { return *scene.description.shapes.at(0).mesh; }

// The point at (u, v), from the definition.
Vec3d point_at(const Tube& tube, double u, double v) {
    const auto direction = [&](double at) { return normalize(tangent_at(tube.axis, at)); };
    const Vec3d d = direction(u), x = turned(tube.seam, direction(0), d), y = cross(d, x);
    const double a = 2 * std::numbers::pi * v;
    return point_on(tube.axis, u) + (x * std::cos(a) + y * std::sin(a)) * tube.radius(u);
}

// How far the ray's line is from the axis, in radii there, at the closest.
double distance_in_radii(const MeshDescription& mesh, const Ray& ray) {
    double least = kInfinity;
    for (std::uint32_t segment = 0; segment < mesh.indices.size(); ++segment) {
        const Tube tube = tube_of(mesh, segment);
        for (int i = 0; i <= 200; ++i) {
            const double u = i / 200.0;
            const Vec3d to = point_on(tube.axis, u) - Vec3d(ray.o), d = normalize(Vec3d(ray.d));
            if (dot(to, d) > 0) least = std::min(least, length(to - d * dot(to, d)) / tube.radius(u));
        }
    }
    return least;
}

TEST(Tubes, AreMetByTheRaysThatComeCloserThanTheRadius) {
    for (const char* simd : {"sse4.2", "best"}) {
        const Built scene = build(kBent, choose_simd(simd).value());
        Random random;
        int met = 0, passed = 0;
        for (int i = 0; i < 10000; ++i) {
            const Vec3f to{random(-.8f, .8f), random(-.4f, .4f), random(-.4f, .4f)};
            const Vec3f from = to + random.direction() * 5.0f;
            const Ray towards{from, normalize(to - from)};
            if (std::abs(towards.d.x) > 0.7f) continue;  // through the open ends, it may be
            const double distance = distance_in_radii(mesh_of(scene), towards);
            const auto hit = first_hit(*scene.geometry, towards);
            EXPECT_EQ(share_passed(*scene.geometry, towards), hit ? 0 : 1);
            if (distance > 1.001) {
                EXPECT_FALSE(hit) << distance;
                ++passed;
            } else if (distance < 0.999) {
                ASSERT_TRUE(hit) << distance;
                ++met;
            }
            if (!hit) continue;
            // On the surface, on the ray, from outside.
            const Tube tube = tube_of(mesh_of(scene), hit->on.primitive);
            const double u = static_cast<double>(hit->on.uv.x);
            const Vec3d out = Vec3d(hit->p) - point_on(tube.axis, u), d = normalize(tangent_at(tube.axis, u));
            EXPECT_NEAR(length(out), tube.radius(u), 1e-6);
            EXPECT_NEAR(dot(out, d), 0, 1e-5);
            EXPECT_LT(length(Vec3d(towards.o) + Vec3d(towards.d) * hit->t - Vec3d(hit->p)), 5e-6);
            EXPECT_LT(dot(hit->ng, towards.d), 1e-3f);
            EXPECT_EQ(hit->ns, hit->ng);
        }
        EXPECT_GT(met, 500);
        EXPECT_GT(passed, 500);
    }
}

// Embree's own bound on its error depends on the unit: where numbers are large, it finds a surface beside the tube.
TEST(Tubes, HaveNothingBesideThemWhateverUnitsTheyAreModelledIn) {
    const auto curve = [](double unit) {
        std::string text = "Shape \"curve\" \"string type\" \"cylinder\" \"point3 P\" [ ";
        for (const double x : {-.8, .2, 0., -.2, 2.2, .4, -.6, -1., .3, 0., 1.2, 0.}) text += fmt::format("{} ", x * unit);
        return text + fmt::format("] \"float width0\" {} \"float width1\" {}\n", .2 * unit, .05 * unit);
    };
    const Built direct = build(curve(1));
    const Tube tube = tube_of(mesh_of(direct), 0);
    for (const double unit : {1e-2, 1.0, 1e2, 1e4}) {
        const Built scene = build("ObjectBegin \"o\"\n" + curve(unit) +
                                  fmt::format("ObjectEnd\nScale {0} {0} {0}\nObjectInstance \"o\"\n", 1 / unit));
        Random random;
        int passed = 0, phantoms = 0;
        for (int i = 0; i < 30000; ++i) {
            const double u = static_cast<double>(random(0, 1));
            const Vec3f on(point_at(tube, u, static_cast<double>(random(0, 1)))),
                out = normalize(on - Vec3f(point_on(tube.axis, u)));
            const Vec3f d = random.about(out, 0);
            const Ray ray{on + out * random(0, .05f) - d * 5.0f, d};
            if (distance_in_radii(mesh_of(direct), ray) < 1.03) continue;
            ++passed;
            phantoms += share_passed(*scene.geometry, ray) < 1 ? 1 : 0;
        }
        EXPECT_GT(passed, 3000);
        EXPECT_EQ(phantoms, 0) << unit;
    }
}

// At every scale, far from the origin, towards grazing angles: what leaves a straight tube has left it, what goes inside is inside.
TEST(Tubes, RaysStartClearOfThem) {
    for (const char* place :
         {"", "Translate 100 -30 1000\n", "Scale .001 .001 .001\n", "Translate 1 2 -1\nScale .0001 .0001 .0001\n"}) {
        SCOPED_TRACE(place);
        const Built scene = build(place + std::string(kStraight));
        const Geometry& g = *scene.geometry;
        const float size = g.radius() / 3;
        Random random;
        int hits = 0, traps = 0, leaks = 0;
        for (int i = 0; i < 6000; ++i) {
            const Vec3f middle = g.center() + Vec3f{random(-1, 1) * size, 0, 0};
            const Vec3f start = middle + normalize(Vec3f{0, random(-1, 1), random(-1, 1)}) * (2 * size);
            const auto on = first_hit(g, {start, normalize(middle - start + random.vector(.1f * size))});
            if (!on) continue;
            ++hits;
            const float cosine = i % 2 == 0 ? random(0.01f, 1) : std::exp(random(-9, 0));
            const Vec3f out = random.about(on->ng, cosine);
            traps += share_passed(g, spawn_ray(on->interaction(), out)) < 1 ? 1 : 0;
            // Not along the tube, whose ends are open.
            if (std::abs(out.x) < 0.5f) leaks += first_hit(g, spawn_ray(on->interaction(), -out)) ? 0 : 1;
        }
        EXPECT_GT(hits, 4000);
        EXPECT_EQ(traps, 0);
        EXPECT_EQ(leaks, 0);
    }
}

TEST(Tubes, ConnectionsEndOnThem) {
    const Built scene = build("Translate 1 -3 10\n" + std::string(kStraight));
    const Geometry& g = *scene.geometry;
    Random random;
    for (const float distance : {0.1f, 1.5f, 10.0f, 1e3f, 1e5f}) {
        int connections = 0, hidden = 0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3f inside = g.center() + Vec3f{random(-1, 1), 0, 0};
            const auto hit = first_hit(g, {inside, normalize(Vec3f{0, random(-1, 1), random(-1, 1)})});
            ASSERT_TRUE(hit);
            const float cosine = i % 2 == 0 ? random(0.01f, 1) : std::exp(random(-9, 0));
            const Interaction camera{hit->p + random.about(hit->ng, cosine) * distance, 0, {}};
            if (dot(normalize(camera.p - hit->p), hit->ng) < 1e-4f) continue;
            ++connections;
            hidden += share_passed(g, spawn_ray(camera, hit->interaction())) < 1 ||
                      share_passed(g, spawn_ray(hit->interaction(), camera)) < 1;
        }
        EXPECT_GT(connections, 3000) << distance;
        EXPECT_EQ(hidden, 0) << distance;
    }
}

// Embree finds some crossings twice, in a straight tube above all.
TEST(Tubes, WithHolesLetTheirShareOfTheLightPassAtEachCrossing) {
    for (const char* curve : {kStraight, kBent}) {
        const Built whole = build(curve), half = build(std::string(curve) + "\"float alpha\" .5\n");
        Random random;
        for (const float distance : {0.0f, 0.3f, 8.0f, 1e3f}) {
            int crossed = 0, wrong = 0;
            for (int i = 0; i < 20000; ++i) {
                const Vec3f to{random(-2.5f, 2.5f), random(-.4f, .4f), random(-.4f, .4f)}, d = random.direction();
                const Ray ray{to - d * distance, d};
                double share = 1;
                auto hit = first_hit(*whole.geometry, ray);
                for (; hit; hit = first_hit(*whole.geometry, spawn_ray(hit->interaction(), d))) share /= 2;
                crossed += share < 1 ? 1 : 0;
                wrong += share_passed(*half.geometry, ray) == static_cast<float>(share) ? 0 : 1;
            }
            EXPECT_GT(crossed, 2000) << distance;
            EXPECT_EQ(wrong, 0) << distance;
        }
    }
}

// In a plane, where a direction that turns the shortest way does not turn about the curve either.
TEST(Tubes, CoordinatesRunAlongAndAround) {
    const Built scene = build(
        "Shape \"curve\" \"string type\" \"cylinder\" \"point3 P\" [0 0 0  1 1 0  2 1 0  3 0 0] \"float width0\" .4 "
        "\"float width1\" .2\n");
    const Tube tube = tube_of(mesh_of(scene), 0);
    for (double u = 0.1; u < 1; u += 0.2) {
        for (double v = 0.05; v < 1; v += 0.1) {
            const double h = 1e-5, k = 1e-3;
            const auto along = [&](double x, double y) { return (point_at(tube, x + h, y) - point_at(tube, x - h, y)) / (2 * h); };
            const auto around = [&](double x, double y) { return (point_at(tube, x, y + h) - point_at(tube, x, y - h)) / (2 * h); };
            const auto normal = [&](double x, double y) { return normalize(cross(around(x, y), along(x, y))); };
            const Vec3d p = point_at(tube, u, v), n = normal(u, v);
            const auto hit = first_hit(*scene.geometry, {Vec3f(p + n * 0.02), Vec3f(-n)});
            ASSERT_TRUE(hit);
            EXPECT_NEAR(hit->t, 0.02, 1e-6);
            EXPECT_LT(length(Vec3d(hit->ng) - n), 1e-5);
            const SurfaceCoordinates at = scene.geometry->coordinates(*hit);
            EXPECT_NEAR(static_cast<double>(at.uv.x), u, 1e-5);
            EXPECT_NEAR(static_cast<double>(at.uv.y), v, 1e-5);
            EXPECT_LT(length(Vec3d(at.dpdu) - along(u, v)), 1e-3);
            EXPECT_LT(length(Vec3d(at.dpdv) - around(u, v)), 1e-3);
            // The normal of a cone changes a little as the axis bends: left out.
            EXPECT_LT(length(Vec3d(at.dndu) - (normal(u + k, v) - normal(u - k, v)) / (2 * k)), 0.05);
            EXPECT_LT(length(Vec3d(at.dndv) - (normal(u, v + k) - normal(u, v - k)) / (2 * k)), 0.05);
        }
    }
}

// A texture does not jump from one segment to the next.
TEST(Tubes, SeamsGoOnFromSegmentToSegment) {
    const Built scene = build(kBent);
    const MeshDescription& mesh = mesh_of(scene);
    ASSERT_EQ(mesh.indices.size(), 4u);
    for (std::uint32_t segment = 1; segment < 4; ++segment) {
        const Tube before = tube_of(mesh, segment - 1), after = tube_of(mesh, segment);
        for (const double v : {0.1, 0.6}) EXPECT_LT(length(point_at(before, 1, v) - point_at(after, 0, v)), 1e-6);
    }
}

TEST(Tubes, OfOneSurfaceAreOneShape) {
    const std::string fibre = "Shape \"curve\" \"point3 P\" [0 0 0  1 0 0  2 0 0  3 0 0] \"float width\" .1\n";
    const Built scene = build("Material \"diffuse\"\n" + fibre + "Translate 0 1 0\n" + fibre + "Material \"diffuse\"\n" + fibre);
    ASSERT_EQ(scene.description.shapes.size(), 2u);
    EXPECT_EQ(mesh_of(scene).indices, (std::vector<std::uint32_t>{0, 4}));
    for (const float y : {0.0f, 1.0f}) EXPECT_EQ(share_passed(*scene.geometry, {{1, y, 1}, {0, 0, -1}}), 0);
    EXPECT_EQ(share_passed(*scene.geometry, {{1, 2, 1}, {0, 0, -1}}), 1);
}

// Stretched, a tube is not round any more, and points must be drawn on one that shines: both are meshes.
TEST(Tubes, ThatAreStretchedOrShineAreMeshes) {
    EXPECT_EQ(build(kStraight).description.shapes.at(0).kind, ShapeKind::kTube);
    EXPECT_EQ(build("Rotate 30 1 2 3\nScale 2 -2 2\n" + std::string(kStraight)).description.shapes.at(0).kind, ShapeKind::kTube);
    EXPECT_EQ(build("Scale 1 2 1\n" + std::string(kStraight)).description.shapes.at(0).kind, ShapeKind::kTriangles);
    EXPECT_EQ(build("AreaLightSource \"diffuse\"\n" + std::string(kStraight)).description.shapes.at(0).kind, ShapeKind::kTriangles);
}

// Points that coincide give no direction; Embree would lose the ends.
TEST(Tubes, WhoseEndsHaveNoDirectionAreWhole) {
    const Built scene = build("Shape \"curve\" \"point3 P\" [0 0 0  0 0 0  3 0 0  3 0 0] \"float width\" .1\n");
    for (float x = 0.001f; x < 3; x += 0.0137f) EXPECT_EQ(share_passed(*scene.geometry, {{x, .01f, 1}, {0, 0, -1}}), 0) << x;
    EXPECT_TRUE(testing::load_world("Shape \"curve\" \"point3 P\" [1 1 1 1 1 1 1 1 1 1 1 1]\n"));
}

}  // namespace
}  // namespace latent::render
