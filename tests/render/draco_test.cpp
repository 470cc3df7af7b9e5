// Meshes in the compression of Draco: the scene is that of the same vertices in accessors.
#include "render/load/gltf/draco.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>

#include "tests/render/models.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::as_glb;
using testing::Folder;
using testing::GltfFile;
using ::testing::HasSubstr;
using Json = nlohmann::json;

// A folded sheet of `n` x `n` squares, one corner after another.
struct Corner {
    std::array<float, 3> position;
    std::array<float, 3> normal;
    std::array<float, 2> uv;
    std::array<std::uint8_t, 4> color;
};
std::vector<Corner> sheet(int n) {
    std::vector<Corner> out;
    const auto corner = [&](int i, int k) {
        const auto x = static_cast<float>(i), y = static_cast<float>(k);
        out.push_back({{x, y, std::abs(x - 2)},
                       x < 2 ? std::array<float, 3>{0.6f, 0, 0.8f} : std::array<float, 3>{-0.6f, 0, 0.8f},
                       {x / 8, y / 8},
                       {static_cast<std::uint8_t>(10 * i), static_cast<std::uint8_t>(20 * k), 255, 51}});
    };
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            corner(i, k), corner(i + 1, k), corner(i + 1, k + 1);
            corner(i, k), corner(i + 1, k + 1), corner(i, k + 1);
        }
    }
    return out;
}

std::string packed(const std::vector<Corner>& corners, int method) {
    draco::TriangleSoupMeshBuilder builder;
    const auto faces = static_cast<std::uint32_t>(corners.size() / 3);
    builder.Start(static_cast<int>(faces));
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32),
              normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32),
              uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32),
              color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8);
    for (std::uint32_t f = 0; f < faces; ++f) {
        const Corner* c = &corners[3 * std::size_t{f}];
        const draco::FaceIndex face(f);
        builder.SetAttributeValuesForFace(position, face, &c[0].position, &c[1].position, &c[2].position);
        builder.SetAttributeValuesForFace(normal, face, &c[0].normal, &c[1].normal, &c[2].normal);
        builder.SetAttributeValuesForFace(uv, face, &c[0].uv, &c[1].uv, &c[2].uv);
        builder.SetAttributeValuesForFace(color, face, &c[0].color, &c[1].color, &c[2].color);
    }
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return {buffer.data(), buffer.size()};
}

class Draco : public ::testing::Test {
 protected:
    // Accessors of the corners, which have data unless `bytes` has them.
    static GltfFile file_of(const std::vector<Corner>& corners, const std::string* bytes) {
        GltfFile file;
        const auto add = [&](const char* type, int component, const auto& value) {
            std::string all;
            for (const Corner& c : corners)
                all.append(reinterpret_cast<const char*>(value(c).data()), value(c).size() * sizeof(value(c)[0]));
            Json accessor = {{"componentType", component}, {"type", type}, {"count", corners.size()}};
            if (bytes == nullptr) accessor["bufferView"] = file.add_bytes(all);
            if (component == 5121) accessor["normalized"] = true;
            file.json["accessors"].push_back(accessor);
            return file.json["accessors"].size() - 1;
        };
        Json attributes;
        attributes["POSITION"] = add("VEC3", 5126, [](const Corner& c) { return c.position; });
        attributes["NORMAL"] = add("VEC3", 5126, [](const Corner& c) { return c.normal; });
        attributes["TEXCOORD_0"] = add("VEC2", 5126, [](const Corner& c) { return c.uv; });
        attributes["COLOR_0"] = add("VEC4", 5121, [](const Corner& c) { return c.color; });
        Json primitive = {{"attributes", attributes}};
        if (bytes != nullptr) {
            primitive["extensions"]["KHR_draco_mesh_compression"] = {
                {"bufferView", file.add_bytes(*bytes)},
                {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}, {"COLOR_0", 3}}}};
            file.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
        }
        file.json["meshes"] = {{{"primitives", {primitive}}}};
        file.json["nodes"] = {{{"mesh", 0}}};
        file.json["scenes"] = {{{"nodes", {0}}}};
        file.json["buffers"] = {{{"byteLength", file.binary.size()}}};
        return file;
    }
    Result<LoadedScene> load(const GltfFile& file) { return load_scene(folder_.write("sheet.glb", as_glb(file))); }
    std::string refusal(const GltfFile& file) {
        const Result<LoadedScene> scene = load(file);
        return scene ? "it loads" : scene.error().message;
    }
    // All that the corners of the model's triangles say, in an order of its own.
    std::vector<std::vector<float>> corners_of(const GltfFile& file) {
        const LoadedScene scene = load(file).value();
        const SceneDescription& world = scene.description;
        const MeshDescription& mesh = *world.shapes.at(0).mesh;
        std::vector<std::vector<float>> out;
        for (const std::uint32_t i : mesh.indices) {
            const Vec3f p = Vec3f(Vec3d(mesh.positions[i]) + world.origin), n = mesh.normals[i];
            out.push_back({p.x, p.y, p.z, n.x, n.y, n.z, mesh.uvs[i].x, mesh.uvs[i].y});
            out.back().insert(out.back().end(), mesh.colors[i].begin(), mesh.colors[i].end());
        }
        for (std::vector<float>& corner : out) {
            for (float& x : corner) x = std::round(x * 1e4f);
        }
        std::ranges::sort(out);
        return out;
    }

    Folder folder_;
};

TEST_F(Draco, ACompressedMeshIsTheOneThatWasCompressed) {
    const std::vector<Corner> corners = sheet(4);
    const std::vector<std::vector<float>> expected = corners_of(file_of(corners, nullptr));
    ASSERT_EQ(expected.size(), 96u);
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const std::string bytes = packed(corners, method);
        EXPECT_EQ(corners_of(file_of(corners, &bytes)), expected) << method;
    }
}

TEST_F(Draco, WhatIsBrokenIsAnErrorThatNamesItsView) {
    const std::vector<Corner> corners = sheet(2);
    const std::string place = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/";
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const std::string whole = packed(corners, method);
        const auto broken = [&](std::size_t at, char value) {
            std::string bytes = whole;
            bytes.at(at) = value;
            return refusal(file_of(corners, &bytes));
        };
        EXPECT_THAT(broken(0, 'd'), HasSubstr(place + "bufferView: is not a mesh in the compression of Draco"));
        EXPECT_THAT(broken(6, 1), HasSubstr("is of version 2.1 of Draco's format; glTF has 2.2"));
        EXPECT_THAT(broken(7, 0), HasSubstr("holds points instead of triangles"));
        EXPECT_THAT(broken(10, '\x80'), HasSubstr("holds metadata, which is not supported"));
        for (std::size_t size = 1; size < whole.size(); ++size) {
            const std::string cut = whole.substr(0, size);
            EXPECT_THAT(refusal(file_of(corners, &cut)), HasSubstr(place)) << size;
        }
        GltfFile file = file_of(corners, &whole);
        Json& ids = file.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"];
        ids["NORMAL"] = 9;
        EXPECT_THAT(refusal(file), HasSubstr(place + "attributes/NORMAL: the compressed mesh has no such attribute"));
        ids["NORMAL"] = 2;
        EXPECT_THAT(refusal(file), HasSubstr(place + "attributes/NORMAL: has 2 numbers per item; NORMAL needs 3"));
    }
    // No room is made for triangles that so few bytes cannot hold.
    std::string bytes = packed(corners, draco::MESH_SEQUENTIAL_ENCODING);
    bytes.replace(11, 1, "\xff\xff\xff\xff\x04");
    EXPECT_THAT(refusal(file_of(corners, &bytes)), HasSubstr("1342177279 triangles in "));
}

}  // namespace
}  // namespace latent::render
