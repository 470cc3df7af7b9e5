#include "base/url.h"

#include <algorithm>
#include <string_view>

namespace latent {

namespace {

// The place after "http:" or "https:", in capitals or not [RFC3986 3.1]; 0 if the text begins with neither.
std::size_t end_of_scheme(const std::string& text) {
    for (const std::string_view scheme : {"http:", "https:"}) {
        const bool same = text.size() >= scheme.size() &&
                          std::equal(scheme.begin(), scheme.end(), text.begin(),
                                     [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b); });
        if (same) return scheme.size();
    }
    return 0;
}

}  // namespace

bool is_url(const std::filesystem::path& path) {
    const std::size_t end = end_of_scheme(path.native());
    return end > 0 && path.native().compare(end, 2, "//") == 0;
}

std::string shown_name(const std::filesystem::path& path) {
    const std::size_t scheme = end_of_scheme(path.native());
    if (scheme == 0) return path.string();
    const std::string& url = path.native();
    const std::size_t end = std::min(url.find_first_of("?#"), url.size());
    std::string shown = url.substr(0, end);
    if (end < url.size() && url[end] == '?') shown += "?...";
    const std::size_t host = std::min(shown.find_first_not_of('/', scheme), shown.size()),
                      host_end = std::min(shown.find_first_of("/?", host), shown.size());
    const std::size_t at = shown.rfind('@', host_end);
    if (at != std::string::npos && at >= host && at < host_end) shown.erase(host, at + 1 - host);
    return shown;
}

}  // namespace latent
