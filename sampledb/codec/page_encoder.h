// sampledb/codec/page_encoder.h: the columns of one page -> its stored bytes. Format: docs/format.md, "Page".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "sampledb/codec/packed_delta2.h"
#include "sampledb/codec/page_layout.h"
#include "sampledb/codec/plane_codec.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"

namespace latent::sampledb {

// Keeps its memory from page to page; serves one thread at a time, and any job.
class PageEncoder {
 public:
    // Appends the stored bytes of `page` to `out` and says what the index needs to know (offset excepted). Its records lie in one
    // node and are sorted; positions are left out where the job's sampler yields every one of them.
    PageInfo encode(const Job& job, const Page& page, Bytes& out);

 private:
    bool begin_column(Column number, ByteSpan values, std::size_t value_width);
    void store_planes(ByteSpan values, std::size_t value_width);
    void store_packed(std::span<const std::uint64_t> values, unsigned bits);
    void store_bright(std::span<std::uint32_t> words);

    void encode_plain(Column number, ByteSpan values, std::size_t value_width);
    void encode_samples(const Job& job, std::span<const std::uint64_t> n);
    bool encode_pixels(const Job& job, std::span<const std::uint64_t> n, std::uint64_t low, std::uint64_t high);
    bool encode_lattice(const Job& job, std::span<const std::uint64_t> n, std::uint64_t low, std::uint64_t high);
    void encode_position(Column number, std::span<const std::uint32_t> positions);
    void encode_luminance(std::span<const float> y);
    void encode_crossed(const Job& job, Column number, std::span<const float> values, std::span<const float> y);
    void encode_along_records(const Job& job, Column number, std::span<const float> values, std::span<const std::uint16_t> pairs);
    bool encode_packed(const Job& job, std::span<const float> values, std::span<const std::uint16_t> pairs, unsigned step);
    std::size_t planes_size(std::span<const float> values, std::span<const std::uint16_t> pairs, unsigned step);
    template <std::size_t i>
    void encode_column(const Job& job, const Page& page, ColumnAt<i> column);

    void find_positions(const Job& job, const Page& page);
    void find_bright_rows(std::span<const float> y);

    // The page at hand.
    std::vector<ColumnEntry> table_;
    Bytes payload_;
    FilmNode node_;
    bool sampled_ = false;  // u_ and v_ are where the job's sampler puts its samples
    bool derived_ = false;  // all of its records lie there
    bool sparse_ = false;   // only bright rows are worth storing
    std::size_t pair_count_ = 0;
    PlaneChoice choice_ = kSmallPlanes;
    std::size_t bright_count_ = 0;      // as bright_ says
    Bytes bright_;                      // which rows of y are not zero
    std::vector<std::uint32_t> u_, v_;  // longer

    PlaneEncoder planes_;
    Delta2Packer delta2_;
    Bytes scratch_;
    std::vector<std::uint32_t> words_;
    std::vector<std::uint64_t> numbers_;
};

}  // namespace latent::sampledb
