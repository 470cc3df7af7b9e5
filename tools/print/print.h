// tools/print/print.h: from samples to prints in one command: what latent-develop and latent-convert make in a row, without a
// picture file between them. docs/recipes.md, "A print in one command".
#pragma once

#include "base/progress.h"
#include "base/result.h"
#include "tools/convert/options.h"
#include "tools/develop/picture/picture.h"

namespace latent::print {

struct PrintOptions {
    develop::PictureOptions picture;  // its output is not used
    convert::ConvertOptions print;    // its input is not used
};

struct PrintReport {
    develop::PictureReport picture;
    convert::ConvertReport print;
};

// The bytes are those of the two tools. The picture waits in a file without a name, in the folder of the first output: 12 bytes for
// each pixel of XYZ. Memory is that of the tool that takes more. Errors: those of both; what can be known of prints before there is
// a picture comes first.
Result<PrintReport> print(PrintOptions options, const Progress& developing, const Progress& printing);

}  // namespace latent::print
