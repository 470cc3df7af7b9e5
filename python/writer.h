// python/writer.h: a part, written grain by grain.
#pragma once

#include <pybind11/numpy.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c_api/latent.h"
#include "python/arrays.h"

namespace latent::python {

template <class T>
using Column = pybind11::array_t<T, pybind11::array::c_style | pybind11::array::forcecast>;

class Writer {
 public:
    Writer(const std::string& path, const pybind11::dict& given, Range samples, double checkpoint_seconds,
           const std::string& provenance, bool replace);

    pybind11::array missing() const;
    std::optional<Range> next();
    // Columns have the lengths and types of the job: latent/_writer.py has seen to that.
    void submit(Range grain, const Column<std::uint64_t>& sample, const Column<std::uint32_t>& u, const Column<std::uint32_t>& v,
                const std::vector<Column<float>>& values, const std::optional<Column<float>>& share,
                const std::optional<Column<std::uint8_t>>& record_class, const std::vector<pybind11::array>& extra);
    void checkpoint() { call(latent_writer_checkpoint); }
    void finish() { call(latent_writer_finish); }
    void close();

 private:
    latent_writer* opened() const;
    void call(latent_status (*function)(latent_writer*, latent_error*));

    latent_job job_{};
    std::vector<std::string> extra_names_;
    std::vector<latent_column> extra_;
    struct Closer {
        void operator()(latent_writer* writer) const { latent_writer_close(writer); }
    };
    std::unique_ptr<latent_writer, Closer> writer_;
};

}  // namespace latent::python
