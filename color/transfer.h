// color/transfer.h: transfer functions between linear light and encoded values, exact in double. Equations: docs/color.md.
#pragma once

namespace latent::color {

// Encoding of one channel, increasing on [0,1] with 0 -> 0 and 1 -> 1; odd-symmetric below 0 and continued above 1.
//   encoded = slope x                      for |x| < linear_below
//   encoded = scale x^exponent - (scale-1) otherwise
// Covers sRGB, Rec.2020, pure powers (slope 0, linear_below 0, scale 1) and the identity (exponent 1).
struct Transfer {
    double slope = 0, linear_below = 0, scale = 1, exponent = 1;

    static Transfer linear() { return {}; }
    static Transfer srgb();     // [IEC61966-2-1]; also Display P3
    static Transfer rec2020();  // [BT2020], alpha and beta to full precision; same curve as BT.709
    static Transfer gamma(double gamma) { return {0, 0, 1, 1 / gamma}; }  // Adobe RGB (1998): 563/256 [AdobeRGB]

    bool operator==(const Transfer&) const = default;
    bool is_linear() const { return exponent == 1; }
    double encode(double linear_value) const;
    double decode(double encoded_value) const;
};

}  // namespace latent::color
