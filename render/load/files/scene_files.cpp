#include "render/load/files/scene_files.h"

#include <vector>

#include "base/file.h"

namespace latent::render {

Result<std::string> SceneFiles::read_text(const std::filesystem::path& path) {
    const Result<File> file = File::open_read(path);
    if (!file) return file.error();
    const Result<std::uint64_t> size = file->size();
    if (!size) return size.error();
    std::string text(*size, '\0');
    if (const Status read = file->read_exact(0, std::as_writable_bytes(std::span(text))); !read) return read.error();
    return text;
}

Result<Hash128> SceneFiles::hash(const std::string& name) const {
    const Result<File> file = File::open_read(resolve(name));
    if (!file) return file.error();
    Hasher128 hasher;
    std::vector<std::byte> buffer(std::size_t{1} << 20);
    for (std::uint64_t offset = 0;;) {
        const Result<std::size_t> size = file->read_some(offset, buffer);
        if (!size) return size.error();
        if (*size == 0) return hasher.digest();
        hasher.update(std::span(buffer).first(*size));
        offset += *size;
    }
}

}  // namespace latent::render
