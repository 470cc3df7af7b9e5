#include "tools/convert/dodge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/option_parts.h"
#include "base/parse.h"

namespace latent::convert {

Result<Dodge> parse_dodge(std::string_view text) {
    constexpr double kMaxStops = 20, kFar = 10;
    const std::size_t colon = text.find(':');
    const std::string_view kind = text.substr(0, colon);
    const auto numbers = parse_numbers(colon == text.npos ? "" : text.substr(colon + 1));
    const bool is_brush = kind == "brush";
    const std::size_t before = is_brush ? 2 : 1;  // the line
    const bool is_possible = numbers &&
                             (is_brush ? numbers->size() >= 4 && numbers->size() % 2 == 0 && (*numbers)[1] > 0
                                       : kind == "gradient" && numbers->size() == 5) &&
                             std::abs((*numbers)[0]) <= kMaxStops &&
                             std::all_of(numbers->begin() + 1, numbers->end(), [](double v) { return std::abs(v) <= kFar; });
    if (is_possible) {
        Dodge dodge{.text = std::string(text), .stops = (*numbers)[0], .radius = is_brush ? (*numbers)[1] : 0};
        for (std::size_t i = before; i < numbers->size(); i += 2) dodge.line.push_back({(*numbers)[i], (*numbers)[i + 1]});
        const Place &a = dodge.line.front(), &b = dodge.line.back();
        if (is_brush || a.x != b.x || a.y != b.y) return dodge;
    }
    return is_not(text, "a part to dodge or burn (try brush:0.5,0.1,0.25,0.75 or gradient:-1,0.5,0,0.5,0.4)");
}

Dodging::Dodging(std::span<const Dodge> all, const image::Rect& whole) {
    for (const Dodge& dodge : all) {
        Stroke stroke{dodge.stops, dodge.radius * std::max(whole.width(), whole.height())};
        for (const Place& p : dodge.line)
            stroke.line.push_back({whole.x0 + p.x * whole.width() - 0.5, whole.y0 + p.y * whole.height() - 0.5});
        const auto [top, bottom] = std::ranges::minmax(stroke.line, {}, [](const auto& p) { return p[1]; });
        const double reach = stroke.radius > 0 ? stroke.radius : std::numeric_limits<double>::infinity();
        stroke.first = top[1] - reach, stroke.last = bottom[1] + reach;
        strokes_.push_back(std::move(stroke));
    }
}

bool Dodging::reaches(int y) const {
    return std::ranges::any_of(strokes_, [y](const Stroke& s) { return s.first < y && y < s.last; });
}

// How much of the stops applies.
double Dodging::share(const Stroke& stroke, double x, double y) {
    // How far along the line from a to b the nearest place is, from 0 to 1.
    const auto along = [&](const std::array<double, 2>& a, const std::array<double, 2>& b) {
        const double dx = b[0] - a[0], dy = b[1] - a[1], length2 = dx * dx + dy * dy;
        return length2 == 0 ? 0 : std::clamp(((x - a[0]) * dx + (y - a[1]) * dy) / length2, 0.0, 1.0);
    };
    if (stroke.radius == 0) {
        const double t = along(stroke.line[0], stroke.line[1]);
        return 1 - t * t * (3 - 2 * t);
    }
    double nearest2 = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < stroke.line.size(); ++i) {
        const auto &a = stroke.line[i], &b = stroke.line[std::min(i + 1, stroke.line.size() - 1)];
        const double t = along(a, b), dx = a[0] + t * (b[0] - a[0]) - x, dy = a[1] + t * (b[1] - a[1]) - y;
        nearest2 = std::min(nearest2, dx * dx + dy * dy);
    }
    const double outside = std::max(0.0, 1 - nearest2 / (stroke.radius * stroke.radius));
    return outside * outside;
}

void Dodging::apply(int x0, int y, const std::array<std::span<float>, 3>& rows) const {
    if (!reaches(y)) return;
    for (std::size_t i = 0; i < rows[0].size(); ++i) {
        const double x = x0 + static_cast<double>(i);
        double stops = 0;
        for (const Stroke& stroke : strokes_) {
            if (stroke.first < y && y < stroke.last) stops += stroke.stops * share(stroke, x, y);
        }
        if (stops == 0) continue;
        const auto factor = static_cast<float>(std::exp2(stops));
        for (const std::span<float> row : rows) row[i] *= factor;
    }
}

}  // namespace latent::convert
