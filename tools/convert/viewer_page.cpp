#include "tools/convert/viewer_page.h"

#include "base/json.h"

namespace latent::convert {

namespace {

std::string escaped_for_html(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '&')
            escaped += "&amp;";
        else if (c == '<')
            escaped += "&lt;";
        else
            escaped += c;
    }
    return escaped;
}

}  // namespace

std::string viewer_page(const std::string& name, int width, int height, const image::DeepZoomOptions& options) {
    std::string address;  // the folder's name as a relative URL
    for (const char c : name + "_files/") {
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
    const auto put = [&page](std::string_view place, const std::string& text) {
        page.replace(page.find(place), place.size(), text);
    };
    put("@PICTURE@", json_text(picture, -1));
    put("@TITLE@", escaped_for_html(name));  // last, as a name may contain anything; its place is the first in the page
    return page;
}

}  // namespace latent::convert
