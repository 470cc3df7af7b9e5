// The loop over grains with a renderer that is made up: what is asked of it, what it may do, and how it stops.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>

#include "render/program/commit_log.h"
#include "render/program/forecast.h"
#include "render/program/loop.h"
#include "tests/faults/process.h"

namespace latent::render {
namespace {

using latent::testing::TemporaryFolder;
using sampledb::SampleRange;

// One XYZ record per sample, after a pause; every 100th sample is at fault. Any of them may ask for a stop.
class FakeIntegrator final : public Integrator {
 public:
    explicit FakeIntegrator(std::chrono::microseconds pause = {}) : pause_(pause) {}
    void trace(std::uint64_t n, sampledb::Records& out, RadianceFaults& faults) const override {
        if (pause_.count() > 0) std::this_thread::sleep_for(pause_);
        if (held_up_.count() > 0 && n / sampledb::kGrainSamples == held_up_grain_) std::this_thread::sleep_for(held_up_);
        if (n % 100 == 0) ++faults.nan;
        const sampledb::FilmPosition p = sampledb::halton23(n, {sampledb::PositionSampler::kHalton23, 0, 0});
        out.sample.push_back(n);
        out.record_class.push_back(sampledb::RecordClass::kCamera);
        out.u.push_back(p.u);
        out.v.push_back(p.v);
        out.share.push_back(1);
        for (std::vector<float>* column : {&out.x, &out.y, &out.z}) column->push_back(static_cast<float>(n % 7));
        const std::lock_guard lock(mutex_);
        EXPECT_TRUE(traced_.insert(n).second) << n << " was traced twice";
        if (traced_.size() == stop_after_) *stop_ = true;
    }
    const sampledb::WavelengthDensity& density() const override { return density_; }
    std::uint32_t light_paths_per_sample() const override { return 0; }
    const std::set<std::uint64_t>& traced() const { return traced_; }
    void forget() { traced_.clear(); }
    // Sets `stop` when so many samples have been traced.
    // Each sample of this grain takes so much longer.
    void hold_up(std::uint64_t grain, std::chrono::microseconds pause) { held_up_grain_ = grain, held_up_ = pause; }
    void stop_after(std::size_t samples, std::atomic<bool>& stop) { stop_after_ = samples, stop_ = &stop; }

 private:
    std::chrono::microseconds pause_, held_up_{};
    std::uint64_t held_up_grain_ = 0;
    sampledb::WavelengthDensity density_;
    mutable std::mutex mutex_;
    mutable std::set<std::uint64_t> traced_;
    std::size_t stop_after_ = 0;
    std::atomic<bool>* stop_ = nullptr;
};

struct Fake {
    explicit Fake(SampleRange range, std::chrono::microseconds pause = {}) {
        auto owned = std::make_unique<FakeIntegrator>(pause);
        integrator = owned.get();
        job.integrator = std::move(owned);
        job.job.id = {1, 2};
        job.job.run_samples = 4096;
        job.job.positions = {sampledb::PositionSampler::kHalton23, 0, 0};
        job.range = range;
        options.output = folder / "x.latent";
        options.threads = 2;
    }
    TemporaryFolder folder;
    RenderJob job;
    FakeIntegrator* integrator;
    RenderOptions options;
    std::atomic<bool> stop{false};
};

// Alone, the slow one would sleep for 40 s.
TEST(RenderLoop, StopsWhenAnotherProcessHasFinishedThePart) {
    Fake slow({0, 4096 * 40}, std::chrono::microseconds(500)), fast({0, 4096 * 40});
    slow.options.checkpoint_seconds = 0.1;
    fast.options.output = slow.options.output;
    Result<RenderReport> report = Error{};
    std::jthread rendering([&] { report = render(slow.job, slow.options, slow.stop, {}); });
    while (slow.folder.names().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_TRUE(render(fast.job, fast.options, fast.stop, {}));
    rendering.join();
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_TRUE(report->complete && report->elsewhere);
    EXPECT_LT(report->samples, slow.job.range.size());
    EXPECT_EQ(report->committed, slow.job.range.size());
    EXPECT_EQ(slow.folder.names(), std::vector<std::string>{"x.latent"});
}

TEST(RenderLoop, TracesEverySampleOnceAndCountsFaults) {
    Fake fake({4096, 15000});
    const Result<RenderReport> report = render(fake.job, fake.options, fake.stop, {});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_TRUE(report->complete);
    EXPECT_EQ(report->samples, 15000u - 4096u);
    EXPECT_EQ(report->committed, 15000u - 4096u);
    EXPECT_EQ(fake.integrator->traced().size(), 15000u - 4096u);
    EXPECT_EQ(*fake.integrator->traced().begin(), 4096u);
    EXPECT_EQ(*fake.integrator->traced().rbegin(), 14999u);
    EXPECT_EQ(report->faults.nan, 109u);  // 4100, 4200 ... 14900
    EXPECT_EQ(fake.folder.names(), std::vector<std::string>{"x.latent"});
}

TEST(RenderLoop, TheSameCommandAgainRendersNothing) {
    Fake fake({0, 10000});
    ASSERT_TRUE(render(fake.job, fake.options, fake.stop, {})->complete);
    fake.integrator->forget();
    const Result<RenderReport> again = render(fake.job, fake.options, fake.stop, {});
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_TRUE(again->complete);
    EXPECT_TRUE(fake.integrator->traced().empty());
}

TEST(RenderLoop, EmptyShardsWriteAFile) {
    Fake fake({8192, 8192});
    const Result<RenderReport> report = render(fake.job, fake.options, fake.stop, {});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_TRUE(report->complete);
    EXPECT_EQ(fake.folder.names(), std::vector<std::string>{"x.latent"});
}

TEST(RenderLoop, StopsKeepWhatWasFinishedAndTheNextCallGoesOn) {
    Fake fake({0, 40960});
    fake.integrator->stop_after(5000, fake.stop);
    std::uint64_t committed = 0;
    int calls = 0;
    for (bool complete = false; !complete; ++calls) {
        fake.stop = false;
        fake.integrator->forget();
        const Result<RenderReport> report = render(fake.job, fake.options, fake.stop, {});
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_EQ(report->committed, committed + report->samples);  // nothing finished is lost, nothing is done twice
        EXPECT_EQ(fake.integrator->traced().size(), report->samples);
        committed = report->committed;
        complete = report->complete;
        ASSERT_LT(calls, 100);
    }
    EXPECT_EQ(committed, 40960u);
    EXPECT_GT(calls, 1);
}

TEST(RenderLoop, ProgressCountsWhatEarlierCallsCommitted) {
    Fake fake({0, 40960}, std::chrono::microseconds(20));
    fake.integrator->stop_after(20000, fake.stop);
    const Result<RenderReport> first = render(fake.job, fake.options, fake.stop, {});
    ASSERT_TRUE(first && first->committed > 0 && !first->complete);
    fake.stop = false;
    fake.integrator->forget();
    std::vector<double> parts;
    ASSERT_TRUE(render(fake.job, fake.options, fake.stop, [&](double done, const std::string&) { parts.push_back(done); }));
    ASSERT_FALSE(parts.empty());
    EXPECT_EQ(parts.front(), static_cast<double>(first->committed) / 40960);
    EXPECT_TRUE(std::ranges::is_sorted(parts));
    EXPECT_LE(parts.back(), 1);
}

TEST(CommitLog, HasOneLineForEachCommitButNoMoreThanOneInAnInterval) {
    CommitLog log(1000, 10);
    const auto at = [](double seconds) {
        return CommitLog::Clock::time_point() +
               std::chrono::duration_cast<CommitLog::Clock::duration>(std::chrono::duration<double>(seconds));
    };
    EXPECT_EQ(log.line({0, 0, 0}, at(0)), "");                                          // nothing is committed
    EXPECT_EQ(log.line({250, 0, 0}, at(0)), "committed 250 of 1000 samples (25.0 %)");  // by earlier work
    EXPECT_EQ(log.line({250, 0, 50}, at(20)), "");
    EXPECT_EQ(log.line({500, 1024, 50}, at(21)),
              "committed 500 of 1000 samples (50.0 %), 10.0s left, 50 samples/s, 1.0 KiB written");
    EXPECT_EQ(log.line({600, 1024, 50}, at(30)), "");
    EXPECT_NE(log.line({600, 1024, 50}, at(31)), "");
    EXPECT_EQ(log.line({1000, 2048, 50}, at(32), true), "committed 1000 of 1000 samples (100.0 %), 50 samples/s, 2.0 KiB written");
    EXPECT_EQ(log.line({1000, 2048, 50}, at(90), true), "");
}

TEST(RenderLoop, TheLogEndsWithAllThatIsCommitted) {
    Fake fake({0, 40960}, std::chrono::microseconds(20));
    std::vector<std::string> lines;
    fake.options.log = [&](const std::string& line) { lines.push_back(line); };
    fake.integrator->stop_after(20000, fake.stop);
    const Result<RenderReport> first = render(fake.job, fake.options, fake.stop, {});
    ASSERT_TRUE(first && first->committed > 0 && !first->complete);
    ASSERT_FALSE(lines.empty());
    EXPECT_TRUE(lines.back().starts_with("committed " + std::to_string(first->committed) + " of 40960 samples (")) << lines.back();
    fake.stop = false;
    fake.integrator->forget();
    lines.clear();
    ASSERT_TRUE(render(fake.job, fake.options, fake.stop, {}));
    ASSERT_GE(lines.size(), 2u);
    EXPECT_TRUE(lines.front().starts_with("committed " + std::to_string(first->committed) + " of 40960 samples ("))
        << lines.front();
    EXPECT_TRUE(lines.back().starts_with("committed 40960 of 40960 samples (100.0 %)")) << lines.back();
}

TEST(RenderLoop, ADryRunOfWhatWasStoppedCountsTheRestButTheWholePart) {
    Fake fake({0, 1 << 20}, std::chrono::microseconds(20));
    fake.integrator->stop_after(20000, fake.stop);
    const Result<RenderReport> first = render(fake.job, fake.options, fake.stop, {});
    ASSERT_TRUE(first && first->committed > 0 && !first->complete);
    fake.stop = false;
    fake.integrator->forget();
    const Result<Forecast> rest = forecast(fake.job, fake.options, 0.3, 1, fake.stop);
    ASSERT_TRUE(rest) << rest.error().message;
    EXPECT_EQ(rest->samples, std::uint64_t{1} << 20);
    EXPECT_EQ(rest->committed, first->committed);
    EXPECT_NEAR(static_cast<double>(rest->missing_bytes()) / static_cast<double>(rest->bytes),
                1 - static_cast<double>(first->committed) / (1 << 20), 1e-6);
}

TEST(RenderLoop, TimeLimitIsAStop) {
    Fake fake({0, std::uint64_t{1} << 31});
    fake.options.max_seconds = 0.2;
    const Result<RenderReport> report = render(fake.job, fake.options, fake.stop, {});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_FALSE(report->complete);
    EXPECT_EQ(report->committed, report->samples);
}

// Samples so slow that a grain takes minutes: a stop gives the grain up.
TEST(RenderLoop, SlowGrainsAreGivenUp) {
    Fake fake({0, 4096}, std::chrono::milliseconds(100));
    fake.integrator->stop_after(1, fake.stop);
    const Result<RenderReport> report = render(fake.job, fake.options, fake.stop, {});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_FALSE(report->complete);
    EXPECT_EQ(report->committed, 0u);
}

// While one thread is held up in a grain, the other finishes later ones, which cannot be committed without it.
TEST(RenderLoop, AForecastCountsWhatIsCommittedNotWhatIsFinished) {
    for (const std::uint64_t grain : {0, 2}) {
        Fake fake({0, 4 * sampledb::kGrainSamples});
        fake.integrator->hold_up(grain, std::chrono::milliseconds(20));
        const Result<Forecast> estimated = forecast(fake.job, fake.options, 0.2, 1, fake.stop);
        EXPECT_TRUE(fake.folder.names().empty());
        ASSERT_EQ(estimated.has_value(), grain > 0);
        if (!estimated) {
            EXPECT_EQ(estimated.error().code, ErrorCode::kStopped) << estimated.error().message;
            continue;
        }
        EXPECT_EQ(estimated->measured_samples, grain * sampledb::kGrainSamples);
        EXPECT_GE(estimated->bytes, 4 * sampledb::kGrainSamples);  // a byte per record at the least
    }
}

TEST(RenderLoop, EstimatesFromAShortTrialAndLeavesNothing) {
    Fake fake({0, std::uint64_t{1} << 30}, std::chrono::microseconds(50));
    const Result<Forecast> estimated = forecast(fake.job, fake.options, 2, 1, fake.stop);
    ASSERT_TRUE(estimated) << estimated.error().message;
    EXPECT_EQ(estimated->samples, std::uint64_t{1} << 30);
    EXPECT_GT(estimated->seconds, 1000);
    EXPECT_GT(estimated->bytes, 1'000'000'000u);  // a byte per record at the least
    EXPECT_TRUE(fake.folder.names().empty());
}

TEST(RenderLoop, AnEmptyShardIsEstimatedAtNothing) {
    Fake fake({8192, 8192});
    const Result<Forecast> estimated = forecast(fake.job, fake.options, 2, 1, fake.stop);
    ASSERT_TRUE(estimated) << estimated.error().message;
    EXPECT_EQ(estimated->samples, 0u);
    EXPECT_EQ(estimated->bytes, 0u);
}

TEST(RenderLoop, ErrorsOfTheDiskEndTheLoop) {
    Fake fake({0, 40960});
    fake.options.output = fake.folder / "no/such/folder/x.latent";
    const Result<RenderReport> report = render(fake.job, fake.options, fake.stop, {});
    ASSERT_FALSE(report);
    EXPECT_NE(report.error().message.find("folder"), std::string::npos);
}

}  // namespace
}  // namespace latent::render
