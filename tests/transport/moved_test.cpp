// A scene is the same wherever in its world it stands: places are counted from an origin near the camera. docs/scenes.md,
// "Geometry".
#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "tests/support/paths.h"
#include "tests/transport/blocks.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {
namespace {

std::string text_of(const std::string& name) {
    std::stringstream text;
    text << std::ifstream(latent::testing::in_tree("scenes/" + name)).rdbuf();
    return text.str();
}

// Every kind of light and shape that has a place, and an object that was modelled far from where it is used.
const char* const kEachLight =
    "LookAt 0 -4 2  0 0 0.5  0 0 1\nCamera \"perspective\" \"float fov\" 50 \"float lensradius\" 0.02 \"float focaldistance\" 4\n"
    "WorldBegin\nLightSource \"point\" \"point3 from\" [1 -1 2] \"float power\" 20\n"
    "LightSource \"distant\" \"point3 from\" [-1 0 2] \"point3 to\" [0 0 1] \"float illuminance\" 1\n"
    "LightSource \"infinite\" \"rgb L\" [.2 .2 .2]\n"
    "Material \"diffuse\" \"spectrum reflectance\" [360 .5 830 .6]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [-3 -3 0  3 -3 0  -3 3 0  3 3 0.2]\n"
    "Translate -1 0 0.5\nShape \"disk\" \"float radius\" 0.6 \"float height\" 0.1\n"
    "AttributeBegin\nAreaLightSource \"diffuse\"\nTranslate 0 0 1\nShape \"sphere\" \"float radius\" 0.2\nAttributeEnd\n"
    "AttributeBegin\nIdentity\nObjectBegin \"o\"\nTranslate 5000 0 0\nMaterial \"conductor\" \"float roughness\" 0.1\nShape "
    "\"sphere\" \"float radius\" 0.4\n"
    "Translate 0 0 0.5\nShape \"trianglemesh\" \"point3 P\" [-.4 -.4 0  .4 -.4 0  0 .4 .1]\nObjectEnd\nAttributeEnd\n"
    "Rotate 30 0 0 1\nTranslate -4999 0 0\nObjectInstance \"o\"\n";

struct Traced {
    std::vector<double> y;  // of each sample
    Blocks picture;
};
Traced trace_moved(const Scene& scene, const IntegratorSettings& settings, std::uint64_t samples) {
    const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
    Traced out;
    BlockSums sums(8);
    RadianceFaults faults;
    sampledb::Records records;
    for (std::uint64_t n = 0; n < samples; ++n) {
        records.clear();
        integrator->trace(n, records, faults);
        sums.add(records);
        out.y.push_back(0);
        for (const float y : records.y) out.y.back() += static_cast<double>(y);
    }
    EXPECT_EQ(faults.total(), 0u);
    out.picture = sums.picture(samples);
    return out;
}

// Sample by sample. All but a few are equal to the bit: doubles know a place to 1e-10, so a few vertices are rounded otherwise.
// Next to none takes another way than its unmoved likeness, at an edge or by a choice.
TEST(Moved, TheSamplesOfASceneAreTheSameWhereverItStands) {
    constexpr std::uint64_t kSamples = 20'000;
    for (const std::string& text : {text_of("cornell.pbrt"), text_of("fog.pbrt"), std::string(kEachLight)}) {
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            const IntegratorSettings settings{.kind = kind, .record = sampledb::RecordKind::kXyz, .seed = 3};
            const Traced unmoved = trace_moved(scene_from(text), settings, kSamples);
            for (const double distance : {1e4, 1e5, 1e6}) {
                SCOPED_TRACE(fmt::format("{}, by {}: {:.60}", kind == IntegratorKind::kPath ? "path" : "bdpt", distance, text));
                const Traced there = trace_moved(scene_from(moved(text, distance)), settings, kSamples);
                int unequal = 0, others = 0;
                for (std::size_t n = 0; n < kSamples; ++n) {
                    const double difference = std::abs(there.y[n] - unmoved.y[n]);
                    unequal += difference > 0 ? 1 : 0;
                    others += difference > 1e-4 * unmoved.y[n] ? 1 : 0;
                }
                EXPECT_LT(unequal, 200);
                EXPECT_LE(others, 2);
                for (std::size_t b = 0; b < 64; ++b) {
                    for (std::size_t c = 0; c < 3; ++c)
                        EXPECT_NEAR(there.picture.xyz[b][c], unmoved.picture.xyz[b][c], 1e-3 * unmoved.picture.xyz[b][c]);
                }
            }
        }
    }
}

}  // namespace
}  // namespace latent::render::testing
