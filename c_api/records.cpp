#include "c_api/records.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "c_api/abi.h"

namespace latent::c {

using namespace sampledb;

namespace {

template <class T>
Status copy(const T* from, std::size_t count, const char* name, std::vector<T>& to) {
    if (count > 0 && from == nullptr) return usage_error(std::string("records: the column ") + name + " is null");
    to.assign(from, from + count);
    return {};
}

// The class of every record, and its share. Errors: kOutOfRange (a share that is not finite).
Status copy_classes(const latent_records& from, Records& to) {
    if (from.record_class == nullptr) {
        to.record_class.assign(from.count, RecordClass::kCamera);
    } else {
        to.record_class.resize(from.count);
        for (std::size_t i = 0; i < from.count; ++i) to.record_class[i] = static_cast<RecordClass>(from.record_class[i]);
    }
    if (from.share != nullptr) {
        to.share.assign(from.share, from.share + from.count);
        const auto bad = std::ranges::find_if_not(to.share, [](float share) { return std::isfinite(share); });
        if (bad != to.share.end()) {
            const std::uint64_t sample = to.sample[static_cast<std::size_t>(bad - to.share.begin())];
            return Error{ErrorCode::kOutOfRange, "sample " + std::to_string(sample) + ": a share that is not finite"};
        }
    } else {
        to.share.resize(from.count);
        for (std::size_t i = 0; i < from.count; ++i) to.share[i] = to.record_class[i] == RecordClass::kCamera ? 1.0f : 0.0f;
    }
    return {};
}

// Errors: kOutOfRange (numbers that do not fit together; a wavelength that is not positive).
Status copy_pairs(const Job& job, const latent_records& from, Records& to) {
    if (Status s = copy(from.pairs, from.count, "pairs", to.pairs); !s) return s;
    if (std::accumulate(to.pairs.begin(), to.pairs.end(), std::size_t{0}) != from.pair_count) {
        return Error{ErrorCode::kOutOfRange, "records: pair_count is not the sum of pairs"};
    }
    if (Status s = copy(from.power, from.pair_count, "power", to.power); !s) return s;
    if (job.density.empty()) {
        if (Status s = copy(from.lambda_nm, from.pair_count, "lambda_nm", to.lambda_nm); !s) return s;
        const bool all = std::ranges::all_of(to.lambda_nm, [](float lambda) { return lambda > 0 && std::isfinite(lambda); });
        return all ? Status{} : Error{ErrorCode::kOutOfRange, "records: a wavelength that is not a positive number of nm"};
    }
    if (Status s = copy(from.xi, from.count, "xi", to.xi); !s) return s;
    if (from.index != nullptr) return copy(from.index, from.count, "index", to.index);
    to.index.assign(from.count, kNoIndex);
    return {};
}

}  // namespace

Result<Records> records_from(const Job& job, const latent_records* records) {
    const Result<latent_records> given = taken(records, sizeof(latent_records), "records");
    if (!given) return given.error();
    const latent_records& from = *given;
    Records to;
    if (Status s = copy(from.sample, from.count, "sample", to.sample); !s) return s.error();
    if (Status s = copy(from.u, from.count, "u", to.u); !s) return s.error();
    if (Status s = copy(from.v, from.count, "v", to.v); !s) return s.error();
    if (Status s = copy_classes(from, to); !s) return s.error();
    if (job.kind == RecordKind::kXyz) {
        if (Status s = copy(from.x, from.count, "x", to.x); !s) return s.error();
        if (Status s = copy(from.y, from.count, "y", to.y); !s) return s.error();
        if (Status s = copy(from.z, from.count, "z", to.z); !s) return s.error();
    } else if (Status s = copy_pairs(job, from, to); !s) {
        return s.error();
    }
    for (std::size_t i = 0; i < job.extra.size(); ++i) {
        const ExtraColumnSpec& column = job.extra[i];
        to.extra.push_back({column.name, column.type, {}});
        if (from.count > 0 && from.extra == nullptr) return usage_error("records: extra is null");
        const auto* bytes = from.count > 0 ? static_cast<const std::byte*>(from.extra[i]) : nullptr;
        if (Status s = copy(bytes, from.count * width(column.type), column.name.c_str(), to.extra.back().values); !s)
            return s.error();
    }
    return to;
}

void RecordView::derive_wavelengths(const Job& job, const Page& page, std::size_t pairs) {
    lambda_nm_.resize(pairs);
    for (std::size_t i = 0; i < page.count; ++i)
        wavelengths_of(job.density, job.batch, page, i, std::span(lambda_nm_).subspan(page.first_pair[i], page.pairs[i]));
}

latent_records RecordView::of(const Job& job, const Page& page, std::uint32_t columns) {
    latent_records view{};
    view.size = sizeof view;
    view.count = page.count;
    if (page.count == 0) return view;
    classes_.assign(page.count, static_cast<std::uint8_t>(page.record_class));
    view.record_class = classes_.data();
    if ((columns & LATENT_SAMPLES) != 0) view.sample = page.sample.data();
    if ((columns & LATENT_POSITIONS) != 0) view.u = page.u.data(), view.v = page.v.data();
    if ((columns & LATENT_SHARES) != 0) {
        const bool camera = page.record_class == RecordClass::kCamera;
        if (!camera || page.unit_share) shares_.assign(page.count, camera ? 1.0f : 0.0f);
        view.share = camera && !page.unit_share ? page.share.data() : shares_.data();
    }
    const bool wavelengths = (columns & LATENT_WAVELENGTHS) != 0;
    if ((columns & LATENT_VALUES) != 0 || wavelengths) {
        if (job.kind == RecordKind::kXyz) {
            view.x = page.x.data(), view.y = page.y.data(), view.z = page.z.data();
        } else {
            view.pairs = page.pairs.data(), view.first_pair = page.first_pair.data(), view.power = page.power.data();
            view.pair_count = page.first_pair[page.count];
            if (!job.density.empty()) view.xi = page.xi.data(), view.index = page.index.data();
            if (wavelengths && !job.density.empty()) derive_wavelengths(job, page, view.pair_count);
            if (wavelengths) view.lambda_nm = job.density.empty() ? page.lambda_nm.data() : lambda_nm_.data();
        }
    }
    if ((columns & LATENT_EXTRA) != 0 && !page.extra.empty()) {
        extra_.clear();
        for (const ExtraColumn& column : page.extra) extra_.push_back(column.values.data());
        view.extra = extra_.data();
    }
    return view;
}

}  // namespace latent::c
