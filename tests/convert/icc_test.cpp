// Profiles as Little CMS understands them.
#include "tools/convert/icc.h"

#include <lcms2.h>

#include <cmath>
#include <fstream>

#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

// Linear XYZ (D50) of encoded RGB through a profile, by Little CMS.
std::array<double, 3> xyz_of(const Bytes& icc, const std::array<double, 3>& rgb) {
    const cmsHPROFILE profile = cmsOpenProfileFromMem(icc.data(), static_cast<cmsUInt32Number>(icc.size()));
    const cmsHPROFILE xyz = cmsCreateXYZProfile();
    const cmsHTRANSFORM transform = cmsCreateTransform(profile, TYPE_RGB_DBL, xyz, TYPE_XYZ_DBL, INTENT_RELATIVE_COLORIMETRIC,
                                                       cmsFLAGS_NOOPTIMIZE | cmsFLAGS_NOCACHE);
    EXPECT_NE(transform, nullptr);
    std::array<double, 3> out{};
    cmsDoTransform(transform, rgb.data(), out.data(), 1);
    cmsDeleteTransform(transform);
    cmsCloseProfile(profile);
    cmsCloseProfile(xyz);
    return out;
}

TEST(Icc, TheProfileOfASpaceSaysWhatTheSpaceDoes) {
    for (const std::string name : {"srgb", "display-p3", "rec2020", "adobe-rgb", "0.7,0.3,0.2,0.7,0.14,0.05,0.3127,0.329"}) {
        SCOPED_TRACE(name);
        const Result<Display> display = display_from(name, std::nullopt);
        ASSERT_TRUE(display) << display.error().message;
        const color::RgbSpace& space = display->space;
        const std::array<double, 3> white = xyz_of(display->icc, {1, 1, 1});
        EXPECT_NEAR(white[0], 0.9642, 2e-4);  // D50
        EXPECT_NEAR(white[1], 1, 2e-4);
        EXPECT_NEAR(white[2], 0.8249, 2e-4);
        for (const double code : {0.02, 0.2, 0.5, 0.9}) {  // luminance of primaries at every part of the curve
            EXPECT_NEAR(xyz_of(display->icc, {code, code, code})[1], space.transfer.decode(code), 2e-4);
        }
        EXPECT_EQ(display->icc, icc_of(space));
    }
}

TEST(Icc, ProfilesCarryNoDate) {
    const Bytes icc = display_from("srgb", std::nullopt)->icc;
    const std::vector<std::byte> date(icc.begin() + 24, icc.begin() + 36);
    const std::array<int, 12> expected{7, 208, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0};  // 2000-01-01 00:00:00
    for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(static_cast<int>(date[i]), expected[i]);
}

using IccFile = PrintTest;

TEST_F(IccFile, PrintingForAProfileIsPrintingForItsSpace) {
    // Colours well inside the gamuts: a profile's numbers have 16 binary places, 1e-5 of light, and mapping into the gamut
    // magnifies.
    write_picture(folder_ / "a.exr", {64, 64}, [](int x, int y) -> std::array<float, 3> {
        const float light = 0.05f + static_cast<float>(y) / 64;
        return {light * (0.9f + 0.1f * static_cast<float>(x) / 64), light, light * (1.2f - 0.2f * static_cast<float>(x) / 64)};
    });
    for (const std::string name : {"display-p3", "adobe-rgb", "rec2020"}) {
        SCOPED_TRACE(name);
        const Display space = *display_from(name, std::nullopt);
        std::ofstream(folder_ / (name + ".icc"), std::ios::binary)
            .write(reinterpret_cast<const char*>(space.icc.data()), static_cast<std::streamsize>(space.icc.size()));
        const Result<Display> file = display_from(at(name + ".icc"), std::nullopt);
        ASSERT_TRUE(file) << file.error().message;
        EXPECT_EQ(file->icc, space.icc);  // embedded as it is
        ConvertOptions by_name, by_file;
        by_name.depth = by_file.depth = Depth::k16;
        by_name.profile = name;
        by_file.profile = at(name + ".icc");
        ASSERT_TRUE(print("a.exr", name + ".1.png", by_name));
        ASSERT_TRUE(print("a.exr", name + ".2.png", by_file));
        const image::Decoded one = image::decode_png(folder_ / (name + ".1.png")),
                             two = image::decode_png(folder_ / (name + ".2.png"));
        const auto* a = reinterpret_cast<const std::uint16_t*>(one.pixels.data());
        const auto* b = reinterpret_cast<const std::uint16_t*>(two.pixels.data());
        // A tenth of a step of 8 bits.
        for (std::size_t i = 0; i < 64 * 64 * 3; ++i) ASSERT_NEAR(a[i], b[i], 26) << i;
        EXPECT_EQ(image::decode_png(folder_ / (name + ".2.png")).icc, space.icc);
    }
}

TEST_F(IccFile, WhatIsNotAProfileOfPrimariesIsRefusedClearly) {
    std::ofstream(folder_ / "text.icc") << "no profile";
    const Result<Display> text = display_from(at("text.icc"), std::nullopt);
    ASSERT_FALSE(text);
    EXPECT_EQ(text.error().code, ErrorCode::kForeign);
    EXPECT_EQ(display_from(at("none.icc"), std::nullopt).error().code, ErrorCode::kNotFound);

    const auto saved = [&](cmsHPROFILE profile, const char* name) {
        EXPECT_TRUE(cmsSaveProfileToFile(profile, at(name).c_str()));
        cmsCloseProfile(profile);
    };
    saved(cmsCreateLab4Profile(nullptr), "lab.icc");
    cmsToneCurve* grey = cmsBuildGamma(nullptr, 2.2);
    saved(cmsCreateGrayProfile(cmsD50_xyY(), grey), "grey.icc");
    cmsFreeToneCurve(grey);
    // A LUT profile of RGB: a device link of sRGB to Lab turned into a profile.
    const cmsHPROFILE srgb = cmsCreate_sRGBProfile(), lab = cmsCreateLab4Profile(nullptr);
    const cmsHTRANSFORM transform = cmsCreateTransform(srgb, TYPE_RGB_16, lab, TYPE_Lab_16, INTENT_PERCEPTUAL, 0);
    const cmsHPROFILE lut = cmsTransform2DeviceLink(transform, 4.3, cmsFLAGS_FORCE_CLUT);
    cmsSetDeviceClass(lut, cmsSigDisplayClass);
    saved(lut, "lut.icc");
    cmsDeleteTransform(transform);
    cmsCloseProfile(srgb);
    cmsCloseProfile(lab);
    for (const char* name : {"lab.icc", "grey.icc", "lut.icc"}) {
        const Result<Display> refused = display_from(at(name), std::nullopt);
        ASSERT_FALSE(refused) << name;
        EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
        EXPECT_NE(refused.error().message.find(name), std::string::npos);
    }
    EXPECT_NE(display_from(at("lut.icc"), std::nullopt).error().message.find("LUT"), std::string::npos);
}

}  // namespace
}  // namespace latent::convert
