// The grammar of .pbrt files: every message names file, line and column, and no input does harm.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "render/load/pbrt/directive.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::Folder;
using ::testing::HasSubstr;
using testing::load;
using testing::load_world;
using testing::refusal;

TEST(SceneText, NumbersStringsAndFlagsOfEveryTypeAreRead) {
    DirectiveReader reader(R"(Shape "sphere" "float radius" [ 1.5e-1 ] "integer n" -3 "bool b" true "string s" "a \"b\"\\"
                              "spectrum t" [ 400 1 700 2 ] "spectrum u" "metal-Au-eta" "point3 p" [1 2 3 4 5 6] # comment " [ 
                              "rgb c" [.1 +.2 3.])",
                           0);
    const auto directive = reader.next();
    ASSERT_TRUE(directive && *directive);
    const std::vector<Parameter>& p = (*directive)->parameters;
    ASSERT_EQ(p.size(), 8u);
    EXPECT_EQ(p[0].numbers, std::vector<double>{0.15});
    EXPECT_EQ(p[1].numbers, std::vector<double>{-3});
    EXPECT_EQ(p[2].flags, std::vector<bool>{true});
    EXPECT_EQ(p[3].strings, std::vector<std::string>{"a \"b\"\\"});
    EXPECT_EQ(p[4].numbers.size(), 4u);
    EXPECT_EQ(p[5].strings, std::vector<std::string>{"metal-Au-eta"});
    EXPECT_EQ(p[6].numbers.size(), 6u);
    EXPECT_EQ(p[7].numbers, (std::vector<double>{.1, .2, 3}));
    EXPECT_EQ(p[4].where.line, 2u);
    EXPECT_EQ(p[4].where.column, 31u);
    const auto end = reader.next();
    EXPECT_TRUE(end && !*end);
}

TEST(SceneText, SyntaxErrorsNameFileLineAndColumn) {
    struct Case {
        const char *text, *place, *message;
    };
    for (const Case& c : {
             Case{"WorldBegin\n  Blob 3", ":2:3: ", "\"Blob\" is not a directive"},
             Case{"Translate 1 x 3", ":1:13: ", "\"x\" is not a finite number"},
             Case{"Translate 1 inf 3", ":1:13: ", "not a finite number"},
             Case{"Scale 1 2", ":1:1: ", "Scale: a number is missing before the end of the file"},
             Case{"WorldBegin\n\n Scale 1 2\nWorldBegin", ":3:2: ", "Scale: a number is missing before \"WorldBegin\""},
             Case{"Camera\nWorldBegin", ":1:1: ", "Camera: a quoted name is missing before \"WorldBegin\""},
             Case{"Film \"rgb\" \"float iso\"\nWorldBegin", ":1:12: ", "iso: a value is missing before \"WorldBegin\""},
             Case{"Film \"rgb\" \"float iso\"\n\"float x\" 1", ":1:12: ", "iso: a value is missing before \"float x\""},
             Case{"Film \"rgb\" \"string filename\"", ":1:12: ", "a value is missing before the end of the file"},
             Case{"Film \"rgb\" \"float iso\" [ 3\nWorldBegin", ":1:12: ", "iso: ] is missing before \"WorldBegin\""},
             Case{"Film rgb", ":1:6: ", "is not a quoted name"},
             Case{"Film \"rgb\n\"", ":1:6: ", "without closing quote"},
             Case{"Film \"rgb\" \"float\" 3", ":1:12: ", "is not a parameter"},
             Case{"Film \"rgb\" \"colour c\" 3", ":1:12: ", "is not a parameter type"},
             Case{"Film \"rgb\" \"integer n\" 3.5", ":1:24: ", "32-bit integer"},
             Case{"Film \"rgb\" \"integer n\" [ 3", ":1:12: ", "n: ] is missing before the end of the file"},
             Case{"Film \"rgb\" \"bool b\" 1", ":1:21: ", "true or false"},
             Case{"Film \"rgb\" \"string s\" [ [ ]", ":1:25: ", "[ inside ["},
             Case{"Film \"\\q\"", ":1:6: ", "unknown escape"},
             Case{"Transform 1 2", ":1:11: ", "is not ["},
             Case{"ActiveTransform", ":1:1: ", "a word must follow"},
         }) {
        const std::string message = refusal(c.text);
        EXPECT_THAT(message, HasSubstr(std::string("room.pbrt") + c.place));
        EXPECT_THAT(message, HasSubstr(c.message));
    }
}

// It goes on at the next word that is a directive.
TEST(SceneText, AnErrorOfSyntaxCostsItsDirectiveAlone) {
    const std::string message = refusal(R"(Flim "rgb" "integer xresolution" 64
WorldBegin
Shpae "sphere" "float radius" 1
Shape "sphere" "float radius" "abc"
Shape "sphere" "string alpha" 3 Shape "sphere" "float radius" -1
Scale 1 2
Shape "sphere" "flaot radius" 1
Shape "sphere
Shape "disk" "float height" [ 1
Material "diffuse" "texture reflectance" "t"
Texture "t" "spectrum" "imagemap" "string filename" "a.png"
)");
    for (const char* line : {
             ":1:1: \"Flim\" is not a directive of pbrt-v4; did you mean Film?",
             ":3:1: \"Shpae\" is not a directive of pbrt-v4; did you mean Shape?",
             ":4:31: radius: its type is float, but \"abc\" is a string",
             ":5:31: alpha: \"3\" is not a quoted string",
             ":5:48: radius: -1 is not between",
             ":6:1: Scale: a number is missing before \"Shape\"",
             ":7:16: \"flaot\" is not a parameter type; did you mean float?",
             ":8:7: string without closing quote",
             ":9:14: height: ] is missing before \"Material\"",
             ":11:1: ",
         })
        EXPECT_THAT(message, HasSubstr(std::string("room.pbrt") + line));
    EXPECT_EQ(std::ranges::count(message, '\n'), 9);
}

// The beginning of the world among them.
TEST(SceneText, WhatIsLostIsNotMissedOnceMore) {
    const std::string message =
        refusal("WorldBegi\nMakeNamedMaterial \"a\" \"string type\" 3\nNamedMaterial \"a\"\nShape \"sphere\"\n");
    EXPECT_THAT(message, HasSubstr("room.pbrt:1:1: \"WorldBegi\" is not a directive"));
    EXPECT_THAT(message, HasSubstr("room.pbrt:2:37: type: \"3\" is not a quoted string"));
    EXPECT_THAT(message, HasSubstr("room.pbrt:3:1: not defined in what could be read: material \"a\""));
    EXPECT_EQ(std::ranges::count(message, '\n'), 2);
}

TEST(SceneText, MessagesOfIncludedFilesNameThem) {
    const Folder folder;
    folder.write("part.pbrt", "\nIdentity\n   Frob");
    const Result<LoadedScene> scene = load_scene(folder.write("room.pbrt", "WorldBegin\nInclude \"part.pbrt\""));
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().message, HasSubstr("part.pbrt:3:4: "));
}

TEST(SceneText, FilesThatIncludeThemselvesAndMissingFilesAreRefused) {
    EXPECT_THAT(refusal("WorldBegin\nInclude \"room.pbrt\""), HasSubstr("room.pbrt:2:1: Include: the file includes itself"));
    EXPECT_THAT(refusal("WorldBegin\nInclude \"nowhere.pbrt\""), HasSubstr(":2:1: "));
    EXPECT_THAT(refusal("WorldBegin\nInclude \".\""), HasSubstr("is a folder, not a file"));
    EXPECT_THAT(refusal("Import \"x\""), HasSubstr("must come after WorldBegin"));
    EXPECT_FALSE(load_scene("/nonexistent/room.pbrt"));
}

// Hostile input: anything is either read or refused with a place, never worse (run under asan too).
TEST(SceneText, AnyBytesAreReadOrRefused) {
    const std::string seed =
        "Film \"rgb\" \"integer xresolution\" [ 8 ]\nLookAt 0 0 3 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" "
        "39\nWorldBegin\n"
        "AttributeBegin\nMaterial \"diffuse\" \"spectrum reflectance\" [ 360 .5 830 .5 ]\nTranslate 1 2 3\n"
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 ]\nAttributeEnd\n"
        "LightSource \"point\" \"blackbody I\" 3000 \"point3 from\" [ 0 1 0 ]\n";
    ASSERT_TRUE(load(seed));
    std::mt19937 random(1);
    for (int i = 0; i < 20000; ++i) {
        std::string text = seed;
        for (int k = 0; k < 1 + i % 4 && !text.empty(); ++k) {
            const std::size_t at = random() % text.size();
            switch (random() % 4) {
                case 0:
                    text[at] = static_cast<char>(random());
                    break;
                case 1:
                    text.erase(at, 1 + random() % 9);
                    break;
                case 2:
                    text.insert(at, text.substr(random() % text.size(), random() % 40));
                    break;
                default:
                    text.resize(at + 1);
            }
        }
        DirectiveReader reader(text, 0);
        const auto lines = static_cast<std::uint32_t>(std::ranges::count(text, '\n')) + 1;
        for (auto directive = reader.next(); !directive || *directive; directive = reader.next()) {
            EXPECT_LE(directive ? (*directive)->where.line : directive.error().where.line, lines);
        }
        if (i % 100 != 0) continue;  // files are slow
        const Result<LoadedScene> scene = load(text);
        if (scene) continue;
        EXPECT_THAT(scene.error().message, HasSubstr("room.pbrt:")) << text;
    }
}

}  // namespace
}  // namespace latent::render
