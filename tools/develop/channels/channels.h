// tools/develop/channels/channels.h: what a record gives to each channel of the picture: X, Y, Z, or the bins of a spectrum.
// Equations: docs/developing.md, "From spectra to channels".
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "color/observer.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"
#include "tools/develop/channels/aov_columns.h"
#include "tools/develop/channels/batch_response.h"
#include "tools/develop/channels/layers.h"
#include "tools/develop/channels/light_mix.h"
#include "tools/develop/lens/lens_weights.h"

namespace latent::develop {

// Bins of equal width, in nm.
struct SpectralBins {
    double from_nm = color::kLambdaMin, to_nm = color::kLambdaMax;
    int count = 0;  // 0: no bins, but X, Y, Z
    double width_nm() const { return (to_nm - from_nm) / count; }
};
// "94": bins over 360..830 nm; "400:700:10": bins 10 nm wide from 400 to 700 nm. Errors: kUsage.
Result<SpectralBins> parse_spectral_bins(std::string_view text);

class Channels {
 public:
    // X, Y, Z under `observer` (XYZ jobs: as stored, and `observer` must be null).
    static Result<Channels> xyz(const sampledb::Job& job, const color::Observer* observer);
    // Mean spectral radiance of each bin in W m^-2 sr^-1 nm^-1. Errors: kUsage for XYZ jobs.
    static Result<Channels> spectral_bins(const sampledb::Job& job, const SpectralBins& bins);

    // Errors: of AovColumns.
    Status add_layers(const sampledb::Job& job, const Layers& layers);
    // Multiplies the records of each group of lights. Errors: kUsage for curves in XYZ jobs.
    Status mix_lights(const sampledb::Job& job, const std::vector<GroupFactor>& factors);
    // Names of the groups that are layers, in the order of their numbers; each is that group's part of the mix.
    void show_lights(const sampledb::Job& job, std::vector<std::string> names);

    // Weighs records by where and when they met the lens; those of no weight become rows of zeros. Errors: of LensWeights::make.
    Status weigh(const sampledb::Job& job, const LensChoice& choice);
    const std::optional<LensWeights>& lens() const { return lens_; }

    // Divides each channel by what its responses make of white [R06 3.3.6] (docs/developing.md, "The ratio estimator"). Of X, Y, Z.
    // Errors: kUsage: XYZ jobs; as of BatchWhite::make.
    Status use_ratio();

    const RowLayout& layout() const { return layout_; }
    int count() const { return layout_.channels; }
    int stride() const { return layout_.stride(); }
    sampledb::ColumnSet columns() const;

    // For rows begin .. end-1: a row of layout() each: channels, share (light records: 0), and what layers need. Values that are
    // not finite become black, so do their shares where these are not finite; returns how many rows had such values. Layers of
    // samples need the rows of a sample at one position to be neighbours, as they are in a page: the first becomes their sum, the
    // others 0.
    std::uint64_t values(const sampledb::Page& page, std::size_t begin, std::size_t end, float* out) const;

 private:
    // How the light of a group is seen.
    struct GroupLight {
        float factor = 1;
        std::optional<color::Spectrum> curve{};             // bins
        std::shared_ptr<const color::Observer> observer{};  // behind the curve, if there is one; not of bins or XYZ
        BatchResponse response{};
    };
    void see_through(std::shared_ptr<const color::Observer> observer, GroupLight& light) const;
    std::size_t group_of(const sampledb::Page& page, std::size_t row) const;
    void spectral_row(const GroupLight& light, const sampledb::Page& page, std::size_t row, float* out) const;
    void add_pair(const GroupLight& light, float lambda_nm, float power, float* out) const;
    std::uint64_t light_rows(const sampledb::Page& page, std::size_t begin, std::size_t end, float* out) const;
    void complete_rows(const sampledb::Page& page, std::size_t begin, std::size_t end, float* out) const;
    void fill_halves(const sampledb::Page& page, std::size_t begin, std::size_t end, float* out) const;

    sampledb::RecordKind kind_ = sampledb::RecordKind::kXyz;
    RowLayout layout_;
    int bins_ = 0, batch_ = 0;
    float bins_from_ = 0, bins_to_ = 0, bins_per_nm_ = 0;
    float bin_scale_ = 1;  // from a power to what it adds to the mean of its bin
    sampledb::WavelengthDensity density_;
    std::vector<GroupLight> lights_{1};  // by number of their group; the last one is that of all further groups
    std::optional<BatchWhite> white_;    // for the ratio estimator
    AovColumns aovs_;
    std::optional<LensWeights> lens_;
    std::optional<std::size_t> group_column_;  // among the extra ones; none: all light is alike
};

}  // namespace latent::develop
