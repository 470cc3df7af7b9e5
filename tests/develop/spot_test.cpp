#include "tools/develop/engine/spot.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/develop/developed.h"

namespace latent::develop {
namespace {

TEST(Spot, HoldsThePositionsThatReachItAndNoOthers) {
    std::mt19937 random(5);
    for (const auto& [pixels, reach] : {std::pair{1u, 2}, {7u, 1}, {375u, 2}, {1280u, 4}, {kMaxSide, 8}}) {
        for (int i = 0; i < 200; ++i) {
            const std::int64_t from = random() % pixels, to = from + 1 + random() % (pixels - from);
            const PositionRange range = positions_reaching(from, to, pixels, reach);
            const auto reaches = [&, pixels = pixels, reach = reach](std::uint32_t position) {
                const auto j = static_cast<std::int64_t>((std::uint64_t{position} * pixels + 0x80000000u) >> 32);
                return j - reach < to && j + reach > from;
            };
            for (const std::uint32_t edge : {range.from, range.to, static_cast<std::uint32_t>(random())}) {
                for (const std::uint32_t position : {edge - 1, edge, edge + 1})  // modulo 2^32: the other end of the film
                    ASSERT_EQ(range.holds(position), reaches(position))
                        << from << ".." << to << " of " << pixels << ": " << position;
            }
        }
    }
}

// In 75 x 50 pixels, which are four cells, a pixel is reached from 4 x 4.
TEST(Spot, APixelIsThatOfTheWholeAndTakesFewOfItsRecords) {
    synthetic::Scene scene;
    scene.light_per_sample = 0.3;
    const MemoryRunSet run_set = make_runs(synthetic::make_job(sampledb::RecordKind::kXyz), 4, 1 << 17, scene);
    Settings settings = settings_for(75, 50, "quartic:-3,1.5");
    const Developed whole = develop_in_memory(run_set, settings);
    for (const PixelRect& crop : {PixelRect{0, 0, 1, 1}, {30, 20, 31, 21}, {63, 31, 64, 32}, {74, 49, 75, 50}}) {
        SCOPED_TRACE(crop.x0);
        settings.crop = crop;
        const Developed part = develop_in_memory(run_set, settings);
        for (int c = 0; c < 3; ++c) EXPECT_EQ(part.picture.at(crop.x0, crop.y0, c), whole.picture.at(crop.x0, crop.y0, c));
        const auto expected = static_cast<double>(whole.counts.camera_records) * 16 / 3750;
        EXPECT_LT(static_cast<double>(part.counts.camera_records), 1.2 * expected);
        EXPECT_GT(part.counts.camera_records, 0u);
        EXPECT_LT(4 * part.counts.pages, whole.counts.pages);
        EXPECT_EQ(part.counts.pages_decoded, part.counts.pages);
    }
}

}  // namespace
}  // namespace latent::develop
