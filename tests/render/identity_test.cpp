// The identity of a scene: the same for every layout, another one for every change that shapes the picture.
#include <gtest/gtest.h>

#include <map>

#include "render/scene/canonical.h"
#include "render/scene/content_hash.h"
#include "render/scene/fields.h"
#include "tests/render/scenes.h"
#include "tests/transport/measured_examples.h"

namespace latent::render {
namespace {

using testing::Folder;

enum class Which { kPicture, kLabels };

// Visits the fields of a scene, each number and each length of a list as a leaf, and changes the leaf whose turn it is.
class Mutation {
 public:
    Mutation(SceneDescription& scene, Which which, std::size_t turn)
        : scene_(scene), which_(which), counting_(which == Which::kPicture), turn_(turn) {
        each_field(scene, *this);
        std::apply([this](auto&... entries) { (mutate_each(entries), ...); }, tables(scene));
    }

    template <class... T>
    void operator()(T&... x) {
        (mutate(x), ...);
    }
    template <class... T>
    void label(T&... x) {
        counting_ = which_ == Which::kLabels;
        (mutate(x), ...);
        counting_ = which_ == Which::kPicture;
    }
    // To another entry, or to none. Within a table of things that are made of each other: to the next one alone,
    // so that none is made of itself.
    template <class T, class... I>
    void index(I&... i) {
        const auto next = [&](std::uint32_t& at) {
            if (visited_ == &table<T>(scene_)) {
                if (at == kNone && entry_ + 1 == table<T>(scene_).size()) return;
                if (is_turn()) at = at == kNone ? entry_ + 1 : kNone;
                return;
            }
            if (is_turn()) at = at == kNone ? 0 : at + 1 < table<T>(scene_).size() ? at + 1 : kNone;
        };
        (next(i), ...);
    }
    // Whether there was such a leaf.
    bool done() const { return leaf_ > turn_; }

 private:
    bool is_turn() { return counting_ && leaf_++ == turn_; }
    template <class T>
    void mutate_each(std::vector<T>& entries) {
        visited_ = &entries;
        for (entry_ = 0; entry_ < entries.size(); ++entry_) each_field(entries[entry_], *this);
        visited_ = nullptr;
    }
    template <class T>
    void mutate(T& x) {
        if constexpr (std::is_same_v<T, bool>) {
            if (is_turn()) x = !x;
        } else if constexpr (std::is_enum_v<T>) {
            if (is_turn()) x = static_cast<T>(static_cast<std::underlying_type_t<T>>(x) ^ 1);
        } else if constexpr (std::is_floating_point_v<T>) {
            if (is_turn()) x = std::nextafter(x, std::numeric_limits<T>::infinity());
        } else if constexpr (std::is_integral_v<T>) {
            if (is_turn()) ++x;
        } else {
            each_field(x, *this);
        }
    }
    void mutate(Hash128& hash) { mutate(hash.low), mutate(hash.high); }
    void mutate(SourceLocation& where) { mutate(where.line), mutate(where.column), mutate(where.file); }
    void mutate(FilmDescription& film) { mutate(film.width), mutate(film.height); }
    void mutate(std::string& text) {
        if (is_turn()) text += 'x';
    }
    void mutate(color::Spectrum& s) {
        std::vector<double> nm(s.lambda_nm().begin(), s.lambda_nm().end()), value(s.values().begin(), s.values().end());
        bool clamped = s.outside() == color::Outside::kClamped;
        const std::size_t before = leaf_;
        if (nm.empty()) nm = {400}, value = {0};
        mutate(nm.back()), mutate(value.back()), mutate(clamped);
        if (before <= turn_ && turn_ < leaf_)
            s = *color::Spectrum::from_samples(nm, value, clamped ? color::Outside::kClamped : color::Outside::kZero);
    }
    // The first and last item, and the number of items.
    template <class T>
    void mutate(std::vector<T>& items) {
        if (!items.empty()) mutate(items.front());
        if (items.size() > 1) mutate(items.back());
        if (is_turn()) items.emplace_back();
    }
    template <class T, std::size_t N>
    void mutate(std::array<T, N>& items) {
        for (T& x : items) mutate(x);
    }
    // The name and value of the first item, and the number of items.
    template <class T>
    void mutate(std::map<std::string, T, std::less<>>& items) {
        if (!items.empty()) {
            auto first = items.extract(items.begin());
            mutate(first.key()), mutate(first.mapped());
            items.insert(std::move(first));
        }
        if (is_turn()) items["another"];
    }
    template <class T>
    void mutate(std::optional<T>& x) {
        if (x) mutate(*x);
        if (is_turn()) x ? x.reset() : void(x.emplace());
    }
    template <class... T>
    void mutate(std::variant<T...>& x) {
        std::visit([this](auto& value) { this->mutate(value); }, x);
    }
    template <class T>
    void mutate(std::shared_ptr<const T>& x) {
        auto copy = x ? std::make_shared<T>(*x) : std::make_shared<T>();
        const std::size_t before = leaf_;
        if (x) mutate(*copy);
        if (!x && is_turn()) x = copy;
        if (before <= turn_ && turn_ < leaf_) x = copy;
    }

    SceneDescription& scene_;
    Which which_;
    bool counting_;
    std::size_t turn_, leaf_ = 0;
    const void* visited_ = nullptr;  // table
    std::uint32_t entry_ = 0;        // of it
};

// A scene with everything: two used entries in every table, and each optional field given once and left out once.
SceneDescription everything(const Folder& folder) {
    testing::write_exr(folder / "sky.exr", 2, 2, std::vector<float>(12, 0.5f));
    const Bytes metal = testing::MeasuredFile(testing::measured({.side = 2, .directions = 2})).bytes();
    folder.write("metal.bsdf", {reinterpret_cast<const char*>(metal.data()), metal.size()});
    const Result<LoadedScene> scene = load_scene(folder.write("all.pbrt", R"(
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [.1 .2 .3] "rgb sigma_s" [.3 .2 .1] "float g" .5
MakeNamedMedium "mist" "string type" "homogeneous" "rgb sigma_a" [.1 .1 .3] "rgb sigma_s" [.3 .3 .1]
MakeNamedMedium "dust" "string type" "uniformgrid" "integer nx" 2 "float density" [1 2]
MakeNamedMedium "fire" "string type" "uniformgrid" "float density" 1 "float temperature" 300 "float Lescale" 2
MakeNamedMedium "paint" "string type" "rgbgrid" "rgb sigma_a" [.1 .2 .3] "rgb Le" [1 1 2]
MakeNamedMedium "cloud" "string type" "cloud"
MediumInterface "fog" "fog"
Camera "perspective" "float lensradius" .1
WorldBegin
LightSource "infinite" "string filename" "sky.exr" "float illuminance" 3
LightSource "point" "float power" 3
LightSource "distant"
MakeNamedMaterial "glass" "string type" "dielectric" "float roughness" .2
Texture "a" "spectrum" "mix" "texture tex1" "b" "texture amount" "c"
Texture "b" "spectrum" "scale" "rgb tex" [.1 .2 .3] "float scale" .5
Texture "c" "float" "scale" "texture tex" "d"
Texture "d" "float" "constant" "float value" .25
MakeNamedMaterial "metal" "string type" "measured" "string filename" "metal.bsdf"
MakeNamedMaterial "shiny" "string type" "phong" "texture Kd" "a" "texture exponent" "c"
ObjectBegin "a"
  NamedMaterial "glass"
  Shape "trianglemesh" "point3 P" [0 0 0  1 0 0  0 1 0] "normal N" [0 0 1 0 0 1 0 0 1] "point2 uv" [0 0 1 0 0 1]
ObjectEnd
ObjectBegin "b"
  MediumInterface "mist" "dust"
  Shape "sphere" "float radius" 2
  MediumInterface "fire" "paint"
  Shape "sphere" "float radius" 1
  MediumInterface "cloud" ""
  Shape "sphere" "float radius" .5
ObjectEnd
ObjectInstance "a"
Translate 3 0 0
ObjectInstance "b"
Rotate 30 0 1 1
AttributeBegin
  AreaLightSource "diffuse" "float power" 5
  NamedMaterial "shiny"
  Shape "trianglemesh" "point3 P" [0 0 0  1 0 0  0 1 0]
  AreaLightSource "diffuse" "bool twosided" true
  Shape "trianglemesh" "point3 P" [0 0 0  2 0 0  0 1 0]
AttributeEnd
Shape "disk" "texture alpha" "c"
NamedMaterial "metal"
Shape "disk"
)"));
    EXPECT_TRUE(scene) << scene.error().message;
    return scene->description;
}

// The content hash of the scene with each of its leaves changed in turn.
std::vector<Hash128> hashes_of_mutants(const SceneDescription& original, Which which) {
    std::vector<Hash128> hashes;
    while (true) {
        SceneDescription scene = original;
        if (!Mutation(scene, which, hashes.size()).done()) return hashes;
        hashes.push_back(content_hash(scene));
    }
}

TEST(Identity, EveryFieldThatShapesThePictureShapesIt) {
    const Folder folder;
    const SceneDescription scene = everything(folder);
    const std::vector<Hash128> mutants = hashes_of_mutants(scene, Which::kPicture);
    std::map<Hash128, std::size_t> seen{{content_hash(scene), mutants.size()}};
    for (std::size_t i = 0; i < mutants.size(); ++i) {
        const auto [same, is_new] = seen.emplace(mutants[i], i);
        EXPECT_TRUE(is_new) << "leaf " << i << " of " << mutants.size() << " is as " << same->second;
    }
    EXPECT_GT(mutants.size(), 300u);
}

TEST(Identity, NamesPlacesInFilesAndWhatTheJobSaysItselfDoNotCount) {
    const Folder folder;
    const SceneDescription scene = everything(folder);
    const std::vector<Hash128> mutants = hashes_of_mutants(scene, Which::kLabels);
    for (const Hash128& hash : mutants) EXPECT_EQ(hash, content_hash(scene));
    EXPECT_GT(mutants.size(), 50u);
}

class Layouts : public ::testing::Test {
 protected:
    // Of the text after WorldBegin.
    Hash128 hash(const std::string& text, const std::string& options = "") const {
        const Result<LoadedScene> scene = load_scene(folder_.write("room.pbrt", options + "\nWorldBegin\n" + text));
        EXPECT_TRUE(scene) << scene.error().message;
        return scene ? content_hash(scene->description) : Hash128{};
    }
    Folder folder_;
};

TEST_F(Layouts, CommentsSpacesIncludesBlocksAndSpellingsOfNumbersDoNotCount) {
    folder_.write("moved.pbrt", "Translate 1 0 0\n");
    const Hash128 original = hash("Translate 1 0 0\nMaterial \"diffuse\" \"rgb reflectance\" [.5 .25 1]\nShape \"sphere\"");
    EXPECT_EQ(hash("# words\n\tTranslate 1.0 -0 0e3 Material \"diffuse\" \"rgb reflectance\" [0.50 25e-2 +1] Shape \"sphere\" "
                   "\"float radius\" 1"),
              original);
    EXPECT_EQ(hash("Include \"moved.pbrt\"\nMaterial \"diffuse\" \"rgb reflectance\" [.5 .25 1]\nShape \"sphere\"",
                   "Sampler \"sobol\"\nFilm \"rgb\" \"float iso\" 400\nPixelFilter \"box\""),
              original);
    EXPECT_EQ(hash("AttributeBegin\nAttribute \"material\" \"rgb reflectance\" [.5 .25 1]\nTranslate 2 0 0\nTranslate -1 0 0\n"
                   "Material \"diffuse\"\nAttributeBegin\nShape \"sphere\"\nAttributeEnd\nAttributeEnd"),
              original);
    EXPECT_NE(hash("Translate 1 0 1e-9\nMaterial \"diffuse\" \"rgb reflectance\" [.5 .25 1]\nShape \"sphere\""), original);
}

TEST_F(Layouts, OnlyDefinitionsThatAreUsedCountWithoutTheirNamesAndOrder) {
    const std::string glass = "\"string type\" \"dielectric\" \"spectrum eta\" \"glass-BK7\"\n",
                      wall = "\"string type\" \"diffuse\" \"rgb reflectance\" [.1 .2 .3]\n",
                      fog = "\"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 3] \"rgb sigma_s\" [1 1 1]\n";
    const auto make = [](const std::string& what, const std::string& name, const std::string& parameters) {
        return "MakeNamed" + what + " \"" + name + "\" " + parameters;
    };
    const auto shapes = [](const std::string& first, const std::string& second) {
        return first + "\nShape \"sphere\"\n" + second + "\nShape \"disk\"\n" + first + "\nShape \"disk\" \"float height\" 1\n";
    };
    const Hash128 original = hash(make("Material", "wall", wall) + make("Material", "glass", glass) +
                                  shapes("NamedMaterial \"glass\"", "NamedMaterial \"wall\""));
    EXPECT_EQ(
        hash(make("Material", "b", glass) + make("Medium", "fog", fog) + make("Material", "unused", "\"string type\" \"phong\"\n") +
             make("Material", "a", wall) + shapes("NamedMaterial \"b\"", "NamedMaterial \"a\"")),
        original);
    EXPECT_EQ(hash("ObjectBegin \"unused\"\nShape \"sphere\"\nObjectEnd\n" +
                   shapes("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"",
                          "Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3]")),
              original);
    EXPECT_NE(hash(make("Material", "wall", wall) + make("Material", "glass", glass) +
                   shapes("NamedMaterial \"wall\"", "NamedMaterial \"glass\"")),
              original);
}

TEST_F(Layouts, MeshesCountByWhatIsInThem) {
    const std::string header =
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n";
    folder_.write("ascii.ply", "ply\nformat ascii 1.0\n" + header + "0.1 0 0\n1 0.3 0\n0 1 0.7\n3 0 1 2\n");
    Bytes body;
    ByteWriter writer(body);
    for (const float x : {0.1f, 0.f, 0.f, 1.f, 0.3f, 0.f, 0.f, 1.f, 0.7f}) writer.put(x);
    writer.put(std::uint8_t{3});
    for (const std::int32_t i : {0, 1, 2}) writer.put(i);
    folder_.write("binary.ply", "ply\nformat binary_little_endian 1.0\ncomment another\n" + header +
                                    std::string(reinterpret_cast<const char*>(body.data()), body.size()));
    const std::string shape = "Translate 5.1 6.2 7.3\nRotate 33 1 2 3\nShape \"plymesh\" \"string filename\" ";
    EXPECT_EQ(hash(shape + "\"ascii.ply\""), hash(shape + "\"binary.ply\""));
    EXPECT_EQ(hash("Shape \"trianglemesh\" \"point3 P\" [1 0 0  0 1 0  0 0 1]"),
              hash("Translate 1 0 0\nShape \"trianglemesh\" \"point3 P\" [0 0 0  -1 1 0  -1 0 1]"));
}

TEST_F(Layouts, TheOrderOfShapesAndLightsCounts) {
    const std::string sphere = "Shape \"sphere\"\n", disk = "Shape \"disk\"\n", point = "LightSource \"point\"\n",
                      sun = "LightSource \"distant\"\n";
    EXPECT_NE(hash(sphere + disk), hash(disk + sphere));
    EXPECT_NE(hash(point + sun), hash(sun + point));
    EXPECT_EQ(hash(sphere + point), hash(point + sphere));
}

// Where content hashes agree, so do the tables and the indices into them.
TEST_F(Layouts, OfOneContentHaveOneCanonicalDescription) {
    const auto described = [&](const std::string& text) {
        return load_scene(folder_.write("room.pbrt", "WorldBegin\n" + text))->description;
    };
    const std::string light = "AreaLightSource \"diffuse\"\n", red = "Material \"diffuse\" \"rgb reflectance\" [.5 0 0]\n",
                      sphere = "Shape \"sphere\"\n", disk = "Shape \"disk\"\n";
    SceneDescription a = described("Material \"phong\"\n" + disk + light + red + sphere + light + red + sphere),
                     b = described(
                         "MakeNamedMedium \"f\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0 0 0] \"rgb sigma_s\" "
                         "[1 1 1]\nAttributeBegin\nMaterial \"phong\"\n" +
                         disk + "AttributeEnd\n" +
                         "MakeNamedMaterial \"r\" \"string type\" \"diffuse\" \"rgb reflectance\" [.5 0 0]\n" +
                         "AttributeBegin\nAreaLightSource \"diffuse\" \"float scale\" 2\nAttributeEnd\n" + light +
                         "NamedMaterial \"r\"\n" + sphere + sphere);
    const Hash128 hash = content_hash(a);
    ASSERT_EQ(hash, content_hash(b));
    EXPECT_EQ(make_canonical(a), hash);
    EXPECT_EQ(make_canonical(b), hash);
    EXPECT_EQ(content_hash(a), hash);
    for (const SceneDescription* scene : {&a, &b}) {
        EXPECT_EQ(scene->materials.size(), 2u);
        EXPECT_EQ(scene->area_lights.size(), 1u);
        EXPECT_TRUE(scene->media.empty());
        std::vector<std::uint32_t> materials;
        for (const ShapeDescription& shape : scene->shapes) materials.push_back(shape.material);
        EXPECT_EQ(materials, (std::vector<std::uint32_t>{0, 1, 1}));
        EXPECT_EQ(scene->materials[0].type, "phong");
    }
}

}  // namespace
}  // namespace latent::render
