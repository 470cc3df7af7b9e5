// color/film/push.h: longer development, in stops. Densities above the base D(h) become c D(h + s): docs/color.md, "Film".
#pragma once

namespace latent::film {

inline double push_speed(double stops) { return 0.1 * stops; }          // s, log10 exposure
inline double push_contrast(double stops) { return 1 + 0.15 * stops; }  // c; and of the grain

}  // namespace latent::film
