// color/power_of_ten.h: powers and logarithms without libm, whose last bit may depend on the processor: observers decide pixels.
#pragma once

namespace latent::color {

double power_of_ten(double x);  // to about 1e-15; 0 or infinite where a double is
double power_of_e(double x);
double log10_of(double x);  // x > 0; to about 1e-16

}  // namespace latent::color
