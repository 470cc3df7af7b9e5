// Prints beside those of other programs: Little CMS' transicc, oiiotool, exiftool, tiffinfo and Chromium (scripts/install test).
#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "color/difference.h"
#include "image/exr_reader.h"
#include "tests/convert/test_picture.h"
#include "tools/convert/device.h"

namespace latent::convert {
namespace {

constexpr int kSide = 64, kPixels = kSide * kSide;

// Greys and colours from black to white.
std::array<float, 3> soft_colours(int x, int y) {
    const float light = std::exp2(-8 + 11 * static_cast<float>(y) / kSide);
    return {light * (0.75f + 0.45f * static_cast<float>(x) / kSide), light, light * (1.5f - 1.1f * static_cast<float>(x) / kSide)};
}

class Peers : public PrintTest {
 protected:
    static constexpr const char* kInks = "/usr/share/color/icc/ghostscript/default_cmyk.icc";

    void SetUp() override { write_picture(folder_ / "a.exr", {kSide, kSide}, soft_colours); }

    std::string peer(std::vector<std::string> command) const {
        command.insert(command.begin(), "/usr/bin/env");
        const testing::Outcome outcome = testing::run(command);
        EXPECT_EQ(outcome.status, 0) << command[1] << ": " << outcome.err << " (scripts/install test)";
        return outcome.out;
    }

    // Code values, 0..100, of linear light in table_space() with this profile.
    std::vector<double> codes_of_transicc(const std::filesystem::path& light, const std::vector<std::string>& options) const {
        const Result<image::ExrReader> reader = image::ExrReader::open(light);
        EXPECT_TRUE(reader);
        if (!reader) return {};
        std::vector<float> planes(3 * kPixels);
        image::ExrReader::Scratch scratch;
        EXPECT_TRUE(
            reader->read(reader->image().data_window, {planes.data(), &planes[kPixels], &planes[2 * kPixels]}, kSide, scratch));
        std::ofstream lab(folder_ / "lab.txt");
        for (std::size_t i = 0; i < kPixels; ++i) {
            const auto value = [&](std::size_t c) { return static_cast<double>(planes[c * kPixels + i]); };
            const std::array<double, 3> xyz = table_space().xyz_from_rgb * std::array{value(0), value(1), value(2)};
            const color::Lab from = color::lab_from_xyz({xyz[0], xyz[1], xyz[2]}, {0.9642, 1, 0.8249});
            lab << fmt::format("{:.6f} {:.6f} {:.6f}\n", from.l, from.a, from.b);
        }
        lab.close();
        std::string command = fmt::format("transicc '-i*Lab4' -o{} -n -c0", kInks);
        for (const std::string& option : options) command += " " + option;
        std::istringstream numbers(peer({"sh", "-c", command + " <" + at("lab.txt")}));
        std::vector<double> codes;
        for (double code = 0; numbers >> code;) codes.push_back(code);
        return codes;
    }

    // What Chromium shows of a file, on a display of sRGB.
    image::Decoded seen_by_chromium(const std::string& name) const {
        std::ofstream(folder_ / "page.html") << "<style>body{margin:0}img{display:block}</style><img src='" << name << "'>";
        peer({"chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
              "--disable-background-networking", "--hide-scrollbars", "--force-color-profile=srgb", "--force-device-scale-factor=1",
              "--window-size=64,64", "--user-data-dir=" + at("chromium"), "--screenshot=" + at("seen.png"),
              "file://" + at("page.html")});
        return image::decode_png(folder_ / "seen.png");
    }
};

TEST_F(Peers, InksAreThoseOfTransicc) {
    const std::pair<Intent, const char*> intents[] = {
        {Intent::kPerceptual, "-t0"}, {Intent::kRelative, "-t1"}, {Intent::kSaturation, "-t2"}, {Intent::kAbsolute, "-t3"}};
    for (const auto& [intent, option] : intents) {
        for (const bool compensation : {true, false}) {
            if (compensation && intent == Intent::kAbsolute) continue;  // which has none
            SCOPED_TRACE(fmt::format("{} {}", option, compensation));
            ConvertOptions options;
            options.profile = kInks;
            options.dither = color::Dither::kNone;
            options.replace = true;
            options.rendering = {intent, compensation};
            const Result<ConvertReport> printed = print("a.exr", "a.tif", options);
            ASSERT_TRUE(printed) << printed.error().message;
            options.profile = kTableSpace;
            ASSERT_TRUE(print("a.exr", "light.exr", options));
            std::vector<std::string> how = {option};
            if (compensation) how.push_back("-b");
            const std::vector<double> expected = codes_of_transicc(folder_ / "light.exr", how);
            const image::Decoded tiff = image::decode_tiff(folder_ / "a.tif")[0];
            EXPECT_EQ(tiff.format.channels, 4);
            EXPECT_FALSE(tiff.icc.empty());
            ASSERT_EQ(expected.size(), 4u * kPixels);
            ASSERT_EQ(tiff.pixels.size(), 4u * kPixels);
            for (std::size_t i = 0; i < expected.size(); ++i)
                ASSERT_NEAR(static_cast<int>(tiff.pixels[i]), 2.55 * expected[i], 1) << i / 4 << ' ' << i % 4;
        }
    }
}

TEST_F(Peers, OtherFilesOfInksHoldTheSame) {
    ConvertOptions options;
    options.profile = kInks;
    options.dither = color::Dither::kNone;
    options.quality = 100;
    ASSERT_TRUE(print("a.exr", "a.tif", options));
    ASSERT_TRUE(print("a.exr", "a.jpg", options));
    options.tiles = options.pyramid = true;
    options.depth = Depth::k16;
    ASSERT_TRUE(print("a.exr", "deep.tif", options));
    const image::Decoded eight = image::decode_tiff(folder_ / "a.tif")[0], sixteen = image::decode_tiff(folder_ / "deep.tif")[0],
                         jpeg = image::decode_jpeg(folder_ / "a.jpg");
    const auto* deep = reinterpret_cast<const std::uint16_t*>(sixteen.pixels.data());
    ASSERT_EQ(jpeg.format.channels, 4);
    EXPECT_EQ(jpeg.icc, eight.icc);
    for (std::size_t i = 0; i < 4 * kPixels; ++i) {
        ASSERT_NEAR(static_cast<int>(eight.pixels[i]), deep[i] / 257.0, 0.51) << i;
        ASSERT_NEAR(static_cast<int>(eight.pixels[i]), static_cast<int>(jpeg.pixels[i]), 3) << i;  // quality 100 rounds once more
    }
    ConvertOptions plain;
    plain.profile = kInks;
    for (const char* name : {"a.png", "a.dzi", "a.exr.exr"}) {
        const Result<ConvertReport> refused = print("a.exr", name, plain);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
        EXPECT_NE(refused.error().message.find("CMYK"), std::string::npos);
    }
    plain.depth = Depth::kFloat;
    EXPECT_FALSE(print("a.exr", "float.tif", plain));
}

TEST_F(Peers, ASoftProofOfInksLacksWhatPaperCannotShow) {
    ConvertOptions options;
    options.dither = color::Dither::kNone;
    ASSERT_TRUE(print("a.exr", "plain.png", options));
    options.proof = kInks;
    const Result<ConvertReport> shown = print("a.exr", "proof.png", options);
    ASSERT_TRUE(shown) << shown.error().message;
    write_picture(folder_ / "blue.exr", {8, 8}, [](int, int) -> std::array<float, 3> { return {0.18f, 0.0722f, 0.95f}; });
    ASSERT_TRUE(print("blue.exr", "proof2.png", options));
    const image::Decoded blue = image::decode_png(folder_ / "proof2.png");
    EXPECT_GT(static_cast<int>(blue.pixels[0]), 20);  // no ink is as blue as the display
}

// Little CMS and OpenImageIO share no code with ours: the same matrix and curve.
TEST_F(Peers, CodesAreThoseOfOiiotool) {
    ConvertOptions options;
    options.tone = "none";
    options.dither = color::Dither::kNone;
    options.sensitivity = 0.75;
    ASSERT_TRUE(print("a.exr", "a.tif", options));
    const auto& m = color::RgbSpace::srgb().rgb_from_xyz.m;
    std::string matrix;  // of columns
    for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) matrix += fmt::format("{}{:.9g}", matrix.empty() ? "" : ",", 0.75 * m[i][j]);
    }
    peer({"oiiotool", at("a.exr"), "--ccmatrix", matrix, "--clamp:min=0:max=1", "--colorconvert", "linear", "sRGB", "-d", "uint8",
          "-o", at("b.tif")});
    const image::Decoded ours = image::decode_tiff(folder_ / "a.tif")[0], theirs = image::decode_tiff(folder_ / "b.tif")[0];
    ASSERT_EQ(ours.pixels.size(), theirs.pixels.size());
    int most = 0, between = 0;
    for (std::size_t i = 0; i < ours.pixels.size(); ++i) {
        const int a = static_cast<int>(ours.pixels[i]), b = static_cast<int>(theirs.pixels[i]);
        most = std::max(most, std::abs(a - b));
        between += a > 0 && a < 255;
    }
    EXPECT_LE(most, 1);
    EXPECT_GT(between, 3 * kPixels / 2);
}

TEST_F(Peers, ExiftoolAndTiffinfoReadTheTags) {
    ConvertOptions options;
    options.profile = "display-p3";
    options.dpi = 254;
    for (const char* name : {"a.png", "a.tif", "a.jpg"}) ASSERT_TRUE(print("a.exr", name, options));
    const auto tags = nlohmann::json::parse(peer({"exiftool", "-json", at("a.png"), at("a.tif"), at("a.jpg")}));
    ASSERT_EQ(tags.size(), 3u);
    for (const auto& file : tags) {
        SCOPED_TRACE(file["FileName"]);
        EXPECT_EQ(file["ProfileDescription"], "Display P3");
        EXPECT_EQ(file["ImageWidth"], kSide);
        EXPECT_EQ(file["ImageHeight"], kSide);
        EXPECT_FALSE(file.contains("Warning")) << file["Warning"];
    }
    EXPECT_EQ(tags[0]["PixelsPerUnitX"], 10000);
    EXPECT_EQ(tags[0]["PixelUnits"], "meters");
    EXPECT_EQ(tags[0]["Tone"], "film");
    for (const std::size_t i : {1, 2}) {
        EXPECT_EQ(tags[i]["XResolution"], 254);
        EXPECT_EQ(tags[i]["ResolutionUnit"], "inches");
    }
    EXPECT_NE(tags[1]["ImageDescription"].get<std::string>().find("Profile: display-p3"), std::string::npos);
    EXPECT_NE(tags[1]["Software"].get<std::string>().find("latent-convert"), std::string::npos);
    EXPECT_NE(tags[2]["Comment"].dump().find("latent-convert"), std::string::npos);
    const std::string info = peer({"tiffinfo", at("a.tif")});
    for (const char* line : {"Image Width: 64 Image Length: 64", "Resolution: 254, 254 pixels/inch", "Bits/Sample: 8",
                             "Photometric Interpretation: RGB color", "ICC Profile: <present>"})
        EXPECT_NE(info.find(line), std::string::npos) << line << info;
}

// Shown on a display of sRGB, a print for another display that is tagged rightly is the print for sRGB.
TEST_F(Peers, ChromiumReadsTheProfiles) {
    write_picture(folder_ / "a.exr", {kSide, kSide}, [](int x, int y) -> std::array<float, 3> {
        const float light = std::exp2(-4 + 4 * static_cast<float>(y) / kSide);
        return {light * (0.85f + 0.25f * static_cast<float>(x) / kSide), light,
                light * (1.3f - 0.9f * static_cast<float>(x) / kSide)};
    });
    ConvertOptions options;
    options.dither = color::Dither::kNone;
    options.quality = 100;
    options.replace = true;
    const Result<ConvertReport> printed = print("a.exr", "srgb.png", options);
    ASSERT_TRUE(printed);
    ASSERT_EQ(printed->print.out_of_gamut, 0u);  // so no gamut is mapped
    const image::Decoded expected = image::decode_png(folder_ / "srgb.png");
    const std::string wide = "0.708,0.292,0.17,0.797,0.131,0.046,0.3127,0.329";
    for (const std::string& profile :
         {std::string("srgb"), std::string("display-p3"), std::string("adobe-rgb"), std::string("rec2020"), wide}) {
        for (const char* name : {"a.png", "a.jpg"}) {
            SCOPED_TRACE(fmt::format("{} {}", profile, name));
            options.profile = profile;
            ASSERT_TRUE(print("a.exr", name, options));
            const image::Decoded seen = seen_by_chromium(name);
            ASSERT_EQ(seen.format.width, kSide);
            ASSERT_EQ(seen.pixels.size(), expected.pixels.size());
            const image::Decoded codes =
                name == std::string("a.png") ? image::decode_png(folder_ / name) : image::decode_jpeg(folder_ / name);
            const auto distance = [&](const image::Decoded& from) {
                int most = 0;
                for (std::size_t i = 0; i < seen.pixels.size(); ++i)
                    most = std::max(most, std::abs(static_cast<int>(from.pixels[i]) - static_cast<int>(expected.pixels[i])));
                return most;
            };
            EXPECT_LE(distance(seen), name == std::string("a.png") ? 3 : 8);  // JPEG rounds its own transform, too
            if (profile != "srgb") {
                EXPECT_GT(distance(codes), 9);
            }
        }
    }
}

}  // namespace
}  // namespace latent::convert
