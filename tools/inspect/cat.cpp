#include "tools/inspect/cat.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <type_traits>
#include <vector>

#include "base/bytes.h"
#include "base/json.h"
#include "base/printable.h"
#include "sampledb/codec/page_decoder.h"
#include "tools/inspect/damage.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

constexpr std::size_t kFlushBytes = std::size_t{1} << 16;

// A float in as few digits as bring it back exactly; JSON has no NaN or infinity: they become null.
template <class T>
void put_value(std::string& line, T value, bool json) {
    if constexpr (std::is_floating_point_v<T>) {
        if (json && !std::isfinite(value)) {
            line += "null";
            return;
        }
    }
    fmt::format_to(std::back_inserter(line), "{}", value);
}

void put_extra(std::string& line, const ExtraColumn& column, std::size_t row, bool json) {
    const std::byte* at = column.values.data() + row * width(column.type);
    switch (column.type) {
        case ColumnType::kU8:
            return put_value(line, load_le<std::uint8_t>(at), json);
        case ColumnType::kU16:
            return put_value(line, load_le<std::uint16_t>(at), json);
        case ColumnType::kU32:
            return put_value(line, load_le<std::uint32_t>(at), json);
        case ColumnType::kU64:
            return put_value(line, load_le<std::uint64_t>(at), json);
        case ColumnType::kF32:
            return put_value(line, load_le<float>(at), json);
        case ColumnType::kF64:
            return put_value(line, load_le<double>(at), json);
    }
}

// A name as a field of CSV [RFC4180], without what would steer a terminal.
std::string csv_field(const std::string& name) {
    const std::string shown = printable_line(name);
    if (shown.find_first_of(",\"") == std::string::npos) return shown;
    std::string field = "\"";
    for (const char c : shown) field += c == '"' ? "\"\"" : std::string(1, c);
    return field + '"';
}

// Columns that say how the wavelengths of a record are stored: its pairs are printed in their place.
constexpr bool is_spectral(Presence presence) {
    return presence == Presence::kSpectral || presence == Presence::kDensity || presence == Presence::kNoDensity;
}

// Lines of text from decoded pages. Columns: as in the table, the class behind the sample; in spectral jobs wavelengths and their
// values, joined by spaces in CSV; then the job's extra columns; one that is named like another is "extra.NAME".
class LineWriter {
 public:
    LineWriter(const Job& job, TextFormat format) : job_(job), json_(format == TextFormat::kJsonLines), lambda_(kMaxPairs) {
        for_each_column([&](auto column) {
            constexpr auto spec = column.spec;
            if (!has_column(job, RecordClass::kCamera, spec.presence)) return;
            if constexpr (spec.number == Column::kPairs) {
                names_.insert(names_.end(), {"lambda_nm", "power"});
            } else if constexpr (!is_spectral(spec.presence)) {
                names_.push_back(spec.name);
            }
            if constexpr (spec.number == Column::kSample) names_.push_back("class");
        });
        for (const ExtraColumnSpec& column : job.extra) {
            std::string name = column.name;
            while (std::ranges::find(names_, name) != names_.end()) name.insert(0, "extra.");
            names_.push_back(std::move(name));
        }
        for (const std::string& name : names_) {
            const char* const before = before_.empty() ? (json_ ? "{" : "") : ",";
            before_.push_back(json_ ? fmt::format("{}{}:", before, json_text(nlohmann::json(name), -1)) : before);
        }
        if (json_) return;
        for (const std::string& name : names_) heading_ += (heading_.empty() ? "" : ",") + csv_field(name);
        heading_ += '\n';
    }

    const std::string& heading() const { return heading_; }  // empty in JSON

    void put(std::string& line, const Page& page, std::size_t row) {
        auto before = before_.begin();
        const auto next = [&]() -> std::string& { return line += *before++; };
        for_each_column([&](auto column) {
            constexpr auto spec = column.spec;
            if (!has_column(job_, RecordClass::kCamera, spec.presence)) return;
            if constexpr (spec.number == Column::kPairs) {
                put_list(next(), wavelengths(page, row));
                put_list(next(), powers(page, row));
            } else if constexpr (spec.number == Column::kShare) {
                put_value(next(), share_of(page, row), json_);
            } else if constexpr (spec.coding == Coding::kPosition) {
                put_value(next(), (page.*spec.values)[row] * 0x1p-32, json_);
            } else if constexpr (!is_spectral(spec.presence)) {
                put_value(next(), (page.*spec.values)[row], json_);
            }
            if constexpr (spec.number == Column::kSample) put_class(next(), page.record_class);
        });
        for (const ExtraColumn& column : page.extra) put_extra(next(), column, row, json_);
        line += json_ ? "}\n" : "\n";
    }

 private:
    static float share_of(const Page& page, std::size_t row) {
        return page.record_class == RecordClass::kLight ? 0.0f : page.unit_share ? 1.0f : page.share[row];
    }
    void put_class(std::string& line, RecordClass record_class) const {
        const char* const name = record_class == RecordClass::kCamera ? "camera" : "light";
        line += json_ ? fmt::format("\"{}\"", name) : name;
    }
    void put_list(std::string& line, std::span<const float> values) const {
        if (json_) line += '[';
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (i > 0) line += json_ ? ',' : ' ';
            put_value(line, values[i], json_);
        }
        if (json_) line += ']';
    }
    static std::span<const float> powers(const Page& page, std::size_t row) {
        return {page.power.data() + page.first_pair[row], page.pairs[row]};
    }
    std::span<const float> wavelengths(const Page& page, std::size_t row) {
        const std::uint16_t n = page.pairs[row];
        if (job_.density.empty()) return {page.lambda_nm.data() + page.first_pair[row], n};
        if (n == job_.batch) {
            job_.density.batch(page.xi[row], std::span(lambda_).first(n));
        } else if (n == 1) {
            lambda_[0] = job_.density.wavelength(page.xi[row], page.index[row], job_.batch);
        }
        return {lambda_.data(), n};
    }

    const Job& job_;
    const bool json_;
    std::vector<std::string> names_;
    std::vector<std::string> before_;  // what stands before the value of each
    std::string heading_;
    std::vector<float> lambda_;
};

// Whether a node has anything in the region.
bool touches(const FilmNode& node, const std::array<double, 4>& region) {
    const double side = std::ldexp(1.0, -node.level);
    return node.x * side < region[2] && (node.x + 1) * side > region[0] && node.y * side < region[3] &&
           (node.y + 1) * side > region[1];
}

}  // namespace

Result<GatherReport> cat(const CatOptions& options, std::FILE* out) {
    GatherOptions gather;
    gather.inputs = options.inputs;
    gather.samples = options.samples;
    gather.job = options.job;
    gather.memory = options.memory;
    const Result<std::unique_ptr<Gathering>> opened = Gathering::open(gather);
    if (!opened) return opened.error();
    const Gathering& gathering = **opened;
    LineWriter lines(gathering.job(), options.format);
    std::string text = lines.heading();
    const auto flush = [&]() -> Status {
        const bool written = std::fwrite(text.data(), 1, text.size(), out) == text.size() && std::fflush(out) == 0;
        text.clear();
        if (!written) return error_from_errno(errno, "standard output", "cannot write");
        return {};
    };
    const std::array<double, 4> region = options.region.value_or(std::array<double, 4>{0, 0, 1, 1});
    PageDecoder decoder;
    Page page;
    GatherReport report = gathering.report();
    // Damage costs the page or the run that it is in.
    const auto left_out = [&](std::size_t run, const Error& error) {
        if (!is_unreadable(error)) return false;
        const std::string name = gathering.files()[gathering.runs()[run].file].string();
        leave_out(report.left_out, {name, error.message.substr(name.size() + 2)});
        return true;
    };
    std::uint64_t left = options.limit;
    for (std::size_t run = 0; run < gathering.runs().size() && left > 0; ++run) {
        const auto pages = gathering.pages(run);
        if (!pages) {
            if (left_out(run, pages.error())) continue;
            return pages.error();
        }
        for (const PageInfo& info : **pages) {
            if (left == 0) break;
            if (!touches(info.node, region)) continue;
            if (Status s = gathering.read_page(run, info, ColumnSet{}, decoder, page); !s) {
                if (left_out(run, s.error())) continue;
                return s.error();
            }
            for (std::size_t row = 0; row < page.count && left > 0; ++row) {
                const double u = page.u[row] * 0x1p-32, v = page.v[row] * 0x1p-32;
                if (u < region[0] || v < region[1] || u >= region[2] || v >= region[3]) continue;
                lines.put(text, page, row);
                --left;
                if (text.size() < kFlushBytes) continue;
                if (Status s = flush(); !s) return s.error();
            }
        }
    }
    if (Status s = flush(); !s) return s.error();
    return report;
}

}  // namespace latent::inspect
