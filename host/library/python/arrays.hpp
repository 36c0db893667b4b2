// SPDX-License-Identifier: MIT
#pragma once
/// \file Values of the library as numpy arrays.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <span>

namespace biteline::python {

namespace py = pybind11;

template <class T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;
using Free = py::call_guard<py::gil_scoped_release>;

/// (count, width) of `of(item)`, which has `width` numbers; (count,) for one number each.
template <class T, class Items, class Of>
py::array_t<T> rows(const Items& items, py::ssize_t width, const Of& of) {
  py::array_t<T> out({static_cast<py::ssize_t>(items.size()), width});
  T* next = out.mutable_data();
  for (const auto& item : items) {
    const auto values = of(item);
    for (py::ssize_t k = 0; k < width; ++k) *next++ = static_cast<T>(values[k]);
  }
  return out;
}
template <class T, class Items, class Of>
py::array_t<T> column(const Items& items, const Of& of) {
  py::array_t<T> out(static_cast<py::ssize_t>(items.size()));
  T* next = out.mutable_data();
  for (const auto& item : items) *next++ = static_cast<T>(of(item));
  return out;
}

/// A read-only view that keeps `owner` alive.
template <class T>
py::array view(std::span<const T> values, const py::object& owner) {
  py::array out(py::dtype::of<T>(), {static_cast<py::ssize_t>(values.size())}, {}, values.data(), owner);
  out.attr("setflags")(false);
  return out;
}

}  // namespace biteline::python
