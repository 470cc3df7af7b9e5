#include "color/film/printer.h"

#include <algorithm>
#include <cmath>

#include "color/power_of_ten.h"

namespace latent::film {
namespace {

double logistic(double x) { return 1 / (1 + color::power_of_e(-x)); }

// 3200 K behind a filter that keeps heat away from the film.
const Curve& lamp() {
    static const Curve curve = [] {
        Curve out = film::light("3200K");
        for (std::size_t i = 0; i < kNm; ++i) out[i] *= logistic((730 - kFirstNm - static_cast<double>(i)) / 12);
        return out;
    }();
    return curve;
}

// Densities of dichroic filters of unit density: yellow, magenta, cyan.
const Curves& filters() {
    static const Curves curves = [] {
        Curves out;
        for (std::size_t i = 0; i < kNm; ++i) {
            const double nm = kFirstNm + static_cast<double>(i);
            const auto above = [&](double edge) { return logistic((nm - edge) / 8); };
            const auto below = [&](double edge) { return logistic((edge - nm) / 8); };
            out[0][i] = below(505);
            out[1][i] = above(495) * below(605);
            out[2][i] = above(595);
        }
        return out;
    }();
    return curves;
}

Curve light_of(const Pack& pack) {
    const Curves& f = filters();
    Curve out;
    for (std::size_t i = 0; i < kNm; ++i) {
        const double density = pack.ymc[0] * f[0][i] + pack.ymc[1] * f[1][i] + pack.ymc[2] * f[2][i];
        out[i] = lamp()[i] * color::power_of_ten(pack.log_time - density);
    }
    return out;
}

Curve product(const Curve& a, const Curve& b) {
    Curve out;
    for (std::size_t i = 0; i < kNm; ++i) out[i] = a[i] * b[i];
    return out;
}

// Time and two filters for which light through `grey` gives the layers log10 exposures `aim`; filter `zero` is 0.
Pack solved_without(std::size_t zero, const Stock& paper, const Curve& grey, const Triple& aim) {
    const std::size_t one = zero == 0 ? 1 : 0, two = zero == 2 ? 1 : 2;
    const Curve through_grey = transmittance(grey);
    Pack pack;
    for (int step = 0; step < 200; ++step) {
        const Curve light = product(light_of(pack), through_grey);
        std::array<Triple, 3> jacobian;
        Triple missing;
        for (std::size_t k = 0; k < 3; ++k) {
            const Curve seen_by_layer = product(light, paper.sensitivities()[k]);
            double exposure = 0;
            for (const double v : seen_by_layer) exposure += v;
            jacobian[k] = {1, -dot(seen_by_layer, filters()[one]) / exposure, -dot(seen_by_layer, filters()[two]) / exposure};
            missing[k] = aim[k] - color::log10_of(exposure);
        }
        const Triple change = solve(jacobian, missing);
        const auto limited = [](double v) { return std::clamp(v, -0.3, 0.3); };
        pack.log_time += limited(change[0]);
        pack.ymc[one] += limited(change[1]);
        pack.ymc[two] += limited(change[2]);
        if (std::abs(change[0]) + std::abs(change[1]) + std::abs(change[2]) < 1e-13) break;
    }
    return pack;
}

Triple white_of(const Stock& stock, const Viewing& viewing) {
    Triple white = seen(stock, viewing, {});
    for (const std::size_t c : {0u, 2u}) white[c] /= white[1];
    white[1] = 1;
    return white;
}

}  // namespace

Viewing viewing_of(Kind kind) {
    return kind == Kind::kPrintFilm ? Viewing{film::light("D55"), 0.10} : Viewing{film::light("D50"), 0.18};
}

Triple seen(const Stock& stock, const Viewing& viewing, const Triple& amounts) {
    const Curve stimulus = product(transmittance(stock.density(amounts)), viewing.light);
    return {dot(stimulus, matching()[0]), dot(stimulus, matching()[1]), dot(stimulus, matching()[2])};
}

Triple neutral_amounts(const Stock& stock, const Viewing& viewing, double y) {
    const Triple white = white_of(stock, viewing);
    Curves weights;
    Triple target;
    for (std::size_t k = 0; k < 3; ++k) {
        weights[k] = product(viewing.light, matching()[k]);
        double sum = 0;
        for (const double w : weights[k]) sum += w;
        for (double& w : weights[k]) w /= sum;
        target[k] = -color::log10_of(y * white[k] / sum);
    }
    return unmixed(target, stock.base(), stock.dyes(), weights, {0.6, 0.6, 0.6});
}

Triple neutral_shift(const Stock& slide, const Triple& grey) {
    const Viewing viewing = viewing_of(slide.material().kind);
    const Triple neutral = neutral_amounts(slide, viewing, seen(slide, viewing, slide.amounts(grey))[1]);
    Triple shift;
    for (std::size_t c = 0; c < 3; ++c) shift[c] = slide.exposure_for(c, neutral[c]) - grey[c];
    return shift;
}

Printer::Printer(const Stock& paper, const Curve& grey) {
    const Viewing viewing = viewing_of(paper.material().kind);
    const Triple amounts = neutral_amounts(paper, viewing, viewing.aim);
    for (std::size_t c = 0; c < 3; ++c) aim_[c] = paper.exposure_for(c, amounts[c]);
    // No enlarger can have negative filters: the choice whose smallest density is largest.
    std::array<Pack, 3> packs;
    for (const std::size_t zero : {2u, 1u, 0u}) packs[zero] = solved_without(zero, paper, grey, aim_);
    std::ranges::reverse(packs);
    set(*std::ranges::max_element(packs, {}, [](const Pack& pack) { return std::ranges::min(pack.ymc); }));
}

void Printer::set(const Pack& pack) {
    pack_ = pack;
    light_ = light_of(pack);
}

void Printer::use(const Triple& ymc, const Stock& paper, const Curve& grey) {
    set({ymc, 0});
    const double green = color::log10_of(dot(product(light_, transmittance(grey)), paper.sensitivities()[1]));
    set({ymc, aim_[1] - green});
}

Triple Printer::exposures(const Stock& paper, const Curve& density) const {
    const Curve light = product(light_, transmittance(density));
    Triple h;
    for (std::size_t c = 0; c < 3; ++c) {
        const double plain = color::log10_of(std::max(dot(light, paper.sensitivities()[c]), 1e-12));
        h[c] = aim_[c] + (plain - aim_[c]) * trim_[c];
    }
    return h;
}

// Least squares of a* and b* by Gauss and Newton.
void Printer::trim_to(const Stock& paper, std::span<const Curve> greys) {
    const Viewing viewing = viewing_of(paper.material().kind);
    const Triple white = white_of(paper, viewing);
    trim_ = {1, 1, 1};
    std::vector<Triple> plain;
    for (const Curve& grey : greys) plain.push_back(exposures(paper, grey));
    const auto off = [&](double red, double blue) {
        std::vector<double> out;
        const Triple q{red, 1, blue};
        for (const Triple& h : plain) {
            Triple trimmed;
            for (std::size_t c = 0; c < 3; ++c) trimmed[c] = aim_[c] + (h[c] - aim_[c]) * q[c];
            const Triple colour = lab(seen(paper, viewing, paper.amounts(trimmed)), white);
            out.push_back(colour[1]);
            out.push_back(colour[2]);
        }
        return out;
    };
    constexpr double kStep = 1e-3;
    double red = 1, blue = 1;
    for (int i = 0; i < 15; ++i) {
        const std::vector<double> f = off(red, blue), by_red = off(red + kStep, blue), by_blue = off(red, blue + kStep);
        double rr = 0, rb = 0, bb = 0, rf = 0, bf = 0;
        for (std::size_t k = 0; k < f.size(); ++k) {
            const double r = (by_red[k] - f[k]) / kStep, b = (by_blue[k] - f[k]) / kStep;
            rr += r * r, rb += r * b, bb += b * b, rf += r * f[k], bf += b * f[k];
        }
        const double determinant = rr * bb - rb * rb;
        if (!(determinant > 0)) break;
        const double red_change = (bb * rf - rb * bf) / determinant, blue_change = (rr * bf - rb * rf) / determinant;
        red = std::clamp(red - red_change, 0.5, 2.0);
        blue = std::clamp(blue - blue_change, 0.5, 2.0);
        if (std::abs(red_change) + std::abs(blue_change) < 1e-12) break;
    }
    trim_ = {red, 1, blue};
}

}  // namespace latent::film
