#include "color/difference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace latent::color {

Lab lab_from_xyz(Xyz c, Xyz white) {
    const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : 841.0 / 108 * t + 4.0 / 29; };
    const double x = f(c.x / white.x), y = f(c.y / white.y), z = f(c.z / white.z);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double ciede2000(Lab p, Lab q) {
    constexpr double kDegree = std::numbers::pi / 180;
    const auto seventh = [](double c) {
        const double c7 = std::pow(c, 7);
        return std::sqrt(c7 / (c7 + 6103515625.0));  // 25^7
    };
    const auto hue = [](double a, double b) {
        const double h = a == 0 && b == 0 ? 0 : std::atan2(b, a) / kDegree;
        return h < 0 ? h + 360 : h;
    };
    const double g = 0.5 * (1 - seventh(0.5 * (std::hypot(p.a, p.b) + std::hypot(q.a, q.b))));
    const double ap = (1 + g) * p.a, aq = (1 + g) * q.a;
    const double cp = std::hypot(ap, p.b), cq = std::hypot(aq, q.b), hp = hue(ap, p.b), hq = hue(aq, q.b);
    const bool grey = cp * cq == 0, around = std::abs(hq - hp) > 180;
    const double turn = grey ? 0 : !around ? hq - hp : hq > hp ? hq - hp - 360 : hq - hp + 360;
    const double mean_h = grey            ? hp + hq
                          : !around       ? 0.5 * (hp + hq)
                          : hp + hq < 360 ? 0.5 * (hp + hq + 360)
                                          : 0.5 * (hp + hq - 360);
    const double dl = q.l - p.l, dc = cq - cp, dh = 2 * std::sqrt(cp * cq) * std::sin(0.5 * turn * kDegree);
    const double mean_l = 0.5 * (p.l + q.l), mean_c = 0.5 * (cp + cq);
    const auto cosine = [](double degrees) { return std::cos(degrees * kDegree); };
    const double t =
        1 - 0.17 * cosine(mean_h - 30) + 0.24 * cosine(2 * mean_h) + 0.32 * cosine(3 * mean_h + 6) - 0.20 * cosine(4 * mean_h - 63);
    const double l50 = (mean_l - 50) * (mean_l - 50), off = (mean_h - 275) / 25;
    const double sl = 1 + 0.015 * l50 / std::sqrt(20 + l50), sc = 1 + 0.045 * mean_c, sh = 1 + 0.015 * mean_c * t;
    const double rt = -2 * seventh(mean_c) * std::sin(60 * std::exp(-off * off) * kDegree);
    const double l = dl / sl, c = dc / sc, h = dh / sh;
    return std::sqrt(std::max(0.0, l * l + c * c + h * h + rt * c * h));
}

}  // namespace latent::color
