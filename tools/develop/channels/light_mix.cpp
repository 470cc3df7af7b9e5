#include "tools/develop/channels/light_mix.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/near_names.h"
#include "base/parse.h"
#include "base/small_file.h"
#include "color/catalogue.h"
#include "color/csv.h"
#include "color/light_name.h"
#include "color/light_spectrum.h"
#include "tools/develop/channels/light_setting.h"

namespace latent::develop {

namespace {

using color::Spectrum;

constexpr double kLargestWeight = 20;
constexpr std::uint64_t kMaxCurveFile = 1 << 20;

Result<Spectrum> curve_of_file(const std::string& name) {
    const Result<std::string> text = read_small_file(name, kMaxCurveFile, "a curve");
    if (!text) return text.error();
    Result<Spectrum> curve = color::curve_from_csv(*text);
    if (!curve) return curve.error().at(name);
    return curve;
}

Result<Spectrum> curve_of(const std::string& name) {
    std::error_code ignored;
    if (name.ends_with(".csv") || std::filesystem::exists(name, ignored)) return curve_of_file(name);
    Result<Spectrum> filter = color::lens_filter(name);
    if (!filter)
        return is_not(name, "a factor, a spectrum (6500K, D65, A, E, F1 to F12) or a curve (FILE.csv): " + filter.error().message);
    return filter;
}

// f(nm) at the knots of both and at every whole nm. Errors: kOutOfRange if a value is not finite.
template <class F>
Result<Spectrum> at_knots_of(const Spectrum& a, const Spectrum& b, const F& f) {
    std::vector<double> nm, value;
    for (double whole = color::kLambdaMin; whole <= color::kLambdaMax; ++whole) nm.push_back(whole);
    for (const Spectrum* s : {&a, &b}) {
        for (const double knot : s->lambda_nm()) {
            if (knot > color::kLambdaMin && knot < color::kLambdaMax) nm.push_back(knot);
        }
    }
    std::ranges::sort(nm);
    nm.erase(std::unique(nm.begin(), nm.end()), nm.end());
    for (const double at : nm) value.push_back(f(at));
    return Spectrum::from_samples(std::move(nm), std::move(value), color::Outside::kClamped);
}

// What makes `wanted` of `own`, both of luminance 1.
Result<Spectrum> replacement(const Spectrum& own, const Spectrum& wanted, const LightSetting& setting) {
    const double own_y = color::luminance(own), wanted_y = color::luminance(wanted);
    double missing = 0;
    const Result<Spectrum> ratio = at_knots_of(own, wanted, [&](double nm) {
        const double from = own(nm) / own_y, to = wanted(nm) / wanted_y;
        if (from > 0) return to / from;
        if (to > 0 && missing == 0) missing = nm;
        return 0.0;
    });
    if (missing > 0)
        return usage_error(
            fmt::format("{}: the lights named {} emit nothing at {:.0f} nm, so their spectrum cannot be replaced; render the scene "
                        "with the new light",
                        setting.spectrum, setting.name, missing));
    return ratio;
}

Result<GroupFactor> factor_of(const LightGroup& group, const LightSetting& setting) {
    GroupFactor out{setting.factor, {}};
    const std::string where = "--light " + setting.name;
    const auto multiply = [&](Result<Spectrum> curve) -> Status {
        if (curve && out.curve) curve = at_knots_of(*out.curve, *curve, [&](double nm) { return (*out.curve)(nm) * (*curve)(nm); });
        if (!curve) return curve.error().at(where);
        out.curve = *std::move(curve);
        return {};
    };
    if (!setting.spectrum.empty()) {
        if (!group.spectrum)
            return usage_error(
                fmt::format("--light {}={}: the lights of this name have different spectra, or the file does not name their "
                            "spectrum; use a factor or a filter",
                            setting.name, setting.spectrum, setting.name));
        const Result<Spectrum> wanted = color::light_by_name(setting.spectrum);
        if (!wanted) return wanted.error().at(where);
        if (Status s = multiply(replacement(*group.spectrum, *wanted, setting)); !s) return s.error();
    }
    for (const std::string& name : setting.curves) {
        if (Status s = multiply(curve_of(name)); !s) return s.error();
    }
    return out;
}

std::string names_of(const std::vector<LightGroup>& groups) {
    std::string names;
    for (const LightGroup& group : groups) names += (names.empty() ? "" : ", ") + group.name;
    return names;
}

}  // namespace

Result<std::vector<GroupFactor>> mix_lights(const std::vector<LightGroup>& groups, const std::vector<std::string>& settings,
                                            std::vector<std::string>& warnings) {
    std::vector<GroupFactor> factors(groups.size());
    std::vector<bool> set(groups.size());
    for (const std::string& text : settings) {
        const Result<LightSetting> setting = parse_light(text);
        if (!setting) return setting.error().at("--light");
        const auto found = std::ranges::find(groups, setting->name, &LightGroup::name);
        if (found == groups.end()) {
            std::vector<std::string> names;
            for (const LightGroup& group : groups) names.push_back(group.name);
            const std::string near = near_names(setting->name, names);
            return usage_error(fmt::format("--light {}: no light has this name{}; choose from {}", text,
                                           near.empty() ? "" : fmt::format(" (did you mean {}?)", near), names_of(groups)));
        }
        const auto number = static_cast<std::size_t>(found - groups.begin());
        if (set[number]) return usage_error(fmt::format("--light {}: {} is given twice", text, setting->name));
        set[number] = true;
        const Result<GroupFactor> factor = factor_of(*found, *setting);
        if (!factor) return factor.error();
        factors[number] = *factor;
        double largest = factor->curve ? 0 : 1;
        for (double nm = 380; nm <= 780 && factor->curve; ++nm) largest = std::max(largest, (*factor->curve)(nm));
        largest *= factor->factor;
        if (largest > kLargestWeight)
            warnings.push_back(
                fmt::format("--light {}: {} multiplied by {:.0f}, and so is the noise; for less noise, render the "
                            "scene with the new light",
                            text, factor->curve ? "some wavelengths are" : "the light is", largest));
    }
    return factors;
}

}  // namespace latent::develop
