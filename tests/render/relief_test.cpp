// Relief, mixtures, and what surfaces with textures look like to both integrators.
#include "render/material/relief.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <map>
#include <string>
#include <vector>

#include "color/named_spectra.h"
#include "render/material/material.h"
#include "tests/render/rays.h"
#include "tests/render/scenes.h"
#include "tests/transport/picture_mean.h"

namespace latent::render {
namespace {

using testing::first_hit;
using testing::Folder;
using ::testing::HasSubstr;
using testing::load_world;
using testing::refused_world;

constexpr const char* kPlane =
    "Shape \"trianglemesh\" \"point3 P\" [0 0 0 4 0 0 4 4 0 0 4 0] \"integer indices\" [0 1 2 0 2 3] \"point2 uv\" [0 0 1 0 1 1 0 "
    "1]\n";

// The shading normal of the scene's surface where a ray along z meets it.
Vec3f normal_at(const testing::Scene& scene, float x, float y) {
    SpectrumLibrary library;
    const Textures textures = Textures::build(scene.description, 1 << 20, library).value();
    const Vec3f origin = Vec3f(Vec3d(x, y, -5) - scene.description.origin);
    const std::unique_ptr<World> world = scene.world();
    std::optional<SurfaceHit> hit = first_hit(world->geometry(), {origin, {0, 0, 1}});
    EXPECT_TRUE(hit);
    const Relief relief = Relief::of_surface(scene.description.materials[hit->material], textures);
    const SurfaceCoordinates c = world->geometry().coordinates(*hit);
    TexturePoint point{};
    point.p = hit->p;
    point.n = hit->ns;
    point.uv = c.uv;
    relief.tilt(point, c, *hit);
    EXPECT_NEAR(length(hit->ns), 1, 1e-5);
    EXPECT_GT(dot(hit->ns, hit->ng), 0);
    return hit->ns * (hit->ns.z < 0 ? -1.0f : 1.0f);
}

TEST(Relief, ARampTiltsTheNormalByItsSlope) {
    // u runs 4 units along x: a displacement of u rises by 1/4.
    for (const char* flip : {"", "ReverseOrientation\n"}) {
        const testing::Scene scene = testing::scene_of(load_world(
            std::string("Texture \"h\" \"float\" \"bilerp\" \"float v10\" 1 \"float v01\" 0\nLightSource \"infinite\"\n") + flip +
            "Material \"diffuse\" \"texture displacement\" \"h\"\n" + kPlane));
        const Vec3f n = normal_at(scene, 1.3f, 2.1f);
        EXPECT_NEAR(n.x / n.z, -0.25f * (*flip ? -1 : 1), 1e-3)
            << flip;  // along the normal that points down, it is a valley's side
        EXPECT_NEAR(n.y, 0, 1e-4);
    }
}

TEST(Relief, ASphereBlownUpEvenlyKeepsItsNormals) {
    const testing::Scene scene = testing::scene_of(load_world(
        "Texture \"h\" \"float\" \"constant\" \"float value\" .5\nLightSource \"infinite\"\nMaterial \"diffuse\" \"texture "
        "displacement\" \"h\"\nShape \"sphere\" \"float radius\" 2\n"));
    const Vec3f n = normal_at(scene, 0.7f, 0.9f), expected = Vec3f(0.7f, 0.9f, -std::sqrt(4 - 0.49f - 0.81f)) / 2;
    EXPECT_NEAR(abs_dot(n, expected), 1, 1e-4);
}

TEST(Relief, ANormalMapGivesNormalsInTheFrameOfUv) {
    const Folder folder;
    folder.write("n.ppm", std::string("P6\n1 1\n255\n") + "\xcc\x80\xe6");  // (0.6, 0, 0.8), to 8 bits
    const testing::Scene scene = testing::scene_of(load_scene(folder.write(
        "room.pbrt",
        std::string("WorldBegin\nLightSource \"infinite\"\nMaterial \"diffuse\" \"string normalmap\" \"n.ppm\"\n") + kPlane)));
    const Vec3f n = normal_at(scene, 1.3f, 2.1f);
    EXPECT_NEAR(n.x, 0.6f, 0.01f);
    EXPECT_NEAR(n.y, 0, 0.01f);
    EXPECT_NEAR(n.z, 0.8f, 0.01f);
}

// A closed room, its lamp out of sight, whose walls are uneven: whatever leaves a wall comes from its shading normal's cosine, so
// the light subpaths' correction counts for much here.
std::string room(const std::string& material) {
    return "LookAt 0 0 -2.5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 50\nWorldBegin\n"
           "AttributeBegin\nTranslate 0 2.2 0\nAreaLightSource \"diffuse\" \"rgb L\" [20 20 20]\nMaterial \"diffuse\" \"rgb "
           "reflectance\" [.1 .1 .1]\nShape \"sphere\" \"float radius\" .3\nAttributeEnd\n" +
           material +
           "AttributeBegin\nReverseOrientation\nShape \"sphere\" \"float radius\" 3\nAttributeEnd\n"
           "Translate 0 -.6 .2\nShape \"sphere\" \"float radius\" .7\n";
}

// `path` and `bdpt` to 4 standard errors, in X, Y and Z.
void expect_agreement(const testing::Scene& scene) {
    const testing::Mean path = testing::mean_of_picture(scene, {.kind = IntegratorKind::kPath, .max_depth = 5, .seed = 1}, 60000);
    const testing::Mean bdpt = testing::mean_of_picture(
        scene, {.kind = IntegratorKind::kBdpt, .connections = Connections::kAll, .max_depth = 5, .seed = 2}, 30000);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(path.xyz[c], bdpt.xyz[c], 4 * std::hypot(path.error[c], bdpt.error[c])) << c;
        EXPECT_LT(bdpt.error[c], 0.02 * bdpt.xyz[c]);
    }
}

TEST(TexturedRooms, PathAndBdptAgreeOnReliefTexturesAndMixtures) {
    const Folder folder;
    std::string picture = "P6\n16 16\n255\n";
    for (int i = 0; i < 3 * 256; ++i) picture += static_cast<char>((i * 37) % 200 + 30);
    folder.write("p.ppm", picture);
    const auto scene = [&](const std::string& material) {
        return testing::scene_of(load_scene(folder.write("room.pbrt", room(material))));
    };
    expect_agreement(
        scene("Texture \"p\" \"spectrum\" \"imagemap\" \"string filename\" \"p.ppm\" \"float uscale\" 4\n"
              "Material \"diffuse\" \"texture reflectance\" \"p\"\n"));
    expect_agreement(scene(
        "Scale .2 .2 .2\nTexture \"h\" \"float\" \"fbm\"\nScale 5 5 5\nTexture \"k\" \"float\" \"scale\" \"texture tex\" \"h\" "
        "\"float scale\" .2\n"
        "Material \"diffuse\" \"rgb reflectance\" [.8 .6 .4] \"texture displacement\" \"k\"\n"));
    expect_agreement(
        scene("Texture \"c\" \"float\" \"checkerboard\" \"float uscale\" 8 \"float vscale\" 8 \"float tex1\" .3 \"float tex2\" .7\n"
              "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [.8 .2 .2]\n"
              "MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"texture roughness\" \"c\"\n"
              "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"texture amount\" \"c\"\n"));
    // A coat keeps the normal of the shape.
    expect_agreement(
        scene("Material \"latent:principled\" \"rgb color\" [.8 .6 .4] \"float roughness\" .6 \"float coat\" 1 "
              "\"float coatroughness\" .5 \"string normalmap\" \"p.ppm\"\n"));
}

TEST(Mixture, ChoosesInTheSharesThatItSays) {
    const testing::Scene scene = testing::scene_of(load_world(
        std::string("MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"b\" \"string type\" \"phong\"\n"
                    "LightSource \"infinite\"\nMaterial \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .3\n") +
        kPlane));
    SpectrumLibrary library;
    const Textures textures = Textures::build(scene.description, 1 << 20, library).value();
    const Material mixture(scene.description.materials[scene.description.shapes[0].material], textures, library);
    ASSERT_TRUE(mixture.is_mixture());
    int second = 0;
    for (int i = 0; i < 10000; ++i) {
        TexturePoint point{};
        point.p = {static_cast<float>(i) * 1e-3f, 0.3f, 0};
        const SampledSpectrum* weight = nullptr;
        const std::uint32_t chosen = mixture.chosen(point, 0, weight);
        EXPECT_EQ(mixture.chosen(point, 0, weight), chosen);
        EXPECT_EQ(weight, nullptr);  // one share for all wavelengths
        if (scene.description.materials[chosen].type == "phong") ++second;
    }
    EXPECT_NEAR(second, 3000, 5 * std::sqrt(10000 * 0.3 * 0.7));  // 5 sigma
    EXPECT_THAT(refused_world("Material \"mix\" \"string materials\" \"a\""), HasSubstr("names of two materials"));
    EXPECT_THAT(refused_world("MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [\"a\" \"a\"]"),
                HasSubstr("made of itself"));
    std::string mixtures = "MakeNamedMaterial \"m0\" \"string type\" \"diffuse\"\n";  // the last one of 2^40
    for (int i = 1; i <= 40; ++i)
        mixtures += fmt::format("MakeNamedMaterial \"m{}\" \"string type\" \"mix\" \"string materials\" [\"m{}\" \"m{}\"]\n", i,
                                i - 1, i - 1);
    EXPECT_THAT(refused_world(mixtures), HasSubstr("or of more than 10,000 materials"));
}

TEST(Mixture, WithinAnotherOneChoosesByItself) {
    const testing::Scene scene = testing::scene_of(load_world(
        std::string("MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"b\" \"string type\" \"phong\"\n"
                    "MakeNamedMaterial \"c\" \"string type\" \"conductor\"\n"
                    "MakeNamedMaterial \"ab\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .3\n"
                    "LightSource \"infinite\"\nMaterial \"mix\" \"string materials\" [\"ab\" \"c\"] \"float amount\" .5\n") +
        kPlane));
    SpectrumLibrary library;
    const Textures textures = Textures::build(scene.description, 1 << 20, library).value();
    std::vector<Material> materials;
    for (const MaterialDescription& description : scene.description.materials)
        materials.emplace_back(description, textures, library);
    std::map<std::string, int> found;
    for (int i = 0; i < 10000; ++i) {
        TexturePoint point{};
        point.p = {static_cast<float>(i) * 1e-3f, 0.3f, 0};
        const SampledSpectrum* weight = nullptr;
        std::uint32_t at = scene.description.shapes[0].material;
        for (std::uint32_t depth = 0; materials[at].is_mixture(); ++depth) at = materials[at].chosen(point, depth, weight);
        ++found[scene.description.materials[at].type];
    }
    for (const auto& [type, share] : {std::pair("diffuse", 0.35), {"phong", 0.15}, {"conductor", 0.5}})
        EXPECT_NEAR(found[type], 10000 * share, 5 * std::sqrt(10000 * share * (1 - share))) << type;  // 5 sigma
}

std::string gzipped(const std::string& text) {
    std::string out(compressBound(text.size()) + 64, '\0');
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty "
    "float "
    "ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 0 0 1\n1 0 0 nan 0 1\n0 1 0 0 0 1\n3 0 1 2\n";

TEST(PackedFiles, IncludesAndMeshesMayBeGzipped) {
    const Folder folder;
    folder.write("m.ply.gz", gzipped(kPly));
    folder.write("part.pbrt.gz", gzipped("Shape \"plymesh\" \"string filename\" \"m.ply.gz\"\n"));
    const Result<LoadedScene> scene = load_scene(folder.write("room.pbrt", "WorldBegin\nInclude \"part.pbrt.gz\"\n"));
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->description.shapes[0].mesh->positions.size(), 3u);
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_THAT(scene->warnings[0], HasSubstr("1 normal is not finite"));

    std::string cut = gzipped(kPly);
    cut.resize(cut.size() / 2);
    folder.write("m.ply.gz", cut);
    const Result<LoadedScene> broken = load_scene(folder / "room.pbrt");
    ASSERT_FALSE(broken);
    EXPECT_THAT(broken.error().message, HasSubstr("m.ply.gz: is damaged"));
    folder.write("m.ply.gz", gzipped(std::string(std::size_t{65} << 20, ' ')));  // 1000 times smaller
    const Result<LoadedScene> bomb = load_scene(folder / "room.pbrt");
    ASSERT_FALSE(bomb);
    EXPECT_THAT(bomb.error().message, HasSubstr("m.ply.gz: unpacks to more than 100 times its size"));
}

TEST(Singular, AMeshBecomesFlatAndAQuadricOrInstanceNothing) {
    const Result<LoadedScene> flat = load_world(std::string("Scale 1 0 1\n") + kPlane);
    ASSERT_TRUE(flat) << flat.error().message;
    for (const Vec3f& p : flat->description.shapes[0].mesh->positions)
        EXPECT_EQ(p.y + static_cast<float>(flat->description.origin.y), 0);
    const Result<LoadedScene> none = load_world(std::string("ObjectBegin \"o\"\n") + kPlane +
                                                "ObjectEnd\nScale 1 0 1\nShape \"sphere\"\nObjectInstance \"o\"\n");
    ASSERT_TRUE(none) << none.error().message;
    EXPECT_TRUE(none->description.shapes.empty());
    EXPECT_TRUE(none->description.instances.empty());
    EXPECT_EQ(none->warnings.size(), 2u);
}

TEST(EnvironmentFormats, APfmIsReadAsAnExrIs) {
    const Folder folder;
    // PFM has its rows from the bottom.
    const float rows[2][6] = {{7, 8, 9, 10, 11, 12}, {1, 2, 3, 4, 5, 6}};
    folder.write("sky.pfm", "PF\n2 2\n-1.0\n" + std::string(reinterpret_cast<const char*>(rows), sizeof(rows)));
    const Result<LoadedScene> scene =
        load_scene(folder.write("room.pbrt", "WorldBegin\nLightSource \"infinite\" \"string filename\" \"sky.pfm\"\n"));
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->description.lights[0].image->rgb, (std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
    folder.write("sky.pfm", "PF\n2 2\n-1.0\nshort");
    EXPECT_THAT(load_scene(folder / "room.pbrt").error().message, HasSubstr("sky.pfm: cannot be read as a picture"));
}

TEST(ColorSpaces, Aces2065WhiteIsWhite) {
    const Result<LoadedScene> scene = load_world(
        "ColorSpace \"aces2065-1\"\nMaterial \"diffuse\" \"rgb reflectance\" [.3 .5 .4]\nShape \"sphere\"\n"
        "LightSource \"infinite\" \"rgb L\" [2 2 2]\n");
    ASSERT_TRUE(scene) << scene.error().message;
    const color::Spectrum& light = scene->description.lights[0].spectrum;
    const color::Spectrum white = *color::named_spectrum("illum-acesD60");
    EXPECT_NEAR(light(450) / light(650), white(450) / white(650), 1e-6);
    const double green = scene->description.materials[scene->description.shapes[0].material].spectra.at("reflectance").value(540);
    EXPECT_GT(green, 0.4);
}

TEST(ColorSpaces, APictureOfTheSkyIsSrgbInEveryOne) {
    const Folder folder;
    folder.write("sky.pfm", "PF\n1 1\n-1.0\n" + std::string(12, '\x3f'));
    const auto light = [&](const std::string& before) {
        const Result<LoadedScene> scene = load_scene(
            folder.write("room.pbrt", before + "WorldBegin\nLightSource \"infinite\" \"string filename\" \"sky.pfm\"\n"));
        EXPECT_TRUE(scene) << scene.error().message;
        return scene->description.lights[0].spectrum;
    };
    const color::Spectrum srgb = light(""), aces = light("ColorSpace \"aces2065-1\"\n");
    for (const double nm : {400., 450., 555., 650.}) EXPECT_EQ(srgb(nm), aces(nm)) << nm;
}

}  // namespace
}  // namespace latent::render
