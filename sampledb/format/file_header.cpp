#include "sampledb/format/file_header.h"

#include "sampledb/data/limits.h"
#include "sampledb/format/frames.h"

namespace latent::sampledb {

namespace {

constexpr std::size_t kFrontSize = 64;  // what is checked before the rest is used
constexpr std::size_t kKnotSize = 12;

// The lowest version that says it all, so that programs that know no higher one read what they can.
std::uint16_t minor_of(const Job& job) {
    if (job.positions.sampler == PositionSampler::kPixels) return 2;
    return job.precision < kFullPrecision ? 1 : 0;
}
std::uint64_t features_of(const Job& job) {
    return kFooterFeature | (job.precision < kFullPrecision ? kPrecisionFeature : 0) |
           (job.extra.size() > kFewExtraColumns ? kManyColumnsFeature : 0) |
           (job.positions.sampler == PositionSampler::kPixels ? kPixelsFeature : 0);
}

Bytes encode_job(const FileHeader& header) {
    const Job& job = header.job;
    Bytes body;
    ByteWriter out(body);
    put_hash(out, job.id);
    out.put(job.aspect_width);
    out.put(job.aspect_height);
    out.put(static_cast<std::uint8_t>(job.kind));
    out.put(static_cast<std::uint8_t>(job.positions.sampler));
    out.put(job.batch);
    out.put(job.light_paths_per_sample);
    out.put(job.light_unit_cd_m2);
    out.put(job.run_bytes);
    out.put(job.run_samples);
    out.put(job.positions.shift_u);
    out.put(job.positions.shift_v);
    out.put(static_cast<std::uint32_t>(job.density.knots().size()));
    out.put(static_cast<std::uint32_t>(job.extra.size()));
    out.put(static_cast<std::uint32_t>(header.provenance_json.size()));
    for (const WavelengthDensity::Knot& knot : job.density.knots()) {
        out.put(knot.cumulative);
        out.put(knot.lambda);
    }
    for (const ExtraColumnSpec& column : job.extra) {
        out.put(static_cast<std::uint8_t>(column.type));
        out.put(static_cast<std::uint8_t>(column.name.size()));
        out.put(std::as_bytes(std::span(column.name)));
    }
    out.put(std::as_bytes(std::span(header.provenance_json)));
    if (minor_of(job) >= 1) out.put(job.precision);
    if (minor_of(job) >= 2) {
        out.put(job.positions.width);
        out.put(job.positions.height);
    }
    return body;
}

Result<FileHeader> decode_job(ByteSpan body, std::uint16_t minor, std::uint64_t features) {
    FileHeader header;
    Job& job = header.job;
    ByteReader in(body);
    job.id = get_hash(in);
    job.aspect_width = in.get<std::uint32_t>();
    job.aspect_height = in.get<std::uint32_t>();
    job.kind = RecordKind{in.get<std::uint8_t>()};
    job.positions.sampler = PositionSampler{in.get<std::uint8_t>()};
    job.batch = in.get<std::uint16_t>();
    job.light_paths_per_sample = in.get<std::uint32_t>();
    job.light_unit_cd_m2 = in.get<double>();
    job.run_bytes = in.get<std::uint64_t>();
    job.run_samples = in.get<std::uint32_t>();
    job.positions.shift_u = in.get<std::uint32_t>();
    job.positions.shift_v = in.get<std::uint32_t>();
    const std::uint32_t knot_count = in.get<std::uint32_t>();
    const std::uint32_t extra_count = in.get<std::uint32_t>();
    const std::uint32_t provenance_size = in.get<std::uint32_t>();
    if (knot_count > in.remaining() / kKnotSize || extra_count > kMaxExtraColumns || provenance_size > kMaxProvenanceSize) {
        return corrupt("the header's counts exceed its size");
    }
    std::vector<WavelengthDensity::Knot> knots(knot_count);
    for (WavelengthDensity::Knot& knot : knots) {
        knot.cumulative = in.get<std::uint64_t>();
        knot.lambda = in.get<std::uint32_t>();
    }
    for (std::uint32_t i = 0; i < extra_count; ++i) {
        const ColumnType type{in.get<std::uint8_t>()};
        const std::uint8_t name_size = in.get<std::uint8_t>();
        job.extra.push_back({get_text(in, name_size), type});
    }
    header.provenance_json = get_text(in, provenance_size);
    if (minor >= 1) job.precision = in.get<std::uint8_t>();
    if (minor >= 2) {
        job.positions.width = in.get<std::uint32_t>();
        job.positions.height = in.get<std::uint32_t>();
    }
    if (!in.ok() || (minor <= kHeaderMinor && in.remaining() != 0)) return corrupt("the header's fields do not fill it");
    if (knot_count != 0) {
        Result<WavelengthDensity> density = WavelengthDensity::from_knots(std::move(knots));
        if (!density) return corrupt(density.error().message);
        job.density = std::move(*density);
    }
    if (Status s = job.validate(); !s) {
        return Error{s.error().code == ErrorCode::kUnsupported ? ErrorCode::kUnsupported : ErrorCode::kCorrupt, s.error().message};
    }
    if ((features | kFooterFeature) != features_of(job)) return corrupt("a header whose features contradict its fields");
    return header;
}

}  // namespace

Result<Bytes> encode_file_header(const FileHeader& header) {
    if (Status s = header.job.validate(); !s) return s.error();
    if (header.provenance_json.size() > kMaxProvenanceSize) return Error{ErrorCode::kOutOfRange, "provenance longer than 512 KiB"};
    const Bytes body = encode_job(header);
    const std::uint64_t copy_size = round_up_to_block(kFrontSize + body.size());
    Bytes rest = body;
    rest.resize(copy_size - kFrontSize);

    Bytes file;
    ByteWriter out(file);
    out.put(bytes_of(kFileMagic));
    out.put(kMajor);
    out.put(minor_of(header.job));
    out.put(static_cast<std::uint32_t>(copy_size));
    out.put(features_of(header.job));
    out.put(static_cast<std::uint64_t>(body.size()));
    out.put(hash64(rest));
    out.put_zeros(16);
    out.put(hash64(file));
    out.put(rest);
    const Bytes copy = file;
    out.put(copy);
    return file;
}

Result<FileHeader> decode_file_header(ByteSpan bytes, std::uint64_t* copy_size) {
    if (!begins_with(bytes, kFileMagic)) return Error{ErrorCode::kForeign, "not a Latent file"};
    if (bytes.size() < kFrontSize) return Error{ErrorCode::kTruncated, "ends inside its header"};
    ByteReader in(bytes.subspan(sizeof(Magic)));
    const std::uint16_t major = in.get<std::uint16_t>();
    const std::uint16_t minor = in.get<std::uint16_t>();
    const std::uint64_t size = in.get<std::uint32_t>();
    const std::uint64_t features = in.get<std::uint64_t>();
    const std::uint64_t body_size = in.get<std::uint64_t>();
    const std::uint64_t body_hash = in.get<std::uint64_t>();
    in.take(16);
    if (in.get<std::uint64_t>() != hash64(bytes.first(kFrontSize - 8))) return corrupt("header checksum mismatch");
    if (Status s = check_version(major, features, kPrecisionFeature | kFooterFeature | kManyColumnsFeature | kPixelsFeature); !s)
        return s.error();
    if (size % kBlock != 0 || size == 0 || size > kMaxHeaderSize || body_size > size - kFrontSize) {
        return corrupt("a header of impossible size");
    }
    if (copy_size != nullptr) *copy_size = size;
    if (bytes.size() < size) return Error{ErrorCode::kTruncated, "ends inside its header"};
    if (hash64(bytes.subspan(kFrontSize, size - kFrontSize)) != body_hash) return corrupt("header checksum mismatch");
    if (!all_zero(bytes.subspan(kFrontSize + body_size, size - kFrontSize - body_size)))
        return corrupt("nonzero bytes after the header's fields");
    return decode_job(bytes.subspan(kFrontSize, body_size), minor, features);
}

}  // namespace latent::sampledb
