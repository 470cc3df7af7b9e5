// Where and when light met the lens (`--aov lens,time`): the records of a part of the lens, or of the shutter's time, are those of
// a smaller lens or a shorter exposure. docs/rendering.md, "AOVs".
#include <functional>

#include "tests/transport/pictures.h"

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

using IsKept = std::function<bool(double x, double y, double time)>;

// From the records that are kept, `part` of the lens and the shutter.
Estimate picture_of_part(const Scene& scene, IntegratorSettings settings, std::uint64_t samples, double part,
                         const IsKept& is_kept) {
    settings.max_depth = 3;
    settings.record = sampledb::RecordKind::kXyz;
    settings.aovs = {.lens = true, .time = true};
    std::vector<Blocks> pictures;
    for (settings.seed = 1; settings.seed <= 8; ++settings.seed) {
        const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
        BlockSums sums(8);
        RadianceFaults faults;
        sampledb::Records records;
        for (std::uint64_t n = 0; n < samples; ++n) {
            records.clear();
            integrator->trace(n, records, faults);
            const auto value = [&](std::size_t column, std::size_t row) {
                return (static_cast<double>(records.extra[column].values[row]) + 0.5) / 256;
            };
            for (std::size_t i = 0; i < records.size(); ++i) {
                if (is_kept(2 * value(0, i) - 1, 2 * value(1, i) - 1, value(2, i))) continue;
                records.x[i] = records.y[i] = records.z[i] = records.share[i] = 0;
            }
            sums.add(records);
        }
        EXPECT_EQ(faults.total(), 0u);
        pictures.push_back(sums.picture(static_cast<std::uint64_t>(static_cast<double>(samples) * part + 0.5)));
    }
    return mean_of(pictures);
}

constexpr const char* kWhole = " \"float shutteropen\" 0 \"float shutterclose\" 1";
const IsKept kEveryColumn = [](double, double, double) { return true; };

TEST(LensColumns, TheMiddleOfALensIsASmallerLens) {
    const Scene wide = scene_from(scene_text(".3", kWhole)), narrow = scene_from(scene_text(".15", kWhole));
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        expect_equal(
            picture_of_part(wide, {.kind = kind}, 16'384, 0.25, [](double x, double y, double) { return x * x + y * y < 0.25; }),
            picture_of_part(narrow, {.kind = kind}, 6144, 1, kEveryColumn));
    }
}

TEST(LensColumns, APartOfTheTimeIsAShorterExposure) {
    const Scene longer = scene_from(scene_text(".2", kWhole)),
                shorter = scene_from(scene_text(".2", " \"float shutteropen\" .5 \"float shutterclose\" .75"));
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        expect_equal(
            picture_of_part(longer, {.kind = kind}, 16'384, 0.25, [](double, double, double t) { return t > 0.5 && t < 0.75; }),
            picture_of_part(shorter, {.kind = kind}, 6144, 1, kEveryColumn));
    }
}

// What the pictures above cannot see: that the axes are those of the picture. A lamp before the focal plane that is seen from the
// right side of the lens lies farther left.
TEST(LensColumns, XIsToTheRightAndYUpwards) {
    const Scene scene = scene_from(scene_text(".3", kWhole));
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        const auto centre = [&](const IsKept& is_kept) {
            const Estimate e = picture_of_part(scene, {.kind = kind}, 4096, 0.5, is_kept);
            double sum = 0, u = 0, v = 0;
            for (std::size_t b = 0; b < 64; ++b) {
                const double y = e.mean.xyz[b][1] > 1 ? e.mean.xyz[b][1] : 0;  // lamps alone
                if (b % 8 < 4) continue;  // the nearer one is on the right, as pbrt looks along y
                sum += y, u += y * static_cast<double>(b % 8), v += y * static_cast<double>(b / 8);
            }
            return std::array{u / sum, v / sum};
        };
        EXPECT_LT(centre([](double x, double, double) { return x > 0; })[0] + 0.2,
                  centre([](double x, double, double) { return x < 0; })[0]);
        EXPECT_GT(centre([](double, double y, double) { return y > 0; })[1] - 0.2,
                  centre([](double, double y, double) { return y < 0; })[1]);
    }
}

}  // namespace
}  // namespace latent::render::testing
