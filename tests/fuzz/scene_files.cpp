// Files that scenes name: pictures of textures and lights, spectra, and measured materials.
#include <cmath>

#include "image/pictures.h"
#include "render/bsdf/measured.h"
#include "render/load/brdf/measured.h"
#include "render/load/files/pictures.h"
#include "render/load/load_scene.h"
#include "tests/fuzz/target.h"
#include "tests/transport/measured_examples.h"

// OpenImageIO 2.4 loses its message (31 bytes) about a PNG file whose data end too early: libpng jumps over the string's
// destructor. Its frames are not seen, since Debian's libraries have no frame pointers.
extern "C" const char* __lsan_default_suppressions() { return "leak:basic_string*_M_assign\n"; }

namespace latent::fuzz {

namespace {

constexpr std::uint64_t kMaxPixels = 1 << 14;  // of pictures that are read as a whole

constexpr int kInputs = 64;  // for one cache of pictures: it takes longer to start than most inputs take

void look_up_everything(const image::Pictures& pictures, const image::PictureInfo& info) {
    using enum image::PictureFilter;
    using enum image::PictureWrap;
    for (const image::PictureFilter filter : {kPoint, kBilinear, kTrilinear, kEwa, kQuartic}) {
        for (const image::PictureWrap wrap : {kRepeat, kBlack, kClamp, kMirror}) {
            std::array<float, 4> out{};
            pictures.lookup(info.index, {{wrap, wrap}, filter, 8}, 0.3f, 1.7f, {0.01f, 0}, {0, 0.2f}, out);
            pictures.lookup(info.index, {{wrap, wrap}, filter, 8}, 1, 0, {0, 0}, {0, 0}, out);
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
    const Result<image::PictureInfo> info = pictures->open(path.string(), path.string(), {});
    if (!info) return false;
    require(info->width > 0 && info->height > 0 && info->channels > 0, "a picture has pixels");
    if (std::uint64_t{info->width} * info->height > kMaxPixels) return true;
    look_up_everything(*pictures, *info);
    const bool is_sound = pictures->read(path.string(), path.string(), {}).has_value();
    if (!is_exr && bytes.size() % 4 != 0) return is_sound;  // the next starts a cache of its own for others
    const Result<render::LoadedPicture> whole = render::read_picture(path, "a picture");
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

bool run_measured(ByteSpan bytes) {
    const auto brdf = render::read_measured_brdf(bytes);
    if (!brdf) return false;
    using namespace render;
    const MeasuredTables tables(*brdf);
    Wavelengths wavelengths;
    wavelengths.k = 1;
    std::fill_n(wavelengths.lambda_nm, kMaxWavelengths, 555.0f);
    const Measured closure(tables, wavelengths);
    require(closure.albedo().max() <= 1, "no more than all is reflected");
    for (const Vec3f& wo : {Vec3f{0, 0, 1}, Vec3f{0.6f, 0, 0.8f}, Vec3f{-0.48f, 0.36f, -0.8f}}) {
        for (const float u : {0.0f, 0.3f, 0.99999f}) {
            ClosureSample sample;
            SampledSpectrum value(1.0f);
            if (!closure.sample(wo, 0, u, 1 - u, sample, value)) continue;
            const float length2 = dot(sample.wi, sample.wi);
            require(length2 > 0.99f && length2 < 1.01f, "directions have unit length");
            require(closure.pdf_omega(wo, sample.wi) >= 0, "densities are not below 0");
            closure.multiply_f_cos(wo, sample.wi, value);
            require(value[0] >= 0, "light is not below 0");
        }
    }
    return true;
}

std::vector<Bytes> measured_seeds() {
    using render::testing::MeasuredFile;
    return {MeasuredFile(render::testing::measured({.side = 4, .directions = 2})).bytes(),
            MeasuredFile(render::testing::measured({.alpha_x = 0.2f, .side = 3, .directions = 2, .turns = 4})).bytes()};
}

}  // namespace

Target picture() { return {"picture", run_picture, nullptr, false, 300, nullptr}; }
Target spectrum() { return {"spectrum", run_spectrum, nullptr, true, 1000, spectrum_seeds}; }
Target measured() { return {"measured", run_measured, nullptr, false, 3000, measured_seeds}; }

}  // namespace latent::fuzz
