// base/url.h: files that are named by URLs.
#pragma once

#include <filesystem>
#include <string>

namespace latent {

// http://... or https://...
bool is_url(const std::filesystem::path& path);

// A file as messages, reports and provenance name it. A URL, or what was meant to be one ("http:/..."), is shown without user and
// password, and its query, which may hold the signature of a presigned URL, as "?...".
std::string shown_name(const std::filesystem::path& path);

}  // namespace latent
