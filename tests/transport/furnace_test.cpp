// Light where the answer is known: closed diffuse boxes, lights seen directly, and lights that cannot be seen.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "color/named_spectra.h"
#include "color/observer.h"
#include "tests/transport/picture_mean.h"

namespace latent::render::testing {
namespace {

const char* const kBox = R"(
  Shape "trianglemesh" "point3 P" [ -1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1   -1 -1 1  1 -1 1  1 1 1  -1 1 1 ]
    "integer indices" [ 0 1 2 0 2 3  4 6 5 4 7 6  0 5 1 0 4 5  3 2 6 3 6 7  0 7 4 0 3 7  1 6 2 1 5 6 ]
)";

// Radiance at each wavelength over the light's own, averaged over samples: P / (L / (k p)).
std::vector<double> furnace(const std::string& reflectance, IntegratorKind kind, std::uint32_t depth, std::uint64_t samples,
                            double& error) {
    const std::string text =
        "LookAt 0.1 0 0  0.3 0.2 1  0 1 0\nCamera \"perspective\" \"float fov\" 70\nFilm \"rgb\" \"integer xresolution\" 64 "
        "\"integer yresolution\" 64\n"
        "WorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" " +
        reflectance + "\nAttributeBegin\nAreaLightSource \"diffuse\" \"spectrum L\" [360 1 830 1] \"bool twosided\" true\n" + kBox +
        "AttributeEnd\n";
    const Scene scene = scene_from(text);
    const std::unique_ptr<Integrator> integrator =
        scene.integrator({.kind = kind, .max_depth = depth, .record = sampledb::RecordKind::kSpectral, .seed = 3});
    const WavelengthSampler sampler(integrator->density(), 28);
    Wavelengths w;
    std::vector<double> sum(28), squares(28);
    sampledb::Records r;
    RadianceFaults faults;
    for (std::uint64_t n = 0; n < samples; ++n) {
        r.clear();
        integrator->trace(n, r, faults);
        std::vector<double> of_sample(28);
        std::size_t at = 0;
        for (std::size_t i = 0; i < r.size(); ++i) {
            sampler.draw(r.xi[i], w);
            for (std::uint32_t wavelength = 0; wavelength < r.pairs[i]; ++wavelength) {
                of_sample[wavelength] +=
                    static_cast<double>(r.power[at + wavelength] / w.weight[wavelength]) * 106.856917;  // the light's Y is 1
            }
            at += r.pairs[i];
        }
        for (std::uint32_t wavelength = 0; wavelength < 28; ++wavelength) {
            sum[wavelength] += of_sample[wavelength];
            squares[wavelength] += of_sample[wavelength] * of_sample[wavelength];
        }
    }
    EXPECT_EQ(faults.total(), 0u);
    error = 0;
    for (std::uint32_t wavelength = 0; wavelength < 28; ++wavelength) {
        sum[wavelength] /= static_cast<double>(samples);
        error = std::max(
            error, std::sqrt(std::max(0.0, squares[wavelength] / static_cast<double>(samples) - sum[wavelength] * sum[wavelength]) /
                             static_cast<double>(samples)));
    }
    return sum;
}

// Le (1 - rho^(d+1)) / (1 - rho) with at most d scattering vertices, at every wavelength.
TEST(Furnace, AClosedDiffuseBoxShinesByTheGeometricSeries) {
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        for (const double rho : {0.5, 0.9}) {
            for (const std::uint32_t depth : {1u, 2u, 5u, kUnlimited}) {
                SCOPED_TRACE(std::to_string(rho) + (kind == IntegratorKind::kPath ? " path " : " bdpt ") + std::to_string(depth));
                double error = 0;
                const std::vector<double> mean =
                    furnace("[360 " + std::to_string(rho) + " 830 " + std::to_string(rho) + "]", kind, depth, 30'000, error);
                const double expected = (1 - std::pow(rho, static_cast<double>(depth) + 1)) / (1 - rho);
                EXPECT_LT(error, 0.01 * expected);
                for (const double m : mean) EXPECT_NEAR(m, expected, 4 * error + 1e-4 * expected);
            }
        }
    }
}

// A reflectance that varies with wavelength: each wavelength has its own answer, and the batch is in the record's order.
TEST(Furnace, HoldsWavelengthByWavelength) {
    double error = 0;
    const std::vector<double> mean = furnace("[360 0.9 830 0.1]", IntegratorKind::kPath, 3, 60'000, error);
    for (std::size_t wavelength = 1; wavelength < mean.size(); ++wavelength) EXPECT_LT(mean[wavelength], mean[wavelength - 1]);
    // Ends of the range: between the values at the wavelengths that the first and the last wavelength can have.
    EXPECT_LT(mean.front(), (1 - std::pow(0.9, 4)) / 0.1);
    EXPECT_GT(mean.back(), 1 + 0.1);
}

// What absorbs nothing cannot be seen before a uniform infinite light: Y = 1, and the colour is the light's.
void expect_unseen(const Scene& scene, const char* name) {
    const color::Xyz white = xyz_from_spectrum(color::illuminant_d65(), color::Observer::cie1931());
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        for (const std::uint32_t k : {4u, 28u, 32u}) {
            SCOPED_TRACE(fmt::format("{}, {}, {} wavelengths", name, kind == IntegratorKind::kPath ? "path" : "bdpt", k));
            const Mean mean = mean_of_picture(scene, {.kind = kind, .max_depth = kUnlimited, .batch = k, .seed = 7}, 40'000);
            const double expected[3] = {white.x / white.y, 1, white.z / white.y};
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_LT(mean.error[c], 0.02);
                EXPECT_NEAR(mean.xyz[c], expected[c], 4 * mean.error[c] + 2e-4);
            }
        }
    }
}

std::string view_from(double distance) {
    return fmt::format(
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nLookAt 0 0 -{}  0 0 0  0 1 0\nCamera \"perspective\" "
        "\"float fov\" 40\nWorldBegin\nLightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"\n",
        distance);
}

// Glass, panes, fog; with few wavelengths or many.
TEST(Furnace, NothingThatAbsorbsNothingShowsBeforeAUniformInfiniteLight) {
    const std::string fog =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" [360 0 830 0] \"spectrum sigma_s\" [360 3 "
        "830 1] "
        "\"float g\" 0.4\nMediumInterface \"fog\" \"\"\n";
    const std::vector<std::pair<const char*, std::string>> cases = {
        {"glass", "Material \"dielectric\" \"float eta\" 1.5\n"},
        {"dispersive glass", "Material \"dielectric\" \"spectrum eta\" \"glass-SF11\"\n"},
        {"pane", "Material \"thindielectric\" \"float eta\" 1.5\n"},
        {"dispersive pane", "Material \"thindielectric\" \"spectrum eta\" \"glass-SF11\"\n"},
        {"fog", fog + "Material \"interface\"\n"},
        {"fog in glass", fog + "Material \"dielectric\" \"float eta\" 1.5\n"},
    };
    for (const auto& [name, text] : cases) expect_unseen(scene_from(view_from(3) + text + "Shape \"sphere\"\n"), name);
}

// Also where it reaches far beyond the shapes and the camera; one or several in the same place.
TEST(Furnace, FogThatReachesBeyondTheShapesIsUnseen) {
    const auto grid = [](const char* name, double low, double high) {
        return fmt::format(
            "MakeNamedMedium \"{}\" \"string type\" \"uniformgrid\" \"integer nx\" 1 \"integer ny\" 1 \"integer nz\" 1 \"float "
            "density\" 1 \"point3 p0\" [{} -2 -2] \"point3 p1\" [{} 2 2] \"spectrum sigma_a\" [360 0 830 0] \"spectrum sigma_s\" "
            "[360 .5 830 .2]\n",
            name, low, high);
    };
    const std::string inside = "MediumInterface \"\" \"fog\"\n",
                      glass = "Material \"dielectric\"\nShape \"sphere\" \"float radius\" .1\n";
    expect_unseen(scene_from(grid("fog", -2, 2) + inside + view_from(0.5) + inside + glass), "one");
    expect_unseen(scene_from(grid("a", -2, 1) + grid("b", -1, 2) +
                             "MakeNamedMedium \"fog\" \"string type\" \"latent:sum\" \"string latent:media\" [\"a\" \"b\"]\n" +
                             inside + view_from(0.5) + inside + glass),
                  "two");
}

// A grey floor in z = 0 at the origin under one light: Y = rho / pi E, E the illuminance by `power` or `illuminance` of the scene.
TEST(DirectLight, HasThePowerOrIlluminanceThatTheSceneSays) {
    const double pi = std::numbers::pi, degree = pi / 180;
    const double spot = 2 * pi * (1 - 0.5 * (std::cos(25 * degree) + std::cos(30 * degree)));  // solid angle that counts whole
    const std::string
        above = "AttributeBegin Translate 0 0 2 ",
        area = "AreaLightSource \"diffuse\" \"blackbody L\" 4000 \"float power\" 7 ",
        tiny =
            "Shape \"trianglemesh\" \"point3 P\" [-.01 -.01 0  -.01 .02 0  .02 -.01 0] \"integer indices\" [0 1 2] AttributeEnd\n";
    const std::vector<std::pair<std::string, double>> cases = {
        {"LightSource \"distant\" \"blackbody L\" 4000 \"float illuminance\" 7 \"point3 from\" [1 0 1] \"point3 to\" [0 0 0]\n",
         7 * std::sqrt(0.5)},
        {"LightSource \"infinite\" \"blackbody L\" 4000 \"float illuminance\" 7\n", 7},
        {"LightSource \"infinite\" \"string filename\" \"sky.exr\" \"float illuminance\" 7\n", 7},
        {"LightSource \"point\" \"blackbody I\" 4000 \"float power\" 7 \"point3 from\" [0 0 2]\n", 7 / (4 * pi) / 4},
        {"LightSource \"spot\" \"blackbody I\" 4000 \"float power\" 7 \"point3 from\" [0 0 2] \"point3 to\" [0 0 0]\n",
         7 / spot / 4},
        {above + area + "Shape \"sphere\" \"float radius\" 0.4 AttributeEnd\n", 7 / (4 * pi) / 4},
        {above + area + tiny, 7 / pi / 4},
        {above + area + "\"bool twosided\" true " + tiny, 7 / (2 * pi) / 4},
        {above + area + "\"float scale\" 3 " + tiny, 3 * 7 / pi / 4},
    };
    for (const auto& [light, illuminance] : cases) {
        const Scene scene = scene_under_sky(
            "LookAt 3 0 3  0 0 0  0 0 1\nCamera \"orthographic\" \"float screenwindow\" [-.01 .01 -.01 .01]\nWorldBegin\n" + light +
            "Material \"diffuse\" \"spectrum reflectance\" [360 .5 830 .5]\nShape \"trianglemesh\" \"point3 P\" [-9 -9 0  9 -9 0  "
            "0 9 0] "
            "\"integer indices\" [0 1 2]\n");
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            SCOPED_TRACE(light + (kind == IntegratorKind::kPath ? ", path" : ", bdpt"));
            const Mean mean = mean_of_picture(scene, {.kind = kind, .max_depth = 1, .seed = 9}, 20'000);
            const double expected = 0.5 / pi * illuminance;
            EXPECT_LT(mean.error[1], 0.01 * expected);
            EXPECT_NEAR(mean.xyz[1], expected, 4 * mean.error[1] + 1e-3 * expected);  // lights and window have an extent
        }
    }
}

// Mean XYZ of a picture that a light fills.
std::array<double, 3> seen_light(const std::string& light) {
    const Scene scene = scene_from(
        "Camera \"perspective\" \"float fov\" 20\nFilm \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" "
        "64\nWorldBegin\n" +
        light);
    return mean_of_picture(scene, {.max_depth = 1}, 20'000).xyz;
}

void expect_colour(const std::string& light, const color::Spectrum& spectrum, double scale) {
    const color::Xyz expected = xyz_from_spectrum(spectrum, color::Observer::cie1931());
    const double factor = scale / color::photometric_sum(spectrum);
    const std::array<double, 3> mean = seen_light(light);
    EXPECT_NEAR(mean[0], expected.x * factor, 1e-4 * scale);
    EXPECT_NEAR(mean[1], expected.y * factor, 1e-4 * scale);
    EXPECT_NEAR(mean[2], expected.z * factor, 1e-4 * scale);
}

TEST(DirectLight, HasTheColourThatItsSpectrumSays) {
    const std::string wall =
        " Shape \"trianglemesh\" \"point3 P\" [-9 -9 5  9 -9 5  9 9 5  -9 9 5] \"integer indices\" [0 2 1 0 3 2]\n";
    expect_colour("LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"\n", color::illuminant_d65(), 1);
    expect_colour("AreaLightSource \"diffuse\" \"blackbody L\" 2856 \"float scale\" 20 \"bool twosided\" true" + wall,
                  *color::Spectrum::blackbody(2856), 20);
    const color::Spectrum sodium =
        *color::Spectrum::from_samples({360, 586.5, 588.5, 590.5, 592.5, 830}, {0, 0, 1, 1, 0, 0}, color::Outside::kZero);
    // The table by integer nm holds steps where the file has ramps: the colour of the steps is what is seen, within 1e-3 of the
    // ramps'.
    const std::array<double, 3> lamp = seen_light(
        "AreaLightSource \"diffuse\" \"spectrum L\" [360 0 586.5 0 588.5 1 590.5 1 592.5 0 830 0] \"bool twosided\" true" + wall);
    const color::Xyz expected = xyz_from_spectrum(sodium, color::Observer::cie1931());
    EXPECT_NEAR(lamp[1], 1, 1e-3);
    EXPECT_NEAR(lamp[0] / lamp[1], expected.x / expected.y, 1e-3);
}

// Spectra that whole nm cannot hold: lines on one and between two, by themselves and over a continuum, with ramps and with edges.
TEST(DirectLight, OfScaleOneHasTheYOfOneWhateverItsLines) {
    struct Case {
        std::string name, parameter;
        color::Spectrum written;
    };
    std::vector<Case> cases = {
        {"black body", "\"blackbody L\" 2856", *color::Spectrum::blackbody(2856)},
        {"name", "\"spectrum L\" \"metal-MgO-eta\"", *color::named_spectrum("metal-MgO-eta")},
    };
    const Folder folder;
    const std::pair<const char*, const char*> lines[] = {
        {"at 589 nm", "360 0  588.9 0  589 1  589.1 0  830 0"},
        {"between 588 and 589 nm", "588.1 0  588.5 1  588.9 0"},
        {"doublet", "360 0  588.97 0  588.995 2  589.02 0  589.567 0  589.592 1  589.617 0  830 0"},
        {"over a continuum", "360 .1  588.99 .1  588.995 3  589 .1  589.59 .1  589.592 2  589.6 .1  830 .1"},
        {"blue and red", "360 0  449.8 0  450 1  450.2 0  649.6 0  649.8 .7  650 0  830 0"},
        {"widened", "360 0  545.999 0  546.0003 1000  546.001 0  830 0"},
        {"edges, widened", "532.3 1  532.301 1"},
        {"edges", "632.7 1  633 1"},
        {"steep", "360 0  588.2 0  588.20001 1  588.7 1  588.70001 0  830 0"},
    };
    for (const auto& [name, pairs] : lines) {
        std::vector<double> nm, value;
        std::istringstream words(pairs);
        for (double a, b; words >> a >> b;) nm.push_back(a), value.push_back(b);
        const color::Spectrum written = *color::Spectrum::from_samples(nm, value, color::Outside::kZero);
        const std::string file = std::string(name) + ".spd";
        folder.write(file, pairs);
        cases.push_back({name, fmt::format("\"spectrum L\" [ {} ]", pairs), written});
        cases.push_back({file, fmt::format("\"spectrum L\" \"{}\"", file), written});
    }
    for (const Case& light : cases) {
        SCOPED_TRACE(light.name);
        const Scene scene = scene_of(load_scene(
            folder.write("sky.pbrt", "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\" " + light.parameter + "\n")));
        const color::Xyz written = xyz_from_spectrum(light.written, color::Observer::cie1931());
        const double expected[3] = {written.x / written.y, 1, written.z / written.y};
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            const Mean mean = mean_of_picture(scene, {.kind = kind, .max_depth = 1}, 20'000);
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_LT(mean.error[c], 3e-3 * std::max(1.0, expected[c]));
                EXPECT_NEAR(mean.xyz[c], expected[c], 4 * mean.error[c] + 1e-4);
            }
        }
    }
}

// A lens has an area, which light can meet by chance. A point or a direction is invisible all the same, in mirrors, through glass
// and through panes too: no path from the camera finds it there.
TEST(DeltaLights, AreInvisibleThroughMirrorsAndGlassToo) {
    const std::string plate =
        "Shape \"trianglemesh\" \"point3 P\" [-4 -4 0  4 -4 0  4 4 0  -4 4 0] \"integer indices\" [0 1 2 0 2 3]\n";
    const std::vector<std::pair<std::string, std::string>> objects = {
        {"interface", "Material \"interface\"\n" + plate},
        {"pane", "Material \"thindielectric\" \"float eta\" 1.5\n" + plate},
        {"glass", "Material \"dielectric\" \"float eta\" 1.5\nShape \"sphere\" \"float radius\" 0.5\n"},
        {"dispersive glass", "Material \"dielectric\" \"spectrum eta\" \"glass-SF11\"\nShape \"sphere\" \"float radius\" 0.5\n"},
        {"mirror", "Material \"conductor\" \"float roughness\" 0\nTranslate 0 0 3\n" + plate},
    };
    const std::vector<std::pair<std::string, std::string>> lights = {
        {"point", "LightSource \"point\" \"spectrum I\" \"stdillum-D65\" \"point3 from\" [0 0.1 1]\n"},
        {"spot", "LightSource \"spot\" \"spectrum I\" \"stdillum-D65\" \"point3 from\" [0 0.1 1] \"point3 to\" [0 0 -3]\n"},
        {"spot, away", "LightSource \"spot\" \"spectrum I\" \"stdillum-D65\" \"point3 from\" [0 0.1 1] \"point3 to\" [0 0 3]\n"},
        {"distant", "LightSource \"distant\" \"spectrum L\" \"stdillum-D65\" \"point3 from\" [0 0.1 1] \"point3 to\" [0 0 0]\n"},
        {"distant, away",
         "LightSource \"distant\" \"spectrum L\" \"stdillum-D65\" \"point3 from\" [0 0.1 -1] \"point3 to\" [0 0 0]\n"},
    };
    for (const auto& [object, shape] : objects) {
        for (const auto& [light, source] : lights) {
            const Scene scene = scene_from(
                "LookAt 0 0 -3  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 90 \"float lensradius\" 1\nWorldBegin\n" +
                source + shape);
            for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
                SCOPED_TRACE(fmt::format("{}, {}, {}", object, light, kind == IntegratorKind::kPath ? "path" : "bdpt"));
                EXPECT_EQ(mean_of_picture(scene, {.kind = kind, .seed = 7}, 4000).xyz[1], 0);
            }
        }
    }
}

// What they light is visible: a wall behind a pane, lit through the pane. Only light that hits the lens by chance comes that way,
// after the wall has scattered it: with `bdpt` and a lens. In focus is the wall, 4 m away, of which the window shows a square of
// side w = 8 tan 45 deg:  Y = rho / pi Phi (1 - R')^2 / w^2,  Phi what the spot emits, R' the pane's at normal incidence.
TEST(DeltaLights, LightWallsBehindPanesForALens) {
    const Scene scene = scene_from(
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"path\" \"integer maxdepth\" 3\n"
        "LookAt 0 0 -4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 90 \"float lensradius\" 1 \"float focaldistance\" 4\n"
        "WorldBegin\nLightSource \"spot\" \"spectrum I\" \"stdillum-D65\" \"float power\" 100 \"float coneangle\" 8 \"point3 "
        "from\" [0 0 -3] "
        "\"point3 to\" [0 0 0]\n"
        "Material \"thindielectric\" \"float eta\" 1.5\n"
        "Shape \"trianglemesh\" \"point3 P\" [-9 -9 -1  9 -9 -1  9 9 -1  -9 9 -1] \"integer indices\" [0 1 2 0 2 3]\n"
        "Material \"diffuse\" \"spectrum reflectance\" [360 0.5 830 0.5]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-9 -9 0  9 -9 0  9 9 0  -9 9 0] \"integer indices\" [0 1 2 0 2 3]\n");
    EXPECT_EQ(mean_of_picture(scene, {.kind = IntegratorKind::kPath, .seed = 7}, 4000).xyz[1], 0);
    const Mean bdpt = mean_of_picture(scene, {.kind = IntegratorKind::kBdpt, .seed = 7}, 200'000);
    const double f = 0.04, reflected = 2 * f / (1 + f);
    const double expected = 0.5 / std::numbers::pi * 100 * (1 - reflected) * (1 - reflected) / 64;
    EXPECT_LT(bdpt.error[1], 0.02 * expected);
    EXPECT_NEAR(bdpt.xyz[1], expected, 4 * bdpt.error[1]);
}

}  // namespace
}  // namespace latent::render::testing
