// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/lesion/place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/split_mix.h"

namespace handpiece::lesion {

using core::Vec3;

namespace {

constexpr double kMolarMm = 10.5;  ///< mesiodistal, of the crown that sizes are given for
constexpr double kStepMm = 0.05, kFarMm = 60.0;

const cases::Part* partOf(const cases::Tooth& tooth, cases::Tissue tissue) {
    for (const cases::Part& part : tooth.parts)
        if (part.tissue == tissue) return &part;
    throw core::Error(fmt::format("this tooth has no {}", cases::properties(tissue).name), tooth.name,
                      "lesions need the outer surface, enamel, dentine and pulp");
}

Vec3 gradient(const Surfaces& s, double (Surfaces::*f)(const Vec3&) const, const Vec3& p) {
    Vec3 g;
    for (int k = 0; k < 3; ++k) {
        const Vec3 d = kStepMm * Vec3::Unit(k);
        g[k] = (s.*f)(p + d) - (s.*f)(p - d);
    }
    return g / (2.0 * kStepMm);
}

/// How far the surface at (x, y) lies below what is around it, seen from above: a fissure. Less than zero: no place.
class Relief {
  public:
    explicit Relief(const Surfaces& surfaces) : surfaces_(surfaces), lowestMm_(surfaces.crown().centre().z()) {}

    [[nodiscard]] std::optional<Vec3> surfaceAt(double x, double y) const {
        const auto met = surfaces_.meeting(Vec3(x, y, surfaces_.crown().max.z() + 1.0), -Vec3::UnitZ());
        return met && met->z() > lowestMm_ ? met : std::nullopt;
    }
    [[nodiscard]] double depthMm(const Vec3& p) const {
        constexpr int kAround = 12;
        const double radius = 0.8 * surfaces_.scale();
        double sum = 0.0;
        for (int i = 0; i < kAround; ++i) {
            const double angle = 2.0 * M_PI * i / kAround;
            const auto there = surfaceAt(p.x() + radius * core::cos(angle), p.y() + radius * core::sin(angle));
            if (!there) return -1.0;
            sum += there->z();
        }
        return sum / kAround - p.z();
    }

  private:
    const Surfaces& surfaces_;
    double lowestMm_;
};

/// Follows a fissure both ways from its deepest place.
std::vector<Vec3> fissureOf(const Surfaces& surfaces, const cases::Tooth& tooth) {
    constexpr double kLeastMm = 0.12, kGridMm = 0.2, kStride = 0.2, kMostMm = 3.5;
    const Relief relief(surfaces);
    const core::Box& crown = surfaces.crown();
    const Vec3 middle = crown.centre(), reach = 0.3 * crown.size();
    Vec3 deepest = Vec3::Zero();
    double most = 0.0;
    for (double x = -reach.x(); x <= reach.x(); x += kGridMm)
        for (double y = -reach.y(); y <= reach.y(); y += kGridMm)
            if (const auto p = relief.surfaceAt(middle.x() + x, middle.y() + y))
                if (const double depth = relief.depthMm(*p); depth > most) most = depth, deepest = *p;
    if (most < kLeastMm)
        throw core::Error("this tooth has no fissure or pit", tooth.name, "choose another surface than occlusal");
    std::vector<Vec3> line{deepest};
    double heading = 0.0;
    for (const bool back : {false, true}) {
        Vec3 p = deepest;
        bool isFirst = true;
        for (double way = 0.0; way < kMostMm; way += kStride) {
            double best = -1.0, bestAngle = 0.0;
            Vec3 next = p;
            const double spread = isFirst && !back ? M_PI : 0.7;
            const double ahead = isFirst && back ? heading + M_PI : heading;
            for (int i = -8; i <= 8; ++i) {
                const double angle = ahead + spread * i / 8.0;
                const auto q = relief.surfaceAt(p.x() + kStride * core::cos(angle), p.y() + kStride * core::sin(angle));
                if (!q) continue;
                if (const double depth = relief.depthMm(*q); depth > best) best = depth, bestAngle = angle, next = *q;
            }
            if (best < 0.4 * most) break;
            if (isFirst && !back) heading = bestAngle;
            const double kept = heading;
            heading = bestAngle;
            p = next;
            back ? void(line.insert(line.begin(), p)) : line.push_back(p);
            if (isFirst && !back) heading = kept;
            isFirst = false;
        }
        if (!back && line.size() > 1) {
            const Vec3 first = line[1] - line[0];
            heading = core::atan2(first.y(), first.x());
        }
    }
    return line;
}

/// A stretch of a line about one of its points.
std::vector<Vec3> stretch(const std::vector<Vec3>& line, double atShare, double lengthMm) {
    double whole = 0.0;
    for (std::size_t i = 1; i < line.size(); ++i)
        whole += (line[i] - line[i - 1]).norm();
    const double middle = atShare * whole, from = middle - 0.5 * lengthMm, to = middle + 0.5 * lengthMm;
    std::vector<Vec3> points;
    double at = 0.0;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const double piece = (line[i] - line[i - 1]).norm();
        const int steps = std::max(1, static_cast<int>(std::ceil(piece / 0.2)));
        for (int k = 0; k < steps; ++k) {
            const double here = at + piece * k / steps;
            if (here >= from && here <= to) points.push_back(line[i - 1] + (line[i] - line[i - 1]) * k / steps);
        }
        at += piece;
    }
    if (points.empty()) points.push_back(line[line.size() / 2]);
    return points;
}

double toSegment(const Vec3& a, const Vec3& b, const Vec3& p) {
    const Vec3 ab = b - a;
    const double t = std::clamp((p - a).dot(ab) / std::max(ab.squaredNorm(), 1e-12), 0.0, 1.0);
    return (p - a - t * ab).squaredNorm();
}

}  // namespace

double Dice::between(double low, double high) {
    return low + (high - low) * core::unitOf(core::nextSplitMix(state_));
}

Surfaces::Surfaces(const cases::Tooth& tooth) : tooth_(tooth) {
    if (tooth.outer.triangles.empty())
        throw core::Error("this tooth has no outer surface", tooth.name, "lesions need one, enamel, dentine and pulp");
    enamel_ = &partOf(tooth, cases::Tissue::enamel)->mesh;
    dentine_.emplace(partOf(tooth, cases::Tissue::dentine)->mesh);
    pulp_.emplace(partOf(tooth, cases::Tissue::pulp)->mesh);
    outer_.emplace(tooth.outer);
    crown_ = enamel_->bounds();
}

std::optional<Vec3> Surfaces::meeting(const Vec3& from, const Vec3& along) const {
    const geometry::RayMeeting met = outer_->firstMeeting(from, along);
    if (met.triangle == geometry::kNoTriangle) return {};
    return from + met.distanceMm * along;
}

double Surfaces::cervixMm(const Vec3& out) const {
    constexpr double kWithin = 0.94;  // cosine of 20 degrees
    double lowest = crown_.max.z();
    for (const Vec3& v : enamel_->vertices) {
        const Vec3 aside(v.x() - crown_.centre().x(), v.y() - crown_.centre().y(), 0.0);
        if (aside.dot(out) > kWithin * aside.norm()) lowest = std::min(lowest, v.z());
    }
    return lowest;
}

double Surfaces::scale() const {
    return std::clamp(crown_.size().x() / kMolarMm, 0.55, 1.0);
}

Vec3 outwards(const cases::Tooth& tooth, Surface surface) {
    if (surface == Surface::occlusal) return Vec3::UnitZ();
    if (surface == Surface::mesial) return Vec3::UnitX();
    if (surface == Surface::distal) return -Vec3::UnitX();
    if (tooth.buccalSign == 0)
        throw core::Error("it is not known which side of this tooth is buccal", tooth.name, "give it with --buccal");
    return (surface == Surface::lingual ? -1.0 : 1.0) * tooth.buccalSign * Vec3::UnitY();
}

std::vector<Vec3> entries(const Surfaces& surfaces, const cases::Tooth& tooth, Surface surface, double lengthMm,
                          Dice& dice) {
    const core::Box& crown = surfaces.crown();
    const Vec3 out = outwards(tooth, surface);
    if (surface == Surface::occlusal) {
        if (const int place = tooth.fdiNumber % 10; place >= 1 && place <= 3)
            throw core::Error("incisors and canines have no occlusal surface with a fissure", tooth.name,
                              "choose another surface");
        // The central fissure, else the first; without one, a pit; without both, the shape.
        std::vector<Vec3> line;
        bool isCentral = false;
        for (const cases::Landmark& l : tooth.landmarks) {
            if (l.kind != cases::LandmarkKind::fissure || isCentral) continue;
            isCentral = l.name.find("central") != std::string::npos;
            if (isCentral || line.empty()) line = l.pointsMm;
        }
        for (const cases::Landmark& l : tooth.landmarks)
            if (l.kind == cases::LandmarkKind::pit && line.empty()) line = l.pointsMm;
        if (line.empty()) line = fissureOf(surfaces, tooth);
        return stretch(line, dice.between(0.4, 0.6), lengthMm);
    }
    const double cervix = surfaces.cervixMm(out), height = crown.max.z() - cervix, scale = surfaces.scale();
    Vec3 at = crown.centre();
    if (surface == Surface::mesial || surface == Surface::distal) {
        // Below the contact, where no brush comes. Without a landmark it is where the crown is widest.
        Vec3 contact = Vec3(out.x() * -kFarMm, 0.0, 0.0);
        bool isTold = false;
        for (const cases::Landmark& l : tooth.landmarks)
            if (l.kind == cases::LandmarkKind::contact && l.name == kSurfaces[static_cast<std::size_t>(surface)])
                contact = l.pointsMm.front(), isTold = true;
        for (const cases::Part& part : tooth.parts)
            if (part.tissue == cases::Tissue::enamel && !isTold)
                for (const Vec3& v : part.mesh.vertices)
                    if (v.z() > cervix + 0.35 * height && v.dot(out) > contact.dot(out)) contact = v;
        at.y() = contact.y() + scale * dice.between(-0.3, 0.3);
        at.z() = std::max(contact.z() - scale * dice.between(0.5, 1.0), cervix + 0.25 * height);
    } else {
        at.x() += scale * dice.between(-0.8, 0.8);
        at.z() = surface == Surface::cervical ? cervix + dice.between(1.0, 1.4)
                 : surface == Surface::root   ? cervix - dice.between(1.0, 1.6)
                                              : cervix + dice.between(0.35, 0.5) * height;
    }
    const Vec3 from = at + kFarMm * out;
    if (const auto met = surfaces.meeting(from, -out)) return {*met};
    throw core::Error(fmt::format("this tooth has no {} surface there", kSurfaces[static_cast<std::size_t>(surface)]),
                      tooth.name);
}

Ways waysIn(const Surfaces& surfaces, const cases::Tooth& tooth, const Lesion& lesion, Dice& dice) {
    constexpr double kFissureMm[] = {1.0, 1.4, 1.6, 2.0, 2.4, 2.4};  // of E1 to D3 and a filling
    const double length =
        surfaces.scale() * kFissureMm[std::min<std::size_t>(static_cast<std::size_t>(lesion.finding), 5)];
    Ways ways;
    for (const Vec3& entry : entries(surfaces, tooth, lesion.surface, length, dice)) {
        const Vec3 out = gradient(surfaces, &Surfaces::outer, entry).normalized();
        const Vec3 up = lesion.surface == Surface::occlusal ? Vec3(Vec3::UnitZ()) : out;
        std::vector<Vec3> way{entry + 0.6 * up, entry};
        Vec3 p = entry, last = entry;
        for (int i = 0; i < 400; ++i) {
            const double inDentine = std::max(0.0, -surfaces.dentine(p)), toPulp = surfaces.pulp(p);
            if (toPulp < 2.0 * kStepMm) break;
            Vec3 along = -gradient(surfaces, &Surfaces::dentine, p);
            if (inDentine > 0.0) along = toPulp * along - inDentine * gradient(surfaces, &Surfaces::pulp, p);
            if (along.norm() < 1e-6) break;
            p += kStepMm * along.normalized();
            if ((p - last).norm() > 0.2) way.push_back(last = p);
        }
        way.push_back(p);
        ways.push_back(std::move(way));
    }
    return ways;
}

double distanceMm(const Ways& ways, const Vec3& p) {
    double nearest = 1e18;
    for (const std::vector<Vec3>& way : ways)
        for (std::size_t i = 0; i < way.size(); ++i)
            nearest = std::min(nearest, toSegment(way[i > 0 ? i - 1 : 0], way[i], p));
    return std::sqrt(nearest);
}

}  // namespace handpiece::lesion
