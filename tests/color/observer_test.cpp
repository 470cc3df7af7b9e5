#include "color/observer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "color/named_spectra.h"

namespace latent::color {
namespace {

std::array<double, 3> sums(const Observer& observer) {
    std::array<double, 3> sum{};
    for (const auto& response : observer.responses()) {
        for (int i = 0; i < 3; ++i) sum[i] += response[i];
    }
    return sum;
}

// That of CIE 1931 is as tabulated; the others are scaled, so that their sums keep their ratios alone.
TEST(Observer, TablesAddUpToThePublishedSums) {
    struct Known {
        const char* name;
        std::array<double, 3> sum;
    };
    for (const Known& known : {Known{"cie1931", {106.865469, 106.856917, 106.892251}},
                               {"cie1964", {116.648519, 116.661877, 116.673980}},
                               {"cie2015-2", {113.04232, 113.04231, 113.04231}},
                               {"cie2015-10", {118.51809, 118.51809, 118.51810}}}) {
        SCOPED_TRACE(known.name);
        const auto sum = sums(*Observer::by_name(known.name));
        const double scale = std::string(known.name) == "cie1931" ? 1 : sum[1] / known.sum[1];
        const double rounded = scale == 1 ? 5.1e-6 : 1.02e-5;  // the scale is one of two rounded numbers over the other
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(sum[i] / scale, known.sum[i], rounded);
    }
}

TEST(Observer, DaylightHasOneLuminanceForAll) {
    const double y = xyz_from_spectrum(illuminant_d65(), Observer::cie1931()).y;
    for (const char* name : {"cie1964", "cie2015-2", "cie2015-10"})
        EXPECT_NEAR(xyz_from_spectrum(illuminant_d65(), *Observer::by_name(name)).y / y, 1, 1e-12) << name;
}

TEST(Observer, IsLinearBetweenTableEntriesAndZeroOutside) {
    const Observer& cie = Observer::cie1931();
    EXPECT_EQ(cie.at(555)[1], 1);
    const auto a = cie.at(600), b = cie.at(601), between = cie.at(600.25);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(between[i], 0.75 * a[i] + 0.25 * b[i], 1e-15);
    EXPECT_EQ(cie.at(360)[0], 0.0001299);
    EXPECT_GT(cie.at(830)[0], 0);
    for (const double lambda : {359.99, 830.01, -1e30, 1e30, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_EQ(cie.at(lambda), (std::array<double, 3>{}));
    }
}

TEST(Observer, EvaluatesUnevenTablesLikeTheirSpectrum) {
    const Observer film = *Observer::from_csv(
        "400.25 0.5\n400.5 0.75\n401.125,1\n425;1\n455;0.25\n456 0\n600 0\n623.75 2\n650.5 1\n680 0.125\n700 0.125\n", "film");
    const Spectrum curve = film.curve(1);
    for (double lambda = 399; lambda < 702; lambda += 0.0625) EXPECT_DOUBLE_EQ(film.at(lambda)[1], curve(lambda)) << lambda;
}

// White points of D65 and A at 1 nm, as published by the CIE for both observers.
TEST(Observer, WhitePointsAreThePublishedOnes) {
    const Chromaticity two = Observer::cie1931().neutral(), ten = Observer::by_name("cie1964")->neutral();
    EXPECT_NEAR(two.x, 0.31272, 2e-5);
    EXPECT_NEAR(two.y, 0.32903, 2e-5);
    EXPECT_NEAR(ten.x, 0.31382, 2e-5);
    EXPECT_NEAR(ten.y, 0.33100, 2e-5);
    const Chromaticity e = chromaticity(xyz_from_spectrum(Spectrum::constant(1), Observer::cie1931()));
    EXPECT_NEAR(e.x, 1.0 / 3, 5e-5);
    EXPECT_NEAR(e.y, 1.0 / 3, 5e-5);
}

// 300 to 640 nm, with 2.7 at 400 nm.
std::string film_rows() {
    std::string rows;
    for (int nm = 300; nm <= 640; nm += 20) rows += std::to_string(nm) + "," + std::to_string(2.7 - 0.002 * (nm - 400)) + "\n";
    return rows;
}

TEST(Observer, FilmIsNeutralAndAnswersToDaylightLikeTheEye) {
    const Observer film =
        *Observer::from_csv("# Tri-X or so\nwavelength_nm,log10_sensitivity\n" + film_rows() + "650,2\n660,-3\n", "film.csv");
    EXPECT_FALSE(film.is_cie1931());
    EXPECT_EQ(film.name(), "film.csv");
    const auto response = film.at(500);
    EXPECT_EQ(response[0], response[1]);
    EXPECT_EQ(response[2], response[1]);
    EXPECT_NEAR(film.at(400)[1] / film.at(650)[1], std::pow(10, 0.7), 1e-12);
    const double eye = xyz_from_spectrum(illuminant_d65(), Observer::cie1931()).y;
    EXPECT_NEAR(xyz_from_spectrum(illuminant_d65(), film).y / eye, 1, 1e-12);
    const Chromaticity neutral = film.neutral();
    EXPECT_NEAR(neutral.x, 1.0 / 3, 1e-12);
    EXPECT_NEAR(neutral.y, 1.0 / 3, 1e-12);
}

TEST(Observer, LogarithmsAreTakenToTheLastBitsOfTheirPowers) {
    std::string text = "nm,log10\n";
    for (int i = 0; i <= 300; ++i) text += std::to_string(400 + i) + "," + std::to_string(0.02 * i - 3) + "\n";
    const Observer film = *Observer::from_csv(text, "film");
    for (int i = 0; i <= 300; ++i) {
        const double expected = std::pow(10, std::stod(std::to_string(0.02 * i - 3)) - 3);
        EXPECT_NEAR(film.at(400 + i)[1] / film.at(700)[1] / expected, 1, 2e-15) << i;
    }
}

TEST(Observer, ReadsTheSameTableInAnyDress) {
    const Observer plain = *Observer::from_csv("550,0,0,0\n560,1,2,3\n570,2,3,4\n580,0,0,0\n", "a");
    for (const char* text :
         {"\xEF\xBB\xBF# c\r\nlambda, x, y, z # names\r\n\r\n550,0,0,0\r\n560, 1, 2, 3\r\n570, 2, 3, 4 # last\r\n"
          "580,0,0,0\r\n",
          "550\t0\t0\t0\n560\t1\t2\t3\n570\t2\t3\t+4\n580\t0\t0\t0",
          "  550 0 0 0\n  560 1e0 20e-1 3\n\n#\n 570;2;3;4\n580 0,0;0"}) {
        const Result<Observer> dressed = Observer::from_csv(text, "a");
        ASSERT_TRUE(dressed) << text;
        EXPECT_TRUE(std::ranges::equal(dressed->responses(), plain.responses())) << text;
    }
}

TEST(Observer, BadTablesAreRefusedWithTheirLine) {
    const auto message = [](const std::string& text) {
        const Result<Observer> observer = Observer::from_csv(text, "bad");
        return observer ? std::string("accepted") : observer.error().message;
    };
    using ::testing::HasSubstr;
    using ::testing::StartsWith;
    EXPECT_THAT(message(""), HasSubstr("at least two lines"));
    EXPECT_THAT(message("# nothing\nlambda,v\n"), HasSubstr("at least two lines"));
    EXPECT_THAT(message("400,1\n"), HasSubstr("at least two lines"));
    EXPECT_THAT(message("400,1,2\n500,1,2\n"), StartsWith("line 1: 3 columns"));
    EXPECT_THAT(message("#\n400,1\n\n500,1,2,3\n"), StartsWith("line 4: 4 columns, but the lines above have 2"));
    EXPECT_THAT(message("400,1\n500,x\n"), StartsWith("line 2: \"x\" is not a finite number"));
    EXPECT_THAT(message("400,1\n500,nan\n"), StartsWith("line 2: \"nan\""));
    EXPECT_THAT(message("400,1\n500,inf\n"), StartsWith("line 2: \"inf\""));
    EXPECT_THAT(message("400,1\n500,-0.5\n"), StartsWith("line 2: a response cannot be negative: -0.5"));
    EXPECT_THAT(message("nm,log10_s\n400,1\n500,999\n"), StartsWith("line 3: a response cannot be 10^999"));
    EXPECT_THAT(message("400,1\n400,1\n"), StartsWith("line 2: wavelengths must increase, but 400 nm follows 400 nm"));
    EXPECT_THAT(message("0.4,1\n0.5,1\n"), StartsWith("line 1: 0.4 is not a wavelength"));
    EXPECT_THAT(message("nm,v\nnm,v\n400,1\n"), StartsWith("line 2: \"nm\""));
    EXPECT_THAT(message("550,0,0,0\n560,1,0,1\n570,0,0,0\n"), HasSubstr("no response to daylight"));
    EXPECT_THAT(message("nm,r,g,b\n550,0,0,0\n560,1,1,0\n570,0,0,0\n"), HasSubstr("a channel of the camera has no response"));
}

TEST(Observer, TablesWithAGapOrThatEndTooEarlyAreRefused) {
    const auto message = [](const std::string& text) {
        const Result<Observer> observer = Observer::from_csv(text, "bad");
        return observer ? std::string("accepted") : observer.error().message;
    };
    using ::testing::StartsWith;
    const auto rows = [](int from, int to, const std::string& rest = ",1\n") {
        std::string text;
        for (int nm = from; nm <= to; nm += 10) text += std::to_string(nm) + rest;
        return text;
    };
    EXPECT_EQ(message(rows(400, 700)), "accepted");
    EXPECT_EQ(message(rows(400, 700) + "830,0\n"), "accepted");
    EXPECT_THAT(message(rows(400, 500) + rows(540, 700)),
                StartsWith("line 12: no rows between 500 and 540 nm; between 400 and 700 nm they may be at most 30 nm apart"));
    EXPECT_EQ(message(rows(400, 500) + rows(530, 700)), "accepted");
    EXPECT_EQ(message(rows(400, 500) + "501,0\n599,0\n" + rows(600, 700)), "accepted");
    EXPECT_THAT(message(rows(450, 700)),
                StartsWith("line 1: the table begins at 450 nm, where the response is 100 % of the largest"));
    EXPECT_THAT(message(rows(400, 600, ",4\n") + "610,1\n"),
                StartsWith("line 22: the table ends at 610 nm, where the response is 25 % of the largest"));
    EXPECT_EQ(message("449,0\n" + rows(450, 600) + "601,0\n"), "accepted");
    EXPECT_THAT(message("900,1\n1000,1\n"), StartsWith("line 1: the table begins at 900 nm"));
}

}  // namespace
}  // namespace latent::color
