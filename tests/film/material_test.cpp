#include "color/film/material.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/near_names.h"
#include "color/film/exposure.h"
#include "color/film/stock.h"
#include "tests/faults/process.h"

namespace latent::film {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Material, EachOfTheListHasItsTables) {
    EXPECT_EQ(materials().size(), 51u);
    for (const Material& material : materials()) {
        SCOPED_TRACE(material.name);
        const Result<Material> found = find_material(material.name, material.in_camera());
        ASSERT_TRUE(found);
        EXPECT_EQ(found->file, material.file);
        if (material.colour) {
            const Result<Stock> stock = Stock::make(material);
            ASSERT_TRUE(stock) << stock.error().message;
            EXPECT_LT(stock->separation_rms(), 0.05);
        } else {
            EXPECT_TRUE(need_table(material, "curves", {"log10_exposure"}));
            EXPECT_TRUE(need_table(material, "sensitivity", {"log10_sensitivity"}));
        }
    }
}

TEST(Material, IsFoundHoweverItsNameIsWritten) {
    for (const char* name : {"portra-400", "Portra 400", "kodak_portra_400", "Kodak Portra 400", "PORTRA400"}) {
        const Result<Material> found = find_material(name, true);
        ASSERT_TRUE(found) << name;
        EXPECT_EQ(found->name, "portra-400");
    }
    const Result<Material> misspelt = find_material("porta-400", true);
    ASSERT_FALSE(misspelt);
    EXPECT_EQ(misspelt.error().code, ErrorCode::kUsage);
    EXPECT_THAT(misspelt.error().message, AllOf(HasSubstr("portra-400"), HasSubstr("--list-films")));
    EXPECT_FALSE(find_material("portra-400", false));
    EXPECT_FALSE(find_material("endura", true));
    EXPECT_TRUE(find_material("endura", false));
}

TEST(Material, ListsNameEveryOneAndTheSource) {
    const std::string lists = list_films() + list_papers();
    for (const Material& material : materials()) {
        EXPECT_THAT(lists, HasSubstr("  " + material.name + " "));
        EXPECT_THAT(lists, HasSubstr(material.title));
    }
    EXPECT_THAT(lists, HasSubstr("spectral_film_lut"));
}

// A film of the user's own, in the form that color/data/film has.
class OwnMaterial : public ::testing::Test {
 protected:
    latent::testing::TemporaryFolder folder_;

    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
    std::string name(const std::string& material) const { return (folder_ / material).string(); }
    std::string curves(int skipped, const std::string& in_a_row = "") const {
        std::string text = "log10_exposure,r,g,b\n";
        for (int i = 0; i < 40; ++i) {
            const std::string d = std::to_string(0.2 + 0.05 * i);
            if (i == 7 && !in_a_row.empty())
                text += in_a_row + "\n";
            else if (i != skipped)
                text += std::to_string(-2 + 0.05 * i) + "," + d + "," + d + "," + d + "\n";
        }
        return text;
    }
    void SetUp() override {
        write("materials.csv",
              "name,title,file,kind,exposure_index,balance,densitometry\nmine,My Film,mine,negative,100,D55,status M\n");
        write("mine.sensitivity.csv",
              "wavelength_nm,log10_r,log10_g,log10_b\n400,-9,-9,0\n500,-9,0,-1\n600,0,-1,-9\n700,-1,-9,-9\n");
        write("mine.curves.csv", curves(-1));
        write("mine.dyes.csv",
              "wavelength_nm,cyan,magenta,yellow\n400,0.1,0.1,0.8\n450,0,0.1,1\n550,0.1,1,0.1\n650,1,0.1,0\n720,0.3,0,0\n");
    }
    std::string refused() const {
        const Result<Material> material = find_material(name("mine"), true);
        if (!material) return material.error().message;
        if (const auto exposed = film_observer(*material, 100); !exposed) return exposed.error().message;
        const Result<Stock> stock = Stock::make(*material);
        return stock ? "" : stock.error().message;
    }
};

TEST_F(OwnMaterial, IsReadFromItsFolder) { EXPECT_EQ(refused(), ""); }

TEST_F(OwnMaterial, WithoutCurvesIsRefusedByTheNameOfTheFile) {
    std::filesystem::remove(folder_ / "mine.curves.csv");
    EXPECT_THAT(refused(), AllOf(HasSubstr(name("mine.curves.csv")), HasSubstr("My Film needs it")));
}

TEST_F(OwnMaterial, WithoutALayerIsRefused) {
    write("mine.curves.csv", "log10_exposure,r,g\n-2,0.2,0.2\n-1,0.5,0.5\n");
    EXPECT_THAT(refused(), HasSubstr("has no column b"));
}

TEST_F(OwnMaterial, WithAGapIsRefusedByItsLine) {
    write("mine.curves.csv", curves(-1, "-1.65,0.5,,0.5"));
    EXPECT_THAT(refused(), AllOf(HasSubstr("line 9"), HasSubstr("3 values for 4 columns")));
    write("mine.curves.csv", curves(7));
    EXPECT_THAT(refused(), HasSubstr(name("mine.curves.csv") + ": log exposures must be 0.05 apart without gaps"));
    write("mine.curves.csv", curves(-1, "-1.65,0.5,x,0.5"));
    EXPECT_THAT(refused(), AllOf(HasSubstr("line 9"), HasSubstr("\"x\" is not a finite number")));
    write("mine.curves.csv", curves(-1, "-1.9,0.5,0.5,0.5"));
    EXPECT_THAT(refused(), AllOf(HasSubstr("line 9"), HasSubstr("must increase")));
}

TEST_F(OwnMaterial, WithCurvesThatNoFilmHasIsRefused) {
    const auto with = [&](double from, double step) {
        std::string text = "log10_exposure,r,g,b\n";
        for (int i = 0; i < 40; ++i) text += fmt::format("{},{},0.5,0.5\n", -2 + 0.05 * i, from + step * i);
        write("mine.curves.csv", text);
        return refused();
    };
    EXPECT_THAT(with(0.5, 0), HasSubstr("mine.curves.csv: r: must rise by 0.5 or more"));
    EXPECT_THAT(with(2.5, -0.05), HasSubstr("r: must rise where exposure rises, but is 2.45 at -1.95 after 2.5"));
    EXPECT_THAT(with(0.5, 1), HasSubstr("r: 10.5 is not a density from 0 to 10"));
    EXPECT_THAT(with(-1, 0.1), HasSubstr("r: -1 is not a density"));
}

TEST_F(OwnMaterial, WithColumnsInAnotherOrderIsTheSame) {
    const Result<color::Observer> before = film_observer(*find_material(name("mine"), true), 100);
    write("mine.sensitivity.csv", "wavelength_nm,log10_b,log10_r,log10_g\n400,0,-9,-9\n500,-1,-9,0\n600,-9,0,-1\n700,-9,-1,-9\n");
    const Result<color::Observer> after = film_observer(*find_material(name("mine"), true), 100);
    ASSERT_TRUE(before && after);
    for (const double nm : {450.0, 550.0, 650.0}) EXPECT_EQ(before->at(nm), after->at(nm));
    write("mine.sensitivity.csv", "log10_r,wavelength_nm,log10_g,log10_b\n-9,400,-9,0\n0,500,0,-1\n");
    EXPECT_THAT(refused(), HasSubstr("mine.sensitivity.csv: its first column must be wavelength_nm, not log10_r"));
}

TEST_F(OwnMaterial, WithALayerThatSeesNothingOrDyesOfAFewWavelengthsIsRefused) {
    write("mine.sensitivity.csv", "wavelength_nm,log10_r,log10_g,log10_b\n400,-9,-9,-9\n500,-9,0,-9\n600,0,-1,-9\n");
    EXPECT_THAT(refused(), HasSubstr(name("mine.sensitivity.csv") + ": log10_b: does not respond to D55"));
    SetUp();
    write("mine.dyes.csv", "wavelength_nm,cyan,magenta,yellow\n500,1,1,1\n520,1,1,1\n");
    EXPECT_THAT(refused(), HasSubstr(name("mine.dyes.csv") + ": goes from 500 to 520 nm"));
}

TEST_F(OwnMaterial, WithARowThatSaysNothingUsefulIsRefusedByItsLine) {
    write("materials.csv", "name,file,kind,exposure_index,balance,densitometry\nmine,mine,negative,100,D55,status Q\n");
    EXPECT_THAT(refused(), HasSubstr("line 2: densitometry: 'status Q' is not status M or status A"));
    write("materials.csv", "name,file,kind,exposure_index,balance\nmine,mine,negativ,100,D55\n");
    EXPECT_THAT(refused(), AllOf(HasSubstr("materials.csv: line 2"), HasSubstr("negativ")));
    write("materials.csv", "name,file,kind,exposure_index,balance\nmine,mine,negative,,D55\n");
    EXPECT_THAT(refused(), HasSubstr("needs an exposure_index"));
    write("materials.csv", "name,file,kind,exposure_index,balance\nmine,mine,negative,fast,D55\n");
    EXPECT_THAT(refused(), HasSubstr("'fast' is not a number"));
    write("materials.csv", "name,file,kind,exposure_index,balance\nmine,mine\n");
    EXPECT_THAT(refused(), HasSubstr("2 fields, but the first line names 5"));
}

}  // namespace
}  // namespace latent::film
