// tools/darkroom/server/page.h: the files of the page, from tools/darkroom/page, put into the program.
#pragma once

#include <span>
#include <string_view>

namespace latent::darkroom {

struct PageFile {
    const char* name;  // below the address; "": the page itself
    const char* type;
    std::string_view content;
};

std::span<const PageFile> page_files();

}  // namespace latent::darkroom
