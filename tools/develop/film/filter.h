// tools/develop/film/filter.h: how much a record counts for the pixels around it. Equations: docs/developing.md, "Filters".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace latent::develop {

// What the kernels need to weigh a record, in float32 and without libm, so that every processor gets the same bits. A record whose
// position is (j + g - 1/2) pixels, 0 <= g < 1, reaches the 2n columns j - n .. j + n - 1, at the distances k - n + 1 - g.
struct FilterKernel {
    enum class Form : std::uint8_t {
        kQuartic,    // (1 - rho)^2 (1 + 2 rho + s rho^2), rho = min(r / R, 1)
        kTable,      // a function of r^2, linear between kTableSteps equal steps up to R^2
        kSeparable,  // m(dx) m(dy), m piecewise cubic
        kBox,        // the pixel's own square
    };
    static constexpr int kMaxReach = 8;
    static constexpr int kTableSteps = 16384;

    Form form = Form::kQuartic;
    int reach = 2;                     // n
    bool has_negative_lobes = false;   // some weights may be negative
    float s = 0, inverse_radius2 = 0;  // kQuartic
    float min_factor = 0;              // kQuartic: the second factor is no less; if s >= -3, rounding makes it no less than 0
    float table_scale = 0;             // kTable: steps per pixel^2
    std::vector<float> table_value, table_step;  // kTable: w = value[i] + f step[i]
    float inner[4] = {}, outer[4] = {};          // kSeparable: cubics in d < 1 and in 2 - d <= 1, constant term first

    // A footprint of 4 x 4 pixels of which a row and a column always have weight 0 is covered as 3 x 3 pixels, for a record at
    // (j + g - 1) with columns j - 1 .. j + 1, at the distances k - 1/2 - g. Sums are the same to the bit.
    int covered = 4;                 // pixels along each side of what is added up: 2n, or 3 where n = 2 and R <= 1.5
    std::vector<float> column, row;  // distances where g = 0, of all pixels that are covered, padded with far pixels to 16

    int side() const { return 2 * reach; }
};

class Filter {
 public:
    // "quartic:s,R", "mitchell:B,C", "mitchell-separable:B,C", "gaussian:sigma,R", "lanczos" or "box"; parameters may be left out.
    // Errors: kUsage, saying which names and ranges there are. Filters whose weights sum to zero or less around some position
    // are refused: light records could not be normalised.
    static Result<Filter> parse(std::string_view text);
    static Filter standard();  // quartic:-3,1.5

    const std::string& name() const { return name_; }  // with all parameters: "quartic:-3,1.5"
    const std::optional<std::string>& warning() const { return warning_; }
    int reach() const { return kernel_.reach; }
    const FilterKernel& kernel() const { return kernel_; }

    // w(dx, dy) in double precision, distances in pixels from the record to the pixel centre.
    double weight(double dx, double dy) const;

 private:
    std::string name_;
    std::optional<std::string> warning_;
    FilterKernel kernel_;
};

}  // namespace latent::develop
