// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is measured of the hand, from the samples of its work: one pass, memory that does not grow with it.
/// docs/assessment.md#measures-of-the-hand defines each.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/assess/measures/measure.h"
#include "handpiece/assess/zones/zones.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/model/instrument/bur.h"

namespace handpiece::hand {

/// A tick, as a session has it. What is no number counts for nothing.
struct Sample {
    double timeS = 0.0;       ///< of the session
    double lastsS = 0.0;      ///< since the tick before
    core::Pose burInTooth{};  ///< of the device
    double forceN = 0.0;      ///< commanded, on the hand: the load on the bur
    double depthMm = 0.0;     ///< above 0: the bur is in contact
    double speedRpm = 0.0;
    cases::Tissue tissue = cases::Tissue::none;  ///< that carries most of the pressure
    int tooth = 0;                               ///< that it is of; 0 is the one worked on
    bool isPedalDown = false, isCutting = false, isStalled = false, pressesGingiva = false;
    bool hasRemoved = false;  ///< more of the teeth is gone than at the tick before
};

/// From where and how somebody works, as far as the record tells it.
struct Way {
    int hour = 0;  ///< of the operator's clock; 0: none chosen
    bool mirrorOnly = false, fingerRest = false;
    std::optional<bool> depthStop;  ///< on or off; none: the record does not tell
};

/// What the hand is held against.
struct Against {
    core::Vec3 longAxis = core::Vec3::UnitZ();  ///< of the tooth, out of the crown, unit
    const zones::Zones* zones = nullptr;        ///< of the task; null where it has none. Outlives the measuring
};

/// Takes the samples of a chain of sessions in their order, then says what was measured. Pure: the same samples, the
/// same bits. One thread.
class HandMeasures {
  public:
    /// Throws core::Error for a kind that does not exist, is not of the hand, or does not take what is selected.
    HandMeasures(std::span<const measures::Request> requests, const Against& against);
    ~HandMeasures();
    HandMeasures(const HandMeasures&) = delete;
    HandMeasures& operator=(const HandMeasures&) = delete;

    /// What follows was done after a pause, in this session of the chain.
    void goOn(std::size_t session);
    /// From here on with this bur; its shape may be null, then it reaches into no protected zone. The first is no
    /// change, nor is one of the same name.
    void takeBur(double atS, const std::string& name, const instrument::Bur* bur);
    void takeWay(const Way& way);
    enum class Step { undo, redo, reset };
    void takeStep(double atS, Step step);
    /// As the record tells it: after the pedal came up, once all that was cut had been handed over.
    void endStroke();
    void take(const Sample& sample);

    /// One value, or reason why there is none, a request, in their order.
    [[nodiscard]] std::vector<measures::Measured> measured();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::hand
