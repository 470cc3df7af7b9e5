#include "tests/fuzz/mend.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "base/hash.h"
#include "sampledb/format/footer.h"
#include "sampledb/format/frames.h"
#include "sampledb/format/run_header.h"

namespace latent::fuzz {

using namespace sampledb;

namespace {

constexpr std::size_t kHeaderFront = 64;

template <class T>
T get(const Bytes& bytes, std::size_t at) {
    T value{};
    if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}
template <class T>
void set(Bytes& bytes, std::size_t at, const T& value) {
    if (at + sizeof value <= bytes.size()) std::memcpy(bytes.data() + at, &value, sizeof value);
}

// XXH3-64 of bytes `at` .. `at + size - 1`, as far as they are there.
std::uint64_t hash_of(const Bytes& bytes, std::size_t at, std::uint64_t size) {
    if (at >= bytes.size()) return hash64({});
    return hash64(ByteSpan(bytes).subspan(at, static_cast<std::size_t>(std::min<std::uint64_t>(size, bytes.size() - at))));
}

void mend_copy(Bytes& file, std::size_t at, std::size_t size) {
    set(file, at + 32, hash_of(file, at + kHeaderFront, size - std::min(size, kHeaderFront)));
    set(file, at + 56, hash_of(file, at, 56));
}

// Bytes of a copy of the header; 0 if the field makes no sense.
std::size_t copy_size(const Bytes& file) {
    const auto size = get<std::uint32_t>(file, 12);
    return size % kBlock == 0 && size <= file.size() / 2 ? size : 0;
}

// Bytes of a run by its header; 0 if it is not all there.
std::size_t run_size(const Bytes& bytes, std::size_t at) {
    const std::uint64_t pages_size = get<std::uint64_t>(bytes, at + 104), pages = get<std::uint64_t>(bytes, at + 64);
    if (pages_size > bytes.size() || pages > bytes.size()) return 0;
    const std::uint64_t size = round_up_to_block(kRunHeaderSize + pages_size + get<std::uint32_t>(bytes, at + 12) * kIntervalSize +
                                                 pages * kPageEntrySize);
    return at + size <= bytes.size() ? static_cast<std::size_t>(size) : 0;
}

bool is_run(const Bytes& bytes, std::size_t at) { return at < bytes.size() && begins_with(ByteSpan(bytes).subspan(at), kRunMagic); }

}  // namespace

void mend_header(Bytes& file) {
    const std::size_t size = copy_size(file);
    mend_copy(file, 0, size);
    if (size > 0) mend_copy(file, size, size);
}

void mend_run(Bytes& bytes, std::size_t at) {
    const std::size_t size = run_size(bytes, at);
    if (size > 0) {
        const std::size_t index = at + kRunHeaderSize + get<std::uint64_t>(bytes, at + 104);
        const std::size_t entries = index + get<std::uint32_t>(bytes, at + 12) * kIntervalSize;
        const std::uint64_t pages = get<std::uint64_t>(bytes, at + 64);
        Hasher128 content;
        for (std::size_t page = 0, begin = at + kRunHeaderSize; page < pages; ++page) {
            const std::size_t entry = entries + page * kPageEntrySize;
            const auto stored = get<std::uint32_t>(bytes, entry + 32);
            set(bytes, entry + 40, hash_of(bytes, begin, stored));
            begin += stored;
            content.update(ByteSpan(bytes).subspan(entry, 32));
        }
        set(bytes, at + 112, hash_of(bytes, index, at + size - index));
        const Hash128 hash = content.digest();
        set(bytes, at + 120, hash.low);
        set(bytes, at + 128, hash.high);
    }
    set(bytes, at + 248, hash_of(bytes, at, 248));
}

void mend_footer(Bytes& file) {
    for (std::size_t at = 0; at + kFooterHeadSize <= file.size(); at += kBlock) {
        if (!begins_with(ByteSpan(file).subspan(at), kFooterMagic)) continue;
        const std::uint64_t entries = get<std::uint64_t>(file, at + 16), provenance = get<std::uint64_t>(file, at + 24);
        if (entries > file.size() || provenance > file.size()) continue;
        const std::size_t first = at + kFooterHeadSize, behind = first + static_cast<std::size_t>(entries) * kRunEntrySize;
        set(file, at + 32, hash_of(file, first, entries * kRunEntrySize));
        set(file, at + 40, hash_of(file, behind, provenance));
        set(file, at + 56, hash_of(file, at, 56));
        const std::size_t end = behind + static_cast<std::size_t>(provenance);
        if (end + kFooterHeadSize <= file.size())
            std::copy_n(file.begin() + static_cast<std::ptrdiff_t>(at), kFooterHeadSize,
                        file.begin() + static_cast<std::ptrdiff_t>(end));
    }
}

void mend_file(Bytes& file) {
    mend_header(file);
    for (std::size_t at = 0; at < file.size(); at += kBlock) {
        if (is_run(file, at)) mend_run(file, at);
    }
    mend_footer(file);
}

}  // namespace latent::fuzz
