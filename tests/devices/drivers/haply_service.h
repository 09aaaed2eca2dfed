// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Haply's service as its documentation describes it, in this process: a WebSocket that tells its devices once and then
/// answers every message with their state. Spoken with Boost.Beast, so that the driver's own WebSocket meets another's.

#include <array>
#include <cstdint>
#include <memory>
#include <string>

namespace handpiece::test {

/// In the service's frame and units: +x right, +y away from the user, +z up; metres, newtons.
struct SimulatedArm {
    std::string id = "049D", type = "inverse3", gripId = "61548", basis = "XYZ";
    bool wirelessGrip = true;
    std::array<double, 3> positionM{};
    std::array<double, 4> grip{1, 0, 0, 0};  ///< w x y z
    std::uint32_t buttons = 0;               ///< a, b, c
    bool calibrated = true, powered = true, ready = true, gone = false, gripGone = false;
    double scale = 1.0;
    // What arrived.
    std::array<double, 3> forceN{};
    std::uint64_t count = 0;
};

class HaplyService {
  public:
    explicit HaplyService(int arms = 1);
    ~HaplyService();
    HaplyService(const HaplyService&) = delete;
    HaplyService& operator=(const HaplyService&) = delete;

    [[nodiscard]] std::string url() const;  ///< "ws://localhost:PORT"
    [[nodiscard]] SimulatedArm arm(int which) const;
    template <class Change>
    void change(int which, const Change& with) {
        SimulatedArm arm = this->arm(which);
        with(arm);
        set(which, arm);
    }
    void older(bool older);  ///< of a version before 3.5: another name for the force's place, no session
    void stall(double seconds);
    /// Every answer from now on is this text; empty: as it should be.
    void say(const std::string& garbage);
    /// The next answer is these bytes on the bare socket, no WebSocket's frame.
    void breakFrame(const std::string& bytes);
    /// Answers in pieces of so many bytes, with a ping before each; 0: whole.
    void fragment(std::size_t bytes);
    void kill();    ///< all connections are cut, nobody listens
    void revive();  ///< on the same port
    [[nodiscard]] unsigned breaches() const;
    [[nodiscard]] std::string lastBreach() const;
    [[nodiscard]] std::uint64_t sessions() const;  ///< since the beginning

  private:
    void set(int which, const SimulatedArm& arm);
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::test
