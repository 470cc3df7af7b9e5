#include "tools/develop/channels/channels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/develop/developed.h"

namespace latent::develop {
namespace {

using sampledb::Coverage;
using sampledb::Job;
using sampledb::RecordKind;
using sampledb::WavelengthDensity;

constexpr const char* kObservers[] = {"cie1931", "cie1964", "cie2015-2", "cie2015-10"};

// Knots at every nm, and two narrow lines of much density, as lamps with line spectra have.
WavelengthDensity density_with_lines() {
    std::vector<WavelengthDensity::Knot> knots;
    std::vector<double> lambda, weight;
    for (int nm = 360; nm < 830; ++nm) {
        lambda.push_back(nm);
        weight.push_back(1);
        for (const double line : {546.074, 589.29}) {
            if (nm != static_cast<int>(line)) continue;
            lambda.push_back(line - 0.05);
            weight.push_back(2000);
            lambda.push_back(line + 0.05);
            weight.push_back(1);
        }
    }
    lambda.push_back(830);
    double total = 0;
    for (std::size_t i = 0; i < weight.size(); ++i) total += weight[i] * (lambda[i + 1] - lambda[i]);
    double q = 0;
    for (std::size_t i = 0; i < lambda.size(); ++i) {
        knots.push_back({static_cast<std::uint32_t>(std::llround(lambda[i] * 0x1p20)),
                         static_cast<std::uint64_t>(std::llround(q / total * 0x1p48))});
        if (i < weight.size()) q += weight[i] * (lambda[i + 1] - lambda[i]);
    }
    knots.back().cumulative = std::uint64_t{1} << 48;
    return *WavelengthDensity::from_knots(knots);
}

TEST(BatchResponse, IsTheSumOverTheBatchForEveryObserverAndAnyOffset) {
    std::mt19937 random(5);
    for (const WavelengthDensity& density : {synthetic::make_job(RecordKind::kSpectral).density, density_with_lines()}) {
        for (const char* name : kObservers) {
            SCOPED_TRACE(name);
            const color::Observer observer = *color::Observer::by_name(name);
            for (const int k : {1, 6, 28, 31}) {
                SCOPED_TRACE(k);
                const BatchResponse response(density, k, observer);
                std::vector<float> power(k), lambda(k);
                for (int round = 0; round < 500; ++round) {
                    const std::uint32_t xi = round == 0 ? 0 : round == 1 ? 0xFFFFFFFF : static_cast<std::uint32_t>(random());
                    density.batch(xi, lambda);
                    double expected[3] = {}, scale = 0;
                    for (int i = 0; i < k; ++i) {
                        power[i] = std::ldexp(static_cast<float>(random()), -32) - 0.1f;
                        for (int c = 0; c < 3; ++c)
                            expected[c] += static_cast<double>(power[i]) * static_cast<double>(observer(lambda[i])[c]);
                        scale += std::abs(static_cast<double>(power[i]));
                    }
                    float got[3];
                    response.xyz(xi, power.data(), got);
                    // wavelengths are rounded to 3e-5 nm before they are looked up, where curves rise by up to 0.07 per nm
                    for (int c = 0; c < 3; ++c) ASSERT_NEAR(got[c], expected[c], 2.5e-6 * scale) << xi << ' ' << c;
                }
            }
        }
    }
}

Developed develop_spectral(const Job& job, std::uint64_t samples, Settings settings, const color::Observer& observer) {
    synthetic::Scene scene;
    scene.look = synthetic::Scene::Look::kUniform;  // L = 1
    scene.black = 0;
    scene.light_per_sample = 0;
    MemoryRunSet run_set(job);
    run_set.add(Coverage({0, samples}), synthetic::make_records(job, {0, samples}, scene));
    return develop_in_memory(run_set, settings, 2, &observer);
}

TEST(Spectra, EqualEnergyDevelopsToTheIntegralsOfTheCurvesForDerivedAndExplicitWavelengths) {
    for (const bool derived : {true, false}) {
        SCOPED_TRACE(derived);
        Job job = synthetic::make_job(RecordKind::kSpectral);
        if (!derived) job.density = {};
        for (const char* name : kObservers) {
            SCOPED_TRACE(name);
            const color::Observer observer = *color::Observer::by_name(name);
            double integral[3] = {};
            for (int i = 0; i < 4700; ++i) {
                for (int c = 0; c < 3; ++c)
                    integral[c] += 0.1 * static_cast<double>(observer(360.05f + 0.1f * static_cast<float>(i))[c]);
            }
            const Developed got = develop_spectral(job, 4096, settings_for(3, 2), observer);
            for (int c = 0; c < 3; ++c) {
                double mean = 0;
                for (int pixel = 0; pixel < 6; ++pixel) mean += static_cast<double>(got.picture.at(pixel % 3, pixel / 3, c)) / 6;
                // 4096 batches of 28 stratified wavelengths: an error far below one batch's few percent
                EXPECT_NEAR(mean / integral[c], 1, 2e-3) << c;
            }
        }
    }
}

// By hand: 3 + 1.5 of light between 500 and 510 nm is 0.45 per nm, and 0.45 / 683 W m^-2 sr^-1 nm^-1 = 6.58858e-4 if Y = 1 is 1
// cd/m^2: then the luminance of 1 per nm, 683 lm/W times the integral of ybar / 683, is that integral, 106.9 cd/m^2, which is its
// Y.
TEST(Spectra, BinsAreInWattsWhateverYEquals1Means) {
    for (const auto& [unit, green, red] : {std::tuple{1.0, 6.58858e-4, 1.37628e-4}, {683.0, 0.45, 0.094}, {2049.0, 1.35, 0.282}}) {
        Job job = synthetic::make_job(RecordKind::kSpectral);
        job.density = {};
        job.positions = {};
        job.light_unit_cd_m2 = unit;
        sampledb::Records record;
        record.sample = {0};
        record.record_class = {sampledb::RecordClass::kCamera};
        record.u = {0x80000000u};
        record.v = {0xC0000000u};  // the centre of pixel 1, 1 of 3 x 2
        record.share = {1};
        record.pairs = {3};
        record.power = {3, 1.5f, 0.94f};
        record.lambda_nm = {500.5f, 509.5f, 700.5f};
        MemoryRunSet run_set(job);
        run_set.add(Coverage({0, 1}), record);
        const auto channels = Channels::spectral_bins(job, {.count = 47});
        ASSERT_TRUE(channels);
        const Settings settings = settings_for(3, 2, "box");
        MemoryPicture picture(settings.crop, 47);
        ASSERT_TRUE(develop(run_set, *channels, settings, picture));
        EXPECT_NEAR(picture.at(1, 1, 14) / green, 1, 1e-5);
        EXPECT_NEAR(picture.at(1, 1, 34) / red, 1, 1e-5);
        for (int bin = 0; bin < 47; ++bin) EXPECT_EQ(picture.at(1, 1, bin) > 0, bin == 14 || bin == 34) << bin;
    }
}

TEST(Spectra, BinsHoldTheMeanRadianceOfTheirWavelengths) {
    Job job = synthetic::make_job(RecordKind::kSpectral);
    job.light_unit_cd_m2 = 683;
    synthetic::Scene scene;
    scene.look = synthetic::Scene::Look::kUniform;
    scene.black = 0;
    scene.light_per_sample = 0;
    MemoryRunSet run_set(job);
    run_set.add(Coverage({0, 16384}), synthetic::make_records(job, {0, 16384}, scene));
    for (const int bins : {1, 5, 16}) {
        SCOPED_TRACE(bins);
        const auto channels = Channels::spectral_bins(job, {.count = bins});
        ASSERT_TRUE(channels);
        Settings settings = settings_for(3, 2);
        MemoryPicture picture(settings.crop, bins);
        Threads(2).run([&] { ASSERT_TRUE(develop(run_set, *channels, settings, picture)); });
        for (int bin = 0; bin < bins; ++bin) EXPECT_NEAR(picture.at(1, 1, bin), 1, 0.05) << bin;
    }
    EXPECT_EQ(Channels::spectral_bins(synthetic::make_job(RecordKind::kXyz), {.count = 8}).error().code, ErrorCode::kUsage);
}

TEST(Spectra, RecordsThatKeepOneWavelengthCountLikeTheirBatch) {
    // Each wavelength of a batch as a record of its own, multiplied by nothing: P_i already counts for one of k.
    Job job = synthetic::make_job(RecordKind::kSpectral);
    synthetic::Scene scene;
    scene.light_per_sample = 0.2;
    const sampledb::Records whole = synthetic::make_records(job, {0, 1024}, scene);
    sampledb::Records alone;
    std::size_t first = 0;
    for (std::size_t i = 0; i < whole.size(); first += whole.pairs[i++]) {
        const bool batch = whole.pairs[i] == job.batch;
        for (std::size_t p = 0; p < (batch ? whole.pairs[i] : 1u); ++p) {
            alone.sample.push_back(whole.sample[i]);
            alone.record_class.push_back(whole.record_class[i]);
            alone.u.push_back(whole.u[i]);
            alone.v.push_back(whole.v[i]);
            alone.share.push_back(p == 0 ? whole.share[i] : 0.0f);
            alone.xi.push_back(whole.xi[i]);
            alone.pairs.push_back(whole.pairs[i] == 0 ? 0 : 1);
            alone.index.push_back(batch ? static_cast<std::uint16_t>(p) : whole.index[i]);
            if (whole.pairs[i] > 0) alone.power.push_back(whole.power[first + p]);
        }
    }
    MemoryRunSet a(job), b(job);
    a.add(Coverage({0, 1024}), whole);
    b.add(Coverage({0, 1024}), alone);
    const Settings settings = settings_for(9, 6);
    const Developed from_batches = develop_in_memory(a, settings, 2, &color::Observer::cie1931());
    const Developed from_singles = develop_in_memory(b, settings, 2, &color::Observer::cie1931());
    for (std::size_t i = 0; i < from_batches.picture.pixels().size(); ++i) {
        const float value = from_batches.picture.pixels()[i];
        ASSERT_NEAR(from_singles.picture.pixels()[i], value, 1e-5f * std::abs(value));
    }
}

}  // namespace
}  // namespace latent::develop
