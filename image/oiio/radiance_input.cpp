#include "image/oiio/radiance_input.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

namespace latent::image {

namespace {

constexpr std::size_t kLongestLine = 4096, kMaxLines = 4096;
constexpr int kShortestRun = 8, kLongestRun = 0x7fff;  // widths that the newer encoding has

}  // namespace

bool RadianceInput::open(const std::string& path, OIIO::ImageSpec& spec) {
    file_.open(path, std::ios::binary);
    if (!file_) {
        errorfmt("cannot be opened");
        return false;
    }
    if (!read_header()) return false;
    rows_ = {file_.tellg()};
    m_spec = OIIO::ImageSpec(width_, height_, 3, OIIO::TypeDesc::FLOAT);
    constexpr std::array<float, 8> kXyz{1, 0, 0, 1, 0, 0, 1.0f / 3, 1.0f / 3};
    if (is_xyz_) primaries_ = kXyz;
    if (primaries_) {
        m_spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), primaries_->data());
        m_spec.attribute("latent:neutral", 1);
    }
    spec = m_spec;
    return true;
}

bool RadianceInput::close() {
    file_.close();
    return true;
}

bool RadianceInput::read_header() {
    std::string line;
    for (std::size_t i = 0; i < kMaxLines && std::getline(file_, line) && line.size() < kLongestLine; ++i) {
        if (line.ends_with('\r')) line.pop_back();
        const std::string_view text(line);
        float x = 1, rgb[3] = {1, 1, 1};
        if (text.starts_with("FORMAT=")) {
            is_xyz_ = text == "FORMAT=32-bit_rle_xyze";
            if (is_xyz_ || text == "FORMAT=32-bit_rle_rgbe") continue;
            errorfmt("its FORMAT is neither 32-bit_rle_rgbe nor 32-bit_rle_xyze");
            return false;
        }
        if (std::sscanf(line.c_str(), "EXPOSURE=%f", &x) == 1 && x > 0 && std::isfinite(x)) {
            for (float& factor : scale_) factor /= x;
        } else if (std::sscanf(line.c_str(), "COLORCORR=%f %f %f", &rgb[0], &rgb[1], &rgb[2]) == 3) {
            for (std::size_t c = 0; c < 3; ++c) scale_[c] /= rgb[c] > 0 && std::isfinite(rgb[c]) ? rgb[c] : 1;
        }
        std::array<float, 8> p{};
        if (std::sscanf(line.c_str(), "PRIMARIES=%f %f %f %f %f %f %f %f", &p[0], &p[1], &p[2], &p[3], &p[4], &p[5], &p[6],
                        &p[7]) == 8)
            primaries_ = p;
        char y_sign = 0, x_sign = 0;
        if (std::sscanf(line.c_str(), "%cY %9d %cX %9d", &y_sign, &height_, &x_sign, &width_) == 4 && width_ > 0 && height_ > 0) {
            from_bottom_ = y_sign == '+';
            from_right_ = x_sign == '-';
            return true;
        }
        if (text.starts_with("+X ") || text.starts_with("-X ")) {
            errorfmt("its rows run from top to bottom; turn it by a quarter");
            return false;
        }
    }
    errorfmt("its header has no line with a size");
    return false;
}

bool RadianceInput::read_row() {
    const auto get = [&] { return static_cast<unsigned char>(file_.get()); };
    const auto size = static_cast<std::size_t>(width_);
    row_.assign(size, {});
    std::array<unsigned char, 4> first{};
    for (unsigned char& x : first) x = get();
    if (!file_) return false;
    const bool is_planar = first[0] == 2 && first[1] == 2 && first[2] < 128 && width_ >= kShortestRun && width_ <= kLongestRun &&
                           (first[2] << 8 | first[3]) == width_;
    if (is_planar) {
        for (std::size_t c = 0; c < 4; ++c) {
            for (std::size_t x = 0; x < size;) {
                const unsigned char code = get();
                const std::size_t count = code > 128 ? code - 128u : code;
                if (!file_ || count == 0 || count > size - x) return false;
                const unsigned char value = code > 128 ? get() : 0;
                for (const std::size_t end = x + count; x < end; ++x) row_[x][c] = code > 128 ? value : get();
            }
        }
        return static_cast<bool>(file_);
    }
    // Pixels one after another; (1, 1, 1, n) repeats the one before, and more of these in a row are its higher digits.
    int shift = 0;
    for (std::size_t x = 0; x < size;) {
        if (first[0] == 1 && first[1] == 1 && first[2] == 1) {
            const std::size_t count = shift < 24 ? std::size_t{first[3]} << shift : size + 1;
            if (x == 0 || count > size - x) return false;
            std::fill_n(row_.begin() + static_cast<std::ptrdiff_t>(x), count, row_[x - 1]);
            x += count;
            shift += 8;
        } else {
            row_[x++] = first;
            shift = 0;
        }
        if (x == size) break;
        for (unsigned char& value : first) value = get();
        if (!file_) return false;
    }
    return true;
}

// As of every ImageInput, whoever calls this holds the lock.
bool RadianceInput::read_native_scanline(int subimage, int miplevel, int y, int, void* data) {
    if (subimage != 0 || miplevel != 0 || y < 0 || y >= height_) return false;
    const auto row = static_cast<std::size_t>(from_bottom_ ? height_ - 1 - y : y);
    file_.clear();
    for (std::size_t i = std::min(row, rows_.size() - 1); i <= row; ++i) {
        file_.seekg(rows_[i]);
        if (!read_row()) {
            errorfmt("the file is cut off or damaged, in row {}", i + 1);
            return false;
        }
        if (rows_.size() == i + 1) rows_.push_back(file_.tellg());
    }
    auto* out = static_cast<float*>(data);
    for (std::size_t x = 0; x < row_.size(); ++x) {
        const std::array<unsigned char, 4>& rgbe = row_[from_right_ ? row_.size() - 1 - x : x];
        const float unit = rgbe[3] > 0 ? std::ldexp(1.0f, rgbe[3] - (128 + 8)) : 0;
        for (std::size_t c = 0; c < 3; ++c) *out++ = static_cast<float>(rgbe[c]) * unit * scale_[c];
    }
    return true;
}

}  // namespace latent::image
