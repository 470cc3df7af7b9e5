// tools/darkroom/engine/measures.h: numbers about views. docs/darkroom_api.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace latent::darkroom {

// How often each code value of a print occurs in red, green and blue (or three times in grey), and what it could not show.
struct Histogram {
    std::array<std::array<std::uint64_t, 256>, 3> counts{};
    std::uint64_t pixels = 0, burnt = 0, black = 0, out_of_gamut = 0;
};

// A pixel of a size, before noise is removed from it.
struct Probe {
    std::string observer;  // whose values they are; X, Y, Z of cie1931
    std::array<double, 3> values{}, standard_errors{};
    std::array<int, 3> codes{};  // in the print
    double samples = 0;          // that reach it
};

// The light of a pixel as a spectrum, as it is mixed and passes the lens, before filters and noise removal: mean spectral radiance
// of bins of equal width, in W m^-2 sr^-1 nm^-1.
struct ProbedSpectrum {
    double from_nm = 0, to_nm = 0;
    std::vector<double> values, standard_errors;
    double samples = 0;  // that reach the pixel
};

}  // namespace latent::darkroom
