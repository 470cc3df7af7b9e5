#include "sampledb/read/remote_source.h"

#include <dlfcn.h>

#include <string>

namespace latent::sampledb {

bool is_url(const std::filesystem::path& path) {
    const std::string& text = path.native();
    return text.starts_with("http://") || text.starts_with("https://");
}

Result<std::shared_ptr<const ByteSource>> open_remote(const std::filesystem::path& url) {
    static void* const module = dlopen("latent_http.so", RTLD_NOW | RTLD_LOCAL);  // stays loaded
    using Open = void (*)(const std::string& url, std::shared_ptr<const ByteSource>& source, Status& status);
    const auto open = module == nullptr ? nullptr : reinterpret_cast<Open>(dlsym(module, "latent_open_http"));
    if (open == nullptr)
        return Error{ErrorCode::kUnsupported,
                     url.string() + ": cannot be read: the module latent_http.so (libcurl) is not installed"};
    std::shared_ptr<const ByteSource> source;
    Status status;
    open(url.string(), source, status);
    if (!status) return status.error();
    return source;
}

}  // namespace latent::sampledb
