// Scenes that are models: glTF and OBJ. What they describe is what the same scene in pbrt's format describes.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <set>

#include "base/json.h"
#include "render/load/files/scene_files.h"
#include "render/load/obj/polygon.h"
#include "render/scene/content_hash.h"
#include "tests/render/models.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::as_glb;
using testing::Folder;
using testing::GltfFile;
using ::testing::HasSubstr;
using Json = nlohmann::json;

class Models : public ::testing::Test {
 protected:
    Result<LoadedScene> load(const std::string& name, const std::string& text) const {
        ModelOptions options;
        options.stage = name.ends_with(".pbrt");  // which has none, nor an option for it
        return load_scene(folder_.write(name, text), false, color::RgbSpectra::kSmooth, options);
    }
    SceneDescription described(const std::string& name, const std::string& text) const {
        const Result<LoadedScene> scene = load(name, text);
        EXPECT_TRUE(scene) << scene.error().message;
        return scene ? scene->description : SceneDescription{};
    }
    std::string refusal(const std::string& name, const std::string& text) const {
        const Result<LoadedScene> scene = load(name, text);
        if (!scene) return scene.error().message;
        ADD_FAILURE() << name << " was accepted";
        return "";
    }
    Folder folder_;
};

// A red quad and a lamp, the camera at the origin: z points out of the picture.
const char* const kPbrt =
    "Scale 1 1 -1\nFilm \"rgb\" \"integer xresolution\" 1280 \"integer yresolution\" 1280\nCamera \"perspective\" \"float fov\" "
    "90\n"
    "WorldBegin\nAttributeBegin\nTranslate 0 2 -1\nLightSource \"point\" \"rgb I\" [1 1 1] \"float scale\" 8\nAttributeEnd\n"
    "Material \"diffuse\" \"rgb reflectance\" [.8 .2 .1]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 -3  1 -1 -3  1 1 -4  -1 1 -4] \"integer indices\" [0 1 2 0 2 3]\n";

GltfFile quad_and_lamp() {
    GltfFile file;
    const Json position = file.add_floats({-1, -1, -3, 1, -1, -3, 1, 1, -4, -1, 1, -4}, "VEC3"),
               indices = file.add_indices({0, 1, 2, 0, 2, 3});
    file.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {.8, .2, .1, 1}}, {"metallicFactor", 0}}},
                               {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}}};
    file.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}, {"material", 0}}}}}};
    file.json["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1.5707963267948966}, {"aspectRatio", 1}, {"znear", 0.1}}}}};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 8}}};
    file.json["nodes"] = {
        {{"camera", 0}}, {{"mesh", 0}}, {{"translation", {0, 2, -1}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
    file.json["scenes"] = {{{"nodes", {0, 1, 2}}}};
    return file;
}

TEST_F(Models, OneSceneIsTheSameInEveryFormat) {
    const Hash128 pbrt = content_hash(described("room.pbrt", kPbrt));
    const GltfFile file = quad_and_lamp();
    EXPECT_EQ(content_hash(described("room.glb", as_glb(file))), pbrt);
    EXPECT_EQ(content_hash(described("no_extension", as_glb(file))), pbrt);
    folder_.write("data 1.bin", file.binary);
    Json with_uri = file.json;
    with_uri["buffers"] = {{{"byteLength", file.binary.size()}, {"uri", "data%201.bin"}}};
    EXPECT_EQ(content_hash(described("room.gltf", with_uri.dump())), pbrt);
    with_uri["buffers"][0]["uri"] = "data:application/octet-stream;base64," + testing::base64(file.binary);
    EXPECT_EQ(content_hash(described("room.gltf", with_uri.dump(2))), pbrt);
    EXPECT_EQ(described("room.glb", as_glb(file)).film.height, 1280u);
}

// OBJ has neither camera nor lamp: those that are made up are the same.
TEST_F(Models, ObjAndGltfOfOneModelAreTheSame) {
    GltfFile file = quad_and_lamp();
    file.json["nodes"] = {{{"mesh", 0}}};
    file.json["scenes"] = {{{"nodes", {0}}}};
    folder_.write("red.mtl", "newmtl other\nKd 1 1 1\nnewmtl red one\nKd .8 .2 .1\n");
    const std::string obj =
        "mtllib red.mtl\no quad\nv -1 -1 -3\nv 1 -1 -3\nv 1 1 -4\nv -1 1 -4\nusemtl red one\ns off\nf 1 2 \\\n 3 # half\nf -4/ -2 "
        "-1\n";
    EXPECT_EQ(content_hash(described("room.obj", obj)), content_hash(described("room.glb", as_glb(file))));
}

TEST_F(Models, WithoutACameraAllOfTheModelIsInThePicture) {
    for (const Vec3d& size : {Vec3d(1, 1, 1), Vec3d(100, 1, 1), Vec3d(0.01, 5, 0), Vec3d(2, 0, 900)}) {
        std::string obj;
        for (int corner = 0; corner < 8; ++corner)
            obj +=
                fmt::format("v {} {} {}\n", 50 + (corner & 1 ? size.x : 0), corner & 2 ? size.y : 0, corner & 4 ? size.z : -size.z);
        const SceneDescription scene = described("box.obj", obj + "f 1 2 4\nf 5 8 6\nf 1 7 3\n");
        const CameraDescription& camera = scene.camera;
        const Affined from_world = camera.world_from_camera.inverse().value();
        double widest = 0;
        for (const Vec3f& p : scene.shapes[0].mesh->positions) {
            const Vec3d seen = from_world.point(Vec3d(p));
            EXPECT_GT(seen.z, 0);
            const double across = std::max(std::abs(seen.x / seen.z / camera.x1), std::abs(seen.y / seen.z / camera.y1));
            widest = std::max(widest, across);
        }
        EXPECT_NEAR(widest, 0.8, 1e-4);
        ASSERT_EQ(scene.lights.size(), 1u);
        EXPECT_EQ(scene.lights[0].kind, LightKind::kInfinite);
    }
}

TEST_F(Models, NodesPlaceWhatTheyHold) {
    GltfFile file = quad_and_lamp();
    // z up to y up, doubled, then moved: (x, y, z) -> (2 x, 2 z, -2 y) + (0, 0, 7).
    const double half = std::sqrt(0.5);
    file.json["nodes"] = {{{"translation", {0, 0, 7}}, {"children", {1}}},
                          {{"rotation", {-half, 0, 0, half}}, {"scale", {2, 2, 2}}, {"mesh", 0}}};
    file.json["scenes"] = {{{"nodes", {0}}}};
    const SceneDescription scene = testing::in_world(described("room.glb", as_glb(file)));
    const Vec3f& p = scene.shapes.at(0).mesh->positions.at(2);  // (1, 1, -4)
    EXPECT_NEAR(p.x, 2, 1e-5);
    EXPECT_NEAR(p.y, -8, 1e-5);
    EXPECT_NEAR(p.z, 5, 1e-5);
    EXPECT_FALSE(scene.shapes[0].flip_normal);
    GltfFile without_scenes = file;
    without_scenes.json.erase("scenes");
    EXPECT_EQ(content_hash(described("room.glb", as_glb(without_scenes))), content_hash(described("room.glb", as_glb(file))));
    file.json["nodes"][1]["matrix"] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    EXPECT_TRUE(described("room.glb", as_glb(file)).shapes.at(0).flip_normal);  // a mirror keeps the front in front
}

TEST_F(Models, MeshesOfSeveralNodesBecomeInstancesAndLampsStayInTheWorld) {
    GltfFile file = quad_and_lamp();
    file.json["materials"].push_back(
        {{"emissiveFactor", {1, .5, 0}}, {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}}});
    Json lamp = file.json["meshes"][0]["primitives"][0];
    lamp["material"] = 1;
    file.json["meshes"][0]["primitives"].push_back(lamp);
    file.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {3, 0, 0}}}};
    file.json["scenes"] = {{{"nodes", {0, 1}}}};
    const SceneDescription scene = described("room.glb", as_glb(file));
    EXPECT_EQ(scene.instances.size(), 2u);
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].shapes.size(), 1u);
    ASSERT_EQ(scene.shapes.size(), 2u);
    EXPECT_EQ(scene.area_lights.at(scene.shapes[0].area_light).scale, 20);
    EXPECT_TRUE(scene.lights.empty());  // there is light: no sky
}

TEST_F(Models, StripsFansAndShortIndicesAreTriangles) {
    GltfFile file;
    const Json position = file.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3");
    const auto indices_of = [&](const Json& extra) {
        Json primitive = {{"attributes", {{"POSITION", position}}}};
        primitive.update(extra);
        file.json["meshes"] = {{{"primitives", {primitive}}}};
        file.json["nodes"] = {{{"mesh", 0}}};
        file.json["scenes"] = {{{"nodes", {0}}}};
        return described("room.glb", as_glb(file)).shapes.at(0).mesh->indices;
    };
    using Indices = std::vector<std::uint32_t>;
    EXPECT_EQ(indices_of({{"mode", 5}}), (Indices{0, 1, 2, 1, 3, 2, 2, 3, 4}));
    EXPECT_EQ(indices_of({{"mode", 6}}), (Indices{1, 2, 0, 2, 3, 0, 3, 4, 0}));
    EXPECT_EQ(indices_of({{"indices", file.add_indices({4, 2, 3}, 5121)}}), (Indices{2, 0, 1}));  // unused vertices are left out
    EXPECT_EQ(indices_of({{"indices", file.add_indices({0, 1, 2}, 5123)}}), (Indices{0, 1, 2}));
}

TEST_F(Models, SparseAndInterleavedAccessorsHoldWhatTheySay) {
    GltfFile file;
    const Json interleaved = file.add_floats({0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0, 9}, "VEC3", 16);
    const Json change = file.add_floats({5, 6, 7}, "VEC3"), which = file.add_indices({2}, 5123);
    Json& accessor = file.json["accessors"][interleaved.get<std::size_t>()];
    accessor["count"] = 3;
    accessor["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", file.json["accessors"][which.get<std::size_t>()]["bufferView"]}, {"componentType", 5123}}},
        {"values", {{"bufferView", file.json["accessors"][change.get<std::size_t>()]["bufferView"]}}}};
    file.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", interleaved}}}}}}}};
    file.json["nodes"] = {{{"mesh", 0}}};
    file.json["scenes"] = {{{"nodes", {0}}}};
    const SceneDescription scene = testing::in_world(described("room.glb", as_glb(file)));
    EXPECT_EQ(scene.shapes.at(0).mesh->positions.at(1), Vec3f(1, 0, 0));
    EXPECT_NEAR(scene.shapes.at(0).mesh->positions.at(2).y, 6, 1e-5);
}

TEST_F(Models, PositionsWithoutDataAreAnErrorThatNamesTheExtensionThatHasThem) {
    GltfFile file = quad_and_lamp();
    Json& primitive = file.json["meshes"][0]["primitives"][0];
    file.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()].erase("bufferView");
    EXPECT_THAT(refusal("room.glb", as_glb(file)),
                ::testing::EndsWith("room.glb: /meshes/0/primitives/0/attributes/POSITION: its accessor has no data"));
    primitive["extensions"]["EXT_other_compression"] = {{"bufferView", 0}};
    file.json["extensionsUsed"] = {"EXT_other_compression"};
    EXPECT_THAT(refusal("room.glb", as_glb(file)), ::testing::EndsWith("room.glb: /meshes/0/primitives/0/attributes/POSITION: its "
                                                                       "accessor has no data; EXT_other_compression is not "
                                                                       "supported"));
}

TEST_F(Models, NormalsThatAreNotFiniteCountAsNoneWithAWarning) {
    GltfFile file = quad_and_lamp();
    const double none = std::nan("");
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
        file.add_floats({0, 0, 1, none, 0, 1, 0, HUGE_VAL, 1, 0, 0, 1}, "VEC3");
    const LoadedScene scene = load("room.glb", as_glb(file)).value();
    EXPECT_THAT(scene.warnings, ::testing::ElementsAre(
                                    ::testing::EndsWith("room.glb: /accessors/2: 2 of its items are not finite, and count as 0")));
    const std::vector<Vec3f>& normals = scene.description.shapes.at(0).mesh->normals;
    EXPECT_EQ(normals.at(0), Vec3f(0, 0, 1));
    EXPECT_EQ(normals.at(1), Vec3f());
    EXPECT_EQ(normals.at(2), Vec3f());
}

TEST_F(Models, MaterialsAreWhatTheirExtensionsSay) {
    const auto material = [&](const Json& json) {
        GltfFile file = quad_and_lamp();
        file.json["materials"][0] = json;
        return described("room.glb", as_glb(file));
    };
    const MaterialDescription plain = material(Json::object()).materials.at(0);
    EXPECT_EQ(plain.type, "metallicroughness");
    EXPECT_EQ(plain.number("metallic").value, 1);
    EXPECT_EQ(plain.number("roughness").value, 1);
    EXPECT_EQ(plain.spectra.at("base_color").value(550), 1);
    EXPECT_FLOAT_EQ(plain.number("f0").value, 0.04f);
    const MaterialDescription coated =
        material({{"pbrMetallicRoughness", {{"roughnessFactor", .5}, {"metallicFactor", .25}}},
                  {"extensions",
                   {{"KHR_materials_clearcoat", {{"clearcoatFactor", .75}, {"clearcoatRoughnessFactor", .5}}},
                    {"KHR_materials_ior", {{"ior", 2}}}}}})
            .materials.at(0);
    EXPECT_FLOAT_EQ(coated.number("roughness").value, 0.5f);
    EXPECT_FLOAT_EQ(coated.number("metallic").value, 0.25f);
    EXPECT_FLOAT_EQ(coated.number("f0").value, 1 / 9.0f);
    EXPECT_FLOAT_EQ(coated.number("coat").value, 0.75f);
    EXPECT_FLOAT_EQ(coated.number("coat_roughness").value, 0.5f);
    const MaterialDescription velvet =
        material({{"extensions", {{"KHR_materials_sheen", {{"sheenColorFactor", {.5, .5, .5}}, {"sheenRoughnessFactor", .25}}}}}})
            .materials.at(0);
    EXPECT_EQ(velvet.type, "sheen");
    EXPECT_NEAR(velvet.spectra.at("sheen.color").value(550), 0.5, 1e-3);
    EXPECT_FLOAT_EQ(velvet.number("sheen.roughness").value, 0.25f);
    EXPECT_EQ(material({{"extensions", {{"KHR_materials_sheen", {{"sheenRoughnessFactor", .25}}}}}}).materials.at(0).type,
              "metallicroughness");  // of a black sheen nothing is seen
    const Json clear = {{"transmissionFactor", 1}};
    const SceneDescription pane = material({{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
                                            {"extensions", {{"KHR_materials_transmission", clear}}}});
    EXPECT_EQ(pane.materials.at(0).type, "thindielectric");
    EXPECT_FALSE(pane.materials.at(0).spectra.contains("transmittance"));
    const MaterialDescription tinted =
        material({{"pbrMetallicRoughness", {{"baseColorFactor", {.5, .5, .5, 1}}, {"metallicFactor", 0}}},
                  {"extensions", {{"KHR_materials_transmission", clear}, {"KHR_materials_volume", {{"thicknessFactor", 1}}}}}})
            .materials.at(0);
    EXPECT_EQ(tinted.type, "dielectric");
    EXPECT_NEAR(tinted.spectra.at("transmittance").value(550), 0.5, 1e-3);
    const MaterialDescription unlit =
        material({{"pbrMetallicRoughness", {{"baseColorFactor", {.5, .5, .5, 1}}, {"metallicFactor", 0}}},
                  {"extensions", {{"KHR_materials_transmission", clear}, {"KHR_materials_unlit", Json::object()}}}})
            .materials.at(0);
    EXPECT_EQ(unlit.type, "diffuse");
    EXPECT_NEAR(unlit.spectra.at("reflectance").value(550), 0.5, 1e-3);
    const SceneDescription glass =
        material({{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
                  {"extensions",
                   {{"KHR_materials_transmission", clear},
                    {"KHR_materials_volume",
                     {{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {.25, .25, .25}}}}}}});
    EXPECT_EQ(glass.materials.at(0).type, "dielectric");
    const MediumDescription& inside = glass.media.at(glass.shapes.at(0).inside_medium);
    EXPECT_NEAR(std::exp(-2 * inside.scale * inside.sigma_a(550)), 0.25, 1e-6);  // the attenuation colour after its distance
    EXPECT_EQ(inside.sigma_s(550), 0);
}

// A picture in the file's buffer is the picture beside it.
TEST_F(Models, PicturesShapeMaterialsWhereverTheyLie) {
    testing::write_exr(folder_ / "wood 1.exr", 2, 1, {0.5f, 0.25f, 0.125f, 1, 0, 0});
    const std::string bytes = SceneFiles::read_text(folder_ / "wood 1.exr").value();
    GltfFile file = quad_and_lamp();
    const Json uv = file.add_floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2");
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = uv;
    file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33071}}};
    file.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
    const Json moved = {{"index", 0},
                        {"texCoord", 1},
                        {"extensions", {{"KHR_texture_transform", {{"offset", {0.25, 0.125}}, {"scale", {2, 0.5}}}}}}};
    file.json["materials"][0] = {
        {"pbrMetallicRoughness",
         {{"baseColorFactor", {.5, .5, .5, 1}},
          {"baseColorTexture", moved},
          {"metallicRoughnessTexture", moved},
          {"roughnessFactor", 0.75}}},
        {"extensions", {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatTexture", moved}}}}}};
    file.json["images"] = {{{"uri", "wood%201.exr"}}};
    const Result<LoadedScene> beside = load("room.glb", as_glb(file));
    ASSERT_TRUE(beside) << beside.error().message;
    file.json["images"] = {{{"bufferView", file.add_bytes(bytes)}, {"mimeType", "image/x-exr"}}};
    const Result<LoadedScene> inside = load("room.glb", as_glb(file));
    ASSERT_TRUE(inside) << inside.error().message;
    EXPECT_EQ(content_hash(inside->description), content_hash(beside->description));
    EXPECT_EQ(SceneFiles::read_text(inside->description.textures.at(0).picture.path).value(), bytes);

    const MaterialDescription& material = beside->description.materials.at(0);
    const auto texture = [&](std::uint32_t i) { return beside->description.textures.at(i); };
    const TextureDescription color = texture(material.spectra.at("base_color").texture),
                             roughness = texture(material.number("roughness").texture);
    EXPECT_TRUE(color.is_spectrum && color.picture.is_srgb);
    EXPECT_EQ(color.tint, (std::array<double, 4>{.5, .5, .5, 1}));
    EXPECT_THAT(color.picture.wrap, ::testing::Each(TextureWrap::kClamp));
    EXPECT_FALSE(roughness.is_spectrum || roughness.picture.is_srgb);
    EXPECT_EQ(roughness.picture.channel, 1);  // green
    EXPECT_EQ(roughness.tint[1], 0.75);
    EXPECT_EQ(texture(material.number("metallic").texture).picture.channel, 2);  // blue
    EXPECT_EQ(texture(material.number("coat").texture).picture.channel, 0);      // red
    EXPECT_EQ(texture(material.number("coat").texture).tint[0], 0.5);
    // v = 0.25 from the top is 0.125 + 0.5 * 0.25 from the top of the picture.
    EXPECT_NEAR(color.mapping.t[1] * (1 - 0.25) + color.mapping.delta_v, 1 - 0.25, 1e-12);
    EXPECT_NEAR(color.mapping.s[0] * 0.125 + color.mapping.delta_u, 0.5, 1e-12);
    EXPECT_EQ(beside->description.shapes.at(0).mesh->uvs.at(2).y, 0);

    file.json["images"] = {{{"uri", "none.png"}}};
    EXPECT_THAT(refusal("room.glb", as_glb(file)), HasSubstr("/images/0/uri: "));
    folder_.write("m.mtl", "newmtl m\nKd .5 .5 .5\nmap_Kd wood 1.exr\n");
    const std::string obj = "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    const SceneDescription model = described("m.obj", obj);
    EXPECT_EQ(model.textures.at(model.materials.at(model.shapes.at(0).material).spectra.at("reflectance").texture).tint[0], 0.5);
    folder_.write("m.mtl", "newmtl m\nmap_Kd none.png\n");
    EXPECT_THAT(load("m.obj", obj).value().warnings,
                ::testing::ElementsAre(HasSubstr("m.mtl:2: map_Kd: none.png: cannot be opened; the material is without it")));
}

TEST_F(Models, AlphaOfTheBaseColourIsThatOfShapes) {
    folder_.write("leaf.tga", testing::tga({255, 0}));
    GltfFile file = quad_and_lamp();
    file.json["images"] = {{{"uri", "leaf.tga"}}};
    file.json["textures"] = {{{"source", 0}}};
    const auto alpha = [&](const Json& mode, bool textured, SceneDescription& scene) {
        file.json["materials"][0] = {{"alphaMode", mode}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, .75}}}}};
        if (textured) file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
        scene = described("room.glb", as_glb(file));
        return scene.shapes.at(0).alpha;
    };
    SceneDescription scene;
    EXPECT_EQ(alpha("OPAQUE", false, scene).value, 1);
    EXPECT_EQ(alpha("BLEND", false, scene).value, 0.75f);
    EXPECT_EQ(alpha("MASK", false, scene).value, 1);  // from 0.5 on
    const FloatInput blended = alpha("BLEND", true, scene);
    const TextureDescription blend = scene.textures.at(blended.texture);
    EXPECT_EQ(blend.picture.channel, 3);
    EXPECT_EQ(blend.tint[3], 0.75);
    const FloatInput masked = alpha("MASK", true, scene);
    const TextureDescription mask = scene.textures.at(masked.texture);
    EXPECT_EQ(mask.kind, TextureKind::kThreshold);
    EXPECT_EQ(mask.amount.value, 0.5f);
    EXPECT_EQ(scene.textures.at(mask.numbers[0].texture).picture.channel, 3);

    // A picture without alpha, or with none below 1, hides nothing.
    folder_.write("leaf.tga", testing::tga({255, 255}));
    testing::write_exr(folder_ / "wall.exr", 2, 1, {0.5f, 0.25f, 0.125f, 1, 0, 0});
    for (const char* opaque : {"leaf.tga", "wall.exr"}) {
        file.json["images"] = {{{"uri", opaque}}};
        EXPECT_EQ(alpha("BLEND", true, scene).value, 0.75f);
        EXPECT_EQ(alpha("MASK", true, scene).value, 1);
    }

    folder_.write("m.mtl", "newmtl m\nd .25\nmap_d leaf.tga\n");
    const SceneDescription model = described("m.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    EXPECT_EQ(model.materials.at(model.shapes.at(0).material).type, "diffuse");
    EXPECT_EQ(model.textures.at(model.shapes.at(0).alpha.texture).tint[0], 0.25);
}

TEST_F(Models, MtlStatementsChooseTheNearestMaterial) {
    const auto material = [&](const std::string& mtl) {
        folder_.write("m.mtl", "newmtl m\n" + mtl);
        return described("m.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").materials.back();
    };
    EXPECT_EQ(material("Kd .5 .5 .5\nKs .9 .9 .9\nillum 1\n").type, "diffuse");
    // Blender's default: an index of 1.5, and a roughness of 0.5.
    const MaterialDescription plastic = material("Kd .8 .8 .8\nKs .5 .5 .5\nNs 250\nillum 2\n");
    EXPECT_EQ(plastic.type, "metallicroughness");
    EXPECT_NEAR(plastic.spectra.at("base_color").value(500), 0.8, 1e-3);
    for (const auto& [name, value] : {std::pair("f0", 0.04f), {"f90", 1.0f}, {"roughness", 0.5f}, {"metallic", 0.0f}})
        EXPECT_FLOAT_EQ(plastic.number(name).value, value) << name;
    EXPECT_EQ(material("Kd 0 0 0\nKs .9 .9 .9\nillum 3\n").number("metallic").value, 1);
    const MaterialDescription glass = material("illum 7\nNi 1.33\n");
    EXPECT_EQ(glass.type, "dielectric");
    EXPECT_NEAR(glass.spectra.at("eta").value(550), 1.33, 1e-12);
    EXPECT_EQ(material("Tr 0.9\n").type, "diffuse");
    EXPECT_FLOAT_EQ(material("Pr 0.5\nPm 0.25\n").number("metallic").value, 0.25f);
    testing::write_exr(folder_ / "rust.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    EXPECT_TRUE(material("illum 3\nPm 1\nmap_Kd rust.exr\n").spectra.at("base_color").is_textured());
}

// [Wavefront]: "mtllib filename1 filename2 ...", searched in this order.
TEST_F(Models, AMaterialIsThatOfTheFirstOfItsLibraries) {
    folder_.write("a.mtl", "newmtl x\nKd 1 0 0\n");
    folder_.write("b.mtl", "newmtl x\nKd 0 1 0\nnewmtl y\nKd 0 1 0\n");
    const auto red = [&](const std::string& library) {  // of x and y
        const SceneDescription model =
            described("m.obj", "mtllib " + library + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl x\nf 1 2 3\nusemtl y\nf 1 2 3\n");
        const auto is_red = [&](std::size_t i) {
            const color::Spectrum& kd = model.materials.at(i).spectra.at("reflectance").value;
            return kd(650) > kd(540);
        };
        return std::pair(is_red(1), is_red(2));
    };
    EXPECT_EQ(red("a.mtl  b.mtl"), std::pair(true, false));
    EXPECT_EQ(red("b.mtl a.mtl"), std::pair(false, false));
    folder_.write("a.mtl b.mtl", "newmtl x\nKd 0 1 0\nnewmtl y\nKd 1 0 0\n");  // a name with a space
    EXPECT_EQ(red("a.mtl b.mtl"), std::pair(false, true));

    const auto warnings = [&](const std::string& library) {
        return load("m.obj", "mtllib " + library + "\nusemtl z\nv 0 0 0\nf 1 1 1\n").value().warnings;
    };
    EXPECT_THAT(warnings("a.mtl no.mtl neither.mtl"),
                ::testing::ElementsAre(HasSubstr("m.obj:1: mtllib: "), HasSubstr("/neither.mtl: cannot open")));
    EXPECT_THAT(warnings("no such.mtl"), ::testing::ElementsAre(HasSubstr("/no such.mtl: cannot open")));
}

TEST_F(Models, ObjCornersAreSharedAndPolygonsAreCut) {
    const SceneDescription scene = testing::in_world(described(
        "m.obj",
        "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.5 0\nv 0 2 0\nvn 0 0 1\nvt 0.25 0.75\nf 1/1/1 2/1/1 3/1/1 4/1/1 5/1/1\nf 1 2 3\n"));
    ASSERT_EQ(scene.shapes.size(), 2u);  // with normals, and without
    const MeshDescription& mesh = *scene.shapes[0].mesh;
    EXPECT_EQ(mesh.indices.size(), 9u);
    EXPECT_EQ(mesh.positions.size(), 5u);
    EXPECT_EQ(mesh.uvs.at(0), (Vec2f{0.25f, 0.75f}));
    double area = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const Vec3f &a = mesh.positions[mesh.indices[i]], &b = mesh.positions[mesh.indices[i + 1]],
                    &c = mesh.positions[mesh.indices[i + 2]];
        EXPECT_GT(cross(b - a, c - a).z, 0);  // none is turned over
        area += 0.5 * static_cast<double>(cross(b - a, c - a).z);
    }
    EXPECT_NEAR(area, 4 - 1.5, 1e-5);  // the notch is not filled
    EXPECT_TRUE(scene.shapes[1].mesh->normals.empty());
}

TEST_F(Models, WhatIsWrongIsSaidWithItsPlace) {
    const auto broken = [&](const std::string& pointer, const Json& value) {
        GltfFile file = quad_and_lamp();
        file.json[Json::json_pointer(pointer)] = value;
        return refusal("room.glb", as_glb(file));
    };
    EXPECT_THAT(broken("/nodes/1/mesh", 7), HasSubstr("room.glb: /nodes/1/mesh: is not an index into /meshes, which has 1 item"));
    EXPECT_THAT(broken("/accessors/0/count", 1000000000), HasSubstr("/accessors/0: its 1000000000 items exceed"));
    EXPECT_THAT(broken("/accessors/0/byteOffset", 1e15), HasSubstr("/accessors/0: its 4 items exceed"));
    EXPECT_THAT(broken("/bufferViews/0/byteLength", 4000), HasSubstr("/bufferViews/0: ends at byte"));
    EXPECT_THAT(broken("/bufferViews/0/byteStride", 4), HasSubstr("/bufferViews/0/byteStride"));
    EXPECT_THAT(broken("/nodes/1/children", {1}), HasSubstr("/nodes/1/children/0: node 1 is reached twice"));
    EXPECT_THAT(broken("/nodes/1/rotation", {0, 0, 0, 0}), HasSubstr("/nodes/1/rotation: is not a rotation"));
    EXPECT_THAT(broken("/nodes/1/matrix", {1, 2, 3}), HasSubstr("/nodes/1/matrix: must be an array of 16 numbers"));
    for (const Json& version : {Json("1.0"), Json(1), Json(1.0), Json("")})
        EXPECT_THAT(broken("/asset/version", version), HasSubstr("only glTF 2.0 is supported")) << version;
    EXPECT_THAT(broken("/extensionsRequired", {"KHR_texture_basisu"}),
                HasSubstr("/extensionsRequired/0: KHR_texture_basisu is not supported"));
    EXPECT_THAT(broken("/materials/0/pbrMetallicRoughness/metallicFactor", "shiny"), HasSubstr("metallicFactor: must be a"));
    EXPECT_THAT(broken("/meshes/0/primitives/0/attributes/POSITION", 1), HasSubstr("has 1 numbers per item"));
    GltfFile file = quad_and_lamp();
    file.binary[4 * 4 + 3] = '\x7f', file.binary[4 * 4 + 2] = '\xc0';  // y of vertex 1
    EXPECT_THAT(refusal("room.glb", as_glb(file)), HasSubstr("/accessors/0: item 1 is not finite"));
    EXPECT_THAT(refusal("room.gltf", "{\"asset\": {\n  \"version\" 2}}"), HasSubstr("room.gltf:2:13: not valid JSON: "));

    EXPECT_THAT(refusal("room.gltf", "{\"asset\": {\"version\": 1e999}}"),
                HasSubstr("room.gltf:1:23: the number exceeds double precision"));

    EXPECT_THAT(refusal("m.obj", "v 0 0 0\nv 1 0 nan\n"), HasSubstr("m.obj:2: v: \"nan\" is not a finite number"));
    EXPECT_THAT(refusal("m.obj", "v 0 0 0\n\nf 1 2 3\n"), HasSubstr("m.obj:3: f: vertex 2 is out of range; there are 1"));
    EXPECT_THAT(refusal("m.obj", "v 0 0 0\nf 1 x 1\n"), HasSubstr("m.obj:2: f: \"x\" is not an index"));
    EXPECT_THAT(refusal("m.obj", "# nothing\n"), HasSubstr("m.obj: has no triangles"));
    EXPECT_THAT(refusal("m.obj", ""), HasSubstr("m.obj: not a Wavefront OBJ file: the file is empty"));
    EXPECT_THAT(refusal("m.obj", std::string("\x64\x86\x00\x01", 4)), HasSubstr("m.obj: not a Wavefront OBJ file: it is binary"));
}

TEST_F(Models, AllMissingFilesAreNamedAtOnce) {
    GltfFile file = quad_and_lamp();
    file.json["buffers"] = {{{"byteLength", 84}, {"uri", "a.bin"}},
                            {{"byteLength", 84}, {"uri", "b.bin"}},
                            {{"byteLength", 8}, {"uri", "https://x.org/c.bin"}}};
    const std::string message = refusal("room.gltf", file.json.dump());
    for (const char* part :
         {"/buffers/0/uri: ", "a.bin", "/buffers/1/uri: ", "b.bin", "/buffers/2/uri: \"https://x.org/c.bin\" is not a path"})
        EXPECT_THAT(message, HasSubstr(part));
    // What a missing file would have defined is not missed once more.
    EXPECT_THAT(load("m.obj", "mtllib a.mtl\nmtllib b.mtl\nusemtl x\nv 0 0 0\nf 1 1 1\n").value().warnings,
                ::testing::ElementsAre(AllOf(HasSubstr("m.obj:1: "), HasSubstr("a.mtl")),
                                       AllOf(HasSubstr("m.obj:2: "), HasSubstr("b.mtl"))));
}

TEST_F(Models, WhatManyThingsUseIsComplainedAboutOnce) {
    GltfFile file = quad_and_lamp();
    file.json["accessors"][0]["count"] = 1000000000;
    const Json primitive = file.json["meshes"][0]["primitives"][0];
    for (int i = 0; i < 5; ++i) file.json["meshes"][0]["primitives"].push_back(primitive);
    const std::string message = refusal("room.glb", as_glb(file));
    EXPECT_THAT(message, HasSubstr("/accessors/0: its 1000000000 items exceed"));
    EXPECT_EQ(std::ranges::count(message, '\n'), 0) << message;
}

// What exporters write a little wrong is read, with one warning for all of its kind.
TEST_F(Models, FactorsOutOfRangeAreClampedAndCounted) {
    const auto with = [&](double base, double metallic, double emission) {
        GltfFile file = quad_and_lamp();
        Json& material = file.json["materials"][0];
        material["pbrMetallicRoughness"] = {{"baseColorFactor", {base, base, .5, 1}}, {"metallicFactor", metallic}};
        material["emissiveFactor"] = {emission, 0, 0};
        file.json["materials"] = std::vector<Json>(3, material);
        Result<LoadedScene> scene = load("room.glb", as_glb(file));
        EXPECT_TRUE(scene) << scene.error().message;
        return scene ? std::move(*scene) : LoadedScene{};
    };
    const LoadedScene right = with(1, 0, 1), wrong = with(1.5, -0.25, 7);
    EXPECT_EQ(content_hash(wrong.description), content_hash(right.description));
    EXPECT_THAT(right.warnings, ::testing::IsEmpty());
    const std::string material = "room.glb: /materials/0/";
    EXPECT_THAT(
        wrong.warnings,
        ::testing::UnorderedElementsAre(
            HasSubstr(material + "pbrMetallicRoughness/baseColorFactor: 1.5 is clamped: must be from 0 to 1 (and in 2 other"),
            HasSubstr(material + "pbrMetallicRoughness/metallicFactor: -0.25 is clamped: must be from 0 to 1 (and in 2"),
            HasSubstr(material + "emissiveFactor: 7 is clamped: must be from 0 to 1; KHR_materials_emissive_strength")));
}

TEST_F(Models, MisspeltMembersAreWarnedOfWithTheNameThatWasMeant) {
    const auto warnings = [&](const std::string& pointer, const Json& value) {
        GltfFile file = quad_and_lamp();
        file.json[Json::json_pointer(pointer)] = value;
        return load("room.glb", as_glb(file)).value().warnings;
    };
    const auto is = [](const std::string& pointer, const std::string& meant) {
        return ::testing::ElementsAre(
            ::testing::EndsWith("room.glb: " + pointer + ": is not part of glTF 2.0, and is ignored" + meant));
    };
    const std::string material = "/materials/0/", pbr = material + "pbrMetallicRoughness/";
    EXPECT_THAT(warnings(pbr + "baseColourFactor", {1, 0, 0, 1}), is(pbr + "baseColourFactor", "; did you mean baseColorFactor?"));
    EXPECT_THAT(warnings(material + "emmisiveFactor", {1, 0, 0}),
                is(material + "emmisiveFactor", "; did you mean emissiveFactor?"));
    EXPECT_THAT(warnings("/nodes/1/rotaton", {0, 0, 0, 1}), is("/nodes/1/rotaton", "; did you mean rotation?"));
    EXPECT_THAT(warnings("/nodes/1/zzz", 1), is("/nodes/1/zzz", ""));
    const std::string attributes = "/meshes/0/primitives/0/attributes/";
    EXPECT_THAT(warnings(attributes + "TEXCOORD0", 0), is(attributes + "TEXCOORD0", "; did you mean TEXCOORD_0?"));
    // Neither what applications add, nor what is known and not used.
    for (const char* quiet : {"/extras", "/materials/0/extras", "/nodes/1/extensions/EXT_unknown", "/meshes/0/extensions/X_y",
                              "/materials/0/pbrMetallicRoughness/extras", "/meshes/0/primitives/0/attributes/_ID",
                              "/meshes/0/primitives/0/attributes/JOINTS_3", "/accessors/0/min", "/asset/generator"})
        EXPECT_THAT(warnings(quiet, Json::object()), ::testing::IsEmpty()) << quiet;
}

TEST_F(Models, ATextureWithoutCoordinatesIsWarnedOf) {
    testing::write_exr(folder_ / "wood.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    GltfFile file = quad_and_lamp();
    const Json uv = file.add_floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2");
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uv;
    file.json["images"] = {{{"uri", "wood.exr"}}};
    file.json["textures"] = {{{"source", 0}}};
    Json& info = file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    const auto warnings = [&] {
        std::vector<std::string> lines = load("room.glb", as_glb(file)).value().warnings;
        std::erase_if(lines, [](const std::string& line) { return line.find("TEXCOORD") == line.npos; });
        return lines;
    };
    EXPECT_THAT(warnings(), ::testing::IsEmpty());
    info["texCoord"] = 3;
    EXPECT_THAT(warnings(), ::testing::ElementsAre(HasSubstr(
                                "/meshes/0/primitives/0/attributes: has no TEXCOORD_3, which textures of its material use; each")));
}

// Whatever stands in the place of a member: one line, which names that place if the kind is wrong.
TEST_F(Models, AnythingOfTheWrongKindIsOneError) {
    const Json values[] = {"word", 0.5, -1, 7, 1e9, true, nullptr, Json::array(), Json::object(), {1, 2}, {{"a", 1}}};
    const GltfFile whole = quad_and_lamp();
    const Json flat = whole.json.flatten();
    std::set<std::string> places = {"/extensionsRequired", "/extensionsUsed", "/scene"};
    for (const auto& [pointer, unused] : flat.items()) {
        for (std::size_t end = 0; end != pointer.npos;) {
            end = pointer.find('/', end + 1);
            places.insert(pointer.substr(0, end));
        }
    }
    std::size_t refused = 0;
    std::erase_if(places, [](const std::string& place) { return place.starts_with("/buffers") || place.empty(); });  // as_glb's
    for (const std::string& place : places) {
        for (const Json& value : values) {
            GltfFile file = whole;
            file.json[Json::json_pointer(place)] = value;
            const Json empty = Json::array();
            if ((value == empty || value.is_null()) && place.ends_with("s")) continue;  // no items: all that name one are wrong
            const Result<LoadedScene> scene = load("room.glb", as_glb(file));
            if (scene) continue;
            ++refused;
            const std::string& message = scene.error().message;
            EXPECT_EQ(std::ranges::count(message, '\n'), 0) << place << " " << value << "\n" << message;
            if (message.find(": must be ") == message.npos) continue;  // of what refers to it, perhaps
            const std::string at = message.substr(message.find("room.glb: ") + 10), named = at.substr(0, at.find(": "));
            EXPECT_TRUE(named.starts_with(place) || place.starts_with(named)) << place << ": " << message;
        }
    }
    EXPECT_GT(refused, 300u);
    GltfFile file = whole;
    EXPECT_THAT(refusal("room.gltf", "{\"scenes\": []}"), ::testing::EndsWith("room.gltf: has no asset"));
    file.json["extensionsRequired"] = "KHR_texture_basisu";
    EXPECT_THAT(refusal("room.glb", as_glb(file)),
                ::testing::EndsWith("room.glb: /extensionsRequired: must be an array of strings"));
}

TEST_F(Models, WhatIsNoModelIsCalledByItsName) {
    const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n";
    for (const char* name : {"a.glb", "a.gltf", "a.obj"})
        EXPECT_THAT(refusal(name, pointer), HasSubstr("is a Git LFS pointer")) << name;
    EXPECT_THAT(refusal("a.glb", "<!DOCTYPE html>"), HasSubstr("is neither glTF, which is JSON, nor a .glb"));
    EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\np 1 2\n"), HasSubstr("points and lines are not drawn"));
}

TEST_F(Models, WhatIsMissingForAColourIsLeftOutWithAWarning) {
    const LoadedScene colours = load("m.obj", "v 0 0 0 nan 1 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n").value();
    EXPECT_THAT(colours.warnings, ::testing::ElementsAre(HasSubstr("\"nan\" is not a finite number, and counts as 0")));
    GltfFile file = quad_and_lamp();
    file.json["textures"] = Json::array({Json::object()});
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    EXPECT_THAT(load("room.glb", as_glb(file)).value().warnings,
                ::testing::ElementsAre(HasSubstr("/textures/0: is ignored: it has no source")));
    file.json["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 0;
    EXPECT_THAT(refusal("room.glb", as_glb(file)), HasSubstr("has no source that is supported"));
}

TEST_F(Models, WhatAModelLacksIsNotedAndIsNoWarning) {
    const std::string camera = "has no camera; one that shows the whole model is added",
                      light = "has no light; a soft sky with a key light is added",
                      own = "is lit by its own lights alone; --sky FILE adds a sky",
                      no_ground = "has a camera, and so no ground: --no-stage changes nothing";
    const auto added = [&](const std::string& name, const std::string& text) {
        const LoadedScene scene = load(name, text).value();
        EXPECT_THAT(scene.warnings, ::testing::IsEmpty());
        std::vector<std::string> out;
        for (const std::string& line : scene.added) out.push_back(line.substr(line.find(": ") + 2));
        return out;
    };
    using Lines = std::vector<std::string>;
    EXPECT_EQ(added("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), (Lines{camera, light}));
    GltfFile file = quad_and_lamp();
    EXPECT_EQ(added("room.glb", as_glb(file)), (Lines{no_ground, own}));
    const LoadedScene from_above =
        load_scene(folder_.write("room.glb", as_glb(file)), false, color::RgbSpectra::kSmooth, {.view = ModelView::kTop}).value();
    EXPECT_THAT(from_above.added, ::testing::Contains(HasSubstr("has a camera: --view changes nothing")));
    file.json["scenes"][0]["nodes"] = {0, 1};
    EXPECT_EQ(added("room.glb", as_glb(file)), (Lines{no_ground, light}));
    file.json.erase("cameras");
    file.json["nodes"][0].erase("camera");
    EXPECT_EQ(added("room.glb", as_glb(file)), (Lines{camera, light}));
}

TEST_F(Models, SurfacesOfRadianceOneOrLessDoNotReplaceTheSky) {
    const auto has_sky = [&](const std::string& name, const std::string& text) {
        const LoadedScene scene = load(name, text).value();
        EXPECT_EQ(scene.description.area_lights.size(), 1u);
        const bool added = !scene.description.lights.empty();
        EXPECT_EQ(std::ranges::count_if(scene.added, [](const std::string& s) { return s.find("a soft sky") != s.npos; }),
                  added ? 1 : 0);
        return added;
    };
    const auto lit = [&](const char* emission) {
        folder_.write("m.mtl", std::string("newmtl a\nKe ") + emission + "\n");
        return has_sky("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    };
    EXPECT_TRUE(lit("1 1 1"));
    EXPECT_FALSE(lit("0 0 1.5"));
    GltfFile file = quad_and_lamp();
    file.json["scenes"][0]["nodes"] = {0, 1};  // without its point light
    Json& material = file.json["materials"][0];
    material["emissiveFactor"] = {1, 0, 0};
    EXPECT_TRUE(has_sky("room.glb", as_glb(file)));
    material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 1.5;
    EXPECT_FALSE(has_sky("room.glb", as_glb(file)));
}

TEST_F(Models, ANodeWithAMatrixHasNothingElse) {
    GltfFile file = quad_and_lamp();
    file.json["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    file.json["nodes"][1]["translation"] = {0, 0, 1};
    EXPECT_THAT(load("room.glb", as_glb(file)).value().warnings,
                ::testing::ElementsAre(HasSubstr("/nodes/1/translation: is ignored, since the node has a matrix")));
}

TEST_F(Models, ThatNeedALaterVersionAreRefused) {
    GltfFile file = quad_and_lamp();
    file.json["asset"]["minVersion"] = "2.1";
    EXPECT_THAT(load("room.glb", as_glb(file)).error().message, HasSubstr("is glTF \"2.1\"; only glTF 2.0 is supported"));
}

// Some exporters write an infinite distance as null.
TEST_F(Models, NullIsNotThere) {
    GltfFile file = quad_and_lamp();
    file.json["nodes"][1]["name"] = nullptr;
    file.json["extras"] = nullptr;  // may be anything
    file.json["materials"][0]["extensions"]["KHR_materials_volume"]["attenuationDistance"] = nullptr;
    EXPECT_THAT(load("room.glb", as_glb(file)).value().warnings,
                ::testing::ElementsAre(AllOf(HasSubstr("/attenuationDistance: is null, and is ignored (and in 1 other place)"))));
}

TEST_F(Models, AValueThatManyNodesUseIsOnePlace) {
    GltfFile file = quad_and_lamp();
    file.json["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = -1;
    const Json lamp = file.json["nodes"][2];
    for (int i = 0; i < 3; ++i) {
        file.json["scenes"][0]["nodes"].push_back(file.json["nodes"].size());
        file.json["nodes"].push_back(lamp);
    }
    EXPECT_THAT(load("room.glb", as_glb(file)).value().warnings,
                ::testing::ElementsAre(::testing::EndsWith("/intensity: -1 is clamped: must be at least 0")));
}

// As an editor counts them; those of a binary file begin with its JSON.
TEST_F(Models, AFaultOfTheJsonIsSaidWithItsLineAndColumn) {
    EXPECT_THAT(refusal("room.gltf", "{\n  \"asset\": {\"version\": \"2.0\"},\n  \"nodes\": [1, 2,, 3]\n}\n"),
                HasSubstr("room.gltf:3:18: not valid JSON: "));
    EXPECT_THAT(refusal("room.gltf", "{\n  \"asset\": \"two\nlines\"\n}\n"), HasSubstr("room.gltf:2:16: not valid JSON: "));
    EXPECT_THAT(refusal("room.gltf", "{?"), HasSubstr("room.gltf:1:2: not valid JSON"));
    for (const char* empty : {"", " \n\n"}) EXPECT_THAT(refusal("room.gltf", empty), HasSubstr("room.gltf: the file is empty"));
    std::string glb = as_glb(quad_and_lamp());
    glb[20 + 40] = '\x01';
    EXPECT_THAT(refusal("room.glb", glb), HasSubstr("room.glb: JSON chunk, 1:41: not valid JSON: "));
}

// A binary file that is cut anywhere is one error, and so is a text.
TEST_F(Models, TruncatedFilesAreOneError) {
    const std::string glb = as_glb(quad_and_lamp());
    for (std::size_t size = 4; size < glb.size(); size += 3) {
        const std::string message = refusal("room.glb", glb.substr(0, size));
        ASSERT_THAT(message, HasSubstr("room.glb")) << size;
        ASSERT_THAT(message, HasSubstr("truncated")) << size;
    }
    const std::string json = quad_and_lamp().json.dump();
    for (std::size_t size = 0; size < json.size(); size += 7) ASSERT_NE(refusal("room.gltf", json.substr(0, size)), "") << size;
}

// Any byte of the JSON or of the buffer may be anything: the file is read or refused.
TEST_F(Models, DamagedFilesAreReadOrRefused) {
    const std::string glb = as_glb(quad_and_lamp());
    const std::string obj =
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1e3 0\nvt 0 1\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3/1/1 1/1/1\nf -1 -2 -3\n";
    folder_.write("m.mtl", "newmtl a\nKd 1 0 0\n");
    std::uint32_t random = 1;
    std::size_t read = 0, refused = 0;
    for (int i = 0; i < 1500; ++i) {
        const bool is_glb = i % 2 == 0;
        std::string bytes = is_glb ? glb : obj;
        for (int changes = 0; changes < 1 + i % 3; ++changes) {
            random = random * 1664525 + 1013904223;
            const char put[] = {static_cast<char>(random >> 8), '9', '-', '"', ' ', '[', '0', '\n'};
            bytes[(random >> 11) % bytes.size()] = put[(random >> 5) % 8];
        }
        const Result<LoadedScene> scene = load(is_glb ? "room.glb" : "room.obj", bytes);
        ++(scene ? read : refused);
        EXPECT_TRUE(scene || !scene.error().message.empty());
    }
    EXPECT_GT(read, 50u);
    EXPECT_GT(refused, 50u);
}

}  // namespace
}  // namespace latent::render
