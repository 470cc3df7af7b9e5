// Extensions of glTF: what they say is what the same model without them says, or a closed form.
#include <gmock/gmock.h>

#include <numbers>

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

GltfFile triangle(const Json& material = Json::object()) {
    GltfFile file;
    const Json position = file.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"), uv = file.add_floats({0, 0, 1, 0, 0, 1}, "VEC2");
    file.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}}}, {"material", 0}}}}}};
    file.json["materials"] = Json::array({material});
    file.json["nodes"] = {{{"mesh", 0}}};
    file.json["scenes"] = {{{"nodes", {0}}}};
    return file;
}

class GltfExtensions : public ::testing::Test {
 protected:
    Result<LoadedScene> load(const GltfFile& file, ModelOptions options = {}) const {
        options.stage = false;
        return load_scene(folder_.write("a.glb", as_glb(file)), false, color::RgbSpectra::kSmooth, options);
    }
    SceneDescription described(const GltfFile& file, const ModelOptions& options = {}) const {
        const Result<LoadedScene> scene = load(file, options);
        if (!scene) throw std::runtime_error(scene.error().message);
        EXPECT_THAT(scene->warnings, ::testing::IsEmpty());
        return scene->description;
    }
    Hash128 hash(const GltfFile& file, const ModelOptions& options = {}) const { return content_hash(described(file, options)); }
    static const MaterialDescription& material(const SceneDescription& scene) {
        return scene.materials.at(scene.shapes.at(0).material);
    }
    Folder folder_;
};

TEST_F(GltfExtensions, SpecularGlossinessIsWhatItsRoughAndMetallicTwinIs) {
    const auto glossy = [&](const Json& factors) {
        return hash(triangle({{"extensions", {{"KHR_materials_pbrSpecularGlossiness", factors}}}}));
    };
    const auto rough = [&](const Json& pbr, const Json& specular) {
        Json material = {{"pbrMetallicRoughness", pbr}};
        if (!specular.is_null()) material["extensions"]["KHR_materials_specular"] = specular;
        SceneDescription scene = described(triangle(material));
        return scene;
    };
    // A reflectance of 0.04 at normal incidence is that of index 1.5.
    const SceneDescription body =
        rough({{"baseColorFactor", {.5, .25, .125, 1}}, {"metallicFactor", 0}, {"roughnessFactor", .25}}, {});
    SceneDescription same = described(
        triangle({{"extensions",
                   {{"KHR_materials_pbrSpecularGlossiness",
                     {{"diffuseFactor", {.5, .25, .125, 1}}, {"specularFactor", {.04, .04, .04}}, {"glossinessFactor", .75}}}}}}));
    const MaterialDescription &a = material(body), &b = material(same);
    EXPECT_EQ(a.spectra.at("base_color").value(600), b.spectra.at("base_color").value(600));
    for (const char* name : {"roughness", "metallic", "coat"}) EXPECT_EQ(a.number(name).value, b.number(name).value) << name;
    EXPECT_FLOAT_EQ(a.number("f0").value, b.number("f0").value);
    EXPECT_EQ(a.number("f90", 1).value, b.number("f90", 1).value);
    // Without a body it is a metal of that colour.
    const MaterialDescription metal = material(described(triangle(
        {{"extensions",
          {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0, 0, 0, 1}}, {"specularFactor", {.9, .6, .3}}}}}}})));
    EXPECT_EQ(metal.number("metallic").value, 1);
    EXPECT_EQ(metal.number("roughness").value, 0);
    EXPECT_GT(metal.spectra.at("base_color").value(650), metal.spectra.at("base_color").value(450));
    EXPECT_NE(glossy({{"glossinessFactor", .25}}), glossy({{"glossinessFactor", .5}}));
    // Nor has it one where all light is reflected.
    EXPECT_EQ(glossy({{"diffuseFactor", {.5, .25, .125, 1}}, {"specularFactor", {1, 1, 1}}}),
              glossy({{"diffuseFactor", {0, 0, 0, 1}}, {"specularFactor", {1, 1, 1}}}));
}

// Of each of R, G and B by itself.
TEST_F(GltfExtensions, ASpecularColourReflectsNoMoreThanThereIs) {
    const auto of = [&](const Json& color) {
        return hash(triangle({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                              {"extensions", {{"KHR_materials_specular", {{"specularColorFactor", color}}}}}}));
    };
    EXPECT_EQ(of({10, 30, 1}), of({10, 25, 1}));
    EXPECT_NE(of({10, 30, 1}), of({10, 20, 1}));
}

TEST_F(GltfExtensions, DispersionHasTheIndexAndTheAbbeNumberThatItSays) {
    const auto eta = [&](double dispersion, double thickness) {
        const SceneDescription scene =
            described(triangle({{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
                                {"extensions",
                                 {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                  {"KHR_materials_ior", {{"ior", 1.7}}},
                                  {"KHR_materials_volume", {{"thicknessFactor", thickness}}},
                                  {"KHR_materials_dispersion", {{"dispersion", dispersion}}}}}}));
        return material(scene).spectra.at("eta").value;
    };
    constexpr double kF = 486.1327, kD = 587.5618, kC = 656.2725;
    for (const double abbe : {20.0, 36.0, 64.0}) {
        const color::Spectrum n = eta(20 / abbe, 1);
        EXPECT_NEAR(n(kD), 1.7, 1e-4);
        EXPECT_NEAR((n(kD) - 1) / (n(kF) - n(kC)), abbe, abbe * 2e-3);  // spectra are tables of whole nm
    }
    EXPECT_EQ(eta(0, 1)(450), 1.7);
    EXPECT_EQ(eta(1, 0)(450), 1.7);  // a pane
}

TEST_F(GltfExtensions, TransmissionIsAShareOfTheSurface) {
    testing::write_exr(folder_ / "t.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    const auto scene = [&](double factor, bool has_picture, double roughness = 0) {
        GltfFile file = triangle({{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", roughness}}},
                                  {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", factor}}}}}});
        file.json["images"] = {{{"uri", "t.exr"}}};
        file.json["textures"] = {{{"source", 0}}};
        if (has_picture)
            file.json["materials"][0]["extensions"]["KHR_materials_transmission"]["transmissionTexture"] = {{"index", 0}};
        return described(file);
    };
    EXPECT_EQ(material(scene(0, true)).type, "metallicroughness");
    EXPECT_EQ(material(scene(1, false)).type, "thindielectric");
    EXPECT_EQ(material(scene(1, false, 0.5)).number("alpha_x").value, 0.25f);
    EXPECT_EQ(material(scene(1, false, 0.5)).number("alpha_y").value, 0.25f);
    const SceneDescription part = scene(0.25, false);
    ASSERT_EQ(material(part).type, "mix");
    EXPECT_EQ(material(part).number("amount").value, 0.25f);
    EXPECT_EQ(part.materials.at(material(part).mixed[0]).type, "metallicroughness");
    EXPECT_EQ(part.materials.at(material(part).mixed[1]).type, "thindielectric");
    const SceneDescription picture = scene(1, true);
    ASSERT_EQ(material(picture).type, "mix");
    const TextureDescription& share = picture.textures.at(material(picture).number("amount").texture);
    EXPECT_EQ(share.picture.channel, 0);
    EXPECT_FALSE(share.picture.is_srgb);
}

TEST_F(GltfExtensions, DiffuseTransmissionIsAShareOfTheSurface) {
    const SceneDescription leaf =
        described(triangle({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                            {"extensions",
                             {{"KHR_materials_diffuse_transmission",
                               {{"diffuseTransmissionFactor", .25}, {"diffuseTransmissionColorFactor", {.5, .5, .5}}}}}}}));
    ASSERT_EQ(material(leaf).type, "mix");
    EXPECT_EQ(material(leaf).number("amount").value, 0.25f);
    const MaterialDescription& passed = leaf.materials.at(material(leaf).mixed[1]);
    EXPECT_EQ(passed.type, "diffusetransmission");
    EXPECT_NEAR(passed.spectra.at("transmittance").value(500), 0.5, 1e-9);
}

// What a film and brushed facets reflect: tests/transport/thin_film_test.cpp.
TEST_F(GltfExtensions, IridescenceAndAnisotropyBecomeInputs) {
    testing::write_exr(folder_ / "t.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    const auto scene = [&](const Json& iridescence, const Json& anisotropy, const Json& transmission) {
        GltfFile file = triangle({{"extensions", Json::object()}});
        Json& extensions = file.json["materials"][0]["extensions"];
        extensions["KHR_materials_iridescence"] = iridescence;
        extensions["KHR_materials_anisotropy"] = anisotropy;
        extensions["KHR_materials_transmission"] = transmission;
        file.json["materials"][0]["pbrMetallicRoughness"] = {{"metallicFactor", 0}, {"roughnessFactor", 0}};
        file.json["images"] = {{{"uri", "t.exr"}}};
        file.json["textures"] = {{{"source", 0}}};
        return described(file);
    };
    const Json none = Json::object(), picture = {{"index", 0}};
    const SceneDescription plain = scene(none, none, none);
    EXPECT_FALSE(material(plain).numbers.contains("film"));
    EXPECT_FALSE(material(plain).numbers.contains("anisotropy"));
    const SceneDescription numbers = scene({{"iridescenceFactor", .5}, {"iridescenceIor", 2}, {"iridescenceThicknessMaximum", 700}},
                                           {{"anisotropyStrength", .75}, {"anisotropyRotation", std::numbers::pi / 2}}, none);
    const auto number = [&](const char* name) { return material(numbers).number(name).value; };
    EXPECT_EQ(number("film"), .5f);
    EXPECT_EQ(number("film_eta"), 2);
    EXPECT_EQ(number("film_thickness"), 700);
    EXPECT_EQ(number("anisotropy"), .75f);
    EXPECT_EQ(number("anisotropy_turns"), .25f);
    // Pictures: the film's share is red, its thickness from 100 to 500 nm green; facets: x red, y green, strength blue.
    const SceneDescription pictures = scene({{"iridescenceFactor", 1},
                                             {"iridescenceTexture", picture},
                                             {"iridescenceThicknessMaximum", 500},
                                             {"iridescenceThicknessTexture", picture}},
                                            {{"anisotropyStrength", 1}, {"anisotropyTexture", picture}}, none);
    const auto texture = [&](const char* name) { return pictures.textures.at(material(pictures).number(name).texture); };
    EXPECT_EQ(texture("film").picture.channel, 0);
    EXPECT_EQ(texture("film_thickness").kind, TextureKind::kMix);
    EXPECT_EQ(texture("film_thickness").numbers[0].value, 100);
    EXPECT_EQ(texture("film_thickness").numbers[1].value, 500);
    EXPECT_EQ(pictures.textures.at(texture("film_thickness").amount.texture).picture.channel, 1);
    EXPECT_EQ(texture("anisotropy").picture.channel, 2);
    EXPECT_EQ(texture("anisotropy_x").picture.channel, 0);
    EXPECT_EQ(texture("anisotropy_y").picture.channel, 1);
    // The wall of a soap bubble.
    const SceneDescription bubble = scene({{"iridescenceFactor", 1}}, none, {{"transmissionFactor", 1}});
    EXPECT_EQ(material(bubble).type, "thindielectric");
    EXPECT_EQ(material(bubble).number("film").value, 1);
    EXPECT_EQ(material(bubble).number("film_thickness").value, 400);
}

TEST_F(GltfExtensions, InstancesAreNodes) {
    const double half = std::sqrt(0.5);
    GltfFile nodes = triangle();
    nodes.json["nodes"] = {{{"mesh", 0}, {"translation", {1, 2, 3}}, {"rotation", {0, 0, half, half}}, {"scale", {2, 1, 1}}},
                           {{"mesh", 0}, {"translation", {-1, 0, 0}}}};
    nodes.json["scenes"] = {{{"nodes", {0, 1}}}};
    GltfFile instances = triangle();
    const Json t = instances.add_floats({1, 2, 3, -1, 0, 0}, "VEC3"),
               r = instances.add_floats({0, 0, half, half, 0, 0, 0, 1}, "VEC4"),
               s = instances.add_floats({2, 1, 1, 1, 1, 1}, "VEC3");
    Json& attributes = instances.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes = {{"TRANSLATION", t}, {"ROTATION", r}, {"SCALE", s}};
    instances.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    const SceneDescription a = described(nodes), b = described(instances);
    ASSERT_EQ(b.instances.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const Affined &x = a.instances[i].world_from_object, &y = b.instances[i].world_from_object;
        EXPECT_LT(max_abs(x.x - y.x) + max_abs(x.y - y.y) + max_abs(x.z - y.z) + max_abs(x.t - y.t), 1e-6);
    }
    attributes["SCALE"] = instances.add_floats({2, 1, 1}, "VEC3");
    EXPECT_THAT(load(instances).error().message, HasSubstr("/SCALE: has 1 items, and others have 2"));
}

TEST_F(GltfExtensions, AVariantIsTheModelWithItsMaterials) {
    GltfFile file = triangle({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}});
    const Hash128 red = hash(file);
    GltfFile other = triangle({{"pbrMetallicRoughness", {{"baseColorFactor", {0, 1, 0, 1}}}}});
    const Hash128 green = hash(other);
    file.json["materials"].push_back(other.json["materials"][0]);
    file.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "spring"}}, {{"name", "winter"}}};
    file.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = {
        {{"material", 1}, {"variants", {0}}}};
    EXPECT_EQ(hash(file), red);
    EXPECT_EQ(hash(file, {.variant = "spring"}), green);
    EXPECT_EQ(hash(file, {.variant = "winter"}), red);
    EXPECT_THAT(load(file, {.variant = "summer"}).error().message,
                AllOf(HasSubstr("--variant summer: "), HasSubstr("has no variant of this name (spring, winter)")));
}

TEST_F(GltfExtensions, AWebpPictureGoesBeforeTheOneForOtherReaders) {
    testing::write_exr(folder_ / "a.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    testing::write_exr(folder_ / "b.exr", 1, 1, {0.25f, 0.25f, 0.125f});
    const auto picture = [&](const Json& texture) {
        GltfFile file = triangle({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
        file.json["images"] = {{{"uri", "a.exr"}}, {{"uri", "b.exr"}}};
        file.json["textures"] = Json::array({texture});
        return hash(file);
    };
    EXPECT_EQ(picture({{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}), picture({{"source", 1}}));
    EXPECT_EQ(picture({{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}), picture({{"source", 1}}));
}

TEST_F(GltfExtensions, ASpecularTextureScalesTheMirrorOfADielectric) {
    folder_.write("a.tga", testing::tga({128}));
    GltfFile file =
        triangle({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                  {"extensions", {{"KHR_materials_specular", {{"specularFactor", .5}, {"specularTexture", {{"index", 0}}}}}}}});
    file.json["images"] = {{{"uri", "a.tga"}}};
    file.json["textures"] = {{{"source", 0}}};
    const SceneDescription scene = described(file);
    const TextureDescription &f0 = scene.textures.at(material(scene).number("f0").texture),
                             &f90 = scene.textures.at(material(scene).number("f90").texture);
    EXPECT_NEAR(f0.tint[3], 0.02, 1e-12);
    EXPECT_EQ(f90.tint[3], 0.5);
    EXPECT_EQ(f0.picture.channel, 3);
}

}  // namespace
}  // namespace latent::render
