#include "image/oiio/linear_input.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>
#include <system_error>

#include "image/oiio/claimed_size.h"
#include "image/oiio/radiance_input.h"
#include "image/plausible_size.h"

namespace latent::image {

namespace {

float linear(float x, const PictureEncoding& encoding) {
    if (!encoding.is_srgb) return encoding.gamma == 1 ? x : std::pow(x, encoding.gamma);
    return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

struct Magic {
    std::string_view bytes;
    const char* format;
};
constexpr std::array kMagics = {
    Magic{"\x89PNG", "png"},
    Magic{"\xFF\xD8\xFF", "jpeg"},
    Magic{{"II*\0", 4}, "tiff"},
    Magic{{"MM\0*", 4}, "tiff"},
    Magic{{"II+\0", 4}, "tiff"},
    Magic{{"MM\0+", 4}, "tiff"},
    Magic{"\x76\x2F\x31\x01", "openexr"},
    Magic{"#?", "hdr"},
    Magic{"PF", "pnm"},
    Magic{"Pf", "pnm"},
    Magic{"P1", "pnm"},
    Magic{"P2", "pnm"},
    Magic{"P3", "pnm"},
    Magic{"P4", "pnm"},
    Magic{"P5", "pnm"},
    Magic{"P6", "pnm"},
    Magic{"BM", "bmp"},
    Magic{"GIF8", "gif"},
    Magic{"DDS ", "dds"},
    Magic{"RIFF", "webp"},
};
// Names whose files always begin with one of these.
constexpr std::array<std::string_view, 17> kExtensions = {"png", "jpg", "jpeg", "tif", "tiff", "exr", "hdr", "rgbe", "pfm",
                                                          "ppm", "pgm", "pbm",  "pnm", "bmp",  "gif", "dds", "webp"};

// The format by the first bytes of a file; TGA, which has no such bytes, by the name. OpenImageIO could read many others, from
// films to volumes: their readers have seen fewer strangers' files than these, so they are given none.
Result<std::string> format_of(const std::filesystem::path& path) {
    std::array<char, 4> front{};
    std::ifstream(path, std::ios::binary).read(front.data(), front.size());
    const std::string_view bytes(front.data(), front.size());
    for (const Magic& magic : kMagics) {
        if (bytes.starts_with(magic.bytes)) return magic.format;
    }
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (extension == ".tga") return "targa";
    if (!extension.empty() && std::ranges::find(kExtensions, extension.substr(1)) != kExtensions.end())
        return Error{ErrorCode::kCorrupt, "the file is not a picture of the format that its name says"};
    return Error{ErrorCode::kUnsupported,
                 "its format is none of PNG, JPEG, TIFF, OpenEXR, Radiance HDR, PFM, PNM, TGA, BMP, GIF, DDS and WebP"};
}

// OpenImageIO divides by these.
bool has_pixels(const OIIO::ImageSpec& spec) {
    const bool has_tiles = spec.tile_width != 0;
    return spec.width > 0 && spec.height > 0 && spec.depth > 0 && spec.nchannels > 0 &&
           (!has_tiles || (spec.tile_width > 0 && spec.tile_height > 0 && spec.tile_depth > 0));
}

}  // namespace

OIIO::ImageSpec LinearInput::configuration(const std::string& path, const PictureEncoding& encoding, RefusedValues* refused) {
    OIIO::ImageSpec config;
    config.attribute("latent:path", path);
    config.attribute("latent:srgb", encoding.is_srgb ? 1 : 0);
    config.attribute("latent:gamma", encoding.gamma);
    config.attribute("latent:refused", OIIO::TypeDesc::PTR, &refused);
    return config;
}

bool LinearInput::open(const std::string&, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) {
    encoding_ = {config.get_int_attribute("latent:srgb") != 0, config.get_float_attribute("latent:gamma", 1)};
    config.getattribute("latent:refused", OIIO::TypeDesc::PTR, &refused_);
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    const std::filesystem::path path(std::string(config.get_string_attribute("latent:path")));
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    const auto is_plausible = [&](std::int64_t width, std::int64_t height) {
        if (!failed && width >= 0 && height >= 0 &&
            is_plausible_size(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), bytes))
            return true;
        errorfmt("{} x {} pixels do not fit into a file of its size", width, height);
        return false;
    };
    const ClaimedSize claimed = claimed_size(path, failed ? 0 : bytes);
    if (claimed.attribute_overruns) {
        errorfmt("the file is damaged: an attribute is longer than the file");
        return false;
    }
    if (!is_plausible(static_cast<std::int64_t>(claimed.width), static_cast<std::int64_t>(claimed.height))) return false;
    const Result<std::string> format = format_of(path);
    if (!format) {
        errorfmt("{}", format.error().message);
        return false;
    }
    OIIO::ImageSpec file_spec;
    file_ = *format == "hdr" ? std::make_unique<RadianceInput>() : OIIO::ImageInput::create(*format);
    if (!file_ || !file_->open(path.string(), file_spec, hints)) {
        errorf("%s", file_ ? file_->geterror() : OIIO::geterror());
        file_.reset();
        return false;
    }
    if (!is_plausible(std::max(file_spec.width, file_spec.full_width), std::max(file_spec.height, file_spec.full_height)) ||
        !is_plausible(file_spec.tile_width, file_spec.tile_height)) {
        file_.reset();
        return false;
    }
    if (!has_pixels(file_spec)) {
        errorfmt("has no pixels");
        file_.reset();
        return false;
    }
    is_encoded_ = !file_->spec().format.is_floating_point() && (encoding_.is_srgb || encoding_.gamma != 1);
    if (is_encoded_ && file_->spec().format.size() == 1) {
        for (int i = 0; i < 256; ++i) table_.push_back(linear(static_cast<float>(i) / 255, encoding_));
    }
    take_spec();
    spec = m_spec;
    return true;
}

void LinearInput::take_spec() {
    m_spec = file_->spec();
    m_spec.set_format(OIIO::TypeDesc::FLOAT);
    m_spec.channelformats.clear();
    is_grey_with_alpha_ = m_spec.nchannels == 2 && m_spec.alpha_channel == 1;
    if (is_grey_with_alpha_) {
        m_spec.nchannels = 4;
        m_spec.channelnames = {"R", "G", "B", "A"};
        m_spec.alpha_channel = 3;
    }
    m_spec.erase_attribute("oiio:ConstantColor");  // hints of maketx, in the file's encoding
    m_spec.erase_attribute("oiio:AverageColor");
}

bool LinearInput::close() { return !file_ || file_->close(); }

// As of every ImageInput, whoever calls this holds the lock.
bool LinearInput::seek_subimage(int subimage, int miplevel) {
    if (file_ && subimage == 0 && miplevel == level_) return true;
    if (subimage != 0 || !file_ || !file_->seek_subimage(0, miplevel) || !has_pixels(file_->spec())) return false;
    level_ = miplevel;
    take_spec();
    return true;
}

bool LinearInput::finish(bool read, float* values, std::size_t pixels, int x, int y) {
    if (!read) {
        errorf("%s", file_->geterror());
        return false;
    }
    if (is_grey_with_alpha_) {  // the last first: each pixel moves behind where it was
        for (std::size_t i = pixels; i-- > 0;) {
            const float grey = values[2 * i], alpha = values[2 * i + 1];
            for (std::size_t c = 0; c < 3; ++c) values[4 * i + c] = grey;
            values[4 * i + 3] = alpha;
        }
    }
    const auto channels = static_cast<std::size_t>(m_spec.nchannels);
    if (refused_ != nullptr && file_->spec().format.is_floating_point()) {
        std::uint64_t count = 0;
        for (float& value : std::span(values, pixels * channels)) {
            if (std::isfinite(value)) continue;
            value = 0;
            ++count;
        }
        if (count > 0) refused_->add({level_, x, y}, count);
    }
    if (!is_encoded_) return true;
    for (std::size_t i = 0; i < pixels * channels; ++i) {
        if (m_spec.alpha_channel >= 0 && i % channels == static_cast<std::size_t>(m_spec.alpha_channel)) continue;
        values[i] = table_.empty() ? linear(values[i], encoding_)
                                   : table_[static_cast<std::size_t>(std::lround(std::clamp(values[i], 0.0f, 1.0f) * 255))];
    }
    return true;
}

bool LinearInput::read_native_scanline(int subimage, int miplevel, int y, int z, void* data) {
    return read_native_scanlines(subimage, miplevel, y, y + 1, z, data);
}

bool LinearInput::read_native_scanlines(int subimage, int miplevel, int ybegin, int yend, int z, void* data) {
    const lock_guard one_at_a_time(*this);
    if (!seek_subimage(subimage, miplevel)) return false;
    const bool read = file_->read_scanlines(0, miplevel, ybegin, yend, z, 0, file_->spec().nchannels, OIIO::TypeDesc::FLOAT, data);
    return finish(read, static_cast<float*>(data), static_cast<std::size_t>(m_spec.width) * static_cast<std::size_t>(yend - ybegin),
                  0, ybegin);
}

bool LinearInput::read_native_tile(int subimage, int miplevel, int x, int y, int z, void* data) {
    const lock_guard one_at_a_time(*this);
    if (!seek_subimage(subimage, miplevel)) return false;
    const bool read = file_->read_tile(x, y, z, OIIO::TypeDesc::FLOAT, data);
    return finish(read, static_cast<float*>(data),
                  static_cast<std::size_t>(m_spec.tile_width) * static_cast<std::size_t>(m_spec.tile_height), x, y);
}

}  // namespace latent::image
