// SPDX-License-Identifier: Apache-2.0
#include "studies/scripted_hand.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/cutting/cutter.h"
#include "studies/cut_run.h"

namespace handpiece::studies {
namespace {

using core::Quat;
using core::Vec2;
using core::Vec3;

constexpr double kMeetsMm = 0.02;  // less of the tooth than this is nothing to cut
constexpr double kOfLeeway = 0.25;
constexpr double kKeptOffMm = 0.05;  // from what must stay
constexpr double kSlackMm = 0.008;   // between two places that were sought to 5 um
constexpr double kSpinUpS = 0.8;

/// The scene on a grid whose z is the path of draw, and the bur in it.
class Plan {
  public:
    Plan(const HandScene& scene, const instrument::Bur& bur, const PlanOptions& o) : scene_(scene), o_(o) {
        turn_ = core::rotationBetween(Vec3::UnitZ(), scene.draw);
        core::Box box;
        for (int i = 0; i < 8; ++i)
            box.extend(turn_.conjugate() * Vec3(i & 1 ? scene.box.max.x() : scene.box.min.x(),
                                                i & 2 ? scene.box.max.y() : scene.box.min.y(),
                                                i & 4 ? scene.box.max.z() : scene.box.min.z()));
        const double side = 2.0 * bur.maxRadiusMm() + 3.0 * o.cellMm;
        low_ = box.min - Vec3(side, side, 4.0 * o.cellMm);
        top_ = box.max.z() + 0.3;
        const Vec3 high(box.max.x() + side, box.max.y() + side, top_ + bur.lengthMm() + 2.0 * o.cellMm);
        for (int k = 0; k < 3; ++k)
            count_[static_cast<std::size_t>(k)] = static_cast<int>(std::ceil((high[k] - low_[k]) / o.cellMm)) + 1;
        first_ = box.min.head<2>() - Vec2::Constant(bur.maxRadiusMm() + o.cellMm);
        last_ = box.max.head<2>() + Vec2::Constant(bur.maxRadiusMm() + o.cellMm);
        lowest_ = box.min.z() - o.cellMm;
        sampleBur(bur);
        sampleScene();
    }

    device::Motion motion() {
        const int layers = std::max(1, static_cast<int>(std::ceil((top_ - lowest_) / o_.layerMm)));
        bool back = false;
        for (int layer = 0; layer <= layers; ++layer) {
            const double z = top_ - (top_ - lowest_) * layer / layers;
            for (const bool alongX : {true, false})
                for (const Stroke& stroke : rowsAt(z, alongX)) {
                    go(stroke, back);
                    back = !back;
                }
        }
        for (const Stroke& stroke : floorRows()) {
            go(stroke, back);
            back = !back;
        }
        if (poses_.empty())
            throw core::Error("this bur does not fit into what is to be cut", "scripted hand", "take a thinner one");
        moveTo(raised(poses_.back()), o_.airMmS);
        std::vector<device::TimedPose> timed;
        double t = 0.0;
        const auto add = [&](const Vec3& at, double pedal) { timed.push_back({t, {turn_ * at, turn_}, pedal}); };
        add(poses_.front(), 1.0);
        t += kSpinUpS;
        add(poses_.front(), 1.0);
        for (std::size_t i = 1; i < poses_.size(); ++i) {
            const double way = (poses_[i] - poses_[i - 1]).norm();
            if (way < 1e-6) continue;
            t += way / speeds_[i];
            add(poses_[i], 1.0);
        }
        t += 0.001;
        add(poses_.back(), 0.0);
        t += 0.2;
        add(poses_.back(), 0.0);
        return device::Motion(std::move(timed));
    }

  private:
    using Stroke = std::vector<Vec3>;

    void sampleBur(const instrument::Bur& bur) {
        const double step = std::max(0.1, o_.cellMm);
        const auto ring = [&](double rho, double z) {
            const int around = rho < 1e-6 ? 1 : std::max(8, static_cast<int>(std::ceil(6.2832 * rho / (1.5 * step))));
            for (int i = 0; i < around; ++i) {
                const double rad = 6.283185307179586 * i / around;
                bur_.emplace_back(rho * core::cos(rad), rho * core::sin(rad), z);
            }
        };
        for (const instrument::ProfilePiece& piece : bur.profile().pieces) {
            if (!piece.isArc) {
                const int n = std::max(1, static_cast<int>(std::ceil((piece.to - piece.from).norm() / step)));
                for (int i = 0; i <= n; ++i) {
                    const Vec2 p = piece.from + (piece.to - piece.from) * (static_cast<double>(i) / n);
                    ring(std::max(0.0, p.x()), p.y());
                }
                continue;
            }
            const Vec2 a = piece.from - piece.centre, b = piece.to - piece.centre;
            const double from = core::atan2(a.y(), a.x());
            double turn = core::atan2(b.y(), b.x()) - from;
            while (turn > 3.141592653589793)
                turn -= 6.283185307179586;
            while (turn < -3.141592653589793)
                turn += 6.283185307179586;
            const int n = std::max(2, static_cast<int>(std::ceil(std::abs(turn) * piece.radiusMm / step)));
            for (int i = 0; i <= n; ++i) {
                const double rad = from + turn * i / n;
                const Vec2 p = piece.centre + piece.radiusMm * Vec2(core::cos(rad), core::sin(rad));
                ring(std::max(0.0, p.x()), p.y());
            }
        }
    }

    void sampleScene() {
        const auto nx = static_cast<std::size_t>(count_[0]), ny = static_cast<std::size_t>(count_[1]),
                   nz = static_cast<std::size_t>(count_[2]);
        past_.assign(nx * ny * nz, 0.0f);
        tooth_.assign(past_.size(), 0.0f);
        core::parallelFor(nz, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                for (std::size_t j = 0; j < ny; ++j)
                    for (std::size_t i = 0; i < nx; ++i) {
                        const Vec3 p = turn_ * (low_ + o_.cellMm * Vec3(static_cast<double>(i), static_cast<double>(j),
                                                                        static_cast<double>(k)));
                        const double tooth = scene_.toothMm(p);
                        // In the air all may be cut.
                        double past = -tooth;
                        if (tooth < 2.0 * o_.cellMm) past = std::min(past, scene_.asideMm(p));
                        if (scene_.othersMm) past = std::max(past, o_.clearanceMm - scene_.othersMm(p));
                        const std::size_t n = i + nx * (j + ny * k);
                        past_[n] = static_cast<float>(past);
                        tooth_[n] = static_cast<float>(tooth);
                    }
        });
    }
    [[nodiscard]] double lookup(const std::vector<float>& values, const Vec3& p) const {
        const Vec3 at = (p - low_) / o_.cellMm;
        int cell[3];
        double w[3];
        for (int k = 0; k < 3; ++k) {
            cell[k] = std::clamp(static_cast<int>(std::floor(at[k])), 0, count_[static_cast<std::size_t>(k)] - 2);
            w[k] = std::clamp(at[k] - cell[k], 0.0, 1.0);
        }
        const auto nx = static_cast<std::size_t>(count_[0]), ny = static_cast<std::size_t>(count_[1]);
        double sum = 0.0;
        for (int c = 0; c < 8; ++c) {
            const std::size_t n =
                static_cast<std::size_t>(cell[0] + (c & 1)) + nx * (static_cast<std::size_t>(cell[1] + (c >> 1 & 1)) +
                                                                    ny * static_cast<std::size_t>(cell[2] + (c >> 2)));
            sum += static_cast<double>(values[n]) * ((c & 1) != 0 ? w[0] : 1.0 - w[0]) *
                   ((c & 2) != 0 ? w[1] : 1.0 - w[1]) * ((c & 4) != 0 ? w[2] : 1.0 - w[2]);
        }
        return sum;
    }
    [[nodiscard]] bool fits(const Vec3& tip, double slackMm = 0.0) const {
        return std::none_of(bur_.begin(), bur_.end(), [&](const Vec3& b) { return lookup(past_, tip + b) > slackMm; });
    }
    [[nodiscard]] bool meetsTooth(const Vec3& tip) const {
        return std::any_of(bur_.begin(), bur_.end(),
                           [&](const Vec3& b) { return lookup(tooth_, tip + b) < -kMeetsMm; });
    }
    [[nodiscard]] bool fitsAlong(const Vec3& from, const Vec3& to) const {
        const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / (0.5 * o_.cellMm))));
        for (int i = 0; i <= steps; ++i)
            if (!fits(from + (to - from) * (static_cast<double>(i) / steps), kSlackMm)) return false;
        return true;
    }
    [[nodiscard]] Vec3 raised(const Vec3& tip) const { return {tip.x(), tip.y(), top_ + 1.0}; }

    /// From a place where it fits towards one where it does not.
    [[nodiscard]] Vec3 lastFit(Vec3 in, Vec3 out) const {
        constexpr double kEndMm = 0.005;
        while ((out - in).norm() > kEndMm) {
            const Vec3 middle = 0.5 * (in + out);
            (fits(middle) ? in : out) = middle;
        }
        return in;
    }
    [[nodiscard]] std::vector<Stroke> rowsAt(double z, bool alongX) const {
        const int a = alongX ? 0 : 1, b = 1 - a;
        const int rows = static_cast<int>(std::ceil((last_[b] - first_[b]) / o_.rowMm)) + 1;
        const int steps = static_cast<int>(std::ceil((last_[a] - first_[a]) / o_.cellMm)) + 1;
        std::vector<std::vector<Stroke>> found(static_cast<std::size_t>(rows));
        core::parallelFor(found.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t row = begin; row < end; ++row) {
                const auto at = [&](int i) {
                    Vec3 p;
                    p[a] = first_[a] + i * o_.cellMm, p[b] = first_[b] + static_cast<double>(row) * o_.rowMm, p.z() = z;
                    return p;
                };
                constexpr int kNone = -1;
                int from = kNone, firstMet = kNone, lastMet = kNone;
                for (int i = 0; i <= steps; ++i) {
                    const bool isIn = i < steps && fits(at(i));
                    if (isIn && from == kNone) from = i, firstMet = kNone;
                    if (isIn && meetsTooth(at(i))) {
                        if (firstMet == kNone) firstMet = i;
                        lastMet = i;
                    }
                    if (isIn || from == kNone) continue;
                    if (firstMet != kNone) {
                        Vec3 start = at(firstMet), stop = at(lastMet);
                        if (firstMet == from && from > 0) start = lastFit(start, at(from - 1));
                        if (lastMet == i - 1 && i < steps) stop = lastFit(stop, at(i));
                        found[row].push_back({start, stop});
                    }
                    from = kNone;
                }
            }
        });
        std::vector<Stroke> strokes;
        for (auto& some : found)
            strokes.insert(strokes.end(), some.begin(), some.end());
        return strokes;
    }
    /// Along x over the lowest places that can be come to from above.
    [[nodiscard]] std::vector<Stroke> floorRows() const {
        const double rowMm = 0.5 * o_.rowMm;
        const int rows = static_cast<int>(std::ceil((last_.y() - first_.y()) / rowMm)) + 1;
        const int steps = static_cast<int>(std::ceil((last_.x() - first_.x()) / o_.cellMm)) + 1;
        std::vector<std::vector<Stroke>> found(static_cast<std::size_t>(rows));
        core::parallelFor(found.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t row = begin; row < end; ++row) {
                Stroke stroke;
                const auto close = [&] {
                    if (stroke.size() > 1) found[row].push_back(stroke);
                    stroke.clear();
                };
                for (int i = 0; i < steps; ++i) {
                    Vec3 p(first_.x() + i * o_.cellMm, first_.y() + static_cast<double>(row) * rowMm, top_);
                    bool isFree = fits(p);
                    while (isFree && p.z() > lowest_) {
                        const Vec3 next = p - Vec3(0.0, 0.0, o_.cellMm);
                        if (!fits(next)) {
                            p = lastFit(p, next);
                            break;
                        }
                        p = next;
                    }
                    // Far from the tooth there is no floor.
                    if (!isFree || p.z() <= lowest_ || !meetsTooth(p)) {
                        close();
                        continue;
                    }
                    if (!stroke.empty() && !fitsAlong(stroke.back(), p)) close();
                    stroke.push_back(p);
                }
                close();
            }
        });
        std::vector<Stroke> strokes;
        for (auto& some : found)
            strokes.insert(strokes.end(), some.begin(), some.end());
        return strokes;
    }

    void moveTo(const Vec3& p, double mmS) {
        poses_.push_back(p);
        speeds_.push_back(mmS);
    }
    /// From where one can go straight out: there, or the nearest such place in the same layer.
    [[nodiscard]] std::optional<Vec3> wayOut(const Vec3& from) const {
        if (fitsAlong(from, raised(from))) return from;
        for (double r = o_.cellMm; r < 1.5; r += o_.cellMm)
            for (int i = 0; i < 16; ++i) {
                const double rad = 6.283185307179586 * i / 16;
                const Vec3 p = from + r * Vec3(core::cos(rad), core::sin(rad), 0.0);
                if (fits(p) && fitsAlong(from, p) && fitsAlong(p, raised(p))) return p;
            }
        return {};
    }
    void go(Stroke stroke, bool back) {
        if (back) std::reverse(stroke.begin(), stroke.end());
        if (poses_.empty() || !fitsAlong(poses_.back(), stroke.front())) {
            const auto in = wayOut(stroke.front());
            if (!in) return;  // it cannot be come to
            if (!poses_.empty()) {
                if (const auto out = wayOut(poses_.back())) moveTo(*out, o_.feedMmS);
                moveTo(raised(poses_.back()), o_.airMmS);
            }
            moveTo(raised(*in), o_.airMmS);
            moveTo(*in, o_.feedMmS);
        }
        for (const Vec3& p : stroke)
            moveTo(p, o_.feedMmS);
    }

    const HandScene& scene_;
    const PlanOptions& o_;
    Quat turn_;
    Vec3 low_;
    Vec2 first_, last_;
    double top_ = 0.0, lowest_ = 0.0;
    std::array<int, 3> count_{};
    std::vector<Vec3> bur_;
    std::vector<float> past_, tooth_;
    std::vector<Vec3> poses_;
    std::vector<double> speeds_;
};

}  // namespace

device::Motion planPreparation(const HandScene& scene, const instrument::Bur& bur, const PlanOptions& options) {
    return Plan(scene, bur, options).motion();
}

HandScene handSceneOf(const preparation::Laid& laid, std::function<double(const Vec3&)> others) {
    HandScene scene;
    // A round tip leaves corners: a little of the leeway is taken for that.
    const double beyond = kOfLeeway * std::min(laid.zones->leeway().sideMm, laid.zones->leeway().floorMm);
    scene.asideMm = [zones = laid.zones, beyond](const Vec3& p) {
        const zones::Zones::Distances d = zones->distancesMm(p);
        return std::max(d.target - beyond, kKeptOffMm - d.kept);
    };
    scene.toothMm = [whole = laid.whole](const Vec3& p) { return whole->signedDistance(p); };
    scene.othersMm = std::move(others);
    scene.box = laid.zones->box();
    scene.draw = laid.draw;
    return scene;
}

device::Motion withPlunge(const device::Motion& motion, const Vec3& placeMm, const Vec3& draw, double beyondMm,
                          double fromMm) {
    std::vector<device::TimedPose> poses = motion.poses();
    const Quat turn = core::rotationBetween(Vec3::UnitZ(), draw);
    double t = poses.back().timeS;
    const auto add = [&](const Vec3& at, double afterS, double pedal) {
        t += afterS;
        poses.push_back({t, {at, turn}, pedal});
    };
    const Vec3 above = placeMm + fromMm * draw, under = placeMm - beyondMm * draw;
    add(above, 2.0, 0.0);
    add(above, 0.5, 1.0);
    add(placeMm + 6.0 * draw, 1.0, 1.0);
    add(under, 4.0, 1.0);
    add(above, 2.0, 1.0);
    add(above, 0.2, 0.0);
    return device::Motion(std::move(poses));
}

device::Motion withUnsteadiness(const device::Motion& motion, const Steadiness& hand, std::uint64_t seed) {
    return withNoise(motion, {{hand.tremorMm, 8.0, 12.0}, {hand.driftMm, 0.05, 0.5}}, 0.02, seed);
}

void sweep(const simulation::SimulationSetup& station, const device::Motion& motion) {
    std::vector<cutting::CutTooth> teeth{{station.field, {}}};
    for (const simulation::StandingTooth& other : station.others)
        if (other.field) teeth.push_back({other.field, other.inCase});
    cutting::Cutter cutter(std::move(teeth), station.settings.bur, station.settings.cuttingParameters,
                           station.settings.tissues, {true});
    const auto method = contact::makeFieldMethod(station.field, station.settings.bur);
    // Between two places the bur is swept along a straight line without turning: no step is longer than this.
    constexpr double kStepMm = 0.2, kStepRad = 0.02;
    const std::vector<device::TimedPose>& poses = motion.poses();
    cutting::CutInput input;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const core::Pose& to = poses[i].burInTooth;
        const core::Pose& from = i == 0 ? to : poses[i - 1].burInTooth;
        const double turnRad = core::angleBetween(from.orientation, to.orientation);
        const int steps = std::max(1, static_cast<int>(std::ceil(std::max(
                                          (to.positionMm - from.positionMm).norm() / kStepMm, turnRad / kStepRad))));
        for (int k = 1; k <= steps; ++k) {
            const double share = static_cast<double>(k) / steps;
            input.deviceInTooth = {from.positionMm + share * (to.positionMm - from.positionMm),
                                   core::interpolated(from.orientation, share, to.orientation)};
            input.proxyInTooth = input.deviceInTooth;
            input.speedRadS = poses[i].pedal > 0.0 && (i == 0 || poses[i - 1].pedal > 0.0) ? 1.0 : 0.0;
            (void)cutter.cut(*method, input);
        }
    }
}

}  // namespace handpiece::studies
