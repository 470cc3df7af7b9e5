#include "image/pictures.h"

#include <dlfcn.h>
#include <fmt/format.h>

namespace latent::image {

Result<std::unique_ptr<Pictures>> Pictures::create(std::uint64_t cache_bytes) {
    // Stays loaded: OpenImageIO's threads and statics outlive every use.
    static void* const module = dlopen("latent_oiio.so", RTLD_NOW | RTLD_LOCAL);
    using Create = Pictures* (*)(std::uint64_t);
    const auto create = module == nullptr ? nullptr : reinterpret_cast<Create>(dlsym(module, "latent_create_pictures"));
    if (create == nullptr)
        return Error{ErrorCode::kUnsupported, "pictures cannot be read: the module latent_oiio.so (OpenImageIO) is not installed"};
    return std::unique_ptr<Pictures>(create(cache_bytes));
}

}  // namespace latent::image
