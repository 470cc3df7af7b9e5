// Bidirectional path tracing: a subpath from the camera and one from a light, joined in every way. docs/rendering.md,
// "Bidirectional".
#include "render/transport/bidirectional/bdpt.h"

#include "render/transport/bidirectional/subpaths.h"

namespace latent::render {
namespace {

class BdptIntegrator final : public Transport {
 public:
    using Transport::Transport;
    std::uint32_t light_paths_per_sample() const override { return 1; }

 protected:
    void trace_paths(SampleState& sample, double u, double v, Radiance& camera, sampledb::Records& out,
                     RadianceFaults& faults) const override {
        Bidirectional(world(), settings(), records(), sample, subpaths_.local(), camera, out, faults).trace(u, v);
    }

 private:
    mutable tbb::enumerable_thread_specific<Subpaths> subpaths_;  // room that is used again, sample after sample
};

}  // namespace

std::unique_ptr<Integrator> make_bdpt_integrator(std::unique_ptr<World> world, const IntegratorSettings& settings) {
    return std::make_unique<BdptIntegrator>(std::move(world), settings);
}

}  // namespace latent::render
