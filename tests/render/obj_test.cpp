// OBJ and MTL files as other loaders read them.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "render/load/obj/polygon.h"
#include "render/scene/content_hash.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using ::testing::ElementsAre;
using testing::Folder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::tga;

class Obj : public ::testing::Test {
 protected:
    LoadedScene load(const std::string& text) {
        Result<LoadedScene> scene = load_scene(folder_.write("m.obj", text));
        if (!scene) throw std::runtime_error(scene.error().message);
        return std::move(*scene);
    }
    Hash128 hash(const std::string& text) { return content_hash(load(text).description); }
    MaterialDescription material(const std::string& mtl) {
        folder_.write("m.mtl", "newmtl m\n" + mtl);
        const SceneDescription scene = load("mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").description;
        return scene.materials.at(scene.shapes.at(0).material);
    }
    Folder folder_;
};

TEST_F(Obj, OneModelInManySpellings) {
    folder_.write("m m.mtl", "newmtl red one\nKd .8 .2 .1\n");
    const std::string plain = "mtllib m m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.5\nusemtl red one\nf 1 2 3\nf 2 4 3\n";
    const Hash128 right = hash(plain);
    const auto with_line_ends = [&](const std::string& end) {
        std::string out;
        for (const char c : plain) out += c == '\n' ? end : std::string(1, c);
        return out;
    };
    for (const char* end : {"\r", "\r\n", "\n\n", " \t\n"}) EXPECT_EQ(hash(with_line_ends(end)), right) << end;
    for (const char* text :
         {"mtllib \"m m.mtl\"\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.5\nusemtl \"red one\"\nf 1/ 2// 3/\nf 2// 4 3\n",
          "mtllib m m.mtl\nusemtl red one\nf 1 2 3\nf 2 4 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.5\n",  // forward references
          "mtllib m m.mtl\nusemtl red one\nv +0 0. .0 1\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 1 1 5e-1\nf -3 -1 -2\n"})
        EXPECT_EQ(hash(text), right) << text;
}

TEST_F(Obj, WhatIsNotThereIsWarnedOfAndDoneWithout) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const Hash128 grey = hash(vertices + "f 1 2 3\n");
    const auto warnings = [&](const std::string& text) {
        const LoadedScene scene = load(text);
        EXPECT_EQ(content_hash(scene.description), grey) << text;
        return scene.warnings;
    };
    EXPECT_THAT(warnings("mtllib none.mtl\n" + vertices + "usemtl a\nf 1 2 3\n"),
                ElementsAre(AllOf(HasSubstr("m.obj:1: mtllib: "), HasSubstr("none.mtl: cannot open"), HasSubstr("grey"))));
    folder_.write("empty.mtl", "# nothing\n\n");
    EXPECT_THAT(warnings("mtllib empty.mtl\n" + vertices + "usemtl a\nf 1 2 3\n"),
                ElementsAre(HasSubstr("m.obj:5: usemtl: material \"a\" is not defined; it is grey")));
    EXPECT_THAT(warnings(vertices + "usemtl a\nf 1 2 3\n"),
                ElementsAre(HasSubstr("m.obj:4: usemtl: material \"a\" is not defined; it is grey")));
    EXPECT_THAT(warnings(vertices + "f 1/7 2/8 3/9\n"),
                ElementsAre(HasSubstr("m.obj:4: f: texture vertex 7 is not there; the face is without")));
    EXPECT_THAT(warnings(vertices + "f 1//7 2//7 3//7\n"), ElementsAre(HasSubstr("f: normal 7 is not there")));
    EXPECT_THAT(warnings(vertices + "f 1 2\nf 1 2 3\n"), ElementsAre(HasSubstr("m.obj:4: f: has fewer than 3 corners")));
}

TEST_F(Obj, SmoothingGroupsHaveTheNormalsOfTheirVertices) {
    // A roof: the ridge is smooth within a group, and an edge between two.
    const std::string vertices = "v 0 0 0\nv 0 1 0\nv 1 0 1\nv 1 1 1\nv 2 0 0\nv 2 1 0\n";
    const auto normals = [&](const std::string& faces) { return load(vertices + faces).description.shapes.at(0).mesh->normals; };
    const std::vector<Vec3f> smooth = normals("s 1\nf 1 3 4 2\nf 3 5 6 4\n");
    ASSERT_EQ(smooth.size(), 6u);
    std::size_t up = 0;
    for (const Vec3f& n : smooth) up += n.z > 0.999f ? 1 : 0;
    EXPECT_EQ(up, 2u);  // of the ridge
    EXPECT_THAT(normals("s off\nf 1 3 4 2\nf 3 5 6 4\n"), IsEmpty());
    EXPECT_THAT(normals("f 1 3 4 2\n"), IsEmpty());
    for (const Vec3f& n : normals("s 1\nf 1 3 4 2\ns 2\nf 3 5 6 4\n")) EXPECT_NEAR(n.z, std::sqrt(0.5f), 1e-6);
    // Normals of its own go first.
    EXPECT_EQ(hash("s 1\nvn 0 0 1\n" + vertices + "f 1//1 3//1 4//1\n"), hash("vn 0 0 1\n" + vertices + "f 1//1 3//1 4//1\n"));
}

// The area of a polygon is that of its triangles, none of which is turned over.
TEST_F(Obj, PolygonsOfAnySizeAreCutIntoTriangles) {
    const auto area = [](const std::vector<Vec3d>& corners) {
        std::vector<std::uint32_t> triangles;
        EXPECT_TRUE(triangulate(corners, triangles));
        EXPECT_EQ(triangles.size(), 3 * (corners.size() - 2));
        double sum = 0;
        for (std::size_t i = 0; i + 3 <= triangles.size(); i += 3) {
            const Vec3d &a = corners[triangles[i]], &b = corners[triangles[i + 1]], &c = corners[triangles[i + 2]];
            EXPECT_GE(cross(b - a, c - a).z, -1e-12);
            sum += 0.5 * cross(b - a, c - a).z;
        }
        return sum;
    };
    for (const std::size_t count : {3u, 4u, 1001u, 4000u}) {
        for (const double depth : {1.0, 0.3}) {  // a circle, and a star
            std::vector<Vec3d> corners;
            double exact = 0;
            for (std::size_t i = 0; i < count; ++i) {
                const double turn = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
                const double radius = i % 2 == 0 || count % 2 == 1 ? 1 : depth;
                corners.emplace_back(radius * std::cos(turn), radius * std::sin(turn), 0.0);
            }
            for (std::size_t i = 0; i < count; ++i) {
                const Vec3d &a = corners[i], &b = corners[(i + 1) % count];
                exact += 0.5 * (a.x * b.y - a.y * b.x);
            }
            EXPECT_NEAR(area(corners), exact, 1e-9) << count << " " << depth;
        }
    }
}

TEST_F(Obj, AnIndexOfZeroIsThatOfAnOpaqueMaterial) {
    EXPECT_EQ(material("Kd .5 .5 .5\nPr .5\nNi 0\n").number("f0").value, material("Kd .5 .5 .5\nPr .5\n").number("f0").value);
    EXPECT_EQ(material("illum 7\nNi 0\n").spectra.at("eta").value(500), 1.5);
}

TEST_F(Obj, IllumIsGlassOnlyWhereTheColoursAgree) {
    testing::write_exr(folder_ / "a.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    EXPECT_EQ(material("illum 7\nKd 0 0 0\n").type, "dielectric");
    EXPECT_EQ(material("illum 7\nmap_Kd a.exr\n").type, "diffuse");
    EXPECT_EQ(material("illum 4\nKd .5 .5 .5\nTf 1 1 1\nNi 1.00\n").type, "diffuse");  // Maya's default
    EXPECT_NEAR(material("illum 4\nTf .25 .25 .25\n").spectra.at("transmittance").value(500), 0.25, 1e-3);
    // Without Tf, the hue of Kd, which need not be as dark.
    EXPECT_TRUE(material("illum 4\nKd .5 .5 .5\n").spectra.count("transmittance") == 0);
    const MaterialDescription green = material("illum 4\nKd 0 .25 0\n");
    EXPECT_GT(green.spectra.at("transmittance").value(530), 0.9);
    EXPECT_LT(green.spectra.at("transmittance").value(650), 0.1);
}

// A mirror whose Ks is above Kd, or has a hue; others must have both, plainly.
TEST_F(Obj, TwoSignsOfAMetalMakeOne) {
    const auto metallic = [&](const std::string& mtl) { return material(mtl).number("metallic").value; };
    for (const char* metal : {"illum 3\nKd 0 0 0\nKs .8 .8 .8\n", "illum 8\nKd 0 .8 0\nKs 0 .8 0\n",
                              "illum 2\nKd 0 0 0\nKs .95 .64 .54\n", "Kd 0 0 0\nKs .9 .6 .3\n", "illum 5\nKd 0 0 0\nKs .9 .6 .3\n"})
        EXPECT_EQ(metallic(metal), 1) << metal;
    for (const char* plastic :
         {"illum 3\nKd .8 .8 .8\nKs .1 .1 .1\n", "illum 2\nKd 0 0 0\nKs .8 .8 .8\n", "illum 2\nKd .9 .6 .3\nKs .9 .6 .3\n",
          // OpenGL's red plastic, yellow plastic and red rubber, and a black with a warm highlight.
          "illum 2\nKd .5 0 0\nKs .7 .6 .6\n", "illum 2\nKd .5 .5 0\nKs .6 .6 .5\n", "illum 2\nKd .5 .4 .4\nKs .7 .04 .04\n",
          "illum 2\nKd .02 .02 .02\nKs .8 .75 .7\n"})
        EXPECT_EQ(metallic(plastic), 0) << plastic;
    EXPECT_EQ(material("illum 1\nKd 0 0 0\nKs .95 .64 .54\n").type, "diffuse");
    // Its colour is Ks; it is as rough as Ns says, unless it mirrors.
    const MaterialDescription mirror = material("illum 3\nKd 0 0 0\nKs .8 .8 .8\nNs 250\n");
    EXPECT_NEAR(mirror.spectra.at("base_color").value(500), 0.8, 1e-3);
    EXPECT_EQ(mirror.number("roughness").value, 0);
    EXPECT_EQ(material("Kd 0 0 0\nKs .9 .6 .3\nNs 250\n").number("roughness").value, 0.5f);
    // In between, both are as much a part as they are brighter: (.8 - .2) / .8.
    const MaterialDescription between = material("illum 3\nKd .2 .2 .2\nKs .8 .8 .8\nNs 250\n");
    EXPECT_FLOAT_EQ(between.number("metallic").value, 0.75f);
    EXPECT_FLOAT_EQ(between.number("roughness").value, 0.25f * 0.5f);
    EXPECT_TRUE(between.spectra.at("base_color").is_textured());
}

// Along each of three ways, from plastic to metal or back, in 500 steps.
TEST_F(Obj, ATinyChangeOfANumberChangesAMaterialLittle) {
    constexpr int kSteps = 500;
    constexpr float kMost = 0.05f;
    const auto rgb = [](double r, double g, double b) { return fmt::format("{} {} {}\n", r, g, b); };
    for (const int illum : {2, 3}) {
        float most_changed = 0;
        for (const int way : {0, 1, 2}) {
            std::string mtl, obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
            for (int i = 0; i <= kSteps; ++i) {
                const double x = static_cast<double>(i) / kSteps;
                mtl += fmt::format("newmtl m{}\nillum {}\nNs 100\n", i, illum) +
                       (way == 0   ? "Kd .1 .1 .1\nKs " + rgb(0.1 + 0.9 * x, 0.1 + 0.9 * x, 0.1 + 0.9 * x)
                        : way == 1 ? "Kd " + rgb(x, x, x) + "Ks .9 .7 .3\n"
                                   : "Kd .2 .1 .1\nKs " + rgb(0.9, 0.9 * x, 0.9 * x));
                obj += fmt::format("usemtl m{}\nf 1 2 3\n", i);
            }
            folder_.write("m.mtl", mtl);
            const SceneDescription scene = load(obj).description;
            ASSERT_EQ(scene.shapes.size(), kSteps + 2u);  // and the ground
            float lowest = 1, highest = 0;
            for (std::size_t i = 0; i <= kSteps; ++i) {
                const MaterialDescription& m = scene.materials.at(scene.shapes.at(i).material);
                lowest = std::min(lowest, m.number("metallic").value);
                highest = std::max(highest, m.number("metallic").value);
                if (i == 0) continue;
                const MaterialDescription& before = scene.materials.at(scene.shapes.at(i - 1).material);
                for (const char* name : {"metallic", "roughness", "f0", "f90"})
                    EXPECT_NEAR(m.number(name).value, before.number(name).value, kMost) << name << illum << way << i;
            }
            most_changed = std::max(most_changed, highest - lowest);
        }
        EXPECT_GT(most_changed, 0.7f) << illum;  // or nothing was shown
    }
}

// Blender writes Ka for the metallic share, Ns for the roughness, Ks for the specular level.
TEST_F(Obj, AFileOfBlendersHasTheInputsOfItsPrincipledBsdf) {
    testing::write_exr(folder_ / "a.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    const std::string faces = "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const auto of_header = [&](const std::string& header, const std::string& mtl) {
        folder_.write("m.mtl", header + "newmtl m\n" + mtl);
        return load(faces);
    };
    const std::string metal = "Ns 810\nKa .75 .75 .75\nKd .9 .7 .3\nKs .5 .5 .5\nNi 1.45\nd 1\nillum ";
    for (const char* header : {"# Blender MTL File: 'a.blend'\n", "# Blender 4.1.0 MTL File: 'None'\n# www.blender.org\n"}) {
        for (const int illum : {3, 6}) {
            const LoadedScene scene = of_header(header, metal + std::to_string(illum) + "\n");
            EXPECT_THAT(scene.warnings, IsEmpty());
            const MaterialDescription& m = scene.description.materials.at(1);
            EXPECT_EQ(m.type, "metallicroughness");
            for (const auto& [name, value] :
                 {std::pair("metallic", 0.75f), {"roughness", 0.1f}, {"f0", 0.04f}, {"f90", 1.0f}, {"coat", 0.0f}})
                EXPECT_NEAR(m.number(name).value, value, 1e-6) << name;
            EXPECT_EQ(content_hash(scene.description),
                      content_hash(of_header("# Blender\n", "Kd .9 .7 .3\nKs .5 .5 .5\nPr .1\nPm .75\nNi 1.45\n").description));
        }
        // Ka is 1 for what is not metal.
        EXPECT_EQ(of_header(header, metal + "2\n").description.materials.at(1).number("metallic").value, 0);
    }
    // Other programs have a light from all around in it.
    EXPECT_EQ(of_header("# A program\n", metal + "3\n").description.materials.at(1).number("metallic").value, 0);
    EXPECT_EQ(of_header("# A program\n", metal + "6\n").description.materials.at(1).type, "dielectric");

    const SceneDescription mapped =
        of_header("# Blender 3.4.1\n", "Kd 1 1 1\nKs .5 .5 .5\nillum 2\nmap_Ns a.exr\nmap_refl a.exr\nmap_Bump a.exr\n")
            .description;
    const MaterialDescription& m = mapped.materials.at(1);
    for (const char* name : {"roughness", "metallic"}) {
        ASSERT_TRUE(m.number(name).is_textured()) << name;
        EXPECT_EQ(mapped.textures.at(m.number(name).texture).tint[0], 1) << name;
    }
    EXPECT_NE(m.normal_map, kNone);
    EXPECT_EQ(of_header("# Blender\n", "Kd .1 .8 .1\nPr 0\nPm 0\nTf 1 1 1\nNi 1.45\n").description.materials.at(1).type,
              "dielectric");
}

TEST_F(Obj, AMapWithoutAFactorIsTakenAsItIs) {
    testing::write_exr(folder_ / "a.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    for (const auto& [without, with] : {std::pair("map_Kd a.exr\n", "Kd 1 1 1\nmap_Kd a.exr\n"),
                                        {"map_Ks a.exr\n", "Ks 1 1 1\nmap_Ks a.exr\n"},
                                        {"map_Ke a.exr\n", "Ke 1 1 1\nmap_Ke a.exr\n"},
                                        {"map_Pr a.exr\n", "Pr 1\nmap_Pr a.exr\n"},
                                        {"map_Kd a.exr\nKd 0 0 0\n", "Kd 1 1 1\nmap_Kd a.exr\n"}}) {
        const std::string faces = "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        folder_.write("m.mtl", std::string("newmtl m\n") + without);
        const Hash128 alone = hash(faces);
        folder_.write("m.mtl", std::string("newmtl m\n") + with);
        EXPECT_EQ(alone, hash(faces)) << without;
    }
}

// Black would hide the shape; a Kd that is a colour is what there is.
TEST_F(Obj, ABlackBodyWhosePictureIsMissingIsGrey) {
    const auto kd = [&](const std::string& mtl) { return material(mtl).spectra.at("reflectance").value(500); };
    EXPECT_NEAR(kd("Kd 0 0 0\nmap_Kd none.png\n"), 0.5, 1e-6);
    EXPECT_NEAR(kd("map_Kd none.png\n"), 0.5, 1e-6);
    EXPECT_NEAR(kd("map_Kd none.png\nKd .25 .25 .25\n"), 0.25, 1e-6);
    EXPECT_EQ(kd("Kd 0 0 0\n"), 0);
}

TEST_F(Obj, MapsHaveOptionsAndAreLookedForBesideTheirLibrary) {
    std::filesystem::create_directory(folder_ / "sub");
    testing::write_exr(folder_ / "sub/my wood.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    folder_.write("sub/m.mtl",
                  "newmtl m\nPr .5\nmap_Kd -colorspace sRGB -s 2 3 1 -o 0.25 -clamp on my wood.exr\n"
                  "map_Pr C:\\x\\my wood.exr -imfchan g\n");
    const std::string faces = "usemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    EXPECT_THAT(load("mtllib .\\sub\\m.mtl\n" + faces).warnings, IsEmpty());  // as Windows writes it
    const LoadedScene scene = load("mtllib sub/m.mtl\n" + faces);
    EXPECT_THAT(scene.warnings, IsEmpty());
    const SceneDescription& d = scene.description;
    const MaterialDescription& m = d.materials.at(d.shapes.at(0).material);
    const TextureDescription &color = d.textures.at(m.spectra.at("base_color").texture),
                             &rough = d.textures.at(m.number("roughness").texture);
    EXPECT_EQ(color.mapping.s, (std::array<double, 2>{2, 0}));
    EXPECT_EQ(color.mapping.t, (std::array<double, 2>{0, 3}));
    EXPECT_EQ(color.mapping.delta_u, 0.25);
    EXPECT_THAT(color.picture.wrap, ::testing::Each(TextureWrap::kClamp));
    EXPECT_TRUE(color.picture.is_srgb);
    EXPECT_FALSE(rough.picture.is_srgb);
    EXPECT_EQ(rough.picture.channel, 1);
    EXPECT_EQ(rough.tint[1], 0.5);
}

TEST_F(Obj, NormalMapsAreReadAlsoWhereTheyAreCalledBumps) {
    folder_.write("normals.ppm", std::string("P6\n1 1\n255\n") + "\x80\x80\xFF");
    folder_.write("srgb.ppm", std::string("P6\n1 1\n255\n") + "\xC0\xC0\xF7");
    testing::write_exr(folder_ / "normals.exr", 1, 1, {0.5f, 0.5f, 1});
    for (const char* keyword : {"norm", "bump", "map_Bump"}) {
        for (const char* name : {"normals.ppm", "normals.exr", "srgb.ppm"}) {
            folder_.write("m.mtl", fmt::format("newmtl m\n{} -bm 0.5 {}\n", keyword, name));
            const SceneDescription scene = load("mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").description;
            const MaterialDescription& m = scene.materials.at(scene.shapes.at(0).material);
            ASSERT_NE(m.normal_map, kNone) << keyword << name;
            EXPECT_EQ(m.normal_scale, 0.5f);
            // "norm" says what it is; of a bump, its colours say it.
            const bool is_srgb = std::string_view(name) == "srgb.ppm" && std::string_view(keyword) != "norm";
            EXPECT_EQ(scene.textures.at(m.normal_map).picture.is_srgb, is_srgb) << keyword << name;
        }
    }
    // Grey heights, bluish stone, a blue sky.
    for (const char* pixel : {"\x80\x80\x80", "\xFF\xFF\xFF", "\x60\x70\x90", "\x40\x90\xFF"}) {
        folder_.write("heights.ppm", std::string("P6\n1 1\n255\n") + pixel);
        EXPECT_EQ(material("bump heights.ppm\n").normal_map, kNone) << pixel;
    }
}

// Some programs mean by Tr what d is.
TEST_F(Obj, WhatWouldBeHiddenAsAWholeIsOpaqueWithAWarning) {
    testing::write_exr(folder_ / "a.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    const std::string faces = "mtllib m.mtl\nusemtl paint\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const auto warnings = [&](const std::string& mtl) {
        folder_.write("m.mtl", "newmtl paint\n" + mtl);
        return load(faces).warnings;
    };
    for (const std::string paint : {"map_Kd a.exr\n", "Kd .8 .2 .1\n", "Ks .5 .5 .5\n"}) {
        const Hash128 opaque = (warnings(paint), hash(faces));
        for (const char* hidden : {"d 0\n", "Tr 1\n"}) {
            EXPECT_THAT(warnings(paint + hidden), ElementsAre(HasSubstr("m.mtl:1: paint: d is 0 (or Tr is 1), which would hide")));
            EXPECT_EQ(hash(faces), opaque) << paint << hidden;
        }
    }
    EXPECT_EQ(material("Kd .8 .8 .8\nKs .5 .5 .5\nNi 1.45\nillum 9\nd 0\n").type, "metallicroughness");
    EXPECT_EQ(material("illum 7\nd 0\n").type, "dielectric");
    for (const char* seen : {"map_Kd a.exr\nd 1\n", "map_Kd a.exr\nd .1\n", "d .1\n", "illum 7\nd 0\n"})
        EXPECT_THAT(warnings(seen), IsEmpty()) << seen;
}

// Blender writes illum 9 for what has an alpha below 1.
TEST_F(Obj, TheOpacityOfIllum9IsThatOfItsSurface) {
    folder_.write("m.mtl", "newmtl m\nKd .8 .1 .1\nKs .5 .5 .5\nNi 1.45\nillum 9\nd .75\n");
    const SceneDescription scene = load("mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").description;
    EXPECT_EQ(scene.materials.at(scene.shapes.at(0).material).type, "metallicroughness");
    EXPECT_EQ(scene.shapes[0].alpha.value, 0.75f);
    EXPECT_EQ(material("illum 9\n").type, "dielectric");
}

TEST_F(Obj, TheAlphaOfAPictureIsTheOpacityWhereNoMapSaysIt) {
    folder_.write("leaf.tga", tga({255, 0, 128}));
    folder_.write("unused.tga", tga({0, 0, 0}));
    folder_.write("full.tga", tga({255, 255}));
    const std::string faces = "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    const auto scene = [&](const std::string& mtl) {
        folder_.write("m.mtl", "newmtl m\n" + mtl);
        return load(faces);
    };
    const LoadedScene leaf = scene("map_Kd leaf.tga\nd .5\n");
    const FloatInput alpha = leaf.description.shapes.at(0).alpha;
    ASSERT_TRUE(alpha.is_textured());
    EXPECT_EQ(leaf.description.textures.at(alpha.texture).picture.channel, 3);
    EXPECT_EQ(leaf.description.textures[alpha.texture].tint[3], 0.5);
    EXPECT_THAT(leaf.notes, ElementsAre(HasSubstr("m.mtl:1: m: has no map_d; the alpha of its map_Kd is its opacity")));
    const LoadedScene mapped = scene("map_Kd leaf.tga\nmap_d full.tga\n");
    EXPECT_THAT(mapped.notes, IsEmpty());
    EXPECT_THAT(mapped.description.textures.at(mapped.description.shapes.at(0).alpha.texture).picture.path, HasSubstr("full.tga"));
    // A gloss in the alpha: where it is 0, the picture goes on.
    folder_.write("gloss.tga", tga({255, 0, 0, 128}, {80, 90, 140, 60}));
    const LoadedScene gloss = scene("map_Kd gloss.tga\n");
    EXPECT_FALSE(gloss.description.shapes.at(0).alpha.is_textured());
    EXPECT_THAT(gloss.notes, ElementsAre(HasSubstr("the alpha of its map_Kd hides what looks like a picture, and is ignored")));
    for (const char* opaque : {"map_Kd unused.tga\n", "map_Kd full.tga\n"})
        EXPECT_FALSE(scene(opaque).description.shapes.at(0).alpha.is_textured()) << opaque;
}

// As one that is missing.
TEST_F(Obj, APictureThatCannotBeReadIsDoneWithout) {
    folder_.write("lfs.png", "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n");
    folder_.write("a.ktx2", "\xABKTX 20\xBB and so on");
    folder_.write("cut.png", std::string("\x89PNG\r\n\x1a\n\0\0\0\xDIHDR", 16));
    folder_.write("m.mtl", "newmtl m\nKd .5 .5 .5\nKs .5 .5 .5\nmap_Kd lfs.png\nmap_Ks a.ktx2\nmap_Ns cut.png\n");
    const std::string faces = "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const LoadedScene scene = load(faces);
    const auto without = [](const std::string& map, const std::string& why) {
        return AllOf(HasSubstr(map), HasSubstr(why), HasSubstr("the material is without it"));
    };
    EXPECT_THAT(scene.warnings,
                ElementsAre(without("m.mtl:4: map_Kd: ", "lfs.png: cannot be read as a picture: the file is a Git LFS pointer"),
                            without("m.mtl:5: map_Ks: ", "a.ktx2: cannot be read"), without("m.mtl:6: map_Ns: ", "cut.png: ")));
    const Hash128 hash = content_hash(scene.description);
    folder_.write("m.mtl", "newmtl m\nKd .5 .5 .5\nKs .5 .5 .5\n");
    EXPECT_EQ(hash, content_hash(load(faces).description));
}

TEST_F(Obj, ALibraryThatIsAGitLfsPointerIsCalledSo) {
    folder_.write("m.mtl", "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n");
    EXPECT_THAT(
        load("mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").warnings,
        ElementsAre(HasSubstr("m.obj:1: mtllib: m.mtl: is a Git LFS pointer instead of the file; fetch that with: git lfs pull")));
}

TEST_F(Obj, Utf16IsCalledByItsName) {
    const auto utf16 = [](const std::string& text, bool big_endian) {
        std::string out = big_endian ? "\xFE\xFF" : "\xFF\xFE";
        for (const char c : text) out += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
        return out;
    };
    const std::string faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (const bool big_endian : {false, true}) {
        const Result<LoadedScene> scene = load_scene(folder_.write("m.obj", utf16(faces, big_endian)));
        ASSERT_FALSE(scene);
        EXPECT_THAT(scene.error().message, HasSubstr("m.obj: is UTF-16; only UTF-8 is read (iconv"));
        folder_.write("m.mtl", utf16("newmtl m\nKd 1 0 0\n", big_endian));
        EXPECT_THAT(load("mtllib m.mtl\n" + faces).warnings,
                    ElementsAre(AllOf(HasSubstr("m.obj:1: mtllib: m.mtl: is UTF-16"), HasSubstr("grey"))));
    }
}

// Where there are two, neither is meant.
TEST_F(Obj, NamesThatDifferInCaseAloneAreFoundWithANote) {
    std::filesystem::create_directory(folder_ / "Textures");
    testing::write_exr(folder_ / "Textures/Wood.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    folder_.write("m.mtl", "newmtl m\nmap_Kd textures\\WOOD.EXR\n");
    const std::string faces = "mtllib M.MTL\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const LoadedScene scene = load(faces);
    EXPECT_THAT(scene.warnings, IsEmpty());
    EXPECT_THAT(scene.notes, ElementsAre(AllOf(HasSubstr("m.obj: \"M.MTL\" is read from "), HasSubstr("/m.mtl: ")),
                                         AllOf(HasSubstr("WOOD.EXR\" is read from "), HasSubstr("/Textures/Wood.exr: "))));
    EXPECT_TRUE(scene.description.materials.at(1).spectra.at("reflectance").is_textured());

    testing::write_exr(folder_ / "Textures/wood.exr", 1, 1, {0.5f, 0.25f, 0.125f});
    EXPECT_THAT(load(faces).warnings, ElementsAre(HasSubstr("WOOD.EXR: cannot be opened")));
    std::filesystem::remove(folder_ / "Textures/Wood.exr");
    EXPECT_THAT(load(faces).warnings, IsEmpty());
}

// Whatever a scene names, a message does not say what stands in a file that is something else.
TEST_F(Obj, FilesThatAreSomethingElseAreNotQuoted) {
    const std::string secret = "root:x:0:0:root:/root:/bin/bash\nsecond:y:1:1\n";
    folder_.write("secret", secret);
    const auto expect_silence = [&](const std::string& name, const std::string& text) {
        const Result<LoadedScene> scene = load_scene(folder_.write(name, text));
        std::string said = scene ? "" : scene.error().message;
        if (scene) {
            for (const std::string& line : scene->warnings) said += line + "\n";
        }
        EXPECT_THAT(said, AllOf(HasSubstr("secret"), ::testing::Not(HasSubstr("root")), ::testing::Not(HasSubstr("second")),
                                ::testing::Not(HasSubstr("bash"))))
            << text;
    };
    expect_silence("m.obj", "mtllib secret\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    for (
        const char* directive :
        {"Include \"secret\"", "WorldBegin\nInclude \"secret\"", "WorldBegin\nImport \"secret\"",
         "WorldBegin\nShape \"plymesh\" \"string filename\" \"secret\"",
         "WorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" \"secret\"\nShape \"sphere\"",
         "WorldBegin\nMaterial \"measured\" \"string filename\" \"secret\"\nShape \"sphere\"",
         "WorldBegin\nLightSource \"infinite\" \"string filename\" \"secret\"",
         R"(WorldBegin MakeNamedMedium "m" "string type" "nanovdb" "string filename" "secret" MediumInterface "m" "m" Shape "sphere")"})
        expect_silence("m.pbrt", directive);
    expect_silence("m.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 9999, "uri": "secret"}]})");
}

}  // namespace
}  // namespace latent::render
