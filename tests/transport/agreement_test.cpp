// `path` and `bdpt` estimate the same integral by other means: they must agree wherever light, material, camera and medium meet.
// A pairwise covering design: every pair of choices of two of the five factors occurs in some scene. Small pictures, fixed seeds; over
// all comparisons the false discovery rate is held at 1 % (Benjamini and Hochberg).
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "render/bdpt.h"
#include "tests/transport/blocks.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {
namespace {

struct Choice {
    const char* name;
    const char* text;
};

const std::vector<Choice> kLights = {
    {"area", "AttributeBegin Translate 0 1.7 0 Rotate 90 1 0 0 AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" \"float scale\" 6 Material \"diffuse\" "
             "\"spectrum reflectance\" [360 0.1 830 0.1] Shape \"trianglemesh\" \"point3 P\" [-0.5 -0.5 0  0.5 -0.5 0  0.5 0.5 0  -0.5 0.5 0] \"integer indices\" "
             "[0 1 2 0 2 3] AttributeEnd\n"},
    {"two-sided", "AttributeBegin Translate 0.3 1.2 0.2 Rotate 70 1 0 1 AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-A\" \"float scale\" 4 \"bool twosided\" true "
                  "Material \"diffuse\" \"spectrum reflectance\" [360 0.1 830 0.1] Shape \"trianglemesh\" \"point3 P\" [-0.4 -0.4 0  0.4 -0.4 0  0.4 0.4 0] \"integer "
                  "indices\" [0 1 2] AttributeEnd\n"},
    {"sphere", "AttributeBegin Translate -0.5 1.2 -0.2 AreaLightSource \"diffuse\" \"blackbody L\" 3000 \"float scale\" 8 Material \"diffuse\" \"spectrum reflectance\" "
               "[360 0.1 830 0.1] Shape \"sphere\" \"float radius\" 0.25 AttributeEnd\n"},
    {"point", "LightSource \"point\" \"spectrum I\" \"stdillum-D65\" \"float scale\" 4 \"point3 from\" [0.4 1.4 -0.3]\n"},
    {"spot", "LightSource \"spot\" \"spectrum I\" \"stdillum-D65\" \"float scale\" 9 \"point3 from\" [0.2 1.7 -0.6] \"point3 to\" [0 0 0.1] \"float coneangle\" 45\n"},
    {"distant", "LightSource \"distant\" \"blackbody L\" 5500 \"float scale\" 3 \"point3 from\" [1 2 -2] \"point3 to\" [0 0 0]\n"},
    {"sky", "LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\" \"float scale\" 0.6\n"},
    {"sky and lines", "LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\" \"float scale\" 0.2\nLightSource \"point\" \"spectrum I\" [360 0 586.5 0 588.5 1 590.5 1 592.5 0 "
                      "830 0] \"float scale\" 4 \"point3 from\" [-0.6 1.3 -0.5]\n"},
};
const std::vector<Choice> kMaterials = {
    {"diffuse", "Material \"diffuse\" \"spectrum reflectance\" [360 0.7 830 0.4]\n"},
    {"mirror", "Material \"conductor\" \"spectrum eta\" \"metal-Al-eta\" \"spectrum k\" \"metal-Al-k\" \"float roughness\" 0\n"},
    {"rough metal", "Material \"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"metal-Cu-k\" \"float uroughness\" 0.4 \"float vroughness\" 0.2 \"bool "
                    "remaproughness\" false\n"},
    {"glass", "Material \"dielectric\" \"float eta\" 1.5\n"},
    {"rough glass", "Material \"dielectric\" \"float eta\" 1.5 \"float roughness\" 0.35 \"bool remaproughness\" false\n"},
    {"dispersive glass", "Material \"dielectric\" \"spectrum eta\" \"glass-SF11\"\n"},
    {"rough dispersive glass", "Material \"dielectric\" \"spectrum eta\" \"glass-SF11\" \"float roughness\" 0.3 \"bool remaproughness\" false\n"},
    {"pane", "Material \"thindielectric\" \"float eta\" 1.5\n"},
    {"interface", "Material \"interface\"\n"},
};
const std::vector<Choice> kCameras = {
    {"pinhole", "LookAt 0.3 0.9 -2.6  0 0.5 0  0 1 0\nCamera \"perspective\" \"float fov\" 45\n"},
    {"thin lens", "LookAt 0.3 0.9 -2.6  0 0.5 0  0 1 0\nCamera \"perspective\" \"float fov\" 45 \"float lensradius\" 0.3 \"float focaldistance\" 2.4\n"},
    {"orthographic", "LookAt 0.3 0.9 -2.6  0 0.5 0  0 1 0\nCamera \"orthographic\" \"float screenwindow\" [-1.1 1.1 -1.1 1.1]\n"},
    {"equal-area", "LookAt 0.2 0.7 -0.9  0 0.5 0  0 1 0\nCamera \"spherical\"\n"},
    {"equirectangular", "LookAt 0.2 0.7 -0.9  0 0.5 0  0 1 0\nCamera \"spherical\" \"string mapping\" \"equirectangular\"\n"},
};
const std::vector<Choice> kMedia = {
    {"vacuum", ""},
    {"fog", "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" [360 0.05 830 0.02] \"spectrum sigma_s\" [360 0.5 830 0.2] \"float g\" 0.3\n"},
};

constexpr const char* kRoom =
    "Material \"diffuse\" \"spectrum reflectance\" [360 0.5 560 0.6 830 0.4]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-2 0 -3  2 0 -3  2 0 2  -2 0 2] \"integer indices\" [0 2 1 0 3 2]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-2 0 2  2 0 2  2 2 2  -2 2 2] \"integer indices\" [0 2 1 0 3 2]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-2 0 -3  -2 0 2  -2 2 2  -2 2 -3] \"integer indices\" [0 2 1 0 3 2]\n";
// With fog the room is closed: nothing comes from infinity through a medium that fills all space.
constexpr const char* kLid =
    "Shape \"trianglemesh\" \"point3 P\" [-2 2 -3  2 2 -3  2 2 2  -2 2 2] \"integer indices\" [0 1 2 0 2 3]\n"
    "Shape \"trianglemesh\" \"point3 P\" [2 0 -3  2 0 2  2 2 2  2 2 -3] \"integer indices\" [0 1 2 0 2 3]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-2 0 -3  2 0 -3  2 2 -3  -2 2 -3] \"integer indices\" [0 1 2 0 2 3]\n";

struct Design {
    std::size_t light, material, camera, medium;
};

// Greedy: of many random scenes always the one that covers most pairs not yet met, until none is left.
std::vector<Design> covering_design() {
    const std::size_t levels[4] = {kLights.size(), kMaterials.size(), kCameras.size(), kMedia.size()};
    std::vector<std::array<std::size_t, 4>> open;  // factor a, factor b, level a, level b
    for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t b = a + 1; b < 4; ++b) {
            for (std::size_t i = 0; i < levels[a]; ++i) {
                for (std::size_t j = 0; j < levels[b]; ++j) open.push_back({a, b, i, j});
            }
        }
    }
    const auto value = [](const Design& d, std::size_t f) { return f == 0 ? d.light : f == 1 ? d.material : f == 2 ? d.camera : d.medium; };
    const auto covers = [&](const Design& d, const auto& pair) { return value(d, pair[0]) == pair[2] && value(d, pair[1]) == pair[3]; };
    std::vector<Design> designs;
    std::uint64_t state = 1;
    const auto draw = [&](std::size_t n) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<std::size_t>((state >> 33) % n);
    };
    while (!open.empty()) {
        Design best{};
        std::ptrdiff_t most = -1;
        for (int trial = 0; trial < 300; ++trial) {
            Design d{draw(levels[0]), draw(levels[1]), draw(levels[2]), draw(levels[3])};
            const auto count = std::count_if(open.begin(), open.end(), [&](const auto& pair) { return covers(d, pair); });
            if (count > most) {
                most = count;
                best = d;
            }
        }
        std::erase_if(open, [&](const auto& pair) { return covers(best, pair); });
        designs.push_back(best);
    }
    return designs;
}

std::string text_of(const Design& d) {
    const bool fog = d.medium == 1;
    const std::string inside = fog ? "MediumInterface \"fog\" \"fog\"\n" : "";
    std::string text = kMedia[d.medium].text;
    text += "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"path\" \"integer maxdepth\" 4\n";
    text += inside + kCameras[d.camera].text + "WorldBegin\n" + inside + kLights[d.light].text + kRoom;
    if (fog) text += kLid;
    // The object; an interface, and glass, has clear air inside where there is fog around it.
    if (fog) text += "MediumInterface \"\" \"fog\"\n";
    return text + kMaterials[d.material].text + "AttributeBegin Translate 0 0.55 0.1 Shape \"sphere\" \"float radius\" 0.5 AttributeEnd\n";
}

// Means over the quarters of the picture by independent batches.
Estimate render(const Scene& scene, IntegratorSettings settings, std::uint64_t samples, std::uint32_t seeds) {
    std::vector<Blocks> pictures;
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        settings.seed = seed + (settings.kind == IntegratorKind::kBdpt ? 1000 : 0);
        settings.record = sampledb::RecordKind::kXyz;
        const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
        BlockSums sums(2);
        sampledb::Records r;
        RadianceFaults faults;
        for (std::uint64_t n = 0; n < samples; ++n) {
            r.clear();
            integrator->trace(n, r, faults);
            sums.add(r);
        }
        EXPECT_EQ(faults.total(), 0u);
        pictures.push_back(sums.picture(samples));
    }
    return mean_of(pictures);
}

TEST(Agreement, PathAndBdptAreOnePictureWhateverMeets) {
    std::vector<std::pair<double, std::string>> p_values;
    std::vector<double> detectable;
    for (const Design& d : covering_design()) {
        const std::string name = fmt::format("{} / {} / {} / {}", kLights[d.light].name, kMaterials[d.material].name, kCameras[d.camera].name, kMedia[d.medium].name);
        SCOPED_TRACE(name);
        const Scene scene = scene_from(text_of(d));
        const Estimate path = render(scene, {.kind = IntegratorKind::kPath, .max_depth = 0}, 8192, 16);
        const Estimate one = render(scene, {.kind = IntegratorKind::kBdpt, .connections = Connections::kOne, .max_depth = 0}, 4096, 16);
        const Estimate all = render(scene, {.kind = IntegratorKind::kBdpt, .connections = Connections::kAll, .max_depth = 0}, 4096, 16);
        for (const auto& [other, which] : {std::pair(&one, "one"), std::pair(&all, "all")}) {
            for (std::size_t b = 0; b < 4; ++b) {
                const double error = std::hypot(path.error.xyz[b][1], other->error.xyz[b][1]);
                const double difference = other->mean.xyz[b][1] - path.mean.xyz[b][1];
                if (error <= 0 && difference == 0) continue;
                // Student's t with about 30 degrees of freedom, by its normal approximation.
                const double t = difference / error, z = t * (1 - 1 / 120.0) / std::sqrt(1 + t * t / 60);
                p_values.emplace_back(std::erfc(std::abs(z) / std::numbers::sqrt2),
                                      fmt::format("{}, {}, quarter {}: {:.5f} against {:.5f} +- {:.5f}", name, which, b, other->mean.xyz[b][1], path.mean.xyz[b][1], error));
                detectable.push_back(4.5 * error / path.mean.xyz[b][1]);
            }
        }
    }
    std::sort(p_values.begin(), p_values.end());
    const double m = static_cast<double>(p_values.size());
    std::size_t discoveries = 0;
    for (std::size_t i = 0; i < p_values.size(); ++i) {
        if (p_values[i].first <= 0.01 * static_cast<double>(i + 1) / m) discoveries = i + 1;
    }
    for (std::size_t i = 0; i < discoveries; ++i) ADD_FAILURE() << p_values[i].second << ", p = " << p_values[i].first;
    std::sort(detectable.begin(), detectable.end());
    fmt::print("    {} comparisons; a bias of {:.2f} % (median; worst {:.1f} %) in one quarter would be found\n", p_values.size(),
               100 * detectable[detectable.size() / 2], 100 * detectable.back());
    fmt::print("    smallest p: {:.2g} ({})\n", p_values[0].first, p_values[0].second);
}

}  // namespace
}  // namespace latent::render::testing
