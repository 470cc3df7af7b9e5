// color/observer_file.h: an observer by what a user calls it. The grammar of files: color/observer.h, Observer::from_csv.
#pragma once

#include <string>

#include "color/observer.h"

namespace latent::color {

// A name of color/catalogue.h, or the path of a CSV file. "": cie1931. Errors: kUsage, naming observers that are near; kNotFound,
// kCorrupt, kOutOfRange of a file.
Result<Observer> observer_by_name_or_file(const std::string& name);

}  // namespace latent::color
