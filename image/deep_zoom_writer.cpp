#include "image/deep_zoom_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <optional>

#include "base/file.h"
#include "base/first_error.h"
#include "base/temporary_path.h"
#include "image/row_blocks.h"

namespace latent::image {

namespace fs = std::filesystem;

namespace {

ByteSpan bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

// rename(2) that does not replace an empty folder either, where the file system can promise it.
Status rename_folder(const fs::path& from, const fs::path& to) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return {};
    if (errno == EINVAL && !fs::exists(to) && ::rename(from.c_str(), to.c_str()) == 0) return {};
    return error_from_errno(errno, to.string(), "cannot name the finished folder");
}

// The text of NAME.dzi [DZI].
std::string descriptor(int width, int height, const DeepZoomOptions& options) {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<Image xmlns=\"http://schemas.microsoft.com/deepzoom/2008\" Format=\"{}\" Overlap=\"{}\" TileSize=\"{}\">\n"
        "  <Size Width=\"{}\" Height=\"{}\"/>\n"
        "</Image>\n",
        options.png ? "png" : "jpg", options.overlap, options.tile, width, height);
}

class Writer final : public DeepZoomWriter {
 public:
    Writer(const fs::path& path, int width, int height, const ImageTags& tags, const DeepZoomOptions& options)
        : path_(path), options_(options), tags_(tags), levels_(deep_zoom_levels(width, height)) {
        tags_.texts.clear();
        files_ = fs::path(path).replace_extension() += "_files";
        hidden_ = TemporaryPath(folder_of(path) / (hidden_prefix() + make_nonce() + kHiddenSuffix));
        for (const PixelFormat& level : levels_)
            blocks_.emplace_back(level.height, level.row_bytes(), options.tile, options.overlap, options.overlap);
    }
    ~Writer() override {
        hidden_ = {};
        if (lock_ >= 0) ::close(lock_);
    }

    Status start(const std::string& page) {
        std::error_code failed;
        if (!options_.replace && fs::exists(fs::symlink_status(files_, failed))) {
            return Error{ErrorCode::kExists, files_.string() + ": exists already (--force replaces it)"};
        }
        if (Status s = create_text(path_, descriptor(levels_[0].width, levels_[0].height, options_), descriptor_); !s) return s;
        if (!page.empty()) {
            if (Status s = create_text(fs::path(path_).replace_extension(".html"), page, page_); !s) return s;
        }
        remove_leftovers();
        if (::mkdir(hidden_.path().c_str(), 0777) != 0) return error_from_errno(errno, files_.string(), "cannot create");
        lock_ = open_locked(hidden_.path());
        for (std::size_t level = 0; level < levels_.size(); ++level) {
            if (fs::create_directory(hidden_.path() / std::to_string(level), failed); failed) {
                return error_from_errno(failed.value(), files_.string(), "cannot create");
            }
        }
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
        const fs::path aside = hidden_.path().string() + ".old";
        const bool replacing = options_.replace && ::rename(files_.c_str(), aside.c_str()) == 0;
        Status status = rename_folder(hidden_.path(), files_);
        if (status) {
            if (page_) status = page_->publish();
            const bool page_named = status && page_;
            if (status) status = descriptor_->publish();
            if (!status) remove(files_);
            if (!status && page_named && !options_.replace) ::unlink(page_->path().c_str());
        }
        if (replacing && status) remove(aside);
        if (replacing && !status) ::rename(aside.c_str(), files_.c_str());
        return status;
    }

 private:
    static constexpr const char* kHiddenSuffix = ".tmp";

    static void remove(const fs::path& folder) {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }

    std::string hidden_prefix() const { return fmt::format(".{}.", files_.filename().string()); }

    // A writer locks its hidden folder (flock) for as long as it lives, however it ends. -1: somebody else has the lock, or this
    // file system has none; the folder is then left alone.
    static int open_locked(const fs::path& folder) {
        const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
        if (fd < 0 || ::flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
        ::close(fd);
        return -1;
    }

    // What writers of the same pyramid left when they were killed.
    void remove_leftovers() const {
        const std::size_t length = hidden_.path().filename().string().size();
        std::vector<fs::path> dead;
        std::error_code failed;
        for (fs::directory_iterator it(folder_of(path_), failed); !failed && it != fs::directory_iterator(); it.increment(failed)) {
            const std::string name = it->path().filename().string();
            const bool hidden = name.size() == length && name.starts_with(hidden_prefix()) && name.ends_with(kHiddenSuffix);
            if (hidden) dead.push_back(it->path());
        }
        for (const fs::path& folder : dead) {
            const int lock = open_locked(folder);
            if (lock < 0) continue;
            remove(folder);
            ::close(lock);
        }
    }

    Status create_text(const fs::path& path, const std::string& text, std::optional<OutputFile>& file) const {
        Result<OutputFile> out = OutputFile::create(path, options_.replace);
        if (!out) return out.error();
        if (Status s = out->file().write_all(0, bytes_of(text)); !s) return s;
        file.emplace(std::move(*out));
        return {};
    }

    // One sync of the whole file system instead of one for each of thousands of tiles; it is a courtesy, so it may fail.
    void sync_tiles() const {
        const int fd = ::open(hidden_.path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
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
        const Status written = write_file(hidden_.path() / name, *tile);
        if (written) return {};
        return Error{written.error().code,
                     (files_ / name).string() + written.error().message.substr((hidden_.path() / name).string().size())};
    }

    static Status write_file(const fs::path& path, ByteSpan bytes) {
        Result<File> file = File::create_exclusive(path);
        if (!file) return file.error();
        if (Status s = file->write_all(0, bytes); !s) return s;
        return file->close();
    }

    fs::path path_, files_;
    TemporaryPath hidden_;
    int lock_ = -1;
    DeepZoomOptions options_;
    ImageTags tags_;
    std::vector<PixelFormat> levels_;
    std::vector<RowBlocks> blocks_;
    std::optional<OutputFile> descriptor_, page_;
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
    auto writer = std::make_unique<Writer>(path, width, height, tags, options);
    if (Status s = writer->start(page); !s) return s.error();
    return writer;
}

}  // namespace latent::image
