#include "render/load/files/scene_files.h"

#include <bit>

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

Result<std::string> SceneFiles::read(const std::string& name) {
    Result<std::string> text = read_text(resolve(name));
    if (text) count(*text);
    return text;
}

void SceneFiles::count(std::string_view text) {
    count(static_cast<double>(text.size()));
    hasher_.update(std::as_bytes(std::span(text)));
}

void SceneFiles::count(double value) {
    std::byte bytes[sizeof(double)];
    store_le(bytes, std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value));  // -0 is 0
    hasher_.update(bytes);
}

}  // namespace latent::render
