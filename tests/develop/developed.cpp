#include "tests/develop/developed.h"

#include <algorithm>
#include <cmath>

#include "image/exr_reader.h"
#include "sampledb/codec/page_decoder.h"

namespace latent::develop {

Status MemoryRunSet::read_page(std::size_t run, const sampledb::PageInfo& info, const sampledb::ColumnSet& columns,
                               sampledb::PageDecoder& decoder, sampledb::Page& page) const {
    return decoder.decode(job_, info, ByteSpan(bytes_[run]).subspan(info.offset, info.stored_size), columns, page);
}

MemoryRunSet make_runs(const sampledb::Job& job, int runs, std::uint64_t per_run, const MakeRecords& make) {
    MemoryRunSet run_set(job);
    for (int i = 0; i < runs; ++i) {
        const sampledb::SampleRange range{i * per_run, (i + 1) * per_run};
        run_set.add(sampledb::Coverage(range), make(range));
    }
    return run_set;
}

MemoryRunSet make_runs(const sampledb::Job& job, int runs, std::uint64_t per_run, const synthetic::Scene& scene) {
    return make_runs(job, runs, per_run,
                     [&](const sampledb::SampleRange& range) { return synthetic::make_records(job, range, scene); });
}

Status MemoryPicture::write(int x, int y, std::span<const float> pixels) {
    const int per_row = static_cast<int>((rect_.width() + kTile - 1) / kTile);
    EXPECT_FALSE(tiles_[y * per_row + x]) << "tile " << x << ' ' << y << " came twice";
    tiles_[y * per_row + x] = 1;
    order_.push_back(y * per_row + x);
    const std::int64_t width = std::min<std::int64_t>(kTile, rect_.width() - x * kTile);
    const std::int64_t height = std::min<std::int64_t>(kTile, rect_.height() - y * kTile);
    EXPECT_EQ(pixels.size(), std::size_t(width * height * channels_));
    for (std::int64_t row = 0; row < height; ++row) {
        std::copy_n(&pixels[row * width * channels_], width * channels_,
                    &pixels_[((y * kTile + row) * rect_.width() + x * kTile) * channels_]);
    }
    return {};
}

Settings settings_for(std::uint32_t width, std::uint32_t height, const char* filter) {
    Settings settings;
    settings.width = width;
    settings.height = height;
    settings.crop = {0, 0, width, height};
    settings.filter = *Filter::parse(filter);
    settings.memory = std::uint64_t{64} << 20;
    settings.temporary_folder = std::filesystem::temp_directory_path();
    return settings;
}

Developed develop_in_memory(const sampledb::RunSet& run_set, Settings settings, int threads, const color::Observer* observer,
                            const Layers& layers, const LensChoice& lens) {
    auto channels = Channels::xyz(run_set.job(), observer);
    EXPECT_TRUE(channels);
    EXPECT_TRUE(channels->add_layers(run_set.job(), layers));
    EXPECT_TRUE(channels->weigh(run_set.job(), lens));
    MemoryPicture picture(settings.crop, channels->layout().outputs());
    Result<DevelopCounts> counts = DevelopCounts{};
    Threads(threads).run([&] { counts = develop(run_set, *channels, settings, picture); });
    EXPECT_TRUE(counts) << counts.error().message;
    picture.expect_complete();
    return {std::move(picture), counts ? *counts : DevelopCounts{}};
}

Developed expect_same_with_little_memory(const sampledb::RunSet& run_set, Settings settings, const Layers& layers,
                                         const LensChoice& lens) {
    settings.memory = std::uint64_t{1} << 30;
    Developed whole = develop_in_memory(run_set, settings, 1, nullptr, layers, lens);
    settings.memory = std::uint64_t{40} << 20;
    const Developed little = develop_in_memory(run_set, settings, 2, nullptr, layers, lens);
    EXPECT_GT(little.counts.regions, whole.counts.regions);
    EXPECT_EQ(little.picture.pixels(), whole.picture.pixels());
    return whole;
}

std::vector<ReferencePixel> reference(const sampledb::Job& job, const sampledb::Records& records, std::uint64_t samples,
                                      const Settings& settings) {
    const Filter& filter = settings.filter;
    const std::int64_t width = settings.width, height = settings.height;
    const int reach = filter.reach();
    struct Sums {
        double s[3] = {}, s_plus[3] = {}, s_abs[3] = {}, c = 0, c_plus = 0, w_abs = 0, light[3] = {}, light_abs[3] = {};
    };
    std::vector<Sums> sums(width * height);
    for (std::size_t i = 0; i < records.size(); ++i) {
        const bool light = records.record_class[i] == sampledb::RecordClass::kLight;
        if (light ? !settings.light : !settings.camera) continue;
        const double x = records.u[i] * 0x1p-32 * static_cast<double>(width),
                     y = records.v[i] * 0x1p-32 * static_cast<double>(height);
        const auto column = static_cast<std::int64_t>(x), row = static_cast<std::int64_t>(y);
        const double s[3] = {records.x[i], records.y[i], records.z[i]};
        double lattice = 0;
        for (int pass = light ? 0 : 1; pass < 2; ++pass) {
            for (std::int64_t py = row - reach; py <= row + reach; ++py) {
                for (std::int64_t px = column - reach; px <= column + reach; ++px) {
                    const double w = filter.weight(static_cast<double>(px) + 0.5 - x, static_cast<double>(py) + 0.5 - y);
                    if (pass == 0) lattice += w;
                    if (pass == 0 || px < 0 || py < 0 || px >= width || py >= height) continue;
                    Sums& at = sums[py * width + px];
                    if (!light) {
                        at.c += w * static_cast<double>(records.share[i]);
                        at.c_plus += std::max(w, 0.0) * static_cast<double>(records.share[i]);
                        at.w_abs += std::abs(w);
                    }
                    for (int c = 0; c < 3; ++c) {
                        if (light) {
                            at.light[c] += w / lattice * s[c];
                            at.light_abs[c] += std::abs(w / lattice * s[c]);
                        } else {
                            at.s[c] += w * s[c];
                            at.s_plus[c] += std::max(w, 0.0) * s[c];
                            at.s_abs[c] += std::abs(w * s[c]);
                        }
                    }
                }
            }
        }
    }
    const BorderShare border(filter, settings.width, settings.height);
    const double pixels = static_cast<double>(width * height);
    const double paths = static_cast<double>(samples) * job.light_paths_per_sample;
    std::vector<ReferencePixel> out(width * height);
    for (std::int64_t i = 0; i < width * height; ++i) {
        const Sums& at = sums[i];
        const auto px = static_cast<std::uint32_t>(i % width), py = static_cast<std::uint32_t>(i / width);
        const bool lobes = at.c >= 0.05 * static_cast<double>(samples) / pixels * border.camera_share(px, py);
        const double weight = lobes ? at.c : at.c_plus;
        for (int c = 0; c < 3; ++c) {
            const double camera = weight > 0 ? (lobes ? at.s[c] : at.s_plus[c]) / weight : 0;
            const double scale = paths > 0 ? pixels / paths / border.light_share(px, py) : 0;
            out[i].value[c] = camera + scale * at.light[c];
            out[i].tolerance[c] = 1e-6 * ((at.w_abs > 0 ? at.s_abs[c] / at.w_abs : 0) + scale * at.light_abs[c]);
        }
    }
    return out;
}

std::vector<float> pixels_of_exr(const std::filesystem::path& path) {
    const Result<image::ExrReader> reader = image::ExrReader::open(path);
    EXPECT_TRUE(reader) << reader.error().message;
    const image::Rect& area = reader->image().data_window;
    std::vector<float> pixels(3 * area.pixels());
    image::ExrReader::Scratch scratch;
    float* const planes = pixels.data();
    const Status read = reader->read(area, {planes, planes + area.pixels(), planes + 2 * area.pixels()},
                                     static_cast<std::size_t>(area.width()), scratch);
    EXPECT_TRUE(read) << read.error().message;
    return pixels;
}

}  // namespace latent::develop
