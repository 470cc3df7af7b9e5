#include "tools/develop/lens/aperture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/option_parts.h"
#include "base/parse.h"
#include "color/power_of_ten.h"

namespace latent::develop {

namespace {

constexpr std::size_t kPointsAcross = 8;  // where an edge crosses a cell

class Opening {
 public:
    explicit Opening(const Aperture& a)
        : a_(a),
          blades_(a.blades, a.radius),
          has_rim_(a.radius < 1 || a.squeeze > 1 || a.blades.count > 0)  // else it is the disk itself, in which all points lie
    {}

    bool is_open(double x, double y) const {
        if (a_.half == Aperture::Half::kLeft ? x > 0 : a_.half == Aperture::Half::kRight && x < 0) return false;
        return !has_rim_ || blades_.inside(a_.squeeze * x, y) >= 0;
    }
    // Where it is open, in one direction: the product of both is the whole.
    double transmission(double along, double squeeze) const {
        if (!a_.gaussian) return 1;
        along *= squeeze;
        return color::power_of_e(-2 * along * along / (a_.radius * a_.radius));
    }

 private:
    const Aperture& a_;
    image::BladeOpening blades_;
    bool has_rim_;
};

// For the cell from (x, y) to (x, y) + side, by kPointsAcross x kPointsAcross points: how much of it lies in the disk, and
// how much of that is open. If it hardly touches the disk, how much of all is open.
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
    if (Status s = check_parts_differ(text); !s) return s.error();
    for (const std::string_view part : parts_of(text, ',')) {
        if (const Result<double> radius = parse_number(part)) {
            if (!(*radius > 0 && *radius <= 1))
                return is_not(part, fmt::format("a fraction of the rendered radius, above 0 and at most 1{}",
                                                *radius > 1 ? ": a wider lens must be rendered" : ""));
            aperture.radius = *radius;
            continue;
        }
        const std::optional<NamedNumbers> named = named_numbers(part);
        if (!named) return refuse(part);
        const std::vector<double>& n = named->numbers;
        if (named->name == "f" && n.size() == 1) {
            aperture.f_number = n[0];
            if (!(aperture.f_number > 0)) return is_not(part, "an f-number (try f:8)");
        } else if (named->name == "blades") {
            const Result<image::Blades> blades = image::parse_blades(*named, part);
            if (!blades) return blades.error();
            aperture.blades = *blades;
        } else if (named->name == "gaussian" && n.empty()) {
            aperture.gaussian = true;
        } else if (named->name == "anamorphic" && n.size() == 1) {
            aperture.squeeze = n[0];
            if (!(aperture.squeeze >= 1 && aperture.squeeze <= 4))
                return is_not(part, "a squeeze from 1 to 4 (try anamorphic:1.33)");
        } else if (named->name == "cat-eye" && n.size() == 1) {
            aperture.cat_eye = n[0];
            if (!(aperture.cat_eye >= 0 && aperture.cat_eye <= 1)) return is_not(part, "a cat's eye from 0 to 1 (try cat-eye:0.5)");
        } else if ((named->name == "left" || named->name == "right") && n.empty()) {
            if (aperture.half != Aperture::Half::kBoth) return is_not(text, "an aperture: it has two halves");
            aperture.half = named->name == "left" ? Aperture::Half::kLeft : Aperture::Half::kRight;
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
    const auto place = [](std::size_t corner) { return static_cast<double>(corner) * kSide - 1; };
    std::array<double, kLensCells> across{}, upwards{};
    for (std::size_t i = 0; i < kLensCells; ++i) {
        across[i] = opening.transmission(place(i) + kSide / 2, aperture.squeeze);
        upwards[i] = opening.transmission(place(i) + kSide / 2, 1);
    }
    // For a row of corners of cells: 1 where the lens is open, and where the disk is.
    struct Corners {
        std::array<int, kLensCells + 1> open{}, in_disk{};
    };
    const auto corners_at = [&](double y) {
        Corners corners;
        for (std::size_t i = 0; i <= kLensCells; ++i) {
            corners.open[i] = opening.is_open(place(i), y) ? 1 : 0;
            corners.in_disk[i] = place(i) * place(i) + y * y <= 1 ? 1 : 0;
        }
        return corners;
    };
    LensCells cells{std::vector<float>(kLensCells * kLensCells), std::vector<float>(kLensCells * kLensCells)};
    Corners lower = corners_at(-1);
    for (std::size_t row = 0; row < kLensCells; ++row) {
        const Corners upper = corners_at(place(row + 1));
        for (std::size_t i = 0; i < kLensCells; ++i) {
            const int open = lower.open[i] + lower.open[i + 1] + upper.open[i] + upper.open[i + 1],
                      in_disk = lower.in_disk[i] + lower.in_disk[i + 1] + upper.in_disk[i] + upper.in_disk[i + 1];
            const auto is_mixed = [](int corners) { return corners > 0 && corners < 4; };
            const Shares shares = is_mixed(open) || is_mixed(in_disk) ? shares_of(opening, place(i), place(row), kSide)
                                                                      : Shares{in_disk > 0 ? 1.0 : 0.0, open > 0 ? 1.0 : 0.0};
            const std::size_t cell = row * kLensCells + i;
            cells.area[cell] = static_cast<float>(shares.in_disk);
            cells.transmission[cell] = static_cast<float>(shares.open * across[i] * upwards[row]);
        }
        lower = upper;
    }
    return cells;
}

}  // namespace latent::develop
