// color/visible_density.h: the density of wavelengths when no lamp has lines: that of the eye's response.
#pragma once

namespace latent::color {

// p(lambda) = 0.0039398042 / cosh^2(0.0072 (lambda - 538)) on 360..830 nm, 0 outside [1/nm]: near the product of the CIE curves'
// sum and daylight, with a closed-form integral. Source: [RBA09].
double visible_pdf_lambda(double lambda_nm);
// Its integral from 360 nm: 0 at 360, 1 at 830 (the normalising constant is computed, not rounded).
double visible_cdf(double lambda_nm);

}  // namespace latent::color
