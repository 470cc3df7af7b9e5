#include "color/camera.h"

#include <array>
#include <cmath>
#include <cstdlib>

#include "color/named_spectra.h"
#include "color/observer.h"

namespace latent::color {
namespace {

using Vector3 = std::array<double, 3>;

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// D65 as seen by three curves, nm by nm.
std::vector<Vector3> seen_daylight(const std::array<Spectrum, 3>& curves) {
    std::vector<Vector3> out(kIntegerNmCount);
    for (int i = 0; i < kIntegerNmCount; ++i) {
        for (int c = 0; c < 3; ++c) out[i][c] = curves[c](kLambdaMin + i) * illuminant_d65()(kLambdaMin + i);
    }
    return out;
}

}  // namespace

Result<Matrix3> xyz_from_camera(const std::array<Spectrum, 3>& responses) {
    // e^(-distance / 80 nm), by multiplications alone: no libm decides a bit of a picture.
    constexpr double kCorrelation = 0.98757780049388141;
    std::array<double, kIntegerNmCount> correlation_at{1};
    for (int i = 1; i < kIntegerNmCount; ++i) correlation_at[i] = correlation_at[i - 1] * kCorrelation;
    const Observer& cie = Observer::cie1931();
    const std::vector<Vector3> camera = seen_daylight(responses), eye = seen_daylight({cie.curve(0), cie.curve(1), cie.curve(2)});
    // Covariances of what both see of random reflectances: camera with camera, eye with camera; and their whites.
    Matrix3 auto_covariance{{}}, cross_covariance{{}};
    Vector3 camera_white{}, eye_white{};
    for (int i = 0; i < kIntegerNmCount; ++i) {
        for (int j = 0; j < kIntegerNmCount; ++j) {
            const double correlation = correlation_at[std::abs(i - j)];
            for (int a = 0; a < 3; ++a) {
                for (int b = 0; b < 3; ++b) {
                    auto_covariance.m[a][b] += correlation * camera[i][a] * camera[j][b];
                    cross_covariance.m[a][b] += correlation * eye[i][a] * camera[j][b];
                }
            }
        }
        for (int a = 0; a < 3; ++a) {
            camera_white[a] += camera[i][a];
            eye_white[a] += eye[i][a];
        }
    }
    if (!auto_covariance.invertible()) {
        return Error{ErrorCode::kOutOfRange,
                     "the responses r, g and b of a camera must differ, or they cannot distinguish colours"};
    }
    // Row a: least squares, moved along the direction that costs least until M camera_white = eye_white.
    const Matrix3 inverse = auto_covariance.inverse();
    const Vector3 direction = inverse * camera_white;
    Matrix3 out;
    for (int a = 0; a < 3; ++a) {
        const Vector3 free = inverse * cross_covariance.m[a];
        const double amount = (eye_white[a] - dot(free, camera_white)) / dot(direction, camera_white);
        for (int b = 0; b < 3; ++b) out.m[a][b] = free[b] + amount * direction[b];
    }
    return out;
}

}  // namespace latent::color
