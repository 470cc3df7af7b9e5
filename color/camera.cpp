#include "color/camera.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "color/difference.h"
#include "color/named_spectra.h"
#include "color/tables.h"

namespace latent::color {
namespace {

using Vector3 = std::array<double, 3>;

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// What an observer sees of a patch under D65 of this luminance.
Vector3 seen(const Spectrum& patch, const Observer& observer, double luminance) {
    const auto light = [&](double nm) { return patch(nm) * illuminant_d65()(nm) / luminance; };
    const Xyz c = xyz_from_spectrum(Spectrum::from_function(light, Outside::kZero), observer);
    return {c.x, c.y, c.z};
}

}  // namespace

const std::vector<Spectrum>& color_checker() {
    static const std::vector<Spectrum> patches = [] {
        const Table& t = table("colorchecker_ohta1997_5nm");
        std::vector<Spectrum> all;
        for (const std::string_view column : t.columns.subspan(1)) {
            auto patch = Spectrum::from_samples(t.column("wavelength_nm"), t.column(column), Outside::kClamped);
            assert(patch);
            all.push_back(*std::move(patch));
        }
        return all;
    }();
    return patches;
}

Result<CameraFit> fit_camera(const Observer& camera) {
    const Observer& cie = Observer::cie1931();
    const Xyz daylight = xyz_from_spectrum(illuminant_d65(), cie);
    const Vector3 camera_white{1, 1, 1}, eye_white{daylight.x / daylight.y, 1, daylight.z / daylight.y};
    std::vector<Vector3> by_camera, by_eye;
    Matrix3 auto_covariance{{}}, cross_covariance{{}};
    for (const Spectrum& patch : color_checker()) {
        const Vector3 c = seen(patch, camera, daylight.y), e = seen(patch, cie, daylight.y);
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
                auto_covariance.m[a][b] += c[a] * c[b];
                cross_covariance.m[a][b] += e[a] * c[b];
            }
        }
        by_camera.push_back(c);
        by_eye.push_back(e);
    }
    if (!auto_covariance.invertible()) {
        return Error{ErrorCode::kOutOfRange,
                     "the responses r, g and b of a camera must differ, or they cannot distinguish colours"};
    }
    // Row a: least squares, moved along the direction that costs least until M camera_white = eye_white.
    const Matrix3 inverse = auto_covariance.inverse();
    const Vector3 direction = inverse * camera_white;
    CameraFit fit{};
    for (int a = 0; a < 3; ++a) {
        const Vector3 free = inverse * cross_covariance.m[a];
        const double amount = (eye_white[a] - dot(free, camera_white)) / dot(direction, camera_white);
        for (int b = 0; b < 3; ++b) fit.xyz_from_rgb.m[a][b] = free[b] + amount * direction[b];
    }
    const Xyz white{eye_white[0], eye_white[1], eye_white[2]};
    const auto lab = [&](const Vector3& v) { return lab_from_xyz({v[0], v[1], v[2]}, white); };
    for (std::size_t i = 0; i < by_eye.size(); ++i) {
        const double difference = ciede2000(lab(fit.xyz_from_rgb * by_camera[i]), lab(by_eye[i]));
        fit.mean_difference += difference / static_cast<double>(by_eye.size());
        fit.largest_difference = std::max(fit.largest_difference, difference);
    }
    return fit;
}

}  // namespace latent::color
