// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where the bur touches the tooth.
///
/// Second stage of the tick: device -> [contact] -> force -> cutting. Reads a pose, writes plain results; knows nothing
/// of devices, forces or screens. All in the tooth frame, millimetres, double precision.

#include <cstdint>
#include <limits>

#include "handpiece/base/core/fixed_vector.h"
#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/model/instrument/body_part.h"

namespace handpiece::contact {

/// How a query went. Every value leaves usable results.
enum class Status : std::uint8_t {
    ok,           ///< all that was asked for
    beyondReach,  ///< no surface within reach: depthMm is -reach, a bound only; no normal
    truncated,    ///< a fixed capacity was full; the most important entries were kept (raise the capacity named in the
                  ///< docs)
    invalidPose,  ///< the pose was not finite; results are those of no contact
};

/// What of the instrument touches. Only the bur has patches and a bearing.
using Piece = instrument::BodyPart;

/// How deep the bur is in the tooth, or how far from it.
struct Depth {
    /// - min over x of (phiT(x) + phiB(x)) [mm]: positive when overlapping, zero at touch, minus the distance when
    /// apart.
    double depthMm = -std::numeric_limits<double>::infinity();
    core::Vec3 normal = core::Vec3::Zero();        ///< unit, out of the tooth; zero beyond reach
    core::Vec3 toothPointMm = core::Vec3::Zero();  ///< the surface point of the tooth that decides
    cases::Tissue tissue = cases::Tissue::none;    ///< at that point
    Status status = Status::beyondReach;
    Piece piece = Piece::bur;  ///< of the instrument that decides. A method of one piece says bur, here and below
    std::uint16_t tooth = 0;   ///< index of the tooth that decides. A method of one tooth says 0, here and below
    bool isHeldOnly = false;   ///< by what takes no cut: not the bur, or a tooth that is not to be cut
    double slackMm = 0.0;      ///< Method::slackMm() where the surface has been cut, else zero
    /// How much deeper it could be by what was left unseen, in an uncut tooth, of the bur's axis and of rims deeper
    /// than its radius: zero where that is kDepthToleranceMm at most; more where the work that a tick affords ended.
    double unseenMm = 0.0;
};
inline constexpr double kDepthToleranceMm = 2e-5;

/// A connected piece of the bur's surface within kContactMarginMm of tissue (or inside it).
struct Patch {
    core::Vec3 centreMm = core::Vec3::Zero();  ///< area- and pressure-weighted
    core::Vec3 normal = core::Vec3::Zero();    ///< unit, out of the tooth
    double areaMm2 = 0.0;
    double maxDepthMm = 0.0;     ///< of its points, inside the tooth
    double pressureShare = 0.0;  ///< of all patches, sums to 1: sum of area x s, s = max(0, margin - phiT)
    cases::Tissue tissue = cases::Tissue::none;  ///< that carries most of its pressure
    std::uint16_t tooth = 0;                     ///< whose surface it is on: a patch is of one tooth
};
inline constexpr double kContactMarginMm = 0.02;
inline constexpr std::size_t kMaxPatches = 16;

struct PatchSet {
    core::FixedVector<Patch, kMaxPatches> patches;
    double areaMm2 = 0.0;      ///< of all
    double pressureMm3 = 0.0;  ///< sum of area x s of all: what pressureShare is a share of
    std::array<double, cases::kTissueCount> tissueShare{};  ///< pressure share by tissue, sums to 1 in contact
    Status status = Status::ok;
};

/// A half-space the bur must stay in, linearised at the pose asked about: gapMm + normal . dp >= 0 for a translation
/// dp.
struct Constraint {
    core::Vec3 normal = core::Vec3::Zero();   ///< unit, out of the tooth
    double gapMm = 0.0;                       ///< signed distance of the bur's point there; negative inside
    core::Vec3 pointMm = core::Vec3::Zero();  ///< where on the bur, tooth frame
    cases::Tissue tissue = cases::Tissue::none;
    std::uint16_t tooth = 0;   ///< that holds the bur off
    Piece piece = Piece::bur;  ///< that it holds off
    bool isHeldOnly = false;   ///< as in Depth
};
inline constexpr std::size_t kMaxConstraints = 96;
using ConstraintSet = core::FixedVector<Constraint, kMaxConstraints>;

/// Where something that yields (gingiva) is pressed in by a piece of the instrument.
struct SoftTouch {
    core::Vec3 normal = core::Vec3::Zero();   ///< unit, out of it
    double depthMm = 0.0;                     ///< positive
    core::Vec3 pointMm = core::Vec3::Zero();  ///< on its surface
    cases::Tissue tissue = cases::Tissue::none;
    Piece piece = Piece::bur;
};
inline constexpr std::size_t kMaxSoft = 8;
using SoftSet = core::FixedVector<SoftTouch, kMaxSoft>;

/// How the bur bears on the tooth when it is pushed along a direction: sums over its surface points that face that way
/// and are in contact, by tissue. a: area, w: 1 in contact, falling to 0 at kContactMarginMm above the surface, c:
/// cosine between the bur's outward normal and the direction, rho: distance from the bur's axis, at least
/// `leastRadiusMm`.
struct Bearing {
    std::array<double, cases::kTissueCount> areaMm2{};  ///< sum of a w c
    std::array<double, cases::kTissueCount>
        resistanceMm{};  ///< sum of a w c^2 / rho: load over feed is this / (K omega)
    std::array<core::Vec3, cases::kTissueCount>
        tangentMm{};  ///< sum of a w c t / rho, t the unit direction in which the turning point moves
    Status status = Status::ok;
};

/// One way to find contact between one bur and one tooth. Built off the tick; the methods below run in it.
///
/// Keeps a warm start between calls, so it belongs to one thread; answers do not depend on it beyond 1 nm,
/// on a surface that has been cut beyond 0.5 um.
class Method {
  public:
    virtual ~Method() = default;
    [[nodiscard]] virtual const char* name() const noexcept = 0;

    /// Signed depth, normal and deciding point.
    [[nodiscard]] virtual Depth depth(const core::Pose& burInTooth) noexcept HANDPIECE_REALTIME = 0;

    /// For a bur that only has to come out of the tooth: depth(), or, where that is surely more than `enoughMm`, no
    /// more than a depth that is surely reached, without a normal.
    [[nodiscard]] virtual Depth depthUpTo(double /*enoughMm*/,
                                          const core::Pose& burInTooth) noexcept HANDPIECE_REALTIME {
        return depth(burInTooth);
    }

    /// For whoever wants the deepest of several: depth(), or, where that is surely no more than `floorMm`, beyondReach
    /// with a depth that it surely does not exceed, at least -reach and no more than `floorMm` where that is more.
    [[nodiscard]] virtual Depth depthBeyond(double /*floorMm*/,
                                            const core::Pose& burInTooth) noexcept HANDPIECE_REALTIME {
        return depth(burInTooth);
    }

    /// Contact patches with area and tissue at a pose. A method that knows only depth reports one patch without area.
    virtual void patches(const core::Pose& burInTooth, PatchSet& out) noexcept HANDPIECE_REALTIME;

    /// Half-spaces within `reachMm` of the bur at a pose, enough of them that the bur can slide along every wall it
    /// touches. The default gives the one of depth().
    virtual Status constraints(const core::Pose& burInTooth, double reachMm,
                               ConstraintSet& out) noexcept HANDPIECE_REALTIME;

    /// What yields to the instrument there: it holds nothing off, and pushes back. The default knows of none.
    virtual void yielding(const core::Pose& /*burInTooth*/, SoftSet& out) noexcept HANDPIECE_REALTIME { out.clear(); }

    /// How the bur bears on the tooth when pushed along `direction` (unit, tooth frame); its points count as if it were
    /// `leadMm` farther along it. The default knows nothing of surfaces and reports none.
    virtual void bearing(const core::Pose& burInTooth, const core::Vec3& direction, double leadMm, double leastRadiusMm,
                         Bearing& out) noexcept HANDPIECE_REALTIME;

    /// Another number after the tooth has changed: what was found at the same one still holds.
    [[nodiscard]] virtual std::uint64_t toothVersion() const noexcept HANDPIECE_REALTIME { return 0; }

    /// By how much a surface that has been cut may seem nearer than it is, in depth() and constraints(): so far inside
    /// it a bur may rest, or it would hang in its own cavity, and so far behind the bur the cutter may be.
    [[nodiscard]] virtual double slackMm() const noexcept HANDPIECE_REALTIME { return 0.0; }

    /// Whether the surface near the bur is one that cutting has left: rough by fractions of a micron, in a field.
    [[nodiscard]] virtual bool isCutNear(const core::Pose& /*burInTooth*/) const noexcept HANDPIECE_REALTIME {
        return false;
    }

    /// The bur has cut here, so nothing of the tooth is in it: what a method reads between its samples may not say
    /// otherwise. Holds until the tooth changes.
    virtual void noteCut(const core::Pose& /*burInTooth*/) noexcept HANDPIECE_REALTIME {}

    /// Forget the warm start (after a jump).
    virtual void reset() noexcept {}
};

}  // namespace handpiece::contact
