// Pictures that are missing, broken, cut off or of another kind than they say.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <fstream>

#include "render/texture/textures.h"
#include "tests/faults/process.h"
#include "tests/render/textures.h"
#include "tests/support/paths.h"

namespace latent::render {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using testing::TextureTest;

// A TIFF of one pixel with these sorts of colours.
std::string tiff_of(int photometric) {
    const auto little_endian = [](std::uint32_t x, int bytes) {
        std::string out;
        for (int i = 0; i < bytes; ++i) out += static_cast<char>(x >> (8 * i) & 255);
        return out;
    };
    // Tag, type, count, value.
    const std::vector<std::array<std::uint32_t, 4>> entries = {
        {256, 3, 1, 1},   {257, 3, 1, 1}, {258, 3, 3, 122}, {259, 3, 1, 1}, {262, 3, 1, static_cast<std::uint32_t>(photometric)},
        {273, 4, 1, 128}, {277, 3, 1, 3}, {278, 3, 1, 1},   {279, 4, 1, 3}};
    std::string out = std::string("II*\0", 4) + little_endian(8, 4) + little_endian(static_cast<std::uint32_t>(entries.size()), 2);
    for (const auto& [tag, type, count, value] : entries)
        out += little_endian(tag, 2) + little_endian(type, 2) + little_endian(count, 4) + little_endian(value, 4);
    out += little_endian(0, 4);
    EXPECT_EQ(out.size(), 122u);
    return out + little_endian(8, 2) + little_endian(8, 2) + little_endian(8, 2) + "\x80\x10\x20";
}

// OpenImageIO takes the numbers of L*a*b* for R, G and B.
TEST_F(TextureTest, TiffsInLabAreRefused) {
    const Result<std::unique_ptr<image::Pictures>> pictures = image::Pictures::create(1 << 20);
    ASSERT_TRUE(pictures);
    for (const int lab : {8, 9, 10}) {
        const std::string name = "lab" + std::to_string(lab) + ".tif";
        folder_.write(name, tiff_of(lab));
        const Result<image::PictureInfo> info = (*pictures)->open(folder_ / name, name, {});
        ASSERT_FALSE(info) << lab;
        EXPECT_THAT(info.error().message,
                    HasSubstr(name + ": cannot be read as a picture: its colours are L*a*b*; convert it to RGB"));
    }
    folder_.write("rgb.tif", tiff_of(2));
    EXPECT_TRUE((*pictures)->open(folder_ / "rgb.tif", "rgb.tif", {}));
}

TEST_F(TextureTest, AllMissingPicturesAreNamedAtOnceAndBrokenOnesByOneLineEach) {
    const std::string text = R"(WorldBegin
Texture "a" "spectrum" "imagemap" "string filename" "one.png"
Texture "b" "float" "imagemap" "string filename" "two.png"
Material "phong" "texture Kd" "a" "texture exponent" "b"
Shape "plymesh" "string filename" "three.ply"
)";
    const std::string missing = load_scene(folder_.write("room.pbrt", text)).error().message;
    for (const char* name : {"one.png", "two.png", "three.ply"}) EXPECT_THAT(missing, HasSubstr(name));

    folder_.write("one.png", "this is no picture");
    folder_.write("two.png", "");
    folder_.write("three.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                  "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    const Result<LoadedScene> scene = load_scene(folder_.write("room.pbrt", text));
    ASSERT_TRUE(scene) << scene.error().message;
    const Result<Textures> textures = Textures::build(scene->description, 1 << 20, library_);
    ASSERT_FALSE(textures);
    const std::string& message = textures.error().message;
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 1) << message;
    EXPECT_THAT(message, ::testing::ContainsRegex("room.pbrt:2:1: [^\n]*one.png: cannot be read as a picture"));
    EXPECT_THAT(message, ::testing::ContainsRegex("room.pbrt:3:1: [^\n]*two.png: cannot be read as a picture"));
}

// One bit is what TIFF means by that. OpenImageIO would read another picture, of eight.
TEST_F(TextureTest, ATiffThatDoesNotSayHowManyBitsASampleHasIsRefused) {
    struct Tag {
        std::uint16_t tag, type;
        std::uint32_t value;
    };
    const auto tiff = [](bool says_bits) {
        std::vector<Tag> tags{{256, 3, 16}, {257, 3, 2}, {259, 3, 1}, {262, 3, 1}, {273, 4, 0}, {278, 3, 2}, {279, 4, 4}};
        if (says_bits) tags.insert(tags.begin() + 2, {258, 3, 1});
        std::string out("II*\0\x08\0\0\0", 8);
        const auto add = [&](std::uint32_t x, int bytes) {
            for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>(x >> (8 * i)));
        };
        add(static_cast<std::uint32_t>(tags.size()), 2);
        for (const Tag& t : tags) {
            add(t.tag, 2), add(t.type, 2), add(1, 4);
            add(t.tag == 273 ? static_cast<std::uint32_t>(14 + 12 * tags.size()) : t.value, 4);
        }
        add(0, 4);
        return out + "\xF0\x0F\xF0\x0F";
    };
    const std::string text =
        "WorldBegin\nTexture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tif\"\n"
        "Material \"diffuse\" \"texture reflectance\" \"a\"\nShape \"sphere\"\n";
    for (const bool says_bits : {true, false}) {
        folder_.write("a.tif", tiff(says_bits));
        const Result<LoadedScene> scene = load_scene(folder_.write("room.pbrt", text));
        ASSERT_TRUE(scene) << scene.error().message;
        const Result<Textures> textures = Textures::build(scene->description, 1 << 20, library_);
        EXPECT_EQ(textures.has_value(), says_bits);
        if (textures) continue;
        EXPECT_THAT(textures.error().message,
                    HasSubstr("a.tif: cannot be read as a picture: it does not say how many bits a sample"));
        EXPECT_THAT(textures.error().message, HasSubstr("which means 1"));
    }
}

// Libraries make room before they read: for some of these files, more than 10 GB.
TEST_F(TextureTest, PicturesThatClaimToBeHugeAreRefusedBeforeThereIsRoomForThem) {
    const auto seed = [](const char* name) {
        return latent::testing::in_tree(std::string("tests/fuzz/seeds/picture/once-broken-huge.") + name);
    };
    folder_.write("a.pfm", "PF\n1000000 1000000\n-1.0\nabcd");
    // In our words, or in those of the library, where its release looks first.
    const auto is_refusal = AnyOf(HasSubstr("pixels do not fit into a file of its size"), HasSubstr("resolution may not exceed"));
    for (const std::string& file : {(folder_ / "a.pfm").string(), seed("jpg"), seed("exr"), seed("tga"), seed("gif")}) {
        const auto scene = [&](const std::string& format) {
            return load_scene(folder_.write("room.pbrt", "WorldBegin\n" + fmt::format(fmt::runtime(format), file)));
        };
        const Result<LoadedScene> sky = scene("LightSource \"infinite\" \"string filename\" \"{}\"\nShape \"sphere\"\n");
        ASSERT_FALSE(sky) << file;
        EXPECT_THAT(sky.error().message, is_refusal);
        const Result<LoadedScene> texture = scene(
            "Texture \"s\" \"spectrum\" \"imagemap\" \"string filename\" \"{}\"\n"
            "Material \"diffuse\" \"texture reflectance\" \"s\"\nShape \"sphere\"\n");
        ASSERT_TRUE(texture) << texture.error().message;
        const Result<Textures> textures = Textures::build(texture->description, 1 << 20, library_);
        ASSERT_FALSE(textures) << file;
        EXPECT_THAT(textures.error().message, is_refusal);
    }
}

// Libraries make room for all of an attribute before they read (here, 1.9 GB), divide by the width, and abort if a few tiles do
// not fit into the cache.
TEST_F(TextureTest, HeadersThatMisleadLibrariesAreRefused) {
    const auto open = [](const std::string& seed) {
        const Result<std::unique_ptr<image::Pictures>> pictures = image::Pictures::create(1 << 20);
        EXPECT_TRUE(pictures);
        const Result<image::PictureInfo> info =
            (*pictures)->open(latent::testing::in_tree("tests/fuzz/seeds/picture/" + seed), seed, {});
        return info ? "" : info.error().message;
    };
    EXPECT_THAT(open("once-broken-attribute.exr"), HasSubstr("an attribute is longer than the file"));
    EXPECT_THAT(open("once-broken-empty.tga"), AnyOf(HasSubstr("has no pixels"), HasSubstr("must be at least 1x1")));
    EXPECT_THAT(open("once-broken-tile.tif"), HasSubstr("does not say how many bits"));
    EXPECT_THAT(open("once-broken-large-tile.tif"),
                HasSubstr("a tile of 40968 x 16 pixels takes more than 1/16 of --texture-cache"));
    EXPECT_EQ(open("a.exr"), "");
}

// OpenImageIO could read many more.
TEST_F(TextureTest, PicturesOfOtherFormatsAreRefused) {
    std::string sgi(512, '\0');  // one grey pixel, uncompressed
    sgi[0] = 0x01, sgi[1] = '\xDA', sgi[3] = 1, sgi[5] = 2, sgi[7] = 1, sgi[9] = 1, sgi[11] = 1, sgi[19] = '\xFF';
    sgi += '\x80';
    const Result<std::unique_ptr<image::Pictures>> pictures = image::Pictures::create(1 << 20);
    ASSERT_TRUE(pictures);
    for (const char* name : {"a.sgi", "a.rgb", "a.mp4", "a.psd", "a.null", "a", "a.latent"}) {
        folder_.write(name, sgi);
        const Result<image::PictureInfo> info = (*pictures)->open(folder_ / name, name, {});
        ASSERT_FALSE(info) << name;
        EXPECT_THAT(info.error().message, HasSubstr("its format is none of PNG, JPEG"));
    }
}

TEST_F(TextureTest, APictureThatEndsEarlyIsAnErrorBeforeItIsUsed) {
    const std::string tga = std::string("\0\0\2\0\0\0\0\0\0\0\0\0\100\0\100\0\30\0", 18) + std::string(3000, 'x');
    const std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 4\n" + std::string(500, '\x80');
    // Of 64 x 64 pixels of 24 bits, from the bottom; and of 32 bits.
    std::string bmp("BM\66\60\0\0\0\0\0\0\66\0\0\0\50\0\0\0\100\0\0\0\100\0\0\0\1\0\30\0", 30);
    bmp += std::string(24, '\0') + std::string(64 * 64 * 3 - 500, 'x');
    std::string dds("DDS \174\0\0\0\17\20\0\0\100\0\0\0\100\0\0\0\0\1\0\0", 24);
    dds += std::string(52, '\0') +
           std::string("\40\0\0\0\101\0\0\0\0\0\0\0\40\0\0\0\0\0\377\0\0\377\0\0\377\0\0\0\0\0\0\377\0\20\0\0", 36);
    dds += std::string(16, '\0') + std::string(64 * 64 * 4 - 500, 'x');
    std::string pgm = "P2\n64 640\n255\n";
    for (int i = 0; i < 64 * 70; ++i) pgm += "120\n";
    const Result<std::unique_ptr<image::Pictures>> pictures = image::Pictures::create(1 << 20);
    ASSERT_TRUE(pictures);
    for (const auto& [name, bytes] : {std::pair("a.tga", tga), {"a.hdr", hdr}, {"a.pgm", pgm}, {"a.bmp", bmp}, {"a.dds", dds}}) {
        folder_.write(name, bytes);
        const Result<image::PictureInfo> info = (*pictures)->open(folder_ / name, name, {});
        ASSERT_FALSE(info) << name;
        EXPECT_THAT(info.error().message, HasSubstr(std::string(name) + ": cannot be read as a picture: the file is cut off"));
    }
}

TEST_F(TextureTest, APictureThatIsDamagedInTheMiddleIsAnErrorWhereThatIsNeeded) {
    testing::write_exr(folder_ / "p.exr", 64, 640, std::vector<float>(3 * 64 * 640, 0.5f));
    const std::filesystem::path path = folder_ / "p.exr";
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path) / 2));
    file << std::string(std::filesystem::file_size(path) / 8, '\xFF');
    file.close();
    load_float("\"imagemap\" \"string filename\" \"p.exr\" \"string filter\" \"bilinear\"");
    at(0.5f, 0.05f);
    EXPECT_TRUE(textures_->status());
    at(0.5f, 0.45f);
    ASSERT_FALSE(textures_->status());
    EXPECT_THAT(textures_->status().error().message,
                ::testing::ContainsRegex("room.pbrt:[0-9]+:1: [^\n]*p.exr: cannot be read as a picture"));
}

// Libraries would write to standard error, or make what is missing grey.
TEST_F(TextureTest, APictureThatIsCutOrChangedAnywhereIsOneErrorWithItsPlace) {
    const auto message = [&](const std::string& name, const std::string& bytes) {
        folder_.write(name, bytes);
        const Result<LoadedScene> scene = load_scene(
            folder_.write("room.pbrt", "WorldBegin\n\n Texture \"s\" \"spectrum\" \"imagemap\" \"string filename\" \"" + name +
                                           "\"\nMaterial \"diffuse\" \"texture reflectance\" \"s\"\nShape \"sphere\"\n"));
        const Result<Textures> textures = Textures::build(scene.value().description, 1 << 20, library_);
        return textures ? "" : textures.error().message;
    };
    const auto is_refused = [&](const std::string& name, const std::string& bytes) {
        EXPECT_THAT(message(name, bytes), ::testing::MatchesRegex(".*/room.pbrt:3:2: [^\n]*/" + name +
                                                                  ": cannot be read as a picture: the file is [^\n]*"));
    };
    const auto seed = [](const std::string& name) {
        std::ifstream in(latent::testing::in_tree("tests/fuzz/seeds/picture/" + name), std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    ::testing::internal::CaptureStderr();
    for (const std::string name : {"a.png", "a.jpg"}) {
        const std::string whole = seed(name);
        EXPECT_EQ(message(name, whole), "");
        EXPECT_EQ(message(name, whole + "more"), "");
        for (std::size_t size = 9; size < whole.size(); size += 3) is_refused(name, whole.substr(0, size));
    }
    for (const std::string name : {"a.tif", "grey-tiled.tif", "mips.tif"}) {
        const std::string whole = seed(name);
        EXPECT_EQ(message(name, whole), "");
        for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 50)
            EXPECT_THAT(message(name, whole.substr(0, size)), HasSubstr("/room.pbrt:3:2: ")) << name << " " << size;
    }
    const std::string pfm = "PF\n2 3\n-1.0\n" + std::string(2 * 3 * 3 * 4, '\0');
    const std::string webp = seed("a.webp");
    for (const auto& [name, whole] : {std::pair("a.pfm", pfm), std::pair("a.webp", webp)}) {
        EXPECT_EQ(message(name, whole), "");
        for (std::size_t size = 0; size < whole.size(); ++size) is_refused(name, whole.substr(0, size));
    }
    const std::string gif = seed("a.gif");
    is_refused("a.gif", gif.substr(0, gif.size() / 2));
    for (const char* sides : {"0 3", "2 -3", "x 3", "2 3 x", "2 3 0"})
        is_refused("a.pfm", "PF\n" + std::string(sides) + "\n" + pfm.substr(7));
    for (std::size_t at : {8, 12, 22}) is_refused("a.webp", webp.substr(0, at) + "?" + webp.substr(at + 1));
    const std::string jpeg = seed("a.jpg");
    EXPECT_EQ(message("a.jpg", jpeg.substr(0, 2) + "\xFF\xFF" + jpeg.substr(2)), "");  // bytes that fill
    std::string png = seed("a.png");
    for (std::size_t at = png.find("IDAT"); at < png.size(); at += 5) {
        png[at] ^= 1;
        is_refused("a.png", png);
        png[at] ^= 1;
    }
    is_refused("a.png", png.substr(0, 4) + png.substr(5));  // a line ends in "\n" alone
    // Headers that cannot be, with the checksum that they need: of width, height, bits, colour type, compression, filter,
    // interlace.
    for (const auto& [at, value] : {std::pair(16, 255), std::pair(20, 1), std::pair(24, 3), std::pair(25, 5), std::pair(26, 1),
                                    std::pair(27, 1), std::pair(28, 2), std::pair(15, 88)}) {
        std::string changed = png;
        changed[static_cast<std::size_t>(at)] = static_cast<char>(value);
        const auto sum = static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(&changed[12]), 17));
        for (std::size_t i = 0; i < 4; ++i) changed[29 + i] = static_cast<char>(sum >> (24 - 8 * i));
        is_refused("a.png", changed);
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace latent::render
