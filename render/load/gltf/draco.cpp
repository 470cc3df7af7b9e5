#include "render/load/gltf/draco.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>

#include <limits>

#include "base/bytes.h"

namespace latent::render {

namespace {

Error bad_draco(const std::string& why) { return {ErrorCode::kCorrupt, "is not a mesh in the compression of Draco: " + why}; }

// Numbers at the front of the bytes.
class DracoHeader {
 public:
    explicit DracoHeader(std::string_view bytes) : bytes_(bytes) {}

    std::uint64_t byte() { return at_ < bytes_.size() ? static_cast<std::uint8_t>(bytes_[at_++]) : (is_short_ = true, 0); }
    std::uint64_t varint() {
        std::uint64_t out = 0;
        for (unsigned shift = 0; shift < 35; shift += 7) {
            const std::uint64_t next = byte();
            out |= (next & 127) << shift;
            if (next < 128) break;
        }
        return out;
    }
    bool is_short() const { return is_short_; }

 private:
    std::string_view bytes_;
    std::size_t at_ = 0;
    bool is_short_ = false;
};

// Draco makes room for as many triangles as the mesh says that it has, so that is looked at first.
Status check_size(std::string_view packed) {
    constexpr std::uint64_t kFree = 1 << 20, kMaxPerByte = 64;
    if (!packed.starts_with("DRACO")) return bad_draco("it does not begin with \"DRACO\"");
    DracoHeader header(packed.substr(5));
    const std::uint64_t major = header.byte(), minor = header.byte(), type = header.byte(), method = header.byte();
    header.byte();
    const std::uint64_t flags = header.byte();
    if (major != 2 || minor != 2)
        return Error{ErrorCode::kUnsupported, fmt::format("is of version {}.{} of Draco's format; glTF has 2.2", major, minor)};
    if (type != draco::TRIANGULAR_MESH || flags != 0)
        return Error{ErrorCode::kUnsupported, type != draco::TRIANGULAR_MESH ? "holds points instead of triangles"
                                                                             : "holds metadata, which is not supported"};
    if (method == draco::MESH_EDGEBREAKER_ENCODING) {
        header.byte();
        header.varint();
    }
    const std::uint64_t faces = header.varint();
    if (header.is_short()) return Error{ErrorCode::kTruncated, "is truncated"};
    if (faces > kFree + kMaxPerByte * packed.size())
        return bad_draco(fmt::format("{} triangles in {} bytes", faces, packed.size()));
    return {};
}

float largest_of(draco::DataType type) {
    switch (type) {
        case draco::DT_INT8:
            return std::numeric_limits<std::int8_t>::max();
        case draco::DT_UINT8:
            return std::numeric_limits<std::uint8_t>::max();
        case draco::DT_INT16:
            return std::numeric_limits<std::int16_t>::max();
        case draco::DT_UINT16:
            return std::numeric_limits<std::uint16_t>::max();
        default:
            return 1;
    }
}

// False: a value that is not there.
template <class Number>
bool add_values(const draco::PointAttribute& from, std::size_t vertices, std::vector<float>& out) {
    std::vector<Number> item(from.num_components());
    for (std::size_t i = 0; i < vertices; ++i) {
        const draco::AttributeValueIndex at = from.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
        if (at.value() >= from.size() || !from.ConvertValue<Number>(at, item.data())) return false;
        for (const Number x : item) out.push_back(static_cast<float>(x));
    }
    return true;
}

}  // namespace

Result<DracoMesh> unpack_draco(std::string_view packed) {
    if (Status good = check_size(packed); !good) return good.error();
    draco::DecoderBuffer buffer;
    buffer.Init(packed.data(), packed.size());
    draco::Decoder decoder;
    const draco::StatusOr<std::unique_ptr<draco::Mesh>> decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) return bad_draco(decoded.status().error_msg_string());
    const draco::Mesh& mesh = *decoded.value();
    DracoMesh out;
    out.vertices = mesh.num_points();
    out.indices.reserve(3 * std::size_t{mesh.num_faces()});
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
        for (const draco::PointIndex& vertex : mesh.face(draco::FaceIndex(f))) out.indices.push_back(vertex.value());
    }
    for (int i = 0; i < mesh.num_attributes(); ++i) {
        const draco::PointAttribute& from = *mesh.attribute(i);
        DracoMesh::Attribute& to = out.attributes[from.unique_id()];
        to.components = from.num_components();
        to.largest = largest_of(from.data_type());
        const bool is_float = from.data_type() == draco::DT_FLOAT32 || from.data_type() == draco::DT_FLOAT64;
        if (!(is_float ? add_values<float>(from, out.vertices, to.values)
                       : add_values<std::int64_t>(from, out.vertices, to.values)))
            return bad_draco(fmt::format("values of its attribute {} are missing", from.unique_id()));
    }
    return out;
}

}  // namespace latent::render
