#include "render/transport/bidirectional/bdpt.h"

#include "render/transport/bidirectional/join.h"
#include "render/transport/bidirectional/walk.h"

namespace latent::render {
namespace {

class BdptIntegrator final : public Transport {
 public:
    using Transport::Transport;
    std::uint32_t light_paths_per_sample() const override { return 1; }

 protected:
    void trace_paths(const TracedSample& sample, Vec2d film, bool again, Radiance& seen) const override {
        Subpaths& subpaths = subpaths_.local();
        SubpathWalk walk(world(), settings(), sample, subpaths, seen);
        if (!again) walk.trace_light();
        walk.trace_camera(film);
        SubpathJoin join(world(), settings(), sample, subpaths, seen);
        if (!again) join.join_lens();
        join.join_all(settings().connections);
    }

 private:
    mutable tbb::enumerable_thread_specific<Subpaths> subpaths_;  // room that is used again, sample after sample
};

}  // namespace

std::unique_ptr<Integrator> make_bdpt_integrator(std::unique_ptr<World> world, const IntegratorSettings& settings) {
    return std::make_unique<BdptIntegrator>(std::move(world), settings);
}

}  // namespace latent::render
