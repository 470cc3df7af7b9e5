// color/difference.h: the visible difference of two colours.
#pragma once

#include "color/tristimulus.h"

namespace latent::color {

struct Lab {
    double l = 0, a = 0, b = 0;
};

// CIE 1976 L*a*b* [CIE15].
Lab lab_from_xyz(Xyz c, Xyz white);

// CIEDE2000 with kL = kC = kH = 1 [Sharma05]. Check: (50, 2.6772, -79.7751) and (50, 0, -82.7485) differ by 2.0425.
double ciede2000(Lab p, Lab q);

}  // namespace latent::color
