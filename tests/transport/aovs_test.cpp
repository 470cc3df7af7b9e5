// Laws of what samples see beside light.
#include "render/transport/aovs.h"

#include <gmock/gmock.h>

#include <cmath>

#include "base/bytes.h"
#include "color/named_spectra.h"
#include "color/observer.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {
namespace {

constexpr AovSettings kAll{.albedo = true, .normal = true, .depth = true, .position = true, .id = true};

sampledb::Records trace(const Scene& scene, const IntegratorSettings& settings, std::uint64_t end) {
    sampledb::Records records;
    RadianceFaults faults;
    const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
    for (std::uint64_t n = 0; n < end; ++n) integrator->trace(n, records, faults);
    EXPECT_EQ(faults.total(), 0u);
    return records;
}

float value(const sampledb::Records& records, const std::string& name, std::size_t row) {
    for (const sampledb::ExtraColumn& column : records.extra) {
        if (column.name != name) continue;
        const std::byte* const at = column.values.data() + 4 * row;
        return column.type == sampledb::ColumnType::kU32 ? static_cast<float>(load_le<std::uint32_t>(at)) : load_le<float>(at);
    }
    ADD_FAILURE() << name;
    return 0;
}
Vec3f vector(const sampledb::Records& records, const std::string& name, std::size_t row) {
    return {value(records, name + ".x", row), value(records, name + ".y", row), value(records, name + ".z", row)};
}

// Camera records of XYZ.
sampledb::Records seen_in(const std::string& text, std::uint64_t samples = 500) {
    return trace(scene_from(text), {.record = sampledb::RecordKind::kXyz, .seed = 3, .aovs = kAll}, samples);
}

constexpr const char* kView =
    "LookAt 0 -3 3  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 40\nWorldBegin\n"
    "LightSource \"infinite\"\n";
constexpr const char* kGreyFloor =
    "Material \"diffuse\" \"spectrum reflectance\" [360 .5 830 .5]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [-9 -9 0  9 -9 0  -9 9 0  9 9 0]\n";

TEST(Aovs, ChangeNoBitOfTheLight) {
    const Scene scene = scene_named("cornell.pbrt");
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        IntegratorSettings settings{.kind = kind, .seed = 5};
        const sampledb::Records plain = trace(scene, settings, 400);
        settings.aovs = kAll;
        const sampledb::Records rich = trace(scene, settings, 400);
        EXPECT_EQ(plain.power, rich.power);
        EXPECT_EQ(plain.u, rich.u);
        EXPECT_EQ(plain.v, rich.v);
        EXPECT_EQ(plain.share, rich.share);
        EXPECT_EQ(plain.pairs, rich.pairs);
        EXPECT_EQ(plain.record_class, rich.record_class);
        EXPECT_TRUE(plain.extra.empty());
        ASSERT_EQ(rich.extra.size(), 12u);
        for (const sampledb::ExtraColumn& column : rich.extra) EXPECT_EQ(column.values.size(), 4 * rich.size());
    }
}

TEST(Aovs, AreThoseOfPathAndBdptAlikeAndZeroInLightRecords) {
    const Scene scene = scene_named("cornell.pbrt");
    const IntegratorSettings path{.record = sampledb::RecordKind::kXyz, .seed = 5, .aovs = kAll};
    IntegratorSettings bdpt = path;
    bdpt.kind = IntegratorKind::kBdpt;
    const sampledb::Records a = trace(scene, path, 1000), b = trace(scene, bdpt, 1000);
    std::size_t camera = 0, light = 0;
    for (std::size_t row = 0; row < b.size(); ++row) {
        const bool is_camera = b.record_class[row] == sampledb::RecordClass::kCamera;
        for (std::size_t i = 0; i < b.extra.size(); ++i) {
            const auto at = [](const sampledb::ExtraColumn& column, std::size_t r) {
                return load_le<std::uint32_t>(column.values.data() + 4 * r);
            };
            EXPECT_EQ(at(b.extra[i], row), is_camera ? at(a.extra[i], camera) : 0) << b.extra[i].name << row;
        }
        ++(is_camera ? camera : light);
    }
    EXPECT_EQ(camera, 1000u);
    EXPECT_GT(light, 100u);
}

// With groups of lights, a sample may have several records, which all say the same.
TEST(Aovs, StandBesideLightGroupsInEachRecord) {
    Scene scene =
        scene_from(std::string(kView) + "LightSource \"point\" \"point3 from\" [0 0 4] \"string name\" \"lamp\"\n" + kGreyFloor);
    auto names = group_lights(scene.description);
    if (!names) GTEST_SKIP() << names.error().message;
    IntegratorSettings settings{.record = sampledb::RecordKind::kXyz, .seed = 3, .aovs = kAll};
    settings.light_groups = groups_of(scene.description, names->size());
    const sampledb::Records records = trace(scene, settings, 300);
    ASSERT_EQ(records.extra.size(), 13u);
    EXPECT_EQ(records.extra[0].name, "light_group");
    EXPECT_GT(records.size(), 400u);
    for (std::size_t row = 1; row < records.size(); ++row) {
        EXPECT_NEAR(vector(records, "normal", row).z, 1, 1e-3);
        if (records.sample[row] == records.sample[row - 1]) {
            EXPECT_EQ(value(records, "depth", row), value(records, "depth", row - 1));
        }
    }
}

// Each wavelength of a sample is at a film point of its own, and says what the sample's ray sees: if the focal distances differ by
// almost nothing, what a lens with one of them sees.
TEST(Aovs, OfALensThatSplitsWavelengthsAreInEachRecordThatOfItsRay) {
    const auto text = [](const std::string& focal) {
        return "LookAt 0 -3 3  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 40 \"float lensradius\" .2 " + focal +
               "\nWorldBegin\nLightSource \"infinite\"\n" + kGreyFloor + "Shape \"sphere\" \"float radius\" .5\n";
    };
    const sampledb::Records one = seen_in(text("\"float focaldistance\" 3")),
                            split = seen_in(text("\"float latent:focaldistances\" [ 2.9999 3.0001 ]"));
    ASSERT_EQ(one.size(), 500u);
    EXPECT_EQ(split.size(), 28 * one.size());
    std::vector<float> shares(one.size()), depths(one.size());
    int same = 0;
    for (std::size_t row = 0; row < split.size(); ++row) {
        const std::size_t n = split.sample[row];
        shares[n] += split.share[row];
        depths[n] += split.share[row] * value(split, "depth", row);
        same += value(split, "object", row) == value(one, "object", n) &&
                value(split, "material", row) == value(one, "material", n) &&
                length(vector(split, "position", row) - vector(one, "position", n)) < 1e-3f &&
                length(vector(split, "normal", row) - vector(one, "normal", n)) < 4e-3f;
    }
    for (std::size_t n = 0; n < one.size(); ++n) {
        EXPECT_NEAR(shares[n], 1, 1e-5);
        EXPECT_NEAR(depths[n], value(one, "depth", n), 2e-2);
    }
    EXPECT_GT(same, 0.99 * static_cast<double>(split.size()));  // but on edges
}

TEST(Aovs, ADepthLeadsFromTheLensToThePositionOnTheFirstSurface) {
    const std::string text = std::string(kView) + kGreyFloor + "Material \"dielectric\"\nShape \"sphere\" \"float radius\" .5\n";
    for (const double distance : {0.0, 1024.0}) {
        const sampledb::Records records = seen_in(moved(text, distance));
        const auto offset = static_cast<float>(distance);
        int spheres = 0;
        for (std::size_t row = 0; row < records.size(); ++row) {
            const Vec3f p = vector(records, "position", row) - Vec3f{offset, offset, offset};
            EXPECT_NEAR(length(p - Vec3f{0, -3, 3}), value(records, "depth", row), 3e-4);
            const bool sphere = value(records, "object", row) == 2;
            spheres += sphere;
            if (sphere) {
                EXPECT_NEAR(length(p), 0.5f, 3e-4);
            } else {
                EXPECT_NEAR(p.z, 0, 3e-4);
            }
            const auto material = static_cast<std::size_t>(value(records, "material", row)) - 1;
            EXPECT_EQ(scene_from(text).description.materials[material].type == "dielectric", sphere);
        }
        EXPECT_GT(spheres, 10);
        EXPECT_LT(spheres, 480);
    }
}

TEST(Aovs, OfNothingAreZeroAndInfinitelyFar) {
    const sampledb::Records records = seen_in(
        "LookAt 0 -3 3  0 -3 9  0 1 0\nCamera \"perspective\"\nWorldBegin\n"
        "LightSource \"infinite\"\n" +
            std::string(kGreyFloor),
        20);
    for (std::size_t row = 0; row < records.size(); ++row) {
        EXPECT_EQ(value(records, "depth", row), kInfinity);
        EXPECT_EQ(vector(records, "albedo", row), Vec3f());
        EXPECT_EQ(vector(records, "normal", row), Vec3f());
        EXPECT_EQ(vector(records, "position", row), Vec3f());
        EXPECT_EQ(value(records, "object", row), 0);
        EXPECT_EQ(value(records, "material", row), 0);
    }
}

// White has Y = 1; each sample has its own wavelengths, and grey is grey in all of them.
TEST(Aovs, AGreyAlbedoHasNoNoise) {
    const sampledb::Records records = seen_in(std::string(kView) + kGreyFloor);
    const color::Observer& observer = color::Observer::cie1931();
    const double y = color::integral_of_product(color::illuminant_d65(), observer.curve(1));
    for (std::size_t row = 0; row < records.size(); ++row) {
        const Vec3f albedo = vector(records, "albedo", row);
        const double xyz[] = {albedo.x, albedo.y, albedo.z};
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(xyz[c], 0.5 * color::integral_of_product(color::illuminant_d65(), observer.curve(c)) / y, 5e-4);
    }
}

// Over 500 samples of 28 wavelengths each; the spread of one is below 0.02.
TEST(Aovs, AColouredAlbedoIsItsColourUnderD65) {
    const sampledb::Records records = seen_in(std::string(kView) +
                                              "Material \"diffuse\" \"spectrum reflectance\" [360 .1 500 .2 600 .9 830 .9]\n"
                                              "Shape \"bilinearmesh\" \"point3 P\" [-9 -9 0  9 -9 0  -9 9 0  9 9 0]\n");
    const auto reflectance = color::Spectrum::from_samples({360, 500, 600, 830}, {.1, .2, .9, .9}, color::Outside::kClamped);
    ASSERT_TRUE(reflectance);
    const color::Observer& observer = color::Observer::cie1931();
    double sum[3] = {}, expected[3] = {}, y = 0;
    for (std::size_t row = 0; row < records.size(); ++row) {
        const Vec3f albedo = vector(records, "albedo", row);
        sum[0] += albedo.x, sum[1] += albedo.y, sum[2] += albedo.z;
    }
    for (double nm = 360; nm <= 830; nm += 0.5) {
        const double light = color::illuminant_d65()(nm);
        y += light * observer.curve(1)(nm);
        for (int c = 0; c < 3; ++c) expected[c] += light * observer.curve(c)(nm) * (*reflectance)(nm);
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / 500, expected[c] / y, 0.005) << c;
}

// Seen from above in a mirror that leans by 45 degrees: a wall, whose normal leads to the mirror.
TEST(Aovs, AMirrorShowsAlbedoAndNormalOfWhatItReflectsButIsTheFirstSurface) {
    const std::string wall =
        "Material \"diffuse\" \"spectrum reflectance\" [360 .5 830 .5]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-5 -90 -90  -5 90 -90  -5 -90 90  -5 90 90]\n";
    const std::string view =
        "LookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 10\nWorldBegin\nLightSource \"infinite\"\n";
    const std::string mirror = "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 -1  1 -1 1  -1 1 -1  1 1 1]\n";
    for (const std::string material :
         {"Material \"conductor\" \"spectrum reflectance\" [360 .6 830 .6]\n",
          "Material \"conductor\" \"spectrum reflectance\" [360 .6 830 .6] \"float roughness\" .3\n"}) {
        const bool rough = material.find("rough") != std::string::npos;
        const sampledb::Records records = seen_in(view + wall + material + mirror, 100);
        for (std::size_t row = 0; row < records.size(); ++row) {
            const Vec3f n = vector(records, "normal", row);
            EXPECT_EQ(value(records, "object", row), 2);
            EXPECT_NEAR(value(records, "depth", row), 4, 0.8);
            if (rough) {  // a surface of its own
                EXPECT_NEAR(value(records, "albedo.y", row), 0.6f, 1e-3);
                EXPECT_NEAR(n.z, std::sqrt(0.5), 1e-3);
            } else {
                EXPECT_NEAR(value(records, "albedo.y", row), 0.5f * 0.6f, 0.02);  // Fresnel reflection grows with the angle
                EXPECT_NEAR(n.x, 1, 1e-3);
            }
        }
    }
}

// A pane of glass lets through what is behind it, or shows the black sky above: its albedo is their blend.
TEST(Aovs, GlassShowsWhatIsBehindItByItsTransmittance) {
    const sampledb::Records records = seen_in(
        std::string("LookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 10\nWorldBegin\nLightSource \"infinite\"\n") +
            kGreyFloor +
            "Material \"thindielectric\" \"float eta\" 1.5\nShape \"bilinearmesh\" \"point3 P\" [-9 -9 1  9 -9 1  -9 9 1  9 9 1]\n",
        2000);
    double sum = 0;
    for (std::size_t row = 0; row < records.size(); ++row) {
        EXPECT_EQ(value(records, "object", row), 2);
        EXPECT_NEAR(value(records, "depth", row), 3, 0.05);
        sum += value(records, "albedo.y", row);
    }
    const double r = 0.04, through = 1 - 2 * r / (1 + r);  // all reflections between the faces
    EXPECT_NEAR(sum / 2000, 0.5 * through, 4 * 0.5 * std::sqrt(through * (1 - through) / 2000));
}

TEST(Aovs, AreNamedInAnyOrderAndOthersRefused) {
    const Result<AovSettings> parsed = parse_aovs("id,albedo");
    ASSERT_TRUE(parsed);
    EXPECT_EQ(to_text(*parsed), "albedo,id");
    EXPECT_EQ(to_text(kAll), "albedo,normal,depth,position,id");
    for (const char* bad : {"", "colour", "albedo,", "albedo,,id", "Albedo"}) EXPECT_FALSE(parse_aovs(bad)) << bad;
}

}  // namespace
}  // namespace latent::render::testing
