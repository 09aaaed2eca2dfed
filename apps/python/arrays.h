// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Arrays in, checked, and out, as views of what C++ holds.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::python {

namespace py = pybind11;

/// How far a quaternion's or a normal's length may be off 1.
inline constexpr double kUnitTolerance = 1e-3;
/// NumPy hands on memory that is not aligned as it is, unless it is asked.
inline constexpr int kDense = py::array::c_style | py::array::forcecast | py::detail::npy_api::NPY_ARRAY_ALIGNED_;

/// Dense numbers of any array-like of numbers. TypeError for what is none.
[[nodiscard]] py::array_t<double, py::array::c_style> numbersFrom(const py::handle& given, const char* name);
/// (n, 3), finite; a single (3,) counts as one. TypeError, ValueError.
[[nodiscard]] std::vector<core::Vec3> pointsFrom(const py::handle& given, const char* name);
/// (n, 7) of x y z qw qx qy qz or (n, 4, 4); a single one too. Quaternions within 1e-3 of unit length are normalised,
/// as in files. TypeError, ValueError with the number of the pose.
[[nodiscard]] std::vector<core::Pose> posesFrom(const py::handle& given, const char* name);

/// Reads only, of memory that `owner` keeps alive. Strides in bytes; none: dense.
template <class T>
[[nodiscard]] py::array viewOf(const T* data, std::vector<py::ssize_t> shape, const py::object& owner,
                               std::vector<py::ssize_t> strides = {}) {
    if (strides.empty()) {
        strides.assign(shape.size(), sizeof(T));
        for (std::size_t i = shape.size(); i-- > 1;)
            strides[i - 1] = strides[i] * shape[i];
    }
    // An empty vector has no address, and NumPy would then make memory of its own.
    static const T nothing{};
    py::array array(py::dtype::of<T>(), std::move(shape), std::move(strides), data ? data : &nothing, owner);
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
    return array;
}

/// Keeps what it is given for as long as a view lives.
template <class T>
[[nodiscard]] py::object keeperOf(std::shared_ptr<T> kept) {
    return py::capsule(new std::shared_ptr<T>(std::move(kept)),
                       [](void* pointer) { delete static_cast<std::shared_ptr<T>*>(pointer); });
}

/// An array that owns its numbers.
template <class T>
[[nodiscard]] py::array arrayOf(std::vector<T> values, std::vector<py::ssize_t> shape) {
    auto kept = std::make_shared<std::vector<T>>(std::move(values));
    const T* data = kept->data();
    return py::array(py::dtype::of<T>(), std::move(shape), data, keeperOf(kept));
}

/// One member of each row of a vector of rows, as a view: (n,), or (n, width) for an array of numbers.
template <class T, class Row>
[[nodiscard]] py::array columnOf(const std::vector<Row>& rows, const T* first, py::ssize_t width,
                                 const py::object& owner) {
    const auto n = static_cast<py::ssize_t>(rows.size());
    const auto row = static_cast<py::ssize_t>(sizeof(Row)), number = static_cast<py::ssize_t>(sizeof(T));
    if (width == 1) return viewOf(first, {n}, owner, {row});
    return viewOf(first, {n, width}, owner, {row, number});
}

}  // namespace handpiece::python
