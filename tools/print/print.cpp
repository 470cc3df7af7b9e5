#include "tools/print/print.h"

#include <memory>
#include <utility>

#include "base/file.h"
#include "tools/convert/convert.h"

namespace latent::print {

namespace {

class UnnamedPicture final : public develop::PictureSink {
 public:
    explicit UnnamedPicture(std::filesystem::path folder) : folder_(std::move(folder)) {}

    Status begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) override {
        Result<File> file = File::create_unnamed(folder_);
        if (!file) return file.error();
        file_ = std::make_shared<File>(std::move(*file));
        Result<std::unique_ptr<image::ExrTileWriter>> writer = image::ExrTileWriter::create(*file_, spec, waiting_memory);
        if (!writer) return writer.error();
        writer_ = std::move(*writer);
        return {};
    }
    Status write(int x, int y, std::span<const float> pixels) override { return writer_->write(x, y, pixels); }
    Status finish() override { return writer_->finish(); }

    std::shared_ptr<const File> file() const { return file_; }

 private:
    const std::filesystem::path folder_;
    std::shared_ptr<File> file_;
    std::unique_ptr<image::ExrTileWriter> writer_;  // to file_
};

}  // namespace

Result<PrintReport> print(PrintOptions options, const Progress& developing, const Progress& printing) {
    if (options.picture.frames > 1)
        return usage_error("--frames: a print shows one picture; develop the frames with latent-develop, then print each");
    if (Status s = convert::check(options.print); !s) return s.error();
    options.picture.output = options.print.outputs.front();  // whose disk must have room
    options.picture.replace = options.print.replace;
    options.print.input = options.picture.inputs.front();
    UnnamedPicture picture(folder_of(options.picture.output));
    Result<develop::PictureReport> developed = develop::develop_picture(options.picture, picture, developing);
    if (!developed) return developed.error();
    options.print.picture = picture.file();
    Result<convert::ConvertReport> printed = convert::convert(options.print, printing);
    if (!printed) return printed.error();
    return PrintReport{*std::move(developed), *std::move(printed)};
}

}  // namespace latent::print
