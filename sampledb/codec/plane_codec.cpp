#include "sampledb/codec/plane_codec.h"

#define ZSTD_STATIC_LINKING_ONLY  // ZSTD_c_literalCompressionMode
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <new>
#include <numeric>
#include <span>

#include "hwy/highway.h"
#include "sampledb/data/unreadable.h"

namespace latent::sampledb {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMinCompressed = 64;  // below, a frame's own bytes eat the gain

constexpr std::size_t kPiece = 64, kMaxPieces = 32;  // pieces that a plane is judged by
constexpr std::uint64_t kBit = 256;                  // unit of information: 2^-8 bit

// n log2(n) for the counts of a sample; integers, so that every machine writes the same file.
constexpr auto kSelfInformation = [] {
    std::array<std::uint32_t, kPiece * kMaxPieces + 1> table{};
    for (std::uint64_t n = 1; n < table.size(); ++n) {
        const int whole = std::bit_width(n) - 1;
        std::uint64_t x = n << (30 - whole), log = static_cast<std::uint64_t>(whole);  // 1 <= x / 2^30 < 2
        for (int bit = 0; bit < 16; ++bit) {
            x = x * x >> 30;
            log = log << 1 | x >> 31;
            x >>= x >> 31;
        }
        table[n] = static_cast<std::uint32_t>((n * log) >> 8);
    }
    return table;
}();

// What up to 32 blocks of 64 bytes tell of a plane; contiguous ones, so that no stride of the data can hide in them.
struct PlaneSample {
    std::uint64_t size = 0;
    std::array<std::uint32_t, 256> counts{};  // how often each value occurs
    std::uint64_t values = 0;                 // that occur
    std::uint64_t information = 0;            // entropy times size

    // Whether an entropy coder would save the least part that is worth the time to write and to read.
    bool would_shrink(const PlaneChoice& choice) const {
        return information * choice.min_gain < 8 * kBit * size * (choice.min_gain - 1);
    }
    // Whether `bits` bits a value are nearly what an entropy coder would take.
    bool fills(unsigned bits, const PlaneChoice& choice) const {
        return 4 * bits * kBit * size <= 4 * information + kBit * choice.max_waste * size;
    }
};

PlaneSample sample_of(ByteSpan plane) {
    const std::size_t step = std::max(4 * kPiece, (plane.size() + kMaxPieces - 1) / kMaxPieces);
    std::array<std::array<std::uint16_t, 256>, 4> counts{};  // four, so that equal neighbours do not wait for each other
    PlaneSample sample;
    for (std::size_t at = 0; at < plane.size(); at += step) {
        const ByteSpan piece = plane.subspan(at, std::min(kPiece, plane.size() - at));
        for (std::size_t i = 0; i < piece.size(); ++i) ++counts[i % 4][static_cast<std::uint8_t>(piece[i])];
        sample.size += piece.size();
    }
    sample.information = kSelfInformation[sample.size];
    for (std::size_t value = 0; value < 256; ++value) {
        const std::uint32_t count = counts[0][value] + counts[1][value] + counts[2][value] + counts[3][value];
        sample.counts[value] = count;
        sample.information -= kSelfInformation[count];
        sample.values += count > 0;
    }
    sample.information +=
        (sample.values - 1) * kBit * 721 / 1000;  // a sample's is too small by (values - 1) / (2 ln 2) bits [Miller55]
    return sample;
}

// Whether neighbours are equal in more than half of the cases that chance leaves room for: then zstd finds repetitions.
bool repeats(ByteSpan plane, const PlaneSample& sample) {
    std::uint64_t squares = 0, equal = 0;
    for (const std::uint64_t count : sample.counts) squares += count * count;
    const hn::FixedTag<std::uint8_t, 16> d;
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(plane.data());
    std::size_t i = 0;
    for (; i + 17 <= plane.size(); i += 16) equal += hn::CountTrue(d, hn::Eq(hn::LoadU(d, bytes + i), hn::LoadU(d, bytes + i + 1)));
    return 2 * equal * sample.size * sample.size > i * (squares + sample.size * sample.size);
}

// What zstd answers for want of memory is no answer about the bytes.
std::size_t unless_out_of_memory(std::size_t result) {
    if (ZSTD_getErrorCode(result) == ZSTD_error_memory_allocation) throw std::bad_alloc();
    return result;
}

template <class Context>
Context* made(Context* context) {
    if (context == nullptr) throw std::bad_alloc();
    return context;
}

// Level 1, but hasty about matches, which are few in planes like these: looked for at every fifth byte, and long enough not to be
// chance. Literals are coded in spite of that, as zstd's own faster levels do not.
ZSTD_CCtx* make_compressor() {
    ZSTD_CCtx* const context = made(ZSTD_createCCtx());
    ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, 1);
    ZSTD_CCtx_setParameter(context, ZSTD_c_minMatch, 6);
    ZSTD_CCtx_setParameter(context, ZSTD_c_targetLength, 4);
    ZSTD_CCtx_setParameter(context, ZSTD_c_literalCompressionMode, ZSTD_ps_enable);
    return context;
}

// Eight numbers of `bits` bits, 1..7, packed from the low bit on -> one in each byte of a word: halves are moved apart until each
// has its own byte.
struct Eight {
    explicit Eight(unsigned bits_of_one)
        : bits(bits_of_one),
          ones(((1u << bits) - 1) * 0x0001'0001'0001'0001),
          twos(((1u << 2 * bits) - 1) * 0x0000'0001'0000'0001),
          fours((std::uint64_t{1} << 4 * bits) - 1) {}

    std::uint64_t spread(std::uint64_t x) const {
        x = (x & fours) | (x >> 4 * bits & fours) << 32;
        x = (x & twos) | (x >> 2 * bits & twos) << 16;
        return (x & ones) | (x >> bits & ones) << 8;
    }

    unsigned bits;
    std::uint64_t ones, twos, fours;
};

// For TableLookupBytesOr0: bytes below 16 as they are, a high bit in the others.
template <class V>
V place_in_part(V bytes) {
    const hn::DFromV<V> d;
    return hn::And(hn::SaturatedAdd(bytes, hn::Set(d, 0x70)), hn::Set(d, 0x8F));
}

constexpr unsigned kMaxDictionaryBits = 7;

std::size_t dictionary_size(unsigned bits, std::size_t count) { return 1 + (std::size_t{1} << bits) + (count + 7) / 8 * bits; }

// The values of a dictionary, and where each stands in it.
struct Dictionary {
    explicit Dictionary(std::span<const std::uint32_t, 256> counts) {
        for (unsigned value = 0; value < 256; ++value) {
            if (counts[value] == 0) continue;
            values[size] = static_cast<std::uint8_t>(value);
            place[value] = static_cast<std::uint8_t>(++size);
        }
    }
    unsigned bits() const { return static_cast<unsigned>(std::bit_width(size - 1)); }

    std::array<std::uint8_t, 256> values{};
    std::array<std::uint8_t, 256> place{};  // from 1 on; 0: not in it
    unsigned size = 0;
};

// Writes the places, from 0 on, of a plane's values with so many bits each, and up to 8 bytes more; false if the dictionary, of 128
// values at most, lacks one. Sixteen values are looked up at once, in each sixteenth of the dictionary that has any.
bool pack_plane(ByteSpan plane, const Dictionary& dictionary, unsigned bits, std::byte* to) {
    const hn::FixedTag<std::uint8_t, 16> d;
    const hn::FixedTag<std::uint64_t, 2> d64;
    std::array<std::uint8_t, 16> parts{};
    std::size_t part_count = 0;
    for (std::size_t part = 0; part < 16; ++part) {
        if (std::any_of(&dictionary.place[16 * part], &dictionary.place[16 * part] + 16, [](std::uint8_t at) { return at > 0; }))
            parts[part_count++] = static_cast<std::uint8_t>(16 * part);
    }
    const auto ones = hn::Set(d64, ((1u << bits) - 1) * std::uint64_t{0x0001'0001'0001'0001});
    const auto twos = hn::Set(d64, ((1u << 2 * bits) - 1) * std::uint64_t{0x0000'0001'0000'0001});
    const auto fours = hn::Set(d64, (std::uint64_t{1} << 4 * bits) - 1);
    const int apart = static_cast<int>(8 - bits);
    auto complete = hn::Set(d, 0xFF);
    const auto pack = [&](const std::uint8_t* from) {
        const auto x = hn::LoadU(d, from);
        auto place = hn::Zero(d);
        for (std::size_t i = 0; i < part_count; ++i) {
            const auto in_part = place_in_part(hn::Sub(x, hn::Set(d, parts[i])));
            place = hn::Or(place, hn::TableLookupBytesOr0(hn::LoadU(d, &dictionary.place[parts[i]]), in_part));
        }
        complete = hn::Min(complete, place);
        // The halves of each word are moved together until its eight numbers touch.
        auto word = hn::BitCast(d64, hn::Sub(place, hn::Set(d, 1)));
        word = hn::Or(hn::And(word, ones), hn::ShiftRightSame(hn::AndNot(ones, word), apart));
        word = hn::Or(hn::And(word, twos), hn::ShiftRightSame(hn::AndNot(twos, word), 2 * apart));
        word = hn::Or(hn::And(word, fours), hn::ShiftRightSame(hn::AndNot(fours, word), 4 * apart));
        store_le(to, hn::GetLane(word));
        store_le(to + bits, hn::ExtractLane(word, 1));
        to += 2 * bits;
    };
    const auto* const from = reinterpret_cast<const std::uint8_t*>(plane.data());
    std::size_t i = 0;
    for (; i + 16 <= plane.size(); i += 16) pack(from + i);
    if (i < plane.size()) {
        std::array<std::uint8_t, 16> last;
        last.fill(dictionary.values[0]);
        std::copy(from + i, from + plane.size(), last.begin());
        pack(last.data());
    }
    return hn::AllFalse(d, hn::Eq(complete, hn::Zero(d)));
}

// Appends the plane by its dictionary, if it has one of a size that suits the sample.
bool encode_dictionary(ByteSpan plane, const PlaneSample& sample, const PlaneChoice& choice, Bytes& out) {
    const auto suits = [&](const Dictionary& dictionary) {
        const unsigned bits = dictionary.bits();
        return bits <= kMaxDictionaryBits && sample.fills(bits, choice) &&
               dictionary_size(bits, plane.size()) <= plane.size() - plane.size() / 16;
    };
    const std::size_t begin = out.size();
    const auto append = [&](const Dictionary& dictionary) {
        const unsigned bits = dictionary.bits();
        const std::size_t size = dictionary_size(bits, plane.size()), values = std::size_t{1} << bits;
        out.resize(begin + size + 8);  // whole words are written, then cut
        out[begin] = static_cast<std::byte>(bits);
        std::memcpy(&out[begin + 1], dictionary.values.data(), values);
        const bool complete = pack_plane(plane, dictionary, bits, &out[begin + 1 + values]);
        out.resize(complete ? begin + size : begin);
        return complete;
    };
    const Dictionary guess(sample.counts);  // seldom does a plane have values that its sample has not
    if (!suits(guess) || repeats(plane, sample)) return false;
    if (append(guess)) return true;
    std::array<std::uint32_t, 256> there{};
    for (const std::byte value : plane) there[static_cast<std::uint8_t>(value)] = 1;
    const Dictionary all(there);
    return suits(all) && append(all);
}

// `plane` has room for 8 bytes more than `size`.
Status decode_dictionary(ByteSpan stored, std::size_t size, std::byte* plane) {
    const unsigned bits = stored.empty() ? 0 : std::to_integer<unsigned>(stored[0]);
    if (bits < 1 || bits > kMaxDictionaryBits || stored.size() != dictionary_size(bits, size))
        return corrupt("a dictionary of the wrong size");
    const ByteSpan values = stored.subspan(1, std::size_t{1} << bits);
    const ByteSpan packed = stored.subspan(1 + values.size());
    const Eight eight(bits);
    std::size_t i = 0, at = 0;
    for (; at + 8 <= packed.size(); i += 8, at += bits) store_le(plane + i, eight.spread(load_le<std::uint64_t>(&packed[at])));
    for (; i < size; i += 8, at += bits) {  // the last ones: from a copy that can be read past its end
        std::array<std::byte, 8> word{};
        std::copy_n(&packed[at], bits, word.data());
        store_le(plane + i, eight.spread(load_le<std::uint64_t>(word.data())));
    }
    const auto look_up = [&]<std::size_t parts>() {  // a part of the dictionary is as many values as a vector holds
        const hn::FixedTag<std::uint8_t, 16> d;
        std::array<std::uint8_t, 16 * parts> table{};
        std::memcpy(table.data(), values.data(), values.size());
        auto* const bytes = reinterpret_cast<std::uint8_t*>(plane);
        for (i = 0; i + 16 <= size; i += 16) {
            const auto number = hn::LoadU(d, bytes + i);
            auto found = hn::Zero(d);
            for (std::size_t part = 0; part < parts; ++part) {
                const auto place =
                    parts == 1 ? number : place_in_part(hn::Sub(number, hn::Set(d, static_cast<std::uint8_t>(16 * part))));
                found = hn::Or(found, hn::TableLookupBytesOr0(hn::LoadU(d, &table[16 * part]), place));
            }
            hn::StoreU(found, d, bytes + i);
        }
    };
    if (bits <= 4) {
        look_up.template operator()<1>();
    } else if (bits == 5) {
        look_up.template operator()<2>();
    } else if (bits == 6) {
        look_up.template operator()<4>();
    } else {
        look_up.template operator()<8>();
    }
    for (; i < size; ++i) plane[i] = values[std::to_integer<std::size_t>(plane[i])];
    return {};
}

}  // namespace

std::size_t PlaneEncoder::compress(ByteSpan plane) {
    if (!zstd_) zstd_ = {make_compressor(), &ZSTD_freeCCtx};
    const std::size_t bound = ZSTD_compressBound(plane.size());
    if (buffer_.size() < bound) buffer_.resize(bound);
    const std::size_t size = unless_out_of_memory(ZSTD_compress2(zstd_.get(), buffer_.data(), bound, plane.data(), plane.size()));
    return ZSTD_isError(size) || size >= plane.size() - plane.size() / 64 ? 0 : size;
}

PlaneEntry PlaneEncoder::encode(ByteSpan plane, Bytes& out, const PlaneChoice& choice) {
    assert(!plane.empty());
    const std::size_t begin = out.size();
    const auto entry = [&](PlaneCodec codec) { return PlaneEntry{codec, static_cast<std::uint32_t>(out.size() - begin)}; };
    if (std::memcmp(plane.data(), plane.data() + 1, plane.size() - 1) == 0) {
        out.push_back(plane.front());
        return entry(PlaneCodec::kConstant);
    }
    if (plane.size() >= kMinCompressed) {
        const PlaneSample sample = sample_of(plane);
        if (encode_dictionary(plane, sample, choice, out)) return entry(PlaneCodec::kDictionary);
        if (const std::size_t size = sample.would_shrink(choice) ? compress(plane) : 0; size > 0) {
            out.insert(out.end(), buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(size));
            return entry(PlaneCodec::kZstd);
        }
    }
    return encode_raw(plane, out);
}

PlaneEntry PlaneEncoder::encode_raw(ByteSpan plane, Bytes& out) {
    out.insert(out.end(), plane.begin(), plane.end());
    return {PlaneCodec::kRaw, static_cast<std::uint32_t>(plane.size())};
}

std::size_t PlaneEncoder::estimate(ByteSpan plane) {
    const PlaneSample sample = sample_of(plane);
    return std::min<std::size_t>(plane.size(), plane.size() * sample.information / (8 * kBit * sample.size));
}

// Exactly one frame, and no skippable one, that fills the plane.
bool PlaneDecoder::decompress(ByteSpan stored, std::span<std::byte> plane) {
    if (stored.size() < 4 || load_le<std::uint32_t>(stored.data()) != ZSTD_MAGICNUMBER) return false;
    if (ZSTD_findFrameCompressedSize(stored.data(), stored.size()) != stored.size()) return false;
    if (!zstd_) zstd_ = {made(ZSTD_createDCtx()), &ZSTD_freeDCtx};
    return unless_out_of_memory(ZSTD_decompressDCtx(zstd_.get(), plane.data(), plane.size(), stored.data(), stored.size())) ==
           plane.size();
}

Result<ByteSpan> PlaneDecoder::decode(PlaneEntry entry, ByteSpan stored, std::size_t size, Bytes& scratch) {
    if (entry.codec == PlaneCodec::kRaw) {
        if (stored.size() != size) return corrupt("a raw plane of the wrong size");
        return stored;
    }
    if (scratch.size() < size + 8) scratch.resize(size + 8);
    const std::span<std::byte> plane = std::span(scratch).first(size);
    switch (entry.codec) {
        case PlaneCodec::kConstant:
            if (stored.size() != 1) return corrupt("a constant plane of several bytes");
            std::fill(plane.begin(), plane.end(), stored.front());
            break;
        case PlaneCodec::kZstd:
            if (!decompress(stored, plane)) return corrupt("a plane that zstd cannot decompress");
            break;
        default:
            if (Status s = decode_dictionary(stored, size, plane.data()); !s) return s.error();
    }
    return ByteSpan(plane);
}

}  // namespace latent::sampledb
