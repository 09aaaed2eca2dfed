// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A pointer that is led along a path over a tooth, with the hand, the tick and the window's knowledge of the tooth
/// behind it, without window and threads: what the bur did, in numbers.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/app/input/pointer_controller.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/senses/measure/tooth_probe.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/force/proxy.h"

namespace handpiece::input {

inline constexpr double kEventS = 0.008, kPictureS = 1.0 / 30.0;

/// Where the pointer is at a time [s]; the button is down from `pressS` to `releaseS`.
struct PointerPath {
    std::string name;
    std::function<core::Vec2(double)> at;
    double pressS = 0.3, releaseS = 1.0, endS = 1.3;
};

struct CourseFigures {
    double targetOffPx = 0.0;  ///< of the hand's target from the pointer's ray, at most
    double tipOffMm = 0.0;     ///< of the tip from the pointer's ray while pressed and the pointer is slow, at most
    double tipOffPx = 0.0;
    double notNearestMm = 0.0;  ///< of the bur from the nearest place that tissue allows, at most
    double idleS = 0.0;         ///< pressed, neither touching nor cutting, and nobody said why
    double pressedS = 0.0;
    double removedMm3 = 0.0;
    double mostLoadN = 0.0, heldLoadN = 0.0;  ///< at the end of the press
    double deepestMm = 0.0;                   ///< of the bur's travel along the ray beyond the first touch
};

/// The window's side and the tick's, one after the other.
class PointerCourse {
  public:
    PointerCourse(simulation::SimulationSetup made, view::StandardView eye, int buccalSign, double crownShare,
                  view::Viewport port = {900, 700})
        : station(std::move(made)), mirror(station.tooth), first(station.tooth), probe(mirror), viewport(port) {
        core::Box box = station.tooth->outer.bounds();
        const core::Pose start = startPose(box, 36, buccalSign);
        box.min.z() = box.max.z() - crownShare * box.size().z();
        camera = view::standardView(eye, box, buccalSign, viewport);
        // With buccal at the top: the places of the courses were chosen so.
        if (eye == view::StandardView::occlusal) camera.up = -camera.up;
        mailbox = std::make_shared<device::PointerMailbox>();
        hand = std::make_unique<PointerController>(
            mailbox, start, [this](const view::Ray& ray) { return probe.cast(ray.originMm, ray.direction); });
        loop = std::make_unique<loop::HapticLoop>(
            loop::LoopSettings{},
            std::make_unique<device::PointerDevice>(device::PointerHandSettings{}, mailbox, start), station.work(),
            force::defaultParameters());
        hand->setEye(camera, viewport);
        hand->setFeel(feelUncut(station.tooth, station.settings.bur));
        uncut = contact::makeFieldMethod(station.tooth, station.settings.bur);
        now = contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(station.field), station.settings.bur);
    }
    [[nodiscard]] core::Vec2 pixel(const core::Vec3& p) const { return view::pixelOf(camera, viewport, p).value(); }
    [[nodiscard]] core::Vec3 tip() const { return core::Vec3(last.proxyPositionMm.data()); }
    [[nodiscard]] core::Vec3 tipOff(const core::Vec2& at) const {
        const view::Ray ray = view::rayThrough(camera, viewport, at);
        const core::Vec3 d = tip() - ray.originMm;
        return d - ray.direction * ray.direction.dot(d);
    }
    /// The point of the uncut tooth under a pixel.
    [[nodiscard]] std::optional<core::Vec3> under(const core::Vec2& at) const {
        const view::Ray ray = view::rayThrough(camera, viewport, at);
        const auto hit = probe.castUncut(ray.originMm, ray.direction);
        if (!hit) return {};
        return hit->pointMm;
    }

    using Look = std::function<void(double timeS, const messages::HapticSample&)>;
    CourseFigures play(const PointerPath& path, const Look& look = {}) {
        CourseFigures figures;
        const double removedBefore = removedMm3();
        const auto ticks = static_cast<int>(std::lround(path.endS / loop->periodS()));
        double nextEvent = 0.0, nextPicture = 0.0, nextNearest = path.pressS + 0.4;
        bool pressed = false;
        core::Vec2 at = path.at(0.0);
        for (int i = 0; i < ticks; ++i) {
            const double t = i * loop->periodS();
            if (t >= nextEvent) {
                nextEvent += kEventS;
                const core::Vec2 to = path.at(t);
                if (to != at || i == 0) hand->move(at = to);
                if (!pressed && t >= path.pressS && t < path.releaseS) {
                    hand->follow(last);
                    hand->press(at, true);
                    pressed = true;
                }
                if (pressed && t >= path.releaseS) {
                    hand->release();
                    pressed = false;
                }
                const device::PointerTarget& target = hand->target();
                if (const auto seen = view::pixelOf(camera, viewport, core::Vec3(target.positionMm));
                    seen && pressed && hand->idle() != PointerController::Idle::onItsWay)
                    figures.targetOffPx = std::max(figures.targetOffPx, (*seen - at).norm());
            }
            if (t >= nextPicture) {
                nextPicture += kPictureS;
                hand->follow(last);
            }
            const double before = removedMm3();
            tick();
            if (look) look(t, last);
            if (!pressed) continue;
            const double loadN = core::Vec3(last.forceN.data()).norm();
            figures.mostLoadN = std::max(figures.mostLoadN, loadN);
            figures.heldLoadN = loadN;
            const bool settled = t > path.pressS + 0.25;
            const bool touches = last.depthMm > 0.0, cuts = removedMm3() > before;
            figures.pressedS += loop->periodS();
            if (settled && !touches && !cuts && saysNothing()) figures.idleS += loop->periodS();
            // The hand is a little behind a pointer that moves, a light one more, and comes to rest half a second after
            // it.
            double speed = 0.0;
            for (const double ago : {0.02, 0.05, 0.1, 0.2, 0.3, 0.5})
                speed = std::max(speed, (path.at(t) - path.at(t - ago)).norm() / ago);
            if (settled && speed < 60.0 && hand->idle() != PointerController::Idle::onItsWay) {
                const double off = tipOff(path.at(t - 0.012)).norm();
                figures.tipOffMm = std::max(figures.tipOffMm, off);
                figures.tipOffPx = std::max(figures.tipOffPx, off / view::mmPerPixel(camera, viewport, tip()));
                if (t >= nextNearest) {
                    nextNearest = t + 0.1;
                    figures.notNearestMm = std::max(figures.notNearestMm, notNearest(path.at(t - 0.012)));
                }
            }
        }
        figures.removedMm3 = removedMm3() - removedBefore;
        return figures;
    }
    void tick() {
        loop->tick({});
        loop->fetch([&](const messages::HapticSample& sample) { last = sample; },
                    [&](const tooth::BrickSnapshot& brick) {
                        mirror.apply(brick);
                        if (firstPass) first.apply(brick);
                    });
    }
    [[nodiscard]] double removedMm3() const {
        double sum = 0.0;
        for (const double v : last.removedMm3)
            sum += v;
        return sum;
    }
    /// How much nearer to the pointer's ray the bur could be, at its own depth, by a way that tissue leaves free.
    [[nodiscard]] double notNearest(const core::Vec2& at) {
        core::Pose here;
        here.positionMm = tip();
        here.orientation =
            core::Quat(last.orientation[0], last.orientation[1], last.orientation[2], last.orientation[3]);
        core::Pose wanted = here;
        wanted.positionMm -= tipOff(at);
        force::Proxy walker{force::ProxySettings{}};
        walker.start(*now, here);
        for (int i = 0; i < 200; ++i) {
            core::Pose next = wanted;
            next.positionMm = here.positionMm + std::min(1.0, i / 100.0) * (wanted.positionMm - here.positionMm);
            walker.update(*now, next, now->depth(next), 1e-3);
        }
        return std::max(
            0.0, (here.positionMm - wanted.positionMm).norm() - (walker.pose().positionMm - wanted.positionMm).norm());
    }
    [[nodiscard]] bool saysNothing() const { return hand->idle() == PointerController::Idle::no; }

    struct Outside {
        double secondMm3 = 0.0, outsideMm3 = 0.0, acrossMm3 = 0.0;
    };
    /// Of what has gone since `firstPass` ended: all of it; farther than this from what had gone before; and that as
    /// seen by the eye, whatever its depth.
    [[nodiscard]] Outside outside(double widenMm = 0.1) const {
        const measure::ToothProbe before(first);
        const auto& whole = station.tooth->field;
        const double h = 0.05;
        const core::Box box = whole.bounds();
        Outside sum;
        const auto gone1 = [&](const core::Vec3& p) {
            return whole.distance(p) < 0.0 && before.signedDistanceMm(p) >= 0.0;
        };
        std::vector<core::Vec3> second, gone;
        const core::Vec3 size = box.size();
        for (double z = 0.5 * h; z < size.z(); z += h) {
            const double height = box.min.z() + z;
            if (height < box.max.z() - 0.7 * size.z()) continue;
            for (double y = 0.5 * h; y < size.y(); y += h)
                for (double x = 0.5 * h; x < size.x(); x += h) {
                    const core::Vec3 p = box.min + core::Vec3(x, y, z);
                    if (whole.distance(p) >= 0.0 || probe.signedDistanceMm(p) < 0.0) continue;
                    (before.signedDistanceMm(p) >= 0.0 ? gone : second).push_back(p);
                }
        }
        const double voxel = h * h * h;
        for (const core::Vec3& p : second) {
            sum.secondMm3 += voxel;
            bool near = false;
            const int n = static_cast<int>(std::ceil(widenMm / (0.5 * h)));
            for (int i = -n; i <= n && !near; ++i)
                for (int j = -n; j <= n && !near; ++j)
                    for (int k = -n; k <= n && !near; ++k) {
                        const core::Vec3 d = 0.5 * h * core::Vec3(i, j, k);
                        if (d.norm() <= widenMm + 1e-9) near = gone1(p + d);
                    }
            if (near) continue;
            sum.outsideMm3 += voxel;
            const core::Vec3 towards = (camera.eyeMm - p).normalized();
            bool under = false;
            for (double up = 0.0; up < 4.0 && !under; up += h)
                for (const double side : {0.0, -widenMm, widenMm})
                    under = under || gone1(p + up * towards + side * camera.right()) ||
                            gone1(p + up * towards + side * camera.upward());
            if (!under) sum.acrossMm3 += voxel;
        }
        return sum;
    }

    simulation::SimulationSetup station;
    tooth::ToothMirror mirror, first;
    measure::ToothProbe probe;
    view::Viewport viewport;
    view::Camera camera;
    std::shared_ptr<device::PointerMailbox> mailbox;
    std::unique_ptr<PointerController> hand;
    std::unique_ptr<loop::HapticLoop> loop;
    std::unique_ptr<contact::Method> uncut, now;
    messages::HapticSample last;
    bool firstPass = true;
};

}  // namespace handpiece::input
