// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a turning bur takes off the tooth in one tick. Fourth stage: device -> contact -> force -> [cutting].

#include <memory>
#include <vector>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/instrument/cutting_parameters.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::cutting {

struct CutInput {
    core::Pose proxyInTooth;                ///< where the bur is: on the surface
    core::Pose deviceInTooth;               ///< where the hand wants it
    core::Vec3 loadN = core::Vec3::Zero();  ///< with which the bur presses on the tooth; zero when it does not touch
    double speedRadS = 0.0;                 ///< of the rotor
    double periodS = 0.001;
};

struct CutResult {
    tooth::TissueVolumes removedMm3{};            ///< in this tick
    core::Vec3 tangentialN = core::Vec3::Zero();  ///< on the bur, from its rotation
    double loadTorqueNmm = 0.0;                   ///< with which the tooth holds the rotor back
    double feedMmS = 0.0;                         ///< speed at which the bur eats into the tooth
    core::Pose cutterInTooth;                     ///< pose up to which tissue is gone
    std::uint32_t changedBricks = 0;
};

/// A tooth that can be cut, and where it stands.
struct CutTooth {
    std::shared_ptr<tooth::ToothState> field;  ///< in the tooth's own frame
    core::Pose inScene;                        ///< of the method's frame, which is that of the poses
};

/// Cuts one tooth or several with one bur.
///
/// The bur advances into the tooth as a rigid body: along the load, at the speed at which the pressures that its
/// contact area needs for that (tissue by tissue, p = v_n / (K omega rho)) add up to the load; load and chip are
/// capped. What its envelope sweeps from pose to pose is taken away from every tooth that is there, nothing else. The
/// advance that the field has not yet let through to the proxy is carried to the next tick, so that removal depends
/// neither on rate nor on voxel.
class Cutter {
  public:
    struct Settings {
        bool fullRemoval = false;  ///< take away all that the device's bur sweeps, whatever the load
    };
    Cutter(std::shared_ptr<tooth::ToothState> field, std::shared_ptr<const instrument::Bur> bur,
           const instrument::CuttingParameters& cuttingParameters, const cases::TissueTable& tissues,
           const Settings& settings);
    Cutter(std::vector<CutTooth> teeth, std::shared_ptr<const instrument::Bur> bur,
           const instrument::CuttingParameters& cuttingParameters, const cases::TissueTable& tissues,
           const Settings& settings);
    ~Cutter();
    Cutter(const Cutter&) = delete;
    Cutter& operator=(const Cutter&) = delete;

    /// After the force has been sent. `method` is that of this tick, on the same fields.
    const CutResult& cut(contact::Method& method, const CutInput& input) noexcept HANDPIECE_REALTIME;
    /// The bur is not cutting in this tick: nothing is swept on the way to where it cuts next.
    const CutResult& rest() noexcept HANDPIECE_REALTIME;

    [[nodiscard]] std::size_t toothCount() const noexcept;
    [[nodiscard]] tooth::ToothState& field(std::size_t tooth = 0) noexcept;
    [[nodiscard]] const tooth::ToothState& field(std::size_t tooth = 0) const noexcept;
    /// By its number in the mouth; null where that tooth is not cut.
    [[nodiscard]] tooth::ToothState* fieldOf(std::uint16_t toothNumber) noexcept;
    [[nodiscard]] double largestRadiusMm() const noexcept;  ///< of the bur

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::cutting
