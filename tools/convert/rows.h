// tools/convert/rows.h: rows of a picture that are made from the top while it is printed. They wait in files without a name, so
// that memory holds little of a picture of any size.
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "base/file.h"
#include "tools/convert/bands.h"
#include "tools/convert/source.h"

namespace latent::convert {

class Rows {
 public:
    Rows() = default;
    Rows(const Rows&) = delete;
    Rows& operator=(const Rows&) = delete;
    virtual ~Rows() = default;

    // Makes the rows above y1 that are still missing. On any threads. Errors: of reading; kIo.
    virtual Status make(int y1) = 0;
    // A part of a row. After make(y1), rows from y1 - `keep` on are there, `keep` being what the rows were created with. From any
    // thread.
    virtual Status read(std::size_t channel, int x0, int y, std::span<float> row) const = 0;
};

// The last rows of a picture, in a file.
class RowFile {
 public:
    // A file with the columns of `window` that keeps `rows` rows. Errors: kIo.
    static Result<RowFile> create(const std::filesystem::path& folder, const image::Rect& window, int rows);
    Status write(std::size_t channel, int x0, int y, std::span<const float> row);
    Status read(std::size_t channel, int x0, int y, std::span<float> row) const;

 private:
    RowFile(File file, const image::Rect& window, int rows) : file_(std::move(file)), window_(window), rows_(rows) {}
    std::uint64_t place(std::size_t channel, int x, int y) const;
    File file_;
    image::Rect window_;
    int rows_;
};

// Rows of a file, as they are.
class PictureRows : public Rows {
 public:
    // From the row `first` on. `source` outlives them. Errors: kIo.
    static Result<std::unique_ptr<Rows>> create(const Source& source, int first, int keep, const std::filesystem::path& folder,
                                                int threads);
    Status make(int y1) override;
    Status read(std::size_t channel, int x0, int y, std::span<float> row) const override { return file_.read(channel, x0, y, row); }

 private:
    PictureRows(const Source& source, BandPlan plan, int first, RowFile file);
    const Source& source_;
    BandPlan plan_;
    RowFile file_;
    std::size_t next_band_ = 0;
    int made_;
};

// Rows of the highest band.
int highest(const BandPlan& plan);

}  // namespace latent::convert
