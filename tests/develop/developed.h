// tests/develop/developed.h: records in memory, developed into pictures in memory, and the same by brute force.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "base/parallel.h"
#include "color/observer.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/read/run_set.h"
#include "tests/support/synthetic.h"
#include "tools/develop/engine/develop.h"
#include "tools/develop/kernel/splat.h"

namespace latent::develop {

// Every form of filter, with and without negative lobes.
inline constexpr const char* kFilters[] = {"quartic",  "quartic:-5,2",       "quartic:-6,3", "quartic:-2,1.5", "quartic:-2,1",
                                           "mitchell", "mitchell-separable", "gaussian",     "gaussian:0.4,1", "lanczos",
                                           "box"};

// Encoded runs that lie in memory.
class MemoryRunSet : public sampledb::RunSet {
 public:
    explicit MemoryRunSet(const sampledb::Job& job) : job_(job) {}

    void add(const sampledb::Coverage& coverage, const sampledb::Records& records) {
        Result<Bytes> run = sampledb::encode_run(job_, coverage, records);
        ASSERT_TRUE(run) << run.error().message;
        const auto header = sampledb::decode_run_header(*run);
        ASSERT_TRUE(header);
        auto index = sampledb::decode_run_index(ByteSpan(*run).subspan(header->index_offset()), *header, job_);
        ASSERT_TRUE(index) << index.error().message;
        runs_.push_back({0, false, 0, *header, index->coverage});
        coverage_.add(coverage);
        pages_.push_back(std::make_shared<const std::vector<sampledb::PageInfo>>(std::move(index->pages)));
        bytes_.push_back(std::move(*run));
    }

    const sampledb::Job& job() const override { return job_; }
    const std::vector<std::filesystem::path>& files() const override { return files_; }
    const std::vector<sampledb::SelectedRun>& runs() const override { return runs_; }
    const sampledb::Coverage& coverage() const override { return coverage_; }
    const sampledb::RunSetReport& report() const override { return report_; }
    Result<std::shared_ptr<const std::vector<sampledb::PageInfo>>> pages(std::size_t run) const override { return pages_[run]; }
    Status read_page(std::size_t run, const sampledb::PageInfo& info, const sampledb::ColumnSet& columns,
                     sampledb::PageDecoder& decoder, sampledb::Page& page) const override;
    void will_read(std::size_t, const sampledb::PageInfo&, const sampledb::PageInfo&) const override {}
    std::uint64_t bytes_read() const override { return 0; }

 private:
    sampledb::Job job_;
    std::vector<Bytes> bytes_;
    std::vector<sampledb::SelectedRun> runs_;
    std::vector<std::shared_ptr<const std::vector<sampledb::PageInfo>>> pages_;
    sampledb::Coverage coverage_;
    std::vector<std::filesystem::path> files_;
    sampledb::RunSetReport report_;
};

// `runs` runs of `per_run` samples each, of records that `make` makes, or of a scene.
using MakeRecords = std::function<sampledb::Records(sampledb::SampleRange)>;
MemoryRunSet make_runs(const sampledb::Job& job, int runs, std::uint64_t per_run, const MakeRecords& make);
MemoryRunSet make_runs(const sampledb::Job& job, int runs, std::uint64_t per_run, const synthetic::Scene& scene);

// A picture that tiles are written to; each pixel exactly once.
class MemoryPicture final : public TileSink {
 public:
    MemoryPicture(const PixelRect& rect, int channels)
        : rect_(rect), channels_(channels), pixels_(std::size_t(rect.width() * rect.height()) * channels), tiles_(order_count()) {}
    Status write(int x, int y, std::span<const float> pixels) override;

    // Channel c of pixel (x, y) of the full film.
    float at(std::int64_t x, std::int64_t y, int c) const {
        return pixels_[((y - rect_.y0) * rect_.width() + x - rect_.x0) * channels_ + c];
    }
    const PixelRect& rect() const { return rect_; }
    const std::vector<float>& pixels() const { return pixels_; }
    const std::vector<int>& order() const { return order_; }
    void expect_complete() const { EXPECT_EQ(order_.size(), tiles_.size()); }

 private:
    std::size_t order_count() const {
        return std::size_t((rect_.width() + kTile - 1) / kTile) * std::size_t((rect_.height() + kTile - 1) / kTile);
    }

    PixelRect rect_;
    int channels_;
    std::vector<float> pixels_;
    std::vector<char> tiles_;
    std::vector<int> order_;  // tiles, as they came
};

struct Developed {
    MemoryPicture picture;
    DevelopCounts counts;
};

// Develops on `threads` threads; an empty crop means all. The job's records are XYZ, or seen by `observer`. A pixel has the values
// of RowLayout::outputs().
Developed develop_in_memory(const sampledb::RunSet& run_set, Settings settings, int threads = 2,
                            const color::Observer* observer = nullptr, const Layers& layers = {}, const LensChoice& lens = {});

// Develops with 1 GiB on one thread, and with 40 MiB on two: in more regions, and to the same bits. Returns the former.
Developed expect_same_with_little_memory(const sampledb::RunSet& run_set, Settings settings, const Layers& layers,
                                         const LensChoice& lens = {});

struct ReferencePixel {
    double value[3];
    double tolerance[3];  // 1e-6 of sum |w s| / sum |w|
};
// The definition, record by record in double precision.
std::vector<ReferencePixel> reference(const sampledb::Job& job, const sampledb::Records& records, std::uint64_t samples,
                                      const Settings& settings);

// X, Y and Z of a picture file, plane after plane.
std::vector<float> pixels_of_exr(const std::filesystem::path& path);

Settings settings_for(std::uint32_t width, std::uint32_t height, const char* filter = "quartic");

}  // namespace latent::develop
