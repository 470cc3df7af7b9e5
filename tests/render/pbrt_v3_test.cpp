// Scenes for pbrt-v3: each says what a scene for pbrt-v4 says.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "render/scene/canonical.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using ::testing::ElementsAre;
using testing::Folder;
using ::testing::HasSubstr;

Hash128 hash_of(const std::string& text, const Folder& folder) {
    Result<LoadedScene> scene = load_scene(folder.write("room.pbrt", text));
    if (!scene) throw std::runtime_error(scene.error().message);
    return make_canonical(scene->description);
}

class PbrtV3 : public ::testing::Test {
 protected:
    // Worlds with a lamp; the first begins as a scene for pbrt-v3 does.
    void expect_same(const std::string& v3, const std::string& v4) const {
        SCOPED_TRACE(v3);
        const std::string world = "WorldBegin\nLightSource \"distant\" \"rgb L\" [ 1 1 1 ]\n";
        EXPECT_EQ(hash_of("Film \"image\"\n" + world + v3 + "\nWorldEnd\n", folder_), hash_of(world + v4, folder_));
    }
    // A material, and a ball of it.
    void expect_same_material(const std::string& v3, const std::string& v4) const {
        expect_same("Material " + v3 + " Shape \"sphere\"", "Material " + v4 + " Shape \"sphere\"");
    }
    Folder folder_;
};

TEST_F(PbrtV3, OptionsAreThoseOfV4) {
    const auto same = [&](const std::string& v3, const std::string& v4) {
        EXPECT_EQ(hash_of(v3 + "\nWorldBegin LightSource \"point\" \"color I\" [ 1 1 1 ] Shape \"sphere\" WorldEnd", folder_),
                  hash_of(v4 + "\nWorldBegin LightSource \"point\" \"rgb I\" [ 1 1 1 ] Shape \"sphere\"", folder_))
            << v3;
    };
    same(R"(Film "image" "integer xresolution" 64 "integer yresolution" [32] "float scale" 2 "float maxsampleluminance" 9)",
         R"(Film "rgb" "integer xresolution" 64 "integer yresolution" 32)");
    same(R"(Camera "environment" Film "image")", R"(Camera "spherical" "string mapping" "equirectangular")");
    same(
        R"(LookAt 0 0 5 0 0 0 0 1 0 Camera "perspective" "float fov" 40 Sampler "02sequence" PixelFilter "box" Accelerator "kdtree")",
        R"(LookAt 0 0 5 0 0 0 0 1 0 Camera "perspective" "float fov" 40)");
    same(R"(Integrator "directlighting" "integer maxdepth" 8)", R"(Integrator "path" "integer maxdepth" 8)");
    same(R"(Integrator "whitted")", R"(Integrator "path" "integer maxdepth" 5)");
    same(R"(Integrator "path" "integer maxdepth" 7 "float rrthreshold" 0.5 "string lightsamplestrategy" "spatial")",
         R"(Integrator "path" "integer maxdepth" 7)");
}

TEST_F(PbrtV3, MaterialsAreThoseThatUpgradeWrites) {
    expect_same_material(R"("matte" "color Kd" [ .5 .25 .125 ] "float sigma" 0)", R"("diffuse" "rgb reflectance" [ .5 .25 .125 ])");
    expect_same_material(R"("matte")", R"("diffuse" "rgb reflectance" [ .5 .5 .5 ])");
    expect_same_material(R"("matte" "rgb Kd" [ 1.5 .5 .5 ])", R"("diffuse" "rgb reflectance" [ 1 .5 .5 ])");
    expect_same_material(
        R"("matte" "xyz Kd" [ .47523 .5 .544414 ])",
        fmt::format(R"("diffuse" "rgb reflectance" [ {} {} {} ])", 3.2404542 * .47523 - 1.5371385 * .5 - 0.4985314 * .544414,
                    -0.9692660 * .47523 + 1.8760108 * .5 + 0.0415560 * .544414,
                    0.0556434 * .47523 - 0.2040259 * .5 + 1.0572252 * .544414));
    expect_same_material(R"("plastic" "rgb Kd" [ .5 .1 .1 ] "rgb Ks" [ .3 .3 .3 ] "float roughness" .05)",
                         R"("coateddiffuse" "rgb reflectance" [ .5 .1 .1 ] "float roughness" .05)");
    expect_same_material(R"("plastic")", R"("coateddiffuse" "rgb reflectance" [ .25 .25 .25 ] "float roughness" .1)");
    expect_same_material(R"("plastic" "rgb Kd" [ .5 .1 .1 ] "rgb Ks" [ 0 0 0 ])", R"("diffuse" "rgb reflectance" [ .5 .1 .1 ])");
    expect_same_material(
        R"("uber" "rgb Kd" [ .5 .1 .1 ] "float index" 1.3 "float uroughness" .2 "float vroughness" .3)",
        R"("coateddiffuse" "rgb reflectance" [ .5 .1 .1 ] "float eta" 1.3 "float uroughness" .2 "float vroughness" .3)");
    expect_same("Material \"uber\" \"rgb Kd\" [ .5 .1 .1 ] \"rgb Ks\" [ 0 0 0 ] \"rgb opacity\" [ .25 .25 .25 ] Shape \"sphere\"",
                "Material \"diffuse\" \"rgb reflectance\" [ .5 .1 .1 ] Shape \"sphere\" \"float alpha\" .25");
    expect_same_material(R"("glass" "float index" 1.7)", R"("dielectric" "float eta" 1.7)");
    expect_same_material(
        R"("metal" "rgb eta" [ .2 .9 1.1 ] "rgb k" [ 3 2 2 ] "bool remaproughness" "false")",
        R"("conductor" "rgb eta" [ .2 .9 1.1 ] "rgb k" [ 3 2 2 ] "float roughness" .01 "bool remaproughness" false)");
    expect_same_material(R"("mirror")", R"("conductor" "rgb reflectance" [ .9 .9 .9 ] "float roughness" 0)");
    expect_same_material(R"("substrate" "rgb Kd" [ .1 .2 .3 ] "float uroughness" .05 "float vroughness" .05)",
                         R"("coateddiffuse" "rgb reflectance" [ .1 .2 .3 ] "float uroughness" .05 "float vroughness" .05)");
    expect_same_material(
        R"("translucent" "rgb Kd" [ .5 .5 .25 ] "rgb reflect" [ .25 .25 .25 ] "rgb transmit" [ .75 .5 .5 ] "rgb Ks" [ 0 0 0 ])",
        R"("diffusetransmission" "rgb reflectance" [ .125 .125 .0625 ] "rgb transmittance" [ .375 .25 .125 ])");
    expect_same_material(
        R"("disney" "rgb color" [ .5 .1 .1 ] "float metallic" .5 "float roughness" .25 "float spectrans" 0 "float sheen" .5)",
        R"("latent:principled" "rgb color" [ .5 .1 .1 ] "float metallic" .5 "float roughness" .25 "rgb sheen" [ .5 .5 .5 ])");
    expect_same(
        "MakeNamedMaterial \"a\" \"string type\" \"matte\" MakeNamedMaterial \"b\" \"string type\" \"mirror\" "
        "Material \"mix\" \"string namedmaterial1\" \"a\" \"string namedmaterial2\" \"b\" \"rgb amount\" [ .2 .2 .2 ] Shape "
        "\"sphere\"",
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"rgb "
        "reflectance\" "
        "[ .9 .9 .9 ] Material \"mix\" \"string materials\" [ \"b\" \"a\" ] \"float amount\" .2 Shape \"sphere\"");
}

TEST_F(PbrtV3, LightsShapesAndTexturesAreThoseOfV4) {
    testing::write_exr(folder_ / "t.exr", 2, 2, std::vector<float>(12, 0.5f));
    expect_same("AreaLightSource \"area\" \"color L\" [ 1 2 3 ] \"integer nsamples\" 4 \"color scale\" [ 2 2 2 ] Shape \"sphere\"",
                "AreaLightSource \"diffuse\" \"rgb L\" [ 1 2 3 ] \"float scale\" 2 Shape \"sphere\"");
    expect_same("LightSource \"point\" \"blackbody I\" [ 5000 3 ] \"point from\" [ 1 2 3 ]",
                "LightSource \"point\" \"blackbody I\" 5000 \"float scale\" 3 \"point3 from\" [ 1 2 3 ]");
    expect_same("LightSource \"infinite\" \"string mapname\" \"t.exr\" \"rgb L\" [ 2 2 2 ] \"integer samples\" 8",
                "LightSource \"infinite\" \"string filename\" \"t.exr\" \"float scale\" 2");
    expect_same(
        "Shape \"trianglemesh\" \"point P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 ] \"float uv\" [ 0 0 1 0 0 1 ]",
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"point2 uv\" [ 0 0 1 0 0 1 ]");
    expect_same("Shape \"loopsubdiv\" \"integer nlevels\" 1 \"point P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 ]",
                "Shape \"loopsubdiv\" \"integer levels\" 1 \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 ]");
    expect_same(
        "Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"t.exr\" \"bool trilinear\" \"true\" \"float gamma\" 1.5 "
        "Texture \"s\" \"color\" \"scale\" \"texture tex1\" \"t\" \"rgb tex2\" [ .5 .5 .5 ] "
        "Material \"matte\" \"texture Kd\" \"s\" Shape \"sphere\"",
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.exr\" \"string filter\" \"trilinear\" \"string encoding\" "
        "\"gamma 1.5\" Texture \"s\" \"spectrum\" \"scale\" \"texture tex\" \"t\" \"float scale\" .5 "
        "Material \"diffuse\" \"texture reflectance\" \"s\" Shape \"sphere\"");
    // Names may be given again; what was made before keeps its own.
    expect_same(
        "Texture \"t\" \"float\" \"constant\" \"float value\" .25 Texture \"t\" \"float\" \"scale\" \"texture tex1\" \"t\" \"float "
        "tex2\" 2 "
        "MakeNamedMaterial \"m\" \"string type\" \"matte\" NamedMaterial \"m\" Shape \"sphere\" "
        "MakeNamedMaterial \"m\" \"string type\" \"plastic\" \"texture roughness\" \"t\" NamedMaterial \"m\" Shape \"disk\"",
        "Texture \"t\" \"float\" \"constant\" \"float value\" .25 Texture \"u\" \"float\" \"scale\" \"texture tex\" \"t\" \"float "
        "scale\" 2 "
        "MakeNamedMaterial \"m\" \"string type\" \"diffuse\" NamedMaterial \"m\" Shape \"sphere\" "
        "MakeNamedMaterial \"n\" \"string type\" \"coateddiffuse\" \"rgb reflectance\" [ .25 .25 .25 ] \"texture roughness\" \"u\" "
        "NamedMaterial \"n\" Shape \"disk\"");
}

// Cone, paraboloid and hyperboloid lie on their surfaces, and face along dp/du x dp/dv.
TEST_F(PbrtV3, OnlyTheTransformationEndsWithTransformEnd) {
    expect_same(
        "Translate 0 0 1 TransformBegin Scale 2 2 2 TransformBegin Rotate 90 1 0 0 Material \"matte\" \"rgb Kd\" [ .5 .1 .1 ] "
        "TransformEnd Shape \"sphere\" TransformEnd Shape \"sphere\"",
        "Translate 0 0 1 Material \"diffuse\" \"rgb reflectance\" [ .5 .1 .1 ] AttributeBegin Scale 2 2 2 Shape \"sphere\" "
        "AttributeEnd Shape \"sphere\"");
    EXPECT_THAT(load_scene(folder_.write("end.pbrt", "Film \"image\"\nWorldBegin\nTransformEnd\n")).error().message,
                HasSubstr("TransformEnd"));
}

TEST_F(PbrtV3, ColouredNoiseIsAMixtureOfBlackAndWhite) {
    for (const char* noise : {"fbm", "wrinkled", "windy"}) {
        const std::string octaves = std::string(noise) == "windy" ? "" : " \"integer octaves\" 5";
        expect_same(
            fmt::format("Texture \"n\" \"color\" \"{}\"{} Material \"matte\" \"texture Kd\" \"n\" Shape \"sphere\"", noise,
                        octaves),
            fmt::format("Texture \"n\" \"float\" \"{}\"{} Texture \"n\" \"spectrum\" \"mix\" \"rgb tex1\" [ 0 0 0 ] \"rgb "
                        "tex2\" [ 1 1 1 ] \"texture amount\" \"n\" Material \"diffuse\" \"texture reflectance\" \"n\" Shape "
                        "\"sphere\"",
                        noise, octaves));
    }
}

TEST_F(PbrtV3, QuadricsThatV4LacksAreMeshes) {
    const auto mesh = [&](const std::string& shape) {
        const Result<LoadedScene> scene = load_scene(
            folder_.write("room.pbrt", "Film \"image\"\nWorldBegin\nLightSource \"distant\"\nShape " + shape + "\nWorldEnd"));
        if (!scene) throw std::runtime_error(scene.error().message);
        return *testing::in_world(scene->description).shapes.at(0).mesh;
    };
    const auto check = [&](const std::string& shape, const auto& off, const auto& gradient) {
        SCOPED_TRACE(shape);
        const MeshDescription m = mesh(shape);
        ASSERT_GT(m.positions.size(), 4000u);
        for (std::size_t i = 0; i < m.positions.size(); ++i) {
            const Vec3d p(m.positions[i]);
            ASSERT_NEAR(off(p), 0, 1e-5);
            if (p.x * p.x + p.y * p.y < 0.01) continue;
            const Vec3d g = gradient(p);
            ASSERT_GT(dot(Vec3d(m.normals[i]), g / length(g)), 0.999);
        }
    };
    check(
        "\"cone\" \"float radius\" 2 \"float height\" 3", [](const Vec3d& p) { return std::hypot(p.x, p.y) - 2 * (1 - p.z / 3); },
        [](const Vec3d& p) { return Vec3d(p.x / std::hypot(p.x, p.y), p.y / std::hypot(p.x, p.y), 2.0 / 3); });
    // Outwards and down.
    check(
        "\"paraboloid\" \"float radius\" 2 \"float zmin\" 0.5 \"float zmax\" 2 \"float phimax\" 90",
        [](const Vec3d& p) { return p.x * p.x + p.y * p.y - 2 * p.z; }, [](const Vec3d& p) { return Vec3d(p.x, p.y, -1); });
    // x^2 + y^2 = z^2 + 1 of the line from (1, -1, -1) to (1, 1, 1).
    check(
        "\"hyperboloid\" \"point p1\" [ 1 -1 -1 ] \"point p2\" [ 1 1 1 ]",
        [](const Vec3d& p) { return p.x * p.x + p.y * p.y - p.z * p.z - 1; }, [](const Vec3d& p) { return Vec3d(p.x, p.y, -p.z); });
}

// Also where the first word of pbrt-v3 comes late, or in another file.
TEST_F(PbrtV3, IsRecognisedByAnyOfItsWords) {
    const std::string rest = "LightSource \"distant\"\nShape \"sphere\"\nWorldEnd";
    for (const std::string line : {"Film \"image\"\nWorldBegin\n", "WorldBegin\nMaterial \"matte\"\n",
                                   "WorldBegin\nMaterial \"diffuse\" \"color reflectance\" [ 1 0 0 ]\n",
                                   "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"plastic\"\n",
                                   "WorldBegin\nTexture \"t\" \"color\" \"constant\"\n", "WorldBegin\nInclude \"part.pbrt\"\n"}) {
        folder_.write("part.pbrt", "Shape \"disk\" \"point unused\" [ 0 0 0 ]\nMaterial \"mirror\"");
        const Result<LoadedScene> scene = load_scene(folder_.write("room.pbrt", line + rest));
        if (line.find("part") != line.npos) {
            ASSERT_FALSE(scene);
            EXPECT_THAT(scene.error().message, HasSubstr("part.pbrt:1:14: \"point3 unused\" of Shape \"disk\" is not supported"));
        } else {
            ASSERT_TRUE(scene) << scene.error().message;
            EXPECT_THAT(scene->notes, ::testing::Contains(HasSubstr("room.pbrt: is a scene for pbrt-v3")));
        }
    }
}

TEST_F(PbrtV3, WhatItLosesIsSaid) {
    const auto warnings = [](const std::string& world) {
        const Result<LoadedScene> scene =
            testing::load("Film \"image\"\nWorldBegin\nLightSource \"distant\"\n" + world + "\nShape \"sphere\"");
        EXPECT_TRUE(scene) << scene.error().message;
        return scene ? scene->warnings : std::vector<std::string>();
    };
    EXPECT_THAT(warnings("Material \"matte\" \"float sigma\" 20"),
                ElementsAre(HasSubstr("room.pbrt:4:18: sigma: ignored: the surface is Lambert's")));
    EXPECT_THAT(warnings("Material \"uber\" \"rgb Kr\" [ .5 .5 .5 ] \"rgb Ks\" [ 1 1 1 ]"), ElementsAre(HasSubstr("Kr: ignored")));
    for (const std::string type : {"plastic", "uber", "substrate"}) {
        const std::string material = "Material \"" + type + "\"", message = "room.pbrt:4:1: " + type + ": Ks does not count: ";
        EXPECT_THAT(warnings(material), ElementsAre(HasSubstr(message)));
        EXPECT_THAT(warnings(material + " \"rgb Ks\" [ .1 .1 .1 ]"), ElementsAre(HasSubstr(message)));
        EXPECT_EQ(warnings(material + " \"rgb Ks\" [ 1 1 1 ]").size(), type == "substrate" ? 1u : 0u) << type;
        EXPECT_THAT(warnings(material + " \"rgb Ks\" [ 0 0 0 ]"), ::testing::IsEmpty());
    }
    const Result<LoadedScene> old =
        testing::load("Integrator \"directlighting\"\nWorldBegin\nMaterial \"matte\"\nShape \"sphere\"");
    ASSERT_TRUE(old) << old.error().message;
    EXPECT_THAT(old->warnings, ::testing::Contains(HasSubstr("Integrator \"directlighting\" is replaced by \"path\": ")));
    EXPECT_THAT(warnings("Material \"glass\" \"rgb Kt\" [ 1 .5 .5 ]"), ElementsAre(HasSubstr("Kt: ignored")));
    EXPECT_THAT(warnings("LightSource \"point\" \"rgb scale\" [ 1 2 3 ]"), ElementsAre(HasSubstr("scale: its mean counts")));
    EXPECT_THAT(testing::refusal("Film \"image\"\nWorldBegin\nMaterial \"fourier\""),
                HasSubstr("room.pbrt:3:1: Material \"fourier\" is not supported"));
    EXPECT_THAT(testing::refusal("Film \"image\"\nWorldBegin\nShape \"nurbs\""), HasSubstr("Shape \"nurbs\" is not supported"));
    EXPECT_THAT(testing::refusal("Film \"image\"\nWorldBegin\nTexture \"t\" \"color\" \"constant\" Texture \"u\" \"color\" "
                                 "\"scale\" \"texture tex1\" \"t\" \"rgb tex2\" [ 0 1 0 ]"),
                HasSubstr("room.pbrt:3:32: Texture \"scale\": a texture times a colour is not supported"));
}

TEST_F(PbrtV3, ScenesOfV2AreRefusedWithThatWord) {
    for (const char* line :
         {"SurfaceIntegrator \"path\"", "Film \"image\"\nRenderer \"sampler\"", "WorldBegin\nVolume \"homogeneous\""}) {
        const std::string message = testing::refusal(line);
        EXPECT_THAT(message, HasSubstr("room.pbrt: is a scene for pbrt-v2, which is not supported")) << line;
        EXPECT_THAT(message, HasSubstr("is a directive of pbrt-v2")) << line;
    }
}

}  // namespace
}  // namespace latent::render
