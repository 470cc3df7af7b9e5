// Bidirectional path tracing: a subpath from the eye and one from a light, joined in every way. docs/rendering.md, "Bidirectional".
#include "render/transport/bidirectional/bdpt.h"

#include "render/transport/bidirectional/subpaths.h"

namespace latent::render {
namespace {

class BdptIntegrator final : public Transport {
 public:
    BdptIntegrator(std::unique_ptr<World> world, const IntegratorSettings& settings, StrategyFault fault)
        : Transport(std::move(world), settings), fault_(fault) {}
    std::uint32_t light_paths_per_sample() const override { return 1; }

 protected:
    void trace_paths(SampleState& sample, double u, double v, Radiance& camera, sampledb::Records& out,
                     RadianceFaults& faults) const override {
        auto& [eye, light] = subpaths_.local();
        Bidirectional(world(), settings(), records(), sample, eye, light, fault_, camera, out, faults).trace(u, v);
    }

 private:
    StrategyFault fault_;
    mutable tbb::enumerable_thread_specific<std::pair<Subpath, Subpath>> subpaths_;  // room that is used again, sample after sample
};

}  // namespace

std::unique_ptr<Integrator> make_bdpt_integrator(std::unique_ptr<World> world, const IntegratorSettings& settings,
                                                 StrategyFault fault) {
    return std::make_unique<BdptIntegrator>(std::move(world), settings, fault);
}

}  // namespace latent::render
