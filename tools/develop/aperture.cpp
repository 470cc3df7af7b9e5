#include "tools/develop/aperture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/parse.h"
#include "color/power_of_ten.h"
#include "tools/develop/option_parts.h"

namespace latent::develop {

namespace {

constexpr std::size_t kPointsAcross = 8;  // of a cell on an edge

// By their series: the bits of the library's functions depend on its version.
std::array<double, 2> cos_sin_of_degrees(double degrees) {
    const double turns = degrees / 360, x = (turns - std::round(turns)) * 6.283185307179586;
    std::array<double, 2> sums{};
    double term = 1;  // x^i / i!
    for (int i = 0; i < 30; ++i) {
        sums[static_cast<std::size_t>(i % 2)] += i % 4 < 2 ? term : -term;
        term *= x / (i + 1);
    }
    return sums;
}

class Opening {
 public:
    explicit Opening(const Aperture& a) : a_(a) {
        for (std::uint32_t i = 0; i < a.blades; ++i)
            normals_.push_back(cos_sin_of_degrees(a.rotation_degrees + (i + 0.5) * 360 / a.blades));
        if (a.blades > 0) apothem_ = a.radius * cos_sin_of_degrees(180.0 / a.blades)[0];
        has_rim_ = a.radius < 1 || a.squeeze > 1 || a.blades > 0;  // else it is the disk itself, in which all points lie
    }

    bool is_open(double x, double y) const {
        if (a_.half == Aperture::Half::kLeft ? x > 0 : a_.half == Aperture::Half::kRight && x < 0) return false;
        x *= a_.squeeze;
        const double r2 = x * x + y * y;
        if (has_rim_ && r2 > a_.radius * a_.radius) return false;
        if (normals_.empty()) return true;
        double along = 0;
        for (const std::array<double, 2>& n : normals_) along = std::max(along, n[0] * x + n[1] * y);
        if (a_.curvature == 0) return along <= apothem_;
        return (1 - a_.curvature) * along / apothem_ + a_.curvature * std::sqrt(r2) / a_.radius <= 1;
    }
    // Where it is open.
    double transmission(double x, double y) const {
        if (!a_.gaussian) return 1;
        x *= a_.squeeze;
        return color::power_of_e(-2 * (x * x + y * y) / (a_.radius * a_.radius));
    }

 private:
    const Aperture& a_;
    std::vector<std::array<double, 2>> normals_;  // of the blades' edges
    double apothem_ = 1;
    bool has_rim_ = false;
};

// Of a cell that lies from (x, y) to (x, y) + side, by kPointsAcross x kPointsAcross points: how much of it lies in the disk, and
// how much of that is open; of a cell that hardly touches the disk, how much of all.
struct Shares {
    double in_disk, open;
};
Shares shares_of(const Opening& opening, double x, double y, double side) {
    double open = 0, in_disk = 0, both = 0;
    constexpr double kStep = 1.0 / kPointsAcross, kPoints = kPointsAcross * kPointsAcross;
    for (std::size_t i = 0; i < kPointsAcross * kPointsAcross; ++i) {
        const double px = x + side * kStep * (static_cast<double>(i % kPointsAcross) + 0.5),
                     py = y + side * kStep * (static_cast<double>(i / kPointsAcross) + 0.5);
        const bool is_open = opening.is_open(px, py), is_in_disk = px * px + py * py <= 1;
        open += is_open ? 1 : 0;
        in_disk += is_in_disk ? 1 : 0;
        both += is_open && is_in_disk ? 1 : 0;
    }
    return {in_disk / kPoints, in_disk > 0 ? both / in_disk : open / kPoints};
}

Result<Aperture> refuse(std::string_view part) {
    return is_not(part, "part of an aperture (try 0.35, f:8, blades:6, gaussian, anamorphic:1.33, cat-eye:0.5, left or right)");
}

}  // namespace

Result<Aperture> parse_aperture(std::string_view text) {
    Aperture aperture;
    for (const std::string_view part : parts_of(text, ',')) {
        if (const Result<double> radius = parse_number(part)) {
            if (!(*radius > 0 && *radius <= 1))
                return is_not(part, "a fraction of the rendered radius, above 0 and at most 1: a wider lens must be rendered");
            aperture.radius = *radius;
            continue;
        }
        const std::optional<NamedNumbers> named = named_numbers(part);
        if (!named) return refuse(part);
        const std::vector<double>& n = named->numbers;
        if (named->name == "f" && n.size() == 1) {
            aperture.f_number = n[0];
            if (!(aperture.f_number > 0)) return is_not(part, "an f-number (try f:8)");
        } else if (named->name == "blades" && !n.empty() && n.size() <= 3) {
            if (!(n[0] >= 3 && n[0] <= 64) || n[0] != std::floor(n[0])) return is_not(part, "3 to 64 blades (try blades:6)");
            aperture.blades = static_cast<std::uint32_t>(n[0]);
            if (n.size() > 1) aperture.rotation_degrees = n[1];
            if (n.size() > 2) aperture.curvature = n[2];
            if (!(std::abs(aperture.rotation_degrees) <= 360)) return is_not(part, "a rotation of -360 to 360 degrees");
            if (!(aperture.curvature >= 0 && aperture.curvature <= 1))
                return is_not(part, "a curvature from 0 (straight) to 1 (a circle)");
        } else if (named->name == "gaussian" && n.empty()) {
            aperture.gaussian = true;
        } else if (named->name == "anamorphic" && n.size() == 1) {
            aperture.squeeze = n[0];
            if (!(aperture.squeeze >= 1 && aperture.squeeze <= 4))
                return is_not(part, "a squeeze from 1 to 4 (try anamorphic:1.33)");
        } else if (named->name == "cat-eye" && n.size() == 1) {
            aperture.cat_eye = n[0];
            if (!(aperture.cat_eye >= 0 && aperture.cat_eye <= 1)) return is_not(part, "a cat's eye from 0 to 1 (try cat-eye:0.5)");
        } else if (named->name == "left" && n.empty()) {
            aperture.half = Aperture::Half::kLeft;
        } else if (named->name == "right" && n.empty()) {
            aperture.half = Aperture::Half::kRight;
        } else {
            return refuse(part);
        }
    }
    if (aperture.radius < 1 && aperture.f_number > 0) return is_not(text, "an aperture: it has two radii");
    return aperture;
}

LensCells cells_of(const Aperture& aperture) {
    const Opening opening(aperture);
    constexpr double kSide = 2.0 / kLensCells;
    constexpr int kCorners = 4;
    LensCells cells{std::vector<float>(kLensCells * kLensCells), std::vector<float>(kLensCells * kLensCells)};
    for (std::size_t cell = 0; cell < cells.area.size(); ++cell) {
        const double x = static_cast<double>(cell % kLensCells) * kSide - 1, y = static_cast<double>(cell / kLensCells) * kSide - 1;
        int open = 0, in_disk = 0;
        for (int i = 0; i < kCorners; ++i) {
            const double px = x + kSide * (i % 2), py = y + kSide * (i / 2);
            open += opening.is_open(px, py) ? 1 : 0;
            in_disk += px * px + py * py <= 1 ? 1 : 0;
        }
        const auto is_mixed = [](int corners) { return corners > 0 && corners < kCorners; };
        const Shares shares = is_mixed(open) || is_mixed(in_disk) ? shares_of(opening, x, y, kSide)
                                                                  : Shares{in_disk > 0 ? 1.0 : 0.0, open > 0 ? 1.0 : 0.0};
        cells.area[cell] = static_cast<float>(shares.in_disk);
        if (shares.open > 0)
            cells.transmission[cell] = static_cast<float>(shares.open * opening.transmission(x + kSide / 2, y + kSide / 2));
    }
    return cells;
}

}  // namespace latent::develop
