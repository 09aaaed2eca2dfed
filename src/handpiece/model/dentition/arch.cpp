// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/arch.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <numbers>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/base/geometry/height_raster.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/model/case/work_on.h"
#include "handpiece/model/dentition/occlusion.h"
#include "handpiece/model/dentition/tooth_body.h"

namespace handpiece::dentition {
namespace {

using core::Mat3;
using core::Pose;
using core::Quat;
using core::Vec2;
using core::Vec3;

constexpr double kRad = std::numbers::pi / 180.0;

// The line through the lower incisal edges and buccal cusps: y = A (cosh(k x) - 1), for teeth whose widths from the
// midline to the first molars' distal sides add up to kMeanWidthsMm [R].
constexpr double kCatenaryA = 4.2, kCatenaryK = 0.11, kMeanWidthsMm = 85.0;
constexpr double kLowestOfSpeeMm = 17.5;  ///< how far behind the incisal edges its lowest place is

/// How far the crown leans towards mesial, and towards buccal (labial) [degrees], against the occlusal plane
/// [R, after Dempster 1963]. From the second premolars on the cusps lie in the curves of Spee and Wilson instead.
struct Inclination {
    double mesial, buccal;
};
constexpr Inclination kUpper[8] = {{2, 24}, {7, 22}, {11, 14}, {6, 3}, {5, 4}, {5, 4}, {4, 5}, {0, 5}};
constexpr Inclination kLower[8] = {{0, 20}, {0, 20}, {5, 10}, {5, -3}, {6, -6}, {8, -12}, {10, -14}, {10, -14}};
constexpr int kFirstInCurves = 5;
constexpr double kMostTurnedDeg = 20.0;  ///< into the curves

/// Upper incisal edges below the lower ones: central, lateral, canine [R].
constexpr double kOverbites[3] = {kOverbiteMm, kOverbiteMm - 0.5, kOverbiteMm - 0.3};
constexpr double kToleranceMm = 0.003;
constexpr double kLookMm = 4.0;  ///< teeth farther apart are brought closer unseen

/// How far a tooth may leave its place to settle, and what that costs against depth [mm for 1 mm, for 1 degree].
struct Freedom {
    double asideMm, mesialDeg, buccalDeg, turnDeg;
    double costOfAside, costOfMesial, costOfBuccal, costOfTurn;
};
// Roots that lean together leave no bone between them: leaning to mesial or distal costs premolars most, and lower
// teeth may not. These stay near the curves of Spee and Wilson, and rise to meet what is over them.
constexpr Freedom kUpperPremolars{0.8, 5.0, 10.0, 8.0, 0.15, 0.003, 0.0005, 0.0005},
    kUpperMolars{0.8, 6.0, 12.0, 8.0, 0.15, 0.001, 0.0005, 0.0005},
    kLowerPremolars{0.5, 2.0, 6.0, 8.0, 0.15, 0.006, 0.001, 0.0005},
    kLowerMolars{0.3, 0.0, 3.0, 8.0, 0.3, 0.0, 0.002, 0.001};
constexpr const Freedom& freedomOf(std::size_t i) {
    return i % 8 < 5 ? (isUpper(i) ? kUpperPremolars : kLowerPremolars) : (isUpper(i) ? kUpperMolars : kLowerMolars);
}
constexpr double kMostRiseMm = 0.5;
constexpr int kRounds = 2;  ///< in which the lower teeth rise and all settle again
// It settles as on springs, one under each place: by the volume in which it and the lower teeth overlap, until facets
// are ground. Premolars bear less than molars.
constexpr double kPremolarsBiteMm3 = 0.05, kMolarsBiteMm3 = 0.1;
constexpr std::size_t kFirstThatSettles = 3;  ///< of a quadrant: those before it meet with their edges
// Adjacent teeth meet this far over the cervix or higher, else they are tilted by so much more until they do.
constexpr double kCrownFromMm = 1.5, kClearRootsDeg = 2.5;

/// The lower arch's line, seen from above, by its length from the midline.
class ArchLine {
  public:
    explicit ArchLine(double scale) : scale_(scale) {
        double s = 0.0;
        for (int i = 0; i < kSteps; ++i) {
            const Vec2 p = point(kStepMm * i);
            if (i > 0) s += (p - point(kStepMm * (i - 1))).norm();
            lengths_.push_back(s);
        }
    }
    struct Place {
        Vec2 point, distal, outward;
    };
    /// `side`: +1 the patient's left.
    [[nodiscard]] Place at(double s, double side) const {
        const auto next = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, s);
        const auto i = static_cast<double>(next - lengths_.begin());
        const double from = *(next - 1), x = kStepMm * (i - 1.0 + (s - from) / (*next - from));
        const double slope =
            kCatenaryA * kCatenaryK * 0.5 * (core::exp(kCatenaryK * x / scale_) - core::exp(-kCatenaryK * x / scale_));
        const Vec2 p = point(x), distal = Vec2(1.0, slope).normalized();
        return {{side * p.x(), p.y()}, {side * distal.x(), distal.y()}, {side * distal.y(), -distal.x()}};
    }
    [[nodiscard]] double speeHeight(double y) const {
        const double low = kLowestOfSpeeMm * scale_;
        return ((y - low) * (y - low) - low * low) / (2.0 * kSpeeRadiusMm);
    }
    [[nodiscard]] double speeSlope(double y) const { return (y - kLowestOfSpeeMm * scale_) / kSpeeRadiusMm; }

  private:
    static constexpr double kStepMm = 0.1;
    static constexpr int kSteps = 450;
    [[nodiscard]] Vec2 point(double x) const {
        const double k = kCatenaryK * x / scale_;
        return {x, kCatenaryA * scale_ * (0.5 * (core::exp(k) + core::exp(-k)) - 1.0)};
    }
    double scale_;
    std::vector<double> lengths_;
};

/// What of a tooth the arches ask for.
struct Member {
    const ToothBody& body;
    Vec3 reference;         ///< comes to lie on the line
    Quat ownTilt;           ///< turns its occlusal plane, or its long axis, as the arch wants it
    bool inCurves = false;  ///< its cusps lie in the curves; else its axis has its place's inclination
    int buccalSign = 0;
    double halfWidth = 0.0;
    std::vector<Vec3> occlusal{};   ///< vertices near the top, at most some thousands
    std::vector<double> areaMm2{};  ///< seen from above, what each of them stands for
};

Vec3 mean(const std::vector<Vec3>& points) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : points)
        sum += p;
    return sum / static_cast<double>(points.size());
}

/// The vertices near the top, and what of the surface each stands for.
void addOcclusal(Member& m) {
    const geometry::TriangleMesh& mesh = m.body.mesh;
    std::vector<double> areaMm2(mesh.vertices.size(), 0.0);
    for (const geometry::Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        for (const std::uint32_t v : t)
            areaMm2[v] += (b - a).cross(c - a).z() / 6.0;
    }
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        if (mesh.vertices[i].z() > m.body.box.max.z() - 4.5 && areaMm2[i] > 0.0) near.push_back(i);
    constexpr std::size_t kEnough = 3000;
    const std::size_t step = near.size() / kEnough + 1;
    for (std::size_t i = 0; i < near.size(); i += step) {
        m.occlusal.push_back(mesh.vertices[near[i]]);
        m.areaMm2.push_back(static_cast<double>(step) * areaMm2[near[i]]);
    }
}

Member memberOf(const cases::Tooth& tooth, const ToothBody& body, bool upper, int place) {
    Member m{body, Vec3::Zero(), Quat::Identity(), false, tooth.buccalSign};
    const std::vector<Vec3>& vertices = body.mesh.vertices;
    const double top = body.box.max.z();
    std::vector<Vec3> buccal, lingual, highest;
    for (const cases::Landmark& landmark : tooth.landmarks)
        if (landmark.kind == cases::LandmarkKind::cuspTip)
            (landmark.pointsMm[0].y() * tooth.buccalSign > 0.0 ? buccal : lingual).push_back(landmark.pointsMm[0]);
    double least = 1e9, most = -1e9;
    for (const Vec3& v : vertices) {
        if (v.z() > 0.0) least = std::min(least, v.x()), most = std::max(most, v.x());
        if (v.z() > top - 0.25) highest.push_back(v);
    }
    addOcclusal(m);
    m.halfWidth = 0.5 * (most - least);
    const bool hasTable = place >= 4 && !buccal.empty() && !lingual.empty();
    const Vec3 edge = place >= 4 && !buccal.empty() ? mean(buccal) : mean(highest);
    m.reference = {0.5 * (least + most), edge.y(), edge.z()};
    // The lower buccal cusps bite into the upper central fossae.
    if (upper && hasTable) m.reference.y() = 0.5 * (edge.y() + mean(lingual).y());

    const Inclination lean = upper ? kUpper[place - 1] : kLower[place - 1];
    if (m.inCurves = hasTable && place >= kFirstInCurves; m.inCurves) {
        std::sort(buccal.begin(), buccal.end(), [](const Vec3& a, const Vec3& b) { return a.x() > b.x(); });
        Vec3 along = Vec3::UnitX() + core::tan(lean.mesial * kRad) * Vec3::UnitZ();
        if (buccal.size() > 1) along = buccal[0] - buccal[1];
        const Vec3 across = tooth.buccalSign * (mean(buccal) - mean(lingual));
        m.ownTilt = core::rotationBetween(along.cross(across), Vec3::UnitZ());
        const double turned = core::angleBetween(m.ownTilt, Quat::Identity()), allowed = kMostTurnedDeg * kRad;
        if (turned > allowed) m.ownTilt = core::interpolated(Quat::Identity(), allowed / turned, m.ownTilt);
    } else {
        m.ownTilt = core::rotationAbout(Vec3::UnitY(), lean.mesial * kRad) *
                    core::rotationAbout(Vec3::UnitX(), -tooth.buccalSign * lean.buccal * kRad);
    }
    return m;
}

/// Where a tooth stands on the line: the unknowns of its pose.
struct Place {
    double s = 0.0;        ///< along the line, from the midline
    double asideMm = 0.0;  ///< outwards from it
    double upMm = 0.0;
    double mesialDeg = 0.0, buccalDeg = 0.0;  ///< tilted further than its inclination
    double turnDeg = 0.0;                     ///< about its long axis
    double leastMesialDeg = -90.0;            ///< so that its roots clear those of the tooth before it
};

/// How far the teeth of an arch come towards the other one, over each place of the occlusal plane.
class HeightMap {
  public:
    /// `sign`: +1 of lower teeth, heights; -1 of upper ones, depths.
    explicit HeightMap(double sign) : sign_(sign), z_(static_cast<std::size_t>(kWide * kDeep), kNothing) {}
    void add(const geometry::TriangleMesh& mesh, const Pose& pose) {
        const Mat3 turn = pose.orientation.toRotationMatrix();
        std::vector<Vec3> moved;
        moved.reserve(mesh.vertices.size());
        for (const Vec3& v : mesh.vertices)
            moved.push_back(
                (turn * v + pose.positionMm - Vec3(kFromX, kFromY, 0.0)).cwiseProduct(Vec3(kPerMm, kPerMm, sign_)));
        for (const geometry::Triangle& t : mesh.triangles) {
            // Upside down they run the other way around.
            const Vec3 &a = moved[t[0]], &b = moved[t[sign_ > 0.0 ? 1 : 2]], &c = moved[t[sign_ > 0.0 ? 2 : 1]];
            geometry::heightsUnder(a, b, c, kWide, kDeep, [&](int x, int y, double height) {
                double& z = z_[static_cast<std::size_t>(y * kWide + x)];
                z = std::max(z, height);
            });
        }
    }
    [[nodiscard]] double at(double x, double y) const {
        const double u = (x - kFromX) * kPerMm, v = (y - kFromY) * kPerMm;
        if (!(u >= 0.0 && v >= 0.0 && u < kWide - 1 && v < kDeep - 1)) return kNothing;
        const int i = static_cast<int>(u), j = static_cast<int>(v);
        const double* const z = &z_[static_cast<std::size_t>(j * kWide + i)];
        const double s = u - i, t = v - j;
        return (1.0 - t) * ((1.0 - s) * z[0] + s * z[1]) + t * ((1.0 - s) * z[kWide] + s * z[kWide + 1]);
    }

  private:
    static constexpr double kFromX = -42.0, kFromY = -12.0, kPerMm = 8.0, kNothing = -40.0;
    static constexpr int kWide = 84 * 8, kDeep = 84 * 8;
    double sign_;
    std::vector<double> z_;
};

class Arranger {
  public:
    Arranger(std::span<const cases::Tooth> teeth, const core::Progress& progress)
        : progress_(progress), line_(scaleOf(teeth)) {
        bodies_.reserve(kToothCount);
        for (const cases::Tooth& tooth : teeth)
            bodies_.emplace_back(tooth.outer);
        for (std::size_t i = 0; i < kToothCount; ++i)
            members_.push_back(memberOf(teeth[i], bodies_[i], isUpper(i), 1 + static_cast<int>(i % 8)));
    }

    Arrangement run() {
        // Upper teeth come down onto the lower ones; these then rise to them, and all is placed again.
        placeArch(false);
        placeArch(true);
        for (int round = 0; round < kRounds; ++round) {
            const HeightMap upper = mapOf(true);
            core::parallelFor(kToothCount / 2, 1, [&](std::size_t from, std::size_t to) {
                for (std::size_t i = kToothCount / 2 + from; i < kToothCount / 2 + to; ++i)
                    if (i % 8 >= kFirstThatSettles) settle(i, upper);
            });
            placeArch(false);
            placeArch(true);
        }
        Arrangement made;
        for (std::size_t i = 0; i < kToothCount; ++i)
            made.toothInMouth[i] = poseOf(i);
        made.upperIncisalMm = 0.5 * (edgeOf(0) + edgeOf(8));
        made.lowerIncisalMm = 0.5 * (edgeOf(16) + edgeOf(24));
        made.hingeMm = made.lowerIncisalMm + cases::kBonwillHeightMm * Vec3(0.0, core::cos(cases::kBalkwillRad),
                                                                            core::sin(cases::kBalkwillRad));
        return made;
    }

  private:
    static double scaleOf(std::span<const cases::Tooth> teeth) {
        double widths = 0.0;
        for (std::size_t i = 16; i < kToothCount; ++i)
            if (i % 8 < 6) {
                double least = 1e9, most = -1e9;
                for (const Vec3& v : teeth[i].outer.vertices)
                    if (v.z() > 0.0) least = std::min(least, v.x()), most = std::max(most, v.x());
                widths += most - least;
            }
        return widths / kMeanWidthsMm;
    }
    [[nodiscard]] HeightMap mapOf(bool upper) const {
        HeightMap map(upper ? -1.0 : 1.0);
        for (std::size_t i = upper ? 0 : 16; i < (upper ? 16 : kToothCount); ++i)
            map.add(bodies_[i].mesh, poseOf(i));
        return map;
    }
    /// +1: the patient's left.
    static double sideOf(std::size_t i) { return i / 8 == 1 || i / 8 == 2 ? 1.0 : -1.0; }

    [[nodiscard]] Pose poseOf(std::size_t i) const { return poseOf(i, places_[i]); }
    [[nodiscard]] Pose poseOf(std::size_t i, const Place& at) const {
        const Member& m = members_[i];
        const ArchLine::Place on = line_.at(at.s, sideOf(i));
        const Vec2 stands = on.point + at.asideMm * on.outward;
        Vec3 occlusal = Vec3::UnitZ();  // of the lower arch
        if (m.inCurves) occlusal = Vec3(-on.point.x() / kWilsonRadiusMm, -line_.speeSlope(on.point.y()), 1.0);
        const Vec3 z = (isUpper(i) ? -occlusal : occlusal).normalized();
        const Vec3 mesial = -Vec3(on.distal.x(), on.distal.y(), 0.0);
        const Vec3 x = (mesial - mesial.dot(z) * z).normalized();
        Mat3 base;
        base << x, z.cross(x), z;
        Pose pose;
        pose.orientation = (Quat(base) * m.ownTilt * core::rotationAbout(Vec3::UnitY(), at.mesialDeg * kRad) *
                            core::rotationAbout(Vec3::UnitX(), -m.buccalSign * at.buccalDeg * kRad) *
                            core::rotationAbout(Vec3::UnitZ(), at.turnDeg * kRad))
                               .normalized();
        pose.positionMm =
            Vec3(stands.x(), stands.y(), line_.speeHeight(on.point.y()) + at.upMm) - pose.orientation * m.reference;
        return pose;
    }

    [[nodiscard]] Vec3 edgeOf(std::size_t i) const {
        const Pose pose = poseOf(i);
        Vec3 best = pose.apply(members_[i].occlusal.front());
        for (const Vec3& v : members_[i].occlusal)
            if (const Vec3 p = pose.apply(v); (p.z() > best.z()) != isUpper(i)) best = p;
        best.x() = 0.0;
        return best;
    }

    [[nodiscard]] double gap(std::size_t i, std::size_t j) const {
        return gapBetween(bodies_[i], poseOf(i), bodies_[j], poseOf(j), kLookMm, &closest_[i][j]).distanceMm;
    }
    /// To the lower teeth that an upper one can meet.
    [[nodiscard]] double gapToLower(std::size_t i) const {
        double least = kLookMm;
        const int place = static_cast<int>(i % 8);
        for (std::size_t j = 16; j < kToothCount; ++j) {
            const bool sameSide = sideOf(i) == sideOf(j);
            const int other = static_cast<int>(j % 8);
            if (sameSide ? std::abs(other - place) > 2 : other + place > 1) continue;
            least = std::min(
                least, gapBetween(bodies_[i], poseOf(i), bodies_[j], poseOf(j), least, &closest_[i][j]).distanceMm);
        }
        return least;
    }
    /// Moves `value` until the gap is the one wanted: the gap changes no faster than the value, so that steps as long
    /// as what is left of it do not pass through; slower ones are lengthened.
    template <class Measure>
    void close(double& value, double target, Measure measure) const {
        double before = 0.0, from = 0.0;
        for (int i = 0; i < 40; ++i) {
            const double left = measure() - target;
            if (std::abs(left) < kToleranceMm) return;
            double rate = 1.0;
            if (i > 0 && std::abs(left) < 0.2 && std::abs(before) < 0.4 && value != from)
                rate = std::clamp((left - before) / (value - from), 0.25, 1.0);
            before = left, from = value;
            value -= left / rate;
        }
        for (int i = 0; i < 100 && measure() < 0.0; ++i)
            value += 2.0 * kToleranceMm;
    }

    void placeArch(bool upper) {
        const std::size_t right = upper ? 0 : 24, left = upper ? 8 : 16;
        if (upper) lower_ = mapOf(false);
        for (const std::size_t first : {right, left})
            places_[first].s = members_[first].halfWidth + 0.5;
        for (int round = 0; round < (upper ? 3 : 1); ++round) {
            if (upper)
                core::parallelFor(2, 1, [&](std::size_t from, std::size_t to) {
                    for (std::size_t k = from; k < to; ++k)
                        stopOnLower(k == 0 ? right : left);
                });
            // Both sides by half of what is between them.
            double apart = 0.0;
            const double startRight = places_[right].s, startLeft = places_[left].s;
            close(apart, kContactGapMm, [&] {
                places_[right].s = startRight + 0.5 * apart;
                places_[left].s = startLeft + 0.5 * apart;
                return gap(right, left);
            });
        }
        core::parallelFor(2, 1, [&](std::size_t from, std::size_t to) {
            for (std::size_t k = from; k < to; ++k)
                for (std::size_t i = (k == 0 ? right : left) + 1; i % 8 != 0; ++i)
                    placeBehind(i);
        });
    }

    /// Behind its mesial neighbour, which stands already.
    void placeBehind(std::size_t i) {
        Place& at = places_[i];
        at.s = places_[i - 1].s + members_[i - 1].halfWidth + members_[i].halfWidth + 0.5;
        if (isUpper(i)) at.asideMm = places_[i - 1].asideMm * (i % 8 < 3 ? 1.0 : 0.0);
        const auto toNeighbour = [&] { return gap(i, i - 1); };
        if (!isUpper(i)) {
            close(at.s, kContactGapMm, toNeighbour);
        } else {
            for (int round = 0, free = 4; round <= free; ++round) {
                stopOnLower(i, round < free);
                close(at.s, kContactGapMm, toNeighbour);
                const Vec3 touches = poseOf(i).applyInverse(
                    gapBetween(bodies_[i], poseOf(i), bodies_[i - 1], poseOf(i - 1), kLookMm).pointMm);
                if (touches.z() > kCrownFromMm || i % 8 == 7 || free > 7) continue;
                ++free;
                at.leastMesialDeg = std::max(at.mesialDeg, at.leastMesialDeg) + kClearRootsDeg;
                at.mesialDeg = at.leastMesialDeg;
            }
            stopOnLower(i, false);
        }
        core::report(progress_, static_cast<double>(++placed_) / (28.0 * (1 + kRounds)));
    }

    /// An upper tooth comes down, or from in front back, until it meets the lower ones.
    void stopOnLower(std::size_t i, bool isFree = true) {
        Place& at = places_[i];
        if (const std::size_t place = i % 8; place < kFirstThatSettles) {
            if (isFree) at.upMm = -kOverbites[place], at.asideMm = std::max(at.asideMm, 6.0);
            close(at.asideMm, kOcclusalGapMm, [&] { return gapToLower(i); });
            return;
        }
        if (isFree) settle(i, lower_);
        biteCost(i, at, lower_);
    }

    /// Lets the tooth bite on the other arch at this place, as on springs, until they bear its load, and says what that
    /// costs: how high it stays and what the springs hold, against leaving its place. Its least is where the tooth is
    /// in balance.
    double biteCost(std::size_t i, Place& p, const HeightMap& others) const {
        struct Spring {
            double fromMm, areaMm2;
        };
        const Member& m = members_[i];
        const double sign = isUpper(i) ? 1.0 : -1.0;
        const Pose pose = poseOf(i, (p.upMm = 0.0, p));
        const Mat3 turn = pose.orientation.toRotationMatrix();
        std::vector<Spring> springs;
        double least = 1e9;
        for (std::size_t k = 0; k < m.occlusal.size(); ++k) {
            const Vec3 q = turn * m.occlusal[k] + pose.positionMm;
            const double from = sign * q.z() - others.at(q.x(), q.y());
            least = std::min(least, from);
            if (from < least + kDeepestOverlapMm) springs.push_back({from, m.areaMm2[k]});
        }
        const double bite = i % 8 < 5 ? kPremolarsBiteMm3 : kMolarsBiteMm3;
        double down = least + kDeepestOverlapMm, borne = 0.0, rate = 0.0, held = 0.0;
        const auto press = [&] {
            borne = rate = held = 0.0;
            for (const Spring& s : springs)
                if (const double by = down - s.fromMm; by > 0.0)
                    borne += s.areaMm2 * by, rate += s.areaMm2, held += 0.5 * s.areaMm2 * by * by;
        };
        press();
        // What they bear grows ever faster: Newton's steps from too deep a place stay too deep.
        for (int step = 0; step < 20 && borne > bite + 1e-6; ++step)
            down -= (borne - bite) / rate, press();
        if (!isUpper(i) && !(down >= 0.0 && down <= kMostRiseMm)) down = std::clamp(down, 0.0, kMostRiseMm), press();
        p.upMm = -sign * down;
        const Freedom& freedom = freedomOf(i);
        const auto square = [](double x) { return x * x; };
        return -down + held / bite + freedom.costOfAside * square(p.asideMm) +
               freedom.costOfMesial * square(p.mesialDeg) + freedom.costOfBuccal * square(p.buccalDeg) +
               freedom.costOfTurn * square(p.turnDeg);
    }

    /// The place near its own, the tilt and the turn in which it bites best: where its cusps have found the fossae and
    /// several spots take the load.
    void settle(std::size_t i, const HeightMap& others) {
        Place& at = places_[i];
        const Freedom& freedom = freedomOf(i);
        double best = biteCost(i, at, others);
        double asideStep = 0.4, tiltStep = 2.0;
        for (int halving = 0; halving < 7; ++halving, asideStep *= 0.5, tiltStep *= 0.5)
            for (bool better = true; better;) {
                better = false;
                for (int which = 0; which < 81; ++which) {
                    Place tried = at;
                    tried.asideMm += (which % 3 - 1) * asideStep;
                    tried.mesialDeg += (which / 3 % 3 - 1) * tiltStep;
                    tried.buccalDeg += (which / 9 % 3 - 1) * tiltStep;
                    tried.turnDeg += (which / 27 - 1) * tiltStep;
                    const double leastMesialDeg = std::max(-freedom.mesialDeg, at.leastMesialDeg);
                    if (std::abs(tried.asideMm) > freedom.asideMm || tried.mesialDeg < leastMesialDeg ||
                        tried.mesialDeg > std::max(freedom.mesialDeg, leastMesialDeg) ||
                        std::abs(tried.buccalDeg) > freedom.buccalDeg || std::abs(tried.turnDeg) > freedom.turnDeg)
                        continue;
                    if (const double value = biteCost(i, tried, others); value < best - 1e-5)
                        best = value, at = tried, better = true;
                }
            }
    }

    core::Progress progress_;
    ArchLine line_;
    std::vector<ToothBody> bodies_;
    std::vector<Member> members_;
    std::array<Place, kToothCount> places_;
    /// Of each tooth with each other one; sides that are placed at the same time ask for other pairs.
    mutable std::array<std::array<GapHint, kToothCount>, kToothCount> closest_;
    HeightMap lower_{1.0};
    std::atomic<int> placed_{0};
};

}  // namespace

std::size_t indexOf(int fdi) {
    if (!cases::isPermanentTooth(fdi))
        throw core::Error(fmt::format("{} is no permanent tooth", fdi), "--fdi",
                          "give 11 to 18, 21 to 28, 31 to 38 or 41 to 48");
    return static_cast<std::size_t>(8 * (fdi / 10 - 1) + fdi % 10 - 1);
}

Arrangement arrange(std::span<const cases::Tooth> teeth, const core::Progress& progress) {
    if (teeth.size() != kToothCount)
        throw core::Error(fmt::format("{} teeth cannot be arranged", teeth.size()), "arches", "give all 32");
    return Arranger(teeth, progress).run();
}

Pose opened(const Arrangement& a, double openingMm) {
    if (!(openingMm > 0.0)) return {};
    return cases::openedAbout(a.hingeMm, Vec3::UnitX(), a.upperIncisalMm, a.lowerIncisalMm, openingMm);
}

}  // namespace handpiece::dentition
