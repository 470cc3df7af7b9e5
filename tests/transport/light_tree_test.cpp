// Laws of the choice of lights by place: what is chosen is chosen as often as is said, and no light that shines is left out.
#include <array>

#include "render/spectral/wavelength_density.h"
#include "tests/transport/chi_square.h"
#include "tests/transport/lit_floor.h"
#include "tests/transport/many_lights.h"
#include "tests/transport/numbers.h"
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

// Every kind of light that is somewhere, and a sky.
Scene all_kinds() {
    return scene_under_sky(
        "WorldBegin\nLightSource \"infinite\" \"string filename\" \"sky.exr\"\nLightSource \"point\" \"point3 from\" [2 1 1]\n"
        "LightSource \"spot\" \"point3 from\" [-2 0 2] \"point3 to\" [0 0.5 0] \"float coneangle\" 40 \"float conedeltaangle\" 35\n"
        "LightSource \"spot\" \"point3 from\" [-2 0 -2] \"point3 to\" [0 0.5 0] \"float coneangle\" 120 \"float conedeltaangle\" "
        "5\n"
        "AttributeBegin Translate 0 2 -1 Rotate 120 1 2 0 LightSource \"goniometric\" \"string filename\" \"sky.exr\" "
        "AttributeEnd\n"
        "AttributeBegin Translate 1 -2 -1 Rotate 50 1 2 0 LightSource \"projection\" \"string filename\" \"sky.exr\" \"float fov\" "
        "80 "
        "AttributeEnd\n"
        "AttributeBegin AreaLightSource \"diffuse\" Shape \"trianglemesh\" \"point3 P\" [-1 2 0  2 1.5 .5  0 3 1.5] AttributeEnd\n"
        "AttributeBegin AreaLightSource \"diffuse\" \"bool twosided\" true\nShape \"trianglemesh\" \"point3 P\" [-1 -2 0  2 -1.5 "
        ".5  0 "
        "-3 1.5  1 -1 -1] \"integer indices\" [0 1 2  1 2 3] AttributeEnd\n"
        "AttributeBegin AreaLightSource \"diffuse\" \"float latent:exponent\" 6 Translate -1 -1 1 Scale 1.5 .6 1\n"
        "Shape \"disk\" \"float radius\" .7 AttributeEnd\n"
        "AttributeBegin AreaLightSource \"diffuse\" Translate 3 0 0 Shape \"sphere\" \"float radius\" .4 AttributeEnd\n"
        "AttributeBegin ReverseOrientation AreaLightSource \"diffuse\" Shape \"sphere\" \"float radius\" 9 AttributeEnd\n"
        "AttributeBegin AreaLightSource \"diffuse\" Translate -3 1 0 Shape \"cylinder\" \"float radius\" .3 \"float phimax\" 200 "
        "AttributeEnd\n"
        "AttributeBegin AreaLightSource \"diffuse\" Translate 0 0 3 Shape \"sphere\" \"float radius\" .5 \"float zmin\" -.1 "
        "AttributeEnd\n");
}

Vec3f point_of(Numbers& u, float reach) {
    const float x = u(), y = u(), z = u();
    return Vec3f{2 * x - 1, 2 * y - 1, 2 * z - 1} * reach;
}
// A vertex on a surface, on one that lets light pass, or in a medium.
LightSampleContext vertex_of(Numbers& u, int n) {
    const Uniform a = u(), b = u();
    return n % 3 == 0 ? LightSampleContext{} : LightSampleContext{sample_sphere(a, b), n % 3 == 1};
}

TEST(LightTree, ChoosesEachLightAsOftenAsItsProbabilitySays) {
    for (const Scene& scene : {all_kinds(), scene_from(corridor(60)), scene_from(shining_ring(8))}) {
        const std::unique_ptr<World> world = scene.world();
        const LightSet& lights = world->lights();
        ASSERT_TRUE(lights.has_tree());
        Numbers u(3);
        for (int n = 0; n < 24; ++n) {
            const Vec3f p = point_of(u, 4);
            const LightSampleContext context = vertex_of(u, n);
            constexpr double kDraws = 20'000;
            std::vector<double> counted(lights.size() + 1), expected(lights.size() + 1);  // the last one: none
            double sum = 0;
            for (std::uint32_t i = 0; i < lights.size(); ++i) {
                sum += static_cast<double>(lights.probability(i, p, context));
                expected[i] = kDraws * static_cast<double>(lights.probability(i, p, context));
            }
            EXPECT_LT(sum, 1 + 1e-5);
            expected.back() = kDraws * std::max(0.0, 1 - sum);
            for (double i = 0; i < kDraws; ++i) {
                const ChosenLight chosen = lights.choose(u(), p, context);
                if (chosen.probability > 0) {
                    ASSERT_EQ(chosen.probability, lights.probability(chosen.light, p, context));
                    ++counted[chosen.light];
                } else {
                    ++counted.back();
                }
            }
            std::vector<double> often, expected_often;  // the rare ones together
            double rare = 0, expected_rare = 0;
            for (std::size_t i = 0; i < counted.size(); ++i) {
                if (expected[i] >= 10) {
                    often.push_back(counted[i]);
                    expected_often.push_back(expected[i]);
                } else {
                    rare += counted[i];
                    expected_rare += expected[i];
                }
            }
            if (expected_rare >= 10) {
                often.push_back(rare);
                expected_often.push_back(expected_rare);
            } else {
                EXPECT_LT(rare, 40);
            }
            if (often.size() > 10) expect_counts_follow(often, expected_often);
        }
    }
}

// In a medium all points of light shine everywhere, so one is always chosen.
TEST(LightTree, ProbabilitiesOfLightsThatAllShineAddUpToOne) {
    const std::unique_ptr<World> world = scene_from(points_of_light(9, false)).world();
    Numbers u(5);
    for (int n = 0; n < 200; ++n) {
        const Vec3f p = point_of(u, n % 2 == 0 ? 3 : 3000);
        double sum = 0;
        for (std::uint32_t i = 0; i < world->lights().size(); ++i)
            sum += static_cast<double>(world->lights().probability(i, p, {}));
        EXPECT_NEAR(sum, 1, 1e-5);
    }
}

TEST(LightTree, LeavesOutNoLightThatShines) {
    const std::unique_ptr<World> world = all_kinds().world();
    const LightSet& lights = world->lights();
    Numbers u(7);
    SampledSpectra spectra(world->library());
    WavelengthSampler(wavelength_density(lights.spectra()), 4).draw(1u << 31, spectra.wavelengths);
    spectra.start_sample();
    std::vector<int> seen(lights.size());
    for (int n = 0; n < 200'000; ++n) {
        const auto i = static_cast<std::uint32_t>(n) % static_cast<std::uint32_t>(lights.size());
        Vec3f p = point_of(u, n % 5 == 0 ? 40 : 4);
        const LightSampleContext context = vertex_of(u, n / 16);
        const Uniform a = u(), b = u();
        if (n % 7 == 0 && lights[i].has_area()) {  // at the light, almost
            LightRay ray;
            lights[i].sample_ray(a, b, u(), u(), ray);
            p = ray.at.p + ray.d * (u() * 1e-3f);
        }
        LightPoint point;
        if (!lights[i].sample_point(p, context, a, b, point)) continue;
        const float cosine = dot(context.n, point.wi);
        if (!(context.n == Vec3f{}) && !(context.both_sides ? cosine != 0 : cosine > 0)) continue;
        SampledSpectrum value(1.0f);
        if (!lights[i].multiply_emission(point.point(), -point.wi, spectra, value)) continue;
        ++seen[i];
        EXPECT_GT(lights.probability(i, p, context), 0) << i;
    }
    for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_GT(seen[i], 100) << i;
}

// Where no lamp shines, all choices are left to the sky.
TEST(LightTree, AsksTheSkyAloneBehindAllLamps) {
    const std::unique_ptr<World> world = scene_from(corridor(20) + "LightSource \"infinite\" \"float scale\" .1\n").world();
    const LightSet& lights = world->lights();
    const std::uint32_t sky = lights.infinite().at(0);
    EXPECT_EQ(lights.probability(sky, {0, 0, 40}, {{0, 0, 1}}), 1);
    EXPECT_EQ(lights.probability(sky, {0, 0, 1}, {{0, 0, 1}}), 0.5f);
    EXPECT_EQ(lights.probability(0, {0, 0, 40}, {{0, 0, 1}}), 0);
}

TEST(LightTree, BoundsHoldTheRaysOfTheirLights) {
    const std::unique_ptr<World> world = all_kinds().world();
    const LightSet& lights = world->lights();
    Numbers u(9);
    LightBounds all;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        if (lights[i].is_infinite()) continue;
        const LightBounds b = lights[i].bounds();
        all = i == 0 ? b : all + b;
        for (const LightBounds& bounds : {b, all}) {
            for (int n = 0; n < 2000; ++n) {
                LightRay ray;
                const Uniform a1 = u(), a2 = u(), a3 = u(), a4 = u();
                lights[i].sample_ray(a1, a2, a3, a4, ray);
                EXPECT_LE(length(Vec3d(ray.at.p) - bounds.center), bounds.radius + 1e-5);
                EXPECT_LE(length(bounds.box.nearest(Vec3d(ray.at.p)) - Vec3d(ray.at.p)), 1e-5);
                const double cosine = dot(bounds.axis, Vec3d(ray.d)),
                             angle = std::acos(std::clamp(bounds.both_sides ? std::abs(cosine) : cosine, -1.0, 1.0));
                EXPECT_LE(angle / (2 * std::numbers::pi), static_cast<double>(bounds.spread + bounds.falloff) + 1e-4) << i;
            }
        }
    }
}

// Positions that halve from one to the next make the most uneven splits; equal ones make none.
TEST(LightTree, IsNeverTooDeep) {
    std::vector<LightBounds> bounds(100'000);
    for (std::size_t i = 0; i < bounds.size(); ++i) {
        const double x = i < 1000 ? std::ldexp(1.0, -static_cast<int>(i)) : i < 50'000 ? 0 : static_cast<double>(i % 317);
        bounds[i] = LightBounds::from_ball({x, i < 50'000 ? 0 : static_cast<double>(i % 211), x * x}, 0);
        bounds[i].intensity = i % 10 == 3 ? 0 : 1 + static_cast<double>(i % 7);
    }
    const LightTree tree(bounds);
    EXPECT_LE(tree.depth(), LightTree::kMaxDepth);
    Numbers u(11);
    for (int n = 0; n < 1000; ++n) {
        const Vec3f p = point_of(u, 400);
        const ChosenLight chosen = tree.choose(u(), p, {});
        ASSERT_GT(chosen.probability, 0);
        EXPECT_EQ(chosen.probability, tree.probability(chosen.light, p, {}));
        EXPECT_NE(chosen.light % 10, 3u);
    }
    double sum = 0;
    for (std::uint32_t i = 0; i < bounds.size(); ++i) sum += static_cast<double>(tree.probability(i, {3, 5, 7}, {}));
    EXPECT_NEAR(sum, 1, 1e-4);
}

// The normal of a triangle whose sides are 1e29 long is 0 or no number, and its area is infinite.
TEST(LightTree, HoldsLightsTooLargeForNumbers) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    std::vector<LightBounds> bounds(9);
    for (std::size_t i = 0; i < bounds.size(); ++i) {
        bounds[i] = LightBounds::from_ball({i % 3 == 0 ? 3e38 : static_cast<double>(i), 0, 1}, i % 3 == 1 ? 1e38 : 0.1);
        bounds[i].point({i % 3 == 2 ? kNan : 0, 0, i % 4 == 3 ? 0.0 : 1.0}, 0, 0.25f);
        bounds[i].intensity = i % 4 == 0 ? 1e300 : i % 4 == 1 ? std::numeric_limits<double>::infinity() : 1;
    }
    const LightTree tree(bounds);
    Numbers u(13);
    for (int n = 0; n < 1000; ++n) {
        const Vec3f p = point_of(u, n % 2 == 0 ? 4 : 1e38f);
        const ChosenLight chosen = tree.choose(u(), p, vertex_of(u, n));
        if (chosen.light >= bounds.size()) continue;
        EXPECT_GT(chosen.probability, 0);
        EXPECT_LE(chosen.probability, 1);
    }
}

// Such scenes keep their records.
TEST(LightTree, IsNotNeededForOneLamp) {
    EXPECT_FALSE(scene_named("cornell.pbrt").world()->lights().has_tree());
    EXPECT_FALSE(scene_from(floor_under_spot()).world()->lights().has_tree());
    EXPECT_FALSE(
        scene_from(floor_under_spot() + "LightSource \"infinite\"\nLightSource \"distant\"\n").world()->lights().has_tree());
    EXPECT_TRUE(scene_from(three_lamps()).world()->lights().has_tree());
}

// A lamp alone needs no tree.
TEST(LightTree, APictureOfLampsIsTheSumOfThePicturesOfEach) {
    std::vector<Estimate> each;
    for (const unsigned lamp : {1U, 2U, 4U}) {
        const Scene alone = scene_from(three_lamps(lamp));
        EXPECT_FALSE(alone.world()->lights().has_tree());
        each.push_back(picture_of(alone, {}, 12'288));
    }
    const Scene scene = scene_from(three_lamps());
    expect_equal(picture_of(scene, {}, 12'288), sum_of(each));
    expect_equal(picture_of(scene, {.kind = IntegratorKind::kBdpt}, 8192), sum_of(each));
}

TEST(LightTree, PathAndBdptAgreeOnThePicture) {
    const std::string sky = "LightSource \"infinite\" \"float scale\" .1\n";
    for (const std::string& text : {corridor(24) + sky, shining_ring(8) + sky, points_of_light(4, true)})
        expect_path_and_bdpt_agree(scene_from(text), 8192, 4096);
}

}  // namespace
}  // namespace latent::render::testing
