// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Moments of points and volumes, and their axes. Private to this room.

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::registration {

struct Moments {
    double weight = 0.0;
    core::Vec3 mean = core::Vec3::Zero();
    core::Mat3 covariance = core::Mat3::Zero();
    void add(const core::Vec3& p, double w) {
        weight += w;
        mean += w * p;
        covariance += w * p * p.transpose();
    }
    void finish() {
        if (!(weight > 0.0)) return;
        mean /= weight;
        covariance = covariance / weight - mean * mean.transpose();
    }
};

/// Of the volume: tetrahedra from a point within, weighted with their sign.
inline Moments volumeMoments(const geometry::TriangleMesh& mesh) {
    const core::Vec3 from = mesh.bounds().centre();
    Moments m;
    for (const geometry::Triangle& t : mesh.triangles) {
        const core::Vec3 a = mesh.vertices[t[0]] - from, b = mesh.vertices[t[1]] - from, c = mesh.vertices[t[2]] - from;
        const double volume = a.dot(b.cross(c)) / 6.0;
        const core::Vec3 sum = a + b + c;
        m.weight += volume;
        m.mean += volume * sum / 4.0;
        m.covariance +=
            volume / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
    m.finish();
    m.mean += from;
    return m;
}

/// Third moment of the volume along an axis: negative where the long thin end points along it backwards.
inline double volumeSkew(const geometry::TriangleMesh& mesh, const core::Vec3& mean, const core::Vec3& axis) {
    double sum = 0.0;
    for (const geometry::Triangle& t : mesh.triangles) {
        const core::Vec3 a = mesh.vertices[t[0]] - mean, b = mesh.vertices[t[1]] - mean, c = mesh.vertices[t[2]] - mean;
        const double volume = a.dot(b.cross(c)) / 6.0;
        const double x = a.dot(axis), y = b.dot(axis), z = c.dot(axis);
        // Exact for a tetrahedron with one corner at the mean: sum of all products of degree three, each once.
        sum += volume / 20.0 *
               (x * x * x + y * y * y + z * z * z + x * x * y + x * x * z + y * y * x + y * y * z + z * z * x +
                z * z * y + x * y * z);
    }
    return sum;
}

struct Axes {
    core::Mat3 vectors;  ///< columns, by falling spread
    core::Vec3 spread;
};
inline Axes principalAxes(const core::Mat3& covariance) {
    const Eigen::SelfAdjointEigenSolver<core::Mat3> solver(covariance);
    Axes axes;
    for (int i = 0; i < 3; ++i) {
        axes.vectors.col(i) = solver.eigenvectors().col(2 - i);
        axes.spread[i] = std::max(0.0, solver.eigenvalues()[2 - i]);
    }
    return axes;
}

}  // namespace handpiece::registration
