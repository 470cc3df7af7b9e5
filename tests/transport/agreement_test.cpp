// `path` and `bdpt` estimate the same integral by other means: they must agree wherever light, material, camera and medium meet.
// A pairwise covering design: every pair of choices of two of the five factors occurs in some scene, but for light of a point or of
// one direction on smooth mirrors and glass: no path from the camera finds the caustics of those. Small pictures, fixed seeds;
// every scene is compared in X, Y and Z, and every choice over all its scenes together; over all comparisons the false discovery
// rate is held at 1 % [BH95].
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numbers>

#include "tests/transport/blocks.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {
namespace {

struct Option {
    const char* name;
    const char* text;
};

const std::vector<Option> kLights = {
    {"area",
     "AttributeBegin Translate 0 1.7 0 Rotate 90 1 0 0 AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" \"float scale\" "
     "6 Material \"diffuse\" "
     "\"spectrum reflectance\" [360 0.1 830 0.1] Shape \"trianglemesh\" \"point3 P\" [-0.5 -0.5 0  0.5 -0.5 0  0.5 0.5 0  -0.5 0.5 "
     "0] \"integer indices\" "
     "[0 1 2 0 2 3] AttributeEnd\n"},
    {"two-sided",
     "AttributeBegin Translate 0.3 1.2 0.2 Rotate 70 1 0 1 AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-A\" \"float "
     "scale\" 4 \"bool twosided\" true "
     "Material \"diffuse\" \"spectrum reflectance\" [360 0.1 830 0.1] Shape \"trianglemesh\" \"point3 P\" [-0.4 -0.4 0  0.4 -0.4 0 "
     " 0.4 0.4 0] \"integer "
     "indices\" [0 1 2] AttributeEnd\n"},
    {"sphere",
     "AttributeBegin Translate -0.5 1.2 -0.2 AreaLightSource \"diffuse\" \"blackbody L\" 3000 \"float power\" 20 Material "
     "\"diffuse\" \"spectrum reflectance\" "
     "[360 0.1 830 0.1] Shape \"sphere\" \"float radius\" 0.25 AttributeEnd\n"},
    {"point", "LightSource \"point\" \"spectrum I\" \"stdillum-D65\" \"float power\" 50 \"point3 from\" [0.4 1.4 -0.3]\n"},
    {"spot",
     "LightSource \"spot\" \"spectrum I\" \"stdillum-D65\" \"float scale\" 9 \"point3 from\" [0.2 1.7 -0.6] \"point3 to\" [0 0 "
     "0.1] \"float coneangle\" 45\n"},
    {"distant",
     "LightSource \"distant\" \"blackbody L\" 5500 \"float illuminance\" 3 \"point3 from\" [1 2 -2] \"point3 to\" [0 0 0]\n"},
    {"image infinite",
     "AttributeBegin Rotate 30 0 1 0 Rotate -90 1 0 0 LightSource \"infinite\" \"string filename\" \"sky.exr\" \"float "
     "illuminance\" 2 "
     "AttributeEnd\n"},
    {"shell",
     "AttributeBegin ReverseOrientation AreaLightSource \"diffuse\" \"rgb L\" [0.3 0.5 0.8] Material \"diffuse\" \"rgb "
     "reflectance\" "
     "[0.1 0.1 0.1] Shape \"sphere\" \"float radius\" 6 AttributeEnd\n"},
    {"infinite", "LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\" \"float scale\" 0.6\n"},
    {"infinite and lines",
     "LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\" \"float scale\" 0.2\nAttributeBegin Translate -0.6 1.3 -0.5 "
     "AreaLightSource \"diffuse\" "
     "\"spectrum L\" [360 0 586.5 0 588.5 1 590.5 1 592.5 0 830 0] \"float scale\" 8 Material \"diffuse\" \"spectrum reflectance\" "
     "[360 0.1 830 0.1] Shape "
     "\"sphere\" \"float radius\" 0.25 AttributeEnd\n"},
};
const std::vector<Option> kMaterials = {
    {"diffuse", "Material \"diffuse\" \"spectrum reflectance\" [360 0.7 830 0.4]\n"},
    {"mirror", "Material \"conductor\" \"spectrum eta\" \"metal-Al-eta\" \"spectrum k\" \"metal-Al-k\" \"float roughness\" 0\n"},
    {"rough metal",
     "Material \"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"metal-Cu-k\" \"float uroughness\" 0.4 \"float "
     "vroughness\" 0.2 \"bool "
     "remaproughness\" false\n"},
    {"glass", "Material \"dielectric\" \"float eta\" 1.5\n"},
    {"rough glass", "Material \"dielectric\" \"float eta\" 1.5 \"float roughness\" 0.35 \"bool remaproughness\" false\n"},
    {"dispersive glass", "Material \"dielectric\" \"spectrum eta\" \"glass-SF11\"\n"},
    {"rough dispersive glass",
     "Material \"dielectric\" \"spectrum eta\" \"glass-SF11\" \"float roughness\" 0.3 \"bool remaproughness\" false\n"},
    {"pane", "Material \"thindielectric\" \"float eta\" 1.5\n"},
    {"interface", "Material \"interface\"\n"},
    {"coated diffuse", "Material \"coateddiffuse\" \"spectrum reflectance\" [360 0.7 830 0.4]\n"},
    {"rough coated diffuse",
     "Material \"coateddiffuse\" \"spectrum reflectance\" [360 0.7 830 0.4] \"float roughness\" 0.3 \"bool remaproughness\" "
     "false\n"},
    {"coated metal",
     "Material \"coatedconductor\" \"float interface.roughness\" 0 \"float conductor.roughness\" 0.3 \"bool remaproughness\" false "
     "\"spectrum interface.eta\" \"glass-SF11\"\n"},
    {"leaf",
     "Material \"diffusetransmission\" \"spectrum reflectance\" [360 0.2 830 0.3] \"spectrum transmittance\" [360 0.5 830 0.3]\n"},
    {"milky coat",
     "Material \"coatedconductor\" \"float interface.roughness\" 0.2 \"bool remaproughness\" false \"float thickness\" 0.5 "
     "\"spectrum albedo\" [360 0.9 830 0.5] \"float g\" 0.4\n"},
    {"glossy transmission",
     "Material \"latent:phongtransmission\" \"spectrum Kd\" [360 0.5 830 0.2] \"spectrum Ks\" [360 0.3 830 0.7] \"float exponent\" "
     "40 \"float eta\" 1.3\n"},
    {"measured", "Material \"measured\" \"string filename\" \"metal.bsdf\"\n"},
    {"phong", "Material \"phong\" \"spectrum Kd\" [360 0.5 830 0.2] \"spectrum Ks\" [360 0.3 830 0.7] \"float exponent\" 40\n"},
};
const std::vector<Option> kCameras = {
    {"pinhole", "LookAt 0.3 0.9 -2.6  0 0.5 0  0 1 0\nCamera \"perspective\" \"float fov\" 45\n"},
    {"thin lens",
     "LookAt 0.3 0.9 -2.6  0 0.5 0  0 1 0\nCamera \"perspective\" \"float fov\" 45 \"float lensradius\" 0.3 \"float "
     "focaldistance\" 2.4\n"},
    {"orthographic", "LookAt 0.3 0.9 -2.6  0 0.5 0  0 1 0\nCamera \"orthographic\" \"float screenwindow\" [-1.1 1.1 -1.1 1.1]\n"},
    {"equal-area", "LookAt 0.2 0.7 -0.9  0 0.5 0  0 1 0\nCamera \"spherical\"\n"},
    {"equirectangular", "LookAt 0.2 0.7 -0.9  0 0.5 0  0 1 0\nCamera \"spherical\" \"string mapping\" \"equirectangular\"\n"},
};
// What the material covers, at the room's centre: the octahedron's normals are those of a sphere, far from its faces'.
const std::vector<Option> kShapes = {
    {"sphere", "Shape \"sphere\" \"float radius\" 0.5\n"},
    {"shaded octahedron",
     "Shape \"trianglemesh\" \"point3 P\" [0.6 0 0  -0.6 0 0  0 0.5 0  0 -0.5 0  0 0 0.6  0 0 -0.6] \"normal N\" [1 0 0  -1 0 0  0 "
     "1 0  0 "
     "-1 0  0 0 1  0 0 -1] \"integer indices\" [0 2 4  4 2 1  1 2 5  5 2 0  4 3 0  1 3 4  5 3 1  0 3 5]\n"},
};
constexpr const char* kFog =
    "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" [360 0.05 830 0.02] \"spectrum sigma_s\" [360 "
    "0.5 830 0.2] \"float g\" 0.3\n";
// The whole closed room, the object alone, or nothing is filled with fog.
const std::vector<Option> kMedia = {{"vacuum", ""}, {"fog", kFog}, {"fog inside", kFog}};
enum { kVacuum, kEverywhere, kInside };

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

enum { kLight, kMaterial, kCamera, kMedium, kShape, kFactorCount };
using Design = std::array<std::size_t, kFactorCount>;
const std::vector<Option>* const kFactors[kFactorCount] = {&kLights, &kMaterials, &kCameras, &kMedia, &kShapes};

bool is_one_of(const char* name, std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(), [&](const char* n) { return std::string(n) == name; });
}
// No caustics that only a path from the light finds, no light from infinity through a medium without end.
bool is_possible(const Design& d) {
    const bool delta_light = is_one_of(kLights[d[kLight]].name, {"point", "spot", "distant"});
    const bool smooth =
        is_one_of(kMaterials[d[kMaterial]].name, {"mirror", "glass", "dispersive glass", "pane", "coated diffuse", "coated metal"});
    const bool infinite =
        is_one_of(kLights[d[kLight]].name, {"distant", "image infinite", "shell", "infinite", "infinite and lines"});
    return !(delta_light && smooth) && !(infinite && d[kMedium] == kEverywhere);
}

// Greedy: of many random scenes always the one that covers most pairs not yet met, until none is left.
std::vector<Design> covering_design() {
    std::vector<std::array<std::size_t, 4>> open;  // factors a and b, their choices i and j
    const auto covers = [](const Design& d, const auto& pair) { return d[pair[0]] == pair[2] && d[pair[1]] == pair[3]; };
    for (std::size_t a = 0; a < kFactorCount; ++a) {
        for (std::size_t b = a + 1; b < kFactorCount; ++b) {
            for (std::size_t i = 0; i < kFactors[a]->size(); ++i) {
                for (std::size_t j = 0; j < kFactors[b]->size(); ++j) {
                    Design d{};
                    d[a] = i;
                    d[b] = j;
                    if (is_possible(d)) open.push_back({a, b, i, j});
                }
            }
        }
    }
    std::vector<Design> designs;
    std::uint64_t state = 1;
    const auto draw = [&](std::size_t n) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<std::size_t>((state >> 33) % n);
    };
    while (!open.empty()) {
        Design best{};
        std::ptrdiff_t covered = 0;
        while (covered == 0) {
            for (int trial = 0; trial < 300; ++trial) {
                Design d;
                for (std::size_t f = 0; f < kFactorCount; ++f) d[f] = draw(kFactors[f]->size());
                const auto count =
                    is_possible(d) ? std::count_if(open.begin(), open.end(), [&](const auto& pair) { return covers(d, pair); }) : 0;
                if (count > covered) {
                    covered = count;
                    best = d;
                }
            }
        }
        std::erase_if(open, [&](const auto& pair) { return covers(best, pair); });
        designs.push_back(best);
    }
    return designs;
}

std::string text_of(const Design& d) {
    const bool fog = d[kMedium] == kEverywhere;
    const std::string around = fog ? "MediumInterface \"fog\" \"fog\"\n" : "";
    std::string text = kMedia[d[kMedium]].text;
    text += "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"path\" \"integer maxdepth\" 4\n";
    text += around + kCameras[d[kCamera]].text + "WorldBegin\n" + around + kLights[d[kLight]].text + kRoom + (fog ? kLid : "");
    if (fog) text += "MediumInterface \"\" \"fog\"\n";  // clear air inside the object
    if (d[kMedium] == kInside) text += "MediumInterface \"fog\" \"\"\n";
    return text + kMaterials[d[kMaterial]].text + "AttributeBegin Translate 0 0.55 0.1 " + kShapes[d[kShape]].text +
           "AttributeEnd\n";
}

struct Mean {
    double value, error;
};

// What records of a class are multiplied by.
struct Factors {
    float camera = 1, light = 1;
};

// XYZ of the whole picture, from 16 independent seeds.
std::array<Mean, 3> mean_xyz(const std::function<std::unique_ptr<Integrator>(std::uint32_t seed)>& integrator,
                             std::uint64_t samples, const Factors& factors = {}) {
    std::vector<Blocks> pictures;
    sampledb::Records r;
    RadianceFaults faults;
    for (std::uint32_t seed = 1; seed <= 16; ++seed) {
        const std::unique_ptr<Integrator> of_seed = integrator(seed);
        BlockSums sums(1);
        for (std::uint64_t n = 0; n < samples; ++n) {
            r.clear();
            of_seed->trace(n, r, faults);
            for (std::size_t i = 0; i < r.size(); ++i) {
                const float factor = r.record_class[i] == sampledb::RecordClass::kCamera ? factors.camera : factors.light;
                for (auto* column : {&r.x, &r.y, &r.z}) (*column)[i] *= factor;
            }
            sums.add(r);
        }
        pictures.push_back(sums.picture(samples));
    }
    EXPECT_EQ(faults.total(), 0u);
    const Estimate e = mean_of(pictures);
    std::array<Mean, 3> mean;
    for (std::size_t c = 0; c < 3; ++c) mean[c] = {e.mean.xyz[0][c], e.error.xyz[0][c]};
    return mean;
}

// Samples of each seed after which Y has a relative standard error of 0.45 % or less, as a pilot of other seeds says; at most
// `most`. Scenes with little noise need few.
std::uint64_t samples_needed(const std::function<std::unique_ptr<Integrator>(std::uint32_t seed)>& pilot, std::uint64_t most) {
    constexpr std::uint64_t kPilot = 640;
    const Mean y = mean_xyz(pilot, kPilot)[1];
    const double times = y.error / y.value / 0.0045;
    return std::clamp(static_cast<std::uint64_t>(static_cast<double>(kPilot) * times * times), 2 * kPilot, most);
}

struct Comparison {
    double p;
    std::string text;
};

// A relative difference with its standard error, of about 30 degrees of freedom, by the normal approximation to Student's t.
Comparison judged(const std::string& name, double difference, double error) {
    const double t = difference / error, z = t * (1 - 1 / 120.0) / std::sqrt(1 + t * t / 60);
    return {std::erfc(std::abs(z) / std::numbers::sqrt2),
            fmt::format("{}: {:+.2f} % +- {:.2f} %", name, 100 * difference, 100 * error)};
}

TEST(Agreement, PathAndBdptMakeOnePictureWhateverMeets) {
    std::vector<Comparison> comparisons;
    struct Level {
        double sum = 0, weight = 0;  // of difference / error^2, of 1 / error^2
    };
    std::array<std::vector<std::array<Level, 3>>, kFactorCount> levels;  // of each choice in X, Y, Z
    for (std::size_t f = 0; f < kFactorCount; ++f) levels[f].resize(kFactors[f]->size());
    std::vector<double> errors;  // in Y
    const std::vector<Design> designs = covering_design();
    for (std::size_t i = 0; i < designs.size(); ++i) {
        const Design& d = designs[i];
        const std::string name = fmt::format("{} / {} / {} / {} / {}", kLights[d[kLight]].name, kMaterials[d[kMaterial]].name,
                                             kCameras[d[kCamera]].name, kMedia[d[kMedium]].name, kShapes[d[kShape]].name);
        SCOPED_TRACE(name);
        const Scene scene = scene_under_sky(text_of(d));
        // Other seeds for each scene: what several scenes share is judged as if their errors were independent.
        const auto with = [&](IntegratorKind kind, std::uint32_t first_seed) {
            return [&scene, kind, first_seed, i](std::uint32_t seed) {
                return scene.integrator({.kind = kind,
                                         .connections = i % 2 == 0 ? Connections::kOne : Connections::kAll,
                                         .max_depth = 0,
                                         .record = sampledb::RecordKind::kXyz,
                                         .seed = 10'000 * i + first_seed + seed});
            };
        };
        const auto mean = [&](IntegratorKind kind, std::uint32_t first_seed, std::uint64_t most) {
            return mean_xyz(with(kind, first_seed), samples_needed(with(kind, first_seed + 2000), most));
        };
        const std::array<Mean, 3> path = mean(IntegratorKind::kPath, 0, 20480), bdpt = mean(IntegratorKind::kBdpt, 1000, 10240);
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_GT(path[c].value, 0);
            const double difference = bdpt[c].value / path[c].value - 1,
                         error = std::hypot(path[c].error, bdpt[c].error) / path[c].value;
            comparisons.push_back(judged(fmt::format("{}, {}", name, "XYZ"[c]), difference, error));
            if (c == 1) errors.push_back(error);
            for (std::size_t f = 0; f < kFactorCount; ++f) {
                Level& level = levels[f][d[f]][c];
                level.sum += difference / (error * error);
                level.weight += 1 / (error * error);
            }
        }
    }
    double detectable = 0;  // in Y
    for (std::size_t f = 0; f < kFactorCount; ++f) {
        for (std::size_t i = 0; i < levels[f].size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                const Level& level = levels[f][i][c];
                const double error = 1 / std::sqrt(level.weight);
                comparisons.push_back(
                    judged(fmt::format("all with {}, {}", (*kFactors[f])[i].name, "XYZ"[c]), level.sum * error * error, error));
                if (c == 1) detectable = std::max(detectable, 4.5 * error);
            }
        }
    }
    std::sort(comparisons.begin(), comparisons.end(), [](const Comparison& a, const Comparison& b) { return a.p < b.p; });
    const double m = static_cast<double>(comparisons.size());
    std::size_t discoveries = 0;
    for (std::size_t i = 0; i < comparisons.size(); ++i) {
        if (comparisons[i].p <= 0.01 * static_cast<double>(i + 1) / m) discoveries = i + 1;
    }
    for (std::size_t i = 0; i < discoveries; ++i) ADD_FAILURE() << comparisons[i].text << ", p = " << comparisons[i].p;
    EXPECT_LT(detectable, 0.01) << "a bias that all scenes with one choice share must be seen from 1 % on";
    std::sort(errors.begin(), errors.end());
    fmt::print(
        "    {} scenes, standard error {:.2f} % (median), {:.2f} % (worst); a bias of {:.2f} % shared by all scenes with one "
        "choice is found\n",
        designs.size(), 100 * errors[errors.size() / 2], 100 * errors.back(), 100 * detectable);
    fmt::print("    smallest p: {:.2g} ({})\n", comparisons[0].p, comparisons[0].text);
}

// A lamp that shines on a wall out of sight: all that is seen was scattered twice.
constexpr const char* kIndirect =
    "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"path\" \"integer maxdepth\" 2\n"
    "LookAt 0 1 -2.6  1.2 1 2  0 1 0\nCamera \"perspective\" \"float fov\" 20\nWorldBegin\n"
    "AttributeBegin Translate -1.6 1 0 Rotate -90 0 1 0 AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" Shape "
    "\"trianglemesh\" "
    "\"point3 P\" [-.3 -.3 0  .3 -.3 0  .3 .3 0  -.3 .3 0] \"integer indices\" [0 1 2 0 2 3] AttributeEnd\n";

// Light of a point, scattered once.
constexpr const char* kPointLight =
    "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"path\" \"integer maxdepth\" 1\n"
    "LookAt 0.3 0.9 -2.6  0 0.5 0  0 1 0\nCamera \"perspective\" \"float fov\" 45\nWorldBegin\n"
    "LightSource \"point\" \"spectrum I\" \"stdillum-D65\" \"float power\" 50 \"point3 from\" [0.4 1.4 -0.3]\n";

// A small lamp before a large lens.
constexpr const char* kLampBeforeLens =
    "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"path\" \"integer maxdepth\" 0\n"
    "Camera \"perspective\" \"float fov\" 40 \"float lensradius\" 1 \"float focaldistance\" 1\nWorldBegin\n"
    "AttributeBegin Translate 0 0 1.5 AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" Shape \"trianglemesh\" "
    "\"point3 P\" [-.25 -.25 0  .25 -.25 0  .25 .25 0  -.25 .25 0] \"integer indices\" [0 2 1 0 3 2] AttributeEnd\n";

// What one strategy adds, wrong by 2 %: weights no longer add up to one, and the picture no longer agrees with that of `path`.
// Scenes are such that all records of a class, or nearly all, come from one strategy. Every way to make a path is among them: light
// that is run into, sampled, or joined to the camera's path (camera records), and light that is joined to the lens or runs into it
// (light records). Halton's numbers are spread over the whole film, so that fewer samples tell its mean.
TEST(Agreement, AStrategyWrongBy2PercentIsCaught) {
    struct Case {
        std::string scene;
        std::uint64_t path_samples, bdpt_samples;
        const char *camera, *light;  // the strategies (s, t) behind each class of records; null: none, or too little light
    };
    const std::vector<Case> cases = {
        {kPointLight + std::string(kRoom), 20'000, 20'000, "(1, 2)", "(2, 1)"},
        {kLampBeforeLens, 60'000, 30'000, "(0, 2)", "(2, 0)"},
        {kIndirect + std::string(kRoom), 300'000, 15'000, "(2, 2)", nullptr},
    };
    for (const Case& c : cases) {
        const Scene scene = scene_from(c.scene);
        const auto with = [&](IntegratorKind kind, std::uint32_t first_seed) {
            return [&scene, kind, first_seed](std::uint32_t seed) {
                return scene.integrator({.kind = kind,
                                         .connections = Connections::kAll,
                                         .max_depth = scene.description.max_depth,
                                         .record = sampledb::RecordKind::kXyz,
                                         .positions = {sampledb::PositionSampler::kHalton23},
                                         .seed = first_seed + seed});
            };
        };
        const Mean path = mean_xyz(with(IntegratorKind::kPath, 0), c.path_samples)[1];
        const auto bdpt = [&](const Factors& factors) {
            return mean_xyz(with(IntegratorKind::kBdpt, 1000), c.bdpt_samples, factors)[1];
        };
        const auto standard_errors_off = [&](const Mean& m) { return (m.value - path.value) / std::hypot(m.error, path.error); };
        const Mean right = bdpt({});
        EXPECT_LT(std::abs(standard_errors_off(right)), 3.5);
        const auto expect_caught = [&](const char* strategy, const Factors& factors) {
            if (strategy == nullptr) return;
            const Mean more = bdpt(factors);
            EXPECT_GT(standard_errors_off(more), 4.5) << strategy;
            fmt::print("    {}, {:.0f} % of the picture: {:+.1f} standard errors off with 2 % more, {:+.1f} without\n", strategy,
                       100 * (more.value / right.value - 1) / 0.02, standard_errors_off(more), standard_errors_off(right));
        };
        expect_caught(c.camera, {.camera = 1.02f});
        expect_caught(c.light, {.light = 1.02f});
    }
}

}  // namespace
}  // namespace latent::render::testing
