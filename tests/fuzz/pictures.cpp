// Pictures and profiles that latent-convert reads.
#include "image/exr_reader.h"
#include "tests/fuzz/target.h"
#include "tools/convert/icc.h"

namespace latent::fuzz {

namespace {

bool run_exr(ByteSpan bytes) {
    bool read = false;
    const std::filesystem::path path = as_file("a.exr", bytes);
    for (int level = 0; level < 3; ++level) {
        Result<image::ExrReader> reader = image::ExrReader::open(path, {level, "", true});
        if (!reader) break;
        if (!reader->image().has_colour) reader->integrate({reader->image().emitted_nm.size(), {1, 2, 3}});
        const image::Rect window = reader->image().data_window;
        require(!window.empty() && reader->image().block_width > 0 && reader->image().block_height > 0, "a picture has pixels");
        if (window.width() > 2048 || window.height() > 2048 || window.pixels() > (1 << 18)) continue;
        std::vector<float> values(3 * static_cast<std::size_t>(window.pixels()));
        float* const plane = values.data();
        const auto pixels = static_cast<std::size_t>(window.pixels()), row = static_cast<std::size_t>(window.width());
        image::ExrReader::Scratch scratch;
        read |= static_cast<bool>(reader->read(window, {plane, plane + pixels, plane + 2 * pixels}, row, scratch));
        if (window.width() < 3 || window.height() < 3) continue;
        const image::Rect inner{window.x0 + 1, window.y0 + 1, window.x1 - 1, window.y1 - 1};
        (void)reader->read(inner, {plane, plane + pixels, plane + 2 * pixels}, row, scratch);
    }
    return read;
}

bool run_icc(ByteSpan bytes) { return convert::display_from_icc(as_file("a.icc", bytes).string(), std::nullopt, {}).has_value(); }

std::vector<Bytes> icc_seeds() { return {convert::icc_of(color::RgbSpace::srgb())}; }

}  // namespace

Target exr() { return {"exr", run_exr, nullptr, false, 4000, nullptr}; }
Target icc() { return {"icc", run_icc, nullptr, false, 2000, icc_seeds}; }

}  // namespace latent::fuzz
