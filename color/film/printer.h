// color/film/printer.h: the enlarger, and how a print looks. Equations: docs/color.md, "Film".
#pragma once

#include <span>

#include "color/film/stock.h"

namespace latent::film {

// Densities of the yellow, magenta and cyan filter, and log10 of the time.
struct Pack {
    Triple ymc{};
    double log_time = 0;
};

// How a print material, or a slide, is looked at.
struct Viewing {
    Curve light;  // Y = 1
    double aim;   // Y of a grey card in a print, relative to `light`
};
Viewing viewing_of(Kind kind);

// XYZ relative to the light (a perfect diffuser, or no film at all, has Y = 1).
Triple seen(const Stock& stock, const Viewing& viewing, const Triple& amounts);
// Amounts with the chromaticity of the base at luminance Y.
Triple neutral_amounts(const Stock& stock, const Viewing& viewing, double y);
// log10 exposures to add to the layers of a slide, so that a grey card (exposed with `grey`, log10) is neutral at its own Y.
Triple neutral_shift(const Stock& slide, const Triple& grey);

// Light through a negative or slide onto a print material. Holds no reference to what it was made of.
class Printer {
 public:
    // The pack, one of its filters 0, that prints `grey` (spectral density) neutral at the aim.
    Printer(const Stock& paper, const Curve& grey);

    // Contrasts of the red- and the blue-sensitive layer about the aim that make these greys most neutral.
    void trim_to(const Stock& paper, std::span<const Curve> greys);
    // Other filters; the time is such that the green-sensitive layer keeps its aim.
    void use(const Triple& ymc, const Stock& paper, const Curve& grey);

    const Pack& pack() const { return pack_; }
    const Triple& trim() const { return trim_; }
    const Triple& aim() const { return aim_; }     // log10 exposures of the layers for a grey card
    const Curve& light() const { return light_; }  // behind the filters, times the time
    // log10 exposures of the layers, trimmed.
    Triple exposures(const Stock& paper, const Curve& density) const;

 private:
    void set(const Pack& pack);
    Pack pack_;
    Curve light_;
    Triple aim_, trim_{1, 1, 1};
};

}  // namespace latent::film
