// One channel of grey.
#include <gmock/gmock.h>
#include <lcms2.h>

#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

class Grey : public PrintTest {
 protected:
    void SetUp() override { write_picture(folder_ / "a.exr", {}); }
    ConvertOptions grey(const std::string& profile = "srgb") const {
        ConvertOptions options;
        options.grey = true;
        options.profile = profile;
        options.dither = color::Dither::kNone;
        return options;
    }
    static void expect_grey_profile(const Bytes& icc) {
        ASSERT_FALSE(icc.empty());
        const cmsHPROFILE profile = cmsOpenProfileFromMem(icc.data(), static_cast<cmsUInt32Number>(icc.size()));
        ASSERT_NE(profile, nullptr);
        EXPECT_EQ(cmsGetColorSpace(profile), cmsSigGrayData);
        cmsCloseProfile(profile);
    }
};

TEST_F(Grey, IsTheLuminanceOfThePrintInOneChannelOfEveryFormat) {
    ConvertOptions colour = grey();
    colour.grey = false;
    ASSERT_TRUE(print("a.exr", "colour.png", colour));
    const image::Decoded rgb = image::decode_png(folder_ / "colour.png");
    ASSERT_TRUE(print("a.exr", "grey.png", grey()));
    const image::Decoded one = image::decode_png(folder_ / "grey.png");
    EXPECT_EQ(one.format.channels, 1);
    EXPECT_TRUE(one.srgb);
    const color::RgbSpace& srgb = color::RgbSpace::srgb();
    for (std::size_t i = 0; i < one.pixels.size(); ++i) {
        const auto light = [&](std::size_t c) { return srgb.transfer.decode(static_cast<double>(rgb.pixels[3 * i + c]) / 255); };
        const double y = srgb.luminance_row[0] * light(0) + srgb.luminance_row[1] * light(1) + srgb.luminance_row[2] * light(2);
        // Codes of the colours are rounded, and so is that of the grey.
        ASSERT_NEAR(static_cast<double>(one.pixels[i]), 255 * srgb.transfer.encode(y), 1.6) << i;
    }
    ASSERT_TRUE(print("a.exr", "grey.tif", grey()));
    const image::Decoded tiff = image::decode_tiff(folder_ / "grey.tif").front();
    EXPECT_EQ(tiff.format.channels, 1);
    EXPECT_EQ(tiff.pixels, one.pixels);
    expect_grey_profile(tiff.icc);
    ASSERT_TRUE(print("a.exr", "grey.jpg", grey()));
    const image::Decoded jpeg = image::decode_jpeg(folder_ / "grey.jpg");
    EXPECT_EQ(jpeg.format.channels, 1);
    expect_grey_profile(jpeg.icc);
    ConvertOptions deep = grey("adobe-rgb");
    deep.depth = Depth::k16;
    ASSERT_TRUE(print("a.exr", "deep.png", deep));
    const image::Decoded deep_png = image::decode_png(folder_ / "deep.png");
    EXPECT_EQ(deep_png.format.channels, 1);
    EXPECT_EQ(deep_png.format.sample, image::SampleType::kU16);
    expect_grey_profile(deep_png.icc);
}

TEST_F(Grey, ProfilesOfGreyAreUsedAsTheyAre) {
    cmsToneCurve* curve = cmsBuildGamma(nullptr, 2.2);
    const cmsHPROFILE profile = cmsCreateGrayProfile(cmsD50_xyY(), curve);
    EXPECT_TRUE(cmsSaveProfileToFile(profile, at("grey.icc").c_str()));
    cmsCloseProfile(profile);
    cmsFreeToneCurve(curve);
    ConvertOptions options = grey(at("grey.icc"));
    options.grey = false;
    ASSERT_TRUE(print("a.exr", "profile.png", options));
    const image::Decoded decoded = image::decode_png(folder_ / "profile.png");
    EXPECT_EQ(decoded.format.channels, 1);
    expect_grey_profile(decoded.icc);
}

TEST_F(Grey, FitsNoFormatOfThreeChannels) {
    for (const char* output : {"a.exr", "a.dzi"}) {
        const Result<ConvertReport> refused = print("a.exr", std::string("b") + output, grey());
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
    }
}

}  // namespace
}  // namespace latent::convert
