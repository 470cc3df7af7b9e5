// Files that scenes name: pictures of textures and lights, and spectra.
#include <cmath>

#include "image/pictures.h"
#include "render/load/files/pictures.h"
#include "render/load/load_scene.h"
#include "tests/fuzz/target.h"

namespace latent::fuzz {

namespace {

constexpr std::uint64_t kMostPixels = 1 << 14;  // of pictures that are read as a whole

constexpr int kInputs = 64;  // for one cache of pictures: it takes longer to start than most inputs take

void look_up_everything(const image::Pictures& pictures, const image::PictureInfo& info) {
    using enum image::PictureFilter;
    using enum image::PictureWrap;
    for (const image::PictureFilter filter : {kPoint, kBilinear, kTrilinear, kEwa, kQuartic}) {
        for (const image::PictureWrap wrap : {kRepeat, kBlack, kClamp}) {
            std::array<float, 4> out{};
            pictures.lookup(info.index, {wrap, filter, 8}, 0.3f, 1.7f, {0.01f, 0}, {0, 0.2f}, out);
            pictures.lookup(info.index, {wrap, filter, 8}, 1, 0, {0, 0}, {0, 0}, out);
        }
    }
}

bool run_picture(ByteSpan bytes) {
    const bool is_exr = text_of(bytes).starts_with("\x76\x2F\x31\x01");
    static std::unique_ptr<image::Pictures> pictures;
    static int input = 0;
    if (pictures == nullptr || ++input == kInputs) {
        Result<std::unique_ptr<image::Pictures>> made = image::Pictures::create(1 << 20);
        require(made.has_value(), "there is a module for pictures");
        pictures = std::move(*made);
        input = 0;
    }
    // A cache remembers the names of broken files. Formats but these are known by their first bytes.
    const std::filesystem::path path = as_file(std::to_string(input) + (is_exr ? ".exr" : ".tga"), bytes);
    const Result<image::PictureInfo> info = pictures->open(path.string(), {});
    if (!info) return false;
    require(info->width > 0 && info->height > 0 && info->channels > 0, "a picture has pixels");
    if (std::uint64_t{info->width} * info->height > kMostPixels) return true;
    look_up_everything(*pictures, *info);
    const bool is_sound = pictures->read(path.string(), {}).has_value();
    if (!is_exr && bytes.size() % 4 != 0) return is_sound;  // the next starts a cache of its own for others
    const Result<render::LoadedPicture> whole = render::read_picture(path);
    if (!whole) return is_sound;
    for (const float value : whole->image.rgb) require(std::isfinite(value) && value >= 0, "light is finite and not below 0");
    return true;
}

bool run_spectrum(ByteSpan bytes) {
    static const std::filesystem::path scene = [] {
        constexpr std::string_view kScene =
            "WorldBegin\nLightSource \"point\" \"spectrum I\" \"a.spd\"\n"
            "Material \"conductor\" \"spectrum eta\" \"a.spd\"\nShape \"sphere\"\n";
        return as_file("spectrum.pbrt", std::as_bytes(std::span(kScene)));
    }();
    as_file("a.spd", bytes);
    return render::load_scene(scene).has_value();
}

std::vector<Bytes> spectrum_seeds() {
    std::vector<Bytes> seeds;
    for (const std::string_view text :
         {"300 1 500 2 600 3 900 1\n", "# a lamp\n 360 0.5\n 830.5 1e-3\n", "300 1e30 500 1 500.001 2 900 3"}) {
        const ByteSpan bytes = std::as_bytes(std::span(text));
        seeds.emplace_back(bytes.begin(), bytes.end());
    }
    return seeds;
}

}  // namespace

Target picture() { return {"picture", run_picture, nullptr, false, 300, nullptr}; }
Target spectrum() { return {"spectrum", run_spectrum, nullptr, true, 1000, spectrum_seeds}; }

}  // namespace latent::fuzz
