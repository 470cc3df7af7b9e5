#include "tools/convert/icc.h"

#include <fmt/format.h>
#include <lcms2.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>

#include "base/file.h"
#include "color/adaptation.h"

namespace latent::convert {

namespace {

struct CloseProfile {
    void operator()(void* profile) const { cmsCloseProfile(profile); }
};
using Profile = std::unique_ptr<void, CloseProfile>;

struct FreeCurve {
    void operator()(cmsToneCurve* curve) const { cmsFreeToneCurve(curve); }
};

// Decoding curve of a transfer: ICC's type 1 (y = x^g) or type 4 (y = (a x + b)^g from d on, c x below).
std::unique_ptr<cmsToneCurve, FreeCurve> curve_of(const color::Transfer& t) {
    const double gamma = 1 / t.exponent;
    if (t.linear_below == 0) return std::unique_ptr<cmsToneCurve, FreeCurve>(cmsBuildGamma(nullptr, gamma));
    const double parameters[] = {gamma, 1 / t.scale, (t.scale - 1) / t.scale, 1 / t.slope, t.slope * t.linear_below};
    return std::unique_ptr<cmsToneCurve, FreeCurve>(cmsBuildParametricToneCurve(nullptr, 4, parameters));
}

// How far, at most, two decoding curves are apart.
double distance(const cmsToneCurve* curve, const color::Transfer& transfer) {
    double most = 0;
    for (int i = 0; i <= 1000; ++i) {
        const double encoded = i / 1000.0;
        most = std::max(most, std::abs(static_cast<double>(cmsEvalToneCurveFloat(curve, static_cast<float>(encoded))) -
                                       transfer.decode(encoded)));
    }
    return most;
}

// The transfer that a curve is, to half a code value of 8 bits where it is steepest.
Result<color::Transfer> transfer_of(const cmsToneCurve* curve) {
    constexpr double kTolerance = 0.5 / 255;
    std::vector<color::Transfer> candidates{color::Transfer::linear(), color::Transfer::srgb(), color::Transfer::rec2020()};
    const double gamma = cmsEstimateGamma(curve, 0.1);
    if (gamma > 0) candidates.push_back(color::Transfer::gamma(gamma));
    const auto nearest = std::min_element(
        candidates.begin(), candidates.end(),
        [&](const color::Transfer& a, const color::Transfer& b) { return distance(curve, a) < distance(curve, b); });
    if (distance(curve, *nearest) > kTolerance) {
        return Error{ErrorCode::kUnsupported, "its tone curve is neither that of sRGB or Rec.2020 nor a power"};
    }
    return *nearest;
}

Bytes saved(cmsHPROFILE profile) {
    cmsUInt32Number size = 0;
    if (!cmsSaveProfileToMem(profile, nullptr, &size)) throw std::bad_alloc();
    Bytes bytes(size);
    if (!cmsSaveProfileToMem(profile, bytes.data(), &size)) throw std::bad_alloc();
    return bytes;
}

color::Chromaticity white_of(const color::Matrix3& xyz_from_rgb) {
    const std::array<double, 3> white = xyz_from_rgb * std::array<double, 3>{1, 1, 1};
    return color::chromaticity({white[0], white[1], white[2]});
}

// A profile's primaries are adapted to D50. Undoes that, so that luminance is what the display shows: by the matrix that the
// profile gives (version 4: chad), or else from its white point by Bradford's (version 2) [ICC, Annex E].
color::Matrix3 unadapted(cmsHPROFILE profile, const color::Matrix3& xyz_from_rgb) {
    if (const auto* chad = static_cast<const cmsFloat64Number*>(cmsReadTag(profile, cmsSigChromaticAdaptationTag))) {
        color::Matrix3 adaptation;
        for (std::size_t i = 0; i < 9; ++i) adaptation.m[i / 3][i % 3] = chad[i];
        return adaptation.invertible() ? adaptation.inverse() * xyz_from_rgb : xyz_from_rgb;
    }
    const auto* white = static_cast<const cmsCIEXYZ*>(cmsReadTag(profile, cmsSigMediaWhitePointTag));
    if (white == nullptr || cmsGetEncodedICCversion(profile) >= 0x4000000) return xyz_from_rgb;
    const Result<color::Matrix3> back =
        color::adaptation_matrix(white_of(xyz_from_rgb), color::chromaticity({white->X, white->Y, white->Z}));
    return back ? *back * xyz_from_rgb : xyz_from_rgb;
}

}  // namespace

Bytes icc_of(const color::RgbSpace& space) {
    const color::Primaries& p = space.primaries;
    const cmsCIExyY white{p.white.x, p.white.y, 1};
    const cmsCIExyYTRIPLE primaries{{p.red.x, p.red.y, 1}, {p.green.x, p.green.y, 1}, {p.blue.x, p.blue.y, 1}};
    const auto curve = curve_of(space.transfer);
    cmsToneCurve* curves[] = {curve.get(), curve.get(), curve.get()};
    const Profile profile(cmsCreateRGBProfile(&white, &primaries, curves));
    if (!profile) {
        // That the white cannot be adapted is said elsewhere.
        if (color::adaptation_matrix(p.white, {0.3457, 0.3585})) throw std::bad_alloc();
        return {};
    }
    const auto write = [&](cmsTagSignature tag, const char* words) {  // a text of its own: of each language it takes one only
        const std::unique_ptr<cmsMLU, decltype(&cmsMLUfree)> text(cmsMLUalloc(nullptr, 1), cmsMLUfree);
        return text && cmsMLUsetASCII(text.get(), "en", "US", words) && cmsWriteTag(profile.get(), tag, text.get());
    };
    if (!write(cmsSigProfileDescriptionTag, space.name.c_str()) || !write(cmsSigCopyrightTag, "CC0")) throw std::bad_alloc();
    Bytes bytes = saved(profile.get());
    // The header's time of creation, and the hash over it: 2000-01-01 00:00:00 and none [ICC, 7.2].
    const std::uint16_t date[] = {2000, 1, 1, 0, 0, 0};
    for (std::size_t i = 0; i < 6; ++i) {
        bytes[24 + 2 * i] = std::byte(date[i] >> 8);
        bytes[25 + 2 * i] = std::byte(date[i] & 0xff);
    }
    std::fill(bytes.begin() + 84, bytes.begin() + 100, std::byte{0});
    return bytes;
}

Result<Display> display_from_icc(const std::string& path, const std::optional<std::array<double, 3>>& luminance_row) {
    const Result<File> file = File::open_read(path);
    if (!file) return file.error();
    const Result<std::uint64_t> size = file->size();
    if (!size) return size.error();
    const auto unsupported = [&](const std::string& why) {
        return Error{ErrorCode::kUnsupported, fmt::format("{}: {}", path, why)};
    };
    if (*size > (std::uint64_t{16} << 20)) return unsupported("is too large for a display profile");
    Display display;
    display.icc.resize(*size);
    if (Status s = file->read_exact(0, display.icc); !s) return s.error();
    cmsSetLogErrorHandler(nullptr);
    const Profile profile(cmsOpenProfileFromMem(display.icc.data(), static_cast<cmsUInt32Number>(display.icc.size())));
    if (!profile) return Error{ErrorCode::kForeign, path + ": is not an ICC profile"};
    if (cmsGetColorSpace(profile.get()) != cmsSigRgbData) return unsupported("is not a profile of an RGB display");
    if (!cmsIsMatrixShaper(profile.get()) || cmsIsTag(profile.get(), cmsSigBToA0Tag) || cmsIsTag(profile.get(), cmsSigAToB0Tag)) {
        return unsupported("is based on tables (a LUT profile); only profiles with three primaries and one curve are supported");
    }
    color::Matrix3 xyz_from_rgb;
    const cmsTagSignature columns[] = {cmsSigRedColorantTag, cmsSigGreenColorantTag, cmsSigBlueColorantTag};
    const cmsTagSignature curves[] = {cmsSigRedTRCTag, cmsSigGreenTRCTag, cmsSigBlueTRCTag};
    std::array<color::Transfer, 3> transfers;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto* column = static_cast<const cmsCIEXYZ*>(cmsReadTag(profile.get(), columns[i]));
        const auto* curve = static_cast<const cmsToneCurve*>(cmsReadTag(profile.get(), curves[i]));
        if (column == nullptr || curve == nullptr) return unsupported("lacks a primary or a curve");
        xyz_from_rgb.m[0][i] = column->X;
        xyz_from_rgb.m[1][i] = column->Y;
        xyz_from_rgb.m[2][i] = column->Z;
        const Result<color::Transfer> transfer = transfer_of(curve);
        if (!transfer) return unsupported(transfer.error().message);
        transfers[i] = *transfer;
        if (std::abs(transfers[i].exponent - transfers[0].exponent) > 1e-6 ||
            transfers[i].linear_below != transfers[0].linear_below) {
            return unsupported("has a different tone curve for each primary");
        }
    }
    xyz_from_rgb = unadapted(profile.get(), xyz_from_rgb);
    if (!xyz_from_rgb.invertible()) return unsupported("its primaries lie on a line");
    Result<color::RgbSpace> space =
        color::RgbSpace::from_matrix(path, xyz_from_rgb.inverse(), luminance_row ? &*luminance_row : nullptr, transfers[0]);
    if (!space) return space.error().at(path);
    display.space = *space;
    display.space.name = "ICC profile";  // no path may enter an output
    display.white = white_of(xyz_from_rgb);
    return display;
}

}  // namespace latent::convert
