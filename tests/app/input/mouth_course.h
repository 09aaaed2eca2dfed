// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A pointer that is led about a whole mouth, with hand, tick, contact and cutting behind it, without window and
/// threads: where the bur was, what the hand bore on, what was cut that nobody had drawn.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/app/course/kept_cases.h"
#include "handpiece/app/input/line_of_sight.h"
#include "handpiece/app/input/pointer_controller.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/app/simulation/mouth_feel.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/tick/device/passing_device.h"
#include "handpiece/tick/force/proxy.h"

namespace handpiece::input {

/// Made once: cut and healed again.
struct Mouth {
    /// Kept in `folder`, with its fields: made there when it is not yet.
    Mouth(int fdi, const std::filesystem::path& folder) : number(fdi) {
        whole = course::keptMouth(fdi, {}, folder);
        simulation::SimulationSettings settings;
        settings.field = simulation::fieldSettingsAt(0.1);
        settings.bur = instrument::makeInstrument("330").bur;
        station = simulation::makeSimulation(whole, settings, true);
        live = std::make_shared<simulation::LiveTooth>(station, tooth::StateDelta{});
    }
    int number;
    cases::Case whole;
    simulation::SimulationSetup station;
    std::shared_ptr<simulation::LiveTooth> live;
};

/// What a person does: the pointer's place at a time [s], pressed from `pressS` to `releaseS`.
struct MouthWay {
    std::string name, bur = "330";
    view::StandardView eye = view::StandardView::occlusal;
    std::function<core::Vec2(double)> at;
    double pressS = 0.4, releaseS = 1.4, endS = 1.8;
    double againS = 1e9;  ///< pressed once more from then on, to the end
    double loadN = 1.0;
    DepthLimits limits{kFirstStopMm, kFirstPerPassMm};
    bool isLeftHanded = false, turns = true;
};

struct MouthFigures {
    double notNearestMm = 0.0;  ///< at the end of the press: by how much the bur could be nearer to the pointer's ray
    double offMm = 0.0;         ///< of the tip from it then
    PointerController::Idle said = PointerController::Idle::no;  ///< then
    int tooHard = 0;                                             ///< samples that bore more than 1.1 times the load
    double mostN = 0.0, mostAwayMm = 0.0;                        ///< of the hand from the bur
    double removedMm3 = 0.0, outsideMm3 = 0.0;  ///< of the tooth worked on; what lies outside of what was drawn
    double othersMm3 = 0.0;                     ///< of other teeth
    double pathMm = 0.0, drawnMm = 0.0;         ///< of the hand while pressed; of the places under the pointer
    std::vector<core::Pose> floor;              ///< where it cut
};

class MouthCourse {
  public:
    MouthCourse(Mouth& mouth, const MouthWay& way) : mouth_(mouth), way_(way) {
        const instrument::Instrument instrument = instrument::makeInstrument(way.bur);
        mouth_.station.settings.bur = instrument.bur;
        mouth_.station.settings.cuttingParameters = instrument.cuttingParameters;
        mouth_.station.renewFields();
        core::Box box = mouth_.station.tooth->outer.bounds();
        const core::Pose start = startPose(box, mouth_.number, mouth_.whole.buccalSign);
        box.min.z() = box.max.z() - 0.42 * box.size().z();
        camera = view::standardView(way.eye, box, mouth_.whole.buccalSign, viewport);
        auto mailbox = std::make_shared<device::PointerMailbox>();
        hand = std::make_unique<PointerController>(mailbox, start, [this](const view::Ray& ray) {
            return mouth_.live->withProbe(
                [&](const measure::ToothProbe& probe) { return probe.cast(ray.originMm, ray.direction); });
        });
        auto watched = std::make_unique<Watched>(
            std::make_shared<device::PointerDevice>(device::PointerHandSettings{}, mailbox, start));
        device_ = watched.get();
        loop = std::make_unique<loop::HapticLoop>(loop::LoopSettings{}, std::move(watched), mouth_.station.work(),
                                                  force::defaultParameters());
        now_ = mouth_.station.work().method;
        hand->setEye(camera, viewport);
        feel = simulation::feelMouth(mouth_.live, instrument.bur);
        hand->setFeel(feel);
        if (way.isLeftHanded) hand->turnHandle(core::Vec3(0.5, mouth_.whole.buccalSign > 0 ? -1.0 : 1.0, 0.3));
        hand->faceEye();
        hand->setLoad(way.loadN);
        hand->setStop(way.limits.stopMm);
        hand->setPerPass(way.limits.perPassMm);
    }
    ~MouthCourse() {
        mouth_.live->refresh();
        mouth_.live->apply(tooth::changeBetween(mouth_.live->state({}), {}));
        mouth_.live->refresh();
    }

    MouthFigures play() {
        MouthFigures f;
        const double periodS = loop->periodS();
        double nextEvent = 0.0, nextPicture = 0.0;
        bool pressed = false;
        std::optional<core::Vec2> at;
        core::Vec3 before = core::Vec3::Zero();
        for (int i = 0; i * periodS < way_.endS; ++i) {
            const double t = i * periodS;
            if (t >= nextPicture) {
                nextPicture += 1.0 / 30.0;
                mouth_.live->refresh();
                hand->follow(last);
            }
            if (t >= nextEvent) {
                nextEvent += 0.008;
                const core::Vec2 to = way_.at(t);
                if (!at || to != *at) hand->move(to);
                at = to;
                if (!pressed && t >= way_.pressS && t < way_.releaseS) {
                    hand->press(to, way_.turns);
                    pressed = true;
                }
                if (!pressed && t >= way_.againS) {
                    began_.reset();
                    hand->press(to, way_.turns);
                    pressed = true;
                }
                if (pressed && t >= way_.releaseS && (t < way_.againS || t + 0.01 >= way_.endS)) {
                    finish(to, f);
                    hand->release();
                    pressed = false;
                }
                if (pressed) draw(to, f);
            }
            loop->tick({});
            loop->fetch([&](const messages::HapticSample& sample) { last = sample; },
                        [&](const tooth::BrickSnapshot& brick) { mouth_.live->hear(brick); });
            const core::Vec3 hand_(last.positionMm.data()), tip(last.proxyPositionMm.data());
            f.mostN = std::max(f.mostN, device_->bearingN);
            f.tooHard += device_->bearingN > 1.1 * way_.loadN;
            f.mostAwayMm = std::max(f.mostAwayMm, (hand_ - tip).norm());
            if (pressed && i > 0) f.pathMm += (hand_ - before).norm();
            before = hand_;
            if ((last.flags & messages::kCutting) != 0) f.floor.push_back(proxy());
            if (look) look(t, last);
        }
        mouth_.live->refresh();
        for (const double v : last.removedMm3)
            f.removedMm3 += v;
        f.othersMm3 = last.removedOthersMm3;
        f.outsideMm3 = outsideMm3(f.floor);
        return f;
    }

    [[nodiscard]] core::Quat tilt() const { return proxy().orientation; }
    std::function<void(double, const messages::HapticSample&)> look;
    view::Viewport viewport{900, 700};
    view::Camera camera;
    std::unique_ptr<PointerController> hand;
    std::unique_ptr<loop::HapticLoop> loop;
    std::shared_ptr<HandFeel> feel;
    messages::HapticSample last;

  private:
    struct Watched final : device::PassingDevice {
        explicit Watched(std::shared_ptr<device::Device> inner) : PassingDevice(std::move(inner)) {}
        void watch(const core::Vec3& tipMm, const core::Vec3& forceN) noexcept override {
            bearingN = forceN.norm();
            PassingDevice::watch(tipMm, forceN);
        }
        double bearingN = 0.0;
    };
    /// A place that was drawn: the bur's tip there may be anywhere between.
    struct Drawn {
        core::Vec3 fromMm, toMm;
        core::Quat orientation;
    };

    [[nodiscard]] core::Pose proxy() const {
        core::Pose pose;
        pose.positionMm = core::Vec3(last.proxyPositionMm.data());
        const auto& q = last.proxyOrientation;
        pose.orientation = core::Quat(q[0], q[1], q[2], q[3]);
        return pose;
    }

    /// The place under the pointer, on what the stroke began on, in the recorded tilt.
    void draw(const core::Vec2& pixel, MouthFigures& f) {
        const core::Quat tilt = proxy().orientation;
        const Leading leading(*feel, tilt);
        const LineOfSight sight = leading.alongRay(view::rayThrough(camera, viewport, pixel), kHoverMm, 300.0);
        if (!sight.touchAt) return;
        if (!began_) began_ = sight.what;
        if (sight.what != *began_) return;
        const double cosine = std::clamp(-sight.ray.direction.dot(leading.axis()), 0.5, 1.0);
        double deepMm = kReachMm;
        if (way_.limits.stopMm) deepMm = std::min(deepMm, 3.0 * *way_.limits.stopMm);
        if (way_.limits.perPassMm) deepMm = std::min(deepMm, *way_.limits.perPassMm / cosine);
        const core::Vec3 touch = sight.at(*sight.touchAt);
        if (!drawn_.empty()) f.drawnMm += (touch - drawn_.back().fromMm).norm();
        drawn_.push_back({touch, sight.at(*sight.touchAt + deepMm), tilt});
    }

    void finish(const core::Vec2& pixel, MouthFigures& f) {
        f.said = hand->idle();
        const view::Ray ray = view::rayThrough(camera, viewport, pixel);
        core::Pose here = proxy();
        const core::Vec3 d = here.positionMm - ray.originMm;
        const core::Vec3 off = d - ray.direction * ray.direction.dot(d);
        f.offMm = off.norm();
        core::Pose wanted = here;
        wanted.positionMm -= off;
        force::Proxy walker{force::ProxySettings{}};
        walker.start(*now_, here);
        for (int i = 0; i < 200; ++i) {
            core::Pose next = wanted;
            next.positionMm = here.positionMm + std::min(1.0, i / 100.0) * (wanted.positionMm - here.positionMm);
            walker.update(*now_, next, now_->depth(next), 1e-3);
        }
        f.notNearestMm = std::max(0.0, f.offMm - (walker.pose().positionMm - wanted.positionMm).norm());
    }

    /// Of what has gone: farther than 0.2 mm from every place that was drawn.
    [[nodiscard]] double outsideMm3(const std::vector<core::Pose>& tips) const {
        constexpr double kGrownMm = 0.2, h = 0.1;
        const instrument::Bur& bur = *mouth_.station.settings.bur;
        const tooth::ToothModel& model = *mouth_.station.tooth;
        double sum = 0.0;
        core::Box cut;
        for (const core::Pose& tip : tips)
            cut.extend(tip.positionMm);
        if (cut.isEmpty()) return 0.0;
        cut = cut.grown(bur.lengthMm() + bur.maxRadiusMm());
        const auto isDrawn = [&](const core::Vec3& p) {
            for (const Drawn& d : drawn_) {
                const core::Vec3 way = d.toMm - d.fromMm;
                const int steps = 1 + static_cast<int>(way.norm() / 0.15);
                for (int i = 0; i <= steps; ++i) {
                    const core::Vec3 tip = d.fromMm + (static_cast<double>(i) / steps) * way;
                    if (bur.signedDistance(d.orientation.conjugate() * (p - tip)) <= kGrownMm) return true;
                }
            }
            return false;
        };
        mouth_.live->withProbe([&](const measure::ToothProbe& probe) {
            for (double z = cut.min.z() + 0.5 * h; z < cut.max.z(); z += h)
                for (double y = cut.min.y() + 0.5 * h; y < cut.max.y(); y += h)
                    for (double x = cut.min.x() + 0.5 * h; x < cut.max.x(); x += h) {
                        const core::Vec3 p(x, y, z);
                        if (model.field.distance(p) >= 0.0 || probe.signedDistanceMm(p) < 0.0) continue;
                        if (!isDrawn(p)) sum += h * h * h;
                    }
        });
        return sum;
    }

    Mouth& mouth_;
    MouthWay way_;
    Watched* device_ = nullptr;
    std::unique_ptr<contact::Method> now_;
    std::optional<std::uint16_t> began_;
    std::vector<Drawn> drawn_;
};

}  // namespace handpiece::input
