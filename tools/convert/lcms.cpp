#include "tools/convert/lcms.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <span>

#include "base/small_file.h"

namespace latent::convert::lcms {

Profile linear_profile(const color::RgbSpace& space) {
    const color::Primaries& p = space.primaries;
    const cmsCIExyY white{p.white.x, p.white.y, 1};
    const cmsCIExyYTRIPLE primaries{{p.red.x, p.red.y, 1}, {p.green.x, p.green.y, 1}, {p.blue.x, p.blue.y, 1}};
    const std::unique_ptr<cmsToneCurve, decltype(&cmsFreeToneCurve)> curve(cmsBuildGamma(nullptr, 1), cmsFreeToneCurve);
    cmsToneCurve* curves[] = {curve.get(), curve.get(), curve.get()};
    Profile profile(cmsCreateRGBProfile(&white, &primaries, curves));
    if (!profile) throw std::bad_alloc();
    return profile;
}

Result<Profile> open_profile(const std::string& path, Bytes* bytes) {
    constexpr std::uint64_t kMax = std::uint64_t{64} << 20;
    const Result<std::string> text = read_small_file(path, kMax, "a profile");
    if (!text) return text.error();
    if (text->size() >= 4) {  // a profile begins with its size
        std::uint32_t size = 0;
        for (std::size_t i = 0; i < 4; ++i) size = size << 8 | static_cast<unsigned char>((*text)[i]);
        if (text->size() > 128 && text->substr(36, 4) == "acsp" && size > text->size())
            return Error{ErrorCode::kTruncated,
                         fmt::format("{}: is cut off after {} of {} bytes; copy it again", path, text->size(), size)};
    }
    cmsSetLogErrorHandler(nullptr);
    Profile profile(cmsOpenProfileFromMem(text->data(), static_cast<cmsUInt32Number>(text->size())));
    if (!profile)
        return Error{ErrorCode::kForeign,
                     path + ": is not an ICC profile; name an .icc or .icm file, or srgb, display-p3, rec2020 or adobe-rgb"};
    const auto space = static_cast<std::uint32_t>(cmsGetColorSpace(profile.get()));  // the file's, whatever that is
    if (space != cmsSigRgbData && space != cmsSigCmykData && space != cmsSigGrayData)
        return Error{ErrorCode::kUnsupported, path + ": is no profile of grey, RGB or CMYK; others are not supported"};
    if (bytes != nullptr) {
        const auto all = std::as_bytes(std::span(*text));
        bytes->assign(all.begin(), all.end());
    }
    return profile;
}

std::string description_of(cmsHPROFILE profile) {
    char text[128] = {};
    cmsGetProfileInfoASCII(profile, cmsInfoDescription, "en", "US", text, sizeof text);
    std::string name = text;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    name.erase(name.find_last_not_of(' ') + 1);
    return name.empty() ? "ICC profile" : name;
}

}  // namespace latent::convert::lcms
