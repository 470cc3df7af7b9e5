#include "image/exr_reader.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <openexr.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/file.h"
#include "base/parse.h"
#include "base/recipe.h"
#include "image/exr_channels.h"

namespace latent::image {

namespace {

// Faults that OpenEXR reports while this thread is inside it: its own message, or ours from reading the file, which says more.
struct Fault {
    std::optional<Error> ours;
    std::string theirs;
};
thread_local Fault fault;

void keep_message(exr_const_context_t, exr_result_t, const char* message) {
    if (!fault.theirs.empty()) return;
    for (; *message != 0; ++message) fault.theirs += *message >= ' ' && *message <= '~' ? *message : '?';  // it may quote the file
}

std::int64_t read_file(exr_const_context_t, void* file, void* into, std::uint64_t size, std::uint64_t offset,
                       exr_stream_error_func_ptr_t) {
    const Result<std::size_t> got =
        static_cast<const latent::File*>(file)->read_some(offset, {static_cast<std::byte*>(into), size});
    if (got) return static_cast<std::int64_t>(*got);
    fault.ours = got.error();
    return -1;
}

std::int64_t size_of_file(exr_const_context_t, void* file) {
    const Result<std::uint64_t> size = static_cast<const latent::File*>(file)->size();
    return size ? static_cast<std::int64_t>(*size) : -1;
}

// Three planes of floats that cover an area whose upper left pixel is the corner.
struct Planes {
    std::array<float*, 3> planes;
    std::size_t row_stride;
    int corner_x, corner_y;

    float* at(std::size_t plane, int x, int y) const {
        return planes[plane] + static_cast<std::size_t>(y - corner_y) * row_stride + static_cast<std::size_t>(x - corner_x);
    }
};

Rect rect_of(const exr_attr_box2i_t& box) { return {box.min.x, box.min.y, box.max.x + 1, box.max.y + 1}; }

}  // namespace

struct ExrReader::Scratch::State {
    exr_const_context_t context = nullptr;
    exr_decode_pipeline_t pipeline{};
    Bytes packed;
    std::vector<float> values;

    ~State() {
        if (context != nullptr) exr_decoding_destroy(context, &pipeline);
    }
};

struct ExrReader::File {
    std::shared_ptr<const latent::File> file;
    std::filesystem::path path;
    exr_context_t context = nullptr;
    ExrImage image;
    bool tiled = false;
    int level = 0;
    ExrChannels channels;
    std::vector<std::array<float, 3>> weights{};

    ~File() {
        if (context != nullptr) exr_finish(&context);
    }
    Error error(ErrorCode otherwise, const std::string& where) const {
        if (fault.ours) return *fault.ours;
        return Error{otherwise,
                     fmt::format("{}: {}{}", path.string(), where, fault.theirs.empty() ? "cannot be read" : fault.theirs)};
    }
    Status read_header(const ExrChoice& choice);
    Status find_blocks(int wanted_level);
    Status find_channels(const ExrChoice& choice);
    Status read_attributes();
    std::string words(const char* name, std::size_t longest = 200) const;
    void integrate_row(const std::byte* row, std::size_t width, std::size_t skipped, std::size_t count,
                       const std::array<float*, 3>& out, std::vector<float>& values) const;
    void unpack(const std::byte* rows, int first_row, const Rect& block, const Rect& wanted, const Planes& to,
                std::vector<float>& values) const;
    Status read_block(int column, int row, const Rect& area, const Planes& to, Scratch::State& scratch) const;
    Rect block_area(int column, int row) const {
        const Rect& window = image.data_window;
        const int x0 = window.x0 + column * image.block_width, y0 = window.y0 + row * image.block_height;
        return intersect({x0, y0, x0 + image.block_width, y0 + image.block_height}, window);
    }
};

ExrReader::Scratch::Scratch() : state_(std::make_unique<State>()) {}
ExrReader::Scratch::Scratch(Scratch&&) noexcept = default;
ExrReader::Scratch::~Scratch() = default;

ExrReader::ExrReader(std::unique_ptr<File> file) : file_(std::move(file)) {}
ExrReader::ExrReader(ExrReader&&) noexcept = default;
ExrReader::~ExrReader() = default;

const ExrImage& ExrReader::image() const { return file_->image; }
const std::filesystem::path& ExrReader::path() const { return file_->path; }

void ExrReader::integrate(std::vector<std::array<float, 3>> weights) {
    assert(weights.size() == file_->image.emitted_nm.size());
    file_->weights = std::move(weights);
}

Result<ExrReader> ExrReader::open(const std::filesystem::path& path, const ExrChoice& choice) {
    Result<latent::File> file = latent::File::open_read(path);
    if (!file) return file.error();
    return open(std::make_shared<const latent::File>(*std::move(file)), path, choice);
}

Result<ExrReader> ExrReader::open(std::shared_ptr<const latent::File> opened, const std::filesystem::path& path,
                                  const ExrChoice& choice) {
    auto file = std::make_unique<File>();
    file->file = std::move(opened);
    file->path = path;
    fault = {};
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.user_data = const_cast<latent::File*>(file->file.get());  // only for reading
    setup.read_fn = read_file;
    setup.size_fn = size_of_file;
    setup.error_handler_fn = keep_message;
    setup.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    if (const exr_result_t result = exr_start_read(&file->context, path.c_str(), &setup); result != EXR_ERR_SUCCESS) {
        if (result == EXR_ERR_FILE_BAD_HEADER && !fault.ours) {
            std::array<std::byte, 4> magic{};
            const Result<std::size_t> got = file->file->read_some(0, magic);
            if (!got || *got < magic.size() || load_le<std::uint32_t>(magic.data()) != 0x01312f76)
                return Error{ErrorCode::kForeign, path.string() + ": not an OpenEXR file"};
            return Error{ErrorCode::kTruncated, path.string() + ": its header is damaged or cut off; make the picture again"};
        }
        return file->error(ErrorCode::kForeign, "not a readable OpenEXR file: ");
    }
    if (Status s = file->read_header(choice); !s) return s.error();
    return ExrReader(std::move(file));
}

Status ExrReader::File::read_header(const ExrChoice& choice) {
    const auto unsupported = [&](const std::string& what) { return Error{ErrorCode::kUnsupported, path.string() + ": " + what}; };
    exr_storage_t storage;
    exr_compression_t compression;
    exr_attr_box2i_t data, display;
    if (exr_get_storage(context, 0, &storage) != EXR_ERR_SUCCESS ||
        exr_get_compression(context, 0, &compression) != EXR_ERR_SUCCESS ||
        exr_get_data_window(context, 0, &data) != EXR_ERR_SUCCESS ||
        exr_get_display_window(context, 0, &display) != EXR_ERR_SUCCESS) {
        return error(ErrorCode::kCorrupt, "header: ");
    }
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED) return unsupported("holds deep pixels; flatten it first");
    if (compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB) {  // OpenEXRCore 3.1 cannot decode them
        return unsupported(
            "DWA compression is not supported; convert the file first: oiiotool IN.exr --compression zip -o OUT.exr");
    }
    tiled = storage == EXR_STORAGE_TILED;
    image.data_window = rect_of(data);
    image.display_window = rect_of(display);
    if (Status s = find_blocks(choice.level); !s) return s;
    if (Status s = find_channels(choice); !s) return s;
    return read_attributes();
}

Status ExrReader::File::find_blocks(int wanted_level) {
    image.block_width = image.data_window.width();
    bool good = true;
    if (tiled) {
        std::int32_t levels_x = 1, levels_y = 1;
        std::uint32_t tile_x = 0, tile_y = 0;
        exr_tile_level_mode_t mode;
        exr_tile_round_mode_t rounding;
        good = exr_get_tile_levels(context, 0, &levels_x, &levels_y) == EXR_ERR_SUCCESS &&
               exr_get_tile_descriptor(context, 0, &tile_x, &tile_y, &mode, &rounding) == EXR_ERR_SUCCESS;
        image.block_width = static_cast<int>(std::min(tile_x, static_cast<std::uint32_t>(image.data_window.width())));
        image.block_height = static_cast<int>(std::min(tile_y, static_cast<std::uint32_t>(image.data_window.height())));
        image.levels = std::min(levels_x, levels_y);
    } else {
        good = exr_get_scanlines_per_chunk(context, 0, &image.block_height) == EXR_ERR_SUCCESS;
    }
    if (good && (wanted_level < 0 || wanted_level >= image.levels)) {
        return usage_error(fmt::format("{}: no mip level {}; the file has {}", path.string(), wanted_level,
                                       image.levels == 1 ? "level 0 only" : fmt::format("levels 0 to {}", image.levels - 1)));
    }
    level = wanted_level;
    if (good && level > 0) {
        std::int32_t width = 0, height = 0;
        good = exr_get_level_sizes(context, 0, level, level, &width, &height) == EXR_ERR_SUCCESS;
        const Rect& whole = image.data_window;
        image.data_window = image.display_window = {whole.x0, whole.y0, whole.x0 + width, whole.y0 + height};
    }
    good = good && !image.data_window.empty() && image.block_width > 0 && image.block_height > 0;
    return good ? Status{} : Status{error(ErrorCode::kCorrupt, "header: ")};
}

Status ExrReader::File::find_channels(const ExrChoice& choice) {
    const exr_attr_chlist_t* list = nullptr;
    if (exr_get_channels(context, 0, &list) != EXR_ERR_SUCCESS) return error(ErrorCode::kCorrupt, "channels: ");
    Result<ExrChannels> found = find_exr_channels(path, {list->entries, static_cast<std::size_t>(list->num_channels)}, choice);
    if (!found) return found.error();
    channels = *std::move(found);
    image.has_colour = channels.has_colour;
    image.xyz = channels.xyz;
    image.grey = channels.grey;
    image.emitted_nm = channels.emitted_nm;
    return {};
}

Status ExrReader::File::read_attributes() {
    exr_attr_chromaticities_t c;
    exr_attr_v2f_t neutral;
    float luminance = 0;
    if (exr_attr_get_chromaticities(context, 0, "chromaticities", &c) == EXR_ERR_SUCCESS && !image.xyz) {
        image.chromaticities = {c.red_x, c.red_y, c.green_x, c.green_y, c.blue_x, c.blue_y, c.white_x, c.white_y};
    }
    if (exr_attr_get_v2f(context, 0, "adoptedNeutral", &neutral) == EXR_ERR_SUCCESS) image.adopted_neutral = {neutral.x, neutral.y};
    if (exr_attr_get_float(context, 0, "whiteLuminance", &luminance) == EXR_ERR_SUCCESS && std::isfinite(luminance) &&
        luminance > 0)
        image.white_luminance = static_cast<double>(luminance);
    image.observer = words("latentObserver");
    image.recipe = words("latentRecipe", kLongestRecipe);
    const std::string film = words("latentFilm");
    if (film.empty()) return {};
    const auto number = [&](const char* name, double from, double to) -> Result<double> {
        const std::string text = words(name);
        const Result<double> value = parse_number(text);
        if (value && *value >= from && *value <= to) return value;
        return Error{ErrorCode::kCorrupt,
                     fmt::format("{}: holds exposures of a film, but its {} is '{}', not a number from {} to {}", path.string(),
                                 name, text, from, to)};
    };
    const Result<double> index = number("latentExposureIndex", 0.01, 1e6), push = number("latentPush", -1, 2);
    if (!index || !push) return !index ? index.error() : push.error();
    image.film = ExposedFilm{film, *index, *push};
    return {};
}

// An attribute of text, unless it is longer than that, as far as it can be shown; "" if there is none.
std::string ExrReader::File::words(const char* name, std::size_t longest) const {
    const char* text = nullptr;
    std::int32_t length = 0;
    if (exr_attr_get_string(context, 0, name, &length, &text) != EXR_ERR_SUCCESS || static_cast<std::size_t>(length) > longest)
        return "";
    std::string shown(text, static_cast<std::size_t>(length));
    std::ranges::replace_if(
        shown, [](char letter) { return letter < ' ' || letter > '~'; }, '?');
    return shown;
}

// A block holds its rows one after another, each of them its channels one after another. Takes the wanted part of it out of `rows`,
// which begin with row `first_row` of the block.
void ExrReader::File::unpack(const std::byte* rows, int first_row, const Rect& block, const Rect& wanted, const Planes& to,
                             std::vector<float>& values) const {
    const std::size_t width = static_cast<std::size_t>(block.width()), skipped = static_cast<std::size_t>(wanted.x0 - block.x0);
    const std::size_t count = static_cast<std::size_t>(wanted.width());
    for (int y = wanted.y0; y < wanted.y1; ++y) {
        const std::byte* row = rows + static_cast<std::size_t>(y - first_row) * width * channels.pixel_bytes;
        const std::array<float*, 3> out{to.at(0, wanted.x0, y), to.at(1, wanted.x0, y), to.at(2, wanted.x0, y)};
        if (!weights.empty()) {
            integrate_row(row, width, skipped, count, out, values);
            continue;
        }
        for (std::size_t plane = 0; plane < 3; ++plane) {
            const ExrChannel& channel = channels.colour[plane];
            load_channel(row + width * channel.offset + skipped * (channel.half ? 2 : 4), channel.half, {out[plane], count});
        }
    }
}

// Sums of all channels, in the order of their wavelengths. `values` are kept for the next row.
void ExrReader::File::integrate_row(const std::byte* row, std::size_t width, std::size_t skipped, std::size_t count,
                                    const std::array<float*, 3>& out, std::vector<float>& values) const {
    values.resize(count);
    for (float* plane : out) std::fill_n(plane, count, 0.0F);
    for (std::size_t c = 0; c < weights.size(); ++c) {
        const ExrChannel& channel = channels.emitted[c];
        load_channel(row + width * channel.offset + skipped * (channel.half ? 2 : 4), channel.half, values);
        for (std::size_t plane = 0; plane < 3; ++plane) {
            const float weight = weights[c][plane];
            if (weight == 0) continue;  // beyond the observer's curves; whatever is there is not seen
            for (std::size_t i = 0; i < count; ++i) out[plane][i] += weight * values[i];
        }
    }
}

Status ExrReader::File::read_block(int column, int row, const Rect& area, const Planes& to, Scratch::State& scratch) const {
    const Rect block = block_area(column, row);
    const Rect wanted = intersect(block, area);
    const auto failed = [&] { return error(ErrorCode::kCorrupt, fmt::format("block at {},{}: ", block.x0, block.y0)); };
    fault = {};
    exr_chunk_info_t chunk;
    const exr_result_t found = tiled ? exr_read_tile_chunk_info(context, 0, column, row, level, level, &chunk)
                                     : exr_read_scanline_chunk_info(context, 0, block.y0, &chunk);
    if (found != EXR_ERR_SUCCESS || chunk.unpacked_size != block.pixels() * channels.pixel_bytes) return failed();
    if (chunk.packed_size == chunk.unpacked_size) {  // not compressed: read the wanted rows only
        const std::size_t row_bytes = static_cast<std::size_t>(block.width()) * channels.pixel_bytes;
        scratch.packed.resize(row_bytes * static_cast<std::size_t>(wanted.height()));
        const std::uint64_t at = chunk.data_offset + row_bytes * static_cast<std::size_t>(wanted.y0 - block.y0);
        if (Status s = file->read_exact(at, scratch.packed); !s) return s;
        unpack(scratch.packed.data(), wanted.y0, block, wanted, to, scratch.values);
        return {};
    }
    exr_decode_pipeline_t& pipeline = scratch.pipeline;
    if (scratch.context != nullptr) {
        if (exr_decoding_update(context, 0, &chunk, &pipeline) != EXR_ERR_SUCCESS) return failed();
    } else {
        if (exr_decoding_initialize(context, 0, &chunk, &pipeline) != EXR_ERR_SUCCESS) return failed();
        scratch.context = context;
        if (exr_decoding_choose_default_routines(context, 0, &pipeline) != EXR_ERR_SUCCESS) return failed();
        // OpenEXR reads and decompresses only: its own unpacking of half pixels crashes where a channel is left out (3.1.5).
        pipeline.unpack_and_convert_fn = nullptr;
    }
    if (exr_decoding_run(context, 0, &pipeline) != EXR_ERR_SUCCESS) return failed();
    unpack(static_cast<const std::byte*>(pipeline.unpacked_buffer), block.y0, block, wanted, to, scratch.values);
    return {};
}

Status ExrReader::read(const Rect& area, const std::array<float*, 3>& planes, std::size_t row_stride, Scratch& scratch) const {
    const Rect& window = file_->image.data_window;
    const int width = file_->image.block_width, height = file_->image.block_height;
    assert(!area.empty() && window.contains(area));
    const Planes to{planes, row_stride, area.x0, area.y0};
    for (int row = (area.y0 - window.y0) / height; row <= (area.y1 - 1 - window.y0) / height; ++row) {
        for (int column = (area.x0 - window.x0) / width; column <= (area.x1 - 1 - window.x0) / width; ++column) {
            if (Status s = file_->read_block(column, row, area, to, *scratch.state_); !s) return s;
        }
    }
    return {};
}

}  // namespace latent::image
