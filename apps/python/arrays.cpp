// SPDX-License-Identifier: Apache-2.0
#include "python/arrays.h"

#include <fmt/format.h>

#include <cmath>

namespace handpiece::python {
namespace {

constexpr double kRotationTolerance = 1e-6;

std::string shapeOf(const py::array& array) {
    std::string text;
    for (py::ssize_t i = 0; i < array.ndim(); ++i)
        text += fmt::format("{}{}", i ? ", " : "", array.shape(i));
    return "(" + text + (array.ndim() == 1 ? ",)" : ")");
}

core::Pose poseOfRow(const double* row, const char* name, std::size_t number) {
    core::Pose pose;
    pose.positionMm = {row[0], row[1], row[2]};
    pose.orientation = core::Quat(row[3], row[4], row[5], row[6]);
    const double norm = pose.orientation.norm();
    if (std::abs(norm - 1.0) > kUnitTolerance)
        throw py::value_error(
            fmt::format("{}[{}]: the quaternion's length is {:.6g}, not 1 (columns x, y, z, qw, qx, "
                        "qy, qz)",
                        name, number, norm));
    pose.orientation.coeffs() /= norm;
    return pose;
}

core::Pose poseOfMatrix(const double* m, const char* name, std::size_t number) {
    core::Mat3 rotation;
    core::Pose pose;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c)
            rotation(r, c) = m[4 * r + c];
        pose.positionMm[r] = m[4 * r + 3];
    }
    const bool isRotation =
        (rotation * rotation.transpose() - core::Mat3::Identity()).cwiseAbs().maxCoeff() < kRotationTolerance &&
        rotation.determinant() > 0.0;
    if (!isRotation || m[12] != 0.0 || m[13] != 0.0 || m[14] != 0.0 || m[15] != 1.0)
        throw py::value_error(fmt::format(
            "{}[{}] is no rigid placement: a rotation, a place in the last column, 0 0 0 1 below", name, number));
    pose.orientation = core::Quat(rotation).normalized();
    return pose;
}

void requireFinite(const double* row, std::size_t width, const char* name, std::size_t number) {
    for (std::size_t i = 0; i < width; ++i)
        if (!std::isfinite(row[i])) throw py::value_error(fmt::format("{}[{}] is not finite", name, number));
}

}  // namespace

py::array_t<double, py::array::c_style> numbersFrom(const py::handle& given, const char* name) {
    const py::array array = py::array::ensure(given);
    const char kind = array ? array.dtype().kind() : 'O';
    if (!array) PyErr_Clear();
    if (kind != 'f' && kind != 'i' && kind != 'u')
        throw py::type_error(fmt::format("{} must be an array of real numbers", name));
    return py::array_t<double, kDense>(array);
}

std::vector<core::Vec3> pointsFrom(const py::handle& given, const char* name) {
    const auto array = numbersFrom(given, name);
    const bool isOne = array.ndim() == 1 && array.shape(0) == 3;
    if (!isOne && !(array.ndim() == 2 && array.shape(1) == 3))
        throw py::value_error(fmt::format("{} must have the shape (n, 3), not {}", name, shapeOf(array)));
    const std::size_t n = isOne ? 1 : static_cast<std::size_t>(array.shape(0));
    std::vector<core::Vec3> points(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double* row = array.data() + 3 * i;
        requireFinite(row, 3, name, i);
        points[i] = {row[0], row[1], row[2]};
    }
    return points;
}

std::vector<core::Pose> posesFrom(const py::handle& given, const char* name) {
    const auto array = numbersFrom(given, name);
    const auto dim = array.ndim();
    const bool isRows = (dim == 1 || dim == 2) && array.shape(dim - 1) == 7;
    const bool isMatrices = (dim == 2 || dim == 3) && array.shape(dim - 1) == 4 && array.shape(dim - 2) == 4;
    if (!isRows && !isMatrices)
        throw py::value_error(fmt::format("{} must have the shape (n, 7) or (n, 4, 4), not {}", name, shapeOf(array)));
    const std::size_t width = isRows ? 7 : 16, n = static_cast<std::size_t>(array.size()) / width;
    std::vector<core::Pose> poses(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double* row = array.data() + width * i;
        requireFinite(row, width, name, i);
        poses[i] = isRows ? poseOfRow(row, name, i) : poseOfMatrix(row, name, i);
    }
    return poses;
}

}  // namespace handpiece::python
