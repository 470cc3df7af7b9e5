#include "tools/convert/viewer_page.h"

#include "base/json.h"

namespace latent::convert {

std::string viewer_page(const std::string& tiles, int width, int height, const image::DeepZoomOptions& options) {
    std::string address;  // the folder's name as a relative URL
    for (const char c : tiles) {
        const bool plain =
            std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("-._~/").find(c) != std::string_view::npos;
        constexpr char kHex[] = "0123456789ABCDEF";
        const auto byte = static_cast<unsigned char>(c);
        if (plain)
            address += c;
        else
            address += {'%', kHex[byte >> 4], kHex[byte & 15]};
    }
    const nlohmann::ordered_json picture{{"tiles", "./" + address},
                                         {"format", options.png ? "png" : "jpg"},
                                         {"overlap", options.overlap},
                                         {"tile", options.tile},
                                         {"width", width},
                                         {"height", height}};
    std::string page = kViewerPage;
    constexpr std::string_view kPlace = "@PICTURE@";
    return page.replace(page.find(kPlace), kPlace.size(), json_text(picture, -1));
}

}  // namespace latent::convert
