#include "color/tristimulus.h"

#include <cassert>
#include <cmath>

namespace latent::color {

std::array<double, 3> Matrix3::operator*(const std::array<double, 3>& v) const {
    std::array<double, 3> out{};
    for (int i = 0; i < 3; ++i) out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    return out;
}

Matrix3 Matrix3::operator*(const Matrix3& right) const {
    Matrix3 out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) out.m[i][j] = m[i][0] * right.m[0][j] + m[i][1] * right.m[1][j] + m[i][2] * right.m[2][j];
    }
    return out;
}

Matrix3 Matrix3::operator*(double factor) const {
    Matrix3 out = *this;
    for (auto& row : out.m) {
        for (double& value : row) value *= factor;
    }
    return out;
}

Matrix3 Matrix3::transposed() const {
    Matrix3 out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) out.m[i][j] = m[j][i];
    }
    return out;
}

double Matrix3::determinant() const {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

bool Matrix3::invertible() const {
    double volume = 1;
    for (const auto& row : m) volume *= std::sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
    const double det = determinant();
    return std::isfinite(det) && std::isfinite(volume) && std::abs(det) > 1e-12 * volume;
}

Matrix3 Matrix3::inverse() const {
    assert(invertible());
    const double inverse_determinant = 1 / determinant();
    Matrix3 out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {  // the cofactor of (j, i); indices modulo 3 carry its sign
            const int r0 = (j + 1) % 3, r1 = (j + 2) % 3, c0 = (i + 1) % 3, c1 = (i + 2) % 3;
            out.m[i][j] = (m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0]) * inverse_determinant;
        }
    }
    return out;
}

}  // namespace latent::color
