// Laws of hair: energy, densities, both kinds of subpath, and fibres as rays hit them.
#include <cmath>
#include <numbers>

#include "base/bytes.h"
#include "color/named_spectra.h"
#include "color/observer.h"
#include "color/rgb_space.h"
#include "tests/transport/blocks.h"
#include "tests/transport/chi_square.h"
#include "tests/transport/closure_examples.h"
#include "tests/transport/lit_floor.h"
#include "tests/transport/numbers.h"

namespace latent::render::testing {
namespace {

struct HairCase {
    std::string name;
    Hair::State state;
};

std::vector<HairCase> hairs() {
    const Values& v = values();
    std::vector<HairCase> list;
    const auto add = [&](const std::string& name, const Fibre& fibre) {
        list.push_back({name, {fibre, false, 0}});
        list.push_back({name + ", ribbon", {fibre, true, -0.6f}});
    };
    add("clear", {.sigma_a = &v.black});
    add("clear, smooth, tilted", {.sigma_a = &v.black, .beta_m = 0.15f, .beta_n = 0.2f, .tilt_turns = 4.0f / 360});
    add("rough", {.sigma_a = &v.rising, .beta_m = 0.9f, .beta_n = 0.9f, .tilt_turns = 0});
    add("dark", {.sigma_a = &v.eta, .eta = 1.4f, .beta_m = 0.3f, .beta_n = 0.6f});
    return list;
}

// In the plane of the normal and the fibre, across, nearly along, and (seen through facets) a little from behind.
const std::vector<Vec3f> kViews = {normalize(Vec3f{0.3f, 0.05f, 0.9f}), normalize(Vec3f{-0.2f, 0.8f, 0.3f}),
                                   normalize(Vec3f{0.9f, -0.3f, 0.2f}), normalize(Vec3f{0.1f, -0.95f, 0.02f})};

Bsdf hair_of(const Hair::State& state) { return Bsdf(Frame{}, {0, 0, 1}, Hair(state)); }

TEST(Hair, DirectionsFollowTheirDensity) {
    for (const HairCase& c : hairs()) {
        const Bsdf bsdf = hair_of(c.state);
        for (std::size_t d = 0; d < kViews.size(); ++d) {
            SCOPED_TRACE(c.name + ", direction " + std::to_string(d));
            Numbers u(static_cast<std::uint32_t>(d + 1));
            expect_directions_follow(
                {.sample = [&](std::uint32_t) -> std::optional<Vec3f> {
                     BsdfSample s;
                     SampledSpectrum beta(1.0f);
                     const float lobe = u(), x = u(), y = u();
                     if (!bsdf.sample(kViews[d], true, lobe, x, y, s, beta)) return std::nullopt;
                     return s.wi;
                 },
                 .pdf_omega = [&](const Vec3f& wi) { return static_cast<double>(bsdf.pdf_omega(kViews[d], wi, true)); },
                 .count = 60'000,
                 .fine = 24});
        }
    }
}

// A clear fibre gives back what it gets, one that absorbs less, by 4 standard errors.
TEST(Hair, InAWhiteFurnaceClearFibresVanish) {
    for (const HairCase& c : hairs()) {
        const bool clear = c.state.fibre.sigma_a->max() == 0;
        for (const Vec3f& wo : kViews) {
            SCOPED_TRACE(c.name);
            Numbers u(3);
            constexpr int kCount = 20'000;
            double sum = 0, squares = 0;
            for (int n = 0; n < kCount; ++n) {
                BsdfSample s;
                SampledSpectrum beta(1.0f);
                const float lobe = u(), x = u(), y = u();
                if (!hair_of(c.state).sample(wo, true, lobe, x, y, s, beta)) continue;
                sum += static_cast<double>(beta[31]);
                squares += static_cast<double>(beta[31]) * static_cast<double>(beta[31]);
            }
            const double mean = sum / kCount, error = std::sqrt(std::max(0.0, squares / kCount - mean * mean) / kCount);
            if (clear) {
                EXPECT_NEAR(mean, 1, 4 * error + 2e-3);  // densities to 24 bits of narrow lobes
            } else {
                EXPECT_LT(mean, 1 - 4 * error);
            }
        }
    }
}

TEST(Hair, WeightsAreWhatEvaluationSaysForBothKindsOfSubpath) {
    int met = 0;
    for (const HairCase& c : hairs()) {
        SCOPED_TRACE(c.name);
        const Bsdf bsdf = hair_of(c.state);
        Numbers u(7);
        for (int n = 0; n < 2000; ++n) {
            const Vec3f wo = kViews[static_cast<std::size_t>(n) % kViews.size()];
            const bool from_camera = n % 2 == 0;
            BsdfSample s;
            SampledSpectrum beta(1.0f), f(1.0f);
            const float lobe = u(), x = u(), y = u();
            if (!bsdf.sample(wo, from_camera, lobe, x, y, s, beta)) continue;
            ++met;
            ASSERT_FLOAT_EQ(s.pdf, bsdf.pdf_omega(wo, s.wi, true));
            ASSERT_FLOAT_EQ(bsdf.pdf_reverse(wo, s, true), bsdf.pdf_omega(s.wi, wo, true));
            bsdf.multiply_f_cos(from_camera ? wo : s.wi, from_camera ? s.wi : wo, f);
            const float side = from_camera ? 1 : std::abs(s.wi.z / wo.z);
            for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) ASSERT_NEAR(beta[i], f[i] * side / s.pdf, 2e-5f * beta[i] + 1e-7f);
        }
    }
    EXPECT_GT(met, 10'000);
}

// What a smooth, black fibre without scales sends on is mirrored at its normal, wherever it is seen: so h has the right sign.
TEST(Hair, TheSurfaceOfABlackFibreIsAMirror) {
    const SampledSpectrum absorbs(50.0f);
    const Fibre black{.sigma_a = &absorbs, .beta_m = 0.05f, .beta_n = 0.05f, .tilt_turns = 0};
    const Hair::State round(black, false, 0);
    for (const Vec3f& wo : kViews) {
        const Vec3f mirrored{-wo.x, -wo.y, wo.z};
        EXPECT_GT(hair_of(round).pdf_omega(wo, mirrored, true), 5);
        SampledSpectrum there(1.0f), beside(1.0f);
        hair_of(round).multiply_f_cos(wo, mirrored, there);
        hair_of(round).multiply_f_cos(wo, normalize(mirrored + normalize(Vec3f{0, -mirrored.z, mirrored.y}) * 0.3f), beside);
        EXPECT_LT(beside[3], 0.2f * there[3]);
    }
    // A ribbon that is seen at y = 0.6 has the normal of a round fibre there.
    const Hair::State ribbon(black, true, 0.6f);
    const Vec3f n{0, 0.6f, 0.8f}, wo{0, 0, 1}, mirrored = n * (2 * dot(n, wo)) - wo;
    EXPECT_GT(hair_of(ribbon).pdf_omega(wo, mirrored, true), 5);
    const Vec3f behind{0, 0, -1}, far_normal{0, 0.6f, -0.8f};
    EXPECT_GT(hair_of(ribbon).pdf_omega(behind, far_normal * (2 * dot(far_normal, behind)) - behind, true), 5);
}

TEST(Hair, ARoundFibreIsSeenAndMetFromOutsideAlone) {
    const std::vector<HairCase> list = hairs();
    const Bsdf bsdf = hair_of(list[0].state);
    const Vec3f outside = kViews[0], inside = normalize(Vec3f{0.2f, 0.4f, -0.8f});
    SampledSpectrum through(1.0f), back(1.0f);
    bsdf.multiply_f_cos(outside, inside, through);
    bsdf.multiply_f_cos(inside, outside, back);
    EXPECT_GT(through[0], 0);
    EXPECT_EQ(back[0], 0);
    EXPECT_GT(bsdf.pdf_omega(outside, inside, true), 0);
    EXPECT_EQ(bsdf.pdf_omega(inside, outside, true), 0);
}

std::string tuft(const std::string& type, const std::string& material) {
    std::string text =
        "LookAt 0 -4 .8  0 0 .5  0 0 1\nCamera \"perspective\" \"float fov\" 20\nIntegrator \"path\" \"integer maxdepth\" 6\n"
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nWorldBegin\n"
        "LightSource \"infinite\" \"spectrum L\" [360 1 830 1] \"float scale\" .3\n"
        "AttributeBegin Translate 1.5 -1.5 2 AreaLightSource \"diffuse\" \"spectrum L\" [360 1 830 1] \"float scale\" 10\n"
        "Shape \"sphere\" \"float radius\" .4 AttributeEnd\n"
        "AttributeBegin Translate -.4 2 1 AreaLightSource \"diffuse\" \"spectrum L\" [360 1 830 1] \"float scale\" 6\n"
        "Shape \"sphere\" \"float radius\" .3 AttributeEnd\n"
        "Material \"diffuse\" \"spectrum reflectance\" [360 .4 830 .4]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-3 -3 0  3 -3 0  -3 3 0  3 3 0]\nMaterial \"hair\" " +
        material + "\n";
    for (int i = 0; i < 12; ++i) {
        const double x = -0.55 + 0.1 * i, lean = 0.03 * (i - 5.5);
        text += fmt::format(
            "Shape \"curve\" \"string type\" \"{0}\" \"point3 P\" [{1} 0 0  {1} 0 .4  {2} 0 .7  {3} 0 1] \"float width\" .06{4}\n",
            type, x, x + lean, x + 2 * lean, type == "ribbon" ? " \"normal N\" [0 -1 0  0 -1 0]" : "");
    }
    return text;
}

Estimate render_tuft(const std::string& text, const IntegratorSettings& base, std::uint64_t samples) {
    const Scene scene = scene_from(text);
    std::vector<Blocks> pictures;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        IntegratorSettings settings = base;
        settings.record = sampledb::RecordKind::kXyz;
        settings.seed = seed;
        const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
        BlockSums sums(8);
        sampledb::Records records;
        RadianceFaults faults;
        for (std::uint64_t n = 0; n < samples; ++n) integrator->trace(n, records, faults);
        EXPECT_EQ(faults.total(), 0u);
        sums.add(records);
        pictures.push_back(sums.picture(samples));
    }
    return mean_of(pictures);
}

// Twelve pictures each: the z of 64 blocks follow Student's t of about 22 degrees, whose mean square is 1.1 with a spread of 0.22.
TEST(Hair, PathAndBdptAgree) {
    for (const char* type : {"cylinder", "ribbon"}) {
        const std::string text = tuft(type, "\"float eumelanin\" .2 \"float beta_m\" .25 \"float beta_n\" .3");
        const Estimate path = render_tuft(text, {.kind = IntegratorKind::kPath}, 12'000);
        for (const Connections connections : {Connections::kOne, Connections::kAll}) {
            const Estimate bdpt = render_tuft(text, {.kind = IntegratorKind::kBdpt, .connections = connections}, 8'000);
            const Verdict verdict = compare(bdpt, path, 1);
            EXPECT_LT(std::abs(verdict.whole_z), 3.9) << type;
            EXPECT_LT(verdict.mean_z2, 2.2) << type;
            EXPECT_LT(verdict.whole_error, 0.01) << type;
        }
    }
}

// Fibres with gaps of a tenth of their width send on all that they get: no light is lost between neighbours, or within a tube. The
// radiance of the sky, 1, is seen by each camera ray, after up to a hundred fibres.
TEST(Hair, ADenseTuftOfClearFibresIsInvisibleInAWhiteFurnace) {
    std::string text =
        "LookAt 0 -4 .5  0 0 .5  0 0 1\nCamera \"perspective\" \"float fov\" 11\nIntegrator \"path\"\n"
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nWorldBegin\n"
        "LightSource \"infinite\" \"spectrum L\" [360 1 830 1]\n"
        "Material \"hair\" \"spectrum sigma_a\" [360 0 830 0] \"float beta_m\" .25 \"float beta_n\" .3\n";
    for (int i = 0; i < 72; ++i) {
        const double x = 0.066 * (i % 12 - 5.75 + 0.5 * (i / 12 % 2)), y = 0.0572 * (i / 12);
        text += fmt::format(
            "Shape \"curve\" \"string type\" \"cylinder\" \"point3 P\" [{0} {1} 0 {0} {1} .3 {0} {1} .7 {0} {1} 1] "
            "\"float width\" .06\n",
            x, y);
    }
    const Estimate path = render_tuft(text, {.kind = IntegratorKind::kPath, .max_depth = 100}, 4'000);
    double whole = 0;
    for (std::size_t b = 0; b < path.mean.xyz.size(); ++b) {
        EXPECT_NEAR(path.mean.xyz[b][1], 1, 6 * path.error.xyz[b][1] + 2e-3) << b;
        whole += path.mean.xyz[b][1] / static_cast<double>(path.mean.xyz.size());
    }
    EXPECT_NEAR(whole, 1, 2e-3);
}

// From afar, a ribbon that faces the camera scatters as the tube that it stands for: where it is seen decides, not its shape. Only
// shadows differ, by as much as a fibre is thick.
TEST(Hair, ARibbonThatFacesTheCameraLooksLikeATube) {
    const std::string material = "\"float eumelanin\" .2 \"float beta_m\" .25 \"float beta_n\" .3";
    const IntegratorSettings direct{.max_depth = 1};
    const Estimate tube = render_tuft(tuft("cylinder", material), direct, 20'000),
                   ribbon = render_tuft(tuft("ribbon", material), direct, 20'000);
    const Verdict verdict = compare(tube, ribbon, 1);
    EXPECT_LT(std::abs(verdict.whole_relative), 0.01);
    EXPECT_LT(verdict.whole_error, 0.004);
}

// Melanin absorbs blue light most; twice the melanin absorbs twice as much. As a reflectance, it would have these colours under D65
// (pbrt-v4, HairBxDF::SigmaAFromConcentration).
TEST(Hair, MelaninSetsTheAbsorption) {
    const auto sigma_a = [](const std::string& material) {
        const Scene scene = scene_from(tuft("cylinder", material));
        for (const MaterialDescription& d : scene.description.materials) {
            if (d.type == "hair") return d.spectra.at("sigma_a").value;
        }
        return color::Spectrum();
    };
    const color::Spectrum& d65 = color::illuminant_d65();
    const double white = color::xyz_from_spectrum(d65, color::Observer::cie1931()).y;
    const std::pair<const char*, std::array<double, 3>> kinds[] = {{"eumelanin", {0.419, 0.697, 1.37}},
                                                                   {"pheomelanin", {0.187, 0.4, 1.05}}};
    for (const auto& [melanin, rgb] : kinds) {
        const color::Spectrum one = sigma_a(fmt::format("\"float {}\" 1", melanin)),
                              two = sigma_a(fmt::format("\"float {}\" 2", melanin));
        EXPECT_GT(one(450), 1.5 * one(650));
        for (const double nm : {400, 500, 600, 700}) EXPECT_NEAR(two(nm) / one(nm), 2, 1e-6);
        const color::Xyz seen = color::xyz_from_spectrum(
            color::Spectrum::from_function([&](double nm) { return one(nm) * d65(nm); }, color::Outside::kZero),
            color::Observer::cie1931());
        const auto found = color::RgbSpace::srgb().rgb_from_xyz * std::array{seen.x / white, seen.y / white, seen.z / white};
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], rgb[c], 2e-3) << melanin << c;
    }
}

// The albedo of the fibres of a tuft, the same wherever it is seen.
float albedo(const std::string& material) {
    const Scene scene = scene_from(tuft("cylinder", material));
    sampledb::Records records;
    RadianceFaults faults;
    const std::unique_ptr<Integrator> integrator =
        scene.integrator({.record = sampledb::RecordKind::kXyz, .seed = 1, .aovs = {.albedo = true, .id = true}});
    for (std::uint64_t n = 0; n < 500; ++n) integrator->trace(n, records, faults);
    float found = 0;
    int hair = 0;
    for (std::size_t row = 0; row < records.size(); ++row) {
        const auto number = load_le<std::uint32_t>(records.extra[4].values.data() + 4 * row);
        if (number == 0 || scene.description.materials[number - 1].type != "hair") continue;
        const auto here = load_le<float>(records.extra[1].values.data() + 4 * row);
        if (hair == 0) found = here;
        EXPECT_NEAR(here, found, 1e-3);
        ++hair;
    }
    EXPECT_GT(hair, 50);
    return found;
}

// exp(-sqrt(sigma_a) s), s = 5.969 - 0.215 b + 2.532 b^2 - 10.73 b^3 + 5.574 b^4 + 0.245 b^5 with b = beta_n [Chiang16 eq. 9].
TEST(Hair, AbsorptionLeavesTheAlbedoOfMuchHair) {
    struct Expected {
        double beta_n, sigma_a, albedo;
    };
    for (const auto& [beta_n, sigma_a, expected] :
         {Expected{0.1, 0.01, 0.5509}, Expected{0.3, 0.04, 0.3080}, Expected{0.7, 0.04, 0.3861}})
        EXPECT_NEAR(albedo(fmt::format("\"spectrum sigma_a\" [360 {0} 830 {0}] \"float beta_n\" {1}", sigma_a, beta_n)), expected,
                    1e-3);
}

// Absorption from a colour is such that the albedo of much hair is that colour.
TEST(Hair, AColourIsTheAlbedo) {
    for (const char* name : {"reflectance", "color"}) {
        for (const double beta_n : {0.1, 0.3, 0.7})
            EXPECT_NEAR(albedo(fmt::format("\"spectrum {}\" [360 .4 830 .4] \"float beta_n\" {}", name, beta_n)), 0.4f, 1e-3);
    }
}

}  // namespace
}  // namespace latent::render::testing
