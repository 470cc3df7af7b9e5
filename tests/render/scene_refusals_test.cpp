// What is refused, and what is ignored with a warning: every word by name, and where it stands.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "render/load/files/unread.h"
#include "render/load/list_features.h"
#include "render/load/pbrt/features.h"
#include "tests/render/scenes.h"
#include "tests/support/paths.h"

namespace latent::render {
namespace {

using testing::Folder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::load;
using ::testing::Not;
using testing::refusal;
using testing::refused_world;

TEST(SceneRefusals, WhatWouldMakeAnotherPictureIsAnErrorWithItsPlace) {
    struct Case {
        const char *text, *message;
    };
    for (const Case& c : {
             Case{"Material \"velvet\"", "Material \"velvet\" is not supported (diffuse, "},
             Case{"Texture \"t\" \"float\" \"imagmap\"\nShape \"sphere\" \"texture alpha\" \"t\"", "did you mean imagemap"},
             Case{"Material \"conducter\"", "Material \"conducter\" is not supported; did you mean conductor"},
             Case{"Shape \"sphere\" \"float radus\" 1",
                  "\"float radus\" of Shape \"sphere\" is not supported; did you mean radius?"},
             Case{"Shape \"sphere\" \"bool radius\" true", "is not supported; its type must be float or integer"},
             Case{"Material \"diffuse\" \"texture reflectance\" \"t\"", "2:20: spectrum texture \"t\" is not defined anywhere"},
             Case{"Texture \"t\" \"float\" \"constant\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"",
                  "not defined anywhere; there is a float texture \"t\""},
             Case{"Texture \"t\" \"float\" \"constant\"\nTexture \"t\" \"float\" \"constant\"", "defined before, on line 2"},
             Case{"Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"t\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"",
                  "2:1: Texture: is made of itself"},
             Case{"Material \"diffuse\" \"rgb reflectance\" [ 2 0 0 ]", "must not exceed 1"},
             Case{"Material \"diffuse\" \"rgb reflectance\" [ -1 0 0 ]", "non-negative"},
             Case{"Material \"diffuse\" \"spectrum reflectance\" [ 400 1 300 2 ]", "reflectance: "},
             Case{"Material \"diffuse\" \"spectrum reflectance\" \"nothing\"", "neither a known spectrum nor a file"},
             Case{"Material \"dielectric\" \"spectrum eta\" [ 400 1.5 700 1.4 ]", "must be positive from 360 to 830"},
             Case{"LightSource \"infinite\" \"string filename\" \"sky.exr\"", "sky.exr"},
             Case{"LightSource \"point\" \"spectrum I\" [ 900 1 1000 1 ]", "no visible part"},
             Case{"Shape \"cylinder\" \"float phimax\" 361", "phimax: 361 is not between 0 and 360"},
             Case{"Scale 1 2 1\nAreaLightSource \"diffuse\"\nShape \"cylinder\"", "an area light on a cylinder that is stretched"},
             Case{
                 "AreaLightSource \"diffuse\"\nShape \"curve\" \"string type\" \"ribbon\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 1 1 1 ] "
                 "\"normal N\" [ 0 0 1 1 0 0 ]",
                 "3:1: an area light on a \"ribbon\" that bends"},
             Case{"Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 3 ]",
                  "there are 3 vertices"},
             Case{"Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 ]", "into groups of 3"},
             Case{"Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1e39 0 0 0 1 0 ]", "single precision"},
             Case{"Translate 0 1e39 0\nShape \"sphere\"", "single precision"},
             Case{"Scale 1e20 1e20 1e20\nShape \"disk\" \"float radius\" 1e20", "single precision"},
             Case{"Shape \"plymesh\" \"string filename\" \"no.ply\"", "no.ply"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string preset\" \"Milk\"",
                  "preset: \"Milk\" is not one of Apple, Chicken1"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [ 1 2 3 ]",
                  "density: 3 values, but nx ny nz is 2"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\"", "density: 0 values, but nx ny nz is 1"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [ 1 -2 ]",
                  "value 2 is -2, which is not between 0 and"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" -2 \"float density\" [ 1 2 ]",
                  "nx: must be one integer from 1 to"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" 1 \"point3 p1\" [ 1 0 1 ]", "is flat"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" 1 \"float temperature\" 300 \"rgb Le\" "
                  "[ 1 1 1 ]",
                  "Le and temperature cannot be combined"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"rgbgrid\"", "sigma_a and sigma_s: one of them is required"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" \"rgb sigma_s\" [ 1 1 1  2 2 2 ]",
                  "2 values, but nx ny nz is 1"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" \"rgb sigma_s\" [ 1 1 1 ] \"rgb Le\" [ 1 1 1 ]",
                  "Le: needs sigma_a"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" \"rgb sigma_s\" [ 1 -1 1 ]", "colour 1 has -1"},
             Case{"MediumInterface \"m\" \"m\"", "medium \"m\" is not defined"},
             Case{"ObjectInstance \"o\"", "object \"o\" is not defined"},
             Case{"ObjectBegin \"o\"\nObjectInstance \"p\"", "must not be inside ObjectBegin"},
             Case{"ObjectBegin \"o\"\nAttributeEnd", "ObjectBegin from line 2 is still open"},
             Case{"AttributeBegin", "AttributeBegin has no end"},
             Case{"AttributeEnd", "AttributeEnd has nothing to end"},
             Case{"Camera \"perspective\"", "must come before WorldBegin"},
             Case{"Transform [ 1 0 0 1  0 1 0 0  0 0 1 0  0 0 0 1 ]", "projective"},
             Case{"Scale 1 0 1\nLightSource \"infinite\"", "singular"},
             Case{"ObjectBegin \"o\"\nObjectEnd\nScale 1 1e-20 1\nObjectInstance \"o\"", "ObjectInstance: too small"},
             Case{"Rotate 3 0 0 0", "the axis is 0"},
             Case{"LookAt 0 0 0  0 1 0  0 1 0", "parallel to up"},
             Case{"CoordSysTransform \"x\"", "is not defined"},
             Case{"ActiveTransform Now", "Now is neither StartTime, EndTime nor All"},
             Case{"TransformTimes 0 1", "must come before WorldBegin"},
             Case{"ActiveTransform EndTime\nTranslate 1 0 0\nLightSource \"point\"", "lights cannot move"},
             Case{"ActiveTransform EndTime\nTranslate 1 0 0\nMakeNamedMedium \"m\" \"string type\" \"cloud\"",
                  "a medium of type \"cloud\" cannot move"},
             Case{"ActiveTransform EndTime\nTranslate 1 0 0\nTexture \"t\" \"float\" \"fbm\"\nAttributeBegin\nIdentity\n"
                  "ActiveTransform All\nIdentity\nMaterial \"diffuse\" \"texture displacement\" \"t\"\nAttributeEnd",
                  "textures of space cannot move"},
             Case{"ColorSpace \"acescg\"", "ColorSpace"},
             Case{"ObjectBegin \"o\"\nAreaLightSource \"diffuse\"\nShape \"sphere\"\nObjectEnd", "lights inside ObjectBegin"},
         }) {
        const std::string message = refused_world(c.text);
        EXPECT_THAT(message, HasSubstr(c.message)) << c.text;
        EXPECT_THAT(message, ::testing::ContainsRegex("room.pbrt:[0-9]+:[0-9]+: ")) << c.text;
    }
    EXPECT_THAT(refusal("TransformTimes 1 1\nWorldBegin"), HasSubstr("TransformTimes: the end must come after the start"));
    EXPECT_THAT(refusal("Camera \"perspective\" \"float shutteropen\" 2\nWorldBegin"), HasSubstr("\"shutterclose\" comes before"));
    EXPECT_THAT(refusal("ActiveTransform EndTime\nScale 2 2 2\nCamera \"perspective\"\nWorldBegin"),
                HasSubstr("must be the same at StartTime and EndTime"));
    EXPECT_THAT(refusal("ActiveTransform EndTime\nScale 2 1 1\nCamera \"perspective\"\nWorldBegin"),
                HasSubstr("at EndTime skews or stretches"));
    EXPECT_THAT(refusal("Camera \"realistic\"\nWorldBegin"), HasSubstr("Camera \"realistic\" is not supported"));
    EXPECT_THAT(refusal("Camera \"realistic\"\nWorldBegin"), HasSubstr(": use \"perspective\" with \"lensradius\""));
    EXPECT_THAT(refusal("Film \"rgb\""), HasSubstr("ends before WorldBegin"));
    EXPECT_THAT(refused_world("Material \"diffused\""), Not(HasSubstr("pbrt-v")));
    EXPECT_THAT(refusal("Shape \"sphere\"\nWorldBegin"), HasSubstr("must come after WorldBegin"));
}

TEST(SceneRefusals, AFileOfAnotherFormatIsCalledByItsName) {
    using namespace std::string_literals;
    const auto is = [](const char* format) {
        return HasSubstr(std::string("room.pbrt: not a scene in a supported format (pbrt-v4, glTF 2.0, OBJ): ") + format);
    };
    EXPECT_THAT(refusal("{ \"asset\": { \"version\": \"2.0\" } }"), is("this is a glTF scene"));
    EXPECT_THAT(refusal("\xef\xbb\xbf\n{\"scenes\": [], \"asset\": {}}"), is("this is a glTF scene"));
    EXPECT_THAT(refusal("glTF\2\0\0\0"s), is("this is a glTF scene; its name must end in .gltf or .glb"));
    EXPECT_THAT(refusal("#usda 1.0\ndef Xform \"x\" {}\n"), is("this is a USD scene"));
    EXPECT_THAT(refusal("#usda 1.0\n"), is("this is a USD scene"));
    EXPECT_THAT(refusal("# a cube\n\nmtllib cube.mtl\nv 0 0 0\n"), is("this is a Wavefront OBJ scene; its name must end in .obj"));
    EXPECT_THAT(refusal("<?xml version=\"1.0\"?><scene/>"), is("this is XML"));
    EXPECT_THAT(refusal("\x89\0\1\2"s), is("this is a binary file"));
    EXPECT_THAT(refusal(""), is("the file is empty"));
    EXPECT_THAT(refusal("# only a comment\n"), is("the file is empty"));
    EXPECT_THAT(refusal("Lookat 0 0 0\nWorldBegin"), HasSubstr("room.pbrt:1:1: \"Lookat\" is not a directive of pbrt-v4"));
    EXPECT_THAT(refusal("WorldBegin\n{ \"asset\": 1 }"), HasSubstr("room.pbrt:2:1: "));  // what began as a scene is one
}

TEST(SceneRefusals, AllErrorsAreToldAtOnce) {
    const std::string message = refused_world("Material \"measured\"\nShape \"curve\"\nLightSource \"projection\"\n");
    for (const char* place : {":2:1: ", ":3:1: ", ":4:1: "}) EXPECT_THAT(message, HasSubstr(std::string("room.pbrt") + place));
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

TEST(SceneRefusals, AMissingIncludeHidesNoOtherError) {
    const Folder folder;
    const std::string scene = R"(Include "part.pbrt"
Texture "a" "spectrum" "imagemap" "string filename" "a.png"
Texture "b" "float" "imagemap" "string filename" "b.exr" "string filtr" "ewa"
Material "coateddiffuse" "texture reflectance" "a" "texture roughness" "b"
Shape "plymesh" "string filename" "m.ply"
MakeNamedMedium "v" "string type" "nanovdb" "string filename" "v.nvdb"
Shape "shpere"
AttributeBegin
)";
    const auto errors = [&] {
        const Result<LoadedScene> loaded = load_scene(folder.write("room.pbrt", scene));
        return lines_of(loaded ? "" : loaded.error().message);
    };
    folder.write("part.pbrt", "WorldBegin\n");
    const std::vector<std::string> others = errors();
    EXPECT_EQ(others.size(), 7u);
    std::filesystem::remove(folder / "part.pbrt");
    std::vector<std::string> all = errors();
    ASSERT_THAT(all, ::testing::Contains(HasSubstr("part.pbrt: cannot open")));
    std::erase_if(all, [](const std::string& line) { return line.find("part.pbrt: ") != line.npos; });
    EXPECT_EQ(all, others);
}

TEST(SceneRefusals, NamesThatAMissingIncludeMayDefineAreToldInOneLine) {
    const auto message = [](const std::string& rest) {
        return lines_of(refused_world("Include \"part.pbrt\"\n" + rest +
                                      "CoordSysTransform \"c\"\nNamedMaterial \"gold\"\nMediumInterface \"fog\" \"\"\n"
                                      "ObjectInstance \"o\"\nShape \"sphere\" \"texture alpha\" \"a\"\n"));
    };
    EXPECT_THAT(message(""), ::testing::ElementsAre(HasSubstr("room.pbrt:2:1: "),
                                                    HasSubstr(": not defined in what could be read: float "
                                                              "texture \"a\", material \"gold\", medium \"fog\", object \"o\", "
                                                              "coordinate system \"c\"")));
    // So is WorldBegin.
    EXPECT_THAT(
        lines_of(refusal("Include \"part.pbrt\"\nShape \"sphere\"\nCamera \"perspective\"\nWorldBegin\nShape \"sphere\"\n")),
        ::testing::ElementsAre(HasSubstr("room.pbrt:1:1: ")));
    std::string many;
    for (int i = 0; i < 100; ++i) many += fmt::format("NamedMaterial \"m{}\"\n", i);
    EXPECT_THAT(message(many), ::testing::ElementsAre(HasSubstr("part.pbrt"), HasSubstr("\"m15\" and 95 more names")));
}

TEST(SceneRefusals, WhatGoesOnForeverEnds) {
    const Folder folder;
    for (int i = 0; i < 40; ++i) {
        const std::string next = fmt::format("Include \"{}.pbrt\"\n", i + 1);
        folder.write(fmt::format("{}.pbrt", i), i < 39 ? next + next : "");
    }
    EXPECT_THAT(load_scene(folder / "0.pbrt").error().message, HasSubstr("the scene includes its files so often"));
    // A file that many buffers of a glTF model name is read once; libraries of an OBJ model are read each time.
    folder.write("a.bin", std::string(100'000, '\0'));
    std::string buffers;
    for (int i = 0; i < 200; ++i) buffers += fmt::format(R"({}{{"uri": "a.bin", "byteLength": 100000}})", i > 0 ? ", " : "");
    folder.write("a.gltf", fmt::format(R"({{"asset": {{"version": "2.0"}}, "buffers": [{}]}})", buffers));
    EXPECT_THAT(load_scene(folder / "a.gltf").error().message, HasSubstr("there is no scene"));
    folder.write("a.mtl", std::string(100'000, '#'));
    std::string model;
    for (int i = 0; i < 200; ++i) model += "mtllib a.mtl\n";
    folder.write("a.obj", model + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_THAT(load_scene(folder / "a.obj").error().message, HasSubstr("the scene includes its files so often"));
    std::string many = "WorldBegin\n", lost = many;
    for (int i = 0; i < 5000; ++i) many += "AttributeBegin\n";
    EXPECT_THAT(lines_of(refusal(many)), ::testing::SizeIs(1001));
    EXPECT_LT(refused_world("Material \"" + std::string(100'000, 'x') + "\"\n").size(), 5000u);
    // Each made of the one before twice: 2^40 values for one.
    std::string twice = "Texture \"0\" \"float\" \"fbm\"\n";
    for (int i = 1; i < 40; ++i)
        twice += fmt::format("Texture \"{0}\" \"float\" \"mix\" \"texture tex1\" \"{1}\" \"texture tex2\" \"{1}\"\n", i, i - 1);
    EXPECT_THAT(refused_world(twice + "Shape \"sphere\" \"texture alpha\" \"39\"\n"),
                HasSubstr("evaluates more than 10000 textures for one value"));
    // A file that many things use is missed once.
    for (int i = 0; i < 9; ++i)
        lost += fmt::format(
            "Texture \"{}\" \"float\" \"imagemap\" \"string filename\" \"no.png\"\nShape \"sphere\" \"texture alpha\" \"{}\"\n", i,
            i);
    EXPECT_THAT(lines_of(refusal(lost)), ::testing::ElementsAre(HasSubstr("room.pbrt:2:1: ")));
}

TEST(SceneRefusals, AByteOrderMarkAndBackslashesAreNoFaults) {
    const Folder folder;
    std::filesystem::create_directory(folder / "in");
    folder.write("in/part.pbrt", "\xEF\xBB\xBFShape \"sphere\"\n");
    EXPECT_TRUE(load_scene(folder.write("room.pbrt", "\xEF\xBB\xBFWorldBegin\nInclude \"in\\\\part.pbrt\"\n")));
}

// What is listed is read, and nothing else is: the list is part of the message.
TEST(SceneRefusals, TheListOfFeaturesIsTrue) {
    const auto message = [](const PbrtFeature& feature, std::string_view type) {
        const std::string word = fmt::format(" \"{}\"\n", type), directive(feature.directive);
        std::string text = directive + word + "WorldBegin\n";
        if (directive == "Medium") text = "WorldBegin\nMakeNamedMedium \"m\" \"string type\"" + word;
        if (directive == "Material" && type == "mix") text = "WorldBegin\nMaterial \"mix\"\n";
        if (directive == "Texture") {
            text = "WorldBegin\n";
            for (const char* kind : {"\"float\"", "\"spectrum\""}) text += std::string("Texture \"t\" ") + kind + word;
            text +=
                type == "marble" ? "Material \"phong\" \"texture Kd\" \"t\"\n" : "Material \"phong\" \"texture exponent\" \"t\"\n";
        }
        if (directive == "Shape" || directive == "Material" || directive == "LightSource" || directive == "AreaLightSource")
            text = "WorldBegin\n" + directive + word;
        const Result<LoadedScene> scene = load(text);
        return scene ? "" : scene.error().message;
    };
    for (const PbrtFeature& feature : pbrt_features()) {
        for (const std::string_view type : feature.types)
            EXPECT_THAT(message(feature, type), Not(HasSubstr(fmt::format("\"{}\" is not supported", type)))) << feature.directive;
        EXPECT_THAT(message(feature, "nothing"), HasSubstr("\"nothing\" is not supported (")) << feature.directive;
    }
    for (const PbrtFeature& feature : pbrt_replacements()) {
        for (const std::string_view type : feature.types)
            EXPECT_THAT(message(feature, type), Not(HasSubstr(fmt::format("\"{}\" is not supported", type)))) << feature.directive;
    }
    EXPECT_THAT(list_features(), HasSubstr("  Material        diffuse conductor"));
    EXPECT_THAT(list_features(), HasSubstr("  Integrator      simplepath simplevolpath mlt sppm\n"));
    EXPECT_THAT(list_features(), HasSubstr("  Material        phong latent:phongtransmission latent:principled\n"));
    EXPECT_THAT(list_features(), HasSubstr("KHR_lights_punctual"));
}

// One table: what it lists is named at loading, with the same words, and harmless means that a note is all.
TEST(SceneRefusals, WhatIsNotReadIsListedAndNamed) {
    const auto one_line = [](const std::string& text) { return std::regex_replace(text, std::regex("\\s+"), " "); };
    const std::string list = one_line(list_features());
    const Folder folder;
    const auto said = [&](const char* name, const std::string& text, bool is_harmless) {
        const Result<LoadedScene> scene = load_scene(folder.write(name, text));
        std::string all = scene ? "" : scene.error().message;
        for (const auto& lines : {scene ? scene->notes : std::vector<std::string>{},
                                  scene && !is_harmless ? scene->warnings : std::vector<std::string>{}}) {
            for (const std::string& line : lines) all += line + "\n";
        }
        return all;
    };
    for (const UnreadFeatures& of : unread_features()) {
        const std::string why(of.why), names(of.names), kind(of.kind);
        EXPECT_THAT(list, HasSubstr(kind + (names.empty() ? " " : " " + names + ": ") + why));
        std::istringstream words(names.empty() ? "nothing" : names);
        for (std::string word; words >> word;) {
            SCOPED_TRACE(fmt::format("{} {}", kind, word));
            const auto pbrt = [&](const std::string& text) { EXPECT_THAT(said("a.pbrt", text, of.is_harmless), HasSubstr(why)); };
            const std::string value = word == "sensor" ? " \"string sensor\" \"x\"\n"
                                      : word == "iso"  ? " \"float iso\" 1\n"
                                                       : " \"bool " + word + "\" true\n";
            if (of.language == SceneLanguage::kGltf && kind == "extensions") {
                const std::string text =
                    R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 36, "uri": "data:;base64,)" + std::string(48, 'A') +
                    R"("}], "bufferViews": [{"buffer": 0, "byteLength": 36}], "accessors": [{"bufferView": 0, "componentType": 5126,
                    "count": 3, "type": "VEC3"}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                    "nodes": [{"mesh": 0}], "extensionsUsed": [")" +
                    word + "\"]}";
                EXPECT_THAT(said("a.gltf", text, of.is_harmless), HasSubstr(word + " is "));
                EXPECT_THAT(said("a.gltf", text, of.is_harmless), HasSubstr(why));
            } else if (of.language == SceneLanguage::kObj && kind != "options of maps") {
                const std::string line = kind == "colours" ? "Kd " + word + " 1" : word + " 1", in_mtl = "newmtl m\n" + line + "\n";
                if (word == "bump") continue;  // reads a picture
                folder.write("a.mtl", kind == "statements" ? "newmtl m\n" : in_mtl);
                const std::string in_obj = kind == "statements" ? line + "\n" : "";
                EXPECT_THAT(said("a.obj", "mtllib a.mtl\n" + in_obj + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", of.is_harmless),
                            HasSubstr(of.is_usual ? "" : why));
            } else if (of.language == SceneLanguage::kPbrtV4 && kind == "Option") {
                pbrt("Option \"" + word + "\" true\nWorldBegin\nShape \"sphere\"\n");
            } else if (of.language == SceneLanguage::kPbrtV4 && names.empty()) {
                pbrt(kind + " \"x\"\nWorldBegin\nShape \"sphere\"\n");
            } else if (kind == "Film" || kind == "Integrator") {
                const bool is_v3 = of.language == SceneLanguage::kPbrtV3, is_film = kind == "Film";
                pbrt(fmt::format("Film \"{}\"{}{}WorldBegin\nShape \"sphere\"\n", is_v3 ? "image" : "rgb", is_film ? value : "\n",
                                 is_film ? "" : "Integrator \"path\"" + value));
            } else if (kind == "Camera type" || kind == "Integrator type") {
                pbrt(fmt::format("{} \"{}\"\nWorldBegin\nShape \"sphere\"\n", kind.substr(0, kind.find(' ')), word));
            } else if (kind == "Shape type") {
                pbrt(fmt::format("Film \"image\"\nWorldBegin\nShape \"{}\"\n", word));
            } else if (kind == "Shape") {
                pbrt(fmt::format("Film \"{}\"\nWorldBegin\nShape \"sphere\"{}",
                                 of.language == SceneLanguage::kPbrtV3 ? "image" : "rgb", value));
            }
        }
    }
}

// Names that begin with latent: are those of the table of docs/scenes.md, those that the parsers compare with, and those that the
// project's scenes show.
TEST(SceneRefusals, EveryExtensionIsListedDocumentedAndShown) {
    using Names = std::set<std::string>;
    const auto names_in = [](const std::string& text) {
        static const std::regex name("latent:[a-z]+");
        return Names(std::sregex_token_iterator(text.begin(), text.end(), name), std::sregex_token_iterator());
    };
    const auto read = [](const std::filesystem::path& path) {
        std::ifstream file(path);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    Names read_from_scenes;
    for (const auto& entry : std::filesystem::directory_iterator(latent::testing::in_tree("render/load/pbrt"))) {
        if (entry.path().extension() == ".cpp" && entry.path().stem() != "features") read_from_scenes.merge(names_in(read(entry)));
    }
    Names seen;
    for (const auto& entry : std::filesystem::directory_iterator(latent::testing::in_tree("scenes"))) {
        if (entry.path().extension() == ".pbrt") seen.merge(names_in(read(entry)));
    }
    EXPECT_EQ(seen, read_from_scenes);
    const std::string page = read(latent::testing::in_tree("docs/scenes.md"));
    const std::size_t table = page.find("## Extensions");
    EXPECT_EQ(names_in(list_features()), read_from_scenes);
    EXPECT_EQ(names_in(page.substr(table, page.find("## Alpha") - table)), read_from_scenes);
}

TEST(SceneRefusals, ExtensionsThatContradictOthersAreRefused) {
    const auto mixture = [](const char* amount) {
        return fmt::format("Material \"mix\" \"string materials\" [ \"a\" \"b\" ] \"rgb latent:amount\" [ 1 .5 .2 ] {}\n", amount);
    };
    for (const char* amount : {"\"float amount\" .3", "\"texture amount\" \"t\""})
        EXPECT_THAT(refused_world(mixture(amount)), HasSubstr("2:1: amount and latent:amount cannot be combined"));
    EXPECT_THAT(refused_world(mixture("")), Not(HasSubstr("amount")));

    const auto camera = [](const char* rest) { return refusal(std::string("Camera \"perspective\" ") + rest + "\nWorldBegin\n"); };
    EXPECT_THAT(camera("\"float latent:focaldistances\" [ 2 3 ] \"float focaldistance\" 4"),
                HasSubstr("1:22: latent:focaldistances: cannot be combined with focaldistance"));
    for (const char* count : {"2", "[ ]", "[ 1 2 3 ]", "[ 1 2 3 4 ]"})
        EXPECT_THAT(camera(fmt::format("\"float latent:focaldistances\" {}", count).c_str()),
                    HasSubstr("latent:focaldistances: must be two distances, those of 360 nm and of 830 nm"));
    EXPECT_THAT(camera("\"float latent:focaldistances\" [ 0 1 ]"), HasSubstr("both distances must be between"));

    for (const char* light : {"LightSource \"infinite\"", "AreaLightSource \"diffuse\""})
        EXPECT_THAT(refused_world(std::string(light) + " \"blackbody latent:illuminant\" 3000"),
                    HasSubstr("2:1: latent:illuminant: is the light that a picture colours, and filename is missing"));
    EXPECT_THAT(refused_world("MakeNamedMedium \"all\" \"string type\" \"latent:sum\""),
                HasSubstr("medium \"all\": latent:media: must be the names of two media"));
    EXPECT_THAT(refused_world("MakeNamedMedium \"all\" \"string type\" \"latent:sum\" \"string latent:media\" [ \"all\" \"all\" ]"),
                HasSubstr("2:1: medium \"all\": is a sum of itself"));
}

// Whatever stands in the way, in whichever part of the program it would have been found.
TEST(SceneRefusals, NothingIsToldOnlyAfterTheRestIsMended) {
    const char* const text =
        "Scale 1 2 1\n"
        "Camera \"orthographic\" \"float lensradius\" .1 \"float fovv\" 3\n"
        "WorldBegin\n"
        "Material \"velvet\"\n"
        "AreaLightSource \"diffuse\"\n"
        "Shape \"cylinder\" \"float radius\" -1\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0  1 1 1 ]\n"
        "Include \"no.pbrt\"\n"
        "AttributeBegin\nScale 1 2 1\n"
        "Shape \"sphere\" \"float phimax\" 400\n"
        "AttributeEnd\n"
        "MakeNamedMaterial \"m\"\n"
        "MakeNamedMedium \"n\" \"float g\" 2\n"
        "LightSource \"laser\"\n"
        "Scale 1 0 1\n"
        "Shape \"plymesh\" \"string filename\" \"no.ply\"\n"
        "ObjectInstance \"o\"\n";
    const std::string message = refusal(text);
    for (const char* line : {":2:1: Camera: its transformation skews", ":2:1: Camera: \"lensradius\"", ":2:45: \"float fovv\"",
                             ":4:1: Material \"velvet\" is not supported", ":6:18: radius: -1",
                             ":7:1: an area light on a patch that is not a parallelogram",
                             ":8:1: ", ":11:1: an area light on a sphere that is stretched", ":11:16: phimax",
                             ":13:1: MakeNamedMaterial: \"string type\"", ":14:1: MakeNamedMedium: \"string type\"",
                             ":15:1: LightSource \"laser\"", ":17:1: ", "no.ply"}) {
        EXPECT_THAT(message, HasSubstr(line));
    }
    EXPECT_THAT(message, ::testing::Not(HasSubstr("not defined anywhere")));  // it may be in no.pbrt
}

// The warnings of a scene that is read, without the file's name: "line:column: message".
std::vector<std::string> warnings(const std::string& text, bool replace_integrator = false) {
    const Folder folder;
    const Result<LoadedScene> scene = load_scene(folder.write("room.pbrt", text), replace_integrator);
    EXPECT_TRUE(scene) << text << (scene ? "" : scene.error().message);
    std::vector<std::string> out;
    if (!scene) return out;
    for (const auto* lines : {&scene->notes, &scene->warnings}) {
        for (const std::string& line : *lines) out.push_back(line.substr(line.find("room.pbrt:") + 10));
    }
    return out;
}

TEST(SceneRefusals, WhatChangesNothingIsAWarning) {
    struct Case {
        const char *options, *world, *warning;
    };
    for (const Case& c : {
             Case{"Sampler \"halton\" \"integer pixelsamples\" 4", "", "1:1: Sampler is ignored"},
             Case{"PixelFilter \"gaussian\"", "", "1:1: PixelFilter"},
             Case{"Accelerator \"bvh\"", "", "1:1: Accelerator"},
             Case{"Option \"seed\" 3", "", "1:1: Option \"seed\" is ignored"},
             Case{"Film \"spectral\"", "", "1:1: Film \"spectral\" is ignored"},
             Case{"Film \"gbuffer\"", "", "1:1: Film \"gbuffer\" is ignored"},
             Case{"Film \"rgb\" \"string sensor\" \"canon_eos_5d\"", "",
                  "1:1: Film: ignored: \"sensor\": choose one with latent-develop"},
             Case{"Film \"rgb\" \"float iso\" 200", "", "1:1: Film: ignored: \"iso\": set the exposure"},
             Case{"Film \"rgb\" \"bool savefp16\" false \"string filename\" \"x.exr\"", "",
                  "1:12: Film: ignored: \"savefp16\", \"filename\""},
             Case{"Film \"rgb\"\n \"float cropwindow\" [ 0 .5 0 1 ]", "", "2:2: Film: ignored: \"cropwindow\""},
             Case{"Film \"rgb\" \"float maxcomponentvalue\" 9", "", "1:12: Film: ignored: \"maxcomponentvalue\""},
             Case{"Film \"rgb\" \"float diagonal\" 24", "", "1:12: Film: ignored: \"diagonal\""},
             Case{"Camera \"perspective\" \"float shutterclose\" .5", "", "1:1: Camera: the time that the shutter is open"},
             Case{"Camera \"perspective\" \"float latent:focaldistances\" [ 2 3 ]", "",
                  "1:1: Camera: latent:focaldistances has no effect without lensradius"},
             Case{"Camera \"spherical\" \"float lensradius\" .5", "", "1:20: Camera: ignored: \"lensradius\""},
             Case{"Integrator \"sppm\"", "", "1:1: Integrator \"sppm\" is replaced by \"bdpt\""},
             Case{"Integrator \"mlt\"", "", "1:1: Integrator \"mlt\""},
             Case{"Integrator \"simplepath\"", "", "1:1: Integrator \"simplepath\""},
             Case{"Integrator \"simplevolpath\"", "", "1:1: Integrator \"simplevolpath\""},
             Case{"Integrator \"path\" \"string lightsampler\" \"bvh\"", "", "1:19: Integrator: ignored: \"lightsampler\""},
             Case{"Integrator \"path\" \"float radius\" 2", "", "1:19: Integrator: ignored: \"radius\""},
             Case{"", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer faceIndices\" 0",
                  "3:53: Shape: ignored: \"faceIndices\""},
             Case{"", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"vector3 S\" [1 0 0 1 0 0 1 0 0]",
                  "3:53: S: tangents"},
             Case{"", "Material \"none\"", "3:1: Material \"none\": an old name of \"interface\""},
             Case{"", "Material \"\"", "3:1: Material \"\": an old name of \"interface\""},
         }) {
        EXPECT_THAT(warnings(std::string(c.options) + "\nWorldBegin\n" + c.world),
                    ::testing::ElementsAre(::testing::StartsWith(c.warning)))
            << c.options << c.world;
    }
}

// --strict refuses warnings, and lets notes pass.
TEST(SceneRefusals, WhatNoSampleDependsOnIsANote) {
    for (const char* scene :
         {"Film \"rgb\" \"bool savefp16\" false \"float iso\" 200\nWorldBegin", "Sampler \"halton\"\nWorldBegin",
          "PixelFilter \"box\" \"float xradius\" 2\nWorldBegin", "Accelerator \"bvh\"\nWorldBegin", "Option \"seed\" 3\nWorldBegin",
          "Integrator \"path\" \"string lightsampler\" \"bvh\"\nWorldBegin", "Integrator \"sppm\"\nWorldBegin",
          "WorldBegin\nMaterial \"none\""}) {
        const Result<LoadedScene> loaded = load(scene);
        ASSERT_TRUE(loaded) << scene;
        EXPECT_THAT(loaded->warnings, IsEmpty()) << scene;
        EXPECT_FALSE(loaded->notes.empty()) << scene;
    }
    for (const char* scene : {"Integrator \"path\" \"bool regularize\" true\nWorldBegin",
                              "Option \"disabletexturefiltering\" true\nWorldBegin", "WorldBegin\nScale 0 1 1\nShape \"sphere\""}) {
        const Result<LoadedScene> loaded = load(scene);
        ASSERT_TRUE(loaded) << scene;
        EXPECT_EQ(loaded->warnings.size(), 1u) << scene;
        EXPECT_THAT(loaded->notes, IsEmpty()) << scene;
    }
}

TEST(SceneRefusals, IntegratorsThatMakeOurPictureNeedNoWord) {
    for (const char* name : {"path", "volpath", "bdpt"}) {
        EXPECT_THAT(warnings(std::string("Integrator \"") + name + "\" \"integer maxdepth\" 3\nWorldBegin"), IsEmpty()) << name;
    }
    EXPECT_THAT(warnings("Camera \"perspective\" \"float shutteropen\" 2 \"float shutterclose\" 3\nWorldBegin"), IsEmpty());
}

TEST(SceneRefusals, MediaAreRenderedWherePbrtsPathLeavesThemOut) {
    const std::string medium = "MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\nWorldBegin\n";
    EXPECT_THAT(warnings("Integrator \"path\"\n" + medium), ElementsAre(HasSubstr("2:1: media are rendered")));
    EXPECT_THAT(warnings("Integrator \"volpath\"\n" + medium), IsEmpty());
}

TEST(SceneRefusals, IntegratorsOfAnotherPictureAreRefusedUnlessReplaced) {
    for (const char* name : {"ambientocclusion", "function", "lightpath", "randomwalk", "directlighting", "pathh", ""}) {
        const std::string text = std::string("Integrator \"") + name + "\"\nWorldBegin\n";
        EXPECT_THAT(refusal(text), HasSubstr(std::string("room.pbrt:1:1: Integrator \"") + name + "\" is not supported"));
        EXPECT_THAT(warnings(text, true), IsEmpty()) << name;
    }
    EXPECT_THAT(warnings("Integrator \"sppm\"\nWorldBegin\n", true), IsEmpty());
}

// Every word of pbrt-v4's format that is not read is refused where it stands, if the picture would be another without it.
TEST(SceneRefusals, EveryUnsupportedWordIsNamedWhereItStands) {
    std::vector<std::string> lines;
    const auto directives = [&](const std::string& kind, std::initializer_list<const char*> types) {
        for (const char* type : types) lines.push_back(kind + " \"" + type + "\"");
    };
    directives("Shape", {"curve", "nurbs"});  // a curve without points
    directives("Material", {"measured"});
    lines.push_back("Material \"subsurface\" \"string name\" \"jelly\"");
    directives("LightSource", {"goniometric", "projection"});  // without pictures
    directives("AreaLightSource", {"area"});
    lines.push_back("MakeNamedMedium \"m\" \"string type\" \"marsh\"");

    const auto parameters = [&](const std::string& directive, std::initializer_list<const char*> unsupported) {
        for (const char* parameter : unsupported) lines.push_back(directive + " " + parameter);
    };
    parameters("Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0  1 1 0 ]", {"\"string emissionfilename\" \"x.exr\""});
    parameters("Material \"diffuse\"", {"\"float sigma\" 20"});
    parameters("Material \"dielectric\"", {"\"texture eta\" \"t\"", "\"rgb reflectance\" [ 1 1 1 ]"});
    parameters("LightSource \"infinite\"", {"\"point3 portal\" [ 0 0 0 1 0 0 1 1 0 0 1 1 ]",
                                            "\"point3 portal\" [ 0 0 0 1 0 0 0 1 0 1 1 0 ]", "\"point3 portal\" [ 0 0 0 ]"});
    parameters("LightSource \"spot\"", {"\"string filename\" \"x.exr\""});
    parameters("MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 1 1] \"rgb sigma_s\" [1 1 1]",
               {"\"string preset\" \"Nothing\"", "\"float density\" 2"});
    parameters("Attribute \"shape\"", {"\"string emissionfilename\" \"x.exr\""});
    parameters("Attribute \"light\"", {"\"point3 portal\" [ 0 0 0 1 0 0 1 1 0 0 1 0 ]"});
    parameters("Option", {"\"forcediffuse\" true", "\"disablepixeljitter\" true", "\"disablewavelengthjitter\" true", "\"new\" 1"});
    lines.push_back("ActiveTransform Now");

    std::string text = "WorldBegin";
    for (const std::string& line : lines) text += "\n" + line;
    const std::string message = refusal(text);
    for (std::size_t i = 0; i < lines.size(); ++i)
        EXPECT_THAT(message, HasSubstr("room.pbrt:" + std::to_string(i + 2) + ":")) << lines[i];
    for (const char* option : {"Camera \"realistic\"", "Film \"images\"", "Camera \"perspective\" \"float fovv\" 20",
                               "Film \"rgb\" \"integer yres\" 20", "Integrator \"path\" \"integer depth\" 20"}) {
        EXPECT_THAT(refusal(std::string(option) + "\nWorldBegin"), HasSubstr("room.pbrt:1:")) << option;
    }
}

TEST(SceneRefusals, InheritedParametersThatWouldBeMissedAreRefused) {
    EXPECT_THAT(refused_world("Attribute \"light\" \"string filename\" \"x.exr\"\nAreaLightSource \"diffuse\""),
                HasSubstr("x.exr: cannot open"));
    EXPECT_THAT(refused_world("Attribute \"light\" \"float scale\" 2\nAttributeBegin\nAttribute \"light\" \"float scale\" 3"),
                HasSubstr("room.pbrt:4:19: Attribute: \"scale\" is already inherited"));
}

TEST(SceneRefusals, TangentsMatterWhereRoughnessHasADirection) {
    const std::string shape = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ] \"vector3 S\" [ 1 0 0  1 0 0  1 0 0 ]\n";
    EXPECT_THAT(refused_world("Material \"conductor\" \"float uroughness\" 0.1 \"float vroughness\" 0.2\n" + shape),
                HasSubstr("room.pbrt:3:57: S: tangents"));
}

TEST(SceneRefusals, CamerasThatCannotBeMappedAreRefusedWhereTheyStand) {
    EXPECT_THAT(refusal("Scale 1 2 1\n\n  Camera \"perspective\"\nWorldBegin"),
                AllOf(HasSubstr("room.pbrt:3:3: "), HasSubstr("skews or stretches")));
    EXPECT_THAT(refusal("Camera \"orthographic\" \"float lensradius\" .1\nWorldBegin"),
                AllOf(HasSubstr("room.pbrt:1:1: "), HasSubstr("lensradius")));
    EXPECT_THAT(refusal("\nCamera \"spherical\" \"string mapping\" \"mercator\"\nWorldBegin"), HasSubstr("room.pbrt:2:1: "));
}

}  // namespace
}  // namespace latent::render
