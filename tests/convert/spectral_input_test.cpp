// Spectral pictures, as they are laid out by many renderers [Fichet21], seen by an observer and printed.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "color/camera.h"
#include "color/named_spectra.h"
#include "color/observer.h"
#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

constexpr int kColumns = 24, kRows = 4;

struct NamedPlane {
    std::string channel;
    std::function<double(int x, int y)> value;
};

void write_planes(const std::filesystem::path& path, const std::vector<NamedPlane>& planes) {
    Imf::Header header(kColumns, kRows);
    header.compression() = Imf::ZIP_COMPRESSION;
    std::vector<std::vector<float>> values(planes.size());
    Imf::FrameBuffer frame;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        for (int y = 0; y < kRows; ++y) {
            for (int x = 0; x < kColumns; ++x) values[i].push_back(static_cast<float>(planes[i].value(x, y)));
        }
        header.channels().insert(planes[i].channel, Imf::Channel(Imf::FLOAT));
        frame.insert(planes[i].channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values[i].data()), 4, 4 * kColumns));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(kRows);
}

// A patch of the ColorChecker in each column, under daylight, brighter from row to row; W m^-2 sr^-1 nm^-1.
double radiance(double nm, int x, int y) {
    return color::color_checker()[static_cast<std::size_t>(x)](nm) * color::illuminant_d65()(nm) * std::exp2(y - 2) / 7.2e6;
}
color::Spectrum spectrum(int x, int y) {
    return color::Spectrum::from_function([&](double nm) { return radiance(nm, x, y); }, color::Outside::kZero);
}

using ChannelName = std::function<std::string(double nm)>;
std::string with_comma(double nm) {
    std::string name = fmt::format("S0.{:.3f}nm", nm);
    name[name.rfind('.')] = ',';
    return name;
}

// Means over bins of 5 nm.
std::vector<NamedPlane> bins(const ChannelName& name) {
    std::vector<NamedPlane> planes;
    for (double nm = 362.5; nm < 830; nm += 5)
        planes.push_back({name(nm), [nm](int x, int y) {
                              double sum = 0;
                              for (const double step : {-2, -1, 0, 1, 2}) sum += radiance(nm + step, x, y);
                              return sum / 5;
                          }});
    return planes;
}

class SpectralInput : public PrintTest {
 protected:
    // The prints of a spectral file and of the pixels that the observer sees, channel by channel.
    void expect_same_print(const std::string& observer, const std::string& file, double codes) {
        color::Observer seen_by = *color::Observer::by_name(observer);
        const color::Chromaticity neutral = seen_by.neutral();
        if (seen_by.kind() == color::ObserverKind::kCamera) seen_by = seen_by.as_eye(color::fit_camera(seen_by)->xyz_from_rgb);
        std::vector<std::array<double, 3>> seen;
        for (int y = 0; y < kRows; ++y) {
            for (int x = 0; x < kColumns; ++x) {
                const color::Xyz xyz = color::xyz_from_spectrum(spectrum(x, y), seen_by);
                seen.push_back({683 * xyz.x, 683 * xyz.y, 683 * xyz.z});
            }
        }
        std::vector<NamedPlane> xyz;
        for (std::size_t c = 0; c < 3; ++c)
            xyz.push_back({std::string(1, "XYZ"[c]),
                           [&seen, c](int x, int y) { return seen[static_cast<std::size_t>(y * kColumns + x)][c]; }});
        write_planes(folder_ / "xyz.exr", xyz);
        ConvertOptions of_spectrum, of_xyz;
        of_spectrum.observer = observer;
        of_xyz.white = White{neutral};
        for (ConvertOptions* options : {&of_spectrum, &of_xyz}) {
            options->dither = color::Dither::kNone;
            options->replace = true;
        }
        const Result<ConvertReport> printed = print(file, "a.png", of_spectrum);
        ASSERT_TRUE(printed) << printed.error().message;
        EXPECT_EQ(printed->observer, observer);
        ASSERT_TRUE(print("xyz.exr", "b.png", of_xyz));
        const image::Decoded a = image::decode_png(folder_ / "a.png"), b = image::decode_png(folder_ / "b.png");
        int least = 255, most = 0;
        for (std::size_t i = 0; i < a.pixels.size(); ++i) {
            ASSERT_NEAR(static_cast<int>(a.pixels[i]), static_cast<int>(b.pixels[i]), codes) << observer << ' ' << i;
            least = std::min(least, static_cast<int>(a.pixels[i]));
            most = std::max(most, static_cast<int>(a.pixels[i]));
        }
        EXPECT_LT(least, 60);
        EXPECT_GT(most, 200);
        EXPECT_EQ(std::ranges::count(a.texts, std::pair<std::string, std::string>("Observer", observer)), 1);
    }
};

TEST_F(SpectralInput, ObserversSeeInItWhatTheySeeInTheLight) {
    write_planes(folder_ / "s.exr", bins(with_comma));
    for (const char* observer : {"cie1931", "cie1964", "canon_eos_5d", "kodak_trix_400"}) expect_same_print(observer, "s.exr", 1);
}

TEST_F(SpectralInput, WavelengthsMayHaveAnyUnit) {
    const ChannelName micrometres = [](double nm) { return fmt::format("S0.{:.4f}um", nm / 1000); };
    const ChannelName terahertz = [](double nm) { return fmt::format("S0.{:.9f}THz", 299792.458 / nm); };
    for (const ChannelName& name : {micrometres, terahertz}) {
        write_planes(folder_ / "s.exr", bins(name));
        expect_same_print("cie1931", "s.exr", 1);
    }
}

TEST_F(SpectralInput, OtherChannelsBesideItDoNotMatter) {
    std::vector<NamedPlane> planes = bins(with_comma);
    for (const char* other : {"A", "S1.500,000nm", "S3.500,000nm", "depth.Z", "S0.weight"})
        planes.push_back({other, [](int, int) { return 7.0; }});
    write_planes(folder_ / "s.exr", planes);
    expect_same_print("cie1931", "s.exr", 1);
}

TEST_F(SpectralInput, ALayerIsPrintedLikeAPictureOfItsOwn) {
    const auto plane = [](const char* channel, double light) { return NamedPlane{channel, [light](int, int) { return light; }}; };
    write_planes(folder_ / "plain.exr", {plane("R", 0.1), plane("G", 0.2), plane("B", 0.3)});
    write_planes(folder_ / "layers.exr", {plane("view.combined.R", 0.1), plane("view.combined.G", 0.2),
                                          plane("view.combined.B", 0.3), plane("view.combined.A", 1), plane("view.depth.Z", 7),
                                          plane("albedo.R", 0.5), plane("albedo.G", 0.5), plane("albedo.B", 0.5)});
    ConvertOptions options;
    ASSERT_TRUE(print("plain.exr", "plain.png", options));
    options.layer = "view.combined";
    const Result<ConvertReport> printed = print("layers.exr", "layer.png", options);
    ASSERT_TRUE(printed) << printed.error().message;
    EXPECT_EQ(image::decode_png(folder_ / "plain.png").pixels, image::decode_png(folder_ / "layer.png").pixels);
    const testing::Outcome none = run_tool({at("layers.exr"), "-o", at("a.png")});
    EXPECT_EQ(none.status, 2);
    EXPECT_NE(none.err.find("choose one with --layer: albedo, view.combined\n"), std::string::npos) << none.err;
    const testing::Outcome wrong = run_tool({at("layers.exr"), "-o", at("a.png"), "--layer", "normal"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_NE(wrong.err.find("no layer normal; the file has albedo, view.combined\n"), std::string::npos) << wrong.err;
}

TEST_F(SpectralInput, APreviewIsPrintedUnlessAnObserverIsNamed) {
    std::vector<NamedPlane> planes = bins(with_comma);
    for (const char* channel : {"R", "G", "B"}) planes.push_back({channel, [](int, int) { return 0.25; }});
    write_planes(folder_ / "s.exr", planes);
    ASSERT_TRUE(print("s.exr", "preview.png"));
    const image::Decoded preview = image::decode_png(folder_ / "preview.png");
    EXPECT_NEAR(static_cast<int>(preview.pixels[0]), static_cast<int>(preview.pixels.back()), 1);
    expect_same_print("cie1931", "s.exr", 1);
}

TEST_F(SpectralInput, WhatCannotBeSeenIsRefusedInOneLine) {
    const auto one = [](int, int) { return 1.0; };
    const auto refused = [&](const std::vector<NamedPlane>& planes, std::vector<std::string> options, const char* words) {
        write_planes(folder_ / "s.exr", planes);
        options.insert(options.begin(), {at("s.exr"), "-o", at("s.png")});
        const testing::Outcome outcome = run_tool(options);
        EXPECT_NE(outcome.status, 0) << words;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(folder_ / "s.png"));
    };
    const std::vector<NamedPlane> rgb{{"R", one}, {"G", one}, {"B", one}}, light{{"S0.500nm", one}, {"S0.600nm", one}};
    refused({{"S0.550,000nm", one}}, {}, "a spectrum of a single channel");
    refused({{"S0.550,0nm", one}, {"S0.0,55um", one}}, {}, "has the same wavelength as another channel");
    refused({{"T.500,000nm", one}, {"T.600,000nm", one}}, {}, "holds spectra of reflectance");
    refused({{"S0.1500,000nm", one}, {"S0.1600,000nm", one}}, {}, "is invisible to cie1931");
    refused(rgb, {"--observer", "cie1964"}, "has no spectrum");
    refused(light, {"--observer", "canon"}, "did you mean canon_eos_5d");
    refused(light, {"--observer", "none.csv"}, "no such file");
    refused(light, {"--input-space", "srgb"}, "--input-space");
    refused(rgb, {"--input-space", "sgrb"}, "is not an RGB space");
}

TEST_F(SpectralInput, ABrokenTableOfAnObserverIsRefusedWithItsLine) {
    write_planes(folder_ / "s.exr", bins(with_comma));
    const std::pair<const char*, const char*> tables[] = {
        {"400,0\n500,1\n450,1\n700,0\n", "line 3"},
        {"400,0\n500,-1\n600,1\n700,0\n", "line 2"},
        {"380,0\n400,1\n500,1\n700,0\n", "500"},
        {"450,1\n470,1\n490,1\n510,1\n", "450"},
        {"wavelength;r\n", "two lines"},
    };
    for (const auto& [table, words] : tables) {
        std::ofstream(folder_ / "o.csv") << table;
        const testing::Outcome outcome = run_tool({at("s.exr"), "-o", at("s.png"), "--observer", at("o.csv")});
        EXPECT_EQ(outcome.status, 1) << table;
        EXPECT_NE(outcome.err.find("o.csv"), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    }
}

// Without chromaticities, the space has to be guessed, or named.
TEST_F(SpectralInput, ASpaceCanBeNamedIfTheFileHasNone) {
    write_picture(folder_ / "with.exr",
                  {kColumns, kRows, {}, 0, false, std::array{0.7f, 0.3f, 0.17f, 0.8f, 0.13f, 0.05f, 0.3127f, 0.329f}});
    PictureLayout without{kColumns, kRows};
    without.chromaticities.reset();
    write_picture(folder_ / "without.exr", without);
    const testing::Outcome guessed = run_tool({at("without.exr"), "-o", at("a.png")});
    EXPECT_EQ(guessed.status, 0);
    EXPECT_NE(guessed.err.find("has no chromaticities"), std::string::npos);
    const testing::Outcome named = run_tool(
        {at("without.exr"), "-o", at("b.png"), "--sensitivity", "1", "--input-space", "0.7,0.3,0.17,0.8,0.13,0.05,0.3127,0.329"});
    EXPECT_EQ(named.status, 0);
    EXPECT_EQ(named.err, "");
    ASSERT_TRUE(print("with.exr", "c.png"));
    EXPECT_NE(image::decode_png(folder_ / "a.png").pixels, image::decode_png(folder_ / "b.png").pixels);
    const image::Decoded b = image::decode_png(folder_ / "b.png"), c = image::decode_png(folder_ / "c.png");
    for (std::size_t i = 0; i < b.pixels.size(); ++i) ASSERT_NEAR(static_cast<int>(b.pixels[i]), static_cast<int>(c.pixels[i]), 1);
}

}  // namespace
}  // namespace latent::convert
