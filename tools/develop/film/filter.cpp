#include "tools/develop/film/filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "base/parse.h"

namespace latent::develop {

namespace {

// exp(-x), x >= 0, by + - * / alone: the series at x / 2^m, then m squarings. Relative error below 1e-13 for x <= 64.
double exp_minus(double x) {
    int halvings = 0;
    for (; x > 0.125; x *= 0.5) ++halvings;
    double sum = 1, term = 1;
    for (int i = 1; i < 16; ++i) sum += term *= -x / i;
    for (; halvings > 0; --halvings) sum *= sum;
    return sum;
}

// 2 J1(pi x) / (pi x) as a function of x^2: sum over k of (-z)^k / (k! (k + 1)!), z = (pi x / 2)^2. Error below 1e-11 for x < 4.
double jinc(double x2) {
    const double z = std::numbers::pi * std::numbers::pi * x2 / 4;
    double sum = 1, term = 1;
    for (int k = 1; k < 64; ++k) sum += term *= -z / (static_cast<double>(k) * (k + 1));
    return sum;
}

// The two cubics of [MitchellNetravali88], constant term first: in d on 0 <= d < 1, in 2 - d on 1 <= d < 2.
struct MitchellPieces {
    std::array<double, 4> inner, outer;
};
MitchellPieces mitchell_pieces(double b, double c) {
    return {{(6 - 2 * b) / 6, 0, (-18 + 12 * b + 6 * c) / 6, (12 - 9 * b - 6 * c) / 6}, {0, 0, -c, (b + 6 * c) / 6}};
}
template <class T, class Cubic>
T evaluate(const Cubic& c, T d) {
    return T(c[0]) + d * (T(c[1]) + d * (T(c[2]) + d * T(c[3])));
}

void tabulate(FilterKernel& kernel, double radius, const std::function<double(double r2)>& f) {
    constexpr int n = FilterKernel::kTableSteps;
    kernel.form = FilterKernel::Form::kTable;
    kernel.table_scale = static_cast<float>(n / (radius * radius));
    kernel.table_value.assign(n + 1, 0.0f);
    kernel.table_step.assign(n + 1, 0.0f);
    for (int i = 0; i < n; ++i) kernel.table_value[i] = static_cast<float>(f(radius * radius * i / n));
    for (int i = 0; i < n; ++i) kernel.table_step[i] = kernel.table_value[i + 1] - kernel.table_value[i];
    kernel.has_negative_lobes = std::ranges::any_of(kernel.table_value, [](float w) { return w < 0; });
}

// Whether every weight at 1.5 pixels or more is zero, in the kernel's own arithmetic.
bool ends_within_three_pixels(const FilterKernel& kernel) {
    constexpr float kEdge2 = 1.5f * 1.5f;
    if (kernel.form == FilterKernel::Form::kQuartic) return kEdge2 * kernel.inverse_radius2 >= 1;
    return kernel.form == FilterKernel::Form::kTable && kEdge2 * kernel.table_scale >= FilterKernel::kTableSteps;
}

void lay_out_footprint(FilterKernel& kernel) {
    if (kernel.reach == 2 && ends_within_three_pixels(kernel))
        kernel.covered = 3;
    else
        kernel.covered = kernel.side();
    const int side = kernel.covered;
    const float first = 0.5f * static_cast<float>(2 - side);
    const int padded = (side * side + 15) / 16 * 16;
    kernel.column.assign(padded, 1000.0f);
    kernel.row.assign(padded, 1000.0f);
    for (int k = 0; k < side * side; ++k) {
        kernel.column[k] = first + static_cast<float>(k % side);
        kernel.row[k] = first + static_cast<float>(k / side);
    }
}

}  // namespace

Result<Filter> Filter::parse(std::string_view text) {
    const std::string_view kind = text.substr(0, text.find(':'));
    const std::string_view numbers = text.substr(std::min(kind.size() + 1, text.size()));
    const std::optional<std::vector<double>> parsed = parse_numbers(numbers);
    if (kind.size() < text.size() && !parsed)
        return usage_error(fmt::format("--filter {}: '{}' is not a list of numbers", text, numbers));
    const std::vector<double> given = kind.size() < text.size() ? *parsed : std::vector<double>{};
    std::array<double, 2> p;
    std::size_t parameters = 2;
    if (kind == "quartic")
        p = {-3, 1.5};
    else if (kind == "mitchell" || kind == "mitchell-separable")
        p = {1.0 / 3, 1.0 / 3};
    else if (kind == "gaussian")
        p = {0.5, 1.5};
    else if (kind == "lanczos" || kind == "box")
        p = {0, 0}, parameters = 0;
    else
        return usage_error(
            fmt::format("--filter {}: unknown filter; choose quartic:s,R  mitchell:B,C  mitchell-separable:B,C  "
                        "gaussian:sigma,R  lanczos  box",
                        text));
    if (given.size() > parameters) return usage_error(fmt::format("--filter {}: takes {} parameters", text, parameters));
    std::ranges::copy(given, p.begin());

    Filter filter;
    filter.name_ = parameters == 0 ? std::string(kind) : fmt::format("{}:{:.6g},{:.6g}", kind, p[0], p[1]);
    FilterKernel& kernel = filter.kernel_;
    double radius = 2;
    if (kind == "quartic") {
        if (p[0] <= -9)
            return usage_error(fmt::format("--filter {}: s must be above -9, where the filter's integral vanishes", text));
        if (p[0] < -7) filter.warning_ = fmt::format("--filter {}: rings strongly; usual values of s are -6 to -3", text);
        radius = p[1];
        kernel.form = FilterKernel::Form::kQuartic;
        kernel.has_negative_lobes = p[0] < -3;
    } else if (kind == "gaussian") {
        if (!(p[0] > 0)) return usage_error(fmt::format("--filter {}: sigma must be positive", text));
        radius = p[1];
    } else if (kind == "lanczos") {
        radius = 3.2383154841662362;  // the third zero of jinc
    } else if (kind == "box") {
        radius = 0.5;
    }
    if (!(radius > 0 && radius <= FilterKernel::kMaxReach)) {
        return usage_error(
            fmt::format("--filter {}: the radius R must be above 0 and at most {} pixels", text, FilterKernel::kMaxReach));
    }
    kernel.reach = static_cast<int>(std::ceil(radius));
    if (kind == "quartic") {
        kernel.s = static_cast<float>(p[0]);
        kernel.min_factor = kernel.has_negative_lobes ? std::numeric_limits<float>::lowest() : 0.0f;
        kernel.inverse_radius2 = static_cast<float>(1 / (radius * radius));
    } else if (kind == "gaussian") {
        const double h = 1 / (2 * p[0] * p[0]), at_edge = exp_minus(radius * radius * h);
        tabulate(kernel, radius, [=](double r2) { return exp_minus(r2 * h) - at_edge; });
    } else if (kind == "lanczos") {
        const double first_zero = 1.2196698912665045, window = (first_zero / radius) * (first_zero / radius);
        tabulate(kernel, radius, [=](double r2) { return jinc(r2) * jinc(r2 * window); });
    } else if (kind == "box") {
        kernel.form = FilterKernel::Form::kBox;
    } else {
        const MitchellPieces m = mitchell_pieces(p[0], p[1]);
        if (kind == "mitchell") {
            tabulate(kernel, radius, [=](double r2) {
                const double r = std::sqrt(r2);
                return r < 1 ? evaluate(m.inner, r) : evaluate(m.outer, 2 - r);
            });
        } else {
            kernel.form = FilterKernel::Form::kSeparable;
            kernel.has_negative_lobes = true;
            std::ranges::copy(m.inner, kernel.inner);
            std::ranges::copy(m.outer, kernel.outer);
        }
    }
    lay_out_footprint(kernel);

    for (int a = 0; a <= 32; ++a) {
        for (int b = 0; b <= a; ++b) {  // record positions over one eighth of a pixel: the rest is symmetry
            double sum = 0;
            for (int y = -kernel.reach; y <= kernel.reach; ++y) {
                for (int x = -kernel.reach; x <= kernel.reach; ++x) sum += filter.weight(x - a / 64.0, y - b / 64.0);
            }
            if (!(sum > 1e-3))
                return usage_error(
                    fmt::format("--filter {}: too small or too sharp; its weights must have a positive sum "
                                "around every position",
                                text));
        }
    }
    return filter;
}

Filter Filter::standard() { return *parse("quartic"); }

double Filter::weight(double dx, double dy) const {
    const double r2 = dx * dx + dy * dy;
    switch (kernel_.form) {
        case FilterKernel::Form::kQuartic: {
            const double rho = std::sqrt(std::min(r2 * static_cast<double>(kernel_.inverse_radius2), 1.0));
            const double factor = 1 + rho * (2 + rho * static_cast<double>(kernel_.s));
            return (1 - rho) * (1 - rho) * std::max(factor, static_cast<double>(kernel_.min_factor));
        }
        case FilterKernel::Form::kTable: {
            const double t =
                std::min(r2 * static_cast<double>(kernel_.table_scale), static_cast<double>(FilterKernel::kTableSteps));
            const auto i = static_cast<std::size_t>(t);
            return static_cast<double>(kernel_.table_value[i]) +
                   (t - static_cast<double>(i)) * static_cast<double>(kernel_.table_step[i]);
        }
        case FilterKernel::Form::kSeparable: {
            const auto m = [&](double d) {
                d = std::abs(d);
                return d < 1 ? evaluate(kernel_.inner, d) : d < 2 ? evaluate(kernel_.outer, 2 - d) : 0.0;
            };
            return m(dx) * m(dy);
        }
        case FilterKernel::Form::kBox:
            return dx > -0.5 && dx <= 0.5 && dy > -0.5 && dy <= 0.5 ? 1.0 : 0.0;
    }
    return 0;
}

}  // namespace latent::develop
