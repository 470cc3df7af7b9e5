// What names a job, and which samples a process renders.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "base/simd.h"
#include "render/program/arguments.h"
#include "render/program/job.h"
#include "render/program/report.h"
#include "render/program/simd.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using sampledb::SampleRange;
using testing::Folder;
using ::testing::HasSubstr;

TEST(Shards, TileTheSamplesAtRunBoundariesEvenly) {
    for (const std::uint32_t run : {1024u, 65536u}) {
        for (const std::uint64_t runs : {1u, 2u, 7u, 64u}) {
            for (const std::uint64_t rest : {0u, 1u, 1023u}) {
                for (const std::uint64_t count : {1u, 2u, 3u, 10u, 100u}) {
                    for (const std::uint64_t before : {0u, 1u}) {
                        const SampleRange all{3 * std::uint64_t{run} - before, (3 + runs) * run + rest};
                        std::uint64_t at = all.first, smallest = ~std::uint64_t{0}, largest = 0;
                        for (std::uint64_t i = 0; i < count; ++i) {
                            const SampleRange shard = shard_of(all, {i, count}, run);
                            EXPECT_EQ(shard.first, at);
                            EXPECT_TRUE(shard.first % run == 0 || shard.first == all.first || shard.first == all.end);
                            at = shard.end;
                            const std::uint64_t size = shard.empty() ? 0 : (shard.end - 1) / run - shard.first / run + 1;
                            smallest = std::min(smallest, size);
                            largest = std::max(largest, size);
                        }
                        EXPECT_EQ(at, all.end);
                        EXPECT_LE(largest - smallest, 1u);
                    }
                }
            }
        }
    }
}

TEST(Shards, HugeRangesDoNotOverflow) {
    const SampleRange all{0, (std::uint64_t{1} << 62) - 5};
    std::uint64_t at = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const SampleRange shard = shard_of(all, {i, 1000}, 1024);
        ASSERT_EQ(shard.first, at);
        at = shard.end;
    }
    EXPECT_EQ(at, all.end);
}

TEST(Arguments, AreReadOrRefusedWithAnExample) {
    EXPECT_EQ(parse_samples("65536:131072").value(), (SampleRange{65536, 131072}));
    EXPECT_EQ(parse_samples("64Ki:1M").value(), (SampleRange{65536, 1000000}));
    EXPECT_EQ(parse_shard("2/5").value().index, 2u);
    EXPECT_EQ(parse_shard("2/5").value().count, 5u);
    EXPECT_EQ(parse_resolution("640x480").value().height, 480u);
    EXPECT_EQ(parse_depth("12").value(), 12u);
    EXPECT_EQ(parse_depth("unlimited").value(), kUnlimited);
    const auto refused = [](const auto& parsed) {
        ASSERT_FALSE(parsed);
        EXPECT_EQ(parsed.error().code, ErrorCode::kUsage);
        EXPECT_THAT(parsed.error().message, HasSubstr("(try "));
    };
    for (const char* text : {"5", "9:5", "5:5", "-1:5"}) refused(parse_samples(text));
    for (const char* text : {"5/5", "0/0", "1", "0/1048577"}) refused(parse_shard(text));
    for (const char* text : {"0x5", "640", "16777217x1"}) refused(parse_resolution(text));
    for (const char* text : {"many", "-1"}) refused(parse_depth(text));
    EXPECT_EQ(parse_samples("0:4611686018427387905").error().code, ErrorCode::kUsage);
}

TEST(Simd, LevelsAreThisProcessorsOrRefused) {
    EXPECT_TRUE(choose_simd("best"));
    for (const std::string_view level : simd_levels()) EXPECT_EQ(choose_simd(level).value(), level);
    EXPECT_EQ(choose_simd("mmx").error().code, ErrorCode::kUsage);
}

class JobOf : public ::testing::Test {
 protected:
    RenderSettings settings(const std::string& film = "\"integer xresolution\" 64 \"integer yresolution\" 48") const {
        RenderSettings out;
        out.scene =
            folder_.write("room.pbrt", "Film \"rgb\" " + film +
                                           "\nCamera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\nShape \"sphere\"\n");
        return out;
    }
    static std::unique_ptr<RenderJob> job(const RenderSettings& settings) {
        Result<std::unique_ptr<RenderJob>> prepared = prepare(settings);
        EXPECT_TRUE(prepared) << (prepared ? "" : prepared.error().message);
        return std::move(*prepared);
    }
    Folder folder_;
};

TEST_F(JobOf, StrictTakesNoSceneOfWhichAnythingIsIgnoredThatSamplesMayDependOn) {
    RenderSettings strict = settings();
    strict.strict = true;
    EXPECT_TRUE(prepare(strict));
    folder_.write("room.pbrt", "Sampler \"sobol\"\nWorldBegin\nLightSource \"infinite\"\nShape \"sphere\"\n");
    EXPECT_EQ(job(strict)->warnings.size(), 1u);
    folder_.write("room.pbrt",
                  "Sampler \"sobol\"\nIntegrator \"sppm\" \"bool regularize\" true\nWorldBegin\nLightSource \"infinite\"\nShape "
                  "\"sphere\"\n");
    const Result<std::unique_ptr<RenderJob>> refused = prepare(strict);
    ASSERT_FALSE(refused);
    const std::string room = strict.scene.string();
    EXPECT_EQ(refused.error().message, room + ": refused because of --strict\n" + room +
                                           ":2:19: Integrator: ignored: \"regularize\": reflections are not blurred");
    strict.strict = false;
    EXPECT_EQ(job(strict)->warnings.size(), 3u);
}

TEST_F(JobOf, AResolutionOfAnotherShapeChangesNoShapeAndSaysSo) {
    const auto at = [&](std::uint32_t width, std::uint32_t height) {
        RenderSettings other = settings();  // of 64 x 48
        other.resolution = {width, height};
        return job(other);
    };
    for (const auto& [width, height] : {std::pair{32u, 24u}, {100u, 75u}, {33u, 25u}, {50u, 37u}, {1u, 1u}})
        EXPECT_TRUE(at(width, height)->warnings.empty()) << width << "x" << height;
    const auto other = at(96, 24);
    EXPECT_EQ(other->warnings.size(), 1u);
    EXPECT_THAT(other->warnings.at(0),
                ::testing::StartsWith("--resolution 96x24: the picture keeps the shape of the scene's film, 4:3,"));
    EXPECT_EQ(std::pair(other->job.aspect_width, other->job.aspect_height), (std::pair<std::uint32_t, std::uint32_t>(4, 3)));
    EXPECT_EQ(other->range.size(), 96 * 24 * 16u);
}

TEST_F(JobOf, AModelWithoutACameraHasTheShapeOfTheResolution) {
    RenderSettings model = settings();
    model.scene = folder_.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    model.resolution = {40, 20};
    const auto small = job(model);
    EXPECT_EQ(std::pair(small->job.aspect_width, small->job.aspect_height), (std::pair<std::uint32_t, std::uint32_t>(2, 1)));
    EXPECT_THAT(small->warnings, ::testing::IsEmpty());
    EXPECT_EQ(small->range.size(), 40 * 20 * 16u);
}

TEST_F(JobOf, EverySettingThatChangesRecordsOrRunsIsAnotherJob) {
    const RenderSettings plain = settings();
    std::set<std::string> ids{to_hex(job(plain)->job.id)};
    const auto differs = [&](auto&& change) {
        RenderSettings changed = plain;
        change(changed);
        return ids.insert(to_hex(job(changed)->job.id)).second;
    };
    EXPECT_TRUE(differs([](RenderSettings& s) { s.seed = 1; }));
    EXPECT_TRUE(differs([](RenderSettings& s) { s.max_depth = 6; }));
    EXPECT_TRUE(differs([](RenderSettings& s) { s.max_depth = kUnlimited; }));
    EXPECT_TRUE(differs([](RenderSettings& s) { s.wavelengths = 27; }));
    EXPECT_TRUE(differs([](RenderSettings& s) { s.record = sampledb::RecordKind::kXyz; }));
    EXPECT_TRUE(differs([](RenderSettings& s) { s.run_samples = 1024; }));
    EXPECT_TRUE(differs([](RenderSettings& s) { s.resolution = Resolution{128, 96}; }));
    EXPECT_TRUE(differs([](RenderSettings& s) { s.sampler = sampledb::PositionSampler::kHalton23; }));
    EXPECT_TRUE(differs([](RenderSettings& s) { s.precision = 13; }));
    EXPECT_TRUE(differs([&](RenderSettings& s) { s = settings("\"integer xresolution\" 64 \"integer yresolution\" 49"); }));
}

// Nor is the size, unless samples are spread over its pixels.
TEST_F(JobOf, HowMuchAndWhereAreNoPartOfIt) {
    RenderSettings first = settings();
    first.sampler = sampledb::PositionSampler::kHalton23;
    const auto plain = job(first);
    RenderSettings other = settings("\"integer xresolution\" 128 \"integer yresolution\" 96");  // the same aspect
    other.sampler = first.sampler;
    other.spp = 3;
    other.resolution = Resolution{1000, 10};
    other.shard = {1, 2};
    const auto same = job(other);
    EXPECT_EQ(same->job.id, plain->job.id);
    EXPECT_EQ(plain->job.aspect_width, 4u);
    EXPECT_EQ(plain->job.aspect_height, 3u);
    EXPECT_EQ(plain->range, (SampleRange{0, 16 * 64 * 48}));
    EXPECT_EQ(same->range, (SampleRange{0, 30000}));  // one run: shard 0 is empty
}

// A medium or a dispersive material that nothing uses would add dimensions to a sample.
TEST_F(JobOf, ScenesOfOneContentHaveOneIdAndTheSameRecords) {
    const std::string light = "LightSource \"infinite\"\n", shape = "Shape \"disk\" \"float radius\" 3\n",
                      area = "AreaLightSource \"diffuse\" \"spectrum L\" [500 0 501 5 502 0]\n",
                      lamp = "Shape \"sphere\" \"float radius\" 0.1\n";
    const auto of = [this](const std::string& world) {
        RenderSettings settings;
        settings.scene = folder_.write("room.pbrt", "Camera \"perspective\"\nWorldBegin\nTranslate 0 0 2\n" + world);
        return job(settings);
    };
    const auto plain = of(light + "Material \"phong\"\n" + shape + area + lamp + "Translate 1 0 0\n" + lamp);
    const auto other =
        of("MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 1 1] \"rgb sigma_s\" [1 1 1]\n"
           "Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"\nMaterial \"phong\"\n" +
           light + shape + area + lamp + "Translate 1 0 0\n" + area + lamp);
    EXPECT_EQ(other->job.id, plain->job.id);
    sampledb::Records records[2];
    RadianceFaults faults;
    for (std::uint64_t n = 0; n < 256; ++n) {
        plain->integrator->trace(n, records[0], faults);
        other->integrator->trace(n, records[1], faults);
    }
    EXPECT_EQ(records[0].power, records[1].power);
    EXPECT_GT(records[0].power.size(), 256u);
    EXPECT_NE(of(light + "Material \"phong\"\n" + shape + area + lamp)->job.id, plain->job.id);
}

TEST_F(JobOf, ProvenanceNamesEverySettingAsItWasUsed) {
    const auto of = [this](auto&& change) {
        RenderSettings changed = settings();
        change(changed);
        return nlohmann::json::parse(provenance(*job(changed), changed));
    };
    const nlohmann::json plain = of([](RenderSettings&) {});
    EXPECT_EQ(plain["integrator"], "path");
    EXPECT_EQ(plain["max_depth"], 5);  // pbrt-v4's, as the scene names none
    EXPECT_EQ(plain["record"], "spectral");
    EXPECT_EQ(plain["wavelengths"], 28);
    EXPECT_EQ(plain["spp"], 16);
    EXPECT_EQ(plain["resolution"], nlohmann::json({64, 48}));
    EXPECT_FALSE(plain.contains("connections") || plain.contains("samples") || plain.contains("shard"));
    const nlohmann::json other = of([](RenderSettings& s) {
        s.integrator = IntegratorKind::kBdpt;
        s.max_depth = kUnlimited;
        s.resolution = Resolution{1000, 750};
        s.shard = {1, 2};
    });
    EXPECT_EQ(other["integrator"], "bdpt");
    EXPECT_EQ(other["connections"], "one");
    EXPECT_EQ(other["max_depth"], "unlimited");
    EXPECT_EQ(other["resolution"], nlohmann::json({1000, 750}));
    EXPECT_EQ(other["shard"], "1/2");
    const nlohmann::json range = of([](RenderSettings& s) { s.samples = SampleRange{0, 5000}; });
    EXPECT_EQ(range["samples"], nlohmann::json({0, 5000}));
    EXPECT_FALSE(range.contains("spp"));
    EXPECT_EQ(range["resolution"], nlohmann::json({64, 48}));
}

TEST_F(JobOf, SeedsShiftFilmPositionsButForZero) {
    const auto plain = job(settings());
    EXPECT_EQ(plain->job.positions.shift_u, 0u);
    EXPECT_EQ(plain->job.positions.shift_v, 0u);
    RenderSettings seeded = settings();
    seeded.seed = 5;
    const auto other = job(seeded);
    EXPECT_NE(other->job.positions.shift_u, 0u);
    EXPECT_NE(other->job.positions.shift_v, other->job.positions.shift_u);
}

TEST_F(JobOf, MoreSamplesThanNumbersGoAreCalledTooMany) {
    for (const auto& [spp, says] : {std::pair(1e30, "too large"), {HUGE_VAL, "too large"}, {0.0, "not a number of samples"}}) {
        RenderSettings wrong = settings();
        wrong.spp = spp;
        const auto prepared = prepare(wrong);
        ASSERT_FALSE(prepared);
        EXPECT_EQ(prepared.error().code, ErrorCode::kUsage);
        EXPECT_THAT(prepared.error().message, HasSubstr(says));
    }
}

TEST_F(JobOf, RangesMayBeginAndEndAnywhere) {
    RenderSettings odd = settings();
    odd.run_samples = 4096;
    odd.samples = SampleRange{5000, 9000};
    EXPECT_EQ(job(odd)->range, (SampleRange{5000, 9000}));
    odd.shard = {1, 2};
    EXPECT_EQ(job(odd)->range, (SampleRange{8192, 9000}));
}

}  // namespace
}  // namespace latent::render
