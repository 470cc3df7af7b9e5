#include "image/oiio/linear_input.h"

#include <algorithm>
#include <cmath>

namespace latent::image {

namespace {

float linear(float x, const PictureEncoding& encoding) {
    if (!encoding.is_srgb) return encoding.gamma == 1 ? x : std::pow(x, encoding.gamma);
    return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

}  // namespace

OIIO::ImageSpec LinearInput::configuration(const std::string& path, const PictureEncoding& encoding) {
    OIIO::ImageSpec config;
    config.attribute("latent:path", path);
    config.attribute("latent:srgb", encoding.is_srgb ? 1 : 0);
    config.attribute("latent:gamma", encoding.gamma);
    return config;
}

bool LinearInput::open(const std::string&, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) {
    encoding_ = {config.get_int_attribute("latent:srgb") != 0, config.get_float_attribute("latent:gamma", 1)};
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    file_ = OIIO::ImageInput::open(config.get_string_attribute("latent:path"), &hints);
    if (!file_) {
        errorf("%s", OIIO::geterror());
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
    m_spec.erase_attribute("oiio:ConstantColor");  // hints of maketx, in the file's encoding
    m_spec.erase_attribute("oiio:AverageColor");
}

bool LinearInput::close() { return !file_ || file_->close(); }

// As of every ImageInput, whoever calls this holds the lock.
bool LinearInput::seek_subimage(int subimage, int miplevel) {
    if (file_ && subimage == 0 && miplevel == level_) return true;
    if (subimage != 0 || !file_ || !file_->seek_subimage(0, miplevel)) return false;
    level_ = miplevel;
    take_spec();
    return true;
}

bool LinearInput::finish(bool read, float* values, std::size_t pixels) {
    if (!read) {
        errorf("%s", file_->geterror());
        return false;
    }
    if (!is_encoded_) return true;
    const auto channels = static_cast<std::size_t>(m_spec.nchannels);
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
    const bool read = file_->read_scanlines(0, miplevel, ybegin, yend, z, 0, m_spec.nchannels, OIIO::TypeDesc::FLOAT, data);
    return finish(read, static_cast<float*>(data),
                  static_cast<std::size_t>(m_spec.width) * static_cast<std::size_t>(yend - ybegin));
}

bool LinearInput::read_native_tile(int subimage, int miplevel, int x, int y, int z, void* data) {
    const lock_guard one_at_a_time(*this);
    if (!seek_subimage(subimage, miplevel)) return false;
    const bool read = file_->read_tile(x, y, z, OIIO::TypeDesc::FLOAT, data);
    return finish(read, static_cast<float*>(data),
                  static_cast<std::size_t>(m_spec.tile_width) * static_cast<std::size_t>(m_spec.tile_height));
}

}  // namespace latent::image
