#include "image/pictures.h"

#include <dlfcn.h>
#include <fmt/format.h>

namespace latent::image {

Result<std::unique_ptr<Pictures>> Pictures::create(std::uint64_t cache_bytes) {
    // Stays loaded: OpenImageIO's threads and statics outlive every use.
    static void* const module = dlopen("latent_oiio.so", RTLD_NOW | RTLD_LOCAL);
    using Create = Pictures* (*)(std::uint64_t);
    const auto create = module == nullptr ? nullptr : reinterpret_cast<Create>(dlsym(module, "latent_create_pictures"));
    if (create == nullptr) {
        const char* const reason = dlerror();
        return Error{
            ErrorCode::kUnsupported,
            fmt::format("pictures cannot be read: install the package latent-pictures, or OpenImageIO and build again ({})",
                        reason == nullptr ? "it was not built for this version" : reason)};
    }
    return std::unique_ptr<Pictures>(create(cache_bytes));
}

}  // namespace latent::image
