#include "render/load/files/scene_files.h"

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

}  // namespace latent::render
