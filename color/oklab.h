// color/oklab.h: lightness, chroma and hue as people see them [Ottosson20].
#pragma once

#include "color/tristimulus.h"

namespace latent::color {

struct Oklab {
    double lightness = 0, a = 0, b = 0;
    double chroma() const;
    double hue_degrees() const;  // -180..180
};

// `c` is relative to D65 with Y = 1. Check: (0.950, 1, 1.089) is (1, 0, 0), (1, 0, 0) is (0.450, 1.236, -0.019).
Oklab oklab_from_xyz(Xyz c);

}  // namespace latent::color
