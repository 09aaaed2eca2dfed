// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the tick tells its listeners, once a tick: plain data, copied by value through a queue.

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace handpiece::messages {

/// Steps of a tick's inputs: the loop rounds what it reads from a device to them before using it, so that a record of
/// whole steps gives the inputs back bit for bit.
inline constexpr double kPositionStepMm = 0x1p-20, kOrientationStep = 0x1p-30, kPedalStep = 0x1p-16;

/// As many as cases::Tissue has.
inline constexpr std::size_t kTissues = 19;

/// One tick. Poses are bur in tooth [mm], quaternions w x y z; forces on the hand in the tooth frame [N].
struct HapticSample {
    std::uint64_t tick = 0;
    double timeS = 0.0;                  ///< nominal: tick x period
    std::array<double, 3> positionMm{};  ///< as read from the device (quantised, delayed)
    std::array<double, 4> orientation{1, 0, 0, 0};
    std::array<double, 3> velocityMmS{};      ///< filtered
    std::array<double, 3> forceN{};           ///< commanded
    std::array<double, 3> torqueNmm{};        ///< about the grip; commanded as far as the device has torque axes
    double depthMm = 0.0;                     ///< at the pose as read; negative when apart
    std::array<double, 3> truePositionMm{};   ///< of the simulated device's mass; as read for real devices
    std::array<double, 3> proxyPositionMm{};  ///< what the eye sees
    std::array<double, 4> proxyOrientation{1, 0, 0, 0};
    std::array<double, 3> appliedForceN{};  ///< that acts on the device now, after its delay
    double contactAreaMm2 = 0.0;            ///< at the proxy
    /// Where the proxy bears on the tooth: the middle of the patch that carries most of the pressure, its normal out of
    /// the tooth, unit. Without contact the normal is zero.
    std::array<double, 3> contactPointMm{}, contactNormal{};
    std::uint8_t tissue = 0;         ///< cases::Tissue that carries most of the pressure
    std::uint8_t contactStatus = 0;  ///< contact::Status
    std::uint16_t patchCount = 0;
    std::uint16_t tooth = 0;  ///< that `tissue` is of: 0 the one worked on, else its number among those around it
    std::uint16_t touchedNeighbour = 0;  ///< of the teeth around that the bur touches the one it bears on most; 0: none
    std::uint16_t cutNeighbour = 0;      ///< that has lost most; 0: none has
    std::uint32_t flags = 0;             ///< SampleFlag bits
    float workUs = 0.0f;                 ///< from reading the pose to having the force
    float lateUs = 0.0f;                 ///< start of the tick after its nominal time
    float cutUs = 0.0f;                  ///< after the force was sent: cutting and handing over
    float feedMmS = 0.0f;                ///< speed at which the bur eats into the tooth
    std::int32_t elapsedPeriods = 1;     ///< since the tick before
    std::uint32_t buttons = 0;           ///< bit 0: the upper one
    std::uint32_t waitingBricks = 0;     ///< changed bricks not handed over yet
    std::uint64_t handedBricks = 0;      ///< changed bricks handed over so far: those before this sample
    std::uint64_t lastCommand = 0;       ///< number of the newest staged command that has taken effect
    double pedal = 0.0;                  ///< 0..1
    double speedRpm = 0.0;               ///< of the bur
    double loadTorqueNmm = 0.0;          ///< with which the tooth held the bur back in the tick before
    std::array<double, kTissues> removedMm3{};  ///< of the tooth worked on by cases::Tissue, since it was whole
    double removedOthersMm3 = 0.0;              ///< of all other teeth
};

enum SampleFlag : std::uint32_t {
    kForceLimited = 1,       ///< clamped to the device's largest force
    kSlopeLimited = 2,       ///< the change of force was limited
    kInvalidPose = 4,        ///< the device's pose was not finite, or jumped: force is zero
    kFault = 8,              ///< force is held at zero until reset
    kWaiting = 16,           ///< force is held at zero until the bur is clear of the tooth
    kCutting = 32,           ///< tissue was taken away in this tick
    kStalled = 64,           ///< the bur stands although the pedal is down
    kRestoring = 128,        ///< an undo, redo or reset is being put in place
    kOutOfBricks = 256,      ///< the tooth's memory for cuts is used up: it is cut no deeper
    kShankTouches = 512,     ///< of the instrument behind the bur this bears most: its shank,
    kHeadTouches = 1024,     ///< the handpiece's head,
    kHandleTouches = 2048,   ///< or its handle
    kPressesGingiva = 4096,  ///< part of the instrument presses on gingiva
    kCutsGingiva = 8192,     ///< the turning bur is in it
};

static_assert(std::is_trivially_copyable_v<HapticSample>);

}  // namespace handpiece::messages
