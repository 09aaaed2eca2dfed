// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Finds what is worth a name in the stream of samples.

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/record/session/record.h"

namespace handpiece::session {

/// Watches samples in their order and tells events, each once as it begins. One thread, off the tick.
class EventWatch {
  public:
    using Teller = std::function<void(std::uint64_t tick, EventName name, std::string_view text)>;
    /// `fdiNumbers` of the teeth that stand around the one worked on, from number 1 on; 0 where one is unknown.
    explicit EventWatch(Teller teller, std::vector<int> fdiNumbers = {})
        : tell_(std::move(teller)), fdiNumbers_(std::move(fdiNumbers)) {}

    void look(const messages::HapticSample& sample);
    /// True from the pedal going down until it is up and every changed brick has been handed over.
    [[nodiscard]] bool inStroke() const noexcept { return inStroke_; }
    /// Strokes that have ended so far.
    [[nodiscard]] std::uint64_t strokes() const noexcept { return strokes_; }

    static constexpr double kTellMm3 = 1e-5;  ///< less than this of a tissue is grit, no exposure
    static constexpr double kPauseS = 1.0;    ///< between two tellings of a limit or a stall

  private:
    void tellOnce(const messages::HapticSample& sample, std::uint32_t flag, EventName name);
    [[nodiscard]] std::string nameOf(std::uint16_t tooth) const;

    Teller tell_;
    bool inStroke_ = false, first_ = true;
    std::uint64_t strokes_ = 0;
    std::uint32_t lastFlags_ = 0;
    std::vector<int> fdiNumbers_;
    static constexpr int kNoNeighbour = -1;
    int lastNeighbour_ = kNoNeighbour;
    bool hasCutNeighbour_ = false;
    std::array<bool, cases::kTissueCount> reached_{};
    std::array<double, cases::kTissueCount> strokeStartMm3_{};
    std::array<double, kEventNameCount> toldAtS_{};
};

}  // namespace handpiece::session
