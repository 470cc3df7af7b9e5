// Material "latent:principled" is the material of glTF: the same parameters are the same surface.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <map>

#include "render/scene/canonical.h"
#include "tests/render/models.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::Folder;
using testing::GltfFile;
using ::testing::HasSubstr;
using Json = nlohmann::json;

// A quad of this material: all that it is made of counts, but not how it is seen and lit.
class Principled : public ::testing::Test {
 protected:
    Hash128 of_gltf(const Json& material) const {
        GltfFile file;
        const Json position = file.add_floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3"),
                   indices = file.add_indices({0, 1, 2, 0, 2, 3});
        file.json["meshes"] = {
            {{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}, {"material", 0}}}}}};
        file.json["materials"] = Json::array({material});
        file.json["nodes"] = {{{"mesh", 0}}};
        file.json["scenes"] = {{{"nodes", {0}}}};
        return surface(folder_.write("a.glb", testing::as_glb(file)), {.stage = false});
    }
    Hash128 of_pbrt(const std::string& parameters) const {
        return surface(folder_.write("a.pbrt", "WorldBegin\nMaterial \"latent:principled\" " + parameters +
                                                   "\nShape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  1 1 0  0 1 0 ] "
                                                   "\"integer indices\" [ 0 1 2 0 2 3 ]\n"));
    }
    static Json pbr(const Json& factors, const Json& extensions = Json::object()) {
        return {{"pbrMetallicRoughness", factors}, {"extensions", extensions}};
    }
    Folder folder_;

 private:
    static Hash128 surface(const std::filesystem::path& path, const ModelOptions& options = {}) {
        Result<LoadedScene> scene = load_scene(path, false, color::RgbSpectra::kSmooth, options);
        if (!scene) throw std::runtime_error(scene.error().message);
        EXPECT_THAT(scene->warnings, ::testing::IsEmpty());
        SceneDescription& all = scene->description;
        all.origin = {};
        all.camera = {};
        all.lights.clear();
        for (ShapeDescription& shape : all.shapes) shape.mesh.reset();
        return make_canonical(all);
    }
};

TEST_F(Principled, IsTheMaterialOfGltf) {
    const Json red = {.5, .25, .125, 1};
    EXPECT_EQ(of_gltf(pbr({{"baseColorFactor", red}, {"metallicFactor", 0}, {"roughnessFactor", .5}})),
              of_pbrt(R"("rgb color" [ .5 .25 .125 ])"));
    EXPECT_EQ(
        of_gltf(pbr({{"baseColorFactor", red}, {"metallicFactor", .75}, {"roughnessFactor", .25}},
                    {{"KHR_materials_ior", {{"ior", 1.75}}},
                     {"KHR_materials_specular", {{"specularFactor", .5}, {"specularColorFactor", {1, .5, .25}}}}})),
        of_pbrt(
            R"("rgb color" [ .5 .25 .125 ] "float metallic" .75 "float roughness" .25 "float eta" 1.75 "float specular" .5 "rgb specularcolor" [ 1 .5 .25 ])"));
    EXPECT_EQ(of_gltf(pbr({{"baseColorFactor", red}, {"metallicFactor", 0}, {"roughnessFactor", 1}},
                          {{"KHR_materials_clearcoat", {{"clearcoatFactor", .5}, {"clearcoatRoughnessFactor", .125}}},
                           {"KHR_materials_sheen", {{"sheenColorFactor", {.5, .5, .25}}, {"sheenRoughnessFactor", .75}}}})),
              of_pbrt(R"("rgb color" [ .5 .25 .125 ] "float roughness" 1 "float coat" .5 "float coatroughness" .125)"
                      R"( "rgb sheen" [ .5 .5 .25 ] "float sheenroughness" .75)"));
}

TEST_F(Principled, HasTheFilmAndTheDirectionOfGltf) {
    const Json factors = {{"metallicFactor", .5}, {"roughnessFactor", .5}},
               film = {{"iridescenceFactor", .5}, {"iridescenceIor", 1.5}, {"iridescenceThicknessMaximum", 300}};
    EXPECT_EQ(of_gltf(pbr(factors, {{"KHR_materials_iridescence", film},
                                    {"KHR_materials_anisotropy",
                                     {{"anisotropyStrength", .5}, {"anisotropyRotation", 3.14159265358979323846 / 2}}}})),
              of_pbrt(R"("rgb color" [ 1 1 1 ] "float metallic" .5 "float film" .5 "float filmeta" 1.5 "float filmthickness" 300)"
                      R"( "float anisotropy" .5 "float anisotropyrotation" 90)"));
    EXPECT_EQ(of_gltf(pbr({{"metallicFactor", 0}, {"roughnessFactor", 0}},
                          {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}, {"KHR_materials_iridescence", film}})),
              of_pbrt(R"("rgb color" [ 1 1 1 ] "float roughness" 0 "float transmission" 1 "bool thin" true)"
                      R"( "float film" .5 "float filmeta" 1.5 "float filmthickness" 300)"));
    for (const bool thin : {true, false}) {
        Json extensions = {{"KHR_materials_transmission", {{"transmissionFactor", .5}}},
                           {"KHR_materials_anisotropy", {{"anisotropyStrength", .5}, {"anisotropyRotation", 0}}}};
        if (!thin) extensions["KHR_materials_volume"] = {{"thicknessFactor", 1}};
        EXPECT_EQ(
            of_gltf(pbr({{"metallicFactor", 0}, {"roughnessFactor", .5}}, extensions)),
            of_pbrt(R"("rgb color" [ 1 1 1 ] "float roughness" .5 "float transmission" .5 "float anisotropy" .5 "bool thin" )" +
                    std::string(thin ? "true" : "false")));
    }
}

TEST_F(Principled, PassesLightAsTheMaterialOfGltfDoes) {
    const Json factors = {{"baseColorFactor", {.5, .25, .125, 1}}, {"metallicFactor", .5}, {"roughnessFactor", .5}};
    const Json solid = {{"thicknessFactor", 1}};
    EXPECT_EQ(
        of_gltf(pbr(factors, {{"KHR_materials_transmission", {{"transmissionFactor", .5}}}, {"KHR_materials_volume", solid}})),
        of_pbrt(R"("rgb color" [ .5 .25 .125 ] "float metallic" .5 "float transmission" .5)"));
    EXPECT_EQ(of_gltf(pbr({{"metallicFactor", 0}, {"roughnessFactor", 0}},
                          {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}, {"KHR_materials_ior", {{"ior", 1.25}}}})),
              of_pbrt(R"("rgb color" [ 1 1 1 ] "float roughness" 0 "float transmission" 1 "bool thin" true "float eta" 1.25)"));
    EXPECT_EQ(of_gltf(pbr(factors, {{"KHR_materials_diffuse_transmission",
                                     {{"diffuseTransmissionFactor", .5}, {"diffuseTransmissionColorFactor", {.5, .25, .75}}}}})),
              of_pbrt(R"("rgb color" [ .5 .25 .125 ] "float metallic" .5 "float diffusetransmission" .5)"
                      R"( "rgb diffusetransmissioncolor" [ .5 .25 .75 ])"));
}

// Half metal, and half of the rest glass: of what is not glass, two thirds are metal.
TEST_F(Principled, MetalHasItsShareOfAllPoints) {
    const Result<LoadedScene> scene =
        testing::load_world("Material \"latent:principled\" \"float metallic\" .5 \"float transmission\" .5 Shape \"sphere\"");
    ASSERT_TRUE(scene);
    const auto opaque = std::ranges::find(scene->description.materials, "metallicroughness", &MaterialDescription::type);
    ASSERT_NE(opaque, scene->description.materials.end());
    EXPECT_FLOAT_EQ(opaque->numbers.at("metallic").value, 2.F / 3);
}

// The same colour multiplies what is refracted; white glass has neither.
TEST_F(Principled, TintedGlassReflectsItsColour) {
    for (const auto& [parameters, is_tinted] :
         std::map<std::string, bool>{{R"("rgb color" [ .5 .5 .5 ] "bool tintedreflection" true)", true},
                                     {R"("rgb color" [ .5 .5 .5 ])", false},
                                     {R"("rgb color" [ 1 1 1 ] "bool tintedreflection" true)", false}}) {
        const Result<LoadedScene> scene =
            testing::load_world("Material \"latent:principled\" \"float transmission\" 1 " + parameters + " Shape \"sphere\"");
        ASSERT_TRUE(scene) << scene.error().message;
        const auto glass = std::ranges::find(scene->description.materials, "dielectric", &MaterialDescription::type);
        ASSERT_NE(glass, scene->description.materials.end());
        ASSERT_EQ(glass->spectra.contains("reflectance"), is_tinted) << parameters;
        if (is_tinted) {
            EXPECT_NEAR(glass->spectra.at("reflectance").value(500), .5, 1e-9);
        }
    }
}

TEST_F(Principled, WhatCannotBeIsRefused) {
    const auto refused = [](const std::string& parameters) {
        const std::string texture = "Texture \"t\" \"float\" \"constant\"\n";
        const Result<LoadedScene> scene = testing::load_world(texture + "Material \"latent:principled\" " + parameters);
        return scene ? "" : scene.error().message;
    };
    EXPECT_THAT(refused(R"("float metalic" 1)"), HasSubstr("did you mean metallic, eta?"));
    EXPECT_THAT(refused(R"("float roughness" 2)"), HasSubstr("roughness: 2 is not between 0 and 1"));
    EXPECT_THAT(refused(R"("float transmission" 1 "float diffusetransmission" 1)"), HasSubstr("cannot be combined"));
    EXPECT_THAT(refused(R"("float transmission" 1 "texture metallic" "t")"), HasSubstr("transmission: "));
    EXPECT_THAT(refused(R"("texture transmission" "t" "float metallic" .5)"), HasSubstr("transmission: "));
    EXPECT_THAT(refused(R"("float transmission" 1 "texture roughness" "t")"), HasSubstr("roughness: "));
    EXPECT_EQ(refused(R"("texture transmission" "t" "texture coat" "t" "texture coatroughness" "t" "texture sheenroughness" "t")"),
              "");
}

}  // namespace
}  // namespace latent::render
