// tools/develop/lens/recorded_lens.h: the lens of the camera that took the samples, as their files tell. docs/format.md,
// "Registry".
#pragma once

#include <array>

#include "base/result.h"
#include "sampledb/read/run_set.h"

namespace latent::develop {

// Lengths in the units of the scene. The ray of film point (u, v) through point l of the unit disk starts at radius l and goes
// along
//   (x0 + u (x1 - x0), y1 + v (y0 - y1), 1) - (radius l / focus, 0)
// in the camera's x (to the right), y (upwards) and z (forward).
struct RecordedLens {
    double radius = 0, focus = 0;  // distance in focus, along z
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    // Where a ray meets the film is moved by so much (u, v), times its point l, if the lens is focused at another distance.
    std::array<double, 2> film_shift(double distance) const {
        const double shift = radius * (1 / distance - 1 / focus);
        return {shift / (x1 - x0), shift / (y0 - y1)};
    }
    // Distance along z of the point at `depth` from l on that ray.
    double distance(double u, double v, const std::array<double, 2>& l, double depth) const;
    // That of a camera with the same angle of view whose film is 36 mm wide, or high if it is higher; scenes in metres.
    double f_number() const;
};
// Errors: kUsage, beginning with `option`: no file tells; of reading.
Result<RecordedLens> recorded_lens(const sampledb::RunSet& run_set, const char* option);

}  // namespace latent::develop
