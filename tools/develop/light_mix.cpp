#include "tools/develop/light_mix.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>

#include "base/file.h"
#include "base/json.h"
#include "base/near_names.h"
#include "base/parse.h"
#include "color/catalogue.h"
#include "color/light_spectrum.h"
#include "color/named_spectra.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/provenance.h"

namespace latent::develop {

namespace {

using color::Spectrum;

constexpr double kLargestWeight = 20;
constexpr std::uint64_t kMaxCurveFile = 1 << 20;

Error usage(std::string message) { return Error{ErrorCode::kUsage, std::move(message)}; }

std::vector<std::string_view> parts_of(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    while (true) {
        const std::size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

bool is_temperature(std::string_view text) {
    return text.size() > 1 && (text.back() == 'K' || text.back() == 'k') && parse_number(text.substr(0, text.size() - 1)) &&
           text.find_first_not_of("0123456789.") == text.size() - 1;
}

// A light by its temperature or name; kNotFound if there is none of that name.
Result<Spectrum> light_of(const std::string& text) {
    constexpr double kLeast = 1000, kDaylight = 4000, kMost = 25000;
    if (text == "E") return Spectrum::constant(1);
    if (!is_temperature(text)) return color::named_spectrum("stdillum-" + text);
    const double kelvin = *parse_number(std::string_view(text).substr(0, text.size() - 1));
    if (!(kelvin >= kLeast && kelvin <= kMost))
        return usage(fmt::format("'{}' is not a temperature from {:.0f}K to {:.0f}K", text, kLeast, kMost));
    return kelvin >= kDaylight ? color::daylight(kelvin) : Spectrum::blackbody(kelvin);
}

// Lines of nm and factor; `#` comments, and one line of column names.
Result<Spectrum> curve_of_file(const std::string& name) {
    Result<File> file = File::open_read(name);
    if (!file) return file.error();
    const Result<std::uint64_t> size = file->size();
    if (!size) return size.error();
    if (*size > kMaxCurveFile) return Error{ErrorCode::kForeign, name + ": too large for a curve"};
    std::string text(*size, '\0');
    if (Status s = file->read_exact(0, std::as_writable_bytes(std::span(text))); !s) return s.error();
    std::vector<double> nm, factor;
    int number = 0;
    for (std::string_view line : parts_of(text, '\n')) {
        ++number;
        line = line.substr(0, line.find('#'));
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
        if (line.empty()) continue;
        const auto numbers = parse_numbers(line);
        if (!numbers && nm.empty() && line.find_first_of("0123456789") != 0) continue;  // names of columns
        if (!numbers || numbers->size() != 2 || (*numbers)[1] < 0)
            return Error{ErrorCode::kCorrupt,
                         fmt::format("{}: line {}: not a wavelength in nm and a factor, as in 550,0.8", name, number)};
        nm.push_back((*numbers)[0]);
        factor.push_back((*numbers)[1]);
    }
    Result<Spectrum> curve = Spectrum::from_samples(std::move(nm), std::move(factor), color::Outside::kClamped);
    if (!curve) return curve.error().at(name);
    return curve;
}

Result<Spectrum> curve_of(const std::string& name) {
    std::error_code ignored;
    if (name.ends_with(".csv") || std::filesystem::exists(name, ignored)) return curve_of_file(name);
    Result<Spectrum> filter = color::lens_filter(name);
    if (!filter) return usage(filter.error().message);
    return filter;
}

// f(nm) at the knots of both and at every whole nm.
template <class F>
Spectrum at_knots_of(const Spectrum& a, const Spectrum& b, const F& f) {
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
    return *Spectrum::from_samples(std::move(nm), std::move(value), color::Outside::kClamped);
}

// What makes `wanted` of `own`, both of luminance 1.
Result<Spectrum> replacement(const Spectrum& own, const Spectrum& wanted, const LightSetting& setting) {
    const double own_y = color::luminance(own), wanted_y = color::luminance(wanted);
    double missing = 0;
    const Spectrum ratio = at_knots_of(own, wanted, [&](double nm) {
        const double from = own(nm) / own_y, to = wanted(nm) / wanted_y;
        if (from > 0) return to / from;
        if (to > 0 && missing == 0) missing = nm;
        return 0.0;
    });
    if (missing > 0)
        return usage(
            fmt::format("--light {}={}: lights called {} emit nothing at {:.0f} nm, so that cannot be made of them; render "
                        "the scene with that light",
                        setting.name, setting.spectrum, setting.name, missing));
    return ratio;
}

Result<GroupFactor> factor_of(const LightGroup& group, const LightSetting& setting) {
    GroupFactor out{setting.factor, {}};
    const auto multiply = [&](const Spectrum& curve) {
        out.curve = out.curve ? at_knots_of(*out.curve, curve, [&](double nm) { return (*out.curve)(nm)*curve(nm); }) : curve;
    };
    if (!setting.spectrum.empty()) {
        if (!group.spectrum)
            return usage(
                fmt::format("--light {}={}: lights called {} have several spectra, or their file does not say which; they "
                            "can be scaled or filtered",
                            setting.name, setting.spectrum, setting.name));
        const Result<Spectrum> wanted = light_of(setting.spectrum);
        if (!wanted) return wanted.error().at("--light " + setting.name);
        const Result<Spectrum> ratio = replacement(*group.spectrum, *wanted, setting);
        if (!ratio) return ratio.error();
        multiply(*ratio);
    }
    for (const std::string& name : setting.curves) {
        const Result<Spectrum> curve = curve_of(name);
        if (!curve) return curve.error().at("--light " + setting.name);
        multiply(*curve);
    }
    return out;
}

std::string names_of(const std::vector<LightGroup>& groups) {
    std::string names;
    for (const LightGroup& group : groups) names += (names.empty() ? "" : ", ") + group.name;
    return names;
}

}  // namespace

Result<LightSetting> parse_light(std::string_view text) {
    const std::size_t equals = text.rfind('=');
    const auto refuse = [&](std::string_view what) {
        return usage(fmt::format("'{}': {} (try lamp=2.5, or sky=6500K,0.3)", text, what));
    };
    if (equals == std::string_view::npos || equals == 0) return refuse("not NAME=...");
    LightSetting setting{.name = std::string(text.substr(0, equals))};
    for (const std::string_view part : parts_of(text.substr(equals + 1), ',')) {
        const bool is_light = is_temperature(part) || part == "E" || color::named_spectrum(fmt::format("stdillum-{}", part));
        const Result<double> number = parse_number(part);
        if (part.empty()) return refuse("a part is empty");
        if (is_light && !setting.spectrum.empty()) return refuse("two spectra");
        if (!is_light && number && *number < 0) return refuse("a factor cannot be negative");
        if (is_light) {
            setting.spectrum = part;
        } else if (number) {
            setting.factor *= *number;
        } else {
            setting.curves.emplace_back(part);
        }
    }
    return setting;
}

std::vector<LightGroup> light_groups_in(std::string_view provenance_json) {
    std::vector<LightGroup> groups;
    for_each_element(member_of(provenance_json, "light_groups"), [&](std::string_view element) {
        const nlohmann::json group = nlohmann::json::parse(element, nullptr, false);
        LightGroup& out = groups.emplace_back();
        if (!group.is_object() || !group.contains("name") || !group["name"].is_string()) return;
        out.name = group["name"].get<std::string>();
        if (!group.contains("spectrum")) return;
        const auto numbers = [&](const char* key) {
            std::vector<double> list;
            const nlohmann::json& spectrum = group["spectrum"];
            if (!spectrum.is_object() || !spectrum.contains(key) || !spectrum[key].is_array()) return list;
            for (const nlohmann::json& x : spectrum[key]) list.push_back(x.is_number() ? x.get<double>() : std::nan(""));
            return list;
        };
        const bool goes_on = group["spectrum"].is_object() && group["spectrum"].value("goes_on", nlohmann::json()) == true;
        Result<Spectrum> spectrum =
            Spectrum::from_samples(numbers("nm"), numbers("value"), goes_on ? color::Outside::kClamped : color::Outside::kZero);
        if (spectrum && color::luminance(*spectrum) > 0) out.spectrum = *std::move(spectrum);
    });
    for (std::size_t i = 0; i < groups.size(); ++i) {
        if (groups[i].name.empty()) groups[i].name = std::to_string(i);
    }
    return groups;
}

Result<std::vector<LightGroup>> light_groups_of(const sampledb::Gathering& gathering) {
    if (std::ranges::find(gathering.job().extra, kLightGroupColumn, &sampledb::ExtraColumnSpec::name) ==
        gathering.job().extra.end())
        return usage("--light: the records do not say whose light they are; render with --light-groups");
    for (const sampledb::SelectedRun& run : gathering.runs()) {
        const std::filesystem::path& path = gathering.files()[run.file];
        const Result<sampledb::FileSource> source = sampledb::FileSource::open(path);
        if (!source) return source.error();
        const Result<sampledb::FileContents> frames = sampledb::read_frames(*source);
        if (!frames) return frames.error().at(path.string());
        const auto own = sampledb::quote_provenance(frames->header.provenance_json, sampledb::kHeaderProvenanceDepth);
        std::vector<LightGroup> groups = light_groups_in(own.json);
        const auto merged = sampledb::quote_provenance(frames->footer_provenance, sampledb::kFooterProvenanceDepth);
        for_each_element(member_of(merged.json, "parts"), [&](std::string_view part) {
            if (groups.empty()) groups = light_groups_in(member_of(part, "provenance"));
        });
        if (!groups.empty()) return groups;
        break;  // all parts of a job say the same
    }
    std::vector<LightGroup> numbered;
    for (int i = 0; i < 256; ++i) numbered.push_back({std::to_string(i)});
    return numbered;
}

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
            return usage(fmt::format("--light {}: there is no such light{}; there are {}", text,
                                     near.empty() ? "" : fmt::format(" (did you mean {}?)", near), names_of(groups)));
        }
        const auto number = static_cast<std::size_t>(found - groups.begin());
        if (set[number]) return usage(fmt::format("--light {}: {} is given twice", text, setting->name));
        set[number] = true;
        const Result<GroupFactor> factor = factor_of(*found, *setting);
        if (!factor) return factor.error();
        factors[number] = *factor;
        double largest = 0;
        for (double nm = 380; nm <= 780 && factor->curve; ++nm) largest = std::max(largest, (*factor->curve)(nm));
        if (largest > kLargestWeight)
            warnings.push_back(
                fmt::format("--light {}: some wavelengths count {:.0f} times, so the picture is noisy; render the scene "
                            "with that light for less noise",
                            text, largest));
    }
    return factors;
}

}  // namespace latent::develop
