// tools/convert/device.h: displays and printers that only their ICC profile describes: by curves, or by tables.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/result.h"
#include "color/rgb_space.h"

namespace latent::convert {

// How colours beyond a device are brought into it, as ICC profiles define it.
enum class Intent : std::uint8_t { kPerceptual = 0, kRelative = 1, kSaturation = 2, kAbsolute = 3 };

struct Rendering {
    Intent intent = Intent::kRelative;
    bool black_point_compensation = true;  // the darkest of the picture becomes the darkest of the device

    bool compensates() const { return black_point_compensation && intent != Intent::kAbsolute; }  // which has none
};
std::string_view name_of(Intent intent);

// From rows of linear light to what the device gets, 0..1, or to other light. Thread-safe.
class DeviceTransform {
 public:
    virtual ~DeviceTransform() = default;
    virtual int channels() const { return 3; }  // 4: cyan, magenta, yellow, black, where 1 is all of an ink
    // In place; the fourth channel, if there is one, goes to `fourth`, of the same size.
    virtual void apply(const std::array<std::span<float>, 3>& rgb, std::span<float> fourth) const = 0;
};

// Which colours a device has: its relative colorimetric print of the others differs by more than kMax in CIELAB. Thread-safe.
class DeviceGamut {
 public:
    static constexpr double kMax = 5;
    virtual ~DeviceGamut() = default;
    // Rows in table_space(), and 1 for each pixel that the device lacks, 0 for others. Returns the number of the former.
    virtual std::size_t find_lacking(const std::array<std::span<const float>, 3>& rgb, std::span<std::uint8_t> lacking) const = 0;
};

// The space that prints for tables are made in: it holds every colour that a device has (ROMM RGB's primaries, D50), linear.
const color::RgbSpace& table_space();

// A curve for each primary, inverted. The curves are decoding ones of Little CMS (cmsToneCurve), and are copied.
std::shared_ptr<const DeviceTransform> curves_of(const std::array<const void*, 3>& curves);
// From table_space() through the tables of a profile (cmsHPROFILE). Errors: kUnsupported.
Result<std::shared_ptr<const DeviceTransform>> tables_of(void* profile, const Rendering& rendering);
// The gamut of a profile (cmsHPROFILE). With black point compensation, colours are compensated before. Errors: kUnsupported.
Result<std::shared_ptr<const DeviceGamut>> gamut_of(void* profile, const Rendering& rendering);
// From table_space() to what the device's print looks like in the linear light of `display`, whose white is the paper's unless the
// intent is absolute. Errors: kUnsupported.
Result<std::shared_ptr<const DeviceTransform>> proof_of(void* profile, const color::RgbSpace& display, const Rendering& rendering);

}  // namespace latent::convert
