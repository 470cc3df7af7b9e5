#include "render/load/gltf/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <utility>

#include "base/bytes.h"
#include "base/json.h"
#include "render/load/gltf/check.h"
#include "render/load/gltf/extensions.h"
#include "render/load/gltf/meshopt.h"

namespace latent::render {

namespace {

constexpr std::size_t kHeader = 12, kChunkHeader = 8;
constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;  // types of chunks
constexpr std::size_t kMaxDepth = 64;                              // levels of JSON; the format needs about 10

std::uint32_t u32(std::string_view bytes, std::size_t at) {
    return load_le<std::uint32_t>(reinterpret_cast<const std::byte*>(bytes.data() + at));
}

struct Chunks {
    std::string_view json, binary{};
    bool has_binary = false;
};

Result<Chunks> chunks_of(std::string_view bytes) {
    if (bytes.size() < kHeader + kChunkHeader)
        return Error{ErrorCode::kTruncated, fmt::format("truncated: {} bytes", bytes.size())};
    if (u32(bytes, 4) != 2)
        return Error{ErrorCode::kUnsupported, fmt::format("version {} of binary glTF; only version 2 is supported", u32(bytes, 4))};
    const std::size_t size = u32(bytes, 8);
    if (size > bytes.size()) return Error{ErrorCode::kTruncated, fmt::format("truncated: {} of {} bytes", bytes.size(), size)};
    bytes = bytes.substr(0, size);
    Chunks chunks;
    for (std::size_t at = kHeader, i = 0; at + kChunkHeader <= bytes.size(); ++i) {
        const std::size_t length = u32(bytes, at), begin = at + kChunkHeader;
        const std::uint32_t type = u32(bytes, at + 4);
        if (length > bytes.size() - begin)
            return Error{ErrorCode::kCorrupt, fmt::format("chunk {} is {} bytes long, beyond the end of the file", i, length)};
        if (i == 0 && type != kJson) return Error{ErrorCode::kCorrupt, "the first chunk is not JSON"};
        if (i == 0) chunks.json = bytes.substr(begin, length);
        if (i == 1 && type == kBinary) {
            chunks.binary = bytes.substr(begin, length);
            chunks.has_binary = true;
        }
        at = begin + length;
    }
    return chunks;
}

int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

std::optional<std::string> from_base64(std::string_view text) {
    while (text.ends_with('=')) text.remove_suffix(1);
    std::string out;
    out.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int digit = base64_digit(c);
        if (digit < 0) return std::nullopt;
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
        if ((count += 6) < 8) continue;
        count -= 8;
        out.push_back(static_cast<char>(bits >> count & 0xFF));
    }
    return out;
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

}  // namespace

std::optional<std::string> file_of_uri(std::string_view uri) {
    const std::size_t colon = uri.find(':');
    if (colon != uri.npos && uri.substr(0, colon).find('/') == uri.npos) return std::nullopt;
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const bool escape = uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 && hex_digit(uri[i + 2]) >= 0;
        name.push_back(escape ? static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2])) : uri[i]);
        if (escape) i += 2;
    }
    return name;
}

namespace {

// Why a text is no JSON, in the words of the library: "unexpected number literal; expected ':'", or nothing.
std::string reason(std::string_view what) {
    const std::size_t begin = what.find(" - ");
    if (begin == what.npos) return "";
    const std::string_view text = what.substr(begin + 3);
    return ": " + std::string(text.substr(0, text.find("; last read")));
}

// Where the text first holds the digits that the library quotes, of a number that is too large for it.
std::size_t place_of_number(std::string_view text, std::string_view what) {
    const std::size_t begin = what.find('\'') + 1, end = what.find('\'', begin);
    return end == what.npos ? 0 : text.find(what.substr(begin, end - begin)) + 1;
}

// Where reading ended: `at` characters were read, the last of which could not follow the others.
std::string line_and_column(std::string_view text, std::size_t at) {
    const std::string_view before = text.substr(0, std::max<std::size_t>(at, 1) - 1);
    const auto line = 1 + std::ranges::count(before, '\n');
    return fmt::format("{}:{}", line, before.size() - (before.rfind('\n') + 1) + 1);
}

// In a .glb, the whole JSON is often one line, and begins behind a header.
Error error_at(const std::string& name, bool is_binary, std::string_view text, std::size_t at, const std::string& message) {
    const std::string place = is_binary ? fmt::format("{}: JSON chunk, {}", name, line_and_column(text, at))
                                        : fmt::format("{}:{}", name, line_and_column(text, at));
    return {ErrorCode::kCorrupt, fmt::format("{}: {}", place, message)};
}

// The version that a file claims, if that is not 2; else empty. Files of 1.0 may claim none, but their `meshes` is an object.
std::string other_version(const GltfValue& root) {
    const GltfValue version = root["asset"]["version"], least = root["asset"]["minVersion"];
    if (least.is_text() && least.text() != "2.0") return fmt::format("\"{}\"", least.text());
    if (version.is_number()) return version.number(2) < 2 ? fmt::format("{}", version.number(2)) : "";
    if (version.is_text()) return version.text().starts_with("2.") ? "" : fmt::format("\"{}\"", version.text());
    return !version.exists() && root["meshes"].is_object() ? "1.0" : "";
}

}  // namespace

Result<GltfDocument> GltfDocument::read(const std::string& bytes, const std::string& name, SceneFiles& files,
                                        Diagnostics& diagnostics) {
    GltfDocument document(name, files, diagnostics);
    Chunks chunks{bytes};
    if (bytes.starts_with("glTF")) {
        const Result<Chunks> found = chunks_of(bytes);
        if (!found) return found.error().at(name);
        chunks = *found;
    }
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (chunks.json.starts_with(kByteOrderMark)) chunks.json.remove_prefix(kByteOrderMark.size());
    const bool is_binary = bytes.starts_with("glTF");
    if (chunks.json.find_first_not_of(" \t\r\n") == chunks.json.npos)
        return Error{ErrorCode::kCorrupt, fmt::format("{}: {} is empty", name, is_binary ? "its JSON chunk" : "the file")};
    if (!is_binary && chunks.json[chunks.json.find_first_not_of(" \t\r\n")] != '{')
        return Error{ErrorCode::kForeign, name + ": is neither glTF, which is JSON, nor a .glb"};
    const Status is_object = check_json_object(chunks.json, kMaxDepth);
    try {
        document.json_ = nlohmann::json::parse(chunks.json);
    } catch (const nlohmann::json::parse_error& e) {
        return error_at(name, is_binary, chunks.json, e.byte, "not valid JSON" + reason(e.what()));
    } catch (const nlohmann::json::out_of_range& e) {
        return error_at(name, is_binary, chunks.json, place_of_number(chunks.json, e.what()),
                        "the number exceeds double precision");
    }
    if (!is_object) return is_object.error().at(name);

    if (const std::string other = other_version(document.root()); !other.empty())
        return Error{ErrorCode::kUnsupported, fmt::format("{}: is glTF {}; only glTF 2.0 is supported", name, other)};
    document.is_sound_ = check_gltf(document.root()) && check_extensions(document.root());
    if (document.is_sound_) document.read_buffers(chunks.binary, chunks.has_binary);
    if (document.is_sound_) document.unpack_views();
    return document;
}

std::optional<std::string> GltfDocument::resource(const GltfValue& uri) const {
    const std::string text = uri.text();
    if (text.starts_with("data:")) {
        const std::size_t comma = text.find(',');
        const bool base64 = comma != text.npos && std::string_view(text).substr(0, comma).ends_with(";base64");
        std::optional<std::string> bytes = base64 ? from_base64(std::string_view(text).substr(comma + 1)) : std::nullopt;
        if (!bytes) uri.error("is not valid base64 data");
        return bytes;
    }
    const std::optional<std::string> name = file_of_uri(text);
    if (!name) {
        uri.error(fmt::format("\"{}\" is not a path; give that of a file beside this one", text.substr(0, 80)));
        return std::nullopt;
    }
    Result<std::string> bytes = files_->include(files_->resolve(*name));
    if (bytes) return std::move(*bytes);
    uri.error(bytes.error().message);
    return std::nullopt;
}

void GltfDocument::read_buffers(std::string_view binary_chunk, bool has_chunk) {
    const GltfValue buffers = root()["buffers"];
    const std::vector<bool> used = find_used_buffers();
    std::map<std::string, std::shared_ptr<const std::string>> by_uri;
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        const GltfValue buffer = buffers[i];
        std::shared_ptr<const std::string> bytes;
        if (!used[i]) {
            buffers_.push_back(nullptr);
            continue;
        }
        if (buffer["uri"].exists()) {
            const std::string uri = buffer["uri"].text();
            const auto known = by_uri.find(uri);
            if (known != by_uri.end()) {
                bytes = known->second;
            } else if (std::optional<std::string> read = resource(buffer["uri"])) {
                bytes = std::make_shared<const std::string>(std::move(*read));
                if (!uri.starts_with("data:")) by_uri.emplace(uri, bytes);
            }
        } else if (i == 0 && has_chunk) {
            bytes = std::make_shared<const std::string>(binary_chunk);
        } else {
            buffer.error("has no uri, and the file has no binary chunk");
        }
        const std::uint64_t declared = buffer["byteLength"].count(0);
        if (bytes && bytes->size() < declared) {
            const std::string uri = buffer["uri"].exists() ? buffer["uri"].text() : "";
            const std::string of = uri.empty() || uri.starts_with("data:") ? "" : uri + " ";
            buffer.error(fmt::format("{}is truncated: {} of {} bytes", of, bytes->size(), declared));
            bytes.reset();
        }
        buffers_.push_back(std::move(bytes));
    }
}

namespace {

// The compression of a buffer view; does not exist if there is none.
GltfValue meshopt_of(const GltfValue& view) {
    const GltfValue ratified = view.extension("KHR_meshopt_compression");
    return ratified.exists() ? ratified : view.extension("EXT_meshopt_compression");
}

}  // namespace

std::vector<bool> GltfDocument::find_used_buffers() const {
    const GltfValue views = root()["bufferViews"];
    // What no view uses is read, so that its faults are told.
    std::vector<bool> used(root()["buffers"].size(), true);
    const auto mark = [&](const GltfValue& buffer, bool value) {
        const std::uint64_t i = buffer.is_count() ? buffer.count(0) : used.size();
        if (i < used.size()) used[i] = value;
    };
    for (std::size_t i = 0; i < views.size(); ++i) mark(views[i]["buffer"], !meshopt_of(views[i]).exists());
    for (std::size_t i = 0; i < views.size(); ++i) {
        const GltfValue packed = meshopt_of(views[i]);
        mark(packed.exists() ? packed["buffer"] : views[i]["buffer"], true);
    }
    return used;
}

void GltfDocument::unpack_views() {
    constexpr std::uint64_t kMaxRatio = 256, kFree = std::uint64_t{16} << 20;  // what is unpacked in all, over what was packed
    const GltfValue views = root()["bufferViews"], buffers = root()["buffers"];
    views_.resize(views.size());
    std::uint64_t unpacked = 0, compressed = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const GltfValue view = views[i], packed = meshopt_of(view);
        if (!packed.exists()) continue;
        views_[i] = std::make_shared<const std::string>();
        const std::optional<std::uint32_t> b = packed["buffer"].index(buffers);
        if (!b || !buffers_[*b]) continue;  // an error already
        const std::uint64_t begin = packed["byteOffset"].count(0), length = packed["byteLength"].count(0),
                            size = buffers_[*b]->size();
        const MeshoptView described{packed["mode"].text(), packed["filter"].text("NONE"), packed["count"].count(0),
                                    packed["byteStride"].count(0)};
        if (begin > size || length > size - begin) {
            packed.error(fmt::format("ends at byte {} of a buffer of {} bytes", begin + length, size));
        } else if (described.count > (std::uint64_t{1} << 40) || described.stride > 256 ||
                   described.count * described.stride != view["byteLength"].count(0)) {
            packed.error(fmt::format("{} items of {} bytes are not the {} bytes of its view", described.count, described.stride,
                                     view["byteLength"].count(0)));
        } else if (compressed += length, unpacked += described.count * described.stride;
                   unpacked > kFree && unpacked - kFree > kMaxRatio * compressed) {
            return packed.error(
                fmt::format("the file's views unpack to {} bytes, more than {} times their size", unpacked, kMaxRatio));
        } else if (Result<std::string> bytes = unpack_meshopt(std::string_view(*buffers_[*b]).substr(begin, length), described)) {
            views_[i] = std::make_shared<const std::string>(std::move(*bytes));
        } else {
            packed.error(bytes.error().message);
        }
    }
}

}  // namespace latent::render
