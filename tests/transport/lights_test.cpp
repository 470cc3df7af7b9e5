// Laws of lights: points and rays are drawn as their densities say, and both ways of asking give the same light.
#include <cmath>

#include "color/named_spectra.h"
#include "color/observer.h"
#include "render/light/light_set.h"
#include "tests/render/rays.h"
#include "tests/transport/chi_square.h"
#include "tests/transport/lit_floor.h"
#include "tests/transport/numbers.h"
#include "tests/transport/picture_mean.h"
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

struct LightCase {
    std::string name, text;
};
const char* const kFloor = "Shape \"trianglemesh\" \"point3 P\" [-9 -3 -9  9 -3 -9  0 -3 9] \"integer indices\" [0 1 2]\n";
const std::vector<LightCase> kAreas = {
    {"triangle",
     "AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" Shape \"trianglemesh\" \"point3 P\" [-1 2 0  2 1.5 0.5  0 3 1.5] "
     "\"integer indices\" [0 1 2]\n"},
    {"two-sided triangle",
     "AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" \"bool twosided\" true Shape \"trianglemesh\" \"point3 P\" [-1 2 "
     "0  2 1.5 0.5  0 3 1.5] "
     "\"integer indices\" [0 1 2]\n"},
    {"sphere",
     "AttributeBegin Translate 1 2 0.5 AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" Shape \"sphere\" \"float "
     "radius\" 0.8 AttributeEnd\n"},
    {"sphere from within",
     "AttributeBegin ReverseOrientation Translate 0.2 0.1 0 AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" Shape "
     "\"sphere\" \"float radius\" 2.5 "
     "AttributeEnd\n"},
    {"disk",
     "AttributeBegin Translate 1 2 3 AreaLightSource \"diffuse\" \"bool twosided\" true Shape \"disk\" \"float radius\" 2 "
     "\"float innerradius\" 0.5 \"float phimax\" 200 AttributeEnd\n"},
    {"two-sided ellipse with an exponent",
     "AttributeBegin Translate 1 2 3 Scale 1.5 0.6 1 AreaLightSource \"diffuse\" \"bool twosided\" true \"float "
     "latent:exponent\" 7 Shape \"disk\" \"float radius\" 1.4 AttributeEnd\n"},
};
// Their densities grow beyond all bounds along their edges, where numbers of a grid miss them.
const std::vector<LightCase> kRound = {
    {"cylinder",
     "AttributeBegin Translate 1 2 0.5 AreaLightSource \"diffuse\" \"bool twosided\" true Shape \"cylinder\" \"float radius\" 1.5 "
     "\"float zmin\" -1 \"float zmax\" 2 \"float phimax\" 250 AttributeEnd\n"},
    {"part of a sphere",
     "AttributeBegin Translate 1 2 0.5 AreaLightSource \"diffuse\" \"bool twosided\" true Shape \"sphere\" \"float radius\" 1.5 "
     "\"float zmin\" -1 \"float zmax\" 0.5 \"float phimax\" 250 AttributeEnd\n"},
};

Scene with_light(const std::string& light) {
    return scene_from("WorldBegin\nAttributeBegin\n" + light + "AttributeEnd\n" + kFloor);
}
LightRay ray_of(const Light& light, Numbers& u) {
    LightRay ray;
    const Uniform a = u(), b = u(), c = u(), d = u();
    light.sample_ray(a, b, c, d, ray);
    return ray;
}

// Directions from a point to the light follow pdf_of_point, found by casting rays at the geometry itself.
TEST(Lights, PointsOfAreaLightsFollowTheirDensity) {
    for (const LightCase& c : kAreas) {
        for (const Vec3f& from : {Vec3f{0, 0, 0}, Vec3f{0.3f, -1, 0.6f}}) {
            SCOPED_TRACE(c.name);
            const Scene scene = with_light(c.text);
            const std::unique_ptr<World> world = scene.world();
            const Light& light = world->lights()[0];
            Numbers u(2);
            expect_directions_follow({.sample = [&](std::uint32_t) -> std::optional<Vec3f> {
                                          LightPoint p;
                                          const Uniform x = u(), y = u();
                                          if (!light.sample_point(from, {}, x, y, p)) return std::nullopt;
                                          return p.wi;
                                      },
                                      .pdf_omega = [&](const Vec3f& w) -> double {
                                          const auto hit = first_hit(world->geometry(), {from, w});
                                          if (!hit || hit->emitter == kNone) return 0;
                                          if (!(light.pdf_direction(hit->ng, -w) > 0)) return 0;
                                          return static_cast<double>(light.pdf_omega(from, {}, {w, hit->p, hit->ng}));
                                      },
                                      .count = 40'000,
                                      .rows = 32,
                                      .columns = 64,
                                      .fine = 32});
        }
    }
}

TEST(Lights, DirectionsOfRaysFollowTheirDensity) {
    std::vector<LightCase> cases = {
        {"point", "LightSource \"point\" \"spectrum I\" \"stdillum-D65\"\n"},
        {"spot",
         "LightSource \"spot\" \"spectrum I\" \"stdillum-D65\" \"point3 from\" [0 1 0] \"point3 to\" [1 -1 0.5] \"float "
         "coneangle\" 40\n"},
        {"goniometric", "Rotate 50 1 2 3 LightSource \"goniometric\" \"string filename\" \"sky.exr\"\n"},
        {"projection", "Rotate 50 1 2 3 LightSource \"projection\" \"string filename\" \"sky.exr\" \"float fov\" 80\n"},
        {"uniform infinite", "LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"\n"},
        {"image infinite", "LightSource \"infinite\" \"string filename\" \"sky.exr\"\n"},
    };
    cases.insert(cases.end(), kAreas.begin(), kAreas.end());
    cases.insert(cases.end(), kRound.begin(), kRound.end());
    for (const LightCase& c : cases) {
        SCOPED_TRACE(c.name);
        const Scene scene = scene_under_sky("WorldBegin\nAttributeBegin\n" + c.text + "AttributeEnd\n" + kFloor);
        const std::unique_ptr<World> world = scene.world();
        const Light& light = world->lights()[0];
        Numbers u(4);
        const Vec3f z = light.has_area() ? Vec3f{0, 0, 1} : Vec3f{};  // directions from an area are looked at about its normal
        expect_directions_follow({.sample = [&](std::uint32_t) -> std::optional<Vec3f> {
                                      const LightRay ray = ray_of(light, u);
                                      EXPECT_FLOAT_EQ(ray.pdf_direction, light.pdf_direction(ray.at.ng, ray.d));
                                      return light.has_area() ? Frame::from_z(ray.at.ng).to_local(ray.d) : ray.d;
                                  },
                                  .pdf_omega = [&](const Vec3f& w) { return static_cast<double>(light.pdf_direction(z, w)); },
                                  .count = 60'000});
    }
}

// Where rays start: evenly on triangles and quadrics, and the disk across which a light at infinity shines. Each point becomes two
// numbers that are then even in [0, 1): counts of a 16 x 16 grid of them.
TEST(Lights, RaysStartEvenlyOnTheirLight) {
    struct StartCase {
        LightCase light;
        std::function<Vec2f(const Vec3f& p, const Geometry&)> even;
    };
    const auto turns = [](float y, float x) { return std::atan2(y, x) / (2 * kPi) + 0.5f; };
    const auto from_x = [](const Vec3f& d) {  // degrees about z
        const float degrees = std::atan2(d.y, d.x) * 180 / kPi;
        return degrees < 0 ? degrees + 360 : degrees;
    };
    const auto on_triangle = [](const Vec3f& p, const Geometry& geometry) {
        const Emitter& e = geometry.emitters()[0];
        const Vec3f n = cross(e.e1, e.e2), d = p - e.p;
        const float b1 = dot(cross(d, e.e2), n) / length_squared(n), b2 = dot(cross(e.e1, d), n) / length_squared(n);
        return Vec2f{(b1 + b2) * (b1 + b2), b2 / (b1 + b2)};
    };
    const auto on_sphere = [&](const Vec3f& p, const Geometry& geometry) {
        const Emitter& e = geometry.emitters()[0];
        const Vec3f d = (p - e.p) / e.radius;
        return Vec2f{0.5f * (1 + d.z), turns(d.y, d.x)};
    };
    const std::vector<StartCase> cases = {
        {kAreas[0], on_triangle},
        {kAreas[1], on_triangle},
        {kAreas[2], on_sphere},
        {kAreas[3], on_sphere},
        {kAreas[4],
         [&](const Vec3f& p, const Geometry& geometry) {
             const Vec3f d = p - geometry.emitters()[0].p;
             return Vec2f{(d.x * d.x + d.y * d.y - 0.25f) / 3.75f, from_x(d) / 200};
         }},
        {kRound[0],
         [&](const Vec3f& p, const Geometry& geometry) {
             const Vec3f d = p - geometry.emitters()[0].p;
             return Vec2f{(d.z + 1) / 3, from_x(d) / 250};
         }},
        {kRound[1],
         [&](const Vec3f& p, const Geometry& geometry) {
             const Vec3f d = p - geometry.emitters()[0].p;
             return Vec2f{(d.z + 1) / 1.5f, from_x(d) / 250};
         }},
        {{"distant", "LightSource \"distant\" \"point3 from\" [1 2 3] \"point3 to\" [0 0 0]\n"},
         [&](const Vec3f& p, const Geometry& geometry) {
             const Vec3f d = Frame::from_z(normalize(Vec3f{1, 2, 3})).to_local(p - geometry.center());
             return Vec2f{(d.x * d.x + d.y * d.y) / (geometry.radius() * geometry.radius()), turns(d.y, d.x)};
         }},
    };
    for (const StartCase& c : cases) {
        SCOPED_TRACE(c.light.name);
        const Scene scene = with_light(c.light.text);
        const std::unique_ptr<World> world = scene.world();
        const Light& light = world->lights()[0];
        constexpr int kSide = 16, kCount = 100'000;
        std::vector<double> counted(kSide * kSide);
        Numbers u(5);
        for (int n = 0; n < kCount; ++n) {
            const LightRay ray = ray_of(light, u);
            ASSERT_EQ(ray.pdf_position, light.pdf_position());
            const Vec2f cell = c.even(ray.at.p, world->geometry());
            const auto index = [](float x) { return static_cast<std::size_t>(std::clamp(x * kSide, 0.0f, kSide - 1.0f)); };
            ++counted[index(cell.x) * kSide + index(cell.y)];
        }
        expect_counts_follow(counted, std::vector<double>(counted.size(), static_cast<double>(kCount) / (kSide * kSide)));
    }
}

TEST(Lights, AreChosenAsOftenAsTheirProbabilitySays) {
    std::vector<double> weight;
    Numbers u(14);
    for (int i = 0; i < 37; ++i) weight.push_back(i % 5 == 0 ? 0.01 : static_cast<double>(u() * u()));
    const AliasTable table(weight);
    constexpr int kCount = 200'000;
    std::vector<double> counted(weight.size());
    for (int n = 0; n < kCount; ++n) ++counted[table.sample(u())];
    std::vector<double> expected;
    double whole = 0;
    for (std::uint32_t i = 0; i < weight.size(); ++i) {
        expected.push_back(kCount * static_cast<double>(table.probability(i)));
        whole += static_cast<double>(table.probability(i));
    }
    EXPECT_NEAR(whole, 1, 1e-5);
    expect_counts_follow(counted, expected);
}

// The sum over rays of emission x cosine / density is the light's power, known in closed form.
TEST(Lights, RaysCarryThePowerOfTheLight) {
    const std::vector<std::pair<LightCase, double>> cases = {
        {kAreas[2], kPi * 4 * kPi * 0.64},
        {{"point", "LightSource \"point\" \"spectrum I\" \"stdillum-D65\" \"float power\" 7\n"}, 7},
        {{"spot",
          "LightSource \"spot\" \"spectrum I\" \"stdillum-D65\" \"float power\" 7 \"float coneangle\" 50 \"float conedeltaangle\" "
          "20\n"},
         7},
        {{"area power",
          "AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" \"float power\" 5 Shape \"sphere\" \"float radius\" 0.8\n"},
         5},
    };
    for (const auto& [c, power] : cases) {
        SCOPED_TRACE(c.name);
        const Scene scene = with_light(c.text);
        const std::unique_ptr<World> world = scene.world();
        const Light& light = world->lights()[0];
        Numbers u(6);
        double sum = 0;
        constexpr int kCount = 40'000;
        for (int n = 0; n < kCount; ++n) {
            const LightRay ray = ray_of(light, u);
            sum += static_cast<double>(light.emission().scale * ray.cosine * ray.profile / (ray.pdf_position * ray.pdf_direction));
        }
        EXPECT_NEAR(sum / kCount, power, 0.01 * power);
    }
}

// The same for points that shine as a picture: of greys, so that any wavelength has it.
TEST(Lights, PicturesOfAPointCarryItsPower) {
    const Folder folder;
    std::vector<float> greys;
    for (int i = 0; i < 16; ++i) greys.insert(greys.end(), 3, static_cast<float>(i * i % 7));
    write_exr(folder / "greys.exr", 4, 4, greys);
    for (const std::string type : {"\"goniometric\"", "\"projection\" \"float fov\" 50"}) {
        const Scene scene = scene_of(load_scene(folder.write(
            "room.pbrt", "WorldBegin\nLightSource " + type + " \"string filename\" \"greys.exr\" \"float power\" 7\n")));
        const std::unique_ptr<World> world = scene.world();
        const Light& light = world->lights()[0];
        SampledSpectra spectra(world->library());
        WavelengthSampler(wavelength_density({}), 32).draw(1u << 31, spectra.wavelengths);
        spectra.start_sample();
        const float illuminant = spectra[light.emission().spectrum][0];
        Numbers u(16);
        double sum = 0;
        constexpr int kCount = 40'000;
        for (int n = 0; n < kCount; ++n) {
            const LightRay ray = ray_of(light, u);
            SampledSpectrum value(1.0f);
            ASSERT_TRUE(light.multiply_emission(ray.point(), ray.d, spectra, value));
            sum += static_cast<double>(value[0] / (illuminant * ray.pdf_direction));
        }
        EXPECT_NEAR(sum / kCount, 7, 0.01 * 7) << type;
    }
}

// From the top left of the picture, as seen from the light, and from a goniometric map's middle, which lies along y.
TEST(Lights, PicturesStandUpright) {
    const Folder folder;
    write_exr(folder / "dots.exr", 2, 2, {9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    const auto value = [&](const std::string& light, const Vec3f& d) {
        const Scene scene = scene_of(
            load_scene(folder.write("room.pbrt", "WorldBegin\nLightSource " + light + " \"string filename\" \"dots.exr\"\n")));
        const std::unique_ptr<World> world = scene.world();
        SampledSpectra spectra(world->library());
        WavelengthSampler(wavelength_density({}), 32).draw(1u << 31, spectra.wavelengths);
        spectra.start_sample();
        SampledSpectrum out(1.0f);
        return world->lights()[0].multiply_emission({}, normalize(d), spectra, out) ? out.max() : 0;
    };
    const std::string projection = "\"projection\" \"float fov\" 90";
    EXPECT_GT(value(projection, {-.9f, .9f, 1}), 0);
    for (const Vec3f& d :
         {Vec3f{.9f, .9f, 1}, Vec3f{-.9f, -.9f, 1}, Vec3f{-1.1f, .9f, 1}, Vec3f{-.9f, 1.1f, 1}, Vec3f{-.9f, .9f, -1}})
        EXPECT_EQ(value(projection, d), 0) << d.x << ", " << d.y << ", " << d.z;
    // The square's quarters meet along y of light space, and its rows follow z.
    EXPECT_GT(value("\"goniometric\"", {-.1f, 1, -.1f}), 0);
    for (const Vec3f& d : {Vec3f{.1f, 1, -.1f}, Vec3f{-.1f, 1, .1f}, Vec3f{.1f, 1, .1f}})
        EXPECT_EQ(value("\"goniometric\"", d), 0) << d.x << ", " << d.y << ", " << d.z;
}

TEST(Lights, OfPicturesLookAlikeToPathAndBdpt) {
    for (const std::string light : {"\"goniometric\" \"float scale\" .3", "\"projection\" \"float fov\" 70"}) {
        const Scene scene = scene_under_sky(floor_under_sky(3, ".1 .1 .1") +
                                            "Material \"conductor\" \"float roughness\" .3\nShape \"sphere\" \"float radius\" .4\n"
                                            "Translate .3 -.4 1.6\nRotate 170 1 .1 0\nLightSource " +
                                            light + " \"string filename\" \"sky.exr\"\n");
        expect_path_and_bdpt_agree(scene, 4096, 2048);
    }
}

TEST(Lights, AreChosenByTheirPowerAndNeverNot) {
    const std::string text =
        "WorldBegin LightSource \"point\" \"spectrum I\" \"stdillum-D65\" \"float scale\" 3\n"
        "LightSource \"point\" \"spectrum I\" \"stdillum-D65\" \"float scale\" 1\n"
        "LightSource \"point\" \"spectrum I\" [360 0 586.5 0 588.5 1 590.5 1 592.5 0 830 0] \"float scale\" 1\n";
    const std::unique_ptr<World> local = scene_from(text + kFloor).world();
    EXPECT_NEAR(local->lights().probability(0) / local->lights().probability(1), 3, 1e-4);
    EXPECT_GT(local->lights().probability(2), 0.05f);  // pbrt's four wavelengths miss this lamp altogether
    const std::unique_ptr<World> mixed =
        scene_from(text + "LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\" \"float scale\" 1e-6\n" + kFloor).world();
    EXPECT_NEAR(mixed->lights().probability(3), 0.5, 1e-6);
}

// `power` is that of each sphere, triangle and patch by itself, whether a patch is two triangles or not.
TEST(Lights, HaveTheRadianceOfThePowerOfTheirShape) {
    const std::string text =
        "WorldBegin AreaLightSource \"diffuse\" \"float power\" 6 \"float scale\" 2\n"
        "Shape \"sphere\" \"float radius\" 0.5\n"
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 2  3 0 2  3 4 2 ]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ 5 0 0  7 0 0  5 1 0  7 1 0 ]\n"
        "AreaLightSource \"diffuse\" \"float scale\" 5 \"bool twosided\" true\nShape \"trianglemesh\" \"point3 P\" [0 9 0  1 9 0  "
        "0 9 1]\n"
        "AreaLightSource \"diffuse\" \"float power\" 3 \"bool twosided\" true\nShape \"trianglemesh\" \"point3 P\" [0 8 0  1 8 0  "
        "0 8 1]\n";
    const Scene scene = scene_from(text);
    const std::unique_ptr<World> world = scene.world();
    const float expected[] = {2 * 6 / (kPi * kPi), 2 * 6 / (kPi * 6), 2 * 6 / (kPi * 2), 2 * 6 / (kPi * 2), 5,
                              3 / (kPi * 0.5f * 2)};
    ASSERT_EQ(world->lights().size(), std::size(expected));
    for (std::uint32_t i = 0; i < std::size(expected); ++i) EXPECT_FLOAT_EQ(world->lights()[i].emission().scale, expected[i]) << i;
}

// One id for each light that the scene gives, whatever it is made of: area lights first.
TEST(Lights, HaveTheIdOfTheirSource) {
    const std::string lamp =
        "Shape \"trianglemesh\" \"point3 P\" [0 0 3  1 0 3  0 1 3  1 1 3] \"integer indices\" [0 1 2  1 3 2]\n";
    const std::unique_ptr<World> world =
        scene_from("WorldBegin\nLightSource \"point\"\nLightSource \"infinite\"\nAttributeBegin AreaLightSource \"diffuse\"\n" +
                   lamp + "Shape \"sphere\"\nAttributeEnd\nAttributeBegin AreaLightSource \"diffuse\"\n" + lamp + "AttributeEnd\n")
            .world();
    std::vector<std::uint32_t> ids;
    for (std::uint32_t i = 0; i < world->lights().size(); ++i) ids.push_back(world->lights()[i].id());
    EXPECT_EQ(ids, (std::vector<std::uint32_t>{0, 0, 0, 1, 1, 2, 3}));
}

TEST(Lights, ASphereFromOutsideIsSeenUnderItsConeOnly) {
    const std::unique_ptr<World> world = with_light(kAreas[2].text).world();
    const Vec3f from{0, -1, 0}, to = Vec3f{1, 2, 0.5f} - from;
    const double sin2 = 0.64 / static_cast<double>(length_squared(to));
    const double solid_angle = 2 * std::numbers::pi * (1 - std::sqrt(1 - sin2));
    EXPECT_NEAR(world->lights()[0].pdf_omega(from, {}, {normalize(to), {1, 1.2f, 0.5f}, {0, -1, 0}}) * solid_angle, 1, 1e-4);
}

TEST(Lights, AUniformInfiniteLightIsDrawnByTheCosineToWhatItLights) {
    const std::unique_ptr<World> world = with_light("LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"\n").world();
    const Light& light = world->lights()[0];
    const Vec3f n = normalize(Vec3f{0.3f, -0.5f, 0.4f});
    for (const LightSampleContext& context : {LightSampleContext{}, LightSampleContext{n, false}, LightSampleContext{n, true}}) {
        Numbers u(8);
        expect_directions_follow({.sample = [&](std::uint32_t) -> std::optional<Vec3f> {
                                      LightPoint p;
                                      const Uniform x = u(), y = u();
                                      if (!light.sample_point({}, context, x, y, p)) return std::nullopt;
                                      return p.wi;
                                  },
                                  .pdf_omega = [&](const Vec3f& w) -> double {
                                      const bool behind = !context.both_sides && dot(w, context.n) < 0;
                                      return behind ? 0 : static_cast<double>(light.pdf_omega({}, context, {w}));
                                  },
                                  .count = 60'000});
    }
}

TEST(Lights, AnImageInfiniteLightIsDrawnByItsPixels) {
    const std::unique_ptr<World> world =
        scene_under_sky(
            "WorldBegin\nAttributeBegin Rotate 40 1 2 0 LightSource \"infinite\" \"string filename\" \"sky.exr\" AttributeEnd\n" +
            std::string(kFloor))
            .world();
    const Light& light = world->lights()[0];
    for (const LightSampleContext& context : {LightSampleContext{}, LightSampleContext{{0, 1, 0}, false}}) {
        Numbers u(15);
        expect_directions_follow(
            {.sample = [&](std::uint32_t) -> std::optional<Vec3f> {
                 LightPoint p;
                 const Uniform x = u(), y = u();
                 if (!light.sample_point({}, context, x, y, p)) return std::nullopt;
                 EXPECT_FLOAT_EQ(p.pdf_omega, light.pdf_omega({}, context, {p.wi}));
                 return p.wi;
             },
             .pdf_omega = [&](const Vec3f& w) { return static_cast<double>(light.pdf_omega({}, context, {w})); },
             .count = 60'000});
    }
}

class EnvironmentMapTest : public ::testing::Test {
 protected:
    EnvironmentMapTest() {
        image_->width = image_->height = 8;
        Numbers u(9);
        for (int i = 0; i < 8 * 8 * 3; ++i) image_->rgb.push_back(u() < 0.7f ? u() * 0.2f : 5 * u());
    }
    std::shared_ptr<ImageDescription> image_ = std::make_shared<ImageDescription>();
    Affined turned_{normalize(Vec3d{1, 0.2, 0}), normalize(Vec3d{-0.2, 1, 0}), {0, 0, 1}, {}};
    SpectrumLibrary library_;
};

TEST_F(EnvironmentMapTest, DirectionsFollowTheirDensity) {
    const EnvironmentMap map(image_, turned_, library_, color::RgbSpectra::kSmooth);
    Numbers u(10);
    expect_directions_follow({.sample = [&](std::uint32_t) -> std::optional<Vec3f> {
                                  const Uniform x = u(), y = u();
                                  return map.sample(x, y);
                              },
                              .pdf_omega = [&](const Vec3f& w) { return static_cast<double>(map.pdf_omega(w)); },
                              .count = 60'000});
}

TEST_F(EnvironmentMapTest, ContrastIsOneOverTheShareOfTheSkyThatShinesEvenly) {
    for (const int lit : {1, 16, 32, 64}) {
        image_->rgb.assign(8 * 8 * 3, 0.0f);
        std::fill_n(image_->rgb.begin(), 3 * lit, 2.0f);
        EXPECT_NEAR(EnvironmentMap(image_, turned_, library_, color::RgbSpectra::kSmooth).contrast(), 64.0 / lit, 1e-9);
    }
}

// The spectrum of each pixel, times the illuminant, has the pixel's linear sRGB.
TEST_F(EnvironmentMapTest, PixelsHaveTheirColour) {
    const EnvironmentMap map(image_, turned_, library_, color::RgbSpectra::kSmooth);
    const color::Spectrum& d65 = color::illuminant_d65();
    const std::uint32_t illuminant = library_.add(d65, Lookup::kNearestNm);
    const WavelengthSampler sampler(wavelength_density({}), 32);
    SampledSpectra spectra(library_);
    const color::Observer& observer = color::Observer::cie1931();
    const double norm = color::photometric_sum(d65);
    Numbers u(11);
    for (int n = 0; n < 20; ++n) {
        const Uniform a = u(), b = u();
        const Vec3f w = map.sample(a, b);
        const Vec3f local = normalize(Vec3f(turned_.inverse()->vector(Vec3d(w))));
        const Vec2f p = square_from_sphere(local);
        const float* rgb = &image_->rgb[3 * (static_cast<std::size_t>(p.y * 8) * 8 + static_cast<std::size_t>(p.x * 8))];
        std::array<double, 3> xyz{};
        constexpr int kOffsets = 512;
        for (int i = 0; i < kOffsets; ++i) {
            sampler.draw(static_cast<std::uint32_t>((i + 0.5) / kOffsets * 0x1p32), spectra.wavelengths);
            spectra.start_sample();
            SampledSpectrum value = spectra[illuminant];
            map.multiply(w, spectra, value);
            for (std::uint32_t wavelength = 0; wavelength < 32; ++wavelength) {
                const std::array<float, 3> response = observer(spectra.wavelengths.lambda_nm[wavelength]);
                for (std::size_t c = 0; c < 3; ++c) {
                    xyz[c] += static_cast<double>(value[wavelength] * spectra.wavelengths.weight[wavelength] * response[c]) / norm /
                              kOffsets;
                }
            }
        }
        const std::array<double, 3> back = color::RgbSpace::srgb().rgb_from_xyz * xyz;
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(back[c], rgb[c], 3e-3 * (rgb[0] + rgb[1] + rgb[2]));
    }
}

const std::string kFloorAndCeiling =
    "MediumInterface \"\" \"\"\n"
    "Material \"diffuse\" \"spectrum reflectance\" [360 0.6 830 0.5]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-4 0 -4  4 0 -4  4 0 4  -4 0 4] \"integer indices\" [0 2 1 0 3 2]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [-4 3 -4  4 3 -4  -4 3 4  4 3 4]\n";

const std::string kDown = "LookAt 0 2 -3.5  0 1.2 0  0 1 0\n";

// `view`: the camera's place and medium.
Scene scene_between(const std::string& view, const std::string& world) {
    return scene_from(view + "Camera \"perspective\" \"float fov\" 35\nIntegrator \"path\" \"integer maxdepth\" 5\nWorldBegin\n" +
                      kFloorAndCeiling + world);
}

void expect_equal(const Mean& a, const Mean& b) {
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(a.xyz[c], b.xyz[c], 4.5 * std::hypot(a.error[c], b.error[c]));
        EXPECT_LT(a.error[c] + b.error[c], 0.03 * a.xyz[c]);
    }
}

// A lamp, or the camera's lens, in the plane of a floor or ceiling: that surface is not in the way of light.
TEST(PointsOnSurfaces, PathAndBdptSeeTheSamePicture) {
    for (const char* light : {"LightSource \"point\" \"float scale\" 8 \"point3 from\" [0.3 3 0.2]\n",
                              "LightSource \"point\" \"float scale\" 8 \"point3 from\" [0.3 0 0.2]\n",
                              "LightSource \"spot\" \"float scale\" 8 \"point3 from\" [0.3 3 0.2] \"point3 to\" [0 0 0]\n"}) {
        const Scene scene = scene_between(kDown, light);
        expect_equal(mean_of_picture(scene, {.kind = IntegratorKind::kPath, .seed = 1}, 40'000),
                     mean_of_picture(scene, {.kind = IntegratorKind::kBdpt, .seed = 2}, 40'000));
    }
    // A pinhole on the floor sees what one just above it does.
    const std::string sky = "LightSource \"infinite\"\n";
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt})
        expect_equal(
            mean_of_picture(scene_between("LookAt 0 0 -3.5  0 1.2 0  0 1 0\n", sky), {.kind = kind, .seed = 1}, 40'000),
            mean_of_picture(scene_between("LookAt 0 1e-4 -3.5  0 1.2 0  0 1 0\n", sky), {.kind = kind, .seed = 2}, 40'000));
}

// A lamp, or the camera's lens, on an interface between media is on both of its sides, whichever it was given.
TEST(PointsOnSurfaces, AreInTheMediumOnTheSideThatALineLeadsTo) {
    const std::string fog =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" [360 0 830 0] \"spectrum sigma_s\" [360 0.7 "
        "830 0.9]\n";
    const auto ball = [](double radius) {
        return fmt::format(
            "AttributeBegin\nMediumInterface \"fog\" \"\"\nMaterial \"interface\"\nTranslate 0 1.2 0\nShape \"sphere\" \"float "
            "radius\" {:.17g}\nAttributeEnd\n",
            radius);
    };
    const auto lamp = [](const char* medium) {
        return fmt::format(
            "AttributeBegin\nMediumInterface \"\" \"{}\"\nLightSource \"point\" \"float scale\" 8 \"point3 from\" [0 2.1 "
            "0]\nAttributeEnd\n",
            medium);
    };
    const Mean by_path =
        mean_of_picture(scene_between(kDown, fog + ball(0.9) + lamp("")), {.kind = IntegratorKind::kPath}, 160'000);
    for (const char* medium : {"", "fog"})
        expect_equal(by_path, mean_of_picture(scene_between(kDown, fog + ball(0.9) + lamp(medium)),
                                              {.kind = IntegratorKind::kBdpt, .seed = 2}, 40'000));

    const std::string world = ball(std::hypot(0.8, 3.5)) + "LightSource \"infinite\"\n",
                      in_fog = fog + "MediumInterface \"\" \"fog\"\n";
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        const auto picture = [&](const std::string& view, std::uint64_t seed) {
            return mean_of_picture(scene_between(view, world), {.kind = kind, .seed = seed}, 20'000);
        };
        const std::string out = "LookAt 0 2 -3.5  0 1.2 -7  0 1 0\n";
        EXPECT_EQ(picture(fog + kDown, 1).xyz, picture(in_fog + kDown, 1).xyz);
        EXPECT_EQ(picture(fog + out, 1).xyz, picture(in_fog + out, 1).xyz);
        expect_equal(picture(fog + kDown, 1), picture(in_fog + "LookAt 0 2 -3.4999  0 1.2 0  0 1 0\n", 2));
        expect_equal(picture(in_fog + out, 1), picture(fog + "LookAt 0 2 -3.5001  0 1.2 -7  0 1 0\n", 2));
    }
}

// Whose walls, as they are no interfaces, say nothing of the vacuum outside.
TEST(Furnace, BdptSeesTheSkyThroughTheWindowOfAFoggyRoom) {
    const Scene scene = scene_from(
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" [360 .02 830 .01] \"spectrum sigma_s\" [360 "
        ".1 830 "
        ".2]\nMediumInterface \"\" \"fog\"\nLookAt 0 0 -1.9  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 60\nIntegrator "
        "\"volpath\" \"integer maxdepth\" 4\nWorldBegin\nMediumInterface \"\" \"\"\nLightSource \"infinite\"\n"
        "Material \"diffuse\" \"spectrum reflectance\" [360 .7 830 .6]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-1 -1 -2  1 -1 -2  1 1 -2  -1 1 -2  -1 -1 2  1 -1 2  1 1 2  -1 1 2] \"integer "
        "indices\" [0 "
        "1 2 0 2 3  4 5 6 4 6 7  0 1 5 0 5 4  2 3 7 2 7 6  0 3 7 0 7 4]\n"
        "Shape \"trianglemesh\" \"point3 P\" [1 -1 -4  5 -1 -4  5 -1 4  1 -1 4] \"integer indices\" [0 2 1 0 3 2]\n"
        "MediumInterface \"fog\" \"\"\nMaterial \"interface\"\n"
        "Shape \"trianglemesh\" \"point3 P\" [1 -1 -2  1 1 -2  1 1 2  1 -1 2] \"integer indices\" [0 1 2 0 2 3]\n");
    expect_equal(mean_of_picture(scene, {.kind = IntegratorKind::kPath, .seed = 1}, 40'000),
                 mean_of_picture(scene, {.kind = IntegratorKind::kBdpt, .seed = 2}, 40'000));
}

// What is near an interface is not on it, however large the scene is.
TEST(PointsOnSurfaces, DoNotIncludeThoseNearThem) {
    const std::string fog =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" [360 40 830 40]\nMediumInterface \"\" "
        "\"fog\"\n";
    const auto picture = [&](double radius) {
        return mean_of_picture(
            scene_between(fog + kDown,
                          fmt::format("LightSource \"infinite\"\nMaterial \"interface\"\nMediumInterface \"fog\" "
                                      "\"\"\nAttributeBegin\nTranslate 0 2 -3.5\nShape \"sphere\" \"float radius\" "
                                      "0.02\nAttributeEnd\nMediumInterface \"\" \"\"\nTranslate 0 -1 0\nShape \"disk\" "
                                      "\"float radius\" {}\n",
                                      radius)),
            {.kind = IntegratorKind::kPath}, 1'000);
    };
    EXPECT_NEAR(picture(2e5).xyz[1], picture(5).xyz[1], 1e-5);
}

}  // namespace
}  // namespace latent::render::testing
