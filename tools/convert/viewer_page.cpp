#include "tools/convert/viewer_page.h"

#include <fmt/format.h>

#include <cctype>

#include "base/json.h"
#include "base/parse.h"
#include "base/small_file.h"

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

// The name of a folder as a relative URL.
std::string url_of(const std::string& folder) {
    std::string address;
    for (const char c : folder) {
        const bool plain =
            std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("-._~/").find(c) != std::string_view::npos;
        constexpr char kHex[] = "0123456789ABCDEF";
        const auto byte = static_cast<unsigned char>(c);
        if (plain)
            address += c;
        else
            address += {'%', kHex[byte >> 4], kHex[byte & 15]};
    }
    return "./" + address;
}

// The value of NAME="..." in an element <ELEMENT ...>; "" if there is none.
std::string attribute_of(std::string_view xml, std::string_view element, std::string_view name) {
    const std::size_t begin = xml.find(fmt::format("<{}", element));
    if (begin == std::string_view::npos) return "";
    const std::string_view tag = xml.substr(begin, xml.find('>', begin) - begin);
    for (const char quote : {'"', '\''}) {
        const std::string start = fmt::format("{}={}", name, quote);
        std::size_t at = tag.find(start);
        while (at != std::string_view::npos && at > 0 && std::isspace(static_cast<unsigned char>(tag[at - 1])) == 0)
            at = tag.find(start, at + 1);
        if (at == std::string_view::npos) continue;
        const std::string_view value = tag.substr(at + start.size());
        return std::string(value.substr(0, value.find(quote)));
    }
    return "";
}

// Text inside <script>.
std::string for_script(std::string json) {
    for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;) json.replace(at, 1, "\\u003c");
    return json;
}

}  // namespace

Result<OtherPyramid> read_pyramid(const std::filesystem::path& descriptor, const std::filesystem::path& page_of, int width,
                                  int height) {
    const Result<std::string> xml = read_small_file(descriptor, 1 << 20, "a Deep Zoom descriptor");
    if (!xml) return xml.error();
    const auto number = [&](std::string_view element, std::string_view name) {
        const Result<std::uint64_t> value = parse_count(attribute_of(*xml, element, name));
        return value && *value <= 0x7fffffff ? static_cast<int>(*value) : -1;
    };
    OtherPyramid other{descriptor.stem().string(), "", attribute_of(*xml, "Image", "Format"), number("Image", "TileSize"),
                       number("Image", "Overlap")};
    const int other_width = number("Size", "Width"), other_height = number("Size", "Height");
    if (other.format.empty() || other.tile < 1 || other.overlap < 0 || other_width < 1 || other_height < 1)
        return Error{ErrorCode::kForeign, descriptor.string() + ": not a Deep Zoom descriptor"};
    if (other_width != width || other_height != height)
        return usage_error(
            fmt::format("{}: has {} x {} pixels, and this print {} x {}; only prints of one size can be "
                        "compared",
                        descriptor.string(), other_width, other_height, width, height));
    std::error_code ignored;
    const auto folder_of_file = [&](const std::filesystem::path& file) {
        return std::filesystem::weakly_canonical(std::filesystem::absolute(file, ignored).parent_path(), ignored);
    };
    const std::filesystem::path way = folder_of_file(descriptor).lexically_relative(folder_of_file(page_of));
    other.folder = (way / (other.name + "_files")).lexically_normal().string() + "/";
    return other;
}

std::string viewer_page(const std::string& name, int width, int height, const image::DeepZoomOptions& options,
                        const std::optional<OtherPyramid>& other) {
    nlohmann::ordered_json picture{{"name", name},
                                   {"tiles", url_of(name + "_files/")},
                                   {"format", options.png ? "png" : "jpg"},
                                   {"overlap", options.overlap},
                                   {"tile", options.tile},
                                   {"width", width},
                                   {"height", height}};
    if (other)
        picture["other"] = {{"name", other->name},
                            {"tiles", url_of(other->folder)},
                            {"format", other->format},
                            {"overlap", other->overlap},
                            {"tile", other->tile}};
    std::string page = kViewerPage;
    const auto put = [&page](std::string_view place, const std::string& text) {
        page.replace(page.find(place), place.size(), text);
    };
    put("@PICTURE@", for_script(json_text(picture, -1)));
    put("@TITLE@", escaped_for_html(name));  // last, as a name may contain anything; its place is the first in the page
    return page;
}

}  // namespace latent::convert
