// python/arrays.h: NumPy arrays from columns.
#pragma once

#include <pybind11/numpy.h>

#include <cstring>
#include <utility>
#include <vector>

#include "c_api/latent.h"

namespace latent::python {

using Range = std::pair<std::uint64_t, std::uint64_t>;      // first, end
using JobHalves = std::pair<std::uint64_t, std::uint64_t>;  // of a job's id: high, low

// NumPy's names of LATENT_U8 .. LATENT_F64.
inline constexpr const char* kTypes[] = {"", "u1", "u2", "u4", "u8", "f4", "f8"};

// Member `name` of what Python has checked.
template <class T>
T get(const pybind11::dict& given, const char* name) {
    return given[name].cast<T>();
}

// A new array of `shape`, filled by a copy.
template <class T>
pybind11::array copied(const T* from, std::vector<pybind11::ssize_t> shape) {
    pybind11::array_t<T> array(std::move(shape));
    if (array.size() > 0) std::memcpy(array.mutable_data(), from, static_cast<std::size_t>(array.nbytes()));
    return array;
}

// (m, 2): the intervals that `list`, a function of latent.h, stores.
template <class List>
pybind11::array intervals(const List& list) {
    std::vector<latent_range> ranges(list(nullptr, 0));
    list(ranges.data(), ranges.size());
    return copied(reinterpret_cast<const std::uint64_t*>(ranges.data()), {static_cast<pybind11::ssize_t>(ranges.size()), 2});
}

}  // namespace latent::python
