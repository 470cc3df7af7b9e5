// Meshes come out the same from every encoding that PLY has, and no file does harm.
#include "render/load/mesh/ply.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <random>

namespace latent::render {
namespace {

using ::testing::HasSubstr;

enum class Encoding { kAscii, kLittle, kBig };

// Writes values one after another in an encoding.
class Writer {
 public:
    explicit Writer(Encoding encoding) : encoding_(encoding) {}
    template <class T>
    void put(T value) {
        if (encoding_ == Encoding::kAscii) {
            text_ += std::to_string(value) + " ";
            return;
        }
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof(T));
        if (encoding_ == Encoding::kBig) std::reverse(raw, raw + sizeof(T));
        text_.append(raw, sizeof(T));
    }
    const std::string& text() const { return text_; }

 private:
    Encoding encoding_;
    std::string text_;
};

std::string name(Encoding encoding) {
    return encoding == Encoding::kAscii ? "ascii" : encoding == Encoding::kLittle ? "binary_little_endian" : "binary_big_endian";
}

// A triangle and a quad, with normals, uv and things that are to be skipped.
std::string example(Encoding encoding) {
    Writer body(encoding);
    const float p[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0.5f, 0.25f}};
    for (const auto& v : p) {
        body.put<std::uint8_t>(7);
        for (const float x : v) body.put<double>(x);
        for (const float x : {0.f, 0.f, 1.f}) body.put<float>(x);
        body.put<float>(v[0] / 2);
        body.put<float>(v[1] / 2);
    }
    body.put<std::int16_t>(-3);
    for (const std::int32_t i : {4, 5, 6}) body.put(i);  // element "edge" with a list of 2 and a number
    for (const std::uint8_t n : {std::uint8_t{3}, std::uint8_t{4}}) {
        body.put(n);
        for (std::uint16_t i = 0; i < n; ++i) body.put<std::uint16_t>(n == 3 ? static_cast<std::uint16_t>(i + 2) : i);
        body.put<std::int8_t>(-1);
    }
    std::string edges = "element edge 1\nproperty short weight\nproperty int a\nproperty int b\nproperty int32 c\n";
    return "ply\nformat " + name(encoding) + " 1.0\ncomment made by hand\nobj_info none\n" +
           "element vertex 5\nproperty uchar red\nproperty double x\nproperty float64 y\nproperty double z\nproperty float "
           "nx\nproperty float32 ny\nproperty float nz\n"
           "property float u\nproperty float v\n" +
           edges + "element face 2\nproperty list uchar ushort vertex_indices\nproperty char flag\nend_header\n" + body.text();
}

TEST(Ply, EveryEncodingHoldsTheSameMesh) {
    for (const Encoding encoding : {Encoding::kAscii, Encoding::kLittle, Encoding::kBig}) {
        const Result<PlyMesh> mesh = parse_ply(example(encoding), "m.ply");
        ASSERT_TRUE(mesh) << name(encoding) << ": " << mesh.error().message;
        ASSERT_EQ(mesh->positions.size(), 5u);
        EXPECT_EQ(mesh->positions[4], Vec3d(2, 0.5, 0.25));
        EXPECT_EQ(mesh->normals[2], Vec3f(0, 0, 1));
        EXPECT_EQ(mesh->uvs[2], (Vec2f{0.5f, 0.5f}));
        EXPECT_EQ(mesh->triangles, (std::vector<std::uint32_t>{2, 3, 4}));
        EXPECT_EQ(mesh->quads, (std::vector<std::uint32_t>{0, 1, 2, 3}));
    }
}

TEST(Ply, FilesCutAnywhereAreRefused) {
    for (const Encoding encoding : {Encoding::kLittle, Encoding::kBig}) {
        const std::string whole = example(encoding);
        for (std::size_t size = 0; size < whole.size(); ++size)
            EXPECT_FALSE(parse_ply(std::string_view(whole).substr(0, size), "m.ply")) << size;
    }
}

TEST(Ply, BrokenFilesAreRefusedInWords) {
    const std::string vertices = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    const auto message = [](const std::string& text) {
        const Result<PlyMesh> mesh = parse_ply(text, "m.ply");
        return mesh ? std::string("accepted") : mesh.error().message;
    };
    EXPECT_THAT(message("solid stl\n"), HasSubstr("not a PLY file"));
    EXPECT_THAT(message(vertices + "property frob w\nend_header\n"), HasSubstr("m.ply:7: type \"frob\" is unknown"));
    EXPECT_THAT(
        message(vertices + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 5 0 1 2 0 1\n"),
        HasSubstr("5 sides"));
    EXPECT_THAT(
        message(vertices + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 3 0 1 3\n"),
        HasSubstr("there are 3 vertices"));
    EXPECT_THAT(
        message(vertices + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 3 0 1 -1\n"),
        HasSubstr("out of range"));
    EXPECT_THAT(message(vertices + "end_header\n0 0 0 1 nan 0 0 1 0\n"), HasSubstr("vertex 1"));
    EXPECT_THAT(message("ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n"), HasSubstr("m.ply:3: "));
    EXPECT_THAT(message("ply\nformat binary_little_endian 1.0\nelement vertex 9999999999999\nproperty float x\nproperty float "
                        "y\nproperty float z\nend_header\n0123"),
                HasSubstr("m.ply: the file ends within vertex 0 of"));
}

// The same rows with one fault, in lines of their own, after a header of ten.
TEST(Ply, AFaultInTextIsSaidWithItsLine) {
    const std::vector<std::string> rows = {"0 0 0", "1 0 0", "0 1 0", "3 0 1 2", "3 2 1 0"};
    for (std::size_t row = 0; row < rows.size(); ++row) {
        for (const char* fault : {"3 1 x", "3 1 nan", "3 1 1e999", "3 1 9 9", ""}) {
            if (row < 3 && std::string_view(fault) == "3 1 9 9") continue;  // a vertex, and more values than it has
            std::string text =
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                "element face 2\nproperty list uchar int vertex_indices\ncomment\nend_header\n";
            for (std::size_t i = 0; i < row; ++i) text += rows[i] + "\n";
            text += fault;
            const Result<PlyMesh> mesh = parse_ply(text, "m.ply");
            ASSERT_FALSE(mesh) << text;
            EXPECT_THAT(mesh.error().message, ::testing::StartsWith("m.ply:" + std::to_string(11 + row) + ": ")) << text;
        }
    }
}

TEST(Ply, AnyChangedByteIsReadOrRefused) {
    std::mt19937 random(1);
    for (const Encoding encoding : {Encoding::kAscii, Encoding::kLittle, Encoding::kBig}) {
        const std::string whole = example(encoding);
        for (int i = 0; i < 3000; ++i) {
            std::string text = whole;
            text[random() % text.size()] = static_cast<char>(random());
            const Result<PlyMesh> mesh = parse_ply(text, "m.ply");
            if (!mesh) continue;
            for (const std::uint32_t index : mesh->triangles) EXPECT_LT(index, mesh->positions.size());
            for (const std::uint32_t index : mesh->quads) EXPECT_LT(index, mesh->positions.size());
        }
    }
}

}  // namespace
}  // namespace latent::render
