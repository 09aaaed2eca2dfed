// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/mouth_feel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/case/held_aside.h"
#include "handpiece/tick/contact/mouth_method.h"

namespace handpiece::simulation {
namespace {

using core::Pose;
using core::Vec3;
using instrument::Bur;

constexpr double kPointsApartMm = 0.15;  // on the bur, where it is felt in the tooth as it is now
// A bur works with what lies below: so far up, or so many of its radii [judgements].
constexpr double kEndMm = 1.0, kEndRadii = 2.2;
constexpr double kLeastSideMm = 0.3, kBlunt = 1e-3;
constexpr int kStations = 12;

double radiusAt(const Bur& bur, double zMm) {
    double in = 0.0, out = bur.maxRadiusMm() + 0.1;
    if (bur.signedDistance({0.0, 0.0, zMm}) >= 0.0) return 0.0;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (in + out);
        (bur.signedDistance({middle, 0.0, zMm}) < 0.0 ? in : out) = middle;
    }
    return in;
}

/// The bur above its working end, as a solid of its own; null where it is all end.
std::shared_ptr<const Bur> sideOf(const Bur& bur, double& fromMm) {
    fromMm = std::max(kEndMm, kEndRadii * bur.maxRadiusMm());
    const double length = bur.lengthMm() - fromMm;
    if (length < kLeastSideMm) return nullptr;
    instrument::Profile outline;
    core::Vec2 last(0.0, 0.0);
    const auto to = [&](const core::Vec2& next) {
        if ((next - last).norm() > 1e-9) outline.pieces.push_back({last, next});
        last = next;
    };
    for (int i = 0; i <= kStations; ++i) {
        const double z = length * i / kStations;
        to({std::max(radiusAt(bur, fromMm + std::clamp(z, kBlunt, length - kBlunt)), 0.05), z});
    }
    to({0.0, length});
    return std::make_shared<const Bur>("side", std::move(outline));
}

std::vector<Vec3> pointsOf(const Bur& bur) {
    std::vector<Vec3> points;
    const instrument::SurfaceRing* last = nullptr;
    for (const instrument::SurfaceRing& ring : bur.rings()) {
        if (last && core::hypot(ring.zMm - last->zMm, ring.rhoMm - last->rhoMm) < kPointsApartMm && ring.rhoMm > 0.0 &&
            &ring != &bur.rings().back())
            continue;
        last = &ring;
        const double around = 2.0 * std::numbers::pi * ring.rhoMm;
        const int count = std::max(1, static_cast<int>(std::ceil(around / kPointsApartMm)));
        for (int i = 0; i < count; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / count;
            points.emplace_back(ring.rhoMm * core::cos(angle), ring.rhoMm * core::sin(angle), ring.zMm);
        }
    }
    return points;
}

class MouthFeel final : public input::HandFeel {
  public:
    MouthFeel(std::shared_ptr<LiveTooth> tooth, const std::shared_ptr<const Bur>& bur)
        : tooth_(std::move(tooth)), points_(pointsOf(*bur)) {
        const contact::FeltInstrument felt(bur);
        std::vector<contact::PlacedMethod> all, end, body;
        place(felt, all);
        for (contact::PlacedMethod& one : all)
            (one.piece == contact::Piece::bur ? end : body).push_back(std::move(one));
        bur_ = contact::makeMouthMethod(std::move(end), input::kFarClearMm);
        body_ = contact::makeMouthMethod(std::move(body), input::kFarClearMm);
        std::shared_ptr<const Bur> side = sideOf(*bur, sideFromMm_);
        if (!side) return;
        std::vector<contact::PlacedMethod> sides;
        all.clear();
        place(contact::FeltInstrument(std::move(side)), all);
        for (contact::PlacedMethod& one : all)
            if (one.piece == contact::Piece::bur) sides.push_back(std::move(one));
        side_ = contact::makeMouthMethod(std::move(sides), input::kFarClearMm);
    }

    input::Clearance ofBur(const Pose& bur) override {
        const contact::Depth depth = bur_->depth(bur);
        return {-depth.depthMm, depth.tooth, isTooth(depth.tooth)};
    }
    double ofBodyMm(const Pose& bur) override { return -body_->depth(bur).depthMm; }
    double ofSideMm(const Pose& bur) override {
        if (!side_) return input::kFarClearMm;
        return -side_->depth({bur.apply(Vec3(0.0, 0.0, sideFromMm_)), bur.orientation}).depthMm;
    }
    double inStrokeMm(const Pose& bur) override {
        return tooth_->withStrokeStart([&](const measure::ToothProbe& probe) {
            double nearest = input::kFarClearMm;
            for (const Vec3& point : points_)
                nearest = std::min(nearest, probe.signedDistanceMm(bur.apply(point)));
            return nearest;
        });
    }
    void beginStroke() override { tooth_->beginStroke(); }

  private:
    [[nodiscard]] static bool isHeldAside(const StandingTooth& one) {
        const auto& names = cases::kHeldAside;
        return std::find(names.begin(), names.end(), one.model->name) != names.end();
    }
    [[nodiscard]] bool isTooth(std::uint16_t number) const {
        if (number == 0) return true;
        const StandingTooth& one = tooth_->standing()[number - 1u];
        return !one.isYielding && !one.isBone;
    }
    /// What yields is met like all else: a hand hovers over gingiva, too.
    void place(const contact::FeltInstrument& felt, std::vector<contact::PlacedMethod>& to) const {
        contact::FeltInstrument::Standing plain;
        plain.isPlain = true;
        felt.place(tooth_->modelShared(), plain, to);
        const std::vector<StandingTooth>& others = tooth_->standing();
        for (std::size_t i = 0; i < others.size(); ++i) {
            if (isHeldAside(others[i])) continue;
            plain.inScene = others[i].inCase;
            plain.tooth = static_cast<std::uint16_t>(i + 1);
            felt.place(others[i].model, plain, to);
        }
    }

    std::shared_ptr<LiveTooth> tooth_;
    std::vector<Vec3> points_;
    double sideFromMm_ = 0.0;
    std::unique_ptr<contact::Method> bur_, body_, side_;
};

}  // namespace

std::shared_ptr<input::HandFeel> feelMouth(std::shared_ptr<LiveTooth> tooth, std::shared_ptr<const Bur> bur) {
    if (tooth == nullptr || bur == nullptr) return {};
    return std::make_shared<MouthFeel>(std::move(tooth), bur);
}

}  // namespace handpiece::simulation
