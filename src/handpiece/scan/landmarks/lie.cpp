// SPDX-License-Identifier: Apache-2.0
// How a tooth lies in its surface: the average one of its number is laid into it.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/scan/landmarks/find_landmarks.h"
#include "handpiece/scan/landmarks/finder.h"

namespace handpiece::landmarks {
namespace {

using core::Mat3;
using core::Quat;
using core::Vec3;
using geometry::TriangleMesh;

constexpr double kLieSampleMm = 0.5, kReachMm = 3.0;
constexpr std::size_t kMostSamples = 1200;
constexpr int kRounds = 30;
/// Of the average tooth's surface: how far that of another person lies off it, and how many of its points tell on
/// their own.
constexpr double kSpreadMm = 0.3, kOwnPoints = 120.0;
/// How well the rough place is known, and sizes.
constexpr double kTurnRad = 0.25, kSizeShare = 0.15;
/// Roots differ more from person to person than crowns.
constexpr double kRootWeight = 0.25;
constexpr double kMostMisfitMm = 0.6, kLeastShare = 0.7, kLeastCos = 0.77;  // 40 degrees

struct SurfaceSample {
    Vec3 at, normal;
    double weight = 1.0;
};

std::vector<SurfaceSample> samplesOf(const TriangleMesh& mesh) {
    std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
    for (const geometry::Triangle& t : mesh.triangles) {
        const Vec3 n = (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
        for (const std::uint32_t v : t)
            normals[v] += n;
    }
    std::vector<SurfaceSample> samples;
    const std::size_t step = mesh.vertices.size() / kMostSamples + 1;
    for (std::size_t v = 0; v < mesh.vertices.size(); v += step)
        if (normals[v].norm() > 0.0)
            samples.push_back(
                {mesh.vertices[v], normals[v].normalized(), mesh.vertices[v].z() > 0.0 ? 1.0 : kRootWeight});
    return samples;
}

core::Box crownOf(const TriangleMesh& mesh, double neckAt) {
    core::Box box;
    for (const Vec3& v : mesh.vertices)
        if (v.z() > neckAt) box.extend(v);
    return box;
}

/// From the average tooth to the surface: stretched, turned, moved.
struct Laid {
    Vec3 size = Vec3::Ones();
    Quat turn = Quat::Identity();
    Vec3 moved = Vec3::Zero();
    [[nodiscard]] Vec3 stretched(const Vec3& p) const { return p.cwiseProduct(size); }
    [[nodiscard]] Vec3 apply(const Vec3& p) const { return turn * stretched(p) + moved; }
};

struct Meeting {
    bool isFound = false;
    double distanceMm = 0.0;  ///< along the surface's normal
    Vec3 normal = Vec3::Zero();
};

std::vector<Meeting> meet(const geometry::TriangleTree& tree, const std::vector<SurfaceSample>& samples,
                          const Laid& laid) {
    std::vector<Meeting> meetings(samples.size());
    core::parallelFor(samples.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const Vec3 p = laid.apply(samples[i].at);
            const geometry::NearestPoint n = tree.nearest(p, kReachMm);
            if (n.triangle == geometry::kNoTriangle) continue;
            const Vec3 normal = tree.pseudonormal(n.triangle, n.feature);
            if (normal.dot(laid.turn * samples[i].normal) < 0.3) continue;
            meetings[i] = {true, normal.dot(p - n.pointMm), normal};
        }
    });
    return meetings;
}

}  // namespace

std::optional<Lie> lieOf(int fdiNumber, const TriangleMesh& surface, const core::Pose& roughly) {
    if (!cases::isPermanentTooth(fdiNumber) || surface.triangles.empty()) return std::nullopt;
    const dentition::ToothForm form(fdiNumber, {0, kAverageAgeYears});
    geometry::IsosurfaceSettings settings;
    settings.lipschitz = dentition::ToothForm::kLipschitz;
    settings.usualSlope = 1.0;
    settings.spacingMm = kLieSampleMm;
    const TriangleMesh average = geometry::isosurface(
        form.bounds(), [&](const Vec3& p) { return form.outer(p); }, settings);
    const std::vector<SurfaceSample> samples = samplesOf(average);
    const TriangleMesh tooth = geometry::transformed(surface, roughly);
    const geometry::TriangleTree tree(tooth);

    // Crowns as large as each other, their tops together.
    Laid laid;
    const core::Box whole = tooth.bounds(), wholeAverage = average.bounds();
    const double top = wholeAverage.max.z(), length = whole.size().z() / wholeAverage.size().z();
    const core::Box crown = crownOf(tooth, whole.max.z() - length * top), crownAverage = crownOf(average, 0.0);
    if (crown.isEmpty() || crownAverage.isEmpty()) return std::nullopt;
    laid.size = crown.size().cwiseQuotient(crownAverage.size());
    laid.size.z() = length;
    laid.size = laid.size.cwiseMax(0.6).cwiseMin(1.6);
    const Vec3 sizeAtFirst = laid.size;
    laid.moved = crown.centre() - laid.stretched(crownAverage.centre());
    laid.moved.z() = whole.max.z() - laid.size.z() * top;

    for (int round = 0; round < kRounds; ++round) {
        const std::vector<Meeting> meetings = meet(tree, samples, laid);
        // Turn, move, stretch: what makes the distances along the normals least.
        Eigen::Matrix<double, 9, 9> a = Eigen::Matrix<double, 9, 9>::Zero();
        Eigen::Matrix<double, 9, 1> b = Eigen::Matrix<double, 9, 1>::Zero();
        double weights = 0.0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const Meeting& m = meetings[i];
            if (!m.isFound) continue;
            const Vec3 p = laid.stretched(samples[i].at), turned = laid.turn * p;
            const double off = m.distanceMm / (2.0 * kSpreadMm), w = samples[i].weight / (1.0 + off * off);
            Eigen::Matrix<double, 9, 1> row;
            row << turned.cross(m.normal), m.normal, (laid.turn.conjugate() * m.normal).cwiseProduct(p);
            a += w * row * row.transpose();
            b -= w * m.distanceMm * row;
            weights += w;
        }
        if (!(weights > 20.0)) return std::nullopt;
        const double share = kOwnPoints / (weights * kSpreadMm * kSpreadMm);
        a *= share;
        b *= share;
        const Vec3 turnedBy = (laid.turn.w() < 0.0 ? -2.0 : 2.0) * laid.turn.vec();
        for (int k = 0; k < 3; ++k) {
            a(k, k) += 1.0 / (kTurnRad * kTurnRad);
            b(k) -= turnedBy[k] / (kTurnRad * kTurnRad);
            a(k + 3, k + 3) += 1e-3;
            a(k + 6, k + 6) += 1.0 / (kSizeShare * kSizeShare);
            b(k + 6) -= (laid.size[k] / sizeAtFirst[k] - 1.0) / (kSizeShare * kSizeShare);
        }
        const Eigen::Matrix<double, 9, 1> step = a.ldlt().solve(b);
        if (!step.allFinite()) return std::nullopt;
        const Vec3 turn = step.head<3>().cwiseMax(-0.2).cwiseMin(0.2);
        laid.turn = (Quat(1.0, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z()).normalized() * laid.turn).normalized();
        laid.moved += step.segment<3>(3).cwiseMax(-1.0).cwiseMin(1.0);
        laid.size = laid.size.cwiseProduct(Vec3::Ones() + step.tail<3>().cwiseMax(-0.1).cwiseMin(0.1));
    }

    double sum = 0.0, found = 0.0, all = 0.0;
    const std::vector<Meeting> meetings = meet(tree, samples, laid);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!(samples[i].at.z() > 0.0)) continue;
        all += 1.0;
        if (!meetings[i].isFound) continue;
        found += 1.0;
        sum += std::abs(meetings[i].distanceMm);
    }
    const Mat3 turned = laid.turn.toRotationMatrix();
    const bool isFar = turned.diagonal().minCoeff() < kLeastCos;
    Lie lie;
    lie.misfitMm = found > 0.0 ? sum / found : kReachMm;
    if (isFar || found < kLeastShare * all || lie.misfitMm > kMostMisfitMm) return std::nullopt;
    lie.surfaceInTooth = (core::Pose{laid.moved, laid.turn}.inverse() * roughly).normalised();
    return lie;
}

}  // namespace handpiece::landmarks
