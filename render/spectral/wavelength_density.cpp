#include "render/spectral/wavelength_density.h"

#include <algorithm>
#include <cmath>

#include "color/light_spectrum.h"
#include "color/visible_density.h"

namespace latent::render {
namespace {

constexpr double kEyeShare = 0.63, kUniformShare = 0.09, kSpikeShare = 0.28;
constexpr double kSpikeThreshold = 4;
constexpr std::uint32_t kNearKnots = 1024;  // in units of 2^-20 nm: nearer ones are joined
constexpr std::size_t kMaxKnots = 4096;     // that a header holds: docs/format.md, "Header"
constexpr double kRange = color::kLambdaMax - color::kLambdaMin;

// The function that transport evaluates for a light (SpectrumTable, Lookup::kNearestNm), as knots of a piecewise linear one: steps
// half way between integer nm, or the spectrum's own knots where it has fine lines.
struct Evaluated {
    const color::Spectrum* s;
    bool fine;

    explicit Evaluated(const color::Spectrum& spectrum) : s(&spectrum), fine(has_fine_lines(spectrum)) {}
    void add_knots(std::vector<double>& knots) const {
        if (fine) {
            knots.insert(knots.end(), s->lambda_nm().begin(), s->lambda_nm().end());
        } else {
            for (double nm = color::kLambdaMin; nm < color::kLambdaMax; ++nm) knots.push_back(nm + 0.5);
        }
    }
    // Over an interval without a step inside. Knots that were joined with an end are passed over, others between are gone along.
    double integral(double a, double b) const {
        if (!fine) return (*s)(std::floor(0.5 * (a + b) + 0.5)) * (b - a);
        const auto nm = s->lambda_nm();
        // Beyond an edge at either end there is nothing; a and b are rounded to 2^-20 nm.
        const bool beyond = nm.front() + 0x1p-20 > b || nm.back() - 0x1p-20 < a;
        if (beyond && s->outside() == color::Outside::kZero) return 0;
        auto knot = std::upper_bound(nm.begin(), nm.end(), a + kNearKnots * 0x1p-20);
        const auto last = std::lower_bound(knot, nm.end(), b - kNearKnots * 0x1p-20);
        double sum = 0;
        for (; knot < last; a = *knot++) sum += 0.5 * ((*s)(a) + (*s)(*knot)) * (*knot - a);
        return sum + 0.5 * ((*s)(a) + (*s)(b)) * (b - a);
    }
};

// Largest s(lambda) over its mean weighted by p_eye.
double peak_over_mean(const color::Spectrum& s) {
    std::vector<double> knots;
    for (double nm = color::kLambdaMin; nm <= color::kLambdaMax; ++nm) knots.push_back(nm);
    const Evaluated evaluated(s);
    evaluated.add_knots(knots);
    std::sort(knots.begin(), knots.end());
    double mean = 0, peak = 0;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        const double a = std::max(knots[i], color::kLambdaMin), b = std::min(knots[i + 1], color::kLambdaMax);
        if (!(b > a)) continue;
        const double average = evaluated.integral(a, b) / (b - a);
        mean += average * (color::visible_cdf(b) - color::visible_cdf(a));
        peak = std::max(peak, average);
    }
    return mean > 0 ? peak / mean : 0;
}

}  // namespace

sampledb::WavelengthDensity wavelength_density(const std::vector<LightSpectrum>& lights) {
    std::vector<double> nm;
    for (double x = color::kLambdaMin; x <= color::kLambdaMax; ++x) nm.push_back(x);

    struct Spike {
        Evaluated evaluated;
        double power, integral = 0;
    };
    std::vector<Spike> spikes;
    double spike_power = 0;
    for (const LightSpectrum& light : lights) {
        if (!(light.luminous_power > 0) || peak_over_mean(light.spectrum) <= kSpikeThreshold) continue;
        spikes.push_back({Evaluated(light.spectrum), light.luminous_power});
        spikes.back().evaluated.add_knots(nm);
        spike_power += light.luminous_power;
    }

    std::vector<std::uint32_t> knots;
    for (const double x : nm) {
        if (x >= color::kLambdaMin && x <= color::kLambdaMax) knots.push_back(static_cast<std::uint32_t>(std::lround(x * 0x1p20)));
    }
    std::sort(knots.begin(), knots.end());
    for (std::uint32_t near = kNearKnots; near == kNearKnots || knots.size() > kMaxKnots; near *= 2) {
        const auto joined = std::unique(knots.begin(), knots.end(), [&](std::uint32_t a, std::uint32_t b) { return b - a < near; });
        knots.erase(joined, knots.end());
    }
    knots.back() = static_cast<std::uint32_t>(color::kLambdaMax * 0x1p20);

    const auto each_interval = [&](auto visit) {
        for (std::size_t i = 0; i + 1 < knots.size(); ++i) visit(knots[i] * 0x1p-20, knots[i + 1] * 0x1p-20, i + 1);
    };
    each_interval([&](double a, double b, std::size_t) {
        for (Spike& spike : spikes) spike.integral += spike.evaluated.integral(a, b);
    });

    std::vector<sampledb::WavelengthDensity::Knot> q{{knots.front(), 0}};
    const double eye_share = spikes.empty() ? kEyeShare + kSpikeShare : kEyeShare;
    double sum = 0;
    each_interval([&](double a, double b, std::size_t upper) {
        sum += eye_share * (color::visible_cdf(b) - color::visible_cdf(a)) + kUniformShare * (b - a) / kRange;
        for (const Spike& spike : spikes)
            sum += kSpikeShare * spike.power / spike_power * spike.evaluated.integral(a, b) / spike.integral;
        const std::uint64_t rounded = static_cast<std::uint64_t>(std::llround(sum * 0x1p32)) << 16;
        q.push_back({knots[upper], std::max(rounded, q.back().cumulative + (1u << 16))});
    });
    q.back().cumulative = std::uint64_t{1} << 48;
    return *sampledb::WavelengthDensity::from_knots(std::move(q));
}

}  // namespace latent::render
