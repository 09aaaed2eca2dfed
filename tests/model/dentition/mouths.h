// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Mouths for tests: coarse teeth, arranged, and what holds them.

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/dentition/mouth.h"
#include "handpiece/model/dentition/occlusion.h"

namespace handpiece::dentition {

using cases::LandmarkKind;
using core::Pose;
using core::Vec3;
using geometry::TriangleMesh;
using geometry::TriangleTree;

/// Teeth with some 20,000 faces, as arrange() takes them, without their tissues.
struct Mouth {
    std::vector<cases::Tooth> teeth;
    Arrangement arches;
    double deepestFacetMm = 0.0;
    std::vector<TriangleMesh> placed;  ///< closed, mouth frame
    std::vector<TriangleTree> trees;   ///< of those

    [[nodiscard]] Vec3 cusp(int fdi, const std::string& name) const {
        const std::size_t i = indexOf(fdi);
        for (const cases::Landmark& mark : teeth[i].landmarks)
            if (mark.kind == LandmarkKind::cuspTip && mark.name == name)
                return arches.toothInMouth[i].apply(mark.pointsMm[0]);
        ADD_FAILURE() << fdi << " has no cusp " << name;
        return Vec3::Zero();
    }
    [[nodiscard]] std::vector<Vec3> cusps(int fdi, bool buccal) const {
        const std::size_t i = indexOf(fdi);
        std::vector<Vec3> found;
        for (const cases::Landmark& mark : teeth[i].landmarks)
            if (mark.kind == LandmarkKind::cuspTip && (mark.pointsMm[0].y() * teeth[i].buccalSign > 0.0) == buccal)
                found.push_back(arches.toothInMouth[i].apply(mark.pointsMm[0]));
        return found;
    }
};

inline bool isRightTooth(std::size_t i) {
    return fdiOf(i) / 10 == 1 || fdiOf(i) / 10 == 4;
}

/// Left teeth are the right ones in the mirror, bit for bit (tooth_form_test): half of the time.
inline void addLeftTeeth(std::vector<cases::Tooth>& teeth) {
    const auto turn = [](TriangleMesh& mesh) {
        for (Vec3& v : mesh.vertices)
            v.y() = -v.y();
        for (geometry::Triangle& t : mesh.triangles)
            std::swap(t[1], t[2]);
    };
    for (std::size_t i = 0; i < kToothCount; ++i) {
        if (isRightTooth(i)) continue;
        const int fdi = fdiOf(i);
        cases::Tooth& left = teeth[i] = teeth[indexOf(fdi < 30 ? fdi - 10 : fdi + 10)];
        left.fdiNumber = fdi, left.buccalSign = -left.buccalSign;
        turn(left.outer);
        for (cases::Part& part : left.parts)
            turn(part.mesh);
        for (cases::Landmark& mark : left.landmarks)
            for (Vec3& p : mark.pointsMm)
                p.y() = -p.y();
    }
}

inline std::vector<cases::Tooth> coarseTeeth(const Patient& patient, double spacingMm = 0.3) {
    std::vector<cases::Tooth> teeth(kToothCount);
    core::parallelFor(kToothCount, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            if (!isRightTooth(i)) continue;
            const ToothForm form(fdiOf(i), patient);
            geometry::IsosurfaceSettings settings;
            settings.spacingMm = spacingMm;
            settings.lipschitz = ToothForm::kLipschitz;
            settings.usualSlope = 1.0;
            settings.relaxations = 0;
            teeth[i].outer = geometry::isosurface(
                form.bounds(), [&](const Vec3& p) { return form.outer(p); }, settings);
            teeth[i].fdiNumber = form.fdi();
            teeth[i].buccalSign = form.buccalSign();
            teeth[i].landmarks = form.landmarks();
        }
    });
    addLeftTeeth(teeth);
    return teeth;
}

inline Mouth madeMouth(std::uint64_t seed) {
    Mouth m;
    m.teeth = coarseTeeth({seed, 25.0});
    m.arches = arrange(m.teeth);
    m.deepestFacetMm = grindFacets(m.teeth, m.arches);
    for (std::size_t i = 0; i < kToothCount; ++i) {
        m.placed.push_back(geometry::transformed(m.teeth[i].outer, m.arches.toothInMouth[i]));
        m.trees.emplace_back(m.placed.back());
    }
    return m;
}

/// The same, kept.
inline const Mouth& mouth(std::uint64_t seed) {
    static std::map<std::uint64_t, Mouth> made;
    if (const auto found = made.find(seed); found != made.end()) return found->second;
    return made[seed] = madeMouth(seed);
}

/// Least signed distance of one surface's vertices and edges' middles from the other, both ways; `at` the place.
inline double gapOf(const Mouth& m, std::size_t a, std::size_t b, double boundMm, Vec3* at = nullptr) {
    double least = boundMm;
    for (const auto& [of, to] : {std::pair{a, b}, std::pair{b, a}}) {
        const core::Box box = m.trees[to].bounds().grown(boundMm);
        const auto ask = [&, to = to](const Vec3& p) {
            if (((p - box.max).array() > 0.0).any() || ((box.min - p).array() > 0.0).any()) return;
            if (m.trees[to].nearest(p, 1.5).triangle == geometry::kNoTriangle) return;
            const double distance = m.trees[to].signedDistance(p);
            if (distance < least) {
                least = distance;
                if (at) *at = p;
            }
        };
        for (const Vec3& p : m.placed[of].vertices)
            ask(p);
        for (const geometry::Triangle& t : m.placed[of].triangles)
            for (int e = 0; e < 3; ++e)
                if (t[e] < t[(e + 1) % 3])
                    ask(0.5 * (m.placed[of].vertices[t[e]] + m.placed[of].vertices[t[(e + 1) % 3]]));
    }
    return least;
}

/// Height of a point over the cemento-enamel junction near it, in the tooth's frame.
inline double overJunction(const cases::Tooth& tooth, const Vec3& p) {
    double nearest = 1e9, height = 0.0;
    for (const cases::Landmark& mark : tooth.landmarks)
        if (mark.kind == LandmarkKind::cementoEnamelJunction)
            for (const Vec3& q : mark.pointsMm)
                if (const double away = (q - p).head<2>().norm(); away < nearest)
                    nearest = away, height = p.z() - q.z();
    return height;
}

/// Gingiva and bone of one arch, coarse.
struct Held {
    std::vector<std::size_t> order;
    Periodontium tissues;
};
inline Held madeHeld(const Mouth& m, bool upper) {
    Held h;
    std::vector<ArchTooth> arch;
    for (std::size_t k = 0; k < 16; ++k) {
        h.order.push_back(k < 8 ? (upper ? 7 : 31) - k : (upper ? 8 : 16) + k - 8);
        arch.push_back({&m.teeth[h.order.back()], m.arches.toothInMouth[h.order.back()]});
    }
    h.tissues = makePeriodontium(arch, {.spacingMm = 0.25, .gingivaFaces = 120000, .boneFaces = 60000});
    return h;
}

/// The same, kept.
inline const Held& held(bool upper, std::uint64_t seed = 1) {
    static std::map<std::pair<bool, std::uint64_t>, Held> made;
    if (const auto found = made.find({upper, seed}); found != made.end()) return found->second;
    return made[{upper, seed}] = madeHeld(mouth(seed), upper);
}

}  // namespace handpiece::dentition
