// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/recording.h"

#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/app/simulation/working_way.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/record/session/session_reader.h"

namespace handpiece::assessment {
namespace {

using session::Event;
using session::EventName;
using session::Record;

constexpr std::size_t kStretch = 4096;

/// Hears a chain of sessions as it was done.
struct Listener {
    virtual ~Listener() = default;
    /// A session begins, or goes on after a pause.
    virtual void goOn(std::size_t session) = 0;
    virtual void takeBur(double atS, const simulation::SimulationSettings& settings) = 0;
    virtual void takeWay(const simulation::WorkingWay& way) = 0;
    virtual void takeStep(double atS, hand::HandMeasures::Step step) = 0;
    virtual void endStroke() = 0;
    virtual void take(double timeS, double lastsS, const Record& record) = 0;
};

bool isNamed(const Event& event, EventName name) {
    return event.name == nameOf(name);
}

void tell(const Event& event, double rateHz, const std::string& where, std::size_t session,
          simulation::SimulationSettings& settings, Listener& to) {
    const double atS = static_cast<double>(event.tick) / rateHz;
    if (isNamed(event, EventName::workingWay)) return to.takeWay(simulation::workingWayFromJson(event.text));
    using Step = hand::HandMeasures::Step;
    if (isNamed(event, EventName::undo)) return to.takeStep(atS, Step::undo);
    if (isNamed(event, EventName::redo)) return to.takeStep(atS, Step::redo);
    if (isNamed(event, EventName::reset)) return to.takeStep(atS, Step::reset);
    if (isNamed(event, EventName::strokeEnd)) return to.endStroke();
    if (isNamed(event, EventName::burChange)) {
        (void)simulation::applyChange(event.text, settings, where);
        return to.takeBur(atS, settings);
    }
    if (isNamed(event, EventName::resume)) {
        settings = simulation::resumptionFromJson(event.text, where).settings;
        to.goOn(session);
        to.takeBur(atS, settings);
    }
}

void play(std::span<const Recording> chain, Listener& to, const core::Progress& progress) {
    for (std::size_t i = 0; i < chain.size(); ++i) {
        const std::string& where = chain[i].name;
        const session::SessionReader reader(chain[i].path);
        const double rateHz = reader.info().rateHz;
        simulation::SimulationSettings settings = simulation::settingsFromJson(reader.info().settings, where);
        to.goOn(i);
        to.takeBur(0.0, settings);
        const std::vector<Event> events = reader.events();
        auto next = events.begin();
        const std::uint64_t untilTick = chain[i].untilTick.value_or(reader.endTick());
        for (std::uint64_t first = 0; first < reader.size(); first += kStretch) {
            for (const Record& record : reader.records(first, kStretch)) {
                if (record.tick > untilTick) break;
                // A way of working bears the number of the last tick that went before it.
                for (; next != events.end() && (next->tick < record.tick ||
                                                (next->tick == record.tick && !isNamed(*next, EventName::workingWay)));
                     ++next)
                    tell(*next, rateHz, where, i, settings, to);
                to.take(static_cast<double>(record.tick) / rateHz, record.elapsedPeriods / rateHz, record);
            }
            core::report(progress,
                         (static_cast<double>(i) + static_cast<double>(first) / static_cast<double>(reader.size())) /
                             static_cast<double>(chain.size()));
        }
        for (; next != events.end(); ++next)
            if (next->tick < reader.endTick() && next->tick <= untilTick) tell(*next, rateHz, where, i, settings, to);
    }
}

core::Pose poseOf(const Record& record) {
    const session::Inputs in = session::inputsOf(record);
    core::Pose pose;
    pose.positionMm = core::Vec3(in.positionMm[0], in.positionMm[1], in.positionMm[2]);
    pose.orientation = core::Quat(in.orientation[0], in.orientation[1], in.orientation[2], in.orientation[3]);
    if ((record.flags & messages::kInvalidPose) != 0)
        pose.positionMm.setConstant(std::numeric_limits<double>::quiet_NaN());
    return pose;
}

core::Vec3 forceOf(const Record& record) {
    return {record.forceN[0], record.forceN[1], record.forceN[2]};
}

class HandListener : public Listener {
  public:
    explicit HandListener(hand::HandMeasures& hand) : hand_(hand) {}
    void goOn(std::size_t session) override {
        removedMm3_.reset();
        hand_.goOn(session);
    }
    void takeBur(double atS, const simulation::SimulationSettings& settings) override {
        if (settings.bur) hand_.takeBur(atS, settings.bur->name(), settings.bur.get());
    }
    void takeWay(const simulation::WorkingWay& way) override {
        hand_.takeWay({way.hour, way.mirrorOnly, way.fingerRest, way.depthStop});
    }
    void takeStep(double atS, hand::HandMeasures::Step step) override { hand_.takeStep(atS, step); }
    void endStroke() override { hand_.endStroke(); }
    void take(double timeS, double lastsS, const Record& record) override {
        hand::Sample s;
        s.timeS = timeS;
        s.lastsS = lastsS;
        s.burInTooth = poseOf(record);
        s.forceN = forceOf(record).norm();
        s.depthMm = record.depthMm;
        s.speedRpm = record.speedRpm;
        s.tissue =
            record.tissue < cases::kTissueCount ? static_cast<cases::Tissue>(record.tissue) : cases::Tissue::none;
        s.tooth = record.tooth;
        s.isPedalDown = record.pedal > 0;
        s.isCutting = (record.flags & messages::kCutting) != 0;
        s.isStalled = (record.flags & messages::kStalled) != 0;
        s.pressesGingiva = (record.flags & (messages::kPressesGingiva | messages::kCutsGingiva)) != 0;
        double removedMm3 = record.removedOthersMm3;
        for (const double ofTissue : record.removedMm3)
            removedMm3 += ofTissue;
        // What comes back, or goes again, while a step is taken is no cut.
        s.hasRemoved = (record.flags & messages::kRestoring) == 0 && removedMm3 > removedMm3_.value_or(removedMm3);
        removedMm3_ = removedMm3;
        hand_.take(s);
    }

  private:
    hand::HandMeasures& hand_;
    std::optional<double> removedMm3_;  ///< at the tick before
};

class TimeListener : public Listener {
  public:
    TimeListener(const std::vector<measures::Evidence*>& places, double withinMm) : withinMm_(withinMm) {
        for (measures::Evidence* place : places)
            places_.push_back({place, {}, 0.0});
    }
    void goOn(std::size_t session) override { session_ = session; }
    void takeBur(double /*atS*/, const simulation::SimulationSettings& settings) override { bur_ = settings.bur; }
    void takeWay(const simulation::WorkingWay& /*way*/) override {}
    void takeStep(double /*atS*/, hand::HandMeasures::Step /*step*/) override {}
    void endStroke() override {}
    void take(double timeS, double /*lastsS*/, const Record& record) override {
        if ((record.flags & messages::kCutting) == 0 || !bur_) return;
        core::Pose pose = poseOf(record);
        if (!pose.isValid()) return;
        // The device's bur is in the tooth by `depth`; the one that cuts is held back from there, the way it is pushed.
        const core::Vec3 force = forceOf(record);
        const double forceN = force.norm();
        if (forceN > 0.0 && record.depthMm > 0.0f)
            pose.positionMm += force * (static_cast<double>(record.depthMm) / forceN);
        const double reach = bur_->lengthMm() + bur_->maxRadiusMm() + withinMm_;
        for (Place& at : places_) {
            if ((*at.place->placeMm - pose.positionMm).squaredNorm() > reach * reach) continue;
            const double distance = bur_->signedDistance(pose.applyInverse(*at.place->placeMm));
            if (distance > withinMm_) continue;
            // Of the last time that the bur passed there, the moment at which it was nearest.
            if (at.lastS && timeS - *at.lastS < kVisitS && session_ == at.place->session) {
                at.lastS = timeS;
                if (distance >= at.nearestMm) continue;
            }
            at.lastS = timeS;
            at.nearestMm = distance;
            at.place->timeS = timeS;
            at.place->forceN = forceN;
            at.place->session = session_;
        }
    }

  private:
    static constexpr double kVisitS = 0.25;  ///< a bur that was away for longer comes again
    struct Place {
        measures::Evidence* place;
        std::optional<double> lastS;
        double nearestMm;
    };
    std::vector<Place> places_;
    double withinMm_;
    std::size_t session_ = 0;
    std::shared_ptr<const instrument::Bur> bur_;
};

/// More than one at a reading.
struct Several : Listener {
    std::vector<std::unique_ptr<Listener>> all;
    void goOn(std::size_t session) override {
        for (const auto& one : all)
            one->goOn(session);
    }
    void takeBur(double atS, const simulation::SimulationSettings& settings) override {
        for (const auto& one : all)
            one->takeBur(atS, settings);
    }
    void takeWay(const simulation::WorkingWay& way) override {
        for (const auto& one : all)
            one->takeWay(way);
    }
    void takeStep(double atS, hand::HandMeasures::Step step) override {
        for (const auto& one : all)
            one->takeStep(atS, step);
    }
    void endStroke() override {
        for (const auto& one : all)
            one->endStroke();
    }
    void take(double timeS, double lastsS, const Record& record) override {
        for (const auto& one : all)
            one->take(timeS, lastsS, record);
    }
};

}  // namespace

std::vector<measures::Measured> readRecord(std::span<const Recording> chain, std::span<measures::Measured> ofTooth,
                                           double voxelMm, std::span<const measures::Request> ofHand,
                                           const hand::Against& against, const core::Progress& progress) {
    /// What the depth, told in steps and along one direction, leaves open of where the bur lay [mm].
    constexpr double kPoseErrorMm = 0.02;
    std::vector<measures::Evidence*> places;
    for (measures::Measured& m : ofTooth)
        for (measures::Evidence& evidence : m.evidence)
            if (evidence.placeMm && !evidence.timeS) places.push_back(&evidence);
    std::optional<hand::HandMeasures> hand;
    if (!ofHand.empty()) hand.emplace(ofHand, against);
    Several listener;
    if (hand) listener.all.push_back(std::make_unique<HandListener>(*hand));
    if (!places.empty()) listener.all.push_back(std::make_unique<TimeListener>(places, 0.5 * voxelMm + kPoseErrorMm));
    if (!listener.all.empty()) play(chain, listener, progress);
    return hand ? hand->measured() : std::vector<measures::Measured>();
}

}  // namespace handpiece::assessment
