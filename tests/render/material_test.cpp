// Materials: loaders and closures call the inputs by the same names.
#include "render/material/material.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "render/load/pbrt/materials.h"
#include "tests/render/scenes.h"
#include "tests/transport/measured_examples.h"

namespace latent::render {
namespace {

class MaterialTest : public ::testing::Test {
 protected:
    void build(const MaterialDescription& description) {
        const Result<Textures> textures = Textures::build({}, 1 << 20, library_);
        ASSERT_TRUE(textures);
        const Material material(description, *textures, library_);
    }
    SpectrumLibrary library_;
};

TEST_F(MaterialTest, EveryTypeOfThePbrtFormatIsMadeOfInputsOfItsClosure) {
    const testing::Folder folder;
    const Bytes metal = testing::MeasuredFile(testing::measured({.side = 2, .directions = 2})).bytes();
    folder.write("metal.bsdf", {reinterpret_cast<const char*>(metal.data()), metal.size()});
    std::vector<std::string> texts = {fmt::format(R"("measured" "string filename" "{}")", (folder / "metal.bsdf").string()),
                                      R"("phong" "string latent:lobe" "retro")",
                                      R"("conductor" "string latent:lobe" "retro")",
                                      R"("conductor" "bool latent:multiscatter" true)",
                                      R"("dielectric" "bool latent:multiscatter" true)",
                                      R"("latent:principled" "bool multiscatter" true "float transmission" 0.5)",
                                      R"("latent:principled" "bool multiscatter" true "rgb sheen" [0.5 0.5 0.5])",
                                      R"("coateddiffuse" "spectrum albedo" [360 0.5 830 0.5])",
                                      R"("hair" "spectrum reflectance" [360 0.5 830 0.5])"};
    for (const std::string_view type : material_types()) {
        if (type != "mix" && type != "interface" && type != "measured") texts.push_back(fmt::format("\"{}\"", type));
    }
    for (const std::string& text : texts) {
        const Result<LoadedScene> scene = testing::load_world("Material " + text + "\nShape \"sphere\"\n");
        ASSERT_TRUE(scene) << scene.error().message;
        for (const MaterialDescription& material : scene->description.materials) EXPECT_NO_THROW(build(material)) << text;
    }
}

TEST_F(MaterialTest, NamesThatNoClosureHasAreRefused) {
    EXPECT_THROW(build({.type = "difuse"}), std::logic_error);
    EXPECT_THROW(build({.type = "diffuse", .spectra = {{"reflectence", {}}}}), std::logic_error);
    EXPECT_THROW(build({.type = "diffuse", .numbers = {{"reflectance", 1.0f}}}), std::logic_error);  // a spectrum
}

}  // namespace
}  // namespace latent::render
