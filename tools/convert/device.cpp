#include "tools/convert/device.h"

#include <lcms2.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "color/difference.h"
#include "tools/convert/lcms.h"

namespace latent::convert {

namespace {

// Codes whose decoding curves were measured at 65536 places; found by bisection.
class Curves final : public DeviceTransform {
 public:
    explicit Curves(const std::array<const void*, 3>& curves) {
        for (std::size_t c = 0; c < 3; ++c) {
            const auto* curve = static_cast<const cmsToneCurve*>(curves[c]);
            float last = 0;
            for (int i = 0; i < kPlaces; ++i)  // never falls, whatever a file says
                decoded_[c].push_back(last = std::max(last, cmsEvalToneCurveFloat(curve, static_cast<float>(i) / (kPlaces - 1))));
        }
    }

    void apply(const std::array<std::span<float>, 3>& rgb, std::span<float>) const override {
        for (std::size_t c = 0; c < 3; ++c) {
            for (float& v : rgb[c]) v = code_of(decoded_[c], v);
        }
    }

 private:
    static constexpr int kPlaces = 65536;

    static float code_of(const std::vector<float>& decoded, float light) {
        const auto above = std::ranges::upper_bound(decoded, light);
        if (above == decoded.begin()) return 0;  // NaN too
        if (above == decoded.end()) return 1;
        const float below = *(above - 1), part = (light - below) / (*above - below);
        return (static_cast<float>(above - decoded.begin() - 1) + part) / (kPlaces - 1);
    }

    std::array<std::vector<float>, 3> decoded_;
};

struct DeleteTransform {
    void operator()(void* transform) const { cmsDeleteTransform(transform); }
};

class Lcms final : public DeviceTransform {
 public:
    Lcms(cmsHTRANSFORM transform, int channels) : transform_(transform), channels_(channels) {}

    int channels() const override { return channels_; }

    void apply(const std::array<std::span<float>, 3>& rgb, std::span<float> fourth) const override {
        constexpr std::size_t kAtOnce = 256;
        const std::array<std::span<float>, 4> planes{rgb[0], rgb[1], rgb[2], fourth};
        const auto n = static_cast<std::size_t>(channels_);
        const float whole = channels_ == 4 ? 100.0f : 1.0f;  // inks are percentages
        std::array<float, 3 * kAtOnce> pixels;
        std::array<float, 4 * kAtOnce> codes;
        for (std::size_t first = 0; first < rgb[0].size(); first += kAtOnce) {
            const std::size_t count = std::min(kAtOnce, rgb[0].size() - first);
            for (std::size_t i = 0; i < 3 * count; ++i) {
                const float v = rgb[i % 3][first + i / 3];
                pixels[i] = v >= 0 ? std::min(v, 1.0f) : 0;  // NaN too
            }
            cmsDoTransform(transform_.get(), pixels.data(), codes.data(), static_cast<cmsUInt32Number>(count));
            for (std::size_t i = 0; i < n * count; ++i) planes[i % n][first + i / n] = std::clamp(codes[i] / whole, 0.0f, 1.0f);
        }
    }

 private:
    std::unique_ptr<void, DeleteTransform> transform_;
    int channels_;
};

cmsUInt32Number flags_of(const Rendering& rendering) {
    return cmsFLAGS_NOCACHE | cmsFLAGS_NOOPTIMIZE | (rendering.compensates() ? cmsFLAGS_BLACKPOINTCOMPENSATION : 0);
}

class RoundTrip final : public DeviceGamut {
 public:
    RoundTrip(cmsHTRANSFORM transform, const std::array<double, 3>& black) : to_lab_(transform), black_(black) {}

    std::size_t find_lacking(const std::array<std::span<const float>, 3>& rgb, std::span<std::uint8_t> lacking) const override {
        constexpr std::size_t kAtOnce = 256;
        const color::Matrix3& to_xyz = table_space().xyz_from_rgb;
        const std::array<double, 3> white = to_xyz * std::array{1.0, 1.0, 1.0};
        std::array<float, 3 * kAtOnce> pixels, printed;
        std::size_t found = 0;
        for (std::size_t first = 0; first < rgb[0].size(); first += kAtOnce) {
            const std::size_t count = std::min(kAtOnce, rgb[0].size() - first);
            for (std::size_t i = 0; i < 3 * count; ++i) pixels[i] = rgb[i % 3][first + i / 3];
            cmsDoTransform(to_lab_.get(), pixels.data(), printed.data(), static_cast<cmsUInt32Number>(count));
            for (std::size_t i = 0; i < count; ++i) {
                const auto from = [&](std::size_t c) { return static_cast<double>(pixels[3 * i + c]); };
                const auto to = [&](std::size_t c) { return static_cast<double>(printed[3 * i + c]); };
                std::array<double, 3> xyz = to_xyz * std::array{from(0), from(1), from(2)};
                for (std::size_t c = 0; c < 3; ++c) xyz[c] = black_[c] + xyz[c] * (1 - black_[c] / white[c]);
                const color::Lab lab = color::lab_from_xyz({xyz[0], xyz[1], xyz[2]}, {white[0], white[1], white[2]});
                const bool lacks = !(std::hypot(lab.l - to(0), lab.a - to(1), lab.b - to(2)) <= kMax);
                lacking[first + i] = lacks;
                found += lacks;
            }
        }
        return found;
    }

 private:
    std::unique_ptr<void, DeleteTransform> to_lab_;
    std::array<double, 3> black_;
};

}  // namespace

std::string_view name_of(Intent intent) {
    constexpr std::string_view kNames[] = {"perceptual", "relative", "saturation", "absolute"};
    return kNames[static_cast<std::size_t>(intent)];
}

const color::RgbSpace& table_space() {
    static const color::RgbSpace space = [] {
        const color::Primaries romm{{0.7347, 0.2653}, {0.1596, 0.8404}, {0.0366, 0.0001}, {0.3457, 0.3585}};
        auto made = color::RgbSpace::from_primaries("ICC profile", romm, color::Transfer::linear());
        assert(made);
        return *std::move(made);
    }();
    return space;
}

std::shared_ptr<const DeviceTransform> curves_of(const std::array<const void*, 3>& curves) {
    return std::make_shared<Curves>(curves);
}

Result<std::shared_ptr<const DeviceTransform>> tables_of(void* profile, const Rendering& rendering) {
    const lcms::Profile from = lcms::linear_profile(table_space());
    const bool inks = cmsGetColorSpace(profile) == cmsSigCmykData;
    cmsHTRANSFORM transform = cmsCreateTransform(from.get(), TYPE_RGB_FLT, profile, inks ? TYPE_CMYK_FLT : TYPE_RGB_FLT,
                                                 static_cast<cmsUInt32Number>(rendering.intent), flags_of(rendering));
    if (!transform) return Error{ErrorCode::kUnsupported, "is a LUT profile without tables for printing with this intent"};
    return std::make_shared<Lcms>(transform, inks ? 4 : 3);
}

Result<std::shared_ptr<const DeviceGamut>> gamut_of(void* profile, const Rendering& rendering) {
    const lcms::Profile from = lcms::linear_profile(table_space()), lab(cmsCreateLab4Profile(nullptr));
    cmsHTRANSFORM transform =
        cmsCreateProofingTransform(from.get(), TYPE_RGB_FLT, lab.get(), TYPE_Lab_FLT, profile, INTENT_RELATIVE_COLORIMETRIC,
                                   INTENT_RELATIVE_COLORIMETRIC, flags_of(rendering) | cmsFLAGS_SOFTPROOFING);
    if (!transform) return Error{ErrorCode::kUnsupported, "has no tables from colours to codes and back"};
    cmsCIEXYZ black{};
    if (rendering.compensates()) cmsDetectDestinationBlackPoint(&black, profile, INTENT_RELATIVE_COLORIMETRIC, 0);
    return std::make_shared<RoundTrip>(transform, std::array{black.X, black.Y, black.Z});
}

Result<std::shared_ptr<const DeviceTransform>> proof_of(void* profile, const color::RgbSpace& display, const Rendering& rendering) {
    const lcms::Profile from = lcms::linear_profile(table_space()), to = lcms::linear_profile(display);
    const bool absolute = rendering.intent == Intent::kAbsolute;
    cmsHTRANSFORM transform = cmsCreateProofingTransform(
        from.get(), TYPE_RGB_FLT, to.get(), TYPE_RGB_FLT, profile, static_cast<cmsUInt32Number>(rendering.intent),
        absolute ? INTENT_ABSOLUTE_COLORIMETRIC : INTENT_RELATIVE_COLORIMETRIC, flags_of(rendering) | cmsFLAGS_SOFTPROOFING);
    if (!transform) return Error{ErrorCode::kUnsupported, "has no tables for a proof with this intent"};
    return std::make_shared<Lcms>(transform, 3);
}

}  // namespace latent::convert
