// Media that overlap add up (docs/scenes.md, "Extensions"): their sum is one medium of summed coefficients, in each wavelength.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/medium/make_medium.h"
#include "render/sampling/halton_sampler.h"
#include "render/spectral/wavelength_density.h"
#include "tests/transport/chi_square.h"
#include "tests/transport/lit_floor.h"
#include "tests/transport/numbers.h"
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

// A ball of the medium "m" over a floor.
std::string ball(const std::string& media) {
    return floor_under_sky(4, ".5 .7 1") + media +
           "AttributeBegin\nTranslate .2 0 .2\nMaterial \"interface\"\nMediumInterface \"m\" \"\"\nShape \"sphere\" \"float "
           "radius\" "
           ".8\nAttributeEnd\n"
           "Translate -.2 .1 1.6\nRotate 160 1 .2 0\nAreaLightSource \"diffuse\" \"float scale\" 9\nShape \"disk\" \"float "
           "radius\" .3\n";
}
std::string medium(const std::string& name, const std::string& rest) {
    return fmt::format("MakeNamedMedium \"{}\" \"string type\" {}\n", name, rest);
}
std::string sum(const std::string& name, const std::string& a, const std::string& b) {
    return medium(name, fmt::format("\"latent:sum\" \"string latent:media\" [\"{}\" \"{}\"]", a, b));
}

std::vector<float> xyz_of(const Scene& scene, IntegratorKind kind) {
    const std::unique_ptr<Integrator> integrator =
        scene.integrator({.kind = kind, .record = sampledb::RecordKind::kXyz, .seed = 4});
    sampledb::Records out;
    RadianceFaults faults;
    for (std::uint64_t n = 0; n < 2000; ++n) integrator->trace(n, out, faults);
    EXPECT_EQ(faults.total(), 0u);
    out.x.insert(out.x.end(), out.y.begin(), out.y.end());
    return out.x;
}

TEST(SumMedium, TwoHomogeneousMediaAreOneOfSummedCoefficients) {
    // Binary fractions, so that not even the last bit differs.
    const Scene two = scene_from(ball(
        medium("a", "\"homogeneous\" \"spectrum sigma_a\" [360 .25 830 .25] \"spectrum sigma_s\" [360 .5 830 1] \"float g\" .5") +
        medium("b", "\"homogeneous\" \"spectrum sigma_a\" [360 .125 830 .125] \"spectrum sigma_s\" [360 2 830 1] \"float g\" .5") +
        sum("m", "a", "b")));
    const Scene one = scene_from(ball(medium(
        "m", "\"homogeneous\" \"spectrum sigma_a\" [360 .375 830 .375] \"spectrum sigma_s\" [360 2.5 830 2] \"float g\" .5")));
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt})
        EXPECT_EQ(xyz_of(two, kind), xyz_of(one, kind));
    // A third one that is nothing changes nothing.
    const Scene three = scene_from(ball(
        medium("a", "\"homogeneous\" \"spectrum sigma_a\" [360 .25 830 .25] \"spectrum sigma_s\" [360 .5 830 1] \"float g\" .5") +
        medium("b", "\"homogeneous\" \"spectrum sigma_a\" [360 .125 830 .125] \"spectrum sigma_s\" [360 2 830 1] \"float g\" .5") +
        medium("none", "\"homogeneous\" \"spectrum sigma_a\" [360 0 830 0] \"spectrum sigma_s\" [360 0 830 0] \"float g\" .5") +
        sum("ab", "none", "b") + sum("m", "a", "ab")));
    EXPECT_EQ(xyz_of(three, IntegratorKind::kPath), xyz_of(one, IntegratorKind::kPath));
}

const std::string kVoxels =
    "\"uniformgrid\" \"integer nx\" 2 \"integer ny\" 1 \"integer nz\" 3 \"float density\" [1 .2 .5 .9 .1 .7] "
    "\"point3 p0\" [-.5 -.6 -.4] \"point3 p1\" [.5 .6 .7] ";

// The same density twice: one grid whose coefficients are the sums.
TEST(SumMedium, TwoGridsAreOneOfSummedCoefficients) {
    const Scene two = scene_from(
        ball(medium("a", kVoxels + "\"spectrum sigma_a\" [360 .5 830 .5] \"spectrum sigma_s\" [360 1 830 4] \"float g\" .3") +
             medium("b", kVoxels + "\"spectrum sigma_a\" [360 0 830 2] \"spectrum sigma_s\" [360 4 830 2] \"float g\" .3") +
             sum("m", "a", "b")));
    const Scene one = scene_from(
        ball(medium("m", kVoxels + "\"spectrum sigma_a\" [360 .5 830 2.5] \"spectrum sigma_s\" [360 5 830 6] \"float g\" .3")));
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt})
        expect_equal(picture_of(two, {.kind = kind}, 3072), picture_of(one, {.kind = kind}, 3072));
}

class Overlap : public ::testing::Test {
 protected:
    static MediumDescription described(double a0, double a1, double s0, double s1, double g) {
        const auto line = [](double at_360, double at_830) {
            return color::Spectrum::from_function([=](double nm) { return at_360 + (at_830 - at_360) * (nm - 360) / 470; },
                                                  color::Outside::kZero);
        };
        MediumDescription d;
        d.sigma_a = line(a0, a1), d.sigma_s = line(s0, s1), d.g = g;
        return d;
    }
    // Haze everywhere, and two columns of a grid that grow along z; they overlap in 0.5 .. 1.5.
    static std::vector<MediumDescription> media() {
        std::vector<MediumDescription> list{described(.1, .3, .5, .2, -.4), described(.2, .1, 2, .3, .8),
                                            described(0, .2, .4, 1, .1)};
        for (std::size_t i : {1u, 2u}) {
            VoxelGrid grid = VoxelGrid::of_size({1, 1, 2});
            grid.set(0, 0, 0, 0.5f), grid.set(0, 0, 1, 1.5f);
            // Constant across, and voxels at both ends of the box.
            list[i].volume = GridVolume{.density = {std::make_shared<const VoxelGrid>(std::move(grid)),
                                                    Affined({0, 0, 0}, {0, 0, 0}, {0, 0, 1 / kThick}, {0, 0, 0})}};
            list[i].low = {-50, -50, 0}, list[i].high = {50, 50, kThick};
        }
        list[2].world_from_medium.t = {0, 0, 0.5};
        list.push_back({.summed = {1, 2}});
        list.push_back({.summed = {0, 3}});
        return list;
    }
    Overlap() {
        WavelengthSampler(wavelength_density({}), 28).draw(987654321, spectra_.wavelengths);
        spectra_.start_sample();
    }
    static double density(std::size_t i, double z) {
        if (i == 0) return 1;
        const double at = i == 2 ? z - 0.5 : z;
        return at >= 0 && at <= kThick ? 0.5 + at / kThick : 0;
    }
    double sigma_t(std::size_t i, double nm) const { return media_[i].sigma_a(nm) + media_[i].sigma_s(nm); }
    double nm(std::uint32_t i) const { return 360 + spectra_.wavelengths.nearest[i]; }

    static constexpr double kThick = 1.5;
    std::vector<MediumDescription> media_ = media();
    SpectrumLibrary library_;
    std::unique_ptr<const Medium> sum_ = make_medium(media_, 4, library_);
    SampledSpectra spectra_{library_};
    HaltonSampler sampler_{{}, 1, {}};
    SampleState sample_{{sampler_, 0}, spectra_, 0, Random(78)};
    Segment segment_{{0.3f, 0.2f, -0.2f}, {0, 0, 1}, 2.6f};
};

TEST_F(Overlap, TransmittanceIsTheProductAndScatteringTheSum) {
    EXPECT_FALSE(sum_->box());
    constexpr int kCount = 100'000;
    std::array<std::array<double, 3>, 28> sums{}, squares{};
    Numbers u(3);
    for (int n = 0; n < kCount; ++n) {
        SampledSpectrum through(1.0f), value(1.0f);
        sum_->multiply_transmittance(segment_, sample_, through);
        const Uniform channel = u(), x = u();
        const bool scattered = sum_->sample_step(segment_, channel, x, sample_, value, nullptr).scattered;
        for (std::uint32_t i = 0; i < 28; ++i) {
            const double v[3] = {static_cast<double>(through[i]), scattered ? 0 : static_cast<double>(value[i]),
                                 scattered ? static_cast<double>(value[i]) : 0};
            for (std::size_t k = 0; k < 3; ++k) sums[i][k] += v[k], squares[i][k] += v[k] * v[k];
        }
    }
    for (std::uint32_t i = 0; i < 28; ++i) {
        constexpr int kSteps = 6500;
        double depth = 0, scattering = 0;
        for (int j = 0; j < kSteps; ++j) {
            const double z = -0.2 + 2.6 * (j + 0.5) / kSteps, dz = 2.6 / kSteps;
            double t = 0, s = 0;
            for (std::size_t m = 0; m < 3; ++m) {
                t += density(m, z) * sigma_t(m, nm(i));
                s += density(m, z) * media_[m].sigma_s(nm(i));
            }
            scattering += s * std::exp(-depth - t * dz / 2) * dz;
            depth += t * dz;
        }
        const double expected[3] = {std::exp(-depth), std::exp(-depth), scattering};
        for (std::size_t k = 0; k < 3; ++k) {
            const double mean = sums[i][k] / kCount, error = std::sqrt((squares[i][k] / kCount - mean * mean) / kCount);
            EXPECT_NEAR(mean, expected[k], 5 * error + 1e-4) << i << " " << k;
        }
    }
}

// Seen from either end, a step has the same densities for weights.
TEST_F(Overlap, WeightsAreTheSameBothWays) {
    Numbers u(5);
    for (int n = 0; n < 300; ++n) {
        const Vec3f a{u(), u(), 3 * u() - 0.5f}, b{u(), u(), 3 * u() - 0.5f};
        const float length = render::length(b - a);
        SampledSpectrum value(1.0f);
        const MediumStep there = sum_->multiply_transmittance({a, b - a, length}, sample_, value),
                         back = sum_->multiply_transmittance({b, a - b, length}, sample_, value);
        EXPECT_NEAR(there.column, back.column, 1e-3f * there.column + 1e-5f);
        EXPECT_NEAR(there.transmittance, back.transmittance, 1e-3f);
    }
}

TEST_F(Overlap, EachPartScattersItsShareByItsOwnPhaseFunction) {
    const Vec3f p{0.1f, 0, 0.9f}, wo = normalize(Vec3f{0.3f, -0.2f, 1});
    const Phase phase = sum_->phase(p, sample_);
    ASSERT_NE(phase.mixture, nullptr);
    constexpr int kBins = 40, kCount = 200'000;
    std::vector<double> counted(kBins);
    Numbers u(7);
    for (int n = 0; n < kCount; ++n) {
        const float part = u(), x = u(), y = u();
        const double c = static_cast<double>(dot(phase.sample(wo, part, x, y), wo));
        ++counted[static_cast<std::size_t>(std::clamp((c + 1) / 2 * kBins, 0.0, kBins - 1.0))];
    }
    const auto direction = [&](double c) {
        const Frame frame = Frame::from_z(wo);
        return frame.x * static_cast<float>(std::sqrt(1 - c * c)) + wo * static_cast<float>(c);
    };
    double chi2 = 0;
    for (int b = 0; b < kBins; ++b) {
        constexpr int kFine = 200;
        double expected = 0;
        for (int j = 0; j < kFine; ++j) {
            const double c = -1 + 2 * (b + (j + 0.5) / kFine) / kBins;
            expected += static_cast<double>(phase.pdf_omega(wo, direction(c))) * 2 * std::numbers::pi * 2 / kBins / kFine * kCount;
        }
        chi2 += (counted[static_cast<std::size_t>(b)] - expected) * (counted[static_cast<std::size_t>(b)] - expected) / expected;
    }
    EXPECT_GT(chi_square_tail(chi2, kBins - 1), 1e-4) << chi2;

    const Vec3f wi = direction(-0.7);
    SampledSpectrum value(1.0f);
    phase.multiply(wo, wi, value);
    for (std::uint32_t i = 0; i < 28; ++i) {
        double scattered = 0, total = 0;
        for (std::size_t m = 0; m < 3; ++m) {
            const double s = density(m, 0.9) * media_[m].sigma_s(nm(i));
            total += s;
            scattered += s * static_cast<double>(PhaseFunction{static_cast<float>(media_[m].g)}(wo, wi));
        }
        EXPECT_NEAR(static_cast<double>(value[i]), scattered / total, 1e-4 * scattered / total);
    }
}

TEST(SumMedium, PathAndBdptMakeOnePicture) {
    const std::string haze =
                          medium("haze", "\"homogeneous\" \"rgb sigma_a\" [.1 .2 .4] \"rgb sigma_s\" [.9 .5 .2] \"float g\" -.3"),
                      smoke =
                          medium("smoke", "\"homogeneous\" \"rgb sigma_a\" [.2 .2 .1] \"rgb sigma_s\" [.2 .5 1] \"float g\" .7"),
                      grid = medium("grid", kVoxels + "\"rgb sigma_a\" [.5 .2 .1] \"rgb sigma_s\" [3 2 1] \"float g\" .5"),
                      cloud =
                          medium("cloud",
                                 "\"cloud\" \"spectrum sigma_a\" [360 .1 830 .3] \"spectrum sigma_s\" [360 3 830 2] \"point3 p0\" "
                                 "[-.4 -.5 -.5] \"point3 p1\" [.6 .5 .3] \"float g\" .2"),
                      glow = medium(
                          "glow",
                          "\"homogeneous\" \"rgb sigma_a\" [.3 .2 .1] \"spectrum sigma_s\" [360 0 830 0] \"float Lescale\" .4 "
                          "\"blackbody Le\" 3000");
    for (const std::string& media : {haze + smoke + sum("m", "haze", "smoke"), haze + grid + sum("m", "haze", "grid"),
                                     grid + cloud + glow + sum("dim", "grid", "cloud") + sum("m", "dim", "glow")}) {
        SCOPED_TRACE(media);
        expect_path_and_bdpt_agree(scene_from(ball(media)), 4096, 3072);
    }
}

TEST(SumMedium, RefusesASumOfItselfOrOfTooMany) {
    const auto refusal_of = [](const std::string& media) {
        const auto refused = load(ball(media));
        EXPECT_FALSE(refused);
        return refused ? "" : refused.error().message;
    };
    const std::string a = medium("a", "\"homogeneous\"");
    EXPECT_NE(refusal_of(a + sum("m", "a", "m")).find("is a sum of itself"), std::string::npos);
    EXPECT_NE(refusal_of(a + sum("b", "a", "a") + sum("c", "b", "b") + sum("m", "c", "c")).find("more than 7 media"),
              std::string::npos);
    EXPECT_NE(refusal_of(medium("m", "\"latent:sum\" \"string latent:media\" [\"a\"]")).find("the names of two media"),
              std::string::npos);
    EXPECT_NE(refusal_of(a + sum("m", "a", "nowhere")).find("nowhere"), std::string::npos);
}

}  // namespace
}  // namespace latent::render::testing
