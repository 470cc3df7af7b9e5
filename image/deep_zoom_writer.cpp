#include "image/deep_zoom_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include "base/file.h"
#include "base/first_error.h"
#include "base/output_set.h"
#include "image/row_blocks.h"

namespace latent::image {

namespace fs = std::filesystem;

namespace {

ByteSpan bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

fs::path files_of(const fs::path& path) { return fs::path(path).replace_extension() += "_files"; }

// The text of NAME.dzi [DZI].
// As a comment of XML, which must not hold "--".
std::string as_comment(std::string recipe) {
    for (std::size_t at = 0; (at = recipe.find("--", at)) != std::string::npos; ++at) recipe.replace(at + 1, 1, "\\u002d");
    return recipe.empty() ? "" : fmt::format("<!-- Recipe: {} -->\n", recipe);
}

std::string descriptor(int width, int height, const DeepZoomOptions& options) {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<Image xmlns=\"http://schemas.microsoft.com/deepzoom/2008\" Format=\"{}\" Overlap=\"{}\" TileSize=\"{}\">\n"
        "  <Size Width=\"{}\" Height=\"{}\"/>\n"
        "</Image>\n{}",
        options.png ? "png" : "jpg", options.overlap, options.tile, width, height, as_comment(options.recipe));
}

class PyramidWriter final : public DeepZoomWriter {
 public:
    PyramidWriter(OutputSet outputs, const fs::path& path, const std::vector<PixelFormat>& levels, const ImageTags& tags,
                  const DeepZoomOptions& options)
        : outputs_(std::move(outputs)), path_(path), options_(options), tags_(tags), levels_(levels) {
        tags_.texts.clear();
        for (const PixelFormat& level : levels_)
            blocks_.emplace_back(level.height, level.row_bytes(), options.tile, options.overlap, options.overlap);
    }

    // `texts`: of the files that the names after the first will have.
    Status start(const std::vector<OutputSet::Item>& items, const std::vector<std::string>& texts) {
        for (std::size_t i = 0; i < texts.size(); ++i) {
            if (Status s = write_file(outputs_.place(i + 1), items[i + 1].name, bytes_of(texts[i]), true); !s) return s;
        }
        std::error_code failed;
        fs::create_directory(outputs_.place(0), failed);
        for (std::size_t level = 0; !failed && level < levels_.size(); ++level)
            fs::create_directory(outputs_.place(0) / std::to_string(level), failed);
        if (failed) return error_from_errno(failed.value(), files_of(path_).string(), "cannot create");
        return {};
    }

    Status write_rows(std::size_t halvings, ByteSpan rows) override {
        const std::vector<RowBlock> bands = blocks_[halvings].take(rows);
        const std::size_t across = static_cast<std::size_t>((levels_[halvings].width + options_.tile - 1) / options_.tile);
        FirstError error;
        tbb::parallel_for(std::size_t{0}, bands.size() * across, [&](std::size_t i) {
            error.keep(write_tile(halvings, bands[i / across], static_cast<int>(i % across)));
        });
        blocks_[halvings].settle();
        return error.status();
    }

    Status finish() override { return {}; }

    Status publish() override {
        sync_tiles();
        return outputs_.publish();
    }

 private:
    // One sync of the whole file system instead of one for each of thousands of tiles; it is a courtesy, so it may fail.
    void sync_tiles() const {
        const int fd = ::open(outputs_.place(0).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (fd < 0) return;
        ::syncfs(fd);
        ::close(fd);
    }

    Status write_tile(std::size_t halvings, const RowBlock& band, int column) const {
        const PixelFormat& level = levels_[halvings];
        const int x0 = std::max(0, column * options_.tile - options_.overlap);
        const int x1 = std::min(level.width, (column + 1) * options_.tile + options_.overlap);
        const PixelFormat format{x1 - x0, static_cast<int>(band.rows.size()), SampleType::kU8};
        std::vector<const std::byte*> rows = band.rows;
        for (const std::byte*& row : rows) row += 3 * static_cast<std::size_t>(x0);
        Result<Bytes> tile =
            options_.png ? encode_png(rows, format, tags_, options_.png_options) : encode_jpeg(rows, format, tags_, options_.jpeg);
        if (!tile) return tile.error().at(path_.string());
        const std::size_t number = levels_.size() - 1 - halvings;
        const fs::path name = fs::path(std::to_string(number)) /
                              fmt::format("{}_{}.{}", column, band.first / options_.tile, options_.png ? "png" : "jpg");
        return write_file(outputs_.place(0) / name, files_of(path_) / name, *tile, false);
    }

    // `name`: what it will be called, for errors.
    static Status write_file(const fs::path& place, const fs::path& name, ByteSpan bytes, bool sync) {
        Result<File> file = File::create_exclusive(place);
        Status status = file ? file->write_all(0, bytes) : Status(file.error());
        if (status && sync) status = file->sync_data();
        if (status) status = file->close();
        if (status) return {};
        return Error{status.error().code, name.string() + status.error().message.substr(place.string().size())};
    }

    OutputSet outputs_;  // NAME_files, NAME.html if there is one, NAME.dzi
    fs::path path_;
    DeepZoomOptions options_;
    ImageTags tags_;
    std::vector<PixelFormat> levels_;
    std::vector<RowBlocks> blocks_;
};

}  // namespace

std::vector<PixelFormat> deep_zoom_levels(int width, int height) {
    std::vector<PixelFormat> levels{{width, height, SampleType::kU8}};
    while (width > 1 || height > 1) {
        width = (width + 1) / 2;
        height = (height + 1) / 2;
        levels.push_back({width, height, SampleType::kU8});
    }
    return levels;
}

Result<std::unique_ptr<DeepZoomWriter>> DeepZoomWriter::create(const fs::path& path, int width, int height, const ImageTags& tags,
                                                               const std::string& page, const DeepZoomOptions& options) {
    std::vector<OutputSet::Item> items = {{files_of(path), true}};
    std::vector<std::string> texts;
    if (!page.empty()) {
        items.push_back({fs::path(path).replace_extension(".html")});
        texts.push_back(page);
    }
    items.push_back({path});
    texts.push_back(descriptor(width, height, options));
    Result<OutputSet> outputs = OutputSet::create(items, options.replace);
    if (!outputs) return outputs.error();
    auto writer = std::make_unique<PyramidWriter>(std::move(*outputs), path, deep_zoom_levels(width, height), tags, options);
    if (Status s = writer->start(items, texts); !s) return s.error();
    return writer;
}

}  // namespace latent::image
