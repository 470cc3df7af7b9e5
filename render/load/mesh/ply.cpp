#include "render/load/mesh/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>

namespace latent::render {

namespace {

enum class Type : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
constexpr std::size_t kTypeBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};

std::optional<Type> ply_type(std::string_view name) {
    static constexpr struct {
        std::string_view name, other;
    } kNames[] = {{"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
                  {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
    for (std::size_t i = 0; i < std::size(kNames); ++i) {
        if (name == kNames[i].name || name == kNames[i].other) return static_cast<Type>(i);
    }
    return std::nullopt;
}

struct Property {
    std::string_view name;
    Type type;
    std::optional<Type> list;  // type of the count in front of a list
};
struct Element {
    std::string_view name;
    std::uint64_t count = 0;
    std::vector<Property> properties{};
};
enum class Format { kAscii, kLittle, kBig };

struct Header {
    Format format = Format::kAscii;
    std::vector<Element> elements;
    std::size_t size = 0;  // bytes, the line "end_header" included
};

// Takes values off the body, whatever its encoding. Past the end, and at a word that is no number, it returns 0 and clears `ok`.
class Body {
 public:
    Body(std::string_view name, std::string_view file, const Header& header)
        : name_(name), file_(file), bytes_(file.substr(header.size)), format_(header.format) {}

    double value(Type type) {
        if (format_ == Format::kAscii) return type == Type::kFloat32 ? static_cast<float>(ascii()) : ascii();
        const std::size_t size = kTypeBytes[static_cast<std::size_t>(type)];
        if (bytes_.size() < size) return fail();
        char raw[8];
        for (std::size_t i = 0; i < size; ++i) raw[i] = bytes_[format_ == little_format() ? i : size - 1 - i];
        bytes_.remove_prefix(size);
        switch (type) {
            case Type::kInt8:
                return as<std::int8_t>(raw);
            case Type::kUint8:
                return as<std::uint8_t>(raw);
            case Type::kInt16:
                return as<std::int16_t>(raw);
            case Type::kUint16:
                return as<std::uint16_t>(raw);
            case Type::kInt32:
                return as<std::int32_t>(raw);
            case Type::kUint32:
                return as<std::uint32_t>(raw);
            case Type::kFloat32:
                return as<float>(raw);
            case Type::kFloat64:
                return as<double>(raw);
        }
        return 0;
    }
    bool ok() const { return ok_; }
    std::string_view name() const { return name_; }
    std::size_t remaining() const { return bytes_.size(); }

    // What is wrong with the value that was taken last, or could not be: "file.ply:12: ", without a line where there are none.
    Error error(ErrorCode code, std::string_view what) const {
        if (format_ != Format::kAscii) return {code, fmt::format("{}: {}", name_, what)};
        const auto line = 1 + std::ranges::count(file_.substr(0, file_.size() - bytes_.size()), '\n');
        return {code, fmt::format("{}:{}: {}", name_, line, what)};
    }
    // What to say about a row that ends before its values do.
    Error cut(const Element& element, std::uint64_t row) const {
        const std::string place = fmt::format("{} {} of {}", element.name, row, element.count);
        if (bad_word_.empty()) return error(ErrorCode::kTruncated, fmt::format("the file ends within {}", place));
        return error(ErrorCode::kCorrupt, fmt::format("\"{}\" is not a finite number, in {}", bad_word_, place));
    }

 private:
    static Format little_format() { return std::endian::native == std::endian::little ? Format::kLittle : Format::kBig; }
    template <class T>
    static double as(const char* raw) {
        T value;
        std::memcpy(&value, raw, sizeof(T));
        return static_cast<double>(value);
    }
    double ascii() {
        if (!ok_) return 0;
        const std::size_t begin = bytes_.find_first_not_of(" \t\r\n");
        if (begin == std::string_view::npos) return fail();
        bytes_.remove_prefix(begin);
        double value = 0;
        const auto [end, error] = std::from_chars(bytes_.data(), bytes_.data() + bytes_.size(), value);
        if (error != std::errc{}) {
            ok_ = false;
            bad_word_ = bytes_.substr(0, std::min<std::size_t>(bytes_.find_first_of(" \t\r\n"), 40));
            return 0;
        }
        bytes_.remove_prefix(static_cast<std::size_t>(end - bytes_.data()));
        return value;
    }
    double fail() {
        ok_ = false;
        bytes_ = {};
        return 0;
    }

    std::string_view name_, file_, bytes_;
    std::string_view bad_word_{};  // that is no number
    Format format_;
    bool ok_ = true;
};

std::vector<std::string_view> words(std::string_view line) {
    std::vector<std::string_view> out;
    for (std::size_t at = line.find_first_not_of(" \t\r"); at != std::string_view::npos; at = line.find_first_not_of(" \t\r", at)) {
        const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
        out.push_back(line.substr(at, end - at));
        at = end;
    }
    return out;
}

std::string_view shortened(std::string_view word) { return word.substr(0, 40); }  // the file may hold anything

Result<Header> parse_header(std::string_view name, std::string_view bytes) {
    Header header;
    bool have_format = false;
    for (int number = 1;; ++number) {
        const auto error = [&](ErrorCode code, std::string_view what) {
            return Error{code, fmt::format("{}:{}: {}", name, number, what)};
        };
        const auto wrong = [&](std::string_view what) { return error(ErrorCode::kCorrupt, what); };
        const std::size_t end = bytes.find('\n', header.size);
        if (end == std::string_view::npos)
            return number == 1 ? error(ErrorCode::kForeign, "not a PLY file")
                               : error(ErrorCode::kTruncated, "the file ends within its header");
        const std::vector<std::string_view> line = words(bytes.substr(header.size, end - header.size));
        header.size = end + 1;
        if (number == 1) {
            if (line.size() != 1 || line[0] != "ply") return error(ErrorCode::kForeign, "not a PLY file");
        } else if (line.empty() || line[0] == "comment" || line[0] == "obj_info") {
            continue;
        } else if (line[0] == "end_header") {
            if (!have_format) return wrong("the header has no \"format\"");
            return header;
        } else if (line[0] == "format" && line.size() >= 2) {
            have_format = true;
            if (line[1] == "ascii") {
                header.format = Format::kAscii;
            } else if (line[1] == "binary_little_endian") {
                header.format = Format::kLittle;
            } else if (line[1] == "binary_big_endian") {
                header.format = Format::kBig;
            } else {
                return wrong(fmt::format("format \"{}\" is unknown", shortened(line[1])));
            }
        } else if (line[0] == "element" && line.size() == 3) {
            Element element{.name = line[1]};
            const auto [stop, failed] = std::from_chars(line[2].data(), line[2].data() + line[2].size(), element.count);
            const auto is_same = [&](const Element& other) { return other.name == element.name; };
            if (failed != std::errc{} || stop != line[2].data() + line[2].size())
                return wrong(fmt::format("\"{}\" is not a number of elements", shortened(line[2])));
            if (std::ranges::any_of(header.elements, is_same))
                return wrong(fmt::format("element \"{}\" is declared twice", shortened(element.name)));
            header.elements.push_back(element);
        } else if (line[0] == "property" && !header.elements.empty()) {
            const bool list = line.size() == 5 && line[1] == "list";
            if (!list && line.size() != 3) return wrong("must be \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"");
            const std::optional<Type> type = ply_type(line[list ? 3 : 1]), count = list ? ply_type(line[2]) : std::nullopt;
            if (!type || (list && !count))
                return wrong(fmt::format("type \"{}\" is unknown", shortened(line[!list ? 1 : count ? 3 : 2])));
            header.elements.back().properties.push_back({line.back(), *type, count});
        } else {
            return wrong(fmt::format("\"{}\" is not part of a PLY header, or has too few words or too many", shortened(line[0])));
        }
    }
}

// Columns of `names` among the properties of a vertex; empty unless all are there.
std::vector<std::size_t> columns(const Element& element, std::initializer_list<std::string_view> names) {
    std::vector<std::size_t> found;
    for (const std::string_view name : names) {
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            if (element.properties[i].name == name && !element.properties[i].list) found.push_back(i);
        }
    }
    return found.size() == names.size() ? found : std::vector<std::size_t>{};
}

// A component of a colour: a fraction of the largest integer, which is encoded as sRGB, or a linear number.
float color_of(double x, Type type, bool is_encoded) {
    const double most = type == Type::kUint8 ? 255 : type == Type::kUint16 ? 65535 : 0;
    if (most == 0) return static_cast<float>(std::clamp(x, 0.0, 1.0));
    x /= most;
    if (is_encoded) x = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
    return static_cast<float>(x);
}

Status read_vertices(const Element& element, Body& body, PlyMesh& mesh) {
    const std::vector<std::size_t> xyz = columns(element, {"x", "y", "z"}), normal = columns(element, {"nx", "ny", "nz"});
    std::vector<std::size_t> uv = columns(element, {"u", "v"});
    if (uv.empty()) uv = columns(element, {"s", "t"});
    if (uv.empty()) uv = columns(element, {"texture_u", "texture_v"});
    if (uv.empty()) uv = columns(element, {"texture_s", "texture_t"});
    const std::vector<std::size_t> rgb = columns(element, {"red", "green", "blue"}), alpha = columns(element, {"alpha"});
    if (xyz.empty()) return Error{ErrorCode::kCorrupt, "vertices lack x, y or z"}.at(body.name());
    for (const Property& p : element.properties) {
        if (p.list)
            return Error{ErrorCode::kUnsupported, fmt::format("vertices with a list property ({}) are not supported", p.name)}.at(
                body.name());
    }
    std::vector<double> row(element.properties.size());
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (std::size_t c = 0; c < row.size(); ++c) row[c] = body.value(element.properties[c].type);
        if (!body.ok()) return body.cut(element, i);
        const auto finite = [&](std::size_t c) { return std::isfinite(static_cast<float>(row[c])); };
        if (!normal.empty() && !std::ranges::all_of(normal, finite)) {
            ++mesh.lost_normals;
            for (const std::size_t c : normal) row[c] = 0;
        }
        for (std::size_t c = 0; c < row.size(); ++c) {
            if (!finite(c)) return body.error(ErrorCode::kCorrupt, fmt::format("vertex {} is not finite", i));
        }
        mesh.positions.emplace_back(row[xyz[0]], row[xyz[1]], row[xyz[2]]);
        if (!normal.empty()) mesh.normals.emplace_back(Vec3d(row[normal[0]], row[normal[1]], row[normal[2]]));
        if (!rgb.empty()) {
            std::array<float, 4> color{1, 1, 1, 1};
            for (std::size_t c = 0; c < 3; ++c) color[c] = color_of(row[rgb[c]], element.properties[rgb[c]].type, true);
            if (!alpha.empty()) color[3] = color_of(row[alpha[0]], element.properties[alpha[0]].type, false);
            mesh.colors.push_back(color);
        }
        if (!uv.empty()) mesh.uvs.push_back({static_cast<float>(row[uv[0]]), static_cast<float>(row[uv[1]])});
    }
    return {};
}

// Any element but the vertices; `faces`: its list of indices of so many `vertices` counts.
Status read_rows(const Element& element, bool faces, std::uint64_t vertices, Body& body, PlyMesh& mesh) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (const Property& p : element.properties) {
            if (!p.list) {
                body.value(p.type);
                continue;
            }
            const double count = body.value(*p.list);
            const bool wanted = faces && (p.name == "vertex_indices" || p.name == "vertex_index");
            if (!body.ok()) return body.cut(element, i);
            if (wanted && count != 3 && count != 4)
                return body.error(ErrorCode::kUnsupported,
                                  fmt::format("face {} has {} sides; only triangles and quads are supported", i, count));
            if (!(count >= 0 && count <= static_cast<double>(body.remaining())))
                return body.error(ErrorCode::kCorrupt,
                                  fmt::format("{} {} has a list of {} values, which exceeds the file", element.name, i, count));
            std::vector<std::uint32_t>& out = count == 3 ? mesh.triangles : mesh.quads;
            for (double k = 0; k < count && body.ok(); ++k) {
                const double index = body.value(p.type);
                if (!wanted || !body.ok()) continue;
                if (!(index >= 0 && index < static_cast<double>(vertices) && index <= 4294967295.0))
                    return body.error(ErrorCode::kCorrupt, fmt::format("index {} of face {} is out of range; there are {} vertices",
                                                                       index, i, vertices));
                out.push_back(static_cast<std::uint32_t>(index));
            }
        }
        if (!body.ok()) return body.cut(element, i);
    }
    return {};
}

}  // namespace

Result<PlyMesh> parse_ply(std::string_view bytes, std::string_view name) {
    const Result<Header> header = parse_header(name, bytes);
    if (!header) return header.error();
    PlyMesh mesh;
    Body body(name, bytes, *header);
    const auto vertex = std::ranges::find(header->elements, "vertex", &Element::name);
    const std::uint64_t vertices = vertex == header->elements.end() || vertex->properties.empty() ? 0 : vertex->count;
    for (const Element& element : header->elements) {
        if (element.properties.empty()) continue;
        const Status read = element.name == "vertex" ? read_vertices(element, body, mesh)
                                                     : read_rows(element, element.name == "face", vertices, body, mesh);
        if (!read) return read.error();
    }
    return mesh;
}

}  // namespace latent::render
