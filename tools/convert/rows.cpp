#include "tools/convert/rows.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/first_error.h"

namespace latent::convert {

using image::Rect;

int highest(const BandPlan& plan) {
    int rows = 0;
    for (std::size_t i = 0; i < plan.band_ends.size(); ++i) rows = std::max(rows, plan.band(i).height());
    return rows;
}

Result<RowFile> RowFile::create(const std::filesystem::path& folder, const Rect& window, int rows) {
    Result<File> file = File::create_unnamed(folder);
    if (!file) return file.error();
    return RowFile(std::move(*file), window, rows);
}

std::uint64_t RowFile::place(std::size_t channel, int x, int y) const {
    const auto row = static_cast<std::uint64_t>((y - window_.y0) % rows_), width = static_cast<std::uint64_t>(window_.width());
    return sizeof(float) * ((3 * row + channel) * width + static_cast<std::uint64_t>(x - window_.x0));
}

Status RowFile::write(std::size_t channel, int x0, int y, std::span<const float> row) {
    return file_.write_all(place(channel, x0, y), std::as_bytes(row));
}

Status RowFile::read(std::size_t channel, int x0, int y, std::span<float> row) const {
    return file_.read_exact(place(channel, x0, y), std::as_writable_bytes(row));
}

Result<std::unique_ptr<Rows>> PictureRows::create(const Source& source, int first, int keep, const std::filesystem::path& folder,
                                                  int threads) {
    const image::ExrImage& image = source.reader.image();
    constexpr std::uint64_t kEnough = std::uint64_t{1} << 40;  // print's plan has room for it: spread_bytes()
    Result<BandPlan> plan = plan_bands(image, image.data_window, {}, kEnough, threads);
    if (!plan) return plan.error();
    Result<RowFile> file = RowFile::create(folder, image.data_window, keep + highest(*plan));
    if (!file) return file.error();
    return std::unique_ptr<Rows>(new PictureRows(source, std::move(*plan), first, std::move(*file)));
}

PictureRows::PictureRows(const Source& source, BandPlan plan, int first, RowFile file)
    : source_(source), plan_(std::move(plan)), file_(std::move(file)), made_(first) {
    while (plan_.band_ends[next_band_] <= made_) ++next_band_;
}

// As the file's blocks come.
Status PictureRows::make(int y1) {
    struct Bench {
        image::ExrReader::Scratch scratch;
        std::vector<float> pixels;
    };
    tbb::enumerable_thread_specific<Bench> benches;
    FirstError error;
    while (made_ < y1) {
        const Rect band = plan_.band(next_band_++);
        const std::vector<Rect> blocks = plan_.blocks(band);
        tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
            if (error) return;
            const Rect& block = blocks[i];
            Bench& bench = benches.local();
            bench.pixels.resize(3 * block.pixels());
            std::array<float*, 3> planes{};
            for (std::size_t c = 0; c < 3; ++c) planes[c] = bench.pixels.data() + c * block.pixels();
            const auto width = static_cast<std::size_t>(block.width());
            if (Status s = source_.read(block, planes, width, bench.scratch); !s) return error.set(s.error());
            for (int y = block.y0; y < block.y1 && !error; ++y) {
                for (std::size_t c = 0; c < 3; ++c)
                    error.keep(file_.write(c, block.x0, y, {planes[c] + static_cast<std::size_t>(y - block.y0) * width, width}));
            }
        });
        if (error) return error.status();
        made_ = band.y1;
    }
    return {};
}

}  // namespace latent::convert
