#include "tools/merge/compact_sort.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace latent::merge {

namespace {

constexpr std::size_t kRowsPerPart = std::size_t{1} << 17;
constexpr std::size_t kSampled = 512;  // every so many-th row says where parts should end

// Boundaries of parts of the Z curve that hold about as many rows each: 0 first; the last part ends with the curve.
std::vector<std::uint32_t> part_begins(std::span<const Slice> slices, std::size_t rows) {
    std::vector<std::uint32_t> sampled;
    std::size_t next = 0, before = 0;
    for (const Slice& slice : slices) {
        for (; next < before + (slice.end - slice.begin); next += kSampled)
            sampled.push_back(slice.rows->z[slice.begin + (next - before)]);
        before += slice.end - slice.begin;
    }
    std::ranges::sort(sampled);
    std::vector<std::uint32_t> begins = {0};
    const std::size_t parts = rows / kRowsPerPart + 1;
    for (std::size_t i = 1; i < parts; ++i) {
        const std::uint32_t begin = sampled[i * sampled.size() / parts];
        if (begin > begins.back()) begins.push_back(begin);
    }
    return begins;
}

// Stable, by the `bits` lowest bits of the keys' high halves.
void radix_sort(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& scratch, int bits) {
    constexpr int kDigit = 11;
    scratch.resize(keys.size());
    for (int done = 0; done < bits; done += kDigit) {
        std::array<std::uint32_t, 1 << kDigit> next{};
        const auto digit = [&](std::uint64_t key) { return key >> (32 + done) & ((1 << kDigit) - 1); };
        for (const std::uint64_t key : keys) ++next[digit(key)];
        std::uint32_t sum = 0;
        for (std::uint32_t& n : next) sum += std::exchange(n, sum);
        for (const std::uint64_t key : keys) scratch[next[digit(key)]++] = key;
        keys.swap(scratch);
    }
}

// Sorts part of the slices, rows begins[s] .. ends[s]-1 of slice s, into `z` and `order`.
void sort_part(std::span<const Slice> slices, std::span<const std::size_t> begins, std::span<const std::size_t> ends,
               std::span<std::uint32_t> z, std::span<RowRef> order) {
    thread_local std::vector<std::uint64_t> keys, scratch;  // the Z prefix above, the place in `rows` below
    thread_local std::vector<RowRef> rows;
    thread_local std::vector<const DecodedPage*> pages;
    keys.clear(), rows.clear(), pages.clear();
    std::uint32_t different = 0;
    for (std::size_t s = 0; s < slices.size(); ++s) {
        for (std::size_t row = begins[s]; row < ends[s]; ++row) {
            const std::uint32_t its_z = slices[s].rows->z[row];
            keys.push_back(std::uint64_t{its_z} << 32 | rows.size());
            rows.push_back({static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(row)});
            different |= its_z ^ static_cast<std::uint32_t>(keys.front() >> 32);
        }
    }
    radix_sort(keys, scratch, std::bit_width(different));
    for (std::size_t i = 0; i < keys.size(); ++i) {
        z[i] = static_cast<std::uint32_t>(keys[i] >> 32);
        order[i] = rows[static_cast<std::uint32_t>(keys[i])];
    }
    const auto sample = [&](const RowRef& row) { return slices[row.page].rows->page.sample[row.row]; };
    for (std::size_t i = 0; i < order.size();) {  // rows at one place: by sample
        std::size_t end = i + 1;
        while (end < order.size() && z[end] == z[i]) ++end;
        if (end - i > 1) std::ranges::stable_sort(order.subspan(i, end - i), {}, sample);
        i = end;
    }
    for (RowRef& row : order) row.page = slices[row.page].page;
}

}  // namespace

void merge_slices(std::span<const Slice> slices, std::span<std::uint32_t> z, std::span<RowRef> order) {
    if (order.empty()) return;
    const std::vector<std::uint32_t> begins = part_begins(slices, order.size());
    const std::size_t parts = begins.size();
    std::vector<std::size_t> bounds((parts + 1) * slices.size());  // for each part, the first row of each slice
    tbb::parallel_for(std::size_t{0}, slices.size(), [&](std::size_t s) {
        const auto first = slices[s].rows->z.begin();
        auto from = first + static_cast<std::ptrdiff_t>(slices[s].begin);
        const auto end = first + static_cast<std::ptrdiff_t>(slices[s].end);
        for (std::size_t part = 0; part < parts; ++part) {
            from = std::lower_bound(from, end, begins[part]);
            bounds[part * slices.size() + s] = static_cast<std::size_t>(from - first);
        }
        bounds[parts * slices.size() + s] = slices[s].end;
    });
    const auto bounds_of = [&](std::size_t part) { return std::span(bounds).subspan(part * slices.size(), slices.size()); };
    std::vector<std::size_t> starts = {0};
    for (std::size_t part = 0; part < parts; ++part) {
        std::size_t count = 0;
        for (std::size_t s = 0; s < slices.size(); ++s) count += bounds_of(part + 1)[s] - bounds_of(part)[s];
        starts.push_back(starts.back() + count);
    }
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        const std::size_t start = starts[part], count = starts[part + 1] - start;
        sort_part(slices, bounds_of(part), bounds_of(part + 1), z.subspan(start, count), order.subspan(start, count));
    });
}

}  // namespace latent::merge
