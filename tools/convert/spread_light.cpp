#include "tools/convert/spread_light.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/first_error.h"

namespace latent::convert {

using image::Rect;

namespace {

int highest(const BandPlan& plan) {
    int rows = 0;
    for (std::size_t i = 0; i < plan.band_ends.size(); ++i) rows = std::max(rows, plan.band(i).height());
    return rows;
}

// Start of the tile that holds `at`.
int tile_start(int origin, int step, int at) { return origin + (at - origin) / step * step; }

}  // namespace

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

std::size_t SpreadLight::bytes(const image::ExrImage& image, int radius, int threads) {
    return image::Convolver::bytes(radius, image.data_window) + bytes_to_read(image, image.data_window, threads);
}

Result<std::unique_ptr<SpreadLight>> SpreadLight::make(const Source& source, image::Kernel kernel, const BandPlan& print,
                                                       const std::filesystem::path& folder, int threads) {
    const image::ExrImage& image = source.reader.image();
    constexpr std::uint64_t kEnough = std::uint64_t{1} << 40;  // print's plan has room for it: bytes()
    Result<BandPlan> input = plan_bands(image, image.data_window, {}, kEnough, threads);
    if (!input) return input.error();
    image::Convolver convolver(kernel, image.data_window);
    kernel = image::Kernel(0);  // no longer needed, and large
    Result<RowFile> before = RowFile::create(folder, image.data_window, convolver.size() + highest(*input));
    if (!before) return before.error();
    Result<RowFile> after = RowFile::create(folder, print.area, convolver.step() + highest(print));
    if (!after) return after.error();
    return std::unique_ptr<SpreadLight>(
        new SpreadLight(source, std::move(convolver), print.area, std::move(*input), std::move(*before), std::move(*after)));
}

SpreadLight::SpreadLight(const Source& source, image::Convolver convolver, const Rect& wanted, BandPlan input, RowFile before,
                         RowFile after)
    : source_(source),
      convolver_(std::move(convolver)),
      wanted_(wanted),
      input_(std::move(input)),
      before_(std::move(before)),
      after_(std::move(after)) {
    made_ = tile_start(convolver_.picture().y0, convolver_.step(), wanted.y0);
    loaded_ = std::max(convolver_.picture().y0, made_ - convolver_.margin());
    while (input_.band_ends[next_band_] <= loaded_) ++next_band_;
    const auto size = static_cast<std::size_t>(convolver_.size());
    for (std::vector<float>& plane : planes_) plane.resize(size * size);
}

Status SpreadLight::prepare(const Rect& band) {
    while (made_ < band.y1) {
        if (Status s = make_tiles(made_); !s) return s;
        made_ += convolver_.step();
    }
    return {};
}

// Rows up to y1, as the file's blocks come.
Status SpreadLight::load(int y1) {
    struct Bench {
        image::ExrReader::Scratch scratch;
        std::vector<float> pixels;
    };
    tbb::enumerable_thread_specific<Bench> benches;
    FirstError error;
    while (loaded_ < y1) {
        const Rect band = input_.band(next_band_++);
        const std::vector<Rect> blocks = input_.blocks(band);
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
                    error.keep(before_.write(c, block.x0, y, {planes[c] + static_cast<std::size_t>(y - block.y0) * width, width}));
            }
        });
        if (error) return error.status();
        loaded_ = band.y1;
    }
    return {};
}

// Of the tiles that begin in row y0, what is wanted.
Status SpreadLight::make_tiles(int y0) {
    const Rect& picture = convolver_.picture();
    const int step = convolver_.step(), margin = convolver_.margin(), size = convolver_.size();
    if (Status s = load(std::min(picture.y1, y0 + step + margin)); !s) return s;
    FirstError error;
    for (int x0 = tile_start(picture.x0, step, wanted_.x0); x0 < wanted_.x1; x0 += step) {
        const Rect seen = intersect(picture, {x0 - margin, y0 - margin, x0 - margin + size, y0 - margin + size});
        const Rect tile = intersect(wanted_, {x0, y0, x0 + step, y0 + step});
        const auto row_of = [&](int y) { return static_cast<std::size_t>(y - (y0 - margin)) * static_cast<std::size_t>(size); };
        tbb::parallel_for(0, size, [&](int i) {
            const int y = y0 - margin + i;
            for (std::size_t c = 0; c < 3 && !error; ++c) {
                const std::span<float> row{&planes_[c][row_of(y)], static_cast<std::size_t>(size)};
                std::ranges::fill(row, 0.0F);
                if (y < seen.y0 || y >= seen.y1) continue;
                const auto part =
                    row.subspan(static_cast<std::size_t>(seen.x0 - (x0 - margin)), static_cast<std::size_t>(seen.width()));
                error.keep(before_.read(c, seen.x0, y, part));
                for (float& value : part) value = image::Convolver::usable(value);
            }
        });
        if (error) return error.status();
        convolver_.spread(planes_, [&](std::size_t c, const float* gained) {
            tbb::parallel_for(tile.y0, tile.y1, [&](int y) {
                if (error) return;
                std::vector<float> light(static_cast<std::size_t>(tile.width())), out(light.size());
                error.keep(before_.read(c, tile.x0, y, light));
                convolver_.join(c, tile.x0, y, light, gained + row_of(y) + (tile.x0 - (x0 - margin)), out.data());
                error.keep(after_.write(c, tile.x0, y, out));
            });
        });
        if (error) return error.status();
    }
    return {};
}

Status SpreadLight::read(const Rect& area, const std::array<float*, 3>& planes, std::size_t row_stride) const {
    for (int y = area.y0; y < area.y1; ++y) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::span<float> row{planes[c] + static_cast<std::size_t>(y - area.y0) * row_stride,
                                       static_cast<std::size_t>(area.width())};
            if (Status s = after_.read(c, area.x0, y, row); !s) return s;
        }
    }
    return {};
}

}  // namespace latent::convert
