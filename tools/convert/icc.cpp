#include "tools/convert/icc.h"

#include <fmt/format.h>
#include <lcms2.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <optional>
#include <vector>

#include "color/adaptation.h"
#include "tools/convert/lcms.h"

namespace latent::convert {

namespace {

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

// The transfer that all three curves are, to half a code value of 8 bits where it is steepest; none if they are something else.
std::optional<color::Transfer> transfer_of(const std::array<const void*, 3>& curves) {
    constexpr double kTolerance = 0.5 / 255;
    const auto* first = static_cast<const cmsToneCurve*>(curves[0]);
    std::vector<color::Transfer> candidates{color::Transfer::linear(), color::Transfer::srgb(), color::Transfer::rec2020()};
    const double gamma = cmsEstimateGamma(first, 0.1);
    if (gamma > 0) candidates.push_back(color::Transfer::gamma(gamma));
    const auto nearest = std::min_element(
        candidates.begin(), candidates.end(),
        [&](const color::Transfer& a, const color::Transfer& b) { return distance(first, a) < distance(first, b); });
    for (const void* curve : curves) {
        if (distance(static_cast<const cmsToneCurve*>(curve), *nearest) > kTolerance) return std::nullopt;
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

namespace {

// As other programs show it.
std::string description_of(const color::RgbSpace& space) {
    constexpr std::pair<const char*, const char*> kNames[] = {{"srgb", "sRGB"},
                                                              {"display-p3", "Display P3"},
                                                              {"rec2020", "Rec. 2020"},
                                                              {"adobe-rgb", "Compatible with Adobe RGB (1998)"}};
    for (const auto& [name, description] : kNames) {
        if (space.name == name) return description;
    }
    return "RGB " + space.name;
}

// With its texts, and without what depends on the day.
Bytes finished(cmsHPROFILE profile, const std::string& description) {
    const auto write = [&](cmsTagSignature tag, const char* words) {  // a text of its own: of each language it takes one only
        const std::unique_ptr<cmsMLU, decltype(&cmsMLUfree)> text(cmsMLUalloc(nullptr, 1), cmsMLUfree);
        return text && cmsMLUsetASCII(text.get(), "en", "US", words) && cmsWriteTag(profile, tag, text.get());
    };
    if (!write(cmsSigProfileDescriptionTag, description.c_str()) || !write(cmsSigCopyrightTag, "CC0")) throw std::bad_alloc();
    Bytes bytes = saved(profile);
    // The header's time of creation, and the hash over it: 2000-01-01 00:00:00 and none [ICC, 7.2].
    const std::uint16_t date[] = {2000, 1, 1, 0, 0, 0};
    for (std::size_t i = 0; i < 6; ++i) {
        bytes[24 + 2 * i] = std::byte(date[i] >> 8);
        bytes[25 + 2 * i] = std::byte(date[i] & 0xff);
    }
    std::fill(bytes.begin() + 84, bytes.begin() + 100, std::byte{0});
    return bytes;
}

}  // namespace

Bytes icc_of(const color::RgbSpace& space) {
    const color::Primaries& p = space.primaries;
    const cmsCIExyY white{p.white.x, p.white.y, 1};
    const cmsCIExyYTRIPLE primaries{{p.red.x, p.red.y, 1}, {p.green.x, p.green.y, 1}, {p.blue.x, p.blue.y, 1}};
    const auto curve = curve_of(space.transfer);
    cmsToneCurve* curves[] = {curve.get(), curve.get(), curve.get()};
    const lcms::Profile profile(cmsCreateRGBProfile(&white, &primaries, curves));
    if (!profile) {
        // That the white cannot be adapted is said elsewhere.
        if (color::adaptation_matrix(p.white, {0.3457, 0.3585})) throw std::bad_alloc();
        return {};
    }
    return finished(profile.get(), description_of(space));
}

Bytes grey_icc_of(const color::RgbSpace& space) {
    const cmsCIExyY white = *cmsD50_xyY();
    const auto curve = curve_of(space.transfer);
    const lcms::Profile profile(cmsCreateGrayProfile(&white, curve.get()));
    if (!profile) throw std::bad_alloc();
    return finished(profile.get(), "Grey, " + description_of(space));
}

namespace {

// Three primaries and their curves.
Status read_matrix(cmsHPROFILE profile, const std::optional<std::array<double, 3>>& luminance_row, Display& display) {
    const auto unsupported = [](const std::string& why) { return Error{ErrorCode::kUnsupported, why}; };
    color::Matrix3 xyz_from_rgb;
    const cmsTagSignature columns[] = {cmsSigRedColorantTag, cmsSigGreenColorantTag, cmsSigBlueColorantTag};
    const cmsTagSignature curve_tags[] = {cmsSigRedTRCTag, cmsSigGreenTRCTag, cmsSigBlueTRCTag};
    std::array<const void*, 3> curves;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto* column = static_cast<const cmsCIEXYZ*>(cmsReadTag(profile, columns[i]));
        curves[i] = cmsReadTag(profile, curve_tags[i]);
        if (column == nullptr || curves[i] == nullptr) return unsupported("lacks a primary or a curve");
        xyz_from_rgb.m[0][i] = column->X;
        xyz_from_rgb.m[1][i] = column->Y;
        xyz_from_rgb.m[2][i] = column->Z;
    }
    xyz_from_rgb = unadapted(profile, xyz_from_rgb);
    if (!xyz_from_rgb.invertible()) return unsupported("its primaries lie on a line");
    const std::optional<color::Transfer> transfer = transfer_of(curves);
    if (!transfer) display.device = curves_of(curves);
    Result<color::RgbSpace> space =
        color::RgbSpace::from_matrix(lcms::description_of(profile), xyz_from_rgb.inverse(),
                                     luminance_row ? &*luminance_row : nullptr, transfer.value_or(color::Transfer::linear()));
    if (!space) return space.error();
    display.space = *space;
    display.white = white_of(xyz_from_rgb);
    return {};
}

}  // namespace

namespace {

// One channel with a curve: sRGB's primaries stand for it, of which only the luminance is used.
Status read_grey(cmsHPROFILE profile, Display& display) {
    const void* curve = cmsReadTag(profile, cmsSigGrayTRCTag);
    if (curve == nullptr) return Error{ErrorCode::kUnsupported, "is a grey profile without a curve (kTRC)"};
    const std::array curves{curve, curve, curve};
    const std::optional<color::Transfer> transfer = transfer_of(curves);
    if (!transfer) display.device = curves_of(curves);
    const Result<color::RgbSpace> space = color::RgbSpace::from_primaries(
        lcms::description_of(profile), color::RgbSpace::srgb().primaries, transfer.value_or(color::Transfer::linear()));
    if (!space) return space.error();
    display.space = *space;
    display.white = space->primaries.white;
    display.grey = true;
    return {};
}

}  // namespace

// The space has the profile's own name: no path may enter an output.
Result<Display> display_from_icc(const std::string& path, const std::optional<std::array<double, 3>>& luminance_row,
                                 const Rendering& rendering) {
    Display display;
    const Result<lcms::Profile> profile = lcms::open_profile(path, &display.icc);
    if (!profile) return profile.error();
    if (cmsGetColorSpace(profile->get()) == cmsSigGrayData) {
        if (luminance_row) return usage_error(fmt::format("--luminance-row: {} has no primaries, but grey alone", path));
        if (Status s = read_grey(profile->get(), display); !s) return s.error().at(path);
        return display;
    }
    const bool tables = !cmsIsMatrixShaper(profile->get()) || cmsIsTag(profile->get(), cmsSigBToA0Tag);
    if (!tables) {
        if (Status s = read_matrix(profile->get(), luminance_row, display); !s) return s.error().at(path);
        return display;
    }
    if (luminance_row) return usage_error(fmt::format("--luminance-row: {} has no primaries, but tables", path));
    const auto device = cmsIsTag(profile->get(), cmsSigBToA0Tag)
                            ? tables_of(profile->get(), rendering)
                            : Error{ErrorCode::kUnsupported, "is a LUT profile without tables for printing (BToA0)"};
    if (!device) return device.error().at(path);
    const auto gamut = gamut_of(profile->get(), rendering);
    if (!gamut) return gamut.error().at(path);
    display.device = *device;
    display.gamut = *gamut;
    display.space = table_space();
    display.space.name = lcms::description_of(profile->get());
    display.white = display.space.primaries.white;
    return display;
}

}  // namespace latent::convert
