// image/fourier.h: Fourier transforms of square arrays, for convolutions. Equations: docs/color.md, "Light that spreads".
#pragma once

#include <cstddef>
#include <vector>

namespace latent::image {

// In place, on any threads; the same bits for any number of them and on every processor.
class SquareFourier {
 public:
    explicit SquareFourier(int size);  // along a side; a power of two, 16 to 8192

    int size() const { return size_; }
    // From `size * size` complex numbers to their spectrum, whose frequencies are in bit-reversed order along both axes.
    void forward(float* re, float* im) const;
    // Back, times size^2.
    void inverse(float* re, float* im) const;

    // `place`: that of a frequency in that order. The place of its negative; the frequency itself (0 .. size - 1).
    static int negative(int place);
    int frequency(int place) const;

 private:
    template <bool kForward>
    void along_both(float* re, float* im) const;

    int size_;
    std::vector<float> cos_, sin_;  // at 2 pi k / size
};

}  // namespace latent::image
