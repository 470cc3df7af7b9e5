#include "image/exr_tile_writer.h"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>
#include <ImfTiledOutputFile.h>

#include <algorithm>
#include <cassert>
#include <unordered_map>

#include "base/slot_file.h"
#include "image/exr_stream.h"

namespace latent::image {

namespace {

constexpr int kTile = ExrTileWriter::kTile;
constexpr int kHalf = kTile / 2;

int half_up(int n) { return (n + 1) / 2; }

class LevelsWriter final : public ExrTileWriter {
 public:
    LevelsWriter(File& file, const ExrTileSpec& spec, std::uint64_t waiting_memory)
        : spec_(spec),
          channels_(spec.channels.size()),
          stream_(file),
          quarters_(folder_of(file.path()), std::size_t{kHalf} * kHalf * channels_ * sizeof(float), waiting_memory) {
        for (int w = spec.x1 - spec.x0, h = spec.y1 - spec.y0;; w = half_up(w), h = half_up(h)) {
            levels_.push_back({w, h});
            if (!spec.mipmap || (w == 1 && h == 1)) break;
        }
    }

    Status open() {
        return stream_.guard([&] { out_ = std::make_unique<Imf::TiledOutputFile>(stream_, header(), 0); });
    }

    int tiles_x() const override { return levels_[0].tiles_x(); }
    int tiles_y() const override { return levels_[0].tiles_y(); }

    Status write(int x, int y, std::span<const float> pixels) override { return write_level(0, x, y, pixels); }

    Status finish() override {
        return stream_.guard([&] {
            out_.reset();  // writes the table of tiles; OpenEXR swallows exceptions here, the stream keeps the error
            stream_.flush();
        });
    }

 private:
    struct Level {
        int width, height;
        int tiles_x() const { return (width + kTile - 1) / kTile; }
        int tiles_y() const { return (height + kTile - 1) / kTile; }
        int tile_width(int x) const { return std::min(kTile, width - x * kTile); }
        int tile_height(int y) const { return std::min(kTile, height - y * kTile); }
    };

    Imf::Header header() const {
        const Imath::Box2i display({0, 0}, {spec_.display_width - 1, spec_.display_height - 1});
        const Imath::Box2i data({spec_.x0, spec_.y0}, {spec_.x1 - 1, spec_.y1 - 1});
        Imf::Header header(display, data, 1, {0, 0}, 1, Imf::RANDOM_Y, spec_.zip ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION);
        header.setTileDescription(
            Imf::TileDescription(kTile, kTile, spec_.mipmap ? Imf::MIPMAP_LEVELS : Imf::ONE_LEVEL, Imf::ROUND_UP));
        for (const std::string& name : spec_.channels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        if (const auto& c = spec_.chromaticities) {
            Imf::addChromaticities(header, {{(*c)[0], (*c)[1]}, {(*c)[2], (*c)[3]}, {(*c)[4], (*c)[5]}, {(*c)[6], (*c)[7]}});
        }
        if (const auto& n = spec_.adopted_neutral) Imf::addAdoptedNeutral(header, {(*n)[0], (*n)[1]});
        if (spec_.white_luminance) Imf::addWhiteLuminance(header, *spec_.white_luminance);
        for (const auto& [name, text] : spec_.strings) header.insert(name, Imf::StringAttribute(text));
        return header;
    }

    Status write_level(int level, int x, int y, std::span<const float> pixels) {
        const Level& size = levels_[level];
        const std::size_t width = static_cast<std::size_t>(size.tile_width(x));
        assert(pixels.size() == width * size.tile_height(y) * channels_);
        Status written = stream_.guard([&] {
            Imf::FrameBuffer frame;
            for (std::size_t c = 0; c < channels_; ++c) {
                char* base = const_cast<char*>(reinterpret_cast<const char*>(pixels.data() + c));  // NOLINT: OpenEXR reads only
                frame.insert(spec_.channels[c], Imf::Slice(Imf::FLOAT, base, channels_ * sizeof(float),
                                                           width * channels_ * sizeof(float), 1, 1, 0, true, true));
            }
            out_->setFrameBuffer(frame);
            out_->writeTile(x, y, level);
        });
        if (!written || level + 1 == static_cast<int>(levels_.size())) return written;
        return add_to_coarser(level + 1, x, y, pixels);
    }

    // Pixels of level 0 that column (or row) i of `level` covers, of n.
    static double covered(int level, std::int64_t i, std::int64_t n) {
        const std::int64_t span = std::int64_t{1} << level;
        return static_cast<double>(std::min(span, n - i * span));
    }

    static std::uint64_t key(int level, int x, int y) {
        return std::uint64_t(level) << 58 | std::uint64_t(y) << 29 | std::uint64_t(x);
    }

    // Tile (x, y) of the finer level becomes a quarter of tile (x/2, y/2) of `level`, which is written when it has all its
    // quarters.
    Status add_to_coarser(int level, int x, int y, std::span<const float> finer) {
        const Level& from = levels_[level - 1];
        const int width = from.tile_width(x), height = from.tile_height(y);
        std::vector<float> quarter(std::size_t{kHalf} * kHalf * channels_);
        for (int row = 0; row < height; row += 2) {
            const double rows[2] = {covered(level - 1, y * kTile + row, levels_[0].height),
                                    row + 1 < height ? covered(level - 1, y * kTile + row + 1, levels_[0].height) : 0};
            for (int column = 0; column < width; column += 2) {
                const double columns[2] = {covered(level - 1, x * kTile + column, levels_[0].width),
                                           column + 1 < width ? covered(level - 1, x * kTile + column + 1, levels_[0].width) : 0};
                float* out = &quarter[(std::size_t(row / 2) * kHalf + column / 2) * channels_];
                for (std::size_t c = 0; c < channels_; ++c) {
                    double sum = 0;
                    for (int i = 0; i < 4; ++i) {
                        const int dy = i / 2, dx = i % 2;
                        if (rows[dy] == 0 || columns[dx] == 0) continue;
                        sum += rows[dy] * columns[dx] *
                               static_cast<double>(finer[(std::size_t(row + dy) * width + column + dx) * channels_ + c]);
                    }
                    out[c] = static_cast<float>(sum / ((rows[0] + rows[1]) * (columns[0] + columns[1])));
                }
            }
        }
        if (Status s = quarters_.put(key(level, x, y), std::as_bytes(std::span(quarter))); !s) return s;

        const Level& to = levels_[level];
        const int tile_x = x / 2, tile_y = y / 2;
        const int right = std::min(2, from.tiles_x() - 2 * tile_x), below = std::min(2, from.tiles_y() - 2 * tile_y);
        if (++arrived_[key(level, tile_x, tile_y)] < right * below) return {};
        arrived_.erase(key(level, tile_x, tile_y));
        const int out_width = to.tile_width(tile_x), out_height = to.tile_height(tile_y);
        std::vector<float> tile(std::size_t(out_width) * out_height * channels_);
        for (int i = 0; i < 4; ++i) {
            const int dx = i % 2, dy = i / 2;
            if (dx >= right || dy >= below) continue;
            if (Result<bool> s =
                    quarters_.take(key(level, 2 * tile_x + dx, 2 * tile_y + dy), std::as_writable_bytes(std::span(quarter)));
                !s) {
                return s.error();
            }
            const int part_width = std::min(kHalf, out_width - dx * kHalf), part_height = std::min(kHalf, out_height - dy * kHalf);
            for (int row = 0; row < part_height; ++row) {
                std::copy_n(&quarter[std::size_t(row) * kHalf * channels_], part_width * channels_,
                            &tile[(std::size_t(row + dy * kHalf) * out_width + dx * kHalf) * channels_]);
            }
        }
        return write_level(level, tile_x, tile_y, tile);
    }

    ExrTileSpec spec_;
    std::size_t channels_;
    std::vector<Level> levels_;
    ExrStream stream_;
    std::unique_ptr<Imf::TiledOutputFile> out_;
    SlotFile quarters_;
    std::unordered_map<std::uint64_t, int> arrived_;  // quarters of coarser tiles
};

}  // namespace

Result<std::unique_ptr<ExrTileWriter>> ExrTileWriter::create(File& file, const ExrTileSpec& spec, std::uint64_t waiting_memory) {
    auto writer = std::make_unique<LevelsWriter>(file, spec, waiting_memory);
    if (Status s = writer->open(); !s) return s.error();
    return std::unique_ptr<ExrTileWriter>(std::move(writer));
}

}  // namespace latent::image
