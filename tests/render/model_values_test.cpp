// The values of a model's materials, a factor times a picture times colours of vertices, and where pictures lie on surfaces.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "render/scene/content_hash.h"
#include "tests/render/models.h"
#include "tests/render/seen_values.h"

namespace latent::render {
namespace {

using testing::as_glb;
using testing::Folder;
using testing::GltfFile;
using ::testing::HasSubstr;
using testing::SeenValues;
using Json = nlohmann::json;

// A unit square that faces +z, with texture coordinates (x, 1 - y), as glTF has them.
struct Square {
    GltfFile file;
    Json& primitive() { return file.json["meshes"][0]["primitives"][0]; }
    Json& attributes() { return primitive()["attributes"]; }
    Json& material() { return file.json["materials"][0]; }
    Json& pbr() { return material()["pbrMetallicRoughness"]; }

    Square() {
        const Json position = file.add_floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3"),
                   uv = file.add_floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2"), indices = file.add_indices({0, 1, 2, 0, 2, 3});
        file.json["meshes"] = {
            {{"primitives",
              {{{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}}}, {"indices", indices}, {"material", 0}}}}}};
        file.json["nodes"] = {{{"mesh", 0}}};
        file.json["scenes"] = {{{"nodes", {0}}}};
        file.json["materials"] = {{{"pbrMetallicRoughness", {{"metallicFactor", 0}}}}};
    }
    // Texture i shows file `name`.
    std::size_t add_picture(const std::string& name, const Json& sampler = Json::object()) {
        const std::size_t i = file.json.contains("images") ? file.json["images"].size() : 0;
        file.json["images"].push_back({{"uri", name}});
        file.json["samplers"].push_back(sampler);
        file.json["textures"].push_back({{"source", i}, {"sampler", i}});
        return i;
    }
};

class ModelValues : public ::testing::Test {
 protected:
    SceneDescription load(const std::string& name, const std::string& text) {
        Result<LoadedScene> scene = load_scene(folder_.write(name, text));
        if (!scene) throw std::runtime_error(scene.error().message);
        warnings_ = scene->warnings;
        notes_ = scene->notes;
        return scene->description;
    }
    SceneDescription load(const Square& square) { return load("square.glb", as_glb(square.file)); }
    static void expect_near(const SampledSpectrum& a, const SampledSpectrum& b, float tolerance, const std::string& where = "") {
        for (std::uint32_t i = 0; i < kMaxWavelengths; i += 5) EXPECT_NEAR(a.v[i], b.v[i], tolerance) << where << " " << i;
    }

    Folder folder_;
    std::vector<std::string> warnings_, notes_;
};

TEST_F(ModelValues, AFactorTimesAPictureIsThePictureOfTheirProduct) {
    testing::write_exr(folder_ / "a.exr", 1, 1, {0.75f, 0.5f, 0.25f});
    Square square;
    const Json info = {{"index", square.add_picture("a.exr")}};
    square.material() = {{"pbrMetallicRoughness",
                          {{"baseColorFactor", {1, .25, .5, 1}},
                           {"baseColorTexture", info},
                           {"metallicRoughnessTexture", info},
                           {"roughnessFactor", 0.5},
                           {"metallicFactor", 0.25}}},
                         {"occlusionTexture", info},
                         {"extensions",
                          {{"KHR_materials_sheen", {{"sheenColorFactor", {.5, 1, 1}}, {"sheenColorTexture", info}}},
                           {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatTexture", info}}}}}};
    SeenValues seen(load(square));
    expect_near(seen.spectrum("base_color", 0.3, 0.3), seen.of_rgb({0.75f, 0.125f, 0.125f}), 1e-5f);
    expect_near(seen.spectrum("sheen.color", 0.3, 0.3), seen.of_rgb({0.375f, 0.5f, 0.25f}), 1e-5f);
    EXPECT_FLOAT_EQ(seen.number("roughness", 0.3, 0.3), 0.5f * 0.5f);
    EXPECT_FLOAT_EQ(seen.number("metallic", 0.3, 0.3), 0.25f * 0.25f);
    EXPECT_FLOAT_EQ(seen.number("coat", 0.3, 0.3), 0.75f * 0.5f);
    EXPECT_THAT(warnings_, ::testing::IsEmpty());
    EXPECT_THAT(notes_, ::testing::ElementsAre(HasSubstr("/materials/0/occlusionTexture: is not used: occlusion is computed")));

    folder_.write("m.mtl", "newmtl m\nKd 1 .25 .5\nmap_Kd a.exr\nKs .5 .25 .125\nmap_Ks a.exr\nNs 8\nmap_Ns a.exr\n");
    const std::string obj = "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    SeenValues model(load("m.obj", obj));
    expect_near(model.spectrum("base_color", 0.7, 0.3), model.of_rgb({0.75f, 0.125f, 0.125f}), 1e-5f);
    const float ks = 0.875f / 3;  // the mean
    EXPECT_FLOAT_EQ(model.number("f0", 0.7, 0.3), 0.08f * ks * 0.5f);
    EXPECT_FLOAT_EQ(model.number("f90", 0.7, 0.3), 2 * ks * 0.5f);
    EXPECT_FLOAT_EQ(model.number("roughness", 0.7, 0.3), 1 - 0.5f * std::sqrt(0.008f));
    for (const char* without : {"", "Kd 0 0 0\n"}) {  // the picture is all there is
        folder_.write("m.mtl", std::string("newmtl m\nmap_Kd a.exr\n") + without);
        SeenValues alone(load("m.obj", obj));
        expect_near(alone.spectrum("reflectance", 0.7, 0.3), alone.of_rgb({0.75f, 0.5f, 0.25f}), 1e-5f);
    }
}

TEST_F(ModelValues, TheMirrorOfSpecularGlossinessTakesLightFromTheBodyWhereverItIs) {
    testing::write_exr(folder_ / "a.exr", 1, 1, {0.25f, 0.5f, 0.125f});
    for (const auto& [specular, brightest] : {std::pair(Json{1, 1, 1}, 0.5f), {Json{1, .25, 1}, 0.25f}, {Json{.8, .8, .8}, 0.4f}}) {
        Square square;
        square.material() = {{"extensions",
                              {{"KHR_materials_pbrSpecularGlossiness",
                                {{"diffuseFactor", {.75, .5, .25, 1}},
                                 {"specularFactor", specular},
                                 {"specularGlossinessTexture", {{"index", square.add_picture("a.exr")}}}}}}}};
        SeenValues seen(load(square));
        SampledSpectrum body = seen.of_rgb({0.75f, 0.5f, 0.25f});
        for (float& x : body.v) x *= (1 - brightest) / 0.96f;
        expect_near(seen.spectrum("base_color", 0.3, 0.3), body, 2e-3f, specular.dump());
    }
}

TEST_F(ModelValues, AnEmissionTimesAPictureIsThatOfTheProduct) {
    testing::write_exr(folder_ / "a.exr", 1, 1, {0.75f, 0.5f, 0.25f});
    testing::write_exr(folder_ / "product.exr", 1, 1, {0.75f, 0.125f, 0.125f});
    const auto light_of = [&](const std::string& picture, const Json& factor) {
        Square square;
        square.material()["emissiveFactor"] = factor;
        square.material()["emissiveTexture"] = {{"index", square.add_picture(picture)}};
        const SceneDescription scene = load(square);
        return std::pair(scene.area_lights.at(0), scene.textures.at(scene.area_lights.at(0).picture));
    };
    const auto [product, product_picture] = light_of("product.exr", {1, 1, 1});
    const auto [light, picture] = light_of("a.exr", {1, .25, .5});
    EXPECT_NEAR(light.mean_luminance / product.mean_luminance, 1, 1e-6);
    EXPECT_EQ(light.spectrum(500), product.spectrum(500));
    EXPECT_EQ(picture.tint, (std::array<double, 4>{1, .25, .5, 1}));
    folder_.write("m.mtl", "newmtl m\nKe 1 .25 .5\nmap_Ke a.exr\n");
    const SceneDescription model = load("m.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    EXPECT_NEAR(model.area_lights.at(0).mean_luminance / product.mean_luminance, 1, 1e-6);
}

// The specification asks for normalized integers; who leaves that word out means fractions all the same.
TEST_F(ModelValues, IntegersThatAreNotNormalizedAreFractionsAsColours) {
    for (const int component : {5121, 5123}) {
        Square square;
        const std::size_t colors = square.file.add_fractions({1, .2, .4, 1, .2, .4, 0, .2, .4, 0, .2, .4}, "VEC3", component);
        square.attributes()["COLOR_0"] = colors;
        const SceneDescription normalized = load(square);
        square.file.json["accessors"][colors].erase("normalized");
        const Result<LoadedScene> scene = load_scene(folder_.write("a.glb", as_glb(square.file)));
        ASSERT_TRUE(scene) << scene.error().message;
        EXPECT_THAT(scene->warnings,
                    ::testing::ElementsAre(HasSubstr("/attributes/COLOR_0: is of integers that are not normalized")));
        EXPECT_EQ(content_hash(scene->description), content_hash(normalized)) << component;
    }
}

TEST_F(ModelValues, ColoursOfVerticesMultiplyTheBaseColourInEveryNumberType) {
    for (const int component : {5121, 5123, 5126}) {
        for (const bool has_alpha : {false, true}) {
            Square square;
            square.attributes()["COLOR_0"] =
                has_alpha
                    ? square.file.add_fractions({1, .2, .4, .6, 1, .2, .4, .6, 0, .2, .4, .6, 0, .2, .4, .6}, "VEC4", component)
                    : square.file.add_fractions({1, .2, .4, 1, .2, .4, 0, .2, .4, 0, .2, .4}, "VEC3", component);
            square.pbr()["baseColorFactor"] = {.5, 1, 1, .5};
            square.material()["alphaMode"] = "BLEND";
            SceneDescription scene = load(square);
            EXPECT_EQ(scene.shapes.at(0).alpha.is_textured(), has_alpha);
            const FloatInput alpha = scene.shapes[0].alpha;
            scene.shapes[0].alpha = 1;  // to be met everywhere
            SeenValues seen(scene);
            // From red below to none above.
            for (const double y : {0.1, 0.5, 0.75})
                expect_near(seen.spectrum("base_color", 0.4, y), seen.of_rgb({static_cast<float>(0.5 * (1 - y)), .2f, .4f}), 2e-3f,
                            fmt::format("{} {}", component, y));
            if (!has_alpha) {
                EXPECT_EQ(alpha.value, 0.5f);
            }
            if (has_alpha) {
                EXPECT_EQ(scene.textures.at(alpha.texture).picture.channel, 3);
            }
        }
    }
}

TEST_F(ModelValues, ColoursOfVerticesTimesAPictureAreTheirProductAndOthersStayWhite) {
    testing::write_exr(folder_ / "a.exr", 1, 1, {0.75f, 0.5f, 0.25f});
    Square square;
    square.pbr()["baseColorTexture"] = {{"index", square.add_picture("a.exr")}};
    Json plain = square.primitive();
    plain["attributes"]["POSITION"] = square.file.add_floats({2, 0, 0, 3, 0, 0, 3, 1, 0, 2, 1, 0}, "VEC3");
    square.attributes()["COLOR_0"] = square.file.add_floats({1, .5, 0, 1, .5, 0, 1, .5, 0, 1, .5, 0}, "VEC3");
    square.file.json["meshes"][0]["primitives"].push_back(plain);
    SeenValues seen(load(square));
    expect_near(seen.spectrum("base_color", 0.4, 0.3), seen.of_rgb({0.75f, 0.25f, 0}), 1e-5f);
    expect_near(seen.spectrum("base_color", 2.4, 0.3), seen.of_rgb({0.75f, 0.5f, 0.25f}), 1e-5f);
}

// As Blender and three.js have them.
TEST_F(ModelValues, ColoursOfObjVerticesAreEncodedAsSrgb) {
    const std::string faces = "f 1 2 3\n";
    const auto of = [&](const std::string& color) { return fmt::format("v 0 0 0 {0}\nv 1 0 0 {0}\nv 1 1 0 {0}\n", color) + faces; };
    const float half = 0.21404114f;  // of 0.5
    for (const char* color : {"1 0.5 0", "255 127.5 0"}) {
        SeenValues seen(load("m.obj", of(color)));
        expect_near(seen.spectrum("reflectance", 0.7, 0.3), seen.of_rgb({1, half, 0}), 1e-5f, color);
    }
    folder_.write("m.mtl", "newmtl m\nKd .5 1 1\n");
    SeenValues seen(load("m.obj", "mtllib m.mtl\nusemtl m\n" + of("1 0.5 0")));
    expect_near(seen.spectrum("reflectance", 0.7, 0.3), seen.of_rgb({0.5f, half, 0}), 1e-5f);
    // A weight is no colour.
    EXPECT_EQ(content_hash(load("m.obj", of("1"))), content_hash(load("m.obj", of(""))));
}

TEST_F(ModelValues, ColoursOfPlyVerticesAreATextureOfScenesThatAskForThem) {
    const auto ply = [&](const char* type, const char* color) {
        folder_.write("m.ply", fmt::format("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                                           "float z\nproperty {0} red\nproperty {0} green\nproperty {0} blue\nproperty {0} alpha\n"
                                           "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                           "0 0 0 {1}\n1 0 0 {1}\n1 1 0 {1}\n3 0 1 2\n",
                                           type, color));
    };
    const std::string textured =
        "WorldBegin\nLightSource \"infinite\"\nTexture \"c\" \"spectrum\" \"latent:vertexcolor\"\nTexture \"a\" \"float\" "
        "\"latent:vertexcolor\" \"string channel\" \"alpha\"\nMaterial \"phong\" \"texture Kd\" \"c\" \"texture exponent\" \"a\"\n"
        "Shape \"plymesh\" \"string filename\" \"m.ply\"\n";
    ply("uchar", "255 128 0 128");
    SeenValues seen(load("m.pbrt", textured));
    expect_near(seen.spectrum("Kd", 0.7, 0.3), seen.of_rgb({1, 0.2158605f, 0}), 1e-5f);
    EXPECT_NEAR(seen.number("exponent", 0.7, 0.3), 128 / 255.0, 1e-6);
    ply("float", "1 0.5 0 0.25");
    SeenValues linear(load("m.pbrt", textured));
    expect_near(linear.spectrum("Kd", 0.7, 0.3), linear.of_rgb({1, 0.5f, 0}), 1e-5f);
    const std::string plain = "WorldBegin\nLightSource \"infinite\"\nShape \"plymesh\" \"string filename\" \"m.ply\"\n";
    EXPECT_TRUE(load("m.pbrt", plain).shapes.at(0).mesh->colors.empty());
}

TEST_F(ModelValues, BumpsCanBeMadeOfColoursOfVertices) {
    // The height is x: the normal tilts by 45 degrees.
    folder_.write("m.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
                  "red\nproperty float green\nproperty float blue\nelement face 1\nproperty list uchar int "
                  "vertex_indices\nend_header\n0 0 0 0 0 0\n1 0 0 1 1 1\n1 1 0 1 1 1\n3 0 1 2\n");
    SeenValues seen(load("m.pbrt",
                         "WorldBegin\nLightSource \"infinite\"\nTexture \"h\" \"float\" \"latent:vertexcolor\"\n"
                         "Material \"diffuse\" \"texture displacement\" \"h\"\nShape \"plymesh\" \"string filename\" "
                         "\"m.ply\"\n"));
    const Vec3f n = seen.normal(0.7, 0.3);
    EXPECT_NEAR(n.x, -std::sqrt(0.5f), 1e-3);
    EXPECT_NEAR(n.y, 0, 1e-3);
}

// Texels 1 and 0: along x, then once more upside down.
constexpr int kNearest = 9728, kLinear = 9729, kRepeat = 10497, kMirror = 33648, kClamp = 33071;

TEST_F(ModelValues, ANearestSamplerShowsTexelsAsTheyAre) {
    testing::write_exr(folder_ / "two.exr", 2, 1, {1, 1, 1, 0, 0, 0});
    const auto at = [&](const Json& sampler, double x) {
        Square square;
        square.pbr()["metallicFactor"] = 1;
        square.pbr()["metallicRoughnessTexture"] = {{"index", square.add_picture("two.exr", sampler)}};
        return SeenValues(load(square)).number("metallic", x, 0.5);
    };
    for (const double x : {0.01, 0.3, 0.49}) EXPECT_EQ(at({{"magFilter", kNearest}}, x), 1) << x;
    for (const double x : {0.51, 0.7, 0.99}) EXPECT_EQ(at({{"magFilter", kNearest}}, x), 0) << x;
    for (const Json& sampler : {Json::object(), Json{{"magFilter", kLinear}}, Json{{"minFilter", kNearest}}})
        EXPECT_NEAR(at(sampler, 0.375), 0.75, 1e-5) << sampler;  // a quarter of the way between the texels' middles
}

TEST_F(ModelValues, PicturesContinueAlongEachAxisAsItsModeSays) {
    // 1 at the left and the top, a half at the right, a quarter below.
    testing::write_exr(folder_ / "four.exr", 2, 2, {1, 1, 1, .5f, .5f, .5f, .25f, .25f, .25f, .125f, .125f, .125f});
    const auto at = [&](int wrap_s, int wrap_t, double u, double v) {
        Square square;
        square.attributes()["TEXCOORD_0"] = square.file.add_floats({u, v, u, v, u, v, u, v}, "VEC2");
        square.pbr()["metallicFactor"] = 1;
        square.pbr()["metallicRoughnessTexture"] = {
            {"index", square.add_picture("four.exr", {{"magFilter", kNearest}, {"wrapS", wrap_s}, {"wrapT", wrap_t}})}};
        return SeenValues(load(square)).number("metallic", 0.5, 0.4);
    };
    const double left = 1, right = 0.5, top = 1, below = 0.25;
    for (const int other : {kRepeat, kMirror, kClamp}) {
        // One and a quarter along s: the left again, the right mirrored, the right continued; then along t.
        EXPECT_EQ(at(kRepeat, other, 1.25, 0.25), left * top) << other;
        EXPECT_EQ(at(kMirror, other, 1.25, 0.25), right * top) << other;
        EXPECT_EQ(at(kClamp, other, 1.25, 0.25), right * top) << other;
        EXPECT_EQ(at(kMirror, other, -0.25, 0.75), left * below) << other;
        EXPECT_EQ(at(kRepeat, other, -0.25, 0.75), right * below) << other;
        EXPECT_EQ(at(other, kRepeat, 0.25, 1.25), left * top) << other;
        EXPECT_EQ(at(other, kMirror, 0.25, 1.25), left * below) << other;
        EXPECT_EQ(at(other, kClamp, 0.75, 9.25), right * below) << other;
        EXPECT_EQ(at(other, kMirror, 0.75, 2.25), right * top) << other;
    }
}

TEST_F(ModelValues, TextureTransformsMoveTurnAndScaleCoordinates) {
    // The numbers of a picture are its places: s + 2 t, t from the top.
    std::vector<float> rgb;
    for (int t = 0; t < 8; ++t) {
        for (int s = 0; s < 8; ++s) rgb.insert(rgb.end(), 3, static_cast<float>((s + 0.5) / 8 / 4 + (t + 0.5) / 8 / 2));
    }
    testing::write_exr(folder_ / "places.exr", 8, 8, rgb);
    struct Case {
        double x, y, angle, sx, sy;
    };
    for (const Case& c : {Case{0, 0, 0, 1, 1},
                          {0.25, 0.125, 0, 0.5, 0.25},
                          {0, 1, std::numbers::pi / 2, 1, 1},
                          {0.5, 0.75, std::numbers::pi / 6, 0.25, 0.5}}) {
        Square square;
        square.pbr()["metallicFactor"] = 1;
        square.pbr()["metallicRoughnessTexture"] = {
            {"index", square.add_picture("places.exr")},
            {"extensions", {{"KHR_texture_transform", {{"offset", {c.x, c.y}}, {"rotation", c.angle}, {"scale", {c.sx, c.sy}}}}}}};
        SeenValues seen(load(square));
        for (const auto& [u, v] : {std::pair(0.3, 0.4), std::pair(0.5, 0.2)}) {
            // Counter-clockwise as it is seen, v downwards; scaled first.
            const double s = std::cos(c.angle) * c.sx * u + std::sin(c.angle) * c.sy * v + c.x,
                         t = -std::sin(c.angle) * c.sx * u + std::cos(c.angle) * c.sy * v + c.y;
            const auto inside = [](double x) {
                return std::clamp(x, 1 / 16.0, 15 / 16.0);
            };  // else it is mixed with the other side
            if (inside(s) != s || inside(t) != t) continue;
            EXPECT_NEAR(seen.number("metallic", u, 1 - v), s / 4 + t / 2, 2e-3) << c.angle << " " << u;
        }
    }
}

TEST_F(ModelValues, EachTextureUsesItsOwnSetOfCoordinates) {
    testing::write_exr(folder_ / "two.exr", 2, 1, {1, 1, 1, 0.5f, 0.5f, 0.5f});
    Square square;
    const std::size_t two = square.add_picture("two.exr", {{"magFilter", kNearest}});
    square.attributes()["TEXCOORD_1"] = square.file.add_floats({1, 1, 0, 1, 0, 0, 1, 0}, "VEC2");  // the other way round
    square.attributes()["TEXCOORD_4"] = square.file.add_floats({0, 0, 0, 1, 1, 1, 1, 0}, "VEC2");  // turned
    square.pbr() = {{"metallicFactor", 1}, {"metallicRoughnessTexture", {{"index", two}, {"texCoord", 1}}}};
    square.material()["extensions"]["KHR_materials_clearcoat"] = {
        {"clearcoatFactor", 1},
        {"clearcoatTexture", {{"index", two}}},
        {"clearcoatRoughnessFactor", 1},
        {"clearcoatRoughnessTexture",
         {{"index", two}, {"texCoord", 1}, {"extensions", {{"KHR_texture_transform", {{"texCoord", 4}}}}}}}};
    SeenValues seen(load(square));
    for (const double x : {0.2, 0.7}) {
        for (const double y : {0.1, 0.8}) {
            EXPECT_EQ(seen.number("coat", x, y), x < 0.5 ? 1 : 0.5);
            EXPECT_EQ(seen.number("metallic", x, y), x < 0.5 ? 0.5 : 1);
            EXPECT_EQ(seen.number("coat_roughness", x, y), y < 0.5 ? 1 : 0.5);
        }
    }
    EXPECT_THAT(warnings_, ::testing::IsEmpty());
}

TEST_F(ModelValues, NormalMapsAreScaledAndFollowMirroredCoordinates) {
    testing::write_exr(folder_ / "n.exr", 1, 1, {0.75f, 0.625f, 1});  // (0.5, 0.25, 1) before it is made a unit
    const auto normal = [&](double scale, bool mirrored) {
        Square square;
        if (mirrored) square.attributes()["TEXCOORD_0"] = square.file.add_floats({1, 1, 0, 1, 0, 0, 1, 0}, "VEC2");
        square.material()["normalTexture"] = {{"index", square.add_picture("n.exr")}, {"scale", scale}};
        return SeenValues(load(square)).normal(0.3, 0.4);
    };
    for (const double scale : {1.0, 0.5, 2.0}) {
        const Vec3f n = Vec3f(normalize(Vec3d(0.5 * scale, 0.25 * scale, 1))), seen = normal(scale, false),
                    mirrored = normal(scale, true);
        EXPECT_NEAR(length(seen - n), 0, 1e-3) << scale;
        EXPECT_NEAR(length(mirrored - Vec3f(-n.x, n.y, n.z)), 0, 1e-3) << scale;
    }
}

// A picture, whose left half is glass and whose right half is metal, as exporters write it: with the default factors of 1.
TEST_F(ModelValues, GlassIsAsRoughAsItsPictureAndMetalIsNone) {
    testing::write_exr(folder_ / "m.exr", 2, 1, {0, 0.5f, 0, 0, 0.75f, 1});
    for (const double factor : {1.0, 0.5}) {
        Square square;
        square.pbr() = {
            {"metallicRoughnessTexture", {{"index", square.add_picture("m.exr", {{"magFilter", 9728}, {"minFilter", 9728}})}}}};
        square.material()["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", factor}}},
                                           {"KHR_materials_volume", {{"thicknessFactor", 1}}}};
        SeenValues seen(load(square));
        EXPECT_EQ(seen.number("amount", 0.2, 0.5), static_cast<float>(factor));
        EXPECT_EQ(seen.number("amount", 0.8, 0.5), 0);
        EXPECT_EQ(seen.number_of_part(0, "metallic", 0.8, 0.5), 1);
        EXPECT_EQ(seen.number_of_part(1, "alpha_x", 0.2, 0.5), 0.25f);
        EXPECT_EQ(seen.number_of_part(1, "alpha_y", 0.2, 0.5), 0.25f);
        EXPECT_THAT(warnings_, ::testing::IsEmpty());
    }
}

// The square, whose normal map holds (0.5, 0.25, 1), placed by nodes of these scales.
struct Uneven : Square {
    Uneven(std::size_t normal_map, std::initializer_list<double> tangents, const Json& scales) {
        attributes()["NORMAL"] = file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
        if (tangents.size() > 0) attributes()["TANGENT"] = file.add_floats(tangents, "VEC4");
        material()["normalTexture"] = {{"index", normal_map}};
        file.json["nodes"] = Json::array();
        file.json["scenes"][0]["nodes"] = Json::array();
        for (const Json& scale : scales) {
            file.json["scenes"][0]["nodes"].push_back(file.json["nodes"].size());
            file.json["nodes"].push_back({{"mesh", 0}, {"scale", scale}});
        }
    }
};

TEST_F(ModelValues, TangentsOrientNormalMapsInsteadOfCoordinates) {
    testing::write_exr(folder_ / "n.exr", 1, 1, {0.75f, 0.625f, 1});
    const auto normal = [&](std::initializer_list<double> tangents, const Json& scales, double x) {
        Uneven square(0, tangents, scales);
        square.add_picture("n.exr");
        return SeenValues(load(square)).normal(x, 0.4);
    };
    const Json plain = {{1, 1, 1}}, mirrored = {{-1, 1, 1}}, both = {{1, 1, 1}, {-1, 1, 1}};
    const auto expect = [](const Vec3f& seen, const Vec3d& direction) {
        EXPECT_NEAR(length(seen - Vec3f(normalize(direction))), 0, 1e-5) << seen.x << " " << seen.y << " " << seen.z;
    };
    expect(normal({0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1}, plain, 0.3), {-0.25, 0.5, 1});
    expect(normal({1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1}, plain, 0.3), {0.5, -0.25, 1});
    // Those that say what the coordinates do change nothing, mirrored and in objects too.
    const std::initializer_list<double> same = {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1};
    const std::tuple<Json, double, Vec3d> cases[] = {{plain, 0.3, {0.5, 0.25, 1}},
                                                     {mirrored, -0.3, {-0.5, 0.25, 1}},
                                                     {both, 0.3, {0.5, 0.25, 1}},
                                                     {both, -0.3, {-0.5, 0.25, 1}}};
    for (const auto& [scales, x, direction] : cases) {
        expect(normal(same, scales, x), direction);
        expect(normal({}, scales, x), direction);
    }
}

// A clear coat has the normals of the shape, or those of its own map, and never those of the surface below it [glTF2
// KHR_materials_clearcoat].
TEST_F(ModelValues, ACoatHasNormalsOfItsOwn) {
    testing::write_exr(folder_ / "n.exr", 1, 1, {0.75f, 0.625f, 1});
    testing::write_exr(folder_ / "c.exr", 1, 1, {0.25f, 0.5f, 1});
    const auto expect = [](const Vec3f& seen, const Vec3d& direction) {
        EXPECT_NEAR(length(seen - Vec3f(normalize(direction))), 0, 1e-5) << seen.x << " " << seen.y << " " << seen.z;
    };
    for (const bool base : {false, true}) {
        for (const bool coat : {false, true}) {
            Uneven square(0, {}, {{1, 1, 1}});
            square.add_picture("n.exr");
            const std::size_t own = square.add_picture("c.exr");
            if (!base) square.material().erase("normalTexture");
            Json& clear = square.material()["extensions"]["KHR_materials_clearcoat"] = {{"clearcoatFactor", 0.5}};
            if (coat) clear["clearcoatNormalTexture"] = {{"index", own}, {"scale", 0.5}};
            SeenValues seen(load(square));
            EXPECT_THAT(warnings_, ::testing::IsEmpty());
            expect(seen.normal(0.3, 0.4), base ? Vec3d(0.5, 0.25, 1) : Vec3d(0, 0, 1));
            expect(seen.coat_normal(0.3, 0.4), coat ? Vec3d(-0.25, 0, 1) : Vec3d(0, 0, 1));
        }
    }
}

// What needs no tangents does not keep them, and without normals they mean nothing.
TEST_F(ModelValues, TangentsAreReadWhereTheyCount) {
    testing::write_exr(folder_ / "n.exr", 1, 1, {0.75f, 0.625f, 1});
    const auto tangents = [&](bool has_normals, bool is_brushed, bool has_map) {
        Uneven square(0, {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, {{1, 1, 1}});
        square.add_picture("n.exr");
        if (!has_normals) square.attributes().erase("NORMAL");
        if (!has_map) square.material().erase("normalTexture");
        if (is_brushed) square.material()["extensions"]["KHR_materials_anisotropy"] = {{"anisotropyStrength", 0.5}};
        return load(square).shapes.at(0).mesh->tangents.size();
    };
    EXPECT_EQ(tangents(true, false, true), 4);
    EXPECT_EQ(tangents(true, true, false), 4);
    EXPECT_EQ(tangents(true, false, false), 0);
    EXPECT_EQ(tangents(false, false, true), 0);
}

}  // namespace
}  // namespace latent::render
