// latent-develop as it is called: files in any order and grouping, misuse, damage, disks that fail.
#include <ImathBox.h>
#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledInputFile.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sampledb/codec/run_codec.h"
#include "sampledb/format/file_header.h"
#include "tests/develop/developed.h"
#include "tests/faults/process.h"
#include "tests/support/synthetic.h"
#include "tools/develop/kernel/splat.h"
#include "tools/develop/picture/picture.h"

namespace latent::develop {
namespace {

using sampledb::Coverage;
using sampledb::Job;
using sampledb::RecordKind;
using testing::Outcome;
using testing::read_text;

constexpr std::uint64_t kRun = synthetic::kShortRun;

class Tool : public ::testing::Test {
 protected:
    Job job_ = synthetic::make_short_job();
    testing::TemporaryFolder folder_;

    // A file that holds these runs.
    std::string file(const std::string& name, const std::vector<int>& runs) {
        std::vector<Coverage> coverages;
        for (const int run : runs) coverages.push_back(Coverage({run * kRun, (run + 1) * kRun}));
        const std::filesystem::path path = folder_ / name;
        synthetic::write_file(path, synthetic::make_file(job_, coverages).bytes);
        return path.string();
    }
    std::string out(const std::string& name) const { return (folder_ / name).string(); }

    static Outcome develop(std::vector<std::string> arguments, const std::vector<std::string>& more = {}) {
        arguments.insert(arguments.begin(), testing::tool("latent-develop"));
        arguments.insert(arguments.end(), more.begin(), more.end());
        return testing::run(arguments);
    }
};

TEST_F(Tool, ARunOfAnUnknownTransformIsLeftOutAndSaidSo) {
    const synthetic::FileBytes sound = synthetic::make_file(job_, synthetic::runs_between({0, kRun, 2 * kRun, 3 * kRun}));
    synthetic::write_file(folder_ / "a.latent", synthetic::with_transform(sound, 1, 200));
    const Outcome outcome = develop({(folder_ / "a.latent").string(), "-o", out("a.exr"), "--size", "60"});
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("unknown transform 200"), std::string::npos) << outcome.err;
    ASSERT_EQ(develop({file("b.latent", {0, 2}), "-o", out("b.exr"), "--size", "60"}).status, 0);
    EXPECT_EQ(read_text(folder_ / "a.exr"), read_text(folder_ / "b.exr"));
}

TEST_F(Tool, TheSameRunsInOneFileOrManyInAnyOrderGiveTheSameBytes) {
    const std::string all = file("all.latent", {0, 1, 2, 3, 4, 5});
    const std::string a = file("a.latent", {4, 0}), b = file("b.latent", {5}), c = file("c.latent", {3, 1, 2});
    const std::vector<std::string> options = {"--size", "330x220", "--mipmap"};
    ASSERT_EQ(develop({all, "-o", out("all.exr")}, options).status, 0);
    const std::string expected = read_text(folder_ / "all.exr");
    int i = 0;
    for (const auto& [inputs, more] : std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>>{
             {{a, b, c}, {"--threads", "1"}},
             {{c, b, a}, {"--memory", "32M"}},
             {{b, a, c}, {"--simd", std::string(simd_levels().front()), "--threads", "2"}}}) {
        const std::string name = std::to_string(i++) + ".exr";
        std::vector<std::string> arguments = inputs;
        arguments.insert(arguments.end(), {"-o", out(name)});
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = develop(arguments, options);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_TRUE(read_text(folder_ / name) == expected) << name;
    }
}

TEST_F(Tool, TheExrSaysWhatItsNumbersMean) {
    const std::string in = file("in.latent", {0});
    ASSERT_EQ(develop({in, "-o", out("a.exr"), "--size", "300", "--crop", "10,20,110,70", "--compression", "zip"}).status, 0);
    const Imf::TiledInputFile exr(out("a.exr").c_str());
    const Imf::Header& header = exr.header();
    EXPECT_EQ(header.displayWindow(), Imath::Box2i({0, 0}, {299, 199}));
    EXPECT_EQ(header.dataWindow(), Imath::Box2i({10, 20}, {109, 69}));
    EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
    const Imf::Chromaticities c = Imf::chromaticities(header);
    EXPECT_EQ(c.red, Imath::V2f(1, 0));
    EXPECT_EQ(c.green, Imath::V2f(0, 1));
    EXPECT_EQ(c.blue, Imath::V2f(0, 0));
    EXPECT_EQ(c.white, Imath::V2f(1.0f / 3, 1.0f / 3));
    EXPECT_NEAR(Imf::adoptedNeutral(header).x, 0.3127, 1e-4);
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("colorInteropID").value(), "lin_ciexyzd65_scene");
    EXPECT_EQ(Imf::whiteLuminance(header), 1.0f);
}

// The spectrum L = 1 per nm where Y = 1 is 1 cd/m^2: 1 / 683 W m^-2 sr^-1 nm^-1 in every channel [Fichet21].
TEST_F(Tool, ASpectralExrIsInTheUnitThatItNames) {
    job_ = synthetic::make_short_job(RecordKind::kSpectral);
    const synthetic::Scene equal_energy{.look = synthetic::Scene::Look::kUniform, .black = 0, .light_per_sample = 0};
    synthetic::write_file(folder_ / "in.latent",
                          synthetic::make_file(job_, synthetic::runs_between({0, kRun}), true, equal_energy).bytes);
    ASSERT_EQ(develop({out("in.latent"), "-o", out("a.exr"), "--size", "3", "--spectral-bins", "4"}).status, 0);
    Imf::TiledInputFile exr(out("a.exr").c_str());
    EXPECT_EQ(exr.header().typedAttribute<Imf::StringAttribute>("emissiveUnits").value(), "W.m^-2.sr^-1.nm^-1");
    EXPECT_EQ(exr.header().typedAttribute<Imf::StringAttribute>("spectralLayoutVersion").value(), "1.0");
    for (const char* channel : {"S0.418,750nm", "S0.536,250nm", "S0.653,750nm", "S0.771,250nm"}) {
        float pixels[6] = {};
        Imf::FrameBuffer frame;
        frame.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels), sizeof(float), 3 * sizeof(float)));
        exr.setFrameBuffer(frame);
        exr.readTiles(0, 0, 0, 0);
        for (const float value : pixels) EXPECT_NEAR(683 * value, 1, 0.02) << channel;
    }
}

TEST_F(Tool, SizesFollowTheFilmAndTheNumberOfSamples) {
    const auto size = [&](const char* text) {
        const Result<Size> s = parse_size_on_film(text, job_);  // 3:2
        return s ? std::pair(s->width, s->height) : std::pair(0u, 0u);
    };
    EXPECT_EQ(size("300"), std::pair(300u, 200u));
    EXPECT_EQ(size("301"), std::pair(301u, 201u));
    EXPECT_EQ(size("302x201"), std::pair(302u, 201u));  // 201.33
    EXPECT_EQ(size("301x200"), std::pair(0u, 0u));      // 200.67
    EXPECT_EQ(size("301x203"), std::pair(0u, 0u));
    for (const char* bad : {"", "0", "x", "300x", "300x200x1", "-3", "9999999999", "300 x200", "1e-3"})
        EXPECT_EQ(size(bad), std::pair(0u, 0u)) << bad;
}

// The film is 3:2, and a run has kRun samples.
TEST_F(Tool, ThePictureIsAsLargeAsItWasRenderedForWhateverTheSamples) {
    const auto write = [&](const std::string& name, int runs, const std::string& provenance) {
        std::vector<Coverage> coverages;
        for (int run = 0; run < runs; ++run) coverages.push_back(Coverage({run * kRun, (run + 1) * kRun}));
        synthetic::write_file(folder_ / name, synthetic::make_file(job_, coverages, true, {}, provenance).bytes);
        return out(name);
    };
    const auto size = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"-o", out("a.exr"), "--force", "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = develop(arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const auto report = nlohmann::json::parse(outcome.out);
        const auto pixels = report["width"].get<double>() * report["height"].get<double>();
        EXPECT_NEAR(report["samples_per_pixel"].get<double>() * pixels, report["available_samples"].get<double>(), 1e-6 * pixels);
        return std::pair(report["width"].get<int>(), report["height"].get<int>());
    };
    for (const int runs : {1, 3}) EXPECT_EQ(size({write("a.latent", runs, R"({"resolution":[90,60]})")}), std::pair(90, 60));
    EXPECT_EQ(size({write("rounded.latent", 1, R"({"resolution":[91,61]})")}), std::pair(91, 61));
    EXPECT_EQ(size({write("square.latent", 1, R"({"resolution":[90,90]})")}), std::pair(90, 60));  // the film's shape
    // Of several files, the largest, whatever their order.
    const std::string large = write("large.latent", 2, R"({"resolution":[120,80]})");
    EXPECT_EQ(size({out("a.latent"), large, "--skip-duplicates"}), std::pair(120, 80));
    EXPECT_EQ(size({large, out("a.latent"), "--skip-duplicates"}), std::pair(120, 80));
    // A merged file says what its parts said.
    ASSERT_EQ(testing::run({testing::tool("latent-merge"), large, "-o", out("merged.latent")}).status, 0);
    EXPECT_EQ(size({out("merged.latent")}), std::pair(120, 80));
    // Files that do not say, or nonsense: at least 16 samples per pixel.
    const int width = static_cast<int>(std::floor(std::sqrt(static_cast<double>(kRun) / 16 * 1.5)));
    for (const char* nothing : {"", "{}", R"({"resolution":[0,60]})", R"({"resolution":"90x60"})", R"({"resolution":[90]})",
                                R"({"resolution":[-90,60]})", R"({"resolution":[99999999999,1]})"})
        EXPECT_EQ(size({write("old.latent", 1, nothing)}).first, width) << nothing;
}

TEST_F(Tool, ASizeThatIsOffTheFilmGetsOneThatFits) {
    job_.aspect_width = 70000, job_.aspect_height = 1;
    for (const char* text : {"1x1", "1"}) {
        const Result<Size> size = parse_size_on_film(text, job_);
        ASSERT_FALSE(size);
        EXPECT_NE(size.error().message.find("; use 70000x1"), std::string::npos) << size.error().message;
    }
    EXPECT_TRUE(parse_size_on_film("70000x1", job_));
}

TEST_F(Tool, MisuseIsNamedAndLeavesNothing) {
    const std::string in = file("in.latent", {0});
    for (const std::vector<std::string>& bad : std::vector<std::vector<std::string>>{{"--size", "300x300"},
                                                                                     {"--size", "abc"},
                                                                                     {"--crop", "0,0,9999,1"},
                                                                                     {"--crop", "5,5,5,9"},
                                                                                     {"--filter", "sinc"},
                                                                                     {"--filter", "quartic:-9"},
                                                                                     {"--observer", "cie1964"},
                                                                                     {"--observer", "foo"},
                                                                                     {"--camera-output", "xyz"},
                                                                                     {"--raw-balance", "none"},
                                                                                     {"--lens-filter", "wratten-1000"},
                                                                                     {"--lens-filter", "wratten-25"},
                                                                                     {"--filter-factor", "2"},
                                                                                     {"--filter-factor", "0"},
                                                                                     {"--spectral-bins", "471"},
                                                                                     {"--spectral-bins", "400:700:9"},
                                                                                     {"--spectral-bins", "300:700:10"},
                                                                                     {"--spectral-bins", "700:400:10"},
                                                                                     {"--spectral-bins", "400:700:-10"},
                                                                                     {"--spectral-bins", "8"},
                                                                                     {"--simd", "abacus"},
                                                                                     {"--image", "half"},
                                                                                     {"--samples", "5"}}) {
        const Outcome outcome = develop({in, "-o", out("bad.exr")}, bad);
        EXPECT_EQ(outcome.status, 2) << bad[0] << ' ' << bad[1] << ": " << outcome.err;
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    }
    EXPECT_EQ(develop({in, "-o", out("bad.exr"), "--memory", "18446744073709551615", "--mipmap"}).status, 1);
    EXPECT_EQ(develop({in, "-o", out("bad.exr"), "--spectral-bins", "8", "--observer", "cie1931"}).status, 2);
    EXPECT_EQ(develop({out("none.latent"), "-o", out("bad.exr")}).status, 1);
    EXPECT_EQ(develop({in, "-o", out("bad.png")}).status, 2);
    EXPECT_EQ(develop({"/dev/null", "-o", out("bad.exr")}).status, 1);
    EXPECT_EQ(develop({in, in, "-o", out("bad.exr")}).status, 1);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"in.latent"});
    EXPECT_EQ(develop({in, "-o", out("good.exr")}).status, 0);
    EXPECT_EQ(develop({in, "-o", out("good.exr")}).status, 1);
    EXPECT_EQ(develop({in, "-o", out("good.exr"), "--force"}).status, 0);
    const Outcome picture = develop({out("good.exr"), "-o", out("better.exr")});
    EXPECT_EQ(picture.status, 1);
    EXPECT_NE(picture.err.find("printed by latent-convert"), std::string::npos) << picture.err;
    EXPECT_EQ(folder_.names(), (std::vector<std::string>{"good.exr", "in.latent"}));
    std::ofstream(out("scene.pbrt")) << "WorldBegin\n";
    const Outcome scene = develop({out("scene.pbrt"), "-o", out("better.exr")});
    EXPECT_EQ(scene.status, 1);
    EXPECT_NE(scene.err.find("latent-render scene.pbrt -o scene.latent"), std::string::npos) << scene.err;
}

TEST_F(Tool, ObserversAreListedWithTheirSources) {
    const Outcome outcome = develop({"--list-observers"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const char* text : {"\n  canon_eos_5d ", "\n  kodak_trix_400 ", "\n  wratten-25 ", "source: Darrodi et al. 2015"})
        EXPECT_NE(outcome.out.find(text), std::string::npos) << text;
}

// What a camera's picture is made of, and what turns it into XYZ.
TEST_F(Tool, ARawPictureNamesTheMatrixOfItsCamera) {
    job_ = synthetic::make_short_job(RecordKind::kSpectral);
    const std::string in = file("in.latent", {0});
    const Outcome outcome = develop({in, "-o", out("raw.exr"), "--size", "30", "--observer", "canon_eos_5d", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Imf::TiledInputFile exr(out("raw.exr").c_str());
    EXPECT_EQ(exr.header().typedAttribute<Imf::StringAttribute>("latentObserver").value(), "canon_eos_5d");
    const Imath::M44f file_matrix = Imf::RGBtoXYZ(Imf::chromaticities(exr.header()), 1);  // rows are vectors
    const auto matrix = nlohmann::json::parse(outcome.out)["camera_fit"]["xyz_from_rgb"];
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(file_matrix[j][i], matrix[i][j].get<float>(), 1e-5) << i << j;
    }
    EXPECT_NEAR(Imf::adoptedNeutral(exr.header()).x, 0.3127, 1e-4);
    ASSERT_EQ(develop({in, "-o", out("counts.exr"), "--size", "30", "--observer", "canon_eos_5d", "--raw-balance", "none"}).status,
              0);
    const Imf::TiledInputFile counts(out("counts.exr").c_str());
    EXPECT_FALSE(Imf::hasChromaticities(counts.header()));
    EXPECT_FALSE(Imf::hasAdoptedNeutral(counts.header()));
}

TEST_F(Tool, ADamagedRunIsLeftOutAndReported) {
    const std::string whole = file("whole.latent", {0, 2});
    synthetic::FileBytes damaged = synthetic::make_file(job_, synthetic::runs_between({0, kRun, 2 * kRun, 3 * kRun}));
    damaged.bytes[damaged.run_ends[0] + 1000] ^= std::byte{4};  // in a page of the second run
    synthetic::write_file(folder_ / "damaged.latent", damaged.bytes);
    const Outcome outcome = develop({out("damaged.latent"), "-o", out("damaged.exr"), "--size", "150", "--json"});
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    const auto report = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(report["samples"], (nlohmann::json{{0, kRun}, {2 * kRun, 3 * kRun}}));
    EXPECT_EQ(report["left_out"].size(), 1u);
    ASSERT_EQ(develop({whole, "-o", out("whole.exr"), "--size", "150"}).status, 0);
    EXPECT_TRUE(read_text(folder_ / "damaged.exr") == read_text(folder_ / "whole.exr"));
}

TEST_F(Tool, RecordsThatAreNotFiniteAreReported) {
    sampledb::Records records = synthetic::make_records(job_, {0, kRun}, {.black = 0});
    records.y[100] = std::numeric_limits<float>::quiet_NaN();
    const Result<Bytes> run = sampledb::encode_run(job_, Coverage({0, kRun}), records);
    Result<Bytes> bytes = sampledb::encode_file_header({job_, ""});
    ASSERT_TRUE(run && bytes);
    bytes->insert(bytes->end(), run->begin(), run->end());
    synthetic::write_file(folder_ / "nan.latent", *bytes);
    const Outcome outcome = develop({out("nan.latent"), "-o", out("nan.exr")});
    EXPECT_EQ(outcome.status, 3);
    EXPECT_NE(outcome.err.find("not finite"), std::string::npos) << outcome.err;
}

TEST_F(Tool, SamplesDevelopAsIfTheOthersWereNotThere) {
    const std::string three = file("three.latent", {0, 1, 2}), one = file("one.latent", {1});
    ASSERT_EQ(develop({three, "-o", out("a.exr"), "--size", "90", "--samples", "4096:8192"}).status, 0);
    ASSERT_EQ(develop({one, "-o", out("b.exr"), "--size", "90"}).status, 0);
    EXPECT_TRUE(pixels_of_exr(folder_ / "a.exr") == pixels_of_exr(folder_ / "b.exr"));
    EXPECT_EQ(develop({three, "-o", out("c.exr"), "--size", "90", "--samples", "100:9000"}).status, 0);  // cuts two runs
}

TEST_F(Tool, NoSamplesAreNoPictureAndMissingOnesAreNamed) {
    const std::string two = file("two.latent", {1, 3}), empty = file("empty.latent", {});  // 4096..8192, 12288..16384
    const auto develop_samples = [&](const std::string& samples, const std::vector<std::string>& more = {}) {
        return develop({two, "-o", out("a.exr"), "--size", "90", "--json", "--force", "--samples", samples}, more);
    };
    for (const char* outside : {"0:4096", "8192:12288", "16384:99999", "1000000:18446744073709551615"}) {
        const Outcome none = develop_samples(outside);
        EXPECT_EQ(develop_samples(outside, {"--crop", "0,0,9,9"}).err, none.err);
        EXPECT_EQ(none.status, 1) << none.err;
        EXPECT_EQ(none.err, std::string("latent-develop: --samples ") + outside + ": the files hold only 4096:8192, 12288:16384\n");
        EXPECT_FALSE(std::filesystem::exists(folder_ / "a.exr"));
    }
    const Outcome nothing = develop({empty, "-o", out("b.exr")});
    EXPECT_EQ(nothing.status, 1);
    EXPECT_EQ(nothing.err, "latent-develop: the files hold no samples\n");

    const Outcome part = develop_samples("5000:13000");
    EXPECT_EQ(part.status, 3);
    EXPECT_NE(part.err.find("samples 8192:12288 are in no file"), std::string::npos) << part.err;
    EXPECT_EQ(nlohmann::json::parse(part.out)["missing_samples"], (nlohmann::json{{8192, 12288}}));
    const Outcome whole = develop_samples("5000:8000");
    EXPECT_EQ(whole.status, 0) << whole.err;
    EXPECT_TRUE(nlohmann::json::parse(whole.out)["missing_samples"].empty());
}

TEST_F(Tool, TooLittleMemoryIsRefusedNamingWhatIsEnough) {
    const std::string in = file("in.latent", {0, 1});
    for (const std::string memory : {"0", "1", "1M", "4M"}) {
        for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{{}, {"--mipmap"}, {"--threads", "8"}}) {
            const Outcome small = develop({in, "-o", out("a.exr"), "--size", "300", "--memory", memory}, more);
            ASSERT_EQ(small.status, 1) << small.err;
            const std::string prefix = "latent-develop: --memory: too small; ";
            ASSERT_TRUE(small.err.starts_with(prefix)) << small.err;
            const std::string enough = small.err.substr(prefix.size(), small.err.find(" is enough") - prefix.size());
            const Outcome outcome = develop({in, "-o", out("a.exr"), "--size", "300", "--force", "--memory", enough}, more);
            EXPECT_EQ(outcome.status, 0) << enough << ": " << outcome.err;
            std::filesystem::remove(folder_ / "a.exr");
        }
    }
}

TEST_F(Tool, LittleMemoryReadsTheFileOnceAlsoWhereRunsAreCut) {
    job_.run_samples = 1 << 16;
    std::vector<Coverage> coverages;
    for (std::uint64_t run = 0; run < 16; ++run)
        coverages.push_back(Coverage({run * job_.run_samples, (run + 1) * job_.run_samples}));
    const Bytes bytes = synthetic::make_file(job_, coverages).bytes;
    synthetic::write_file(folder_ / "in.latent", bytes);
    for (const char* samples : {"0:1048576", "1:1048575", "1000:600000"}) {
        const Outcome outcome = develop({out("in.latent"), "-o", out("a.exr"), "--size", "3000", "--memory", "28M", "--threads",
                                         "2", "--samples", samples, "--json", "--force"});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        const auto report = nlohmann::json::parse(outcome.out);
        EXPECT_GE(report["regions"], 4);
        EXPECT_EQ(report["decode_factor"], 1);
        EXPECT_LE(report["bytes_read"].get<double>(), 1.05 * report["bytes_stored"].get<double>());
    }
}

TEST_F(Tool, EachRecordIsReportedOnceHoweverOftenItsPageIsDecoded) {
    std::vector<Coverage> coverages;
    for (std::uint64_t run = 0; run < 96; ++run) coverages.push_back(Coverage({run * kRun, (run + 1) * kRun}));
    synthetic::write_file(folder_ / "in.latent", synthetic::make_file(job_, coverages).bytes);
    const auto report = [&](const char* memory, const char* crop) {
        const Outcome outcome = develop({out("in.latent"), "-o", out("a.exr"), "--size", "600", "--samples", "1000:390000",
                                         "--crop", crop, "--memory", memory, "--threads", "2", "--json", "--force"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return nlohmann::json::parse(outcome.out);
    };
    const sampledb::Records records = synthetic::make_records(job_, {1000, 390000});
    const std::uint64_t light = static_cast<std::uint64_t>(std::ranges::count(records.record_class, sampledb::RecordClass::kLight));
    for (const char* crop : {"0,0,600,400", "100,50,300,399"}) {
        const auto much = report("1G", crop), little = report("18M", crop);
        EXPECT_EQ(much["decode_factor"], 1);
        EXPECT_GT(little["decode_factor"], 2);
        for (const char* key : {"camera_records", "light_records", "fallback_pixels", "empty_pixels"})
            EXPECT_EQ(little[key], much[key]) << key;
        const bool all = std::string(crop).starts_with('0');
        EXPECT_EQ(much["camera_records"] == records.size() - light, all);
        EXPECT_EQ(much["light_records"] == light, all);
    }
}

TEST_F(Tool, ASliceReportsTheRecordsOfItsOwnSamples) {
    const std::string two = file("two.latent", {0, 1});
    const auto records = [&](const std::string& samples) {
        const Outcome outcome = develop({two, "-o", out("slice.exr"), "--size", "90", "--json", "--force", "--samples", samples});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const auto report = nlohmann::json::parse(outcome.out);
        return std::array{report["camera_records"].get<std::uint64_t>(), report["light_records"].get<std::uint64_t>()};
    };
    const auto all = records("0:8192"), begin = records("0:1000"), middle = records("1000:5000"), end = records("5000:8192");
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_GT(begin[i], 0u);
        EXPECT_LT(begin[i], all[i] / 4);
        EXPECT_EQ(begin[i] + middle[i] + end[i], all[i]);
    }
}

TEST_F(Tool, ManySmallRunsAreAdvisedToBeCompactedHoweverMuchMemoryThereIs) {
    for (const std::uint64_t runs : {256u, 257u}) {
        std::vector<Coverage> coverages;
        for (std::uint64_t run = 0; run < runs; ++run) coverages.push_back(Coverage({run * kRun, run * kRun + 16}));
        synthetic::write_file(folder_ / "many.latent", synthetic::make_file(job_, coverages).bytes);
        const Outcome outcome = develop({out("many.latent"), "-o", out("many.exr"), "--size", "90", "--force", "--json"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(nlohmann::json::parse(outcome.out)["regions"], 1);
        EXPECT_EQ(outcome.err.find("257 small runs") != std::string::npos, runs > 256) << outcome.err;
    }
}

TEST_F(Tool, APictureWithoutRecordsIsBlackAndAWarningSaysWhy) {
    job_.light_paths_per_sample = 0;
    const sampledb::Records dark = synthetic::make_records(job_, {0, kRun}, {.light_per_sample = 0});
    const Result<Bytes> run = sampledb::encode_run(job_, Coverage({0, kRun}), dark);
    Result<Bytes> bytes = sampledb::encode_file_header({job_, ""});
    ASSERT_TRUE(run && bytes);
    bytes->insert(bytes->end(), run->begin(), run->end());
    synthetic::write_file(folder_ / "dark.latent", *bytes);
    const auto warning = [&](const std::string& in, const std::vector<std::string>& more) {
        const Outcome outcome = develop({out(in), "-o", out("black.exr"), "--size", "90", "--force"}, more);
        EXPECT_EQ(outcome.status, 3) << outcome.err;  // the file has no footer, which is told too
        return outcome.err;
    };
    EXPECT_NE(warning("dark.latent", {"--image", "light"}).find("no light records reach"), std::string::npos);
    EXPECT_EQ(warning("dark.latent", {}).find("black"), std::string::npos);
}

TEST_F(Tool, DisksThatFailAreReportedAndLeaveNoHalfPicture) {
    const std::string in = file("in.latent", {0, 1});
    const std::vector<std::string> before = folder_.names();
    const std::vector<std::string> command = {testing::tool("latent-develop"),
                                              in,
                                              "-o",
                                              out("picture.exr"),
                                              "--size",
                                              "600",
                                              "--memory",
                                              "24M",
                                              "--mipmap",
                                              "--threads",
                                              "2"};
    ASSERT_EQ(testing::run(command).status, 0);
    const std::string expected = read_text(folder_ / "picture.exr");
    std::filesystem::remove(folder_ / "picture.exr");
    for (const char* call : {"create", "read", "write", "sync", "link"}) {
        for (const char* what : {"EIO", "ENOSPC"}) {
            if (std::string(call) == "read" && std::string(what) == "ENOSPC") continue;
            for (int nth = 1;; nth += nth < 6 ? 1 : nth) {
                const std::string rule = std::string(call) + ":" + std::to_string(nth) + ":" + what;
                SCOPED_TRACE(rule);
                const testing::FaultOutcome outcome = testing::run_with_fault(command, {rule, folder_.path().string()});
                if (!outcome.happened) {
                    EXPECT_EQ(outcome.status, 0) << outcome.err;
                    std::filesystem::remove(folder_ / "picture.exr");
                    break;
                }
                if (outcome.status == 0) {  // what was asked to fail was tried again in another way
                    std::filesystem::remove(folder_ / "picture.exr");
                    continue;
                }
                EXPECT_EQ(outcome.status, 1) << outcome.err;
                EXPECT_NE(outcome.err.find(folder_.path().string()), std::string::npos) << outcome.err;
                if (std::filesystem::exists(folder_ / "picture.exr")) {  // named already when its folder could not be synced
                    EXPECT_EQ(std::string(call), "sync");
                    EXPECT_TRUE(read_text(folder_ / "picture.exr") == expected);
                    std::filesystem::remove(folder_ / "picture.exr");
                }
                EXPECT_EQ(folder_.names(), before);
            }
        }
    }
    for (const char* rule : {"write:1+:short", "read:1+:short"}) {
        EXPECT_EQ(testing::run_with_fault(command, {rule, folder_.path().string()}).status, 0) << rule;
        std::filesystem::remove(folder_ / "picture.exr");
    }
}

}  // namespace
}  // namespace latent::develop
