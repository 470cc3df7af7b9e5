// Geometry against brute force, and the promises that light transport builds on: orientation, clear ray origins, emitters.
#include "render/geometry/geometry.h"

#include <functional>
#include <numbers>

#include "render/geometry/exact_shapes.h"
#include "render/math/next_float.h"
#include "tests/render/built_geometry.h"

namespace latent::render {
namespace {

using testing::build;
using testing::Built;
using testing::first_hit;
using testing::in_world;
using testing::load_world;
using testing::Random;
using testing::share_passed;

std::string number(float x) { return std::to_string(x) + " "; }

// A soup of triangles as text.
std::string soup(int count, float size, Random& random) {
    std::string p, i;
    for (int k = 0; k < count; ++k) {
        const Vec3f center = random.vector(1);
        for (int c = 0; c < 3; ++c) {
            const Vec3f v = center + random.vector(size);
            p += number(v.x) + number(v.y) + number(v.z);
            i += std::to_string(3 * k + c) + " ";
        }
    }
    return "Shape \"trianglemesh\" \"point3 P\" [ " + p + "] \"integer indices\" [ " + i + "]\n";
}

// Distance to a triangle in double, straight from the definition; infinity for a miss.
double brute_force(const MeshDescription& mesh, const Affined& placed, const Ray& ray) {
    double nearest = kInfinity;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        Vec3d p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = placed.point(Vec3d(mesh.positions[mesh.indices[i + k]]));
        const Vec3d e1 = p[1] - p[0], e2 = p[2] - p[0], d(ray.d), s = Vec3d(ray.o) - p[0];
        const double det = dot(e1, cross(d, e2));
        const double u = dot(s, cross(d, e2)) / det, v = dot(d, cross(s, e1)) / det, t = dot(e2, cross(s, e1)) / det;
        if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) nearest = std::min(nearest, t);
    }
    return nearest;
}

TEST(NextFloat, IsWhatTheStandardLibraryCallsIt) {
    std::vector<float> values{0.0f,     -0.0f, 1.0f, -1.0f, 0x1p-149f, -0x1p-149f, 0x1p-126f, 0x1.fffffep127f, -0x1.fffffep127f,
                              -INFINITY};
    for (std::uint32_t bits = 1; bits < 0x7f800000u; bits += 0x12345u) {
        values.push_back(std::bit_cast<float>(bits));
        values.push_back(-values.back());
    }
    for (const float x : values) {
        EXPECT_EQ(next_up(x), std::nextafter(x, INFINITY)) << x;
        EXPECT_EQ(next_down(-x), std::nextafter(-x, -INFINITY)) << x;
    }
    EXPECT_EQ(next_up(INFINITY), INFINITY);
    EXPECT_TRUE(std::isnan(next_up(NAN)));
}

TEST(Geometry, TrianglesAreHitWhereBruteForceHitsThem) {
    Random random;
    const Built scene = build(soup(300, 0.2f, random));
    const MeshDescription& mesh = *scene.description.shapes[0].mesh;
    int different = 0, hits = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f o = random.vector(2);
        const Ray ray{o, normalize(random.vector(1) - o)};
        const double expected = brute_force(mesh, {}, ray);
        const auto hit = first_hit(*scene.geometry, ray);
        EXPECT_EQ(share_passed(*scene.geometry, ray), hit ? 0 : 1);
        if (hit.has_value() != (expected < kInfinity)) {
            ++different;  // rays through edges may be decided otherwise in float
            continue;
        }
        if (!hit) continue;
        ++hits;
        if (std::abs(hit->t - expected) > 1e-4) {
            ++different;
            continue;
        }
        EXPECT_LT(length(Vec3d(hit->p) - (Vec3d(ray.o) + Vec3d(ray.d) * expected)), 1e-4);
        EXPECT_NEAR(length(hit->ng), 1, 1e-5);
        Ray shorter = ray;
        shorter.t_max = hit->t * 0.999f;
        EXPECT_FALSE(first_hit(*scene.geometry, shorter));
        EXPECT_EQ(share_passed(*scene.geometry, shorter), 1);
    }
    EXPECT_GT(hits, 5000);
    EXPECT_LE(different, 4);
}

TEST(Geometry, InstancesAreTheirShapesMoved) {
    Random random;
    const std::string shape = soup(40, 0.4f, random);
    const Built scene =
        build("ObjectBegin \"o\"\nTranslate 0.1 0 0\n" + shape +
              "ObjectEnd\nAttributeBegin\nTranslate 3 0 0\nRotate 30 1 2 3\nScale 1 2 0.5\nObjectInstance \"o\"\nAttributeEnd\n"
              "AttributeBegin\nTranslate -3 1 0\nScale -1 1 1\nObjectInstance \"o\"\nAttributeEnd\n");
    const MeshDescription& mesh = *scene.description.objects[0].shapes[0].mesh;
    int hits = 0, different = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f o = random.vector(6), target = scene.description.instances[i % 2].world_from_object.t == Vec3d(3, 0, 0)
                                                       ? Vec3f(3, 0, 0)
                                                       : Vec3f(-3, 1, 0);
        const Ray ray{o, normalize(target + random.vector(1) - o)};
        double expected = kInfinity;
        for (const InstanceDescription& instance : scene.description.instances)
            expected = std::min(expected, brute_force(mesh, instance.world_from_object, ray));
        const auto hit = first_hit(*scene.geometry, ray);
        if (hit.has_value() != (expected < kInfinity) || (hit && std::abs(hit->t - expected) > 1e-4)) {
            ++different;
            continue;
        }
        if (!hit) continue;
        ++hits;
        EXPECT_LT(length(Vec3d(hit->p) - (Vec3d(ray.o) + Vec3d(ray.d) * expected)), 1e-4);
    }
    EXPECT_GT(hits, 3000);
    EXPECT_LE(different, 4);
}

// A mesh and the same mesh as an instance, mirrored too: same points, same normals.
TEST(Geometry, OrientationSurvivesInstancingAndMirroring) {
    const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ]\n";
    for (const std::string transform : {"Rotate 20 1 1 0\n", "Scale -1 1 1\n", "Scale 2 1 -3\nRotate 70 0 1 1\n"}) {
        for (const std::string reverse : {"", "ReverseOrientation\n"}) {
            const Built flat = build(reverse + transform + triangle);
            const Built instanced =
                build("ObjectBegin \"o\"\n" + reverse + triangle + "ObjectEnd\n" + transform + "ObjectInstance \"o\"\n");
            const Affined& m = instanced.description.instances[0].world_from_object;
            const Vec3f target(m.point({0.25, 0.25, 0})), normal(normalize(m.normal(Vec3d(0, 0, reverse.empty() ? 1 : -1))));
            const Ray ray{target + normal * 2.0f, -normal};
            for (const Built* scene : {&flat, &instanced}) {
                const auto hit = first_hit(*scene->geometry, ray);
                ASSERT_TRUE(hit);
                EXPECT_LT(length(hit->ng - normal), 1e-5f);
                EXPECT_LT(length(hit->ns - normal), 1e-5f);
                EXPECT_LT(length(hit->p - target), 1e-5f);
            }
        }
    }
}

TEST(Geometry, SphereNormalsPointOutUnlessReversed) {
    Random random;
    for (const bool reverse : {false, true}) {
        const Built scene = build(std::string(reverse ? "ReverseOrientation\n" : "") +
                                  "Translate 1 2 3\nScale 1 2 -0.5\nShape \"sphere\" \"float radius\" 1.5\n");
        const Affined& m = scene.description.shapes[0].to_world;
        for (int i = 0; i < 1000; ++i) {
            const Vec3d local = Vec3d(random.direction()) * 1.5;
            const Vec3f p(m.point(local)), inside(m.point(local * 0.5));
            const auto hit = first_hit(*scene.geometry, {inside, p - inside});
            ASSERT_TRUE(hit);
            EXPECT_LT(length(hit->p - p), 1e-5f);
            const Vec3f outward(normalize(m.normal(local)));
            EXPECT_LT(length(hit->ng - (reverse ? -outward : outward)), 1e-4f);
            EXPECT_NEAR(dot(normalize(hit->dpdu), hit->ng), 0, 1e-4f);
        }
    }
}

TEST(Geometry, PatchesAndPairsOfTrianglesAgree) {
    // The same flat quad as pair of triangles (parallelogram) and, bent by less than can be seen, as a curved patch.
    const Built flat = build("Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  2 0.5 0  0.25 1 0  2.25 1.5 0 ]\n");
    const Built bent = build("Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  2 0.5 0  0.25 1 0  2.25 1.5 1e-5 ]\n");
    ASSERT_EQ(flat.description.shapes[0].kind, ShapeKind::kTriangles);
    ASSERT_EQ(bent.description.shapes[0].kind, ShapeKind::kBilinear);
    Random random;
    int hits = 0, different = 0;
    for (int i = 0; i < 5000; ++i) {
        const Ray ray{{random(0, 2.5f), random(0, 2), 3}, {random(-.1f, .1f), random(-.1f, .1f), -1}};
        const auto a = first_hit(*flat.geometry, ray), b = first_hit(*bent.geometry, ray);
        if (a.has_value() != b.has_value()) {
            ++different;
            continue;
        }
        if (!a) continue;
        ++hits;
        EXPECT_LT(length(a->p - b->p), 3e-5f);
        EXPECT_GT(dot(a->ng, b->ng), 0.9999f);  // cross(dpdu, dpdv)
        EXPECT_GT(abs_dot(normalize(a->dpdu), normalize(b->dpdu)), 0.9999f);
    }
    EXPECT_GT(hits, 1000);
    EXPECT_LE(different, 3);
}

TEST(Geometry, ShadingNormalsInterpolateAndOrient) {
    const Built scene = build(
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ] \"normal N\" [ 0 0 -1  .6 0 -.8  0 0 -2 ] \"point2 uv\" [ 0 0 "
        " 0 1  1 0 ]\n");
    const auto hit = first_hit(*scene.geometry, {{0.5f, 0.25f, 1}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_LT(length(hit->ng - Vec3f(0, 0, -1)), 1e-6f);  // the mesh's normals say where out is
    const Vec3d expected = normalize(Vec3d(0, 0, -1) * 0.25 + Vec3d(.6, 0, -.8) * 0.5 + Vec3d(0, 0, -1) * 0.25);
    EXPECT_LT(length(Vec3d(hit->ns) - expected), 1e-6);
    EXPECT_LT(length(hit->dpdu - Vec3f(0, 1, 0)), 1e-6f);  // u grows along y here
}

// A box and a ball, as they are, moved, tiny, stretched and turned; instanced or not.
void for_closed_shapes(const char* moved, const std::function<void(const Geometry&)>& check) {
    const std::string box =
        "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1   -1 -1 1  1 -1 1  1 1 1  -1 1 1 ]\n"
        "\"integer indices\" [ 0 2 1 0 3 2  4 5 6 4 6 7  0 1 5 0 5 4  3 6 2 3 7 6  0 4 7 0 7 3  1 2 6 1 6 5 ]\n";
    const std::string ball = "Shape \"sphere\" \"float radius\" 1.3\n";
    for (const std::string& shape : {box, ball}) {
        for (const std::string place :
             {"", moved, "Scale 1e-3 1e-3 1e-3\n", "Scale 300 1000 20\n", "Translate 7 8 9\nRotate 31 1 2 3\nScale 0.1 3 1\n"}) {
            for (const bool instanced : {false, true}) {
                SCOPED_TRACE(place + shape + (instanced ? "instanced" : ""));
                const Built scene = build(
                    instanced ? "ObjectBegin \"o\"\n" + shape + "ObjectEnd\n" + place + "ObjectInstance \"o\"\n" : place + shape);
                check(*scene.geometry);
            }
        }
    }
}

// A ray that leaves a surface never meets it again on a flat or convex one, and one that stays inside never gets out: at every
// scale, far from the origin, instanced or not, towards grazing angles.
TEST(Geometry, RaysStartClearOfTheirSurface) {
    Random random;
    for_closed_shapes("Translate 100 -30 1000\n", [&](const Geometry& g) {
        int leaks = 0, traps = 0, hits = 0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3f start = g.center() + random.direction() * (g.radius() * 2);
            const auto hit = first_hit(g, {start, normalize(g.center() - start + random.direction() * (g.radius() * 0.3f))});
            if (!hit) continue;
            ++hits;
            const float cosine = i % 2 == 0 ? random(0.01f, 1) : std::exp(random(-9, 0));
            const Vec3f out = random.about(hit->ng, cosine);
            traps += share_passed(g, spawn_ray(hit->interaction(), out)) < 1 ? 1 : 0;
            leaks += first_hit(g, spawn_ray(hit->interaction(), -out)) ? 0 : 1;  // closed: every inward ray ends
        }
        EXPECT_GT(hits, 1000);
        EXPECT_EQ(traps, 0);
        EXPECT_LE(leaks, 1);  // an edge may let a ray in from just beside it
    });
}

TEST(Geometry, ConnectionsSeeEachOtherAndNothingElse) {
    const Built scene = build(
        "Shape \"trianglemesh\" \"point3 P\" [ -50 0 -50  50 0 -50  50 0 50  -50 0 50 ] \"integer indices\" [ 0 2 1  0 3 2 ]\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -1 5 -1  1 5 -1  1 5 1  -1 5 1 ] \"integer indices\" [ 0 1 2  0 2 3 ]\n");
    Random random;
    for (int i = 0; i < 20000; ++i) {
        const auto floor = first_hit(*scene.geometry, {{random(-40, 40), 4, random(-40, 40)}, {0, -1, 0}});
        const auto lamp = first_hit(*scene.geometry, {{random(-.99f, .99f), 4, random(-.99f, .99f)}, {0, 1, 0}});
        ASSERT_TRUE(floor && lamp);
        EXPECT_EQ(share_passed(*scene.geometry, spawn_ray(floor->interaction(), lamp->interaction())), 1);
        EXPECT_EQ(share_passed(*scene.geometry, spawn_ray(lamp->interaction(), floor->interaction())), 1);
        const Interaction above{lamp->p + Vec3f(0, 1, 0), 0, {}};
        EXPECT_EQ(share_passed(*scene.geometry, spawn_ray(Interaction{{lamp->p.x, 1, lamp->p.z}, 0, {}}, above)), 0);
    }
}

// From points at any distance to what they see of a box or ball: nothing is in the way of itself, at any scale and angle; and
// through a lid in front of each point, 2e-5 of the distance away, nothing is seen.
TEST(Geometry, ConnectionsEndOnTheSurfaceThatTheyLeadTo) {
    Random random;
    for_closed_shapes("Translate 1 -3 10\n", [&](const Geometry& g) {
        for (const float distance : {1.5f, 10.0f, 1e3f, 1e5f}) {
            int connections = 0, hidden = 0, grazing = 0;
            for (int i = 0; i < 4000; ++i) {
                const Vec3f inside = g.center() + random.direction() * (g.radius() * 0.01f), out = random.direction();
                const auto hit = first_hit(g, {inside, out});
                ASSERT_TRUE(hit);
                // Half of the points look along the surface.
                const float cosine = i % 2 == 0 ? random(0.01f, 1) : std::exp(random(-9, 0));
                const Vec3f w = random.about(hit->ng, cosine);
                const Interaction camera{hit->p + w * (distance * g.radius()), 0, {}};
                if (dot(normalize(camera.p - hit->p), hit->ng) < 1e-4f) continue;
                ++connections;
                grazing += cosine < 0.01f;
                hidden += share_passed(g, spawn_ray(camera, hit->interaction())) < 1 ||
                          share_passed(g, spawn_ray(hit->interaction(), camera)) < 1;
            }
            EXPECT_GT(connections, 3000) << distance;
            EXPECT_GT(grazing, 400) << distance;
            EXPECT_EQ(hidden, 0) << distance;
        }
    });
    const std::string lamp = "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0  1 -1 0  0 1 0 ]\n";
    for (const float distance : {1.0f, 10.0f, 1e3f}) {
        const float gap = 2e-5f * distance;
        const Built scene = build("Scale 0.1 0.1 1\n" + lamp + "Translate 0 0 " + std::to_string(gap) + "\nScale 2 2 2\n" + lamp);
        for (int i = 0; i < 1000; ++i) {
            const float r = random(-0.02f, 0.02f), s = random(-0.02f, 0.02f);
            const auto on_lamp = first_hit(*scene.geometry, {{r, s, -1}, {0, 0, 1}});
            ASSERT_TRUE(on_lamp);
            const Vec3f w = normalize(Vec3f{random(-1, 1), random(-1, 1), 1});
            const Interaction camera{on_lamp->p + w * distance, 0, {}};
            EXPECT_EQ(share_passed(*scene.geometry, spawn_ray(camera, on_lamp->interaction())), 0) << distance;
            EXPECT_EQ(share_passed(*scene.geometry, spawn_ray(on_lamp->interaction(), camera)), 0) << distance;
        }
    }
}

TEST(Emitters, HoldAreaAndNormal) {
    const Built scene = build(
        "AreaLightSource \"diffuse\" \"float power\" 6 \"float scale\" 2\n"
        "AttributeBegin\nTranslate 0 3 0\nScale 2 2 2\nShape \"sphere\" \"float radius\" 0.5\nAttributeEnd\n"
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  3 0 0  3 4 0  0 0 9 ] \"integer indices\" [ 0 1 2  0 1 3 ]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ 5 0 0  7 0 0  5 1 0  7 1 0 ]\n"
        "AreaLightSource \"diffuse\" \"float scale\" 5 \"bool twosided\" true\nShape \"trianglemesh\" \"point3 P\" [ 0 9 0  1 9 0  "
        "0 9 1 ]\n");
    const std::vector<Emitter>& e = scene.geometry->emitters();
    ASSERT_EQ(e.size(), 6u);
    EXPECT_EQ(e[0].kind, EmitterKind::kSphere);
    EXPECT_EQ(e[0].p, Vec3f(0, 3, 0));
    EXPECT_NEAR(e[0].radius, 1, 1e-6f);
    EXPECT_NEAR(e[0].area, 4 * kPi, 1e-5);
    EXPECT_NEAR(e[1].area, 6, 1e-5);
    EXPECT_NEAR(e[2].area, 13.5, 1e-5);
    for (std::uint32_t i = 0; i < e.size(); ++i) {
        EXPECT_EQ(e[i].is_half, i == 3 || i == 4);  // the patch is two triangles here
        EXPECT_EQ(e[i].area_light, i < 5 ? 0u : 1u);
    }
    Random random;
    for (std::uint32_t i = 1; i < e.size(); ++i) {
        const Vec3f center = e[i].p + (e[i].e1 + e[i].e2) * (1 / 3.0f);
        const auto hit = first_hit(*scene.geometry, {center + e[i].n * 0.5f, -e[i].n});
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->emitter, i);
        EXPECT_LT(length(hit->ng - e[i].n), 1e-6f);
    }
    EXPECT_EQ(first_hit(*scene.geometry, {{0, 3, 5}, {0, 0, -1}})->emitter, 0u);
}

// The loader has told it before; a description may come from elsewhere.
TEST(Emitters, OfShapesThatCannotBeSampledAreRefused) {
    Result<LoadedScene> scene = load_world(
        "AttributeBegin\nScale 1 2 1\nShape \"cylinder\"\nAttributeEnd\nAreaLightSource \"diffuse\"\nShape \"sphere\"\n");
    ASSERT_TRUE(scene);
    EXPECT_TRUE(Geometry::build(scene->description, "sse4.2"));
    scene->description.shapes[0].area_light = 0;
    const auto geometry = Geometry::build(scene->description, "sse4.2");
    ASSERT_FALSE(geometry);
    EXPECT_EQ(geometry.error().message, "an area light on a cylinder that is stretched is not supported");
}

// Along u and v a quadric moves as dpdu and dpdv say, and its normal as dndu and dndv do.
TEST(Coordinates, OfQuadricsRunFromNoughtToOneOverTheirPart) {
    struct Case {
        std::string text;
        std::function<Vec3d(double u, double v)> point;
    };
    const double turn = 250 * std::numbers::pi / 180;
    const auto at = [=](double u, double ring, double z) { return Vec3d(ring * std::cos(u * turn), ring * std::sin(u * turn), z); };
    const std::vector<Case> cases = {
        {"\"cylinder\" \"float radius\" 2 \"float zmin\" 3 \"float zmax\" -1",
         [=](double u, double v) { return at(u, 2, 4 * v - 1); }},
        {"\"disk\" \"float radius\" 2 \"float innerradius\" .5 \"float height\" 1",
         [=](double u, double v) { return at(u, 2 - 1.5 * v, 1); }},
        {"\"sphere\" \"float radius\" 2 \"float zmin\" -1 \"float zmax\" 1.5",
         [=](double u, double v) {
             const double theta = std::acos(-.5) + v * (std::acos(.75) - std::acos(-.5));
             return at(u, 2 * std::sin(theta), 2 * std::cos(theta));
         }},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(c.text);
        const Built scene = build("Shape " + c.text + " \"float phimax\" 250\n");
        for (double u = 0.1; u < 1; u += 0.2) {
            for (double v = 0.1; v < 1; v += 0.2) {
                const Vec3d p = c.point(u, v);
                const double h = 1e-5;
                const Vec3d du = (c.point(u + h, v) - c.point(u - h, v)) / (2 * h),
                            dv = (c.point(u, v + h) - c.point(u, v - h)) / (2 * h);
                const Vec3d n = normalize(cross(du, dv));
                const auto hit = first_hit(*scene.geometry, {Vec3f(p + n * 0.01), Vec3f(-n)});
                ASSERT_TRUE(hit);
                EXPECT_NEAR(hit->t, 0.01, 1e-5);
                const SurfaceCoordinates at_hit = scene.geometry->coordinates(*hit);
                EXPECT_NEAR(static_cast<double>(at_hit.uv.x), u, 1e-5);
                EXPECT_NEAR(static_cast<double>(at_hit.uv.y), v, 1e-5);
                EXPECT_LT(length(Vec3d(at_hit.dpdu) - du), 1e-3);
                EXPECT_LT(length(Vec3d(at_hit.dpdv) - dv), 1e-3);
                const auto normal = [&](double x, double y) {
                    return normalize(cross(c.point(x + h, y) - c.point(x - h, y), c.point(x, y + h) - c.point(x, y - h)));
                };
                const double k = 1e-3;
                EXPECT_LT(length(Vec3d(at_hit.dndu) - (normal(u + k, v) - normal(u - k, v)) / (2 * k)), 1e-2);
                EXPECT_LT(length(Vec3d(at_hit.dndv) - (normal(u, v + k) - normal(u, v - k)) / (2 * k)), 1e-2);
            }
        }
    }
}

// What makes a render repeatable: the same scene, the same level, the same bits.
TEST(Geometry, RebuildingGivesTheSameBits) {
    Random random, rays;
    const std::string text = soup(500, 0.3f, random) + "Shape \"sphere\" \"float radius\" 0.4\n";
    const Built a = build(text, "sse4.2"), b = build(text, "sse4.2");
    for (int i = 0; i < 5000; ++i) {
        const Ray ray{rays.vector(2), rays.direction()};
        const auto x = first_hit(*a.geometry, ray), y = first_hit(*b.geometry, ray);
        ASSERT_EQ(x.has_value(), y.has_value());
        if (!x) continue;
        EXPECT_EQ(x->t, y->t);
        EXPECT_EQ(x->p, y->p);
        EXPECT_EQ(x->ns, y->ns);
    }
}

// Whatever went wrong before, the renderer goes on: such paths are counted as what they are, not a number.
TEST(Geometry, RaysThatAreNoneMeetNothing) {
    const Built scene = build("Shape \"sphere\"\n");
    for (const float bad : {std::nanf(""), kInfinity, -kInfinity, 1e30f}) {
        for (const Ray& ray : {Ray{{bad, 0, 0}, {0, 0, 1}}, Ray{{0, 0, -3}, {0, bad, 1}}}) {
            EXPECT_FALSE(first_hit(*scene.geometry, ray)) << bad;
            EXPECT_EQ(share_passed(*scene.geometry, ray), 0) << bad;
        }
    }
}

TEST(Geometry, EmptySceneHasNoHits) {
    const Built scene = build("");
    EXPECT_FALSE(first_hit(*scene.geometry, {{0, 0, 0}, {0, 0, 1}}));
    EXPECT_EQ(share_passed(*scene.geometry, {{0, 0, 0}, {0, 0, 1}}), 1);
    EXPECT_EQ(scene.geometry->radius(), 0);
}

}  // namespace
}  // namespace latent::render
