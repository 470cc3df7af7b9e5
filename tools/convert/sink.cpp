#include "tools/convert/sink.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <iterator>

#include "base/output_name.h"
#include "base/url.h"
#include "image/deep_zoom_writer.h"
#include "image/exr_writer.h"
#include "image/jpeg_writer.h"
#include "image/png_writer.h"
#include "image/tiff_writer.h"
#include "tools/convert/encoder.h"
#include "tools/convert/viewer_page.h"

namespace latent::convert {

using image::PixelFormat;
using image::Rect;
using image::SampleType;

namespace {

// What pyramids and single images have in common. `write_rows(level, rows)` passes rows of a level to the writer.
template <class Writer>
class WriterSink final : public Sink {
 public:
    using WriteRows = std::function<Status(Writer&, std::size_t level, ByteSpan rows)>;

    // `levels`: 1 without a pyramid.
    WriterSink(std::unique_ptr<Writer> writer, const PrintedPicture& picture, const Encoder& encoder, std::size_t levels,
               std::size_t rows_held, WriteRows write_rows)
        : writer_(std::move(writer)),
          area_(picture.area),
          encoder_(encoder),
          levels_(levels),
          rows_held_(rows_held),
          pyramid_((picture.area.height() + 1) / 2, levels),
          write_rows_(std::move(write_rows)) {}

    std::size_t bytes_per_row() const override {
        return row_bytes(area_.width()) + (levels_ > 1 ? 3 * sizeof(float) * static_cast<std::size_t>(area_.width()) / 4 : 0);
    }
    std::size_t bytes_held() const override { return rows_held_ * row_bytes(area_.width()) * (levels_ > 1 ? 2 : 1); }

    Band new_band(const Rect& area) const override {
        Band band{area, Bytes(row_bytes(area.width()) * static_cast<std::size_t>(area.height())), {}};
        if (levels_ > 1) band.halved = PlanarRows((area.width() + 1) / 2, (area.height() + 1) / 2);
        return band;
    }

    void take(Band& band, const PrintedBlock& block) const override {
        const Rect& area = block.area;
        for (int y = area.y0; y < area.y1; ++y) {
            std::byte* out = band.codes.data() + static_cast<std::size_t>(y - band.area.y0) * row_bytes(band.area.width()) +
                             row_bytes(area.x0 - band.area.x0);
            encoder_.encode(0, {block.row(0, y), block.row(1, y), block.row(2, y)}, area.x0, y, out);
        }
        if (levels_ == 1) return;
        for (int y = area.y0; y < area.y1; y += 2) {
            for (std::size_t c = 0; c < 3; ++c) {
                float* out = band.halved.plane((y - band.area.y0) / 2, c) + (area.x0 - band.area.x0) / 2;
                halve(block.row(c, y).data(), y + 1 < area.y1 ? block.row(c, y + 1).data() : nullptr,
                      static_cast<std::size_t>(area.width()), out);
            }
        }
    }

    Status write(Band& band) override {
        if (Status s = write_rows_(*writer_, 0, band.codes); !s) return s;
        band.codes = {};
        if (levels_ == 1) return {};
        return pyramid_.add(std::move(band.halved), [this](std::size_t level, int y, const PlanarRows& rows) {
            Bytes codes(row_bytes(rows.width) * static_cast<std::size_t>(rows.height));
            tbb::parallel_for(0, rows.height, [&](int i) {
                const auto plane = [&](std::size_t c) { return std::span(rows.plane(i, c), static_cast<std::size_t>(rows.width)); };
                encoder_.encode(level, {plane(0), plane(1), plane(2)}, 0, y + i,
                                codes.data() + static_cast<std::size_t>(i) * row_bytes(rows.width));
            });
            return write_rows_(*writer_, level, codes);
        });
    }
    Status finish() override { return writer_->finish(); }
    Status publish() override { return writer_->publish(); }

 private:
    std::size_t row_bytes(int width) const { return static_cast<std::size_t>(width) * encoder_.pixel_bytes(); }

    std::unique_ptr<Writer> writer_;
    Rect area_;
    Encoder encoder_;
    std::size_t levels_, rows_held_;
    Pyramid pyramid_;
    WriteRows write_rows_;
};

// What a file says about the print. Numbers as they were used, no names of files.
std::vector<std::pair<std::string, std::string>> texts(const PrintedPicture& picture, const Display& display,
                                                       const ConvertOptions& options) {
    std::vector<std::pair<std::string, std::string>> all{{"Software", "latent-convert " LATENT_VERSION},
                                                         {"Sensitivity", fmt::format("{}", picture.sigma)},
                                                         {"Tone", options.tone},
                                                         {"Gamut", options.gamut},
                                                         {"Profile", display.space.name},
                                                         {"White", text_of(picture.white)},
                                                         {"Adaptation", options.adapt}};
    if (!picture.observer.empty()) all.emplace_back("Observer", picture.observer);
    if (!picture.film.empty()) all.emplace_back("Film", picture.film);
    if (options.vignette) all.emplace_back("Vignette", options.vignette->text);
    if (const auto& glare = options.glare)
        all.emplace_back("Glare", glare->aperture.empty() ? glare->text : fmt::format("f:{}", glare->f_number));
    if (!options.dodges.empty()) {
        std::vector<std::string_view> dodges;
        for (const Dodge& dodge : options.dodges) dodges.emplace_back(dodge.text);
        all.emplace_back("Dodge", fmt::format("{}", fmt::join(dodges, " ")));
    }
    if (options.contrast != 1) all.emplace_back("Contrast", fmt::format("{}", options.contrast));
    if (options.black != 0) all.emplace_back("Black", fmt::format("{}", options.black));
    if (const std::string shown = shown_by(options); !shown.empty()) all.emplace_back("Shown", shown);
    if (!display.proof_name.empty()) all.emplace_back("Proof", display.proof_name);
    if (display.gamut) {
        const Rendering& rendering = options.rendering;
        all.emplace_back("Intent", name_of(rendering.intent));
        if (rendering.intent != Intent::kAbsolute)
            all.emplace_back("BlackPointCompensation", rendering.compensates() ? "yes" : "no");
    }
    if (!picture.recipe.empty()) all.emplace_back("Recipe", picture.recipe);
    return all;
}

Result<std::unique_ptr<Sink>> rows_sink(Result<std::unique_ptr<image::RowWriter>> writer, const PrintedPicture& picture,
                                        const Encoder& encoder) {
    if (!writer) return writer.error();
    return std::make_unique<WriterSink<image::RowWriter>>(
        std::move(*writer), picture, encoder, 1, 64,
        [](image::RowWriter& w, std::size_t, ByteSpan rows) { return w.write_rows(rows); });
}

Result<std::unique_ptr<Sink>> exr_sink(OutputFile out, const PrintedPicture& picture, const Display& display,
                                       const ConvertOptions& options) {
    image::ExrTags tags;
    tags.pixels_per_inch = options.dpi;
    if (display.space.rgb_from_xyz.invertible()) tags.chromaticities = color::chromaticities_of(display.space.primaries);
    for (auto& [key, value] : texts(picture, display, options)) {
        tags.texts.emplace_back(
            key == "Software" ? "software" : "latent:" + std::string(1, static_cast<char>(key[0] | 0x20)) + key.substr(1), value);
    }
    return rows_sink(
        image::create_exr(std::move(out), picture.area, picture.display_window, options.depth == Depth::k16, tags, options.threads),
        picture, Encoder{SampleType::kF32, color::Transfer::linear(), color::Dither::kNone, {}});
}

Result<std::unique_ptr<Sink>> tiff_sink(OutputFile out, const PrintedPicture& picture, const image::ImageTags& tags,
                                        const Encoder& encoder, const ConvertOptions& options) {
    std::vector<PixelFormat> formats{encoder.format(picture.area.width(), picture.area.height())};
    while (options.pyramid && std::max(formats.back().width, formats.back().height) > image::kTiffTile) {
        const PixelFormat& last = formats.back();
        formats.push_back(encoder.format((last.width + 1) / 2, (last.height + 1) / 2));
    }
    const image::TiffOptions how{options.tiles || options.pyramid, options.png_level};
    Result<std::unique_ptr<image::TiffWriter>> writer = image::TiffWriter::create(std::move(out), formats, tags, how);
    if (!writer) return writer.error();
    return std::make_unique<WriterSink<image::TiffWriter>>(
        std::move(*writer), picture, encoder, formats.size(), how.tiles ? image::kTiffTile : 64,
        [](image::TiffWriter& w, std::size_t level, ByteSpan rows) { return w.write_rows(level, rows); });
}

Result<std::unique_ptr<Sink>> deep_zoom_sink(const std::filesystem::path& path, const PrintedPicture& picture,
                                             const Display& display, const Encoder& encoder, const ConvertOptions& options) {
    image::DeepZoomOptions how;
    how.overlap = options.overlap;
    how.png = options.png_tiles;
    how.jpeg.quality = options.quality;
    how.png_options.level = options.png_level;
    how.replace = options.replace;
    how.recipe = picture.recipe;
    image::ImageTags tags;  // left empty where that means sRGB: there are thousands of tiles
    if (!display.srgb) tags.icc = display.icc;
    const int width = picture.area.width(), height = picture.area.height();
    std::optional<OtherPyramid> other;
    if (!options.compare.empty()) {
        const Result<OtherPyramid> read = read_pyramid(options.compare, path, width, height);
        if (!read) return read.error().at("--compare");
        other = *read;
    }
    const std::string page = viewer_page(path.stem().string(), width, height, how, other);
    Result<std::unique_ptr<image::DeepZoomWriter>> writer = image::DeepZoomWriter::create(path, width, height, tags, page, how);
    if (!writer) return writer.error();
    return std::make_unique<WriterSink<image::DeepZoomWriter>>(
        std::move(*writer), picture, encoder, image::deep_zoom_levels(width, height).size(),
        static_cast<std::size_t>(how.tile + 2 * how.overlap),
        [](image::DeepZoomWriter& w, std::size_t level, ByteSpan rows) { return w.write_rows(level, rows); });
}

class CodeWriter {
 public:
    explicit CodeWriter(CodeValues& to) : to_(to) {}
    Status write_rows(ByteSpan rows) {
        to_.codes.insert(to_.codes.end(), rows.begin(), rows.end());
        return {};
    }
    static Status finish() { return {}; }
    static Status publish() { return {}; }

 private:
    CodeValues& to_;
};

Encoder encoder_for(const Display& display, const ConvertOptions& options) {
    Encoder encoder{SampleType::kU8, display.device ? color::Transfer::linear() : display.space.transfer, options.dither,
                    display.device};
    if (options.grey) {
        const auto& m = display.space.luminance_row;
        encoder.grey = {static_cast<float>(m[0]), static_cast<float>(m[1]), static_cast<float>(m[2])};
    }
    return encoder;
}

// The extension in lower case.
std::string type_of(const std::filesystem::path& path) {
    std::string type = path.extension().string();
    for (char& c : type) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return type;
}

// Why a file of this type cannot have that depth, and what to do; empty if it can.
std::string_view lacks_depth(std::string_view type, Depth depth) {
    if (type == ".png" && depth == Depth::kFloat) return "PNG has 8 or 16 bits; use .tif or .exr for floats";
    if (type == ".exr" && depth == Depth::k8) return "EXR has floats, or half floats with --bits 16";
    if ((type == ".jpg" || type == ".jpeg" || type == ".dzi") && (depth == Depth::k16 || depth == Depth::kFloat))
        return "JPEG and Deep Zoom have 8 bits; use .png, .tif or .exr for more";
    return "";
}

}  // namespace

Status check_types(const ConvertOptions& options, std::vector<std::string>& notes) {
    constexpr std::string_view kTypes[] = {".png", ".tif", ".tiff", ".jpg", ".jpeg", ".exr", ".dzi"};
    std::vector<std::string> lacking;
    for (const std::filesystem::path& path : options.outputs) {
        const std::string type = type_of(path);
        if (const std::string problem = objection_to_output(path); !problem.empty()) return usage_error(problem).at("--output");
        if (std::ranges::find(kTypes, type) == std::end(kTypes))
            return usage_error(fmt::format("{}: the name must end in .png, .tif, .jpg, .exr or .dzi", shown_name(path)));
        const std::string_view why = lacks_depth(type, options.depth);
        if (!why.empty()) lacking.push_back(fmt::format("{}: {}", path.string(), why));
    }
    if (!lacking.empty() && lacking.size() == options.outputs.size()) return usage_error(lacking.front());
    for (const std::string& why : lacking) notes.push_back("--bits is only for the other outputs: " + why);
    return {};
}

Result<std::unique_ptr<Sink>> open_sink(const std::filesystem::path& path, const PrintedPicture& picture, const Display& display,
                                        const ConvertOptions& options) {
    const std::string type = type_of(path);
    const bool png = type == ".png", tiff = type == ".tif" || type == ".tiff", jpeg = type == ".jpg" || type == ".jpeg";
    Encoder encoder = encoder_for(display, options);
    if ((png || tiff) && options.depth == Depth::k16) encoder.sample = SampleType::kU16;
    if (tiff && options.depth == Depth::kFloat) encoder.sample = SampleType::kF32;
    if (options.grey && (type == ".exr" || type == ".dzi"))
        return usage_error(fmt::format("{}: one channel of grey fits .png, .tif and .jpg", path.string()));
    if (encoder.channels() == 4 && encoder.sample == SampleType::kF32)
        return usage_error(fmt::format("{}: inks (CMYK) have 8 or 16 bits", path.string()));
    if (encoder.channels() == 4 && !tiff && !jpeg)
        return usage_error(fmt::format("{}: the profile is one of inks (CMYK), which only .tif and .jpg hold", path.string()));
    if (type == ".exr" && display.has_tables())
        return usage_error(
            fmt::format("{}: EXR holds light, not the code values of a profile with tables; use .tif, "
                        ".png, .jpg or .dzi",
                        path.string()));
    if (type == ".dzi") return deep_zoom_sink(path, picture, display, encoder, options);

    Result<OutputFile> out = OutputFile::create(path, options.replace);
    if (!out) return out.error();
    if (type == ".exr") return exr_sink(std::move(*out), picture, display, options);
    const image::ImageTags tags{display.icc, display.srgb, display.cicp, texts(picture, display, options), options.dpi};
    if (tiff) return tiff_sink(std::move(*out), picture, tags, encoder, options);
    const PixelFormat format = encoder.format(picture.area.width(), picture.area.height());
    if (png) return rows_sink(image::create_png(std::move(*out), format, tags, {options.png_level}), picture, encoder);
    return rows_sink(image::create_jpeg(std::move(*out), format, tags, {options.quality}), picture, encoder);
}

Result<std::unique_ptr<Sink>> code_sink(CodeValues& codes, const PrintedPicture& picture, const Display& display,
                                        const ConvertOptions& options) {
    const Encoder encoder = encoder_for(display, options);
    if (encoder.channels() == 4) return usage_error("the profile is one of inks (CMYK), which no display shows; --proof does");
    codes.width = picture.area.width(), codes.height = picture.area.height(), codes.channels = encoder.channels();
    codes.srgb = display.srgb;
    codes.icc.assign(display.icc.begin(), display.icc.end());
    return std::make_unique<WriterSink<CodeWriter>>(std::make_unique<CodeWriter>(codes), picture, encoder, 1, 64,
                                                    [](CodeWriter& w, std::size_t, ByteSpan rows) { return w.write_rows(rows); });
}

}  // namespace latent::convert
