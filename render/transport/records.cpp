#include "render/transport/records.h"

#include <cmath>

namespace latent::render {
namespace {

// True if every value is a number that light can have; else counts the cause.
bool is_valid(const SampledSpectrum& power, std::uint32_t k, RadianceFaults& faults) {
    bool nan = false, infinite = false, negative = false;
    for (std::uint32_t i = 0; i < k; ++i) {
        nan |= std::isnan(power[i]);
        infinite |= std::isinf(power[i]);
        negative |= power[i] < 0;
    }
    if (!nan && !infinite && !negative) return true;
    ++(nan ? faults.nan : infinite ? faults.infinite : faults.negative);
    return false;
}

}  // namespace

RecordMaker::RecordMaker(sampledb::RecordKind kind) : kind_(kind) {
    for (int c = 0; c < 3; ++c) observer_[c] = color::sampled_at_integer_nm(color::Observer::cie1931().curve(c));
}

void RecordMaker::camera(std::uint64_t n, std::uint32_t u, std::uint32_t v, const Radiance& radiance, const Wavelengths& w,
                         std::uint32_t kept, sampledb::Records& out, RadianceFaults& faults) const {
    put(n, u, v, sampledb::RecordClass::kCamera, radiance, w, kept, out, faults);
}

void RecordMaker::light(std::uint64_t n, float u, float v, const Radiance& radiance, const Wavelengths& w, std::uint32_t kept,
                        sampledb::Records& out, RadianceFaults& faults) const {
    put(n, static_cast<std::uint32_t>(u * 0x1p32f), static_cast<std::uint32_t>(v * 0x1p32f), sampledb::RecordClass::kLight,
        radiance, w, kept, out, faults);
}

void RecordMaker::put(std::uint64_t n, std::uint32_t u, std::uint32_t v, sampledb::RecordClass record_class,
                      const Radiance& radiance, const Wavelengths& w, std::uint32_t kept, sampledb::Records& out,
                      RadianceFaults& faults) const {
    const bool camera = record_class == sampledb::RecordClass::kCamera;
    const SampledSpectrum power = radiance.sum * w.weight;
    const bool lit = is_valid(power, w.k, faults) && !power.is_black();
    if (!lit && !camera) return;
    out.sample.push_back(n);
    out.record_class.push_back(record_class);
    out.u.push_back(u);
    out.v.push_back(v);
    out.share.push_back(camera ? 1.0f : 0.0f);
    if (kind_ == sampledb::RecordKind::kXyz) {
        float xyz[3] = {0, 0, 0};
        for (std::uint32_t i = 0; lit && i < w.k; ++i) {
            for (int c = 0; c < 3; ++c) {
                const float a = observer_[c].value[w.below[i]], b = observer_[c].value[w.below[i] + 1];
                xyz[c] += power[i] * (a + w.fraction[i] * (b - a));
            }
        }
        out.x.push_back(xyz[0]);
        out.y.push_back(xyz[1]);
        out.z.push_back(xyz[2]);
        return;
    }
    out.xi.push_back(w.xi);
    if (!lit) {
        out.pairs.push_back(0);
        out.index.push_back(sampledb::kNoIndex);
    } else if (radiance.has_all || w.k == 1) {
        out.pairs.push_back(static_cast<std::uint16_t>(w.k));
        out.index.push_back(sampledb::kNoIndex);
        out.power.insert(out.power.end(), power.v, power.v + w.k);
    } else {
        out.pairs.push_back(1);
        out.index.push_back(static_cast<std::uint16_t>(kept));
        out.power.push_back(power[kept]);
    }
}

}  // namespace latent::render
