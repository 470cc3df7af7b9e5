// The module latent_oiio.so: Pictures by OpenImageIO's texture system.
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/first_error.h"
#include "base/size.h"
#include "image/oiio/intact.h"
#include "image/oiio/linear_input.h"

namespace latent::image {

namespace {

using OIIO::TextureOpt;

constexpr int kTile = 64;  // side of a tile, for files without tiles
// So many tiles fit into the cache: each thread holds two beside it, and OpenImageIO ends the process at ten times its limit.
constexpr std::uint64_t kFewestTiles = 16;

// What a file is called: by OpenImageIO, and in messages.
struct FileName {
    std::string path, in_messages;
};

// OpenImageIO's messages name the file, or what it takes for one ("PATH#0"), may have several lines, and may be empty: `otherwise`.
Error error_of(const FileName& file, std::string message, std::string_view otherwise = "unknown format") {
    if (const std::size_t end = message.find('\n'); end != std::string::npos) message.resize(end);
    if (std::size_t begin = message.find(file.path); begin != std::string::npos) {
        std::size_t end = begin + file.path.size();
        if (message[end] == '#') end = std::min(message.find_first_not_of("0123456789", end + 1), message.size());
        if (begin > 0 && message[begin - 1] == '"' && message[end] == '"') --begin, ++end;
        message.replace(begin, end - begin, "the file");
    }
    const auto says = [&](std::string_view text) { return message.find(text) != std::string::npos; };
    if (says("end of file") || (says("asked for") && says("got"))) message = "the file is cut off";
    if (says("Error reading from") || says("Error reading pixel data")) message = "the file is cut off or damaged";
    if (message == "Couldn't decode" || says("not a WebP")) message = "the file is damaged: its pixels cannot be decoded";
    return {ErrorCode::kCorrupt,
            fmt::format("{}: cannot be read as a picture: {}", file.in_messages, message.empty() ? otherwise : message)};
}

Result<PictureInfo> info_of(const FileName& file, const OIIO::ImageSpec& spec) {
    PictureInfo info;
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 || spec.deep)
        return Error{ErrorCode::kUnsupported, fmt::format("{}: not a flat picture", file.in_messages)};
    info.width = static_cast<std::uint32_t>(spec.full_width);
    info.height = static_cast<std::uint32_t>(spec.full_height);
    info.channels = static_cast<std::uint32_t>(spec.nchannels);
    if (info.channels != 1 && info.channels != 3 && info.channels != 4)
        return Error{ErrorCode::kUnsupported,
                     fmt::format("{}: has {} channels, not grey, RGB or RGBA", file.in_messages, info.channels)};
    std::array<float, 8> chromaticities{};
    if (spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), chromaticities.data()))
        info.chromaticities = chromaticities;
    info.is_white_neutral = spec.get_int_attribute("latent:neutral") != 0;
    return info;
}

class OiioPictures final : public Pictures {
 public:
    explicit OiioPictures(std::uint64_t cache_bytes)
        : max_tile_bytes_(std::max(cache_bytes / kFewestTiles, std::uint64_t{kTile} * kTile * 4 * sizeof(float))) {
        textures_ = OIIO::TextureSystem::create(false);
        OiioPictures::set_cache_bytes(cache_bytes);
        textures_->attribute("autotile", kTile);
        textures_->attribute("automip", 1);
        textures_->attribute("forcefloat", 1);
        textures_->attribute("max_errors_per_file", 1);
        cache_ = textures_->imagecache();
    }
    ~OiioPictures() override { OIIO::TextureSystem::destroy(textures_, true); }

    void set_cache_bytes(std::uint64_t cache_bytes) override {
        textures_->attribute("max_memory_MB", static_cast<float>(static_cast<double>(cache_bytes) / (1 << 20)));
    }

    Result<PictureInfo> open(const std::string& path, const std::string& in_messages, const PictureEncoding& encoding) override {
        const FileName file{path, in_messages};
        if (!intact_.contains(path)) {
            const Result<bool> checked = check_intact(path);
            if (!checked) return error_of(file, checked.error().message);
            if (!*checked) {
                if (Status s = check_ends(file, encoding); !s) return s.error();
            }
            intact_.insert(path);
        }
        const OIIO::ustring name(fmt::format("{}#{}", path, handles_.size()));
        const OIIO::ImageSpec config = LinearInput::configuration(path, encoding, &refused_[in_messages]);
        cache_->add_file(name, LinearInput::create, &config);
        OIIO::ImageSpec spec;
        if (!cache_->get_imagespec(name, spec, 0, 0, true)) return error_of(file, cache_->geterror());
        Result<PictureInfo> info = info_of(file, spec);
        if (!info) return info;
        info->index = static_cast<std::uint32_t>(handles_.size());
        if (spec.tile_width == 0) info->whole_bytes = spec.image_bytes() * 4 / 3;
        Result<Sizes> sizes = sizes_of(name, file);
        if (!sizes) return sizes.error();
        if (info->channels == 4) {
            const Result<bool> opaque = is_opaque(file, encoding);
            if (!opaque) return opaque.error();
            info->is_opaque = *opaque;
        }
        handles_.push_back({textures_->get_texture_handle(name), file, static_cast<int>(info->channels), std::move(*sizes)});
        return info;
    }

    void lookup(std::uint32_t index, const PictureSampling& sampling, float s, float t, const std::array<float, 2>& d0,
                const std::array<float, 2>& d1, std::array<float, 4>& out) const override {
        constexpr TextureOpt::Wrap kWraps[] = {TextureOpt::WrapPeriodic, TextureOpt::WrapBlack, TextureOpt::WrapClamp,
                                               TextureOpt::WrapMirror};
        constexpr TextureOpt::MipMode kMips[] = {TextureOpt::MipModeOneLevel, TextureOpt::MipModeOneLevel,
                                                 TextureOpt::MipModeTrilinear, TextureOpt::MipModeAniso};
        const Handle& handle = handles_[index];
        if (sampling.filter == PictureFilter::kQuartic) return reconstruct(handle, sampling.wrap, s, t, d0, d1, out);
        TextureOpt options;
        options.swrap = kWraps[static_cast<std::size_t>(sampling.wrap[0])];
        options.twrap = kWraps[static_cast<std::size_t>(sampling.wrap[1])];
        options.mipmode = kMips[static_cast<std::size_t>(sampling.filter)];
        options.interpmode = sampling.filter == PictureFilter::kPoint ? TextureOpt::InterpClosest : TextureOpt::InterpBilinear;
        options.anisotropic = sampling.max_anisotropy;
        options.conservative_filter = false;
        out = {};
        if (textures_->texture(handle.texture, textures_->get_perthread_info(), options, s, t, d0[0], d0[1], d1[0], d1[1],
                               handle.channels, out.data()))
            return;
        out = {};
        const std::string message = textures_->geterror();
        if (!error_) error_.set(error_of(handle.file, message, "a part of it is damaged or missing"));
    }

    Status status() const override { return error_ ? error_.status() : Status{}; }

    std::vector<std::string> warnings() const override {
        std::vector<std::string> out;
        for (const auto& [name, refused] : refused_) {
            if (const std::uint64_t count = refused.count(); count > 0)
                out.push_back(fmt::format("{}: {} NaN or infinite, and count as 0", name,
                                          counted(count, "value") + (count == 1 ? " is" : " are")));
        }
        return out;
    }

    Result<WholePicture> read(const std::string& path, const std::string& in_messages,
                              const PictureEncoding& encoding) const override {
        const FileName file{path, in_messages};
        if (const Result<bool> intact = check_intact(path); !intact) return error_of(file, intact.error().message);
        LinearInput input;
        OIIO::ImageSpec spec;
        if (!input.open(path, spec, LinearInput::configuration(path, encoding))) return error_of(file, input.geterror());
        const Result<PictureInfo> info = info_of(file, spec);
        if (!info) return info.error();
        WholePicture picture{*info};
        if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width || spec.height != spec.full_height)
            return Error{ErrorCode::kUnsupported, fmt::format("{}: its data window differs from its display window", in_messages)};
        picture.values.resize(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
        if (!input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, picture.values.data()))
            return error_of(file, input.geterror());
        return picture;
    }

 private:
    using Wraps = std::array<PictureWrap, 2>;
    using Sizes = std::vector<std::array<float, 2>>;
    struct Handle {
        OIIO::TextureSystem::TextureHandle* texture;
        FileName file;
        int channels;
        Sizes sizes;  // in texels: the picture's, and its smaller ones
    };

    Result<Sizes> sizes_of(const OIIO::ustring& name, const FileName& file) const {
        int count = 1;
        cache_->get_image_info(name, 0, 0, OIIO::ustring("miplevels"), OIIO::TypeInt, &count);
        Sizes sizes;
        OIIO::ImageSpec spec;
        for (int level = 0; level < count && cache_->get_imagespec(name, spec, 0, level); ++level) {
            if (spec.tile_bytes() > max_tile_bytes_)
                return Error{
                    ErrorCode::kUnsupported,
                    fmt::format("{}: a tile of {} x {} pixels takes more than 1/{} of --texture-cache; raise it, or save the "
                                "picture with smaller tiles",
                                file.in_messages, spec.tile_width, spec.tile_height, kFewestTiles)};
            sizes.push_back({static_cast<float>(spec.full_width), static_cast<float>(spec.full_height)});
        }
        return sizes;
    }

    // The size whose texels are as large as the footprint, or the two about it; the texels of each by the quartic.
    void reconstruct(const Handle& handle, const Wraps& wrap, float s, float t, const std::array<float, 2>& d0,
                     const std::array<float, 2>& d1, std::array<float, 4>& out) const {
        out = {};
        const auto texels = [&](const std::array<float, 2>& d) {
            return std::hypot(d[0] * handle.sizes[0][0], d[1] * handle.sizes[0][1]);
        };
        const float level = std::log2(std::max({1.0f, texels(d0), texels(d1)}));
        const int last = static_cast<int>(handle.sizes.size()) - 1,
                  below = std::min(static_cast<int>(std::min(level, 64.0f)), last);
        const float above = std::min(level - static_cast<float>(below), 1.0f);
        if (!add_level(handle, wrap, below, s, t, below == last ? 1 : 1 - above, out) ||
            (below < last && above > 0 && !add_level(handle, wrap, below + 1, s, t, above, out))) {
            out = {};
            const std::string message = textures_->geterror();
            if (!error_) error_.set(error_of(handle.file, message, "a part of it is damaged or missing"));
        }
    }

    // out += weight times the picture of a level at (s, t): its texels within a radius of two, by (1 - rho)^2 (1 + 2 rho + s rho^2)
    // of their distance, over the sum of that. It rings a little, as sharp pictures need.
    bool add_level(const Handle& handle, const Wraps& wrap, int level, float s, float t, float weight,
                   std::array<float, 4>& out) const {
        constexpr int kRadius = 2, kSide = 2 * kRadius;
        constexpr float kS = -6;
        const auto [width, height] = handle.sizes[static_cast<std::size_t>(level)];
        const float x = s * width - 0.5f, y = t * height - 0.5f;
        if (!(std::abs(x) < 1e9f && std::abs(y) < 1e9f)) return true;
        const int x0 = static_cast<int>(std::floor(x)) - kRadius + 1, y0 = static_cast<int>(std::floor(y)) - kRadius + 1;
        std::array<float, kSide * kSide * 4> texels{};
        const auto channels = static_cast<std::size_t>(handle.channels);
        if (!read_texels(handle, wrap, level, x0, y0, kSide, texels.data())) return false;
        std::array<float, kSide * kSide> f;
        float sum = 0;
        for (int i = 0; i < kSide * kSide; ++i) {
            const float dx = static_cast<float>(x0 + i % kSide) - x, dy = static_cast<float>(y0 + i / kSide) - y;
            const float rho = std::min(std::sqrt(dx * dx + dy * dy) / kRadius, 1.0f);
            f[static_cast<std::size_t>(i)] = (1 - rho) * (1 - rho) * (1 + rho * (2 + kS * rho));
            sum += f[static_cast<std::size_t>(i)];
        }
        for (std::size_t i = 0; i < f.size(); ++i) {
            for (std::size_t c = 0; c < channels; ++c) out[c] += weight / sum * f[i] * texels[i * channels + c];
        }
        return true;
    }

    // `side` x `side` texels of a level from (x0, y0) on, row by row, continued beyond the edges of the picture.
    bool read_texels(const Handle& handle, const Wraps& wrap, int level, int x0, int y0, int side, float* out) const {
        const int width = static_cast<int>(handle.sizes[static_cast<std::size_t>(level)][0]),
                  height = static_cast<int>(handle.sizes[static_cast<std::size_t>(level)][1]);
        TextureOpt options;
        const auto read = [&](int x, int y, int size, float* to) {
            return textures_->get_texels(handle.texture, textures_->get_perthread_info(), options, level, x, x + size, y, y + size,
                                         0, 1, 0, handle.channels, OIIO::TypeDesc::FLOAT, to);
        };
        if (x0 >= 0 && y0 >= 0 && x0 + side <= width && y0 + side <= height) return read(x0, y0, side, out);
        const auto wrapped = [](int i, int n, PictureWrap how) {  // -1: black
            const auto modulo = [&](int period) { return (i % period + period) % period; };
            switch (how) {
                case PictureWrap::kRepeat:
                    return modulo(n);
                case PictureWrap::kClamp:
                    return std::clamp(i, 0, n - 1);
                case PictureWrap::kMirror:
                    return std::min(modulo(2 * n), 2 * n - 1 - modulo(2 * n));
                case PictureWrap::kBlack:
                    break;
            }
            return i >= 0 && i < n ? i : -1;
        };
        for (int i = 0; i < side * side; ++i) {
            const int x = wrapped(x0 + i % side, width, wrap[0]), y = wrapped(y0 + i / side, height, wrap[1]);
            if (x >= 0 && y >= 0 && !read(x, y, 1, out + i * handle.channels)) return false;
        }
        return true;
    }

    // Rows begin .. end-1, which are whole tiles if there are tiles; all channels.
    static bool read_rows(LinearInput& input, const OIIO::ImageSpec& spec, int begin, int end, std::vector<float>& values) {
        constexpr OIIO::TypeDesc kFloat = OIIO::TypeDesc::FLOAT;
        const int n = spec.nchannels;
        values.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(end - begin) * static_cast<std::size_t>(n));
        return spec.tile_width > 0
                   ? input.read_tiles(0, 0, spec.x, spec.x + spec.width, begin, end, 0, 1, 0, n, kFloat, values.data())
                   : input.read_scanlines(0, 0, begin, end, 0, 0, n, kFloat, values.data());
    }

    // Reads the first and the last rows: one of them comes last in the file, and most formats must be decoded up to there.
    static Status check_ends(const FileName& file, const PictureEncoding& encoding) {
        LinearInput input;
        OIIO::ImageSpec spec;
        if (!input.open(file.path, spec, LinearInput::configuration(file.path, encoding))) return error_of(file, input.geterror());
        if (spec.depth > 1 || spec.deep) return {};  // refused later
        const int last = spec.tile_height > 0 ? (spec.height - 1) / spec.tile_height * spec.tile_height : spec.height - 1;
        for (const int row : {0, last}) {
            const int begin = spec.y + row,
                      end = begin + (spec.tile_height > 0 ? std::min(spec.tile_height, spec.height - row) : 1);
            std::vector<float> values;
            const bool read = read_rows(input, spec, begin, end, values);
            if (!read) return error_of(file, input.geterror(), "the file is cut off or damaged");
        }
        return {};
    }

    // A few rows at a time.
    static Result<bool> is_opaque(const FileName& file, const PictureEncoding& encoding) {
        LinearInput input;
        OIIO::ImageSpec spec;
        if (!input.open(file.path, spec, LinearInput::configuration(file.path, encoding))) return error_of(file, input.geterror());
        const int rows = spec.tile_height > 0 ? spec.tile_height : kTile;
        std::vector<float> values;
        for (int y = spec.y; y < spec.y + spec.height; y += rows) {
            const int end = std::min(y + rows, spec.y + spec.height);
            const bool read = read_rows(input, spec, y, end, values);
            if (!read) return error_of(file, input.geterror());
            for (std::size_t i = 3; i < values.size(); i += 4) {
                if (values[i] != 1) return false;
            }
        }
        return true;
    }

    std::uint64_t max_tile_bytes_;
    OIIO::TextureSystem* textures_;
    OIIO::ImageCache* cache_;
    std::vector<Handle> handles_;
    std::set<std::string> intact_;                  // paths
    std::map<std::string, RefusedValues> refused_;  // by names in messages
    mutable FirstError error_;
};

}  // namespace

}  // namespace latent::image

extern "C" latent::image::Pictures* latent_create_pictures(std::uint64_t cache_bytes) {
    return new latent::image::OiioPictures(cache_bytes);
}
