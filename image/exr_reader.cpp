#include "image/exr_reader.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <half.h>
#include <openexr.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <span>
#include <vector>

#include "base/file.h"

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

    ~State() {
        if (context != nullptr) exr_decoding_destroy(context, &pipeline);
    }
};

// Where one of our planes is in each pixel row of the file: bytes per pixel of the channels before it, which are in alphabetic
// order.
struct Channel {
    std::size_t offset = 0;
    bool half = false;
};

struct ExrReader::File {
    latent::File file;
    std::filesystem::path path;
    exr_context_t context = nullptr;
    ExrImage image;
    bool tiled = false;
    int level = 0;
    std::size_t pixel_bytes = 0;  // of all channels of the file
    std::array<Channel, 3> channels{};

    ~File() {
        if (context != nullptr) exr_finish(&context);
    }
    Error error(ErrorCode otherwise, const std::string& where) const {
        if (fault.ours) return *fault.ours;
        return Error{otherwise,
                     fmt::format("{}: {}{}", path.string(), where, fault.theirs.empty() ? "cannot be read" : fault.theirs)};
    }
    Status read_header(int wanted_level);
    Status find_blocks(int wanted_level);
    Status find_channels();
    void read_attributes();
    void unpack(const std::byte* rows, int first_row, const Rect& block, const Rect& wanted, const Planes& to) const;
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

Result<ExrReader> ExrReader::open(const std::filesystem::path& path, int level) {
    auto file = std::make_unique<File>();
    Result<latent::File> opened = latent::File::open_read(path);
    if (!opened) return opened.error();
    file->file = std::move(*opened);
    file->path = path;
    fault = {};
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.user_data = &file->file;
    setup.read_fn = read_file;
    setup.size_fn = size_of_file;
    setup.error_handler_fn = keep_message;
    setup.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    if (const exr_result_t result = exr_start_read(&file->context, path.c_str(), &setup); result != EXR_ERR_SUCCESS) {
        if (result == EXR_ERR_FILE_BAD_HEADER && !fault.ours)
            return Error{ErrorCode::kForeign, path.string() + ": not an OpenEXR file"};
        return file->error(ErrorCode::kForeign, "not a readable OpenEXR file: ");
    }
    if (Status s = file->read_header(level); !s) return s.error();
    return ExrReader(std::move(file));
}

Status ExrReader::File::read_header(int wanted_level) {
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
    if (Status s = find_blocks(wanted_level); !s) return s;
    if (Status s = find_channels(); !s) return s;
    read_attributes();
    return {};
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
        return Error{ErrorCode::kUsage,
                     fmt::format("{}: no mip level {}; the file has {}", path.string(), wanted_level,
                                 image.levels == 1 ? "level 0 only" : fmt::format("levels 0 to {}", image.levels - 1))};
    }
    level = wanted_level;
    if (good && level > 0) {
        std::int32_t width = 0, height = 0;
        good = exr_get_level_sizes(context, 0, level, level, &width, &height) == EXR_ERR_SUCCESS;
        const Rect& whole = image.data_window;
        image.data_window = image.display_window = {whole.x0, whole.y0, whole.x0 + width, whole.y0 + height};
    }
    return good ? Status{} : Status{error(ErrorCode::kCorrupt, "header: ")};
}

Status ExrReader::File::find_channels() {
    const exr_attr_chlist_t* list = nullptr;
    if (exr_get_channels(context, 0, &list) != EXR_ERR_SUCCESS) return error(ErrorCode::kCorrupt, "channels: ");
    const std::span<const exr_attr_chlist_entry_t> entries(list->entries, static_cast<std::size_t>(list->num_channels));
    const auto find = [&](std::string_view name) {
        return std::find_if(entries.begin(), entries.end(),
                            [&](const exr_attr_chlist_entry_t& entry) { return name == entry.name.str; });
    };
    const auto all_there = [&](const std::array<const char*, 3>& names) {
        return std::all_of(names.begin(), names.end(), [&](const char* name) { return find(name) != entries.end(); });
    };
    std::array<const char*, 3> names{"R", "G", "B"};
    if (!all_there(names)) {
        image.xyz = all_there({"X", "Y", "Z"});
        names = image.xyz ? std::array{"X", "Y", "Z"} : std::array{"Y", "Y", "Y"};
    }
    if (!all_there(names)) {
        std::string found;
        for (const exr_attr_chlist_entry_t& entry : entries)
            found += fmt::format("{}{}", found.empty() ? "" : ", ", entry.name.str);
        return Error{ErrorCode::kUnsupported,
                     fmt::format("{}: no channels R, G, B or X, Y, Z; the file has {}", path.string(), found)};
    }
    for (std::size_t plane = 0; plane < 3; ++plane) {
        const auto entry = find(names[plane]);
        if (entry->pixel_type == EXR_PIXEL_UINT) {
            return Error{ErrorCode::kUnsupported, fmt::format("{}: channel {} holds integers; only half and float are supported",
                                                              path.string(), names[plane])};
        }
        channels[plane].half = entry->pixel_type == EXR_PIXEL_HALF;
        for (auto before = entries.begin(); before != entry; ++before)
            channels[plane].offset += before->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    }
    for (const exr_attr_chlist_entry_t& entry : entries) {
        pixel_bytes += entry.pixel_type == EXR_PIXEL_HALF ? 2 : 4;
        if (entry.x_sampling != 1 || entry.y_sampling != 1) {
            return Error{ErrorCode::kUnsupported,
                         fmt::format("{}: channel {} is subsampled; convert it to full size first", path.string(), entry.name.str)};
        }
    }
    return {};
}

void ExrReader::File::read_attributes() {
    exr_attr_chromaticities_t c;
    exr_attr_v2f_t neutral;
    if (exr_attr_get_chromaticities(context, 0, "chromaticities", &c) == EXR_ERR_SUCCESS && !image.xyz) {
        image.chromaticities = {c.red_x, c.red_y, c.green_x, c.green_y, c.blue_x, c.blue_y, c.white_x, c.white_y};
    }
    if (exr_attr_get_v2f(context, 0, "adoptedNeutral", &neutral) == EXR_ERR_SUCCESS) image.adopted_neutral = {neutral.x, neutral.y};
}

// A block holds its rows one after another, each of them its channels one after another. Takes the wanted part of it out of `rows`,
// which begin with row `first_row` of the block.
void ExrReader::File::unpack(const std::byte* rows, int first_row, const Rect& block, const Rect& wanted, const Planes& to) const {
    const std::size_t width = static_cast<std::size_t>(block.width()), skipped = static_cast<std::size_t>(wanted.x0 - block.x0);
    const std::size_t count = static_cast<std::size_t>(wanted.width());
    for (int y = wanted.y0; y < wanted.y1; ++y) {
        const std::byte* row = rows + static_cast<std::size_t>(y - first_row) * width * pixel_bytes;
        for (std::size_t plane = 0; plane < 3; ++plane) {
            const Channel& channel = channels[plane];
            const std::byte* from = row + width * channel.offset + skipped * (channel.half ? 2 : 4);
            float* out = to.at(plane, wanted.x0, y);
            if (channel.half) {
                for (std::size_t i = 0; i < count; ++i) out[i] = imath_half_to_float(load_le<imath_half_bits_t>(from + 2 * i));
            } else if (std::endian::native == std::endian::little) {
                std::memcpy(out, from, count * sizeof(float));
            } else {
                for (std::size_t i = 0; i < count; ++i) out[i] = load_le<float>(from + 4 * i);
            }
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
    if (found != EXR_ERR_SUCCESS || chunk.unpacked_size != block.pixels() * pixel_bytes) return failed();
    if (chunk.packed_size == chunk.unpacked_size) {  // not compressed: read the wanted rows only
        const std::size_t row_bytes = static_cast<std::size_t>(block.width()) * pixel_bytes;
        scratch.packed.resize(row_bytes * static_cast<std::size_t>(wanted.height()));
        const std::uint64_t at = chunk.data_offset + row_bytes * static_cast<std::size_t>(wanted.y0 - block.y0);
        if (Status s = file.read_exact(at, scratch.packed); !s) return s;
        unpack(scratch.packed.data(), wanted.y0, block, wanted, to);
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
    unpack(static_cast<const std::byte*>(pipeline.unpacked_buffer), block.y0, block, wanted, to);
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
