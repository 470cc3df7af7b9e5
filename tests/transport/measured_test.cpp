// Measured surfaces: the warp that their directions are drawn by, files, and tables of a known metal that reflect as it does.
#include "render/bsdf/measured.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "render/bsdf/conductor.h"
#include "render/load/brdf/measured.h"
#include "render/sampling/warp.h"
#include "render/scene/content_hash.h"
#include "tests/transport/chi_square.h"
#include "tests/transport/measured_examples.h"
#include "tests/transport/numbers.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {
namespace {

using ::testing::HasSubstr;

// Two bumpy densities with cells and a row of zeros.
BilinearWarp bumps() {
    Numbers u(1);
    std::vector<float> values(2 * 9 * 7);
    for (float& x : values) x = std::max(0.0f, u() - 0.1f);
    for (std::size_t x = 0; x < 9; ++x) values[9 * 3 + x] = 0;
    return BilinearWarp(values, 9, 7);
}
TableMixture mixture(float share) { return {.table = {0, 1, 0, 0}, .share = {1 - share, share, 0, 0}}; }

TEST(BilinearWarp, InvertsWhatItDraws) {
    const BilinearWarp warp = bumps();
    Numbers u(2);
    for (int n = 0; n < 5000; ++n) {
        const float a = u(), b = u();
        const Vec2f back = warp.invert(mixture(0.6f), warp.sample(mixture(0.6f), a, b));
        ASSERT_NEAR(back.x, a, 2e-5f);
        ASSERT_NEAR(back.y, b, 2e-5f);
    }
}

// Chi-square at 1e-4 of cells smaller than those of the lattice.
TEST(BilinearWarp, PlacesFollowTheirDensity) {
    const BilinearWarp warp = bumps();
    constexpr int kX = 12, kY = 9, kCount = 200'000, kFine = 40;
    const auto cell = [](float x, int cells) { return std::min(static_cast<int>(x * static_cast<float>(cells)), cells - 1); };
    for (const float share : {0.0f, 0.3f, 1.0f}) {
        std::vector<double> expected(kX * kY, 0.0), counted(kX * kY, 0.0);
        for (int y = 0; y < kY * kFine; ++y) {
            for (int x = 0; x < kX * kFine; ++x) {
                const Vec2f at{(static_cast<float>(x) + 0.5f) / (kX * kFine), (static_cast<float>(y) + 0.5f) / (kY * kFine)};
                expected[static_cast<std::size_t>(y / kFine * kX + x / kFine)] +=
                    static_cast<double>(warp.density(mixture(share), at)) * kCount / (kX * kY * kFine * kFine);
            }
        }
        Numbers u(3);
        for (int n = 0; n < kCount; ++n) {
            const float a = u(), b = u();
            const Vec2f at = warp.sample(mixture(share), a, b);
            ++counted[static_cast<std::size_t>(cell(at.y, kY) * kX + cell(at.x, kX))];
        }
        expect_counts_follow(counted, expected);
    }
}

TEST(BilinearWarp, ATableOfZerosIsUniform) {
    const std::vector<float> zeros(6, 0.0f);
    const BilinearWarp warp(zeros, 3, 2);
    EXPECT_FLOAT_EQ(warp.density({}, {0.3f, 0.9f}), 1);
    const Vec2f at = warp.sample({}, 0.3f, 0.9f);
    EXPECT_FLOAT_EQ(at.x, 0.3f);
    EXPECT_FLOAT_EQ(at.y, 0.9f);
}

Wavelengths wavelengths_of(std::initializer_list<float> nm) {
    Wavelengths w;
    w.k = static_cast<std::uint32_t>(nm.size());
    std::fill_n(w.lambda_nm, kMaxWavelengths, *(nm.end() - 1));
    std::ranges::copy(nm, w.lambda_nm);
    return w;
}
MeasuredTables tables_of(const MeasuredMetal& metal) {
    return MeasuredTables(std::make_shared<const MeasuredBrdf>(measured(metal)));
}

// What is reflected of light from one direction, and its mean direction.
struct Reflected {
    double whole = 0, x = 0, y = 0, z = 0;
};
template <class C>
Reflected reflected(const C& closure, const Vec3f& wo) {
    Reflected sum;
    Numbers u(5);
    constexpr int kCount = 20'000;
    for (int n = 0; n < kCount; ++n) {
        ClosureSample s;
        SampledSpectrum value(1.0f), unused(1.0f);
        const float lobe = u(), a = u(), b = u();
        if (!closure.sample(wo, lobe, a, b, s, unused)) continue;
        closure.multiply_f_cos(wo, s.wi, value);
        const double weight = static_cast<double>(value[0] / closure.pdf_omega(wo, s.wi)) / kCount;
        sum.whole += weight;
        sum.x += weight * static_cast<double>(s.wi.x);
        sum.y += weight * static_cast<double>(s.wi.y);
        sum.z += weight * static_cast<double>(s.wi.z);
    }
    return sum;
}

// Directions between those of the lattice, on both sides.
const std::vector<Vec3f> kOutgoing = {
    {0, 0, 1}, normalize(Vec3f{0.5f, 0.2f, 0.8f}), normalize(Vec3f{-0.6f, 0.5f, -0.7f}), normalize(Vec3f{0.1f, -0.9f, 0.4f})};

// Tables of 48 x 48 values for ten angles (and 24 azimuths) reflect as the metal does: within 2 % of the light, also by its mean
// direction; f itself within 3 % of its root mean square, and back and forth within 4 %.
TEST(Measured, TablesOfAMetalReflectAsItDoes) {
    const Wavelengths wavelengths = wavelengths_of({595});
    const SampledSpectrum eta(0.3f), k(3.0f);
    for (const MeasuredMetal& metal : {MeasuredMetal{}, MeasuredMetal{.alpha_x = 0.3f, .alpha_y = 0.6f, .turns = 25}}) {
        const MeasuredTables tables = tables_of(metal);
        const Measured measured(tables, wavelengths);
        const Conductor conductor(eta, k, metal.alpha_x, metal.alpha_y);
        for (const Vec3f& wo : kOutgoing) {
            SCOPED_TRACE(::testing::Message() << metal.alpha_x << ": " << wo.x << " " << wo.y << " " << wo.z);
            const Reflected a = reflected(measured, wo), b = reflected(conductor, wo);
            EXPECT_NEAR(a.whole, b.whole, 0.02 * b.whole);
            EXPECT_NEAR(a.x, b.x, 0.02 * b.whole);
            EXPECT_NEAR(a.y, b.y, 0.02 * b.whole);
            EXPECT_NEAR(a.z, b.z, 0.02 * b.whole);
            Numbers u(7);
            double squares = 0, errors = 0, differences = 0;
            for (int n = 0; n < 5000; ++n) {
                const float x = u(), y = u();
                Vec3f wi = sample_cosine_hemisphere(x, y);
                if (std::abs(wi.z) < 0.1f) continue;
                if (wo.z < 0) wi.z = -wi.z;
                SampledSpectrum there(1.0f), back(1.0f), exact(1.0f);
                measured.multiply_f_cos(wo, wi, there);
                measured.multiply_f_cos(wi, wo, back);
                conductor.multiply_f_cos(wo, wi, exact);
                const double f = static_cast<double>(exact[0] / std::abs(wi.z)),
                             forth = static_cast<double>(there[0] / std::abs(wi.z)),
                             home = static_cast<double>(back[0] / std::abs(wo.z));
                squares += f * f;
                errors += (forth - f) * (forth - f);
                differences += (forth - home) * (forth - home);
            }
            EXPECT_LT(std::sqrt(errors / squares), 0.03);
            EXPECT_LT(std::sqrt(differences / squares), 0.04);
        }
    }
}

TEST(Measured, SpectraAreLinearBetweenWavelengthsAndConstantBeyond) {
    const MeasuredTables tables = tables_of({.tilt = 0.5f});
    const auto f_of = [&](std::initializer_list<float> nm) {
        SampledSpectrum f(1.0f);
        Measured(tables, wavelengths_of(nm))
            .multiply_f_cos(normalize(Vec3f{0.3f, 0.1f, 0.9f}), normalize(Vec3f{-0.2f, 0.1f, 0.9f}), f);
        return f;
    };
    const SampledSpectrum f = f_of({300, 360, 477.5f, 595, 830});
    const float middle = f[3];
    ASSERT_GT(middle, 0);
    EXPECT_FLOAT_EQ(f[0], 0.5f * middle);
    EXPECT_FLOAT_EQ(f[1], 0.5f * middle);
    EXPECT_FLOAT_EQ(f[2], 0.75f * middle);
    for (std::uint32_t i = 4; i < kMaxWavelengths; ++i) EXPECT_FLOAT_EQ(f[i], 1.5f * middle);
    EXPECT_FLOAT_EQ(f_of({900})[0], 1.5f * middle);
}

constexpr MeasuredMetal kSmall{.side = 9, .directions = 3, .turns = 4};

TEST(MeasuredFile, IsReadAsItWasWritten) {
    MeasuredBrdf brdf = measured(kSmall);
    brdf.spectra.values[7] = -1e-3f;  // noise
    const Bytes file = MeasuredFile(brdf).bytes();
    const auto read = read_measured_brdf(file);
    ASSERT_TRUE(read.has_value()) << read.error().message;
    EXPECT_EQ((*read)->content, hash128(file));
    EXPECT_EQ((*read)->phi, brdf.phi);
    EXPECT_EQ((*read)->theta, brdf.theta);
    EXPECT_EQ((*read)->lambda_nm, brdf.lambda_nm);
    brdf.spectra.values[7] = 0;
    for (const auto table :
         {&MeasuredBrdf::ndf, &MeasuredBrdf::sigma, &MeasuredBrdf::vndf, &MeasuredBrdf::luminance, &MeasuredBrdf::spectra}) {
        EXPECT_EQ((**read.*table).width, (brdf.*table).width);
        EXPECT_EQ((**read.*table).height, (brdf.*table).height);
        EXPECT_EQ((**read.*table).values, (brdf.*table).values);
    }
}

std::string refusal(const Bytes& file) {
    const auto read = read_measured_brdf(file);
    return read ? "" : read.error().message;
}

TEST(MeasuredFile, CutAnywhereIsRefused) {
    const Bytes file = MeasuredFile(measured({.side = 3, .directions = 2})).bytes();
    for (std::size_t size = 0; size < file.size(); ++size)
        ASSERT_NE(refusal(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size))), "") << size;
}

TEST(MeasuredFile, WhatNoMeasurementHasIsRefused) {
    const auto refusal_with = [](auto&& change) {
        MeasuredFile file(measured(kSmall));
        change(file);
        return refusal(file.bytes());
    };
    using F = MeasuredFile;
    const Bytes one{std::byte{1}};
    EXPECT_THAT(refusal(Bytes(40)), HasSubstr("not a .bsdf file"));
    for (const char* name : {"phi_i", "theta_i", "wavelengths", "ndf", "sigma", "vndf", "luminance", "spectra", "jacobian"}) {
        EXPECT_THAT(refusal_with([&](F& f) { f.remove(name); }), HasSubstr(std::string("no field ") + name));
        EXPECT_THAT(refusal_with([&](F& f) { f.add(name, {1, 1, 1, 1, 1, 1}, one); }), HasSubstr(std::string(name) + ": not "));
    }
    EXPECT_EQ(refusal_with([](F& f) { f.remove("description"); }), "");
    EXPECT_THAT(refusal_with([&](F& f) { f.add("a", {1}, one, 0); }), HasSubstr("unknown type 0"));
    EXPECT_THAT(refusal_with([&](F& f) { f.add("a", {1}, one, 12); }), HasSubstr("unknown type 12"));
    EXPECT_THAT(refusal_with([&](F& f) { f.add("jacobian", {1}, Bytes(1)); }), HasSubstr("jacobian: is not 1"));
    // Sizes that overflow, or are far beyond the file.
    constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max();
    for (const std::vector<std::uint64_t>& shape :
         {std::vector<std::uint64_t>{kHuge}, {kHuge, kHuge}, {std::uint64_t{1} << 32, std::uint64_t{1} << 32}, {1 << 30}})
        EXPECT_THAT(refusal_with([&](F& f) { f.add("a", shape, one); }), HasSubstr("outside of the file"));
    EXPECT_EQ(refusal_with([](F& f) { f.add("a", {0, kHuge}, Bytes()); }), "");
    // Tables.
    const auto values = [](std::size_t n, float x) { return std::vector<float>(n, x); };
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    EXPECT_THAT(refusal_with([&](F& f) { f.add("ndf", {1, 4}, values(4, 1)); }), HasSubstr("ndf: tables of 4 x 1"));
    EXPECT_THAT(refusal_with([&](F& f) { f.add("ndf", {0, 4}, values(0, 1)); }), HasSubstr("ndf: tables of 4 x 0"));
    for (const float x : {nan, inf})
        EXPECT_THAT(refusal_with([&](F& f) { f.add("sigma", {2, 2}, values(4, x)); }), HasSubstr("sigma: values"));
    EXPECT_THAT(refusal_with([&](F& f) { f.add("vndf", {4, 2, 2, 2}, values(32, 1)); }), HasSubstr("vndf: not a table for each"));
    EXPECT_THAT(refusal_with([&](F& f) { f.add("spectra", {4, 3, 2, 2, 2}, values(96, 1)); }), HasSubstr("spectra: not a table"));
    // Axes.
    for (const char* name : {"phi_i", "theta_i", "wavelengths"}) {
        EXPECT_THAT(refusal_with([&](F& f) { f.add(name, {3}, values(3, 1)); }), HasSubstr("not ascending"));
        EXPECT_THAT(refusal_with([&](F& f) { f.add(name, {1}, values(1, nan)); }), HasSubstr("not finite"));
        EXPECT_THAT(refusal_with([&](F& f) { f.add(name, {0}, values(0, 1)); }), HasSubstr("is empty"));
    }
    EXPECT_THAT(refusal_with([&](F& f) { f.add("theta_i", {3}, {0, 45, 90}); }), HasSubstr("theta_i: not within 0 to"));
    EXPECT_THAT(refusal_with([&](F& f) { f.add("wavelengths", {2}, {0.4f, 0.7f}); }), HasSubstr("wavelengths: not within 100"));
    EXPECT_THAT(refusal_with([&](F& f) { f.add("phi_i", {4}, {0, 1, 2, 3.1f}); }), HasSubstr("does not go all around"));
}

// Errors of the file come with the place in the scene, and the job id depends on the file's bytes alone.
TEST(MeasuredFile, BelongsToItsScene) {
    const Folder folder;
    const auto write = [&](const char* name, const Bytes& bytes) {
        folder.write(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    };
    MeasuredBrdf brdf = measured(kSmall);
    write("a.bsdf", MeasuredFile(brdf).bytes());
    write("b.bsdf", MeasuredFile(brdf).bytes());
    brdf.spectra.values[3] += 1;
    write("c.bsdf", MeasuredFile(brdf).bytes());
    write("d.bsdf", Bytes(3));
    const auto load_with = [&](const std::string& parameters) {
        return load_scene(folder.write(
            "scene.pbrt", "WorldBegin\nLightSource \"infinite\"\nMaterial \"measured\" " + parameters + "\nShape \"sphere\"\n"));
    };
    const auto hash_of = [&](const std::string& file) {
        return content_hash(load_with("\"string filename\" \"" + file + "\"")->description);
    };
    EXPECT_EQ(hash_of("a.bsdf"), hash_of("b.bsdf"));
    EXPECT_NE(hash_of("a.bsdf"), hash_of("c.bsdf"));
    const auto error_of = [&](const std::string& parameters) {
        const auto scene = load_with(parameters);
        return scene ? "" : scene.error().message;
    };
    EXPECT_THAT(error_of("\"string filename\" \"d.bsdf\""), HasSubstr("scene.pbrt:3:1: d.bsdf: not a .bsdf file"));
    EXPECT_THAT(error_of("\"string filename\" \"e.bsdf\""), HasSubstr("e.bsdf"));
    EXPECT_THAT(error_of(""), HasSubstr("filename: is required"));
}

}  // namespace
}  // namespace latent::render::testing
