// color/tristimulus.h: the small value types of colour: chromaticities, tristimulus values, 3x3 matrices. Equations: docs/color.md.
#pragma once

#include <array>

namespace latent::color {

// CIE xy of some observer (1931 2-degree unless said otherwise).
struct Chromaticity {
    double x = 0, y = 0;
    bool operator==(const Chromaticity&) const = default;
};

struct Xyz {
    double x = 0, y = 0, z = 0;
};

// Linear RGB of some space; 1 is its white.
struct Rgb {
    double r = 0, g = 0, b = 0;
};

inline Chromaticity chromaticity(Xyz c) {
    const double sum = c.x + c.y + c.z;
    return {c.x / sum, c.y / sum};
}
// The colour of chromaticity `xy` with Y = 1.
inline Xyz xyz_from_chromaticity(Chromaticity xy) { return {xy.x / xy.y, 1, (1 - xy.x - xy.y) / xy.y}; }

// Row-major 3x3 matrix.
struct Matrix3 {
    std::array<std::array<double, 3>, 3> m{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

    std::array<double, 3> operator*(const std::array<double, 3>& v) const;
    Matrix3 operator*(const Matrix3& right) const;
    Matrix3 operator*(double factor) const;
    Matrix3 transposed() const;
    double determinant() const;
    // True if the determinant is finite and not lost in rounding: |det| > 1e-12 x the product of the rows' lengths.
    bool invertible() const;
    Matrix3 inverse() const;  // the matrix must be invertible
    bool operator==(const Matrix3&) const = default;
};

}  // namespace latent::color
