#include "base/url.h"

#include <algorithm>

namespace latent {

bool is_url(const std::filesystem::path& path) {
    const std::string& text = path.native();
    return text.starts_with("http://") || text.starts_with("https://");
}

std::string shown_name(const std::filesystem::path& path) {
    if (!is_url(path)) return path.string();
    const std::string& url = path.native();
    const std::size_t end = std::min(url.find_first_of("?#"), url.size());
    std::string shown = url.substr(0, end);
    if (end < url.size() && url[end] == '?') shown += "?...";
    const std::size_t host = shown.find("://") + 3, host_end = std::min(shown.find_first_of("/?", host), shown.size());
    const std::size_t at = shown.rfind('@', host_end);
    if (at != std::string::npos && at >= host && at < host_end) shown.erase(host, at + 1 - host);
    return shown;
}

}  // namespace latent
