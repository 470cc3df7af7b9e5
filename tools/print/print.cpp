#include "tools/print/print.h"

#include <utility>

#include "base/file.h"
#include "tools/convert/convert.h"
#include "tools/develop/picture/unnamed_picture.h"

namespace latent::print {

Result<PrintReport> print(PrintOptions options, const Progress& developing, const Progress& printing) {
    if (options.picture.frames > 1)
        return usage_error("--frames: a print shows one picture; develop the frames with latent-develop, then print each");
    if (Status s = convert::check(options.print); !s) return s.error();
    options.picture.output = options.print.outputs.front();  // whose disk must have room
    options.picture.replace = options.print.replace;
    options.print.input = options.picture.inputs.front();
    develop::UnnamedPicture picture([&] { return File::create_unnamed(folder_of(options.picture.output)); });
    Result<develop::PictureReport> developed = develop::develop_picture(options.picture, picture, developing);
    if (!developed) return developed.error();
    options.print.picture = picture.file();
    Result<convert::ConvertReport> printed = convert::convert(options.print, printing);
    if (!printed) return printed.error();
    return PrintReport{*std::move(developed), *std::move(printed)};
}

}  // namespace latent::print
