#include "sampledb/codec/page_decoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "base/hash.h"
#include "sampledb/data/pixel_places.h"
#include "sampledb/data/unreadable.h"

namespace latent::sampledb {

// Decodes the columns of one page one after another. It begins with a page without any column, and each takes back the memory that
// it had before: none is left of another page.
class PageDecoder::Decoding {
 public:
    Decoding(PageDecoder& decoder, const Job& job, const PageInfo& info, const ColumnSet& wanted, bool check_all, Page& page)
        : decoder_(decoder),
          columns_(decoder.columns_),
          job_(job),
          info_(info),
          wanted_(wanted),
          check_all_(check_all),
          page_(page),
          before_(std::exchange(page, Page{})) {}

    Status decode() {
        page_.record_class = info_.record_class;
        page_.count = info_.record_count;
        page_.unit_share = false;
        if (Status s = find_positions(); !s) return s;
        const auto first = [&](auto column, const ColumnEntry& entry) {
            if constexpr (column.spec.coding == Coding::kCrossed) return Status{};
            return decode(column, entry);
        };
        const auto then = [&](auto column, const ColumnEntry& entry) {  // what needs another column
            if constexpr (column.spec.coding == Coding::kCrossed) return crossed(column, entry);
            return Status{};
        };
        if (Status s = for_each_entry(first); !s) return s;
        if (Status s = for_each_entry(then); !s) return s;
        return extra();
    }

 private:
    // f(column, entry) for the columns of the page that are in the table of all jobs, up to the first that fails.
    template <class F>
    Status for_each_entry(F&& f) const {
        Status status;
        const ColumnEntry* next = decoder_.table_.data();
        for_each_column([&](auto column) {
            if (!has_column(job_, info_.record_class, column.spec.presence)) return;
            const ColumnEntry& entry = *next++;
            if (status) status = f(column, entry);
        });
        return status;
    }

    const ColumnEntry& entry_of(Column number) const { return *std::ranges::find(decoder_.table_, number, &ColumnEntry::column); }

    template <class T>
    std::span<T> prepare(std::vector<T> Columns::*column, std::size_t size) {
        return prepare(page_.*column, before_.*column, size);
    }
    template <class T>
    static std::span<T> prepare(std::vector<T>& column, std::vector<T>& before, std::size_t size) {
        column.swap(before);
        return at_least(column, size + Page::kPadding).first(size);
    }

    // Compares a decoded column with its content hash: those that were derived always, the others if asked to.
    template <class T>
    Status check(const ColumnEntry& entry, std::span<T> values) const {
        if (!check_all_ && entry.transform != Transform::kSampler) return {};
        if (hash64(std::as_bytes(values)) == entry.hash) return {};
        return corrupt(fmt::format("column {} does not decode to its content hash", static_cast<int>(entry.column)));
    }

    // Whether positions were left out.
    Status find_positions() {
        const bool no_u = entry_of(Column::kU).transform == Transform::kSampler;
        const bool no_v = entry_of(Column::kV).transform == Transform::kSampler;
        if (no_u != no_v) return corrupt("only one of u and v is derived");
        if (no_u && job_.positions.sampler == PositionSampler::kNone)
            return corrupt("positions left out in a job without a sampler");
        derived_ = no_u;
        return {};
    }

    template <std::size_t i>
    Status decode(ColumnAt<i> column, const ColumnEntry& entry) {
        constexpr auto spec = column.spec;
        using Value = typename ColumnAt<i>::Value;
        const bool derives = derived_ && wanted_.positions;
        bool wanted = wanted_.*spec.wanted;
        if constexpr (spec.coding == Coding::kSample) return wanted || derives ? samples(entry) : Status{};
        if constexpr (spec.number == Column::kShare) {
            page_.unit_share = is_one(entry);
            wanted &= !page_.unit_share;
        }
        if (!wanted) return {};
        if (spec.coding == Coding::kPosition && derives) return spec.number == Column::kU ? derive_positions() : Status{};

        const std::span<Value> values = prepare(spec.values, spec.rows == Rows::kPairs ? info_.pair_count : page_.count);
        Status decoded;
        if constexpr (spec.coding == Coding::kLuminance) {
            decoded = columns_.luminance(entry, values, decoder_.bright_);
        } else if constexpr (spec.coding == Coding::kAlongRecords) {
            decoded = columns_.along_records(entry, values, rows(page_.pairs, page_.count), job_.batch);
        } else {
            decoded = columns_.plain(entry, std::as_writable_bytes(values), sizeof(Value));
        }
        if (!decoded) return decoded;
        if (Status s = check(entry, values); !s) return s;
        if constexpr (spec.number == Column::kPairs) return place_pairs();
        if constexpr (spec.number == Column::kIndex) return check_index();
        return {};
    }

    template <std::size_t i>
    Status crossed(ColumnAt<i> column, const ColumnEntry& entry) {
        if (!(wanted_.*column.spec.wanted)) return {};
        const std::span<float> values = prepare(column.spec.values, page_.count);
        if (Status s = columns_.crossed(entry, values, rows(page_.y, page_.count), decoder_.bright_); !s) return s;
        return check(entry, values);
    }

    // Sample numbers, or what positions follow from in their stead.
    Status samples(const ColumnEntry& entry) {
        const bool by_pixels = entry.transform == Transform::kPixels;
        if (by_pixels && job_.positions.sampler != PositionSampler::kPixels)
            return corrupt("samples by pixels that the job does not have");
        std::span<std::uint64_t> n;
        if (wanted_.samples) n = prepare(&Columns::sample, page_.count);
        numbers_ = by_pixels || !wanted_.samples ? at_least(decoder_.numbers_, page_.count) : n;
        if (Status s = by_pixels ? columns_.packed(entry, numbers_) : columns_.samples(entry, numbers_); !s) return s;
        if (by_pixels) places_.emplace(job_.positions, info_.node, entry.base);
        if (!wanted_.samples) return {};
        if (by_pixels) places_->samples(numbers_, n);
        return check(entry, n);
    }

    Status derive_positions() {
        const std::span<std::uint32_t> u = prepare(&Columns::u, page_.count), v = prepare(&Columns::v, page_.count);
        if (places_) {
            places_->positions(numbers_, u, v);
        } else {
            positions_of(numbers_, job_.positions, u, v);
        }
        if (Status s = check(entry_of(Column::kU), u); !s) return s;
        return check(entry_of(Column::kV), v);
    }

    static bool is_one(const ColumnEntry& entry) {
        return entry.transform == Transform::kPacked && entry.bits == 0 && entry.base == std::bit_cast<std::uint32_t>(1.0f);
    }

    // Where each record's pairs begin. The counts are used only once they add up.
    Status place_pairs() {
        prepare(page_.first_pair, before_.first_pair, page_.count);
        const std::span<std::uint32_t> first(page_.first_pair);
        std::uint64_t sum = 0;
        for (std::size_t i = 0; i < page_.count; ++i) {
            const std::uint16_t n = page_.pairs[i];
            if (n > job_.batch || (!job_.density.empty() && n > 1 && n != job_.batch))
                return corrupt("a record with a wrong number of pairs");
            first[i] = static_cast<std::uint32_t>(sum);
            sum += n;
        }
        std::fill(first.begin() + static_cast<std::ptrdiff_t>(page_.count), first.end(), static_cast<std::uint32_t>(sum));
        return sum == info_.pair_count ? Status{} : corrupt("the pairs of a page do not add up");
    }

    Status check_index() const {
        for (std::size_t i = 0; i < page_.count; ++i) {
            const bool kept_alone = page_.pairs[i] == 1 && job_.batch > 1;
            if (kept_alone ? page_.index[i] >= job_.batch : page_.index[i] != kNoIndex)
                return corrupt("a wavelength outside its batch");
        }
        return {};
    }

    Status extra() {
        page_.extra = extra_columns(job_);
        before_.extra.resize(job_.extra.size());
        for (std::size_t i = 0; i < job_.extra.size(); ++i) {
            if (!wanted_.extra[i]) continue;
            const ColumnEntry& entry = entry_of(extra_number(i));
            ExtraColumn& column = page_.extra[i];
            const std::size_t bytes = width(column.type);
            const std::size_t size = page_.count * bytes;
            const std::span<std::byte> values =
                prepare(column.values, before_.extra[i].values, size + Page::kPadding * bytes).first(size);
            if (Status s = decoder_.columns_.plain(entry, values, bytes); !s) return s;
            if (Status s = check(entry, values); !s) return s;
        }
        return {};
    }

    PageDecoder& decoder_;
    ColumnDecoder& columns_;
    const Job& job_;
    const PageInfo& info_;
    const ColumnSet& wanted_;
    const bool check_all_;
    Page& page_;
    Page before_;  // for its memory
    bool derived_ = false;
    std::span<std::uint64_t> numbers_;   // numbers of its samples
    std::optional<PixelPlaces> places_;  // that they stand for, if they are by pixels
};

Status PageDecoder::decode(const Job& job, const PageInfo& info, ByteSpan stored, const ColumnSet& columns, Page& page,
                           bool every_column) {
    const auto decode = [&]() -> Status {
        if (stored.size() != info.stored_size) return Error{ErrorCode::kTruncated, "the page ends early"};
        if (hash64(stored) != info.stored_hash) return corrupt("checksum mismatch");
        if (Status s = read_table(job, info, stored, table_); !s) return s;
        return Decoding(*this, job, info, columns, every_column, page).decode();
    };
    Status decoded = decode();
    if (!decoded) page = Page{};
    return decoded;
}

Result<std::vector<StoredColumn>> stored_columns(const Job& job, const PageInfo& info, ByteSpan stored) {
    std::vector<ColumnEntry> table;
    if (Status s = read_table(job, info, stored, table); !s) return s.error();
    std::vector<StoredColumn> columns;
    const auto add = [&](const std::string& name, std::uint64_t decoded) {
        const ColumnEntry& entry = table[columns.size()];
        columns.push_back({name, kColumnEntrySize + 4 * entry.planes.size() + entry.stored.size(), decoded});
    };
    for_each_column([&](auto column) {
        if (!has_column(job, info.record_class, column.spec.presence)) return;
        const std::uint64_t values = column.spec.rows == Rows::kPairs ? info.pair_count : info.record_count;
        add(column.spec.name, values * sizeof(typename decltype(column)::Value));
    });
    for (const ExtraColumnSpec& extra : job.extra) add(extra.name, std::uint64_t{info.record_count} * width(extra.type));
    return columns;
}

}  // namespace latent::sampledb
