#include "color/print.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "color/print_row.h"

namespace latent::color {

Result<Gamut> gamut_by_name(std::string_view name) {
    if (name == "luminance") return Gamut::kLuminance;
    if (name == "grey") return Gamut::kGrey;
    if (name == "clip") return Gamut::kClip;
    return usage_error(fmt::format("unknown gamut mapping \"{}\"; choose luminance, grey or clip", name));
}

PrintReport& PrintReport::operator+=(const PrintReport& other) {
    pixels += other.pixels;
    nan += other.nan;
    negative += other.negative;
    infinite += other.infinite;
    colourless += other.colourless;
    out_of_gamut += other.out_of_gamut;
    clipped += other.clipped;
    black += other.black;
    burnt += other.burnt;
    return *this;
}

double pushed_sigma(double sigma, double stops) { return sigma * std::exp2(stops); }

Result<Print> Print::create(const RgbSpace& space, const PrintSettings& settings) {
    if (!(settings.sigma > 0) || !std::isfinite(static_cast<float>(settings.sigma))) {
        return Error{ErrorCode::kOutOfRange, fmt::format("the sensitivity must be a positive number, not {}", settings.sigma)};
    }
    const bool keeps_luminance = settings.tone != Tone::kNone && settings.gamut != Gamut::kClip;
    if (Status s = space.check_luminance_row(); keeps_luminance && !s) return s.error();
    Print print;
    print.sigma_ = settings.sigma;
    print.tone_ = settings.tone;
    print.gamut_ = settings.gamut;
    print.curve_ = settings.curve;
    print.range_ = settings.range;
    print.y_row_ = settings.adaptation.m[1];
    print.rgb_from_xyz_ = space.rgb_from_xyz * settings.adaptation;
    print.m_ = space.luminance_row;
    return print;
}

namespace {

double luminance(const std::array<double, 3>& m, const std::array<double, 3>& rgb) {
    return m[0] * rgb[0] + m[1] * rgb[1] + m[2] * rgb[2];
}

bool outside(const std::array<double, 3>& rgb) {
    return std::ranges::any_of(rgb, [](double v) { return v < -kGamutMargin || v > 1 + kGamutMargin; });
}

// From rgb, whose luminance is y', along the straight line to the grey (y', y', y') until nothing is outside [0,1].
void move_to_grey(std::array<double, 3>& rgb, double y_printed) {
    double t = 1;
    for (const double v : rgb) {
        if (v > 1) t = std::min(t, (1 - y_printed) / (v - y_printed));
        if (v < 0) t = std::min(t, y_printed / (y_printed - v));
    }
    for (double& v : rgb) v = y_printed + t * (v - y_printed);
}

// Scales rgb, inside [0,1], down to the luminance y', or fades it towards white up to it.
void restore_luminance(std::array<double, 3>& rgb, double y_printed, const std::array<double, 3>& m) {
    const double present = luminance(m, rgb), d = y_printed - present;
    for (double& v : rgb) {
        if (d < 0) v *= y_printed / present;
        if (d > 0) v += (1 - v) * d / (1 - present);
        v = std::clamp(v, 0.0, 1.0);
    }
}

}  // namespace

Rgb Print::pixel(Xyz xyz, PrintReport& report) const {
    ++report.pixels;
    const bool coloured = std::isfinite(xyz.x) && std::isfinite(xyz.z);
    const bool adaptable = coloured && std::isfinite(xyz.y);
    const double y = adaptable ? y_row_[0] * xyz.x + y_row_[1] * xyz.y + y_row_[2] * xyz.z : xyz.y;
    report.black += static_cast<float>(y) < range_.black;
    report.burnt += static_cast<float>(y) > range_.burnt;
    if (std::isnan(y)) {
        ++report.nan;
        return {};
    }
    if (y <= 0 && (tone_ != Tone::kNone || !adaptable)) {
        report.negative += y < 0;
        return {};
    }
    if (std::isinf(y)) {
        ++report.infinite;
        return {1, 1, 1};
    }
    // y' and y' / y; the latter tends to sigma ln 2.
    const double y_printed = tone_ == Tone::kFilm    ? -std::expm1(-sigma_ * y * std::numbers::ln2)
                             : tone_ == Tone::kCurve ? curve_(sigma_ * y)
                                                     : sigma_ * y;
    if (!coloured) {
        ++report.colourless;
        return {y_printed, y_printed, y_printed};
    }
    const double scale = tone_ == Tone::kNone                         ? sigma_
                         : tone_ == Tone::kFilm && sigma_ * y < 1e-12 ? sigma_ * std::numbers::ln2
                                                                      : y_printed / y;
    std::array<double, 3> rgb = rgb_from_xyz_ * std::array{xyz.x * scale, xyz.y * scale, xyz.z * scale};
    const bool out = outside(rgb);
    report.out_of_gamut += out;
    if (tone_ == Tone::kNone) return {rgb[0], rgb[1], rgb[2]};
    if (gamut_ == Gamut::kGrey) move_to_grey(rgb, y_printed);
    for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
    if (gamut_ == Gamut::kClip) {
        report.clipped += out;
    } else {
        restore_luminance(rgb, y_printed, m_);
    }
    return {rgb[0], rgb[1], rgb[2]};
}

std::optional<Rgb> Print::unmapped(Xyz xyz) const {
    if (!std::isfinite(xyz.x) || !std::isfinite(xyz.y) || !std::isfinite(xyz.z)) return std::nullopt;
    const double y = y_row_[0] * xyz.x + y_row_[1] * xyz.y + y_row_[2] * xyz.z;
    if (!(y > 0)) return std::nullopt;
    const double scale = tone_ == Tone::kFilm    ? -std::expm1(-sigma_ * y * std::numbers::ln2) / y
                         : tone_ == Tone::kCurve ? curve_(sigma_ * y) / y
                                                 : sigma_;
    const std::array<double, 3> rgb = rgb_from_xyz_ * std::array{xyz.x * scale, xyz.y * scale, xyz.z * scale};
    return Rgb{rgb[0], rgb[1], rgb[2]};
}

bool Print::out_of_gamut(const Rgb& unmapped) const { return outside({unmapped.r, unmapped.g, unmapped.b}); }

void Print::row(std::span<const float> x, std::span<const float> y, std::span<const float> z, std::span<float> r,
                std::span<float> g, std::span<float> b, PrintReport& report, std::span<float> luminances) const {
    assert(luminances.empty() || luminances.size() == x.size());
    assert(y.size() == x.size() && z.size() == x.size() && r.size() == x.size() && g.size() == x.size() && b.size() == x.size());
    PrintRowConstants constants{.sigma = static_cast<float>(sigma_),
                                .tone = tone_,
                                .gamut = gamut_,
                                .adapted = y_row_ != std::array<double, 3>{0, 1, 0},
                                .y_row = y_row_,
                                .rgb_from_xyz = {},
                                .luminance_row = {},
                                .curve = curve_.table().data(),
                                .range = range_,
                                .luminances = luminances.empty() ? nullptr : luminances.data()};
    for (int i = 0; i < 3; ++i) {
        constants.luminance_row[i] = static_cast<float>(m_[i]);
        for (int j = 0; j < 3; ++j) constants.rgb_from_xyz[3 * i + j] = static_cast<float>(rgb_from_xyz_.m[i][j]);
    }
    print_row(constants, x.data(), y.data(), z.data(), r.data(), g.data(), b.data(), x.size(), report);
}

}  // namespace latent::color
