// The module latent_oiio.so: Pictures by OpenImageIO's texture system.
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>
#include <fmt/format.h>

#include <algorithm>

#include "base/first_error.h"
#include "image/oiio/linear_input.h"

namespace latent::image {

namespace {

using OIIO::TextureOpt;

constexpr int kTile = 64;  // of files without tiles

// OpenImageIO's messages name the file, or what it takes for one, and may have several lines.
Error error_of(const std::string& path, std::string message) {
    if (const std::size_t end = message.find('\n'); end != std::string::npos) message.resize(end);
    for (const std::string& name : {"\"" + path + "\"", path}) {
        const std::size_t at = message.find(name);
        if (at != std::string::npos) message.replace(at, name.size(), "the file");
    }
    return {ErrorCode::kCorrupt,
            fmt::format("{}: cannot be read as a picture: {}", path, message.empty() ? "unknown format" : message)};
}

Result<PictureInfo> info_of(const std::string& path, const OIIO::ImageSpec& spec) {
    PictureInfo info;
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 || spec.deep)
        return Error{ErrorCode::kUnsupported, fmt::format("{}: not a flat picture", path)};
    info.width = static_cast<std::uint32_t>(spec.full_width);
    info.height = static_cast<std::uint32_t>(spec.full_height);
    info.channels = static_cast<std::uint32_t>(spec.nchannels);
    if (info.channels != 1 && info.channels != 3 && info.channels != 4)
        return Error{ErrorCode::kUnsupported, fmt::format("{}: has {} channels, not grey, RGB or RGBA", path, info.channels)};
    std::array<float, 8> chromaticities{};
    if (spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), chromaticities.data()))
        info.chromaticities = chromaticities;
    return info;
}

class OiioPictures final : public Pictures {
 public:
    explicit OiioPictures(std::uint64_t cache_bytes) {
        textures_ = OIIO::TextureSystem::create(false);
        textures_->attribute("max_memory_MB", static_cast<float>(static_cast<double>(cache_bytes) / (1 << 20)));
        textures_->attribute("autotile", kTile);
        textures_->attribute("automip", 1);
        textures_->attribute("forcefloat", 1);
        textures_->attribute("max_errors_per_file", 1);
        cache_ = textures_->imagecache();
    }
    ~OiioPictures() override { OIIO::TextureSystem::destroy(textures_, true); }

    Result<PictureInfo> open(const std::string& path, const PictureEncoding& encoding) override {
        const OIIO::ustring name(fmt::format("{}#{}", path, handles_.size()));
        const OIIO::ImageSpec config = LinearInput::configuration(path, encoding);
        cache_->add_file(name, LinearInput::create, &config);
        OIIO::ImageSpec spec;
        if (!cache_->get_imagespec(name, spec, 0, 0, true)) return error_of(path, cache_->geterror());
        Result<PictureInfo> info = info_of(path, spec);
        if (!info) return info;
        info->index = static_cast<std::uint32_t>(handles_.size());
        if (info->channels == 4) {
            const Result<bool> opaque = is_opaque(path, encoding);
            if (!opaque) return opaque.error();
            info->is_opaque = *opaque;
        }
        handles_.push_back({textures_->get_texture_handle(name), path, static_cast<int>(info->channels)});
        return info;
    }

    void lookup(std::uint32_t index, const PictureSampling& sampling, float s, float t, const std::array<float, 2>& d0,
                const std::array<float, 2>& d1, std::array<float, 4>& out) const override {
        constexpr TextureOpt::Wrap kWraps[] = {TextureOpt::WrapPeriodic, TextureOpt::WrapBlack, TextureOpt::WrapClamp};
        constexpr TextureOpt::MipMode kMips[] = {TextureOpt::MipModeOneLevel, TextureOpt::MipModeOneLevel,
                                                 TextureOpt::MipModeTrilinear, TextureOpt::MipModeAniso};
        const Handle& handle = handles_[index];
        TextureOpt options;
        options.swrap = options.twrap = kWraps[static_cast<std::size_t>(sampling.wrap)];
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
        if (!error_) error_.set(error_of(handle.path, message));
    }

    Status status() const override { return error_ ? error_.status() : Status{}; }

    Result<WholePicture> read(const std::string& path, const PictureEncoding& encoding) const override {
        LinearInput input;
        OIIO::ImageSpec spec;
        if (!input.open(path, spec, LinearInput::configuration(path, encoding))) return error_of(path, input.geterror());
        const Result<PictureInfo> info = info_of(path, spec);
        if (!info) return info.error();
        WholePicture picture{*info};
        if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width || spec.height != spec.full_height)
            return Error{ErrorCode::kUnsupported, fmt::format("{}: its data window differs from its display window", path)};
        picture.values.resize(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
        if (!input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, picture.values.data()))
            return error_of(path, input.geterror());
        return picture;
    }

 private:
    struct Handle {
        OIIO::TextureSystem::TextureHandle* texture;
        std::string path;
        int channels;
    };

    // A few rows at a time.
    static Result<bool> is_opaque(const std::string& path, const PictureEncoding& encoding) {
        LinearInput input;
        OIIO::ImageSpec spec;
        if (!input.open(path, spec, LinearInput::configuration(path, encoding))) return error_of(path, input.geterror());
        const int rows = spec.tile_height > 0 ? spec.tile_height : kTile;
        std::vector<float> values;
        for (int y = spec.y; y < spec.y + spec.height; y += rows) {
            const int end = std::min(y + rows, spec.y + spec.height);
            values.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(end - y) * 4);
            const bool read =
                spec.tile_width > 0
                    ? input.read_tiles(0, 0, spec.x, spec.x + spec.width, y, end, 0, 1, 0, 4, OIIO::TypeDesc::FLOAT, values.data())
                    : input.read_scanlines(0, 0, y, end, 0, 0, 4, OIIO::TypeDesc::FLOAT, values.data());
            if (!read) return error_of(path, input.geterror());
            for (std::size_t i = 3; i < values.size(); i += 4) {
                if (values[i] != 1) return false;
            }
        }
        return true;
    }

    OIIO::TextureSystem* textures_;
    OIIO::ImageCache* cache_;
    std::vector<Handle> handles_;
    mutable FirstError error_;
};

}  // namespace

}  // namespace latent::image

extern "C" latent::image::Pictures* latent_create_pictures(std::uint64_t cache_bytes) {
    return new latent::image::OiioPictures(cache_bytes);
}
