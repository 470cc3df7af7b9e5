#include "tools/convert/lcms.h"

#include <fmt/format.h>

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
    constexpr std::uint64_t kMost = std::uint64_t{64} << 20;
    const Result<std::string> text = read_small_file(path, kMost, "a profile");
    if (!text) return text.error();
    cmsSetLogErrorHandler(nullptr);
    Profile profile(cmsOpenProfileFromMem(text->data(), static_cast<cmsUInt32Number>(text->size())));
    if (!profile) return Error{ErrorCode::kForeign, path + ": is not an ICC profile"};
    if (cmsGetColorSpace(profile.get()) != cmsSigRgbData)
        return Error{ErrorCode::kUnsupported, path + ": is not an RGB profile; other profiles are not supported"};
    if (bytes != nullptr) {
        const auto all = std::as_bytes(std::span(*text));
        bytes->assign(all.begin(), all.end());
    }
    return profile;
}

}  // namespace latent::convert::lcms
