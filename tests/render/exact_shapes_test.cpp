// Quadrics and patches against what their equations say.
#include "render/geometry/exact_shapes.h"

#include <gtest/gtest.h>

#include <random>

namespace latent::render {
namespace {

class Random64 {
 public:
    double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
    Vec3d vector(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }

 private:
    std::mt19937_64 engine_{7};
};

constexpr double kFar = 1e30;

// Rays at a surface of which each point p has length(across(p)) = radius.
template <class Across, class Intersect>
void expect_first_hits(const Across& across, const Intersect& intersect) {
    const auto distance = [&](const Vec3d& p) { return length(across(p)); };
    Random64 random;
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        const double radius = std::exp(random(-3, 3));
        const Vec3d o = random.vector(4 * radius), d = random.vector(1.5 * radius) - o;
        const auto hit = intersect(o, d, radius, QuadricPart{}, 0, kFar);
        // The nearest that the ray comes to the centre or the axis decides whether there is a hit at all.
        const double nearest = std::max(0.0, -dot(across(o), across(d)) / dot(across(d), across(d)));
        const bool inside = distance(o) < radius, expected = inside || distance(o + d * nearest) < radius;
        ASSERT_EQ(hit.has_value(), expected);
        if (!hit) continue;
        ++hits;
        EXPECT_NEAR(distance(o + d * hit->t), radius, 1e-9 * (radius + length(o)));
        EXPECT_GT(hit->t, 0);
        EXPECT_EQ(distance(o + d * (hit->t / 2)) < radius, inside);  // nothing in between
    }
    EXPECT_GT(hits, 3000);
}

TEST(Sphere, HitsLieOnItAndAreTheFirst) {
    expect_first_hits([](const Vec3d& p) { return p; }, intersect_sphere);
}

TEST(Sphere, FarAndGrazingRaysKeepTheirPrecision) {
    for (const double distance : {1e2, 1e4, 1e6}) {
        for (const double height : {0.0, 0.5, 0.999, 0.9999999}) {
            const auto hit = intersect_sphere({height, 0, -distance}, {0, 0, 1}, 1, {}, 0, kFar);
            ASSERT_TRUE(hit);
            EXPECT_NEAR(hit->t, distance - std::sqrt((1 - height) * (1 + height)), 1e-9 * distance);
        }
        EXPECT_FALSE(intersect_sphere({1.0000001, 0, -distance}, {0, 0, 1}, 1, {}, 0, kFar));
    }
}

TEST(Sphere, OriginOnTheSurfaceKnowsItsSide) {
    Random64 random;
    for (int i = 0; i < 10000; ++i) {
        const Vec3d n = normalize(random.vector(1)), tangent = normalize(cross(n, random.vector(1)));
        const double cosine = std::exp(random(-8, 0));
        const Vec3d out = n * cosine + tangent * std::sqrt(1 - cosine * cosine);
        EXPECT_FALSE(intersect_sphere(n * (1 + 1e-14), out, 1, {}, 0, kFar));
        const auto in = intersect_sphere(n * (1 - 1e-14), -out, 1, {}, 0, kFar);
        ASSERT_TRUE(in);
        EXPECT_NEAR(in->t, 2 * cosine, 1e-9 + 1e-13 / cosine);  // the chord
    }
}

TEST(Cylinder, HitsLieOnItAndAreTheFirst) {
    expect_first_hits([](const Vec3d& p) { return Vec3d{p.x, p.y, 0}; }, intersect_cylinder);
    EXPECT_FALSE(intersect_cylinder({0.5, 0, 5}, {0, 0, -1}, 1, {}, 0, kFar));  // along its axis
}

// Of the points of a whole quadric that a ray hits, a part has those that lie on it.
TEST(Quadrics, APartIsMetWhereItIs) {
    Random64 random;
    int met = 0, missed = 0;
    for (int i = 0; i < 20000; ++i) {
        const QuadricPart part{random(-1, 0), random(0, 1), random(0.5, 6)};
        const Vec3d o = random.vector(2), d = random.vector(1.2) - o;
        const auto check = [&](const auto& intersect) {
            double low = 0;
            std::optional<ExactHit> expected;
            while (const std::optional<ExactHit> whole = intersect(QuadricPart{}, low)) {
                if (part.holds(o + d * whole->t)) {
                    expected = whole;
                    break;
                }
                low = whole->t;
            }
            const std::optional<ExactHit> hit = intersect(part, 0.0);
            ASSERT_EQ(hit.has_value(), expected.has_value());
            if (hit) {
                EXPECT_EQ(hit->t, expected->t);
            }
            ++(hit ? met : missed);
        };
        check([&](const QuadricPart& p, double low) { return intersect_sphere(o, d, 1, p, low, kFar); });
        check([&](const QuadricPart& p, double low) { return intersect_cylinder(o, d, 1, p, low, kFar); });
        check([&](const QuadricPart& p, double low) { return intersect_disk(o, d, 0.2, 0.3, 1, p, low, kFar); });
    }
    EXPECT_GT(met, 10000);
    EXPECT_GT(missed, 10000);
}

TEST(Disk, IsItsRing) {
    for (double r = 0; r < 3; r += 0.0625) {
        const bool expected = r >= 0.5 && r <= 2;
        EXPECT_EQ(intersect_disk({r, 0, 5}, {0, 0, -1}, 1, 0.5, 2, {}, 0, kFar).has_value(), expected) << r;
        EXPECT_FALSE(intersect_disk({r, 0, 5}, {0, 0, 1}, 1, 0.5, 2, {}, 0, kFar));
    }
    EXPECT_EQ(intersect_disk({1, 0, 5}, {0, 0, -2}, 1, 0, 2, {}, 0, kFar)->t, 2);
}

TEST(Patch, RaysToItsPointsHitThereUnlessSomethingIsInFront) {
    Random64 random;
    int nearest = 0;
    for (int i = 0; i < 20000; ++i) {
        const PatchCorners p{random.vector(1), random.vector(1), random.vector(1), random.vector(1)};
        const double u = random(0.01, 0.99), v = random(0.01, 0.99);
        const Vec3d target = patch_point(p, u, v), o = random.vector(3), d = target - o;
        const auto hit = intersect_patch(o, d, p, 0, kFar);
        ASSERT_TRUE(hit) << i;
        EXPECT_LT(length(patch_point(p, hit->u, hit->v) - (o + d * hit->t)), 1e-7);
        EXPECT_LT(hit->t, 1 + 1e-6);
        nearest += std::abs(hit->t - 1) < 1e-6 ? 1 : 0;
    }
    EXPECT_GT(nearest, 12000);
}

TEST(Patch, FlatRectangleIsThatRectangle) {
    const PatchCorners p{Vec3d(-0.7, -0.7, -0.6), Vec3d(-0.2, -0.7, -0.6), Vec3d(-0.7, -0.1, -0.6), Vec3d(-0.2, -0.1, -0.6)};
    Random64 random;
    for (int i = 0; i < 10000; ++i) {
        const Vec3d o(random(-1, 1), random(-1, 1), 2), d(random(-0.2, 0.2), random(-0.2, 0.2), -1);
        const Vec3d at = o + d * 2.6;
        const bool inside = at.x > -0.7 && at.x < -0.2 && at.y > -0.7 && at.y < -0.1;
        const auto hit = intersect_patch(o, d, p, 0, kFar);
        ASSERT_EQ(hit.has_value(), inside);
        if (!hit) continue;
        EXPECT_NEAR(hit->t, 2.6, 1e-9);
        EXPECT_NEAR(hit->u, (at.x + 0.7) / 0.5, 1e-8);
        EXPECT_NEAR(hit->v, (at.y + 0.7) / 0.6, 1e-8);
    }
}

}  // namespace
}  // namespace latent::render
