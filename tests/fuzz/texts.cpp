// What people write on command lines, and tables of curves.
#include <cmath>

#include "base/json.h"
#include "base/parse.h"
#include "color/catalogue.h"
#include "color/observer.h"
#include "color/rgb_space.h"
#include "render/program/arguments.h"
#include "sampledb/data/parse.h"
#include "tests/fuzz/target.h"
#include "tools/convert/camera_exposure.h"
#include "tools/convert/dodge.h"
#include "tools/convert/glare.h"
#include "tools/convert/vignette.h"
#include "tools/develop/channels/channels.h"
#include "tools/develop/channels/layers.h"
#include "tools/develop/channels/light_setting.h"
#include "tools/develop/film/filter.h"
#include "tools/develop/lens/aperture.h"
#include "tools/develop/lens/focus.h"
#include "tools/develop/lens/shutter.h"

namespace latent::fuzz {

namespace {

bool run_csv(ByteSpan bytes) {
    const Result<color::Observer> observer = color::Observer::from_csv(text_of(bytes), "a.csv");
    if (!observer) return false;
    for (const std::array<double, 3>& row : observer->responses()) {
        for (const double response : row) require(std::isfinite(response), "responses are finite");
    }
    for (double nm = 0; nm < 1200; nm += 37.3) {
        for (const double response : observer->at(nm)) require(std::isfinite(response), "responses are finite everywhere");
    }
    return true;
}

bool run_filter(std::string_view text) {
    const Result<develop::Filter> filter = develop::Filter::parse(text);
    if (!filter) return false;
    const Result<develop::Filter> again = develop::Filter::parse(filter->name());
    require(again && again->name() == filter->name(), "the name of a filter is that filter");
    for (double d = 0; d <= 4; d += 0.37) require(std::isfinite(filter->weight(d, d / 2)), "weights are finite");
    return true;
}

bool run_light(std::string_view text) {
    const Result<develop::LightSetting> light = develop::parse_light(text);
    if (light) require(std::isfinite(light->factor), "the factor of a light is finite");
    return light.has_value();
}

bool run_numbers(std::string_view text) {
    const Result<double> number = parse_number(text), seconds = parse_duration(text);
    if (number) require(std::isfinite(*number), "numbers are finite");
    if (seconds) require(*seconds > 0, "durations are above 0");
    return parse_count(text) || parse_size(text) || parse_pair(text, ':') || parse_numbers(text) || parse_crop(text) || seconds;
}

bool run_develop_options(std::string_view text) {
    const Result<develop::SpectralBins> bins = develop::parse_spectral_bins(text);
    if (bins) require(bins->count > 0 && bins->to_nm > bins->from_nm, "bins have a width");
    return bins || develop::parse_layers(text) || color::lens_filter(text) || color::Observer::by_name(text) ||
           color::RgbSpace::parse(text);
}

bool run_render_options(std::string_view text) {
    const Result<render::Shard> shard = render::parse_shard(text);
    if (shard) require(shard->index < shard->count, "a shard is one of all");
    const Result<sampledb::SampleRange> samples = render::parse_samples(text);
    if (samples) require(!samples->empty(), "a range has samples");
    return shard || samples || render::parse_resolution(text) || render::parse_depth(text) || sampledb::parse_sample_range(text) ||
           sampledb::parse_job_id(text);
}

bool run_lens_options(std::string_view text) {
    const Result<develop::Aperture> aperture = develop::parse_aperture(text);
    if (aperture) require(aperture->radius > 0 && aperture->radius <= 1, "an aperture lies in the lens");
    const Result<develop::Shutter> shutter = develop::parse_shutter(text);
    if (shutter) require(shutter->rolling >= 0 && shutter->rolling < 1, "each row of a rolling shutter is exposed");
    const Result<convert::Glare> glare = convert::parse_glare(text);
    if (glare) require(glare->f_number > 0, "f-numbers are above 0");
    return aperture || shutter || glare || convert::parse_vignette(text) || convert::parse_camera_exposure(text) ||
           convert::parse_dodge(text) || develop::parse_focus(text);
}

bool run_json(std::string_view text) {
    if (!check_json_object(text, 32)) return false;
    (void)member_of(text, "a");
    for_each_element(member_of(text, "parts"), [](std::string_view) {});
    return true;
}

// The first byte chooses who reads the others.
bool run_expressions(ByteSpan bytes) {
    if (bytes.empty()) return false;
    constexpr std::array kReaders = {run_filter,         run_light, run_numbers,     run_develop_options,
                                     run_render_options, run_json,  run_lens_options};
    return kReaders[(std::to_integer<std::size_t>(bytes[0]) - '0') % kReaders.size()](text_of(bytes.subspan(1)));
}

}  // namespace

Target csv() { return {"csv", run_csv, nullptr, true, 8000, nullptr}; }
Target expressions() { return {"expressions", run_expressions, nullptr, true, 6000, nullptr}; }

}  // namespace latent::fuzz
