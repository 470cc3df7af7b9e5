// python/tools.h: latent-merge and latent-develop as functions for Python.
#pragma once

#include <pybind11/numpy.h>

#include <string>
#include <vector>

namespace latent::python {

// `options`: the fields of latent_merge_options. Returns the counts, and what was left out.
pybind11::dict merge(const std::vector<std::string>& paths, const std::string& output, const pybind11::dict& options);

// `options`: as latent-develop takes them. Returns the pixels (height, width, channels), the names of the channels, and warnings,
// what was left out first.
pybind11::tuple develop(const std::vector<std::string>& paths, const pybind11::dict& options);

}  // namespace latent::python
