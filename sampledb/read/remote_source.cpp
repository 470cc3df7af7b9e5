#include "sampledb/read/remote_source.h"

#include <dlfcn.h>

#include <string>
#include <string_view>

#include "base/url.h"

namespace latent::sampledb {

namespace {

// From the module latent_http.so. It is searched for where the program or library that holds this was installed, and stays loaded.
using Open = void (*)(const std::string& url, std::shared_ptr<const ByteSource>& source, Status& status);

Result<Open> find_open() {
    const auto fail = [](std::string why) { return Error{ErrorCode::kUnsupported, "cannot be read: " + std::move(why)}; };
    void* const module = dlopen("latent_http.so", RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) return fail("the module latent_http.so (libcurl) is not installed");
    const auto version = reinterpret_cast<const char* (*)()>(dlsym(module, "latent_http_version"));
    const auto open = reinterpret_cast<Open>(dlsym(module, "latent_open_http"));
    if (version == nullptr || open == nullptr || version() != std::string_view(LATENT_VERSION))
        return fail("the module latent_http.so is not of version " LATENT_VERSION);
    return open;
}

}  // namespace

Result<std::shared_ptr<const ByteSource>> open_remote(const std::filesystem::path& url) {
    static const Result<Open> open = find_open();
    if (!open) return open.error().at(shown_name(url));
    std::shared_ptr<const ByteSource> source;
    Status status;
    (*open)(url.string(), source, status);
    if (!status) return status.error();
    return source;
}

}  // namespace latent::sampledb
