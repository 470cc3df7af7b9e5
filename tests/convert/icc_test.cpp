// Profiles as Little CMS understands them.
#include "tools/convert/icc.h"

#include <lcms2.h>

#include <cmath>
#include <fstream>

#include "color/difference.h"
#include "image/exr_reader.h"
#include "tests/convert/test_picture.h"
#include "tools/convert/device.h"

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
    // A LUT profile of RGB: a device link of sRGB to Lab turned into a profile.
    const cmsHPROFILE srgb = cmsCreate_sRGBProfile(), lab = cmsCreateLab4Profile(nullptr);
    const cmsHTRANSFORM transform = cmsCreateTransform(srgb, TYPE_RGB_16, lab, TYPE_Lab_16, INTENT_PERCEPTUAL, 0);
    const cmsHPROFILE lut = cmsTransform2DeviceLink(transform, 4.3, cmsFLAGS_FORCE_CLUT);
    cmsSetDeviceClass(lut, cmsSigDisplayClass);
    saved(lut, "lut.icc");
    cmsDeleteTransform(transform);
    cmsCloseProfile(srgb);
    cmsCloseProfile(lab);
    for (const char* name : {"lab.icc", "lut.icc"}) {
        const Result<Display> refused = display_from(at(name), std::nullopt);
        ASSERT_FALSE(refused) << name;
        EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
        EXPECT_NE(refused.error().message.find(name), std::string::npos);
    }
    EXPECT_NE(display_from(at("lut.icc"), std::nullopt).error().message.find("LUT"), std::string::npos);
}

// Greys and soft colours from black to white.
std::array<float, 3> soft(int x, int y) {
    const float light = std::exp2(-8 + 11 * static_cast<float>(y) / 64);
    return {light * (0.8f + 0.3f * static_cast<float>(x) / 64), light, light * (1.3f - 0.6f * static_cast<float>(x) / 64)};
}

// Codes of a profile's own curves bring back the light that was printed: of L*, and of a different power for each primary.
TEST_F(IccFile, AnyCurvesOfPrimariesAreInverted) {
    write_picture(folder_ / "a.exr", {64, 64}, soft);
    const cmsCIExyY white{0.3127, 0.3290, 1};
    const cmsCIExyYTRIPLE primaries{{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}};
    for (const bool lightness : {true, false}) {
        std::array<cmsToneCurve*, 3> curves{};
        for (std::size_t c = 0; c < 3; ++c) {
            std::vector<cmsFloat32Number> table;
            for (int i = 0; i < 4096; ++i) {
                const double e = i / 4095.0, l = 100 * e, f = (l + 16) / 116;
                table.push_back(static_cast<float>(!lightness ? std::pow(e, 1.6 + 0.4 * static_cast<double>(c))
                                                   : l > 8    ? f * f * f
                                                              : l / 903.3));
            }
            curves[c] = cmsBuildTabulatedToneCurveFloat(nullptr, 4096, table.data());
        }
        const cmsHPROFILE profile = cmsCreateRGBProfile(&white, &primaries, curves.data());
        ASSERT_TRUE(cmsSaveProfileToFile(profile, at("curves.icc").c_str()));
        cmsCloseProfile(profile);
        cmsFreeToneCurveTriple(curves.data());
        ConvertOptions by_name, by_file;
        by_name.depth = by_file.depth = Depth::k16;
        by_name.replace = by_file.replace = true;
        by_file.profile = at("curves.icc");
        ASSERT_TRUE(print("a.exr", "1.png", by_name));
        const Result<ConvertReport> printed = print("a.exr", "2.png", by_file);
        ASSERT_TRUE(printed) << printed.error().message;
        const image::Decoded one = image::decode_png(folder_ / "1.png"), two = image::decode_png(folder_ / "2.png");
        const auto* a = reinterpret_cast<const std::uint16_t*>(one.pixels.data());
        const auto* b = reinterpret_cast<const std::uint16_t*>(two.pixels.data());
        const auto decoded = [&](int c, double e) {
            const double l = 100 * e, f = (l + 16) / 116;
            return !lightness ? std::pow(e, 1.6 + 0.4 * c) : l > 8 ? f * f * f : l / 903.3;
        };
        for (int i = 0; i < 64 * 64 * 3; ++i) {
            const double light = color::Transfer::srgb().decode(a[i] / 65535.0);
            ASSERT_NEAR(decoded(i % 3, b[i] / 65535.0), light, 1e-4 + 1e-3 * light) << i;
        }
    }
}

// A printer: RGB by tables both ways, of a device whose black is not quite black.
class PrinterProfile : public PrintTest {
 protected:
    void SetUp() override {
        const cmsCIExyY white{0.3457, 0.3585, 1};
        const cmsCIExyYTRIPLE primaries{{0.60, 0.34, 1}, {0.28, 0.57, 1}, {0.17, 0.10, 1}};
        cmsToneCurve* curve = cmsBuildGamma(nullptr, 1.8);
        cmsToneCurve* curves[] = {curve, curve, curve};
        const cmsHPROFILE device = cmsCreateRGBProfile(&white, &primaries, curves), lab = cmsCreateLab4Profile(nullptr);
        cmsFreeToneCurve(curve);
        const cmsHPROFILE printer = cmsCreateProfilePlaceholder(nullptr);
        cmsSetProfileVersion(printer, 2.1);
        cmsSetDeviceClass(printer, cmsSigOutputClass);
        cmsSetColorSpace(printer, cmsSigRgbData);
        cmsSetPCS(printer, cmsSigLabData);
        const auto write = [&](cmsTagSignature tag, cmsHTRANSFORM transform) {
            cmsPipeline* pipeline = cmsPipelineAlloc(nullptr, 3, 3);
            cmsStage* table = cmsStageAllocCLut16bit(nullptr, 33, 3, 3, nullptr);
            const auto sample = [](const cmsUInt16Number in[], cmsUInt16Number out[], void* cargo) -> cmsInt32Number {
                cmsDoTransform(cargo, in, out, 1);
                return 1;
            };
            ASSERT_TRUE(cmsStageSampleCLut16bit(table, sample, transform, 0));
            ASSERT_TRUE(cmsPipelineInsertStage(pipeline, cmsAT_END, table));
            ASSERT_TRUE(cmsWriteTag(printer, tag, pipeline));
            cmsPipelineFree(pipeline);
            cmsDeleteTransform(transform);
        };
        const cmsUInt32Number intent = INTENT_RELATIVE_COLORIMETRIC, flags = cmsFLAGS_NOOPTIMIZE | cmsFLAGS_NOCACHE;
        for (const cmsTagSignature tag : {cmsSigAToB0Tag, cmsSigAToB1Tag})
            write(tag, cmsCreateTransform(device, TYPE_RGB_16, lab, TYPE_LabV2_16, intent, flags));
        for (const cmsTagSignature tag : {cmsSigBToA0Tag, cmsSigBToA1Tag})
            write(tag, cmsCreateTransform(lab, TYPE_LabV2_16, device, TYPE_RGB_16, intent, flags));
        cmsWriteTag(printer, cmsSigMediaWhitePointTag, cmsD50_XYZ());
        ASSERT_TRUE(cmsSaveProfileToFile(printer, at("printer.icc").c_str()));
        cmsCloseProfile(printer);
        cmsCloseProfile(device);
        cmsCloseProfile(lab);
        write_picture(folder_ / "a.exr", {64, 64}, soft);
    }
};

// Little CMS' own way from Lab to 8 bits, for the colours of a float print in the same space.
TEST_F(PrinterProfile, CodesAreThoseOfLittleCms) {
    for (const bool compensation : {true, false}) {
        ConvertOptions options;
        options.profile = at("printer.icc");
        options.dither = color::Dither::kNone;
        options.replace = true;
        options.rendering.black_point_compensation = compensation;
        const Result<ConvertReport> printed = print("a.exr", "a.png", options);
        ASSERT_TRUE(printed) << printed.error().message;
        options.profile = kTableSpace;
        ASSERT_TRUE(print("a.exr", "a.exr.exr", options));
        const Result<image::ExrReader> reader = image::ExrReader::open(folder_ / "a.exr.exr");
        ASSERT_TRUE(reader);
        std::vector<float> planes(3 * 64 * 64);
        image::ExrReader::Scratch scratch;
        ASSERT_TRUE(
            reader->read(reader->image().data_window, {planes.data(), &planes[64 * 64], &planes[2 * 64 * 64]}, 64, scratch));
        const color::RgbSpace& space = table_space();
        const cmsHPROFILE lab = cmsCreateLab4Profile(nullptr), printer = cmsOpenProfileFromFile(at("printer.icc").c_str(), "r");
        const cmsHTRANSFORM transform =
            cmsCreateTransform(lab, TYPE_Lab_DBL, printer, TYPE_RGB_8, INTENT_RELATIVE_COLORIMETRIC,
                               cmsFLAGS_NOOPTIMIZE | (compensation ? cmsFLAGS_BLACKPOINTCOMPENSATION : 0));
        const image::Decoded png = image::decode_png(folder_ / "a.png");
        EXPECT_FALSE(png.icc.empty());
        const color::Xyz white{0.9642, 1, 0.8249};
        for (std::size_t i = 0; i < 64 * 64; ++i) {
            const std::array<double, 3> xyz =
                space.xyz_from_rgb * std::array{static_cast<double>(planes[i]), static_cast<double>(planes[64 * 64 + i]),
                                                static_cast<double>(planes[2 * 64 * 64 + i])};
            const color::Lab from = color::lab_from_xyz({xyz[0], xyz[1], xyz[2]}, white);
            const double values[] = {from.l, from.a, from.b};
            std::uint8_t expected[3];
            cmsDoTransform(transform, values, expected, 1);
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(static_cast<int>(png.pixels[3 * i + c]), static_cast<int>(expected[c]), 1) << i << ' ' << c;
        }
        cmsDeleteTransform(transform);
        cmsCloseProfile(lab);
        cmsCloseProfile(printer);
    }
}

// Soft colours of middle lightness are inside both gamuts: there the proof is the print, but for the coarse steps of the tables.
TEST_F(PrinterProfile, AProofOfColoursThatThePrinterHasIsThePrint) {
    ConvertOptions plain, proof;
    plain.dither = proof.dither = color::Dither::kNone;
    proof.proof = at("printer.icc");
    ASSERT_TRUE(print("a.exr", "1.png", plain));
    const Result<ConvertReport> shown = print("a.exr", "2.png", proof);
    ASSERT_TRUE(shown) << shown.error().message;
    const image::Decoded a = image::decode_png(folder_ / "1.png"), b = image::decode_png(folder_ / "2.png");
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const int one = static_cast<int>(a.pixels[i]), two = static_cast<int>(b.pixels[i]);
        if (one < 90 || one > 200) continue;
        sum += std::abs(one - two);
        ++count;
    }
    EXPECT_GT(count, 1000);
    EXPECT_LT(sum / count, 3);
    // A green that only the display has becomes one that the printer has: bluer.
    write_picture(folder_ / "g.exr", {8, 8}, [](int, int) -> std::array<float, 3> { return {0.18f, 0.36f, 0.06f}; });
    ASSERT_TRUE(print("g.exr", "3.png", plain));
    ASSERT_TRUE(print("g.exr", "4.png", proof));
    EXPECT_GT(static_cast<int>(image::decode_png(folder_ / "4.png").pixels[2]),
              static_cast<int>(image::decode_png(folder_ / "3.png").pixels[2]) + 10);
}

// Three pixels of a green that sRGB has, but the printer lacks; five of a grey.
TEST_F(PrinterProfile, OutOfGamutIsWhatThePrinterLacks) {
    write_picture(folder_ / "g.exr", {8, 1}, [](int x, int) -> std::array<float, 3> {
        if (x < 3) return {0.18f, 0.36f, 0.06f};
        return {0.285f, 0.3f, 0.327f};
    });
    for (const bool compensation : {true, false}) {
        ConvertOptions options;
        options.replace = true;
        options.rendering.black_point_compensation = compensation;
        EXPECT_EQ(print("g.exr", "a.png", options)->print.out_of_gamut, 0u);
        ConvertOptions printed = options;
        printed.profile = at("printer.icc");
        EXPECT_EQ(print("g.exr", "a.png", printed)->print.out_of_gamut, 3u);
        options.proof = at("printer.icc");
        options.show_clipped = true;
        EXPECT_EQ(print("g.exr", "a.png", options)->print.out_of_gamut, 3u);
        const image::Decoded png = image::decode_png(folder_ / "a.png");
        for (std::size_t x = 0; x < 8; ++x) {
            const bool magenta = png.pixels[3 * x] == std::byte{255} && png.pixels[3 * x + 1] == std::byte{0};
            EXPECT_EQ(magenta, x < 3) << x;
        }
    }
}

TEST_F(PrinterProfile, AProofNamesTheDeviceAndHowItRenders) {
    for (const std::string intent : {"relative", "absolute"}) {
        const testing::Outcome text = run_tool(
            {at("a.exr"), "-o", at("a.exr.exr"), "--proof", at("printer.icc"), "--show", "clipped", "--intent", intent, "--force"});
        ASSERT_EQ(text.status, 0) << text.err;
        const bool compensated = intent == "relative";
        const std::string said = compensated ? "relative, with black point compensation" : "absolute";
        for (const std::string& line : {std::string("shown          a proof, clipped\n"),
                                        std::string("proof          ICC profile\n"), "intent         " + said + "\n"})
            EXPECT_NE(text.out.find(line), std::string::npos) << text.out;
        const std::string file = testing::read_text(folder_ / "a.exr.exr");
        for (const char* key : {"latent:shown", "a proof, clipped", "latent:proof", "ICC profile", "latent:intent"})
            EXPECT_NE(file.find(key), std::string::npos) << key;
        EXPECT_EQ(file.find("latent:blackPointCompensation") != std::string::npos, compensated);
    }
    const testing::Outcome refused = run_tool({at("a.exr"), "-o", at("b.exr"), "--profile", at("printer.icc")});
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find("tables"), std::string::npos) << refused.err;
}

TEST_F(PrinterProfile, BrokenOnesAreRefusedOrHarmless) {
    const std::string bytes = testing::read_text(folder_ / "printer.icc");
    std::uint32_t state = 1;
    const auto random = [&] { return state = state * 1664525 + 1013904223; };
    int refused = 0;
    for (int i = 0; i < 24; ++i) {
        std::string broken = i % 3 == 0 ? bytes.substr(0, random() % bytes.size()) : bytes;
        for (int k = 0; k < 4 && !broken.empty(); ++k)
            broken[random() % (i % 3 == 1 ? std::min<std::size_t>(400, broken.size()) : broken.size())] =
                static_cast<char>(random() >> 24);
        std::ofstream(folder_ / "broken.icc", std::ios::binary) << broken;
        ConvertOptions options;
        options.profile = at("broken.icc");
        options.replace = true;
        const Result<ConvertReport> printed = print("a.exr", "b.png", options);
        refused += !printed;
        if (!printed) {
            EXPECT_TRUE(printed.error().message.find("broken.icc") != std::string::npos ||
                        printed.error().message.find("profile 'ICC'") != std::string::npos)  // libpng looks at it, too
                << printed.error().message;
        }
    }
    EXPECT_GT(refused, 6);
}

}  // namespace
}  // namespace latent::convert
