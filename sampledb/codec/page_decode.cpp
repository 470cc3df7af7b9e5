#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "base/hash.h"
#include "sampledb/codec/column_decode.h"
#include "sampledb/codec/page_codec.h"
#include "sampledb/codec/page_layout.h"
#include "sampledb/data/unreadable.h"

namespace latent::sampledb {

namespace {

thread_local std::vector<ColumnEntry> table;  // of the page at hand; kept for its memory

// Decodes the columns of a page one after another, in the order of the table. It begins with a page without any column, and each
// takes back the memory that it had before: none is left of another page.
class PageDecoder {
 public:
    PageDecoder(const Job& job, const PageInfo& info, const ColumnSet& wanted, bool check_all, Page& page)
        : job_(job),
          info_(info),
          wanted_(wanted),
          check_all_(check_all),
          page_(page),
          before_(std::exchange(page, Page{})),
          next_(table.data()) {}

    Status decode() {
        page_.record_class = info_.record_class;
        page_.count = info_.record_count;
        if (Status s = samples_and_positions(); !s) return s;
        if (Status s = share(); !s) return s;
        if (Status s = job_.kind == RecordKind::kXyz ? xyz() : spectrum(); !s) return s;
        return extra();
    }

 private:
    template <class T>
    std::span<T> prepare(std::vector<T> Page::*column, std::size_t size) {
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

    template <class T>
    Status plain(std::vector<T> Page::*column, bool wanted, const ColumnEntry& entry) {
        if (!wanted) return {};
        const std::span<T> values = prepare(column, page_.count);
        if (Status s = decode_plain(entry, std::as_writable_bytes(values), sizeof(T)); !s) return s;
        return check(entry, values);
    }

    Status samples_and_positions() {
        const ColumnEntry& sample = *next_++;
        const ColumnEntry& u = *next_++;
        const ColumnEntry& v = *next_++;
        const bool derived = u.transform == Transform::kSampler;
        if (derived != (v.transform == Transform::kSampler)) return corrupt("half a position");
        if (derived && job_.positions.sampler == PositionSampler::kNone)
            return corrupt("positions left out in a job without a sampler");
        const bool derive = derived && wanted_.positions;
        if (wanted_.samples || derive) {
            const std::span<std::uint64_t> n = prepare(&Page::sample, page_.count);
            if (Status s = decode_samples(sample, n); !s) return s;
            if (Status s = check(sample, n); !s) return s;
        }
        if (!derive) {
            if (Status s = plain(&Page::u, wanted_.positions, u); !s) return s;
            return plain(&Page::v, wanted_.positions, v);
        }
        const std::span<std::uint32_t> pu = prepare(&Page::u, page_.count), pv = prepare(&Page::v, page_.count);
        halton23(rows(page_.sample, page_.count), job_.positions, pu, pv);
        if (Status s = check(u, pu); !s) return s;
        return check(v, pv);
    }

    Status share() {
        page_.unit_share = false;
        if (info_.record_class == RecordClass::kLight) return {};
        const ColumnEntry& entry = *next_++;
        constexpr std::uint32_t kOne = std::bit_cast<std::uint32_t>(1.0f);
        page_.unit_share = entry.transform == Transform::kPacked && entry.bits == 0 && entry.base == kOne;
        return plain(&Page::share, wanted_.share && !page_.unit_share, entry);
    }

    Status xyz() {
        const ColumnEntry& x = *next_++;
        const ColumnEntry& y = *next_++;
        const ColumnEntry& z = *next_++;
        if (!wanted_.values) return {};
        thread_local BrightRows bright;
        const std::span<float> luminances = prepare(&Page::y, page_.count);
        if (Status s = decode_y(y, luminances, bright); !s) return s;
        if (Status s = check(y, luminances); !s) return s;
        const auto crossed = [&](std::vector<float> Page::*column, const ColumnEntry& entry) -> Status {
            const std::span<float> values = prepare(column, page_.count);
            if (Status s = decode_crossed(entry, values, luminances, bright); !s) return s;
            return check(entry, values);
        };
        if (Status s = crossed(&Page::x, x); !s) return s;
        return crossed(&Page::z, z);
    }

    Status spectrum() {
        const bool density = !job_.density.empty();
        if (!wanted_.values) {
            next_ += density ? 4 : 3;
            return {};
        }
        if (Status s = plain(&Page::pairs, true, *next_++); !s) return s;
        if (Status s = place_pairs(); !s) return s;
        if (density) {
            if (Status s = plain(&Page::xi, true, *next_++); !s) return s;
            if (Status s = plain(&Page::index, true, *next_++); !s) return s;
            if (Status s = check_index(); !s) return s;
        }
        const auto along_records = [&](std::vector<float> Page::*column, const ColumnEntry& entry) -> Status {
            const std::span<float> values = prepare(column, info_.pair_count);
            if (Status s = decode_delta2(entry, values, rows(page_.pairs, page_.count)); !s) return s;
            return check(entry, values);
        };
        if (Status s = along_records(&Page::power, *next_++); !s) return s;
        return density ? Status{} : along_records(&Page::lambda_nm, *next_++);
    }

    // Where each record's pairs begin. The counts are believed only once they add up.
    Status place_pairs() {
        prepare(&Page::first_pair, page_.count);
        const std::span<std::uint32_t> first(page_.first_pair);
        std::uint64_t sum = 0;
        for (std::size_t i = 0; i < page_.count; ++i) {
            const std::uint16_t n = page_.pairs[i];
            if (n > job_.batch || (!job_.density.empty() && n > 1 && n != job_.batch))
                return corrupt("a record of a wrong number of pairs");
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
        page_.extra.resize(job_.extra.size());
        before_.extra.resize(job_.extra.size());
        for (std::size_t i = 0; i < job_.extra.size(); ++i) {
            const ColumnEntry& entry = *next_++;
            ExtraColumn& column = page_.extra[i];
            column.name = job_.extra[i].name;
            column.type = job_.extra[i].type;
            if (!wanted_.extra) continue;
            const std::size_t bytes = width(column.type);
            const std::size_t size = page_.count * bytes;
            const std::span<std::byte> values =
                prepare(column.values, before_.extra[i].values, size + Page::kPadding * bytes).first(size);
            if (Status s = decode_plain(entry, values, bytes); !s) return s;
            if (Status s = check(entry, values); !s) return s;
        }
        return {};
    }

    const Job& job_;
    const PageInfo& info_;
    const ColumnSet& wanted_;
    const bool check_all_;
    Page& page_;
    Page before_;  // for its memory
    const ColumnEntry* next_;
};

}  // namespace

Status decode_page(const Job& job, const PageInfo& info, ByteSpan stored, const ColumnSet& columns, Page& page, bool every_column) {
    const auto decode = [&]() -> Status {
        if (stored.size() != info.stored_size) return Error{ErrorCode::kTruncated, "the page ends early"};
        if (hash64(stored) != info.stored_hash) return corrupt("checksum mismatch");
        if (Status s = read_table(job, info, stored, table); !s) return s;
        return PageDecoder(job, info, columns, every_column, page).decode();
    };
    Status decoded = decode();
    if (!decoded) page = Page{};
    return decoded;
}

Result<std::vector<StoredColumn>> stored_columns(const Job& job, const PageInfo& info, ByteSpan stored) {
    if (Status s = read_table(job, info, stored, table); !s) return s.error();
    const std::uint64_t values = info.pair_count, rows_of_page = info.record_count;
    static constexpr struct {
        Column column;
        const char* name;
        unsigned width;
    } kNames[] = {{Column::kSample, "sample", 8}, {Column::kU, "u", 4},         {Column::kV, "v", 4},
                  {Column::kShare, "share", 4},   {Column::kX, "x", 4},         {Column::kY, "y", 4},
                  {Column::kZ, "z", 4},           {Column::kPairs, "pairs", 2}, {Column::kXi, "xi", 4},
                  {Column::kIndex, "index", 2},   {Column::kPower, "power", 4}, {Column::kLambda, "lambda", 4}};
    std::vector<StoredColumn> columns;
    for (const ColumnEntry& entry : table) {
        const std::uint64_t bytes = kColumnEntrySize + 4 * entry.planes.size() + entry.stored.size();
        if (entry.column >= Column::kFirstExtra) {
            const ExtraColumnSpec& extra =
                job.extra[static_cast<std::size_t>(entry.column) - static_cast<std::size_t>(Column::kFirstExtra)];
            columns.push_back({extra.name, bytes, rows_of_page * width(extra.type)});
            continue;
        }
        const auto* const name = std::ranges::find(kNames, entry.column, [](const auto& known) { return known.column; });
        const bool of_pairs = entry.column == Column::kPower || entry.column == Column::kLambda;
        columns.push_back({name->name, bytes, (of_pairs ? values : rows_of_page) * name->width});
    }
    return columns;
}

}  // namespace latent::sampledb
