#include "tools/convert/source.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/url.h"
#include "color/camera.h"
#include "color/observer_file.h"
#include "color/rgb_space.h"
#include "color/spectral_bins.h"

namespace latent::convert {

namespace {

// What the three planes of a file are.
struct Meaning {
    color::Matrix3 xyz_from_file{};
    color::Chromaticity white = color::RgbSpace::srgb().primaries.white;
    std::optional<double> cd_m2{};
    std::string observer{};
    std::vector<std::string> warnings{};
};

// Luminance in cd/m^2 of 1 W m^-2 sr^-1 nm^-1 over 1 nm where the eye responds most.
constexpr double kLumensPerWatt = 683;

// Lets the observer look at the spectra of the file.
Result<Meaning> see_spectra(const ConvertOptions& options, image::ExrReader& reader) {
    const std::vector<double>& nm = reader.image().emitted_nm;
    if (!options.input_space.empty())
        return usage_error(fmt::format("--input-space: {} is printed from its spectrum, which needs none", options.input.string()));
    if (nm.size() < 2)
        return Error{ErrorCode::kUnsupported,
                     fmt::format("{}: has a spectrum of a single channel; two or more are needed", options.input.string())};
    Result<color::Observer> observer = color::observer_by_name_or_file(options.observer);
    if (!observer) return observer.error().at("--observer");
    Meaning meaning{.white = observer->neutral(), .cd_m2 = 1, .observer = observer->name()};
    if (observer->kind() == color::ObserverKind::kCamera) {
        const Result<color::CameraFit> fit = color::fit_camera(*observer);
        if (!fit) return fit.error().at(options.observer).at("--observer");
        observer = observer->as_eye(fit->xyz_from_rgb);
    }
    std::vector<std::array<float, 3>> weights;
    bool sees = false;
    for (const std::array<double, 3>& integral : color::bin_integrals(*observer, nm)) {
        auto& weight = weights.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) weight[c] = static_cast<float>(kLumensPerWatt * integral[c]);
        sees = sees || integral != std::array<double, 3>{};
    }
    if (!sees)
        return Error{ErrorCode::kOutOfRange, fmt::format("{}: its spectrum, of {:.6g} to {:.6g} nm, is invisible to {}",
                                                         options.input.string(), nm.front(), nm.back(), observer->name())};
    reader.integrate(std::move(weights));
    return meaning;
}

// Light in some space: as asked for, else as the file says, else in that of sRGB.
Result<Meaning> read_colour(const ConvertOptions& options, const image::ExrImage& image) {
    Meaning meaning{.cd_m2 = image.white_luminance, .observer = image.observer};
    if (image.film) return meaning;  // exposures, which tools/convert/darkroom.h makes a picture of
    color::Primaries primaries = color::RgbSpace::srgb().primaries;
    bool xyz = image.xyz;
    if (!options.input_space.empty()) {
        xyz = options.input_space == "xyz";
        const Result<color::RgbSpace> space = xyz ? color::RgbSpace::srgb() : color::RgbSpace::parse(options.input_space);
        if (!space) return usage_error(space.error().message + "; or xyz").at("--input-space");
        primaries = space->primaries;
    } else if (image.chromaticities) {
        primaries = color::primaries_of(*image.chromaticities);
    } else if (!xyz && !image.grey) {
        meaning.warnings.push_back(
            fmt::format("{}: has no chromaticities, so its R, G, B are taken as those of sRGB; --input-space names another space",
                        options.input.string()));
    }
    if (!xyz && !color::are_xyz(primaries)) {
        const Result<color::RgbSpace> space =
            color::RgbSpace::from_primaries("chromaticities", primaries, color::Transfer::linear());
        if (!space) return space.error().at(options.input.string());
        meaning.xyz_from_file = space->xyz_from_rgb;
        meaning.white = primaries.white;
    }
    if (const auto& neutral = image.adopted_neutral)
        meaning.white = {static_cast<double>((*neutral)[0]), static_cast<double>((*neutral)[1])};
    return meaning;
}

}  // namespace

double pixel_um(const Source& source, double frame_mm) {
    const image::Rect& whole = source.reader.image().display_window;
    return 1000 * frame_mm / std::max(whole.width(), whole.height());
}

Status Source::read(const image::Rect& from, const std::array<float*, 3>& planes, std::size_t row_stride,
                    image::ExrReader::Scratch& scratch) const {
    if (Status s = reader.read(from, planes, row_stride, scratch); !s || !fall_off) return s;
    for (float* const plane : planes) {
        for (int y = from.y0; y < from.y1; ++y)
            fall_off->apply(from.x0, y,
                            {plane + static_cast<std::size_t>(y - from.y0) * row_stride, static_cast<std::size_t>(from.width())});
    }
    return {};
}

Result<Source> open_source(const ConvertOptions& options) {
    if (!options.picture && is_url(options.input))
        return usage_error(shown_name(options.input) + ": a URL, but pictures are read from files; download it first");
    const image::ExrChoice choice{options.level, options.layer, true};
    Result<image::ExrReader> reader = options.picture ? image::ExrReader::open(options.picture, options.input, choice)
                                                      : image::ExrReader::open(options.input, choice);
    if (!reader && reader.error().code == ErrorCode::kForeign && options.input.extension() == ".latent")
        return Error{ErrorCode::kForeign,
                     fmt::format("{}: holds samples, not pixels; develop it first: latent-develop {} -o {}", options.input.string(),
                                 options.input.filename().string(), options.input.stem().string() + ".exr")};
    if (!reader && reader.error().code == ErrorCode::kForeign && reader.error().message.ends_with("not an OpenEXR file"))
        return Error{ErrorCode::kForeign,
                     reader.error().message + "; latent-convert prints EXR pictures, such as latent-develop writes"};
    if (!reader) return reader.error();
    const image::ExrImage& image = reader->image();
    if (!options.observer.empty() && image.emitted_nm.empty())
        return usage_error(
            fmt::format("--observer: {} has no spectrum (channels S0.<wavelength>nm); choose the observer in "
                        "latent-develop, or write a spectrum with its --spectral-bins",
                        options.input.string()));
    const bool spectral = !options.observer.empty() || !image.has_colour;
    Result<Meaning> meaning = spectral ? see_spectra(options, *reader) : read_colour(options, image);
    if (!meaning) return meaning.error();

    image::Rect area = image.data_window;
    if (options.crop) {
        if (options.crop->empty() || !area.contains(*options.crop)) {
            return usage_error(fmt::format("{}: has pixels {},{} to {},{}; --crop {},{},{},{} is not inside",
                                           options.input.string(), area.x0, area.y0, area.x1, area.y1, options.crop->x0,
                                           options.crop->y0, options.crop->x1, options.crop->y1));
        }
        area = *options.crop;
    }
    std::optional<FallOff> fall_off;
    if (options.vignette) fall_off.emplace(*options.vignette, image.display_window);
    return Source{
        std::move(*reader),           area,    meaning->xyz_from_file, meaning->white, meaning->cd_m2, std::move(meaning->observer),
        std::move(meaning->warnings), fall_off};
}

}  // namespace latent::convert
