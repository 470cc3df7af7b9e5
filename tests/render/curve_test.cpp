// Curves as meshes: where their points are, how their normals stand, and that nothing twists.
#include "render/load/mesh/curve.h"

#include <gmock/gmock.h>

#include <random>

#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using ::testing::HasSubstr;

std::vector<Vec3d> random_points(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> even(-1, 1);
    std::vector<Vec3d> points;
    for (std::size_t i = 0; i < count; ++i) points.emplace_back(even(random), even(random), even(random));
    return points;
}

// The polynomials of both bases, written out.
TEST(Curve, PointsAreThoseOfTheirBasis) {
    const std::vector<Vec3d> p = random_points(7, 1);
    for (double u = 0; u <= 1; u += 0.125) {
        const double t = 1 - u;
        const auto near = [](const Vec3d& a, const Vec3d& b) { EXPECT_LT(length(a - b), 1e-12); };
        near(point_on(segments_of(p, 3, false).at(1), u),
             p[3] * (t * t * t) + p[4] * (3 * t * t * u) + p[5] * (3 * t * u * u) + p[6] * (u * u * u));
        near(point_on(segments_of(p, 2, false).at(2), u), p[4] * (t * t) + p[5] * (2 * t * u) + p[6] * (u * u));
        near(point_on(segments_of(p, 3, true).at(3), u), (p[3] * (t * t * t) + p[4] * (3 * u * u * u - 6 * u * u + 4) +
                                                          p[5] * (-3 * u * u * u + 3 * u * u + 3 * u + 1) + p[6] * (u * u * u)) /
                                                             6);
        near(point_on(segments_of(p, 2, true).at(4), u), (p[4] * (t * t) + p[5] * (-2 * u * u + 2 * u + 1) + p[6] * (u * u)) / 2);
    }
    EXPECT_EQ(segments_of(p, 3, false).size(), 2u);
    EXPECT_EQ(segments_of(p, 3, true).size(), 4u);
    EXPECT_TRUE(segments_of(random_points(6, 1), 3, false).empty());
    EXPECT_TRUE(segments_of(random_points(3, 1), 3, true).empty());
}

// Half a width from the curve, square to it, with normals that point away from it.
TEST(Curve, TubesAreRound) {
    const std::vector<CubicBezier> segments = segments_of(random_points(10, 2), 3, true);
    const LoadedMesh mesh = tube_mesh(segments, {0.2, 0.02});
    ASSERT_EQ(mesh.positions.size() % 17, 0u);
    double greatest_turn = 0;
    Vec3d last;
    std::size_t segment = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const double u = static_cast<double>(mesh.uvs[i].x);
        if (i % 17 == 0 && i > 0 && u == 0) ++segment;
        const Vec3d center = point_on(segments[segment], u), d = normalize(tangent_at(segments[segment], u));
        const double along = (static_cast<double>(segment) + u) / static_cast<double>(segments.size());
        const Vec3d out = mesh.positions[i] - center, n(mesh.normals[i]);
        EXPECT_NEAR(length(out), 0.1 + along * (0.01 - 0.1), 1e-6);
        EXPECT_NEAR(dot(out, d), 0, 1e-6);
        EXPECT_NEAR(dot(n, out), length(out), 1e-6);
        if (i % 17 == 0) {
            // About the curve itself, a frame does not turn.
            if (i > 0 && u > 0) greatest_turn = std::max(greatest_turn, std::abs(dot(cross(last, n), d)));
            last = n;
        }
    }
    EXPECT_EQ(segment + 1, segments.size());
    EXPECT_LT(greatest_turn, 0.1);
}

TEST(Curve, RibbonsLieAcrossTheirNormals) {
    const std::vector<CubicBezier> line = segments_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, 3, false);
    const LoadedMesh mesh = ribbon_along(line, {2, 4}, {{0, 0, 1}, {0, 0, 1}});
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 2, 1, 3}));
    for (const Vec3d& p : mesh.positions) EXPECT_EQ(p.z, 0);
    EXPECT_NEAR(length(mesh.positions[1] - mesh.positions[0]), 2, 1e-12);
    EXPECT_NEAR(length(mesh.positions[3] - mesh.positions[2]), 4, 1e-12);
}

TEST(Curve, IsReadWithItsParametersAndRefusedWithout) {
    const std::string points = "\"point3 P\" [0 0 0 1 0 0 2 1 0 3 1 0] ";
    for (const char* type : {"flat", "cylinder"}) {
        const Result<LoadedScene> scene =
            testing::load_world("Shape \"curve\" " + points + "\"string type\" \"" + type + "\" \"float width\" .1");
        ASSERT_TRUE(scene) << scene.error().message;
        EXPECT_EQ(scene->description.shapes.at(0).kind, ShapeKind::kTube);
    }
    const Result<LoadedScene> ribbon =
        testing::load_world("Shape \"curve\" " + points + "\"string type\" \"ribbon\" \"normal N\" [0 0 1 0 1 0]");
    ASSERT_TRUE(ribbon) << ribbon.error().message;
    EXPECT_THAT(testing::refused_world("Shape \"curve\" " + points + "\"string type\" \"ribbon\""),
                HasSubstr("N: must have 2 normals"));
    EXPECT_THAT(testing::refused_world("Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 1 0]"),
                HasSubstr("3 points make no curve of degree 3"));
    EXPECT_THAT(testing::refused_world("Shape \"curve\" " + points + "\"string basis\" \"nurbs\""), HasSubstr("basis"));
}

}  // namespace
}  // namespace latent::render
