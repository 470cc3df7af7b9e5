#include "render/load/files/scene_files.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <vector>

#include "base/file.h"
#include "render/load/files/pictures.h"

namespace latent::render {

namespace {

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

// What takes more than its files explain: beyond this, and this many times their size.
constexpr std::uint64_t kIncludeRatio = 10, kAlwaysIncluded = std::uint64_t{16} << 20;
constexpr std::uint64_t kMinIncluded = 1024;  // bytes that an inclusion counts, for what it takes beside its text

// Beyond this, and this many times its size, a gzip file is not unpacked: 3 to 10 times is usual, and 1000 times possible.
constexpr std::size_t kRatio = 100, kAlways = std::size_t{1} << 26;

// All members of a gzip file, one after the other. Errors: kCorrupt.
Result<std::string> unpacked(const std::filesystem::path& path, std::string_view bytes) {
    const auto broken = [&] { return Error{ErrorCode::kCorrupt, path.string() + ": is damaged: it cannot be unpacked (gzip)"}; };
    const std::size_t most = std::max(bytes.size() * kRatio, kAlways);
    std::string out;
    while (!bytes.empty()) {
        z_stream stream{};
        if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK) return Error{ErrorCode::kNoMemory, "out of memory"};
        int state = Z_OK;
        while (state == Z_OK) {
            std::vector<char> piece(std::size_t{1} << 18);
            const std::size_t taken = std::min<std::size_t>(bytes.size(), std::size_t{1} << 30);
            stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
            stream.avail_in = static_cast<uInt>(taken);
            stream.next_out = reinterpret_cast<Bytef*>(piece.data());
            stream.avail_out = static_cast<uInt>(piece.size());
            state = inflate(&stream, Z_NO_FLUSH);
            out.append(piece.data(), piece.size() - stream.avail_out);
            bytes.remove_prefix(taken - stream.avail_in);
            if (out.size() > most) state = Z_MEM_ERROR;
        }
        inflateEnd(&stream);
        if (state == Z_MEM_ERROR)
            return Error{ErrorCode::kCorrupt,
                         fmt::format("{}: unpacks to more than {} times its size (gzip)", path.string(), kRatio)};
        if (state != Z_STREAM_END) return broken();
    }
    return out;
}

Result<Hash128> hash_of(const std::filesystem::path& path) {
    const Result<File> file = File::open_read(path);
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

std::string lower_case(std::string text) {
    for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
}

// `path`, or the only one that exists and differs from it in upper and lower case alone, from `known` on.
std::filesystem::path in_any_case(const std::filesystem::path& known, const std::filesystem::path& path) {
    std::error_code unknown;
    std::filesystem::path at = known;
    for (const std::filesystem::path& part : path) {
        if (std::filesystem::exists(at / part, unknown)) {
            at /= part;
            continue;
        }
        std::vector<std::filesystem::path> found;
        for (const auto& entry : std::filesystem::directory_iterator(at.empty() ? "." : at, unknown)) {
            if (lower_case(entry.path().filename().string()) == lower_case(part.string())) found.push_back(entry.path().filename());
        }
        if (found.size() != 1) return known / path;
        at /= found[0];
    }
    return at;
}

}  // namespace

bool is_lfs_pointer(std::string_view content) { return content.starts_with("version https://git-lfs.github.com/spec/"); }

std::filesystem::path SceneFiles::resolve(const std::string& name) const {
    std::error_code unknown;
    if (std::filesystem::exists(folder_ / name, unknown)) return folder_ / name;
    std::string with_slashes = name;
    std::ranges::replace(with_slashes, '\\', '/');
    const std::filesystem::path given = folder_ / with_slashes, found = in_any_case(folder_, with_slashes);
    if (found != given) other_names_.emplace(name, found);
    return found;
}

void SceneFiles::tell_of_other_names(const std::filesystem::path& scene, Diagnostics& diagnostics) const {
    for (const auto& [name, path] : other_names_)
        diagnostics.note(scene.string(),
                         fmt::format("\"{}\" is read from {}: only upper and lower case differ", name, path.string()));
}

Result<std::string> SceneFiles::read_text(const std::filesystem::path& path) {
    const Result<File> file = File::open_read(path);
    if (!file) return file.error();
    const Result<std::uint64_t> size = file->size();
    if (!size) return size.error();
    std::string text(*size, '\0');
    if (const Status read = file->read_exact(0, std::as_writable_bytes(std::span(text))); !read) return read.error();
    Result<std::string> whole = is_gzip(text) ? unpacked(path, text) : std::move(text);
    if (whole && whole->starts_with("\xEF\xBB\xBF")) whole->erase(0, 3);  // the mark of UTF-8
    return whole;
}

Result<std::string> SceneFiles::include(const std::filesystem::path& path) {
    Result<std::string> text = read_text(path);
    if (!text) return text;
    const std::uint64_t size = std::max<std::uint64_t>(text->size(), kMinIncluded);
    std::error_code failed;
    const std::filesystem::path same = std::filesystem::canonical(path, failed);  // whichever link leads to it
    if (included_.insert(failed ? path : same).second) distinct_bytes_ += size;
    included_bytes_ += size;
    if (included_bytes_ > std::max(kAlwaysIncluded, kIncludeRatio * distinct_bytes_))
        return Error{ErrorCode::kOutOfRange,
                     fmt::format("{}: the scene includes its files so often that they add up to {} times their size", path.string(),
                                 included_bytes_ / distinct_bytes_)};
    return text;
}

Result<Hash128> SceneFiles::hash(const std::string& name) {
    const std::filesystem::path path = resolve(name);
    const auto known = hashes_.find(path);
    return known != hashes_.end() ? known->second : hashes_.emplace(path, hash_of(path)).first->second;
}

Result<AlphaUse> SceneFiles::alpha_use(const std::string& name) {
    const std::filesystem::path path = resolve(name);
    const auto known = alphas_.find(path);
    return known != alphas_.end() ? known->second
                                  : alphas_.emplace(path, latent::render::alpha_use(path, path.string())).first->second;
}

}  // namespace latent::render
