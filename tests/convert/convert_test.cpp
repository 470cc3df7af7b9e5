// The laws of printing files: what each format holds, that threads and memory change no byte, that a crop is a part of the whole.
#include "tools/convert/convert.h"

#include <ImfInputFile.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "color/adaptation.h"
#include "color/quantise.h"
#include "image/exr_reader.h"
#include "tests/convert/test_picture.h"
#include "tests/support/sanitizers.h"
#include "tools/convert/display.h"

namespace latent::convert {
namespace {

using image::Decoded;
using image::Rect;

// The print of colourful(x, y) by color's reference in double.
color::Rgb reference(const color::Print& print, int x, int y) {
    color::PrintReport ignored;
    const std::array<float, 3> light = colourful(x, y);
    return print.pixel({static_cast<double>(light[0]), static_cast<double>(light[1]), static_cast<double>(light[2])}, ignored);
}

color::Print print_for(const color::RgbSpace& space, double sigma = 1, const char* gamut = "luminance") {
    const color::Matrix3 adaptation =
        *color::adaptation_matrix({static_cast<double>(0.3127f), static_cast<double>(0.3290f)}, space.primaries.white);
    return *color::Print::create(space, {sigma, color::Tone::kFilm, *color::gamut_by_name(gamut), adaptation});
}

std::vector<float> read_exr(const std::string& path, Rect& window) {
    const Result<image::ExrReader> reader = image::ExrReader::open(path);
    EXPECT_TRUE(reader);
    window = reader->image().data_window;
    const std::size_t count = window.pixels();
    std::vector<float> planes(3 * count), out(3 * count);
    image::ExrReader::Scratch scratch;
    EXPECT_TRUE(reader->read(window, {planes.data(), planes.data() + count, planes.data() + 2 * count},
                             static_cast<std::size_t>(window.width()), scratch));
    for (std::size_t i = 0; i < 3 * count; ++i) out[i] = planes[i % 3 * count + i / 3];
    return out;
}

using Convert = PrintTest;

TEST_F(Convert, SixteenBitsAndFloatsAreTheReferencePrint) {
    write_picture(folder_ / "a.exr", {});
    for (const std::string profile : {"srgb", "display-p3", "rec2020", "adobe-rgb"}) {
        for (const char* gamut : {"luminance", "grey"}) {
            SCOPED_TRACE(profile + " " + gamut);
            const color::RgbSpace space = *color::RgbSpace::parse(profile);
            const color::Print exact = print_for(space, 2.5, gamut);
            ConvertOptions options;
            options.profile = profile;
            options.gamut = gamut;
            options.sensitivity = 1.25;
            options.stops = {1};
            options.replace = true;
            options.depth = Depth::k16;
            ASSERT_TRUE(print("a.exr", "a.png", options));
            ASSERT_TRUE(print("a.exr", "a.tif", options));
            options.depth = Depth::kFloat;
            ASSERT_TRUE(print("a.exr", "f.tif", options));
            ASSERT_TRUE(print("a.exr", "f.exr", options));
            const Decoded png = image::decode_png(folder_ / "a.png"), tif = image::decode_tiff(folder_ / "a.tif").at(0);
            const Decoded floats = image::decode_tiff(folder_ / "f.tif").at(0);
            Rect window;
            const std::vector<float> linear = read_exr(at("f.exr"), window);
            ASSERT_EQ(png.format.width, 300);
            EXPECT_TRUE(png.pixels == tif.pixels);
            const auto* codes = reinterpret_cast<const std::uint16_t*>(png.pixels.data());
            const auto* encoded = reinterpret_cast<const float*>(floats.pixels.data());
            std::size_t i = 0, wrong = 0;
            for (int y = 0; y < 200; ++y) {
                for (int x = 0; x < 300; ++x) {
                    const color::Rgb rgb = reference(exact, x, y);
                    for (const double value : {rgb.r, rgb.g, rgb.b}) {
                        // Rows are printed in float: luminance is right to 1e-6 [color/print.h], blue has as little as 0.06 of it.
                        wrong += std::abs(static_cast<double>(linear[i]) - value) > 1e-6 / 0.05;
                        const double code = space.transfer.encode(static_cast<double>(linear[i]));
                        wrong += encoded[i] != static_cast<float>(code);
                        wrong += std::abs(codes[i] - 65535 * code) > 0.51;
                        ++i;
                    }
                }
            }
            EXPECT_EQ(wrong, 0u);
        }
    }
}

TEST_F(Convert, EightBitsAreTheReferencePrintToHalfAStepAndItsDither) {
    write_picture(folder_ / "a.exr", {});
    const color::Print exact = print_for(color::RgbSpace::srgb());
    for (const bool dither : {false, true}) {
        ConvertOptions options;
        options.dither = dither ? color::Dither::kRandom : color::Dither::kNone;
        const std::string name = dither ? "d.png" : "p.png";
        ASSERT_TRUE(print("a.exr", name, options));
        const Decoded png = image::decode_png(folder_ / name);
        std::size_t i = 0;
        double worst = 0, sum = 0;
        for (int y = 0; y < 200; ++y) {
            for (int x = 0; x < 300; ++x) {
                const color::Rgb rgb = reference(exact, x, y);
                for (const double value : {rgb.r, rgb.g, rgb.b}) {
                    const double error = static_cast<int>(png.pixels[i++]) - 255 * color::Transfer::srgb().encode(value);
                    worst = std::max(worst, std::abs(error));
                    sum += error;
                }
            }
        }
        EXPECT_LT(worst, (dither ? 1.0 : 0.5) + 255 * 3e-5);
        // The mean error of n dithered values has a standard deviation of at most 1/2 / sqrt(n): five of them.
        EXPECT_LT(std::abs(sum / static_cast<double>(i)), 2.5 / std::sqrt(static_cast<double>(i)));
    }
}

TEST_F(Convert, ThreadsMemoryAndTheInputsLayoutChangeNoByte) {
    const int width = 900, height = 1000;
    write_picture(folder_ / "rows.exr", {width, height});
    write_picture(folder_ / "zip.exr", {width, height, {}, 0, true});
    write_picture(folder_ / "tiles.exr", {width, height, {}, 64});
    write_picture(folder_ / "ziptiles.exr", {width, height, {}, 256, true});
    struct Case {
        std::string input;
        int threads;
        std::uint64_t mebibytes;
    };
    const std::vector<Case> cases{{"rows.exr", 1, 1024}, {"rows.exr", 4, 24},       {"zip.exr", 3, 26},
                                  {"tiles.exr", 2, 20},  {"ziptiles.exr", 4, 1024}, {"ziptiles.exr", 1, 20}};
    int number = 0;
    for (const Case& c : cases) {
        SCOPED_TRACE(c.input + " threads " + std::to_string(c.threads) + " memory " + std::to_string(c.mebibytes));
        ConvertOptions options;
        options.threads = c.threads;
        options.memory = c.mebibytes << 20;
        options.input = folder_ / c.input;
        options.pyramid = true;
        const std::string folder = "out" + std::to_string(number++);
        std::filesystem::create_directory(folder_ / folder);
        for (const char* name : {"a.png", "a.tif", "a.jpg", "a.exr", "z.dzi"}) options.outputs.push_back(folder_ / folder / name);
        const Result<ConvertReport> report = convert(options, {});
        ASSERT_TRUE(report) << report.error().message;
        std::size_t files = 0;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / folder)) {
            if (!entry.is_regular_file()) continue;
            ++files;
            const std::filesystem::path first = folder_ / "out0" / std::filesystem::relative(entry.path(), folder_ / folder);
            EXPECT_TRUE(testing::read_text(entry.path()) == testing::read_text(first)) << entry.path();
        }
        EXPECT_GT(files, 30u);
    }
}

TEST_F(Convert, MemoryStaysWithinTheBudgetHoweverWideThePictureIs) {
    const auto light = [](int x, int y) {
        return std::array<float, 3>{static_cast<float>(x) / 30000, static_cast<float>(y) / 300, 0.5f};
    };
    write_picture(folder_ / "tiles.exr", {30000, 300, {}, 256, true}, light);
    write_picture(folder_ / "rows.exr", {30000, 300}, light);
    for (const std::string input : {"tiles.exr", "rows.exr"}) {
        for (const std::string output : {"a.dzi", "a.png", "a.tif"}) {
            std::string first;
            for (const long mebibytes : {64, 1024}) {
                SCOPED_TRACE(input + " to " + output + " within " + std::to_string(mebibytes));
                const testing::Outcome outcome = run_tool(
                    {at(input), "-o", at(output), "--force", "--threads", "2", "--memory", std::to_string(mebibytes) + "M"});
                EXPECT_EQ(outcome.status, 0) << outcome.err;
                if (!testing::kSanitized) {
                    EXPECT_LE(outcome.peak_rss_kib, (std::min(mebibytes, 100L) + 100) << 10);
                }
                const std::string text = testing::read_text(folder_ / (output == "a.dzi" ? "a_files/14/7_1.jpg" : output));
                if (first.empty()) first = text;
                EXPECT_TRUE(text == first);
            }
        }
    }
}

TEST_F(Convert, ACropIsThatPartOfTheWholeBitForBit) {
    const Rect window{10, 20, 610, 520}, crop{101, 77, 402, 300};
    write_picture(folder_ / "a.exr", {800, 700, window, 64, true});
    ASSERT_TRUE(print("a.exr", "whole.png"));
    ConvertOptions options;
    options.crop = crop;
    options.png_tiles = true;
    ASSERT_TRUE(print("a.exr", "crop.png", options));
    ASSERT_TRUE(print("a.exr", "crop.exr", options));
    ASSERT_TRUE(print("a.exr", "crop.dzi", options));
    const Decoded whole = image::decode_png(folder_ / "whole.png"), part = image::decode_png(folder_ / "crop.png");
    const Decoded tile = image::decode_png(folder_ / "crop_files" / "9" / "0_0.png");
    EXPECT_EQ(whole.format.width, window.width());
    ASSERT_EQ(part.format.width, crop.width());
    ASSERT_EQ(part.format.height, crop.height());
    for (int y = 0; y < crop.height(); ++y) {
        const std::byte* in_whole = whole.pixels.data() +
                                    static_cast<std::size_t>(y + crop.y0 - window.y0) * whole.format.row_bytes() +
                                    static_cast<std::size_t>(3 * (crop.x0 - window.x0));
        const std::byte* in_part = part.pixels.data() + static_cast<std::size_t>(y) * part.format.row_bytes();
        ASSERT_EQ(std::memcmp(in_whole, in_part, part.format.row_bytes()), 0) << y;
        if (y >= tile.format.height) continue;
        ASSERT_EQ(std::memcmp(tile.pixels.data() + static_cast<std::size_t>(y) * tile.format.row_bytes(), in_part,
                              tile.format.row_bytes()),
                  0)
            << y;
    }
    Imf::InputFile exr(at("crop.exr").c_str());
    EXPECT_EQ(exr.header().dataWindow(), Imath::Box2i({crop.x0, crop.y0}, {crop.x1 - 1, crop.y1 - 1}));
    EXPECT_EQ(exr.header().displayWindow(), Imath::Box2i({0, 0}, {799, 699}));

    options.crop = Rect{0, 0, 100, 100};
    const Result<ConvertReport> outside = print("a.exr", "b.png", options);
    ASSERT_FALSE(outside);
    EXPECT_EQ(outside.error().code, ErrorCode::kUsage);
    EXPECT_NE(outside.error().message.find("10,20"), std::string::npos) << outside.error().message;
}

TEST_F(Convert, TheSameLightPrintsTheSameWhateverTheFileCallsIt) {
    const color::RgbSpace srgb = color::RgbSpace::srgb(), rec2020 = *color::RgbSpace::parse("rec2020");
    const auto in = [](const color::RgbSpace& space) {
        return [&space](int x, int y) {
            const std::array<float, 3> xyz = colourful(x, y);
            const std::array<double, 3> rgb =
                space.rgb_from_xyz *
                std::array<double, 3>{static_cast<double>(xyz[0]), static_cast<double>(xyz[1]), static_cast<double>(xyz[2])};
            return std::array<float, 3>{static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])};
        };
    };
    PictureLayout plain;
    plain.chromaticities = std::nullopt;  // sRGB's primaries, says OpenEXR
    PictureLayout wide;
    wide.chromaticities = std::array<float, 8>{0.708f, 0.292f, 0.17f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.329f};
    PictureLayout named = plain;
    named.channels = {"X", "Y", "Z"};
    write_picture(folder_ / "xyz.exr", {});
    write_picture(folder_ / "named.exr", named);
    write_picture(folder_ / "srgb.exr", plain, in(srgb));
    write_picture(folder_ / "rec2020.exr", wide, in(rec2020));
    ConvertOptions options;
    options.depth = Depth::k16;
    for (const std::string name : {"xyz", "named", "srgb", "rec2020"}) ASSERT_TRUE(print(name + ".exr", name + ".png", options));
    const Decoded xyz = image::decode_png(folder_ / "xyz.png");
    EXPECT_TRUE(image::decode_png(folder_ / "named.png").pixels == xyz.pixels);
    const auto* a = reinterpret_cast<const std::uint16_t*>(xyz.pixels.data());
    for (const std::string name : {"srgb", "rec2020"}) {
        const Decoded other = image::decode_png(folder_ / (name + ".png"));
        const auto* b = reinterpret_cast<const std::uint16_t*>(other.pixels.data());
        // Components of 2^4 light in float: 1e-6 of it, times sensitivity and the steepest part of the curve.
        for (std::size_t i = 0; i < 300 * 200 * 3; ++i) ASSERT_NEAR(a[i], b[i], 20) << name << " " << i;
    }
}

TEST_F(Convert, ColourAndSettingsAreWrittenIntoEveryFormatAndNoPathIs) {
    write_picture(folder_ / "secretname.exr", {});
    ConvertOptions options;
    options.input = folder_ / "secretname.exr";
    for (const char* name : {"a.png", "a.tif", "a.jpg", "a.exr", "z.dzi"}) options.outputs.push_back(folder_ / name);
    options.profile = "display-p3";
    options.sensitivity = 1.75;
    ASSERT_TRUE(convert(options, {}));
    const Bytes icc = display_from("display-p3", std::nullopt)->icc;
    const Decoded png = image::decode_png(folder_ / "a.png"), tif = image::decode_tiff(folder_ / "a.tif").at(0),
                  jpg = image::decode_jpeg(folder_ / "a.jpg");
    EXPECT_EQ(png.icc, icc);
    EXPECT_EQ(tif.icc, icc);
    EXPECT_EQ(jpg.icc, icc);
    EXPECT_EQ(image::decode_jpeg(folder_ / "z_files" / "9" / "0_0.jpg").icc, icc);
    for (const char* name : {"a.png", "a.tif", "a.jpg", "a.exr"}) {
        const std::string text = testing::read_text(folder_ / name);
        for (const char* fact : {"1.75", "luminance", "display-p3", "latent-convert"})
            EXPECT_NE(text.find(fact), std::string::npos) << name << " " << fact;
    }
    Imf::InputFile exr(at("a.exr").c_str());
    EXPECT_NEAR(Imf::chromaticities(exr.header()).green.x, 0.265f, 1e-6f);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
        if (!entry.is_regular_file() || entry.path().filename() == "secretname.exr") continue;
        const std::string text = testing::read_text(entry.path());
        EXPECT_EQ(text.find("secretname"), std::string::npos) << entry.path();
        EXPECT_EQ(text.find(folder_.path().string()), std::string::npos) << entry.path();
    }
    options.profile = "srgb";
    options.replace = true;
    ASSERT_TRUE(convert(options, {}));
    EXPECT_TRUE(image::decode_png(folder_ / "a.png").srgb);
    EXPECT_TRUE(image::decode_png(folder_ / "a.png").icc.empty());
    EXPECT_TRUE(image::decode_jpeg(folder_ / "z_files" / "9" / "0_0.jpg").icc.empty());
}

TEST_F(Convert, EveryFileSaysHowLargeItIsOnPaperButTiles) {
    write_picture(folder_ / "a.exr", {});
    for (const int dpi : {300, 240}) {
        ConvertOptions options;
        options.replace = true;
        if (dpi != 300) options.dpi = dpi;
        for (const char* name : {"a.png", "a.tif", "a.jpg", "print.exr", "z.dzi"}) ASSERT_TRUE(print("a.exr", name, options));
        const Decoded png = image::decode_png(folder_ / "a.png"), jpg = image::decode_jpeg(folder_ / "a.jpg"),
                      tif = image::decode_tiff(folder_ / "a.tif").at(0),
                      tile = image::decode_jpeg(folder_ / "z_files" / "9" / "0_0.jpg");
        for (const auto& [decoded, unit, resolution] : {std::tuple{&tif, 2, dpi}, {&jpg, 1, dpi}, {&tile, 0, 1}}) {
            EXPECT_EQ(decoded->resolution_unit, unit);
            EXPECT_EQ(decoded->x_resolution, resolution);
            EXPECT_EQ(decoded->y_resolution, resolution);
        }
        EXPECT_EQ(png.resolution_unit, 1);  // metre
        EXPECT_EQ(png.x_resolution, dpi == 300 ? 11811 : 9449);
        EXPECT_EQ(png.y_resolution, png.x_resolution);
        EXPECT_EQ(Imf::xDensity(Imf::InputFile(at("print.exr").c_str()).header()), static_cast<float>(dpi));
    }
}

// [H273]: primaries, transfer, no matrix, full range.
TEST_F(Convert, APngCarriesTheCodePointsOfItsProfileBesideItWhereThereAreAny) {
    write_picture(folder_ / "a.exr", {16, 16});
    using Codes = std::array<std::uint8_t, 4>;
    const struct {
        std::string profile;
        std::optional<Codes> codes;
    } cases[] = {
        {"rec2020", std::nullopt},  // programs disagree on the curve of its code point
        {"display-p3", Codes{12, 13, 0, 1}},
        {"0.68,0.32,0.265,0.69,0.15,0.06,0.3127,0.329", Codes{12, 13, 0, 1}},
        {"0.708,0.292,0.17,0.797,0.131,0.046,0.3127,0.329", Codes{9, 13, 0, 1}},
        {"0.64,0.33,0.29,0.6,0.15,0.06,0.3127,0.329", Codes{5, 13, 0, 1}},
        {"adobe-rgb", std::nullopt},
        {"0.68,0.32,0.265,0.69,0.15,0.06,0.3457,0.3585", std::nullopt},
    };
    for (const auto& [profile, codes] : cases) {
        SCOPED_TRACE(profile);
        ConvertOptions options;
        options.profile = profile;
        options.replace = true;
        ASSERT_TRUE(print("a.exr", "a.png", options));
        const Decoded png = image::decode_png(folder_ / "a.png");  // and all checksums
        EXPECT_EQ(png.cicp, codes);
        EXPECT_EQ(png.icc, display_from(profile, std::nullopt)->icc);
        std::vector<std::string> colour = {"IHDR", "iCCP"};
        if (codes) colour.push_back("cICP");
        EXPECT_EQ(std::vector<std::string>(png.chunks.begin(), png.chunks.begin() + static_cast<long>(colour.size())), colour);
    }
    ASSERT_TRUE(print("a.exr", "srgb.png"));
    EXPECT_EQ(image::decode_png(folder_ / "srgb.png").cicp, std::nullopt);  // its sRGB chunk says the same
}

TEST_F(Convert, PixelsThatAreNotNumbersAreCountedAndTheToolSaysSo) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    write_picture(folder_ / "a.exr", {}, [&](int x, int y) -> std::array<float, 3> {
        if (y == 0 && x < 3) return {1, nan, 1};
        if (y == 1 && x < 5) return {1, inf, 1};
        if (y == 2 && x < 7) return {nan, 0.5f, 1};
        if (y == 3 && x < 11) return {1, -1, 1};
        return {0.5f, 0.5f, 0.5f};
    });
    const testing::Outcome outcome = run_tool({at("a.exr"), "-o", at("a.png"), "--json", "--no-dither"});
    EXPECT_EQ(outcome.status, 3);
    EXPECT_NE(outcome.err.find("15 pixels"), std::string::npos) << outcome.err;
    for (const char* fact : {"\"not_a_number\": 3", "\"infinite\": 5", "\"colourless\": 7", "\"negative\": 11"})
        EXPECT_NE(outcome.out.find(fact), std::string::npos) << outcome.out;
    const Decoded png = image::decode_png(folder_ / "a.png");
    EXPECT_EQ(png.pixels[0], std::byte{0});
    EXPECT_EQ(png.pixels[png.format.row_bytes()], std::byte{255});
}

TEST_F(Convert, AutomaticExposurePrintsTheSensitivityItChoseAndTheNumberGivesTheSamePrint) {
    write_picture(folder_ / "a.exr", {300, 200, {}, 64});
    const testing::Outcome chosen = run_tool({at("a.exr"), "-o", at("auto.png"), "--auto", "--stops", "1"});
    ASSERT_EQ(chosen.status, 0) << chosen.err;
    const std::size_t place = chosen.out.find("sensitivity");
    ASSERT_NE(place, std::string::npos) << chosen.out;
    const double sigma = std::stod(chosen.out.substr(place + 11));
    EXPECT_GT(sigma, 0);
    const testing::Outcome given = run_tool({at("a.exr"), "-o", at("given.png"), "--sensitivity",
                                             chosen.out.substr(place + 15, chosen.out.find(' ', place + 15) - place - 15)});
    ASSERT_EQ(given.status, 0) << given.err;
    EXPECT_TRUE(image::decode_png(folder_ / "auto.png").pixels == image::decode_png(folder_ / "given.png").pixels);
}

TEST_F(Convert, ASpaceGivenByItsMatrixPrintsLikeTheSpaceAndASingularOneNeedsItsLuminances) {
    write_picture(folder_ / "a.exr", {});
    const color::Matrix3& m = color::RgbSpace::srgb().rgb_from_xyz;
    ConvertOptions options;
    ASSERT_TRUE(print("a.exr", "name.png", options));
    for (std::size_t i = 0; i < 9; ++i)
        options.profile = (i == 0 ? "" : options.profile + ",") + fmt::format("{}", m.m[i / 3][i % 3]);
    ASSERT_TRUE(print("a.exr", "matrix.png", options));
    EXPECT_TRUE(image::decode_png(folder_ / "name.png").pixels == image::decode_png(folder_ / "matrix.png").pixels);

    options.profile = "0,1,0,0,1,0,0,1,0";  // red, green and blue all show luminance: black and white
    const Result<ConvertReport> refused = print("a.exr", "grey.png", options);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("--luminance-row"), std::string::npos) << refused.error().message;
    options.luminance_row = {0.2, 0.7, 0.1};
    for (const char* name : {"grey.png", "grey.exr", "grey.tif"}) ASSERT_TRUE(print("a.exr", name, options)) << name;
    Rect window;
    const std::vector<float> grey = read_exr(at("grey.exr"), window);
    for (std::size_t i = 0; i < grey.size(); ++i) {
        const std::array<float, 3> light = colourful(static_cast<int>(i / 3 % 300), static_cast<int>(i / 900));
        ASSERT_NEAR(grey[i], -std::expm1(-static_cast<double>(light[1]) * std::log(2.0)), 3e-6) << i;
    }
}

TEST_F(Convert, MisuseIsExplainedInOneLineAndLeavesNothing) {
    write_picture(folder_ / "a.exr", {});
    PictureLayout wide{66000, 1};
    write_picture(folder_ / "wide.exr", wide);
    std::ofstream(folder_ / "there.png") << "x";
    std::ofstream(folder_ / "s.latent") << "samples";
    for (const char* pipe : {"pipe", "p.icc"}) ASSERT_EQ(::mkfifo(at(pipe).c_str(), 0600), 0);  // nobody writes to them
    struct Case {
        std::vector<std::string> arguments;
        int status;
        std::string says;
    };
    const std::vector<std::string> names = folder_.names();
    for (const Case& c : std::vector<Case>{{{at("a.exr")}, 2, "--output"},
                                           {{at("none.exr"), "-o", at("b.png")}, 1, "none.exr"},
                                           {{at("there.png"), "-o", at("b.png")}, 1, "there.png"},
                                           {{at("s.latent"), "-o", at("b.png")}, 1, "latent-develop s.latent -o s.exr"},
                                           {{at("a.exr"), "-o", at("there.png")}, 1, "--force"},
                                           {{at("a.exr"), "-o", at("b.gif")}, 2, ".png"},
                                           {{at("a.exr"), "-o", at("b.png"), "--bits", "float"}, 2, ".tif"},
                                           {{at("a.exr"), "-o", at("b.png"), "--bits", "12"}, 2, "--bits"},
                                           {{at("a.exr"), "-o", at("b.png"), "--profile", "nonsense"}, 2, "display-p3"},
                                           {{at("a.exr"), "-o", at("b.png"), "--sensitivity", "-1"}, 2, "--sensitivity"},
                                           {{at("a.exr"), "-o", at("b.png"), "--sensitivity", "0"}, 2, "above 0"},
                                           {{at("a.exr"), "-o", at("b.png"), "--sensitivity", "nan"}, 2, "not a number"},
                                           {{at("a.exr"), "-o", at("b.png"), "--stops", "nan"}, 2, "--stops"},
                                           {{at("a.exr"), "-o", at("b.png"), "--profile", "1,1,1,1,1,1,1,1"}, 2, "--profile"},
                                           {{at("a.exr"), "-o", at("b.png"), "--crop", "1,2,3"}, 2, "X0,Y0,X1,Y1"},
                                           {{at("a.exr"), "-o", at("b.png"), "-o", at("./b.png")}, 2, "twice"},
                                           {{at("a.exr"), "-o", "b.png", "-o", "./b.png"}, 2, "twice"},
                                           {{at("a.exr"), "-o"}, 2, "a value is missing"},
                                           {{at("a.exr"), "-o", at("b.png"), "--bits", "8", "--bits", "8"}, 2, "given more"},
                                           {{at("a.exr"), "-o", at("b.png"), "--crop", "0,0,9999,1"}, 2, "--crop"},
                                           {{at("a.exr"), "-o", at("b.tif"), "--dpi", "0"}, 2, "--dpi"},
                                           {{at("a.exr"), "-o", at("b.jpg"), "--dpi", "65536"}, 2, "--dpi"},
                                           {{at("a.exr"), "-o", at("b.jpg"), "--bits", "16"}, 2, "8 bits"},
                                           {{at("a.exr"), "-o", at("b.dzi"), "--bits", "float"}, 2, "8 bits"},
                                           {{at("a.exr"), "-o", at("b.exr"), "--bits", "8"}, 2, "--bits 16"},
                                           {{at("a.exr"), "-o", at("b.png"), "--memory", "-5"}, 2, "--memory"},
                                           {{at("a.exr"), "-o", at("b.png"), "--level", "3"}, 2, "level"},
                                           {{at("pipe"), "-o", at("b.png")}, 1, "pipe: not a regular file"},
                                           {{at("a.exr"), "-o", at("b.png"), "--profile", at("p.icc")}, 1, "not a regular file"},
                                           {{"", "-o", at("b.png")}, 1, "empty file name"},
                                           {{at("wide.exr"), "-o", at("b.jpg")}, 1, "65500"},
                                           {{at("wide.exr"), "-o", at("b.png"), "-o", at("c.jpg")}, 1, "65500"}}) {
        const testing::Outcome outcome = run_tool(c.arguments);
        EXPECT_EQ(outcome.status, c.status) << outcome.err;
        EXPECT_NE(outcome.err.find(c.says), std::string::npos) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_EQ(folder_.names(), names);
    }
    EXPECT_EQ(testing::read_text(folder_ / "there.png"), "x");
}

}  // namespace
}  // namespace latent::convert
