#include "tools/develop/picture/exr_picture.h"

namespace latent::develop {

static_assert(TileSink::kTile == image::ExrTileWriter::kTile);

Status ExrPicture::begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) {
    writer_.reset();
    file_.reset();
    Result<OutputFile> file = OutputFile::create(output_, replace_);
    if (!file) return file.error();
    file_.emplace(std::move(*file));
    Result<std::unique_ptr<image::ExrTileWriter>> writer = image::ExrTileWriter::create(file_->file(), spec, waiting_memory);
    if (!writer) return writer.error();
    writer_ = std::move(*writer);
    return {};
}

Status ExrPicture::finish() {
    if (Status s = writer_->finish(); !s) return s;
    return file_->publish();
}

}  // namespace latent::develop
