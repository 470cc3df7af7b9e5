#include "tools/develop/lens/shutter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "base/option_parts.h"
#include "base/parse.h"
#include "base/small_file.h"
#include "color/csv.h"

namespace latent::develop {

namespace {

constexpr std::uint64_t kMaxShutterFile = 1 << 20;

// From 0 to 1 with level ends.
double smooth_step(double x) { return x * x * (3 - 2 * x); }

// Transmission over the time that an interval takes, 0..1.
using Transmission = std::function<double(double)>;

Result<Transmission> transmission_of(const std::string& curve) {
    if (curve.empty()) return Transmission([](double) { return 1.0; });
    if (curve == "soft") return Transmission([](double t) { return smooth_step(2 * std::min(t, 1 - t)); });
    if (curve == "film") return Transmission([](double t) { return std::min(1.0, 8 * std::min(t, 1 - t)); });
    const Result<std::string> text = read_small_file(curve, kMaxShutterFile, "a shutter's curve");
    if (!text) return text.error();
    const Result<color::Spectrum> table = color::curve_from_csv(*text, "time", "0.5,0.8");
    if (!table) return table.error().at(curve);
    if (table->lambda_nm().front() < 0 || table->lambda_nm().back() > 1)
        return Error{ErrorCode::kOutOfRange, "times are 0 to 1, from the beginning to the end of the exposure"}.at(curve);
    if (table->max_value() > 1)
        return Error{ErrorCode::kOutOfRange, "a shutter lets no more than all light pass: factors are 0 to 1"}.at(curve);
    return Transmission([table = *table](double t) { return table(t); });
}

Result<std::array<double, 2>> parse_interval(std::string_view part) {
    const std::vector<std::string_view> ends = parts_of(part, ':');
    const auto refuse = [&] { return is_not(part, "a part of the exposure, from 0 to 1 (try 0.2:0.5)"); };
    if (ends.size() != 2) return refuse();
    const Result<double> begin = parse_number(ends[0]), end = parse_number(ends[1]);
    if (!begin || !end || !(0 <= *begin && *begin < *end && *end <= 1)) return refuse();
    return std::array{*begin, *end};
}

}  // namespace

Result<Shutter> parse_shutter(std::string_view text) {
    Shutter shutter;
    if (Status s = check_parts_differ(text); !s) return s.error();
    for (const std::string_view part : parts_of(text, ',')) {
        const std::optional<NamedNumbers> named = named_numbers(part);
        if (part == "soft" || part == "film" || part.ends_with(".csv")) {
            if (!shutter.curve.empty()) return is_not(text, "a shutter: it has two curves");
            shutter.curve = part;
        } else if (named && named->name == "rolling" && named->numbers.size() == 1) {
            shutter.rolling = named->numbers[0];
            if (!(shutter.rolling >= 0 && shutter.rolling < 1))
                return is_not(part, "a rolling shutter, from 0 to below 1 (try rolling:0.5)");
        } else if (part.find(':') != std::string_view::npos) {
            const Result<std::array<double, 2>> interval = parse_interval(part);
            if (!interval) return interval.error();
            shutter.intervals.push_back(*interval);
        } else {
            return is_not(part, "part of a shutter (try 0.2:0.5, soft, film, FILE.csv or rolling:0.5)");
        }
    }
    std::ranges::sort(shutter.intervals);
    for (std::size_t i = 1; i < shutter.intervals.size(); ++i) {
        if (shutter.intervals[i][0] < shutter.intervals[i - 1][1]) return is_not(text, "a shutter: its times overlap");
    }
    return shutter;
}

Result<ShutterCurve> ShutterCurve::make(const Shutter& shutter) {
    const Result<Transmission> transmission = transmission_of(shutter.curve);
    if (!transmission) return transmission.error();
    std::vector<std::array<double, 2>> intervals = shutter.intervals;
    if (intervals.empty()) intervals.push_back({0, 1});
    ShutterCurve curve;
    curve.passed_.push_back(0);
    for (int i = 0; i < kSteps; ++i) {
        const double from = 1.0 * i / kSteps, to = 1.0 * (i + 1) / kSteps;
        double passed = 0;
        for (const auto& [begin, end] : intervals) {
            const double first = std::max(begin, from), last = std::min(end, to);
            if (first < last) passed += (last - first) * (*transmission)(((first + last) / 2 - begin) / (end - begin));
        }
        curve.passed_.push_back(curve.passed_.back() + passed);
    }
    curve.passed_.push_back(curve.passed_.back());
    if (!(curve.all() > 0)) return usage_error("--shutter: it never opens");
    return curve;
}

}  // namespace latent::develop
