// Where and when light met the lens (`--aov lens,time`): the records of a part of the lens, or of the shutter's time, are those of
// a smaller lens or a shorter exposure. docs/rendering.md, "AOVs".
#include "tools/develop/lens/lens_columns.h"

#include <numbers>

#include "tests/transport/pictures.h"
#include "tools/develop/lens/lens_weights.h"
#include "tools/develop/lens/recorded_lens.h"

namespace latent::render::testing {
namespace {

// Lamps in front of the focal plane and behind it, which meet the lens by chance in bdpt, and a ball that moves.
std::string scene_text(const std::string& radius, const std::string& shutter) {
    return "LookAt 0 -3 1.2  0 0 .3  0 0 1\nCamera \"perspective\" \"float fov\" 50 \"float frameaspectratio\" 1 "
           "\"float focaldistance\" 3 \"float lensradius\" " +
           radius + shutter + "\nIntegrator \"path\" \"integer maxdepth\" 3\nWorldBegin\n" + R"(
Material "diffuse" "spectrum reflectance" [360 .5 830 .5]
Shape "bilinearmesh" "point3 P" [-4 -4 0  4 -4 0  -4 4 0  4 4 0]
AttributeBegin
ActiveTransform EndTime
Translate .8 0 0
ActiveTransform All
Translate -.4 .3 .4
Shape "sphere" "float radius" .3
AttributeEnd
LightSource "infinite" "spectrum L" [360 .1 830 .1]
AreaLightSource "diffuse" "spectrum L" [360 3 830 3]
Translate -.4 -1.2 .9
Shape "sphere" "float radius" .2
Translate 1.2 2.6 .2
Shape "sphere" "float radius" .3
)";
}

using develop::LensChoice;
using develop::LensWeights;

// As LensWeights moves records. False: off the film.
bool move_on_film(const std::array<double, 2>& shift, sampledb::Page& page, std::size_t row) {
    const std::array<double, 2> lens = develop::lens_point(page, {0, 1}, row);
    const double u = page.u[row] * 0x1p-32 + shift[0] * lens[0], v = page.v[row] * 0x1p-32 + shift[1] * lens[1];
    if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) return false;
    page.u[row] = static_cast<std::uint32_t>(u * 0x1p32), page.v[row] = static_cast<std::uint32_t>(v * 0x1p32);
    return true;
}

// Of a part of the lens and of the exposure, or focused elsewhere, from records of all of both.
Estimate picture_of_part(const Scene& scene, IntegratorSettings settings, std::uint64_t samples, const LensChoice& lens) {
    settings.max_depth = 3;
    settings.record = sampledb::RecordKind::kXyz;
    settings.aovs = {.lens = true, .time = true};
    sampledb::Job job;
    job.extra = aov_columns(settings.aovs);
    job.light_paths_per_sample = 1;
    const Result<LensWeights> weights = LensWeights::make(job, lens);
    EXPECT_TRUE(weights);
    std::vector<Blocks> pictures;
    for (settings.seed = 1; settings.seed <= 8; ++settings.seed) {
        const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
        BlockSums sums(8);
        RadianceFaults faults;
        sampledb::Records records;
        sampledb::Page page;
        LensWeights::Factors factors;
        for (std::uint64_t n = 0; n < samples; ++n) {
            records.clear();
            integrator->trace(n, records, faults);
            page.u = records.u, page.v = records.v, page.extra = records.extra;
            for (std::size_t i = 0; i < records.size(); ++i) {
                page.record_class = records.record_class[i];
                if (!move_on_film(lens.film_shift, page, i)) {
                    records.x[i] = records.y[i] = records.z[i] = records.share[i] = 0;
                    continue;
                }
                records.u[i] = page.u[i], records.v[i] = page.v[i];
                weights->factors(page, i, i + 1, factors);
                for (auto* values : {&records.x, &records.y, &records.z}) (*values)[i] *= factors.value[0];
                records.share[i] *= factors.share[0];
            }
            sums.add(records);
        }
        EXPECT_EQ(faults.total(), 0u);
        pictures.push_back(sums.picture(samples));
    }
    return mean_of(pictures);
}

LensChoice choice(const char* aperture, const char* shutter) {
    return {.aperture = *develop::parse_aperture(aperture), .shutter = *develop::parse_shutter(shutter)};
}
const LensChoice kWholeLens{};
constexpr const char* kWhole = " \"float shutteropen\" 0 \"float shutterclose\" 1";
constexpr const char* kPart = " \"float shutteropen\" .5 \"float shutterclose\" .75";

// Six blades, black and straight, right in front of the lens; on a lens of the radius of their corners, they leave 3 sin(60) / pi
// of the light.
std::string scene_behind_blades(double radius, double rotation_degrees, const std::string& shutter) {
    std::string points, triangles;
    for (int i = 0; i < 6; ++i) {
        const double angle = (rotation_degrees + 60 * i) * std::numbers::pi / 180, x = std::cos(angle), y = std::sin(angle);
        points += fmt::format("{} {} .003 {} {} .003 ", radius * x, radius * y, 2 * radius * x, 2 * radius * y);
        const int a = 2 * i, b = 2 * ((i + 1) % 6);
        triangles += fmt::format("{} {} {} {} {} {} ", a, a + 1, b, b, a + 1, b + 1);
    }
    return scene_text(fmt::format("{}", radius), shutter) +
           fmt::format(
               "AttributeBegin\nCoordSysTransform \"camera\"\nMaterial \"diffuse\" \"spectrum reflectance\" [360 0 830 0]\n"
               "Shape \"trianglemesh\" \"point3 P\" [{}] \"integer indices\" [{}]\nAttributeEnd\n",
               points, triangles);
}
Estimate scaled(Estimate estimate, double factor) {
    for (Blocks* blocks : {&estimate.mean, &estimate.error}) {
        for (std::array<double, 3>& xyz : blocks->xyz) {
            for (double& x : xyz) x *= factor;
        }
    }
    return estimate;
}

TEST(LensColumns, TheMiddleOfALensIsASmallerLens) {
    const Scene wide = scene_from(scene_text(".3", kWhole)), narrow = scene_from(scene_text(".15", kWhole));
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        expect_equal(picture_of_part(wide, {.kind = kind}, 16'384, choice("0.5", "0:1")),
                     picture_of_part(narrow, {.kind = kind}, 6144, kWholeLens));
    }
}

TEST(LensColumns, AHexagonOfALensIsALensBehindSixBlades) {
    const Scene wide = scene_from(scene_text(".3", kWhole)), behind = scene_from(scene_behind_blades(.15, 15, kWhole));
    const double passes = 3 * std::sin(std::numbers::pi / 3) / std::numbers::pi;
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        expect_equal(picture_of_part(wide, {.kind = kind}, 16'384, choice("0.5,blades:6:15", "0:1")),
                     scaled(picture_of_part(behind, {.kind = kind}, 8192, kWholeLens), 1 / passes));
    }
}

TEST(LensColumns, APartOfTheTimeIsAShorterExposure) {
    const Scene longer = scene_from(scene_text(".2", kWhole)), shorter = scene_from(scene_text(".2", kPart));
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        expect_equal(picture_of_part(longer, {.kind = kind}, 16'384, choice("1", "0.5:0.75")),
                     picture_of_part(shorter, {.kind = kind}, 6144, kWholeLens));
    }
}

TEST(LensColumns, APartOfBothIsASmallerLensAndAShorterExposure) {
    expect_equal(
        picture_of_part(scene_from(scene_text(".3", kWhole)), {.kind = IntegratorKind::kBdpt}, 24'576, choice("0.7", "0.5:0.75")),
        picture_of_part(scene_from(scene_text(".21", kPart)), {.kind = IntegratorKind::kBdpt}, 6144, kWholeLens));
}

// Away from the border, where the film that was rendered lacks records of a part of the lens.
TEST(LensColumns, ALensCanBeFocusedElsewhere) {
    const double half = std::tan(25 * std::numbers::pi / 180);
    const Scene at_3 = scene_from(scene_text(".15", kWhole));
    std::string text = scene_text(".15", kWhole);
    text.replace(text.find("focaldistance\" 3"), 16, "focaldistance\" 2");
    const Scene at_2 = scene_from(text);
    LensChoice refocused;
    refocused.film_shift = develop::RecordedLens{.15, 3, -half, -half, half, half}.film_shift(2);
    const auto without_border = [](Estimate estimate) {
        for (Blocks* blocks : {&estimate.mean, &estimate.error}) {
            Blocks inner{6, {}};
            for (std::size_t b = 0; b < 64; ++b) {
                if (b % 8 > 0 && b % 8 < 7 && b / 8 > 0 && b / 8 < 7) inner.xyz.push_back(blocks->xyz[b]);
            }
            *blocks = inner;
        }
        return estimate;
    };
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        expect_equal(without_border(picture_of_part(at_3, {.kind = kind}, 8192, refocused)),
                     without_border(picture_of_part(at_2, {.kind = kind}, 8192, kWholeLens)));
    }
}

// What the pictures above cannot see: that the axes are those of the picture. A lamp before the focal plane lies farther left, seen
// from the right side of the lens, and lower, seen from above.
TEST(LensColumns, XIsToTheRightAndYUpwards) {
    const Scene scene = scene_from(scene_text(".3", kWhole));
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        const std::unique_ptr<Integrator> integrator =
            scene.integrator({.kind = kind, .max_depth = 3, .record = sampledb::RecordKind::kXyz, .aovs = {.lens = true}});
        RadianceFaults faults;
        sampledb::Records records;
        for (std::uint64_t n = 0; n < 32'768; ++n) integrator->trace(n, records, faults);
        double light = 0, mean_u = 0, mean_v = 0, with_x = 0, with_y = 0;
        for (const bool mean_is_known : {false, true}) {
            for (std::size_t i = 0; i < records.size(); ++i) {
                const double u = records.u[i] * 0x1p-32, v = records.v[i] * 0x1p-32, y = static_cast<double>(records.y[i]);
                if (u < 0.5 || y < 1) continue;  // the nearer lamp alone, which is on the right, as pbrt looks along y
                const auto lens = [&](std::size_t axis) { return static_cast<int>(records.extra[axis].values[i]) - 127.5; };
                if (mean_is_known) {
                    with_x += y * (u - mean_u) * lens(0), with_y += y * (v - mean_v) * lens(1);
                } else {
                    light += y, mean_u += y * u, mean_v += y * v;
                }
            }
            if (!mean_is_known) mean_u /= light, mean_v /= light;
        }
        EXPECT_LT(with_x, 0);
        EXPECT_GT(with_y, 0);
    }
}

}  // namespace
}  // namespace latent::render::testing
