// tools/develop/lens/shutter.h: when a shutter is open, as --shutter describes it. docs/developing.md, "Shutter".
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace latent::develop {

// Times run from 0 to 1, over the exposure that was rendered or, of a sequence, over that of the frame.
struct Shutter {
    std::vector<std::array<double, 2>> intervals{};  // in order, apart from each other; none: all the time
    std::string curve{};                             // transmission over each interval: "soft", "film", FILE.csv; "": 1
    double rolling = 0;                              // the part of the time by which the last row is later than the first; < 1
    std::uint32_t frame = 0, frames = 1;             // the frame of a sequence that divides the rendered exposure

    bool is_whole() const { return *this == Shutter{}; }
    bool operator==(const Shutter&) const = default;
};

// "0.2:0.5", "0:0.25,0.75:1", "soft", "film", "FILE.csv", "rolling:0.5", or several with commas between them. Errors: kUsage.
Result<Shutter> parse_shutter(std::string_view text);

// The light that a shutter lets pass up to a time, as a fraction of what passes without one, for rows that are exposed from 0 to 1.
class ShutterCurve {
 public:
    // Errors: of the curve's file; kUsage: it never opens.
    static Result<ShutterCurve> make(const Shutter& shutter);

    // until(0) = 0; rising.
    double until(double time) const {
        const double at = std::clamp(time, 0.0, 1.0) * kSteps;
        const int step = static_cast<int>(at);
        const double* const passed = passed_.data() + step;
        return passed[0] + (at - step) * (passed[1] - passed[0]);
    }
    double all() const { return passed_.back(); }

 private:
    static constexpr int kSteps = 4096;
    std::vector<double> passed_;  // at equally spaced times; the last one twice
};

}  // namespace latent::develop
