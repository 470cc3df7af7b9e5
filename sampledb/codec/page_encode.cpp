#include <algorithm>
#include <cstring>

#include "base/hash.h"
#include "sampledb/codec/page_codec.h"
#include "sampledb/codec/page_layout.h"
#include "sampledb/codec/planes.h"
#include "sampledb/data/z_order.h"
#include "sampledb/format/file_format.h"

namespace latent::sampledb {

namespace {

// Buffers that every page of a thread uses again.
struct Scratch {
    Bytes planes, payload, bitmap;
    std::vector<std::uint32_t> words, u, v;
    std::vector<std::uint64_t> numbers;
    std::vector<ColumnEntry> table;
};
thread_local Scratch scratch;

std::uint32_t zigzag(std::uint32_t difference) { return difference << 1 ^ (0u - (difference >> 31)); }
// Of a multiple of 2^step, counted in these: what rounding has made zero takes no room.
std::uint32_t zigzag(std::uint32_t difference, unsigned step) {
    return zigzag(static_cast<std::uint32_t>(static_cast<std::int32_t>(difference) >> step));
}

// The differences of rounded values are multiples of 2^step. `bits`: all of them, or-ed.
unsigned step_of(const Job& job, std::uint32_t bits) {
    const unsigned step = kFullPrecision - job.precision;
    return (bits & ((1u << step) - 1)) == 0 ? step : 0;
}
void set_transform(ColumnEntry& entry, unsigned step, Transform plain, Transform stepped) {
    entry.transform = step == 0 ? plain : stepped;
    entry.bits = static_cast<std::uint8_t>(step);
}

void store_planes(ColumnEntry& entry, ByteSpan values, std::size_t value_width) {
    const std::span<std::byte> planes = at_least(scratch.planes, values.size());
    split_planes(values, value_width, planes);
    const std::size_t n = values.size() / value_width;
    for (std::size_t p = 0; p < value_width; ++p) entry.planes.push_back(encode_plane(planes.subspan(p * n, n), scratch.payload));
}

void store_packed(ColumnEntry& entry, std::span<const std::uint64_t> values, unsigned bits) {
    entry.bits = static_cast<std::uint8_t>(bits);
    if (bits == 0) return;
    scratch.planes.clear();
    pack_bits(values, bits, scratch.planes);
    entry.planes.push_back(encode_plane(scratch.planes, scratch.payload));
}

// A new entry with its hash; true if all values are equal, which `base` then says.
bool begin_column(Column column, ByteSpan values, std::size_t value_width) {
    ColumnEntry entry{.column = column};
    entry.hash = hash64(values);
    const bool constant =
        !values.empty() && std::memcmp(values.data(), values.data() + value_width, values.size() - value_width) == 0;
    if (constant) {
        entry.transform = Transform::kPacked;
        std::memcpy(&entry.base, values.data(), value_width);
    }
    scratch.table.push_back(std::move(entry));
    return constant || values.empty();
}

template <class T>
void encode_plain(Column column, std::span<const T> values) {
    if (!begin_column(column, std::as_bytes(values), sizeof(T)))
        store_planes(scratch.table.back(), std::as_bytes(values), sizeof(T));
}

// Where the job's sampler puts the samples of a camera page, in scratch.u and scratch.v; false if the job has none.
bool sample_positions(const Job& job, const Page& page) {
    if (page.record_class != RecordClass::kCamera || job.positions.sampler != PositionSampler::kHalton23) return false;
    halton23(rows(page.sample, page.count), job.positions, at_least(scratch.u, page.count), at_least(scratch.v, page.count));
    return true;
}

// Sample numbers within a node differ where u does: their reversed low bits are near each other. n = h 2^s + rev_s(f), and
// f - f0 (mod 2^s) takes about s - level bits, against s for n itself. `u`: where a sampler puts these samples, or empty; without
// its shift that is n reversed, of which the 32 - s low bits are the same for all.
void encode_samples(std::span<const std::uint64_t> n, std::span<const std::uint32_t> u, std::uint32_t shift_u) {
    if (begin_column(Column::kSample, std::as_bytes(n), 8)) return;
    ColumnEntry& entry = scratch.table.back();
    std::uint64_t low = n[0], high = n[0];
    for (const std::uint64_t value : n) low = std::min(low, value), high = std::max(high, value);
    const std::span<std::uint64_t> numbers = at_least(scratch.numbers, n.size());
    const int s = std::bit_width(low ^ high);
    if (!u.empty() && s <= 32) {
        std::int32_t least = 0, most = 0;
        for (const std::uint32_t at : u) {
            const std::int32_t d = static_cast<std::int32_t>(at - u[0]);
            least = std::min(least, d), most = std::max(most, d);
        }
        const unsigned bits =
            static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(std::int64_t{most} - least) >> (32 - s)));
        if (bits < static_cast<unsigned>(std::bit_width(high - low))) {
            const std::uint32_t f0 = u[0] + static_cast<std::uint32_t>(least);
            for (std::size_t i = 0; i < n.size(); ++i) numbers[i] = (u[i] - f0) >> (32 - s);
            entry.transform = Transform::kLattice;
            entry.lattice_bits = static_cast<std::uint8_t>(s);
            entry.base = n[0] >> s << s | (reverse_bits(f0 - shift_u) & ((std::uint64_t{1} << s) - 1));
            return store_packed(entry, numbers, bits);
        }
    }
    entry.transform = Transform::kPacked;
    entry.base = low;
    for (std::size_t i = 0; i < n.size(); ++i) numbers[i] = n[i] - low;
    store_packed(entry, numbers, static_cast<unsigned>(std::bit_width(high - low)));
}

void encode_positions(const Page& page, bool follow) {
    for (const auto& [column, values] : {std::pair{Column::kU, &page.u}, std::pair{Column::kV, &page.v}}) {
        const std::span<const std::uint32_t> positions = rows(*values, page.count);
        if (follow) {
            scratch.table.push_back({.column = column, .transform = Transform::kSampler, .hash = hash64(std::as_bytes(positions))});
        } else {
            encode_plain(column, positions);
        }
    }
}

// The bright rows of a page of XYZ records: those where y is not zero. Black records are so in x, y and z, and the mantissas of
// bright ones are noise: where a sixteenth is black, only bright rows are stored.
struct Bright {
    bool worth_it = false;
    std::size_t count = 0;  // as scratch.bitmap says
};

void store_bright(ColumnEntry& entry, const Bright& bright, std::span<std::uint32_t> words) {
    close_up(scratch.bitmap, words);
    store_planes(entry, std::as_bytes(words.first(bright.count)), 4);
}

void encode_crossed(const Job& job, Column column, std::span<const float> values, std::span<const float> y, const Bright& bright) {
    if (begin_column(column, std::as_bytes(values), 4)) return;
    const std::span<std::uint32_t> words = at_least(scratch.words, values.size());
    std::uint32_t elsewhere = 0, all = 0;  // bits of values where y is zero; of differences
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::uint32_t bits = std::bit_cast<std::uint32_t>(values[i]), of_y = std::bit_cast<std::uint32_t>(y[i]);
        words[i] = bits - of_y;
        all |= bits - of_y;
        elsewhere |= of_y == 0 ? bits : 0;
    }
    const unsigned step = step_of(job, all);
    for (std::uint32_t& word : words) word = zigzag(word, step);
    ColumnEntry& entry = scratch.table.back();
    if (bright.worth_it && elsewhere == 0) {
        set_transform(entry, step, Transform::kSparseCross, Transform::kSteppedSparseCross);
        store_bright(entry, bright, words);
    } else {
        set_transform(entry, step, Transform::kCross, Transform::kSteppedCross);
        store_planes(entry, std::as_bytes(words), 4);
    }
}

void encode_y(std::span<const float> y, const Bright& bright) {
    if (!bright.worth_it) return encode_plain(Column::kY, y);
    begin_column(Column::kY, std::as_bytes(y), 4);  // never constant: some rows are black and some are not
    ColumnEntry& entry = scratch.table.back();
    entry.transform = Transform::kSparse;
    entry.planes.push_back(encode_plane(scratch.bitmap, scratch.payload));
    const std::span<std::uint32_t> words = at_least(scratch.words, y.size());
    std::memcpy(words.data(), y.data(), y.size_bytes());
    store_bright(entry, bright, words);
}

void encode_xyz(const Job& job, const Page& page) {
    const std::span<const float> y = rows(page.y, page.count);
    Bright bright{.count = find_nonzero(std::as_bytes(y), scratch.bitmap)};
    bright.worth_it = bright.count > 0 && bright.count <= y.size() - (y.size() + 15) / 16;
    encode_crossed(job, Column::kX, rows(page.x, page.count), y, bright);
    encode_y(y, bright);
    encode_crossed(job, Column::kZ, rows(page.z, page.count), y, bright);
}

// First value as it is, then zigzag(b1 - b0), then zigzag(b_i - 2 b_{i-1} + b_{i-2}), for each record on its own.
void encode_delta2(const Job& job, Column column, std::span<const float> values, std::span<const std::uint16_t> pairs) {
    if (begin_column(column, std::as_bytes(values), 4)) return;
    const std::span<std::uint32_t> words = at_least(scratch.words, values.size());
    std::uint32_t all = 0;
    for (const float value : values) all |= std::bit_cast<std::uint32_t>(value);
    const unsigned step = step_of(job, all);
    std::size_t at = 0;
    for (const std::uint16_t n : pairs) {
        std::uint32_t before = 0, slope = 0;
        for (std::uint16_t i = 0; i < n; ++i, ++at) {
            const std::uint32_t bits = std::bit_cast<std::uint32_t>(values[at]);
            words[at] = i == 0 ? bits >> step : zigzag(bits - before - slope, step);
            slope = i == 0 ? 0 : bits - before;
            before = bits;
        }
    }
    set_transform(scratch.table.back(), step, Transform::kDelta2, Transform::kSteppedDelta2);
    store_planes(scratch.table.back(), std::as_bytes(words), 4);
}

void encode_extra(Column column, ByteSpan values, std::size_t value_width) {
    if (!begin_column(column, values, value_width)) store_planes(scratch.table.back(), values, value_width);
}

FilmNode node_of(const Page& page) {
    std::uint32_t different_u = 0, different_v = 0;
    for (std::size_t i = 1; i < page.count; ++i) {
        different_u |= page.u[i] ^ page.u[0];
        different_v |= page.v[i] ^ page.v[0];
    }
    const int level = std::min<int>(kZPrefixLevels, std::countl_zero(different_u | different_v));
    if (level == 0) return {};
    return {static_cast<std::uint8_t>(level), page.u[0] >> (32 - level), page.v[0] >> (32 - level)};
}

}  // namespace

PageInfo encode_page(const Job& job, const Page& page, Bytes& out) {
    assert(page.count > 0 && page.count <= kMaxRecordsPerPage);
    scratch.table.clear();
    scratch.payload.clear();
    const bool camera = page.record_class == RecordClass::kCamera;
    const bool sampled = sample_positions(job, page);
    const std::span<const std::uint32_t> u = rows(scratch.u, sampled ? page.count : 0), v = rows(scratch.v, u.size());
    encode_samples(rows(page.sample, page.count), u, job.positions.shift_u);
    encode_positions(page, std::ranges::equal(rows(page.u, page.count), u) && std::ranges::equal(rows(page.v, page.count), v));
    if (camera && page.unit_share) {
        const std::span<std::uint32_t> ones = at_least(scratch.words, page.count);
        std::ranges::fill(ones, std::bit_cast<std::uint32_t>(1.0f));
        encode_plain(Column::kShare, std::span<const std::uint32_t>(ones));
    } else if (camera) {
        encode_plain(Column::kShare, rows(page.share, page.count));
    }
    std::size_t pair_count = 0;
    if (job.kind == RecordKind::kXyz) {
        encode_xyz(job, page);
    } else {
        const std::span<const std::uint16_t> pairs = rows(page.pairs, page.count);
        for (const std::uint16_t n : pairs) pair_count += n;
        encode_plain(Column::kPairs, pairs);
        if (!job.density.empty()) {
            encode_plain(Column::kXi, rows(page.xi, page.count));
            encode_plain(Column::kIndex, rows(page.index, page.count));
        }
        encode_delta2(job, Column::kPower, rows(page.power, pair_count), pairs);
        if (job.density.empty()) encode_delta2(job, Column::kLambda, rows(page.lambda_nm, pair_count), pairs);
    }
    for (std::size_t i = 0; i < job.extra.size(); ++i) {
        const std::size_t value_width = width(job.extra[i].type);
        encode_extra(static_cast<Column>(static_cast<std::size_t>(Column::kFirstExtra) + i),
                     rows(page.extra[i].values, page.count * value_width), value_width);
    }

    const std::size_t begin = out.size();
    ByteWriter table(out);
    table.put(static_cast<std::uint32_t>(scratch.table.size()));
    for (const ColumnEntry& entry : scratch.table) {
        table.put(static_cast<std::uint8_t>(entry.column));
        table.put(static_cast<std::uint8_t>(entry.transform));
        table.put(entry.bits);
        table.put(static_cast<std::uint8_t>(entry.planes.size()));
        table.put(static_cast<std::uint32_t>(entry.lattice_bits));
        table.put(entry.base);
        table.put(entry.hash);
        for (const PlaneEntry& plane : entry.planes) table.put(plane.word());
    }
    table.put(scratch.payload);

    PageInfo info{};
    info.node = node_of(page);
    info.record_class = page.record_class;
    info.record_count = static_cast<std::uint32_t>(page.count);
    info.pair_count = static_cast<std::uint32_t>(pair_count);
    info.stored_size = static_cast<std::uint32_t>(out.size() - begin);
    info.decoded_size = static_cast<std::uint32_t>(decoded_page_size(job, page.record_class, page.count, pair_count));
    info.stored_hash = hash64(ByteSpan(out).subspan(begin));
    info.content_hash = content_hash(scratch.table);
    return info;
}

}  // namespace latent::sampledb
