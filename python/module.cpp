// python/module.cpp: the names that Python sees of what is beside it. What users see is in latent/__init__.py.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <iterator>

#include "c_api/latent.h"
#include "python/failure.h"
#include "python/reader.h"
#include "python/tools.h"
#include "python/writer.h"

namespace py = pybind11;

PYBIND11_MODULE(_latent, m) {
    using namespace latent::python;
    py::register_exception<Failure>(m, "Error", PyExc_OSError);
    m.def("version", latent_version);
    m.attr("types") = std::vector<std::string>(std::next(std::begin(kTypes)), std::end(kTypes));  // of extra columns
    m.def("merge", merge);
    m.def("develop", develop);
    py::class_<Reader, std::shared_ptr<Reader>>(m, "Reader")
        .def(py::init<const std::vector<std::string>&, std::optional<JobHalves>, bool, bool>())
        .def("job", &Reader::job)
        .def("info", &Reader::info)
        .def("coverage", &Reader::coverage)
        .def("left_out", &Reader::left_out)
        .def("provenance", &Reader::provenance)
        .def("light_groups", &Reader::light_groups)
        .def("materials", &Reader::materials);
    py::class_<Pages>(m, "Pages")
        .def(py::init<std::shared_ptr<Reader>, std::optional<std::vector<std::string>>, std::optional<std::vector<double>>,
                      std::optional<Range>, std::uint32_t, std::optional<Range>>())
        .def("__iter__", [](py::object self) { return self; })
        .def("__next__", &Pages::next);
    py::class_<Writer>(m, "Writer")
        .def(py::init<const std::string&, const py::dict&, Range, double, const std::string&, bool>())
        .def("missing", &Writer::missing)
        .def("next", &Writer::next)
        .def("submit", &Writer::submit)
        .def("checkpoint", &Writer::checkpoint)
        .def("finish", &Writer::finish)
        .def("close", &Writer::close);
}
