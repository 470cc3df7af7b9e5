// tools/convert/lcms.h: Little CMS' profiles, owned.
#pragma once

#include <lcms2.h>

#include <memory>
#include <string>

#include "base/bytes.h"
#include "base/result.h"
#include "color/rgb_space.h"

namespace latent::convert::lcms {

struct CloseProfile {
    void operator()(void* profile) const { cmsCloseProfile(profile); }
};
using Profile = std::unique_ptr<void, CloseProfile>;

// The linear light of a space with primaries.
Profile linear_profile(const color::RgbSpace& space);

// A file of at most 64 MiB; its bytes go to `bytes`. Errors: of reading; kForeign, kUnsupported unless it is one of grey, RGB or
// CMYK.
Result<Profile> open_profile(const std::string& path, Bytes* bytes = nullptr);

// What a profile calls itself, in printable ASCII.
std::string description_of(cmsHPROFILE profile);

}  // namespace latent::convert::lcms
