// Laws of records: what they hold, and that a sample is a function of its number alone.
#include <algorithm>
#include <cmath>
#include <thread>

#include "color/observer.h"
#include "render/sampling/halton_sampler.h"
#include "render/spectral/wavelength_density.h"
#include "render/transport/bidirectional/weights.h"
#include "render/transport/records.h"
#include "tests/transport/chi_square.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {
namespace {

sampledb::Records trace(const Integrator& integrator, std::uint64_t first, std::uint64_t end) {
    sampledb::Records r;
    RadianceFaults faults;
    for (std::uint64_t n = first; n < end; ++n) integrator.trace(n, r, faults);
    EXPECT_EQ(faults.total(), 0u);
    return r;
}

IntegratorSettings bdpt(sampledb::RecordKind kind) {
    return {.kind = IntegratorKind::kBdpt, .max_depth = 0, .record = kind, .seed = 5};
}

TEST(Integrator, ASampleIsAFunctionOfItsNumberAlone) {
    const Scene scene = scene_named("cornell.pbrt");
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        IntegratorSettings settings = bdpt(sampledb::RecordKind::kSpectral);
        settings.kind = kind;
        const std::unique_ptr<Integrator> integrator = scene.integrator(settings), another = scene.integrator(settings);
        const sampledb::Records together = trace(*integrator, 100, 600);
        sampledb::Records apart;
        std::thread([&] {  // backwards, in another thread, by another integrator, with other samples in between
            std::vector<sampledb::Records> each;
            for (std::uint64_t n = 600; n-- > 100;) {
                each.push_back(trace(*another, n, n + 1));
                trace(*another, n * 7919, n * 7919 + 1);
            }
            for (auto it = each.rbegin(); it != each.rend(); ++it) {
                std::size_t pair = 0;
                for (std::size_t row = 0; row < it->size(); ++row) {
                    apart.append(*it, row, pair);
                    pair += it->pairs[row];
                }
            }
        })
            .join();
        EXPECT_EQ(together.power, apart.power);
        EXPECT_EQ(together.u, apart.u);
        EXPECT_EQ(together.v, apart.v);
        EXPECT_EQ(together.xi, apart.xi);
        EXPECT_EQ(together.index, apart.index);
    }
}

// The XYZ of a spectral record is the XYZ record of the same sample: sum of P_i times the curves.
TEST(Integrator, BothKindsOfRecordTellTheSame) {
    const Scene scene = scene_named("cornell.pbrt");
    const std::unique_ptr<Integrator> spectral = scene.integrator(bdpt(sampledb::RecordKind::kSpectral));
    const std::unique_ptr<Integrator> xyz = scene.integrator(bdpt(sampledb::RecordKind::kXyz));
    const sampledb::Records s = trace(*spectral, 0, 3000), x = trace(*xyz, 0, 3000);
    ASSERT_EQ(s.size(), x.size());
    std::size_t pair = 0;
    int whole = 0, kept = 0;
    for (std::size_t row = 0; row < s.size(); ++row) {
        ASSERT_EQ(s.record_class[row], x.record_class[row]);
        std::array<double, 3> sum{};
        std::vector<float> lambda(28);
        spectral->density().batch(s.xi[row], lambda);
        for (std::uint32_t i = 0; i < s.pairs[row]; ++i) {
            const float nm = s.pairs[row] == 1 ? lambda[s.index[row]] : lambda[i];
            const std::array<float, 3> response = color::Observer::cie1931()(nm);
            for (std::size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(s.power[pair + i]) * static_cast<double>(response[c]);
        }
        pair += s.pairs[row];
        whole += s.pairs[row] == 28;
        kept += s.pairs[row] == 1;
        ASSERT_TRUE(s.pairs[row] == 0 || s.pairs[row] == 1 || s.pairs[row] == 28);
        const double tolerance = 1e-5 * (sum[0] + sum[1] + sum[2]) + 1e-9;
        ASSERT_NEAR(sum[0], static_cast<double>(x.x[row]), tolerance);
        ASSERT_NEAR(sum[1], static_cast<double>(x.y[row]), tolerance);
        ASSERT_NEAR(sum[2], static_cast<double>(x.z[row]), tolerance);
    }
    EXPECT_GT(whole, 2000);
    EXPECT_GT(kept, 20);  // caustics of the dispersive sphere, seen from the light
}

TEST(Integrator, EverySampleHasOneCameraRecordAndShare) {
    const Scene scene = scene_named("conductors.pbrt");
    const std::unique_ptr<Integrator> integrator = scene.integrator(bdpt(sampledb::RecordKind::kSpectral));
    const sampledb::Records r = trace(*integrator, 0, 2000);
    std::vector<float> share(2000);
    for (std::size_t row = 0; row < r.size(); ++row) {
        if (r.record_class[row] == sampledb::RecordClass::kCamera) {
            share[r.sample[row]] += r.share[row];
        } else {
            EXPECT_EQ(r.share[row], 0);
            EXPECT_GT(r.pairs[row], 0);  // black splats are not written
        }
    }
    EXPECT_TRUE(std::all_of(share.begin(), share.end(), [](float s) { return s == 1; }));
    EXPECT_EQ(integrator->light_paths_per_sample(), 1u);
}

// One light above a floor that fills the picture: one test for each camera vertex. bdpt joins as well, and fewer pairs if one for
// each length is to do.
TEST(Integrator, TestsOfVisibilityAreCounted) {
    const Scene floor = scene_from(
        "LookAt 0 0 1  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\nIntegrator \"path\" \"integer maxdepth\" "
        "1\nWorldBegin\n"
        "LightSource \"point\" \"point3 from\" [0 0 2]\nShape \"disk\" \"float radius\" 3\n");
    const std::unique_ptr<Integrator> integrator = floor.integrator({.kind = IntegratorKind::kPath});
    std::thread([&] { trace(*integrator, 0, 300); }).join();
    trace(*integrator, 300, 1000);
    EXPECT_EQ(integrator->shadow_rays(), 1000u);

    const Scene room = scene_named("cornell.pbrt");
    const auto tests_of = [&](Connections connections) {
        IntegratorSettings settings = bdpt(sampledb::RecordKind::kXyz);
        settings.connections = connections;
        const std::unique_ptr<Integrator> bidirectional = room.integrator(settings);
        trace(*bidirectional, 0, 1000);
        return bidirectional->shadow_rays();
    };
    EXPECT_GT(tests_of(Connections::kAll), tests_of(Connections::kOne));
}

TEST(Integrator, BatchesOf4To32) {
    const Scene scene = scene_named("sodium.pbrt");
    for (const std::uint32_t k : {3u, 4u, 17u, 32u, 33u}) {
        IntegratorSettings settings = bdpt(sampledb::RecordKind::kSpectral);
        settings.batch = k;
        settings.max_depth = 3;
        const Result<std::unique_ptr<Integrator>> integrator = make_integrator(scene.description, settings);
        ASSERT_EQ(integrator.has_value(), k >= 4 && k <= 32) << k;
        if (!integrator) continue;
        const sampledb::Records r = trace(**integrator, 0, 500);
        EXPECT_TRUE(std::all_of(r.pairs.begin(), r.pairs.end(), [&](std::uint16_t n) { return n == 0 || n == k; }));
    }
}

// Depth bounds scattering vertices, for both integrators: 0 sees lights only.
TEST(Integrator, DepthZeroSeesLightsOnly) {
    const std::string text =
        "Camera \"perspective\"\nIntegrator \"path\" \"integer maxdepth\" 0\nWorldBegin\nLightSource \"infinite\" \"spectrum L\" "
        "\"stdillum-D65\"\n"
        "Translate 0 0 5 Shape \"sphere\"\n";
    const Scene scene = scene_from(text);
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        IntegratorSettings settings = bdpt(sampledb::RecordKind::kXyz);
        settings.kind = kind;
        const sampledb::Records r = trace(*scene.integrator(settings), 0, 4000);
        int black = 0;
        for (std::size_t row = 0; row < r.size(); ++row) {
            EXPECT_EQ(r.record_class[row], sampledb::RecordClass::kCamera);
            black += r.y[row] == 0;
        }
        EXPECT_GT(black, 40);
        EXPECT_LT(black, 400);  // the sphere, and nothing else
    }
}

// Glass so thin that nothing is reflected, but dispersive: every record keeps one wavelength, of each index as often.
TEST(Integrator, TheKeptWavelengthIsAnyOfTheBatch) {
    const Scene scene = scene_from(
        "Camera \"perspective\" \"float fov\" 40\nWorldBegin\nLightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"\n"
        "Material \"dielectric\" \"spectrum eta\" [360 1.0002 830 1.0001]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-4 -4 2  4 -4 2  4 4 2  -4 4 2] \"integer indices\" [0 1 2 0 2 3]\n");
    for (const std::uint32_t k : {4u, 28u, 32u}) {
        constexpr std::uint64_t kCount = 20'000;
        const sampledb::Records r = trace(
            *scene.integrator({.kind = IntegratorKind::kPath, .batch = k, .record = sampledb::RecordKind::kSpectral, .seed = 5}), 0,
            kCount);
        std::vector<double> counted(k);
        ASSERT_EQ(r.size(), kCount);
        for (std::size_t row = 0; row < kCount; ++row) {
            ASSERT_EQ(r.pairs[row], 1);
            ++counted.at(r.index[row]);
        }
        expect_counts_follow(counted, std::vector<double>(k, static_cast<double>(kCount) / k));
    }
}

// No bound on depth, and nothing that absorbs: light inside a block of glass that is always reflected totally must end all the
// same.
TEST(Integrator, PathsWithoutABoundEnd) {
    const Scene scene = scene_from(
        "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\nLightSource \"point\" \"spectrum I\" \"stdillum-D65\"\n"
        "Material \"dielectric\" \"float eta\" 1.5\nShape \"trianglemesh\" \"point3 P\" [-1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1  -1 -1 "
        "1  1 -1 1  1 1 1 "
        " -1 1 1] \"integer indices\" [0 2 1 0 3 2  4 5 6 4 6 7  0 1 5 0 5 4  3 6 2 3 7 6  0 4 7 0 7 3  1 2 6 1 6 5]\n");
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        IntegratorSettings settings = bdpt(sampledb::RecordKind::kXyz);
        settings.kind = kind;
        settings.max_depth = kUnlimited;
        EXPECT_GE(trace(*scene.integrator(settings), 0, 3000).size(), 3000u);
    }
}

// Fog without end, and light from infinity: nothing comes through, from either side.
TEST(Integrator, LightFromInfinityDoesNotComeThroughEndlessFog) {
    const std::string inside = "MediumInterface \"fog\" \"fog\"\n";
    const std::string fog =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.1 .1 .1] \"rgb sigma_s\" [.2 .2 .2]\n" + inside;
    for (const std::string light : {"LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"\n", "LightSource \"distant\"\n"}) {
        const Scene scene = scene_from(fog + "LookAt 0 1 -5  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\n" + inside + light +
                                       "Material \"diffuse\"\nShape \"sphere\"\n");
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            IntegratorSettings settings = bdpt(sampledb::RecordKind::kXyz);
            settings.kind = kind;
            const sampledb::Records r = trace(*scene.integrator(settings), 0, 4000);
            EXPECT_TRUE(std::all_of(r.y.begin(), r.y.end(), [](float y) { return y < 1e-30f; }));
        }
    }
}

// Radiance that no light can have: counted by its cause, black in the camera image, absent from the light image.
TEST(Records, FaultsAreCountedAndKeptOut) {
    const sampledb::WavelengthDensity density = wavelength_density({});
    const WavelengthSampler wavelengths(density, 28);
    SpectrumLibrary library;
    SampledSpectra spectra(library);
    wavelengths.draw(12345, spectra.wavelengths);
    const HaltonSampler sampler({}, 1, {});
    const SampleState sample{SampleNumbers(sampler, 1), spectra, 0};
    const Camera camera = *Camera::make({});
    CameraPoint point{};
    point.u = point.v = 0.5f;
    for (const sampledb::RecordKind kind : {sampledb::RecordKind::kSpectral, sampledb::RecordKind::kXyz}) {
        const LightGroups none;
        const RecordMaker maker(kind, none, {});
        sampledb::Records r;
        RadianceFaults faults;
        SampleRecords records(maker, sample, camera, {r, faults});
        for (const float bad : {std::nanf(""), kInfinity, -1.0f}) {
            Radiance radiance(none, sample);
            SampledSpectrum value(1.0f);
            value[7] = bad;
            radiance.add(value, false, kNone);
            records.camera(2, 3, radiance, {});
            records.light(point, radiance);
        }
        EXPECT_EQ(faults.nan, 2u);
        EXPECT_EQ(faults.infinite, 2u);
        EXPECT_EQ(faults.negative, 2u);
        ASSERT_EQ(r.size(), 3u);
        EXPECT_TRUE(r.power.empty());
        EXPECT_TRUE(std::all_of(r.y.begin(), r.y.end(), [](float y) { return y == 0; }));
    }
}

// A vertex that is far likelier from the other side, before one that is far less likely.
TEST(BidirectionalWeights, AreNumbersHoweverFarDensitiesAreApart) {
    const float huge = mis_term(1e25f, 1, 1);
    EXPECT_TRUE(std::isinf(huge));
    EXPECT_EQ(mis_weight(huge), 0);
    EXPECT_EQ(mis_term(1e-25f, 1, 1 + huge), 0);
}

}  // namespace
}  // namespace latent::render::testing
