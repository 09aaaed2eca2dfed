// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A tooth that can be cut, a bur, what turns it and what it feels like: from names to a loop, for the command line and
/// the window alike.

#include <memory>
#include <string>
#include <vector>

#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/rotor.h"
#include "handpiece/model/tooth/tooth_mirror.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/tick/cutting/cutter.h"
#include "handpiece/tick/device/device.h"
#include "handpiece/tick/force/parameters.h"
#include "handpiece/tick/loop/haptic_loop.h"

namespace handpiece::simulation {

/// The field of a tooth at this voxel, whoever cuts it: an attempt fits no other. Its bands are counted in millimetres,
/// but are never thinner than a few voxels.
[[nodiscard]] field::FieldSettings fieldSettingsAt(double voxelMm);

/// All that decides what a cut does, besides the tooth and the hand. What a session keeps of it is enough to cut again.
struct SimulationSettings {
    double rateHz = 1000.0;
    field::FieldSettings field;
    tooth::CutSettings cut;
    std::shared_ptr<const instrument::Bur> bur;
    instrument::CuttingParameters cuttingParameters;
    instrument::Drive drive;
    cases::TissueTable tissues = cases::builtInTissues();
    device::Capability capability;
    force::Parameters parameters = force::defaultParameters();
    bool fullRemoval = false;
    bool hull = false;     ///< feels the paper's hulls instead of the field: touching only
    bool resumed = false;  ///< the tooth was cut before: the session begins with a key frame
};

/// Everything but the tooth, as JSON; numbers come back bit for bit. Of the bur its outline is kept, which decides all
/// that it does, and its name: of a file no folder.
[[nodiscard]] std::string settingsJson(const SimulationSettings& settings);
/// Throws core::Error naming `where` and what is missing or wrong.
[[nodiscard]] SimulationSettings settingsFromJson(const std::string& json, const std::string& where);

/// What changes while one works, as the text of the event that tells it.
[[nodiscard]] std::string burChangeJson(const SimulationSettings& settings);  ///< bur, ability, hull or field
[[nodiscard]] std::string driveChangeJson(const SimulationSettings& settings);
[[nodiscard]] std::string parameterChangeJson(const SimulationSettings& settings);
/// Where a session goes on: with what, and from which state of the tooth (hashText).
struct Resumption {
    SimulationSettings settings;
    std::string stateHash;
    bool isRecovered = false;  ///< its program had ended: state and history are what recover() finds
};
[[nodiscard]] std::string resumptionJson(const Resumption& resumption);
/// Throws core::Error naming `where`.
[[nodiscard]] Resumption resumptionFromJson(const std::string& json, const std::string& where);
/// Which of them a text told.
struct Changed {
    bool work = false, drive = false, parameters = false;
};
/// Puts a change into `settings`. Throws core::Error naming `where`.
Changed applyChange(const std::string& json, SimulationSettings& settings, const std::string& where);

/// A tooth that stands around the one that is cut, or gingiva or bone: felt by the bur and by the handpiece's body.
struct StandingTooth {
    std::shared_ptr<const tooth::ToothModel> model;  ///< in its own frame; Tissue::neighbour unless it is cut
    core::Pose inCase;
    int fdiNumber = 0;
    bool isYielding = false, isBone = false;     ///< no tooth but gingiva, or bone; then of its own tissue
    std::shared_ptr<tooth::ToothState> field{};  ///< null: it is not cut
};
/// Voxel of the fields of teeth that are not cut: they only say where a bur bears on them; and of gingiva and bone,
/// which are only asked how deep something is: that is known from their triangles.
inline constexpr double kStandingVoxelMm = 0.1, kPlainVoxelMm = 0.25;
/// Bricks kept ready for the inside of a tooth beside the one worked on: at 50 um some 250 mm3.
inline constexpr std::size_t kStandingReserveBricks = 4096;

/// One tooth under one bur, and those that stand around it, numbered from 1 on. The fields are cut by the loop that
/// gets the work.
struct SimulationSetup {
    std::shared_ptr<const tooth::ToothModel> tooth;
    std::shared_ptr<tooth::ToothState> field;
    std::vector<StandingTooth> others{};
    SimulationSettings settings;

    /// Of all teeth that can be cut, by their numbers: for mirrors and files.
    [[nodiscard]] tooth::Teeth teeth() const;
    [[nodiscard]] std::uint64_t identity() const { return tooth::identityOf(teeth()); }
    /// As they are now. While no loop runs.
    [[nodiscard]] tooth::StateDelta state() const;
    [[nodiscard]] std::uint64_t stateHash() const { return tooth::stateHash(state()); }
    /// Uncut fields in place of these, which somebody else may go on with.
    void renewFields();
    /// Puts bricks of the teeth in place. Not while a loop runs.
    void put(const tooth::StateDelta& change) const;
    /// Teeth that were cut before: whoever listens begins with them so. Not while a loop runs.
    void resume(const tooth::StateDelta& state) const;
    /// What is on its way to listeners who begin with the state as it is. Not while a loop runs.
    void discardBricks() const;
    /// A method and a cutter on the field, for a loop; of hulls a method alone. One loop at a time; while it runs
    /// another may be made for it, on another thread. Throws core::Error for what has no hull.
    [[nodiscard]] loop::Work work() const;
};
/// A tooth beside the one worked on that has been cut.
struct NickedTooth {
    std::uint16_t number = 0;
    int fdiNumber = 0;  ///< 0 where it is unknown
    std::string name;
    tooth::TissueVolumes removedMm3{};
};
/// As they are now. While no loop runs.
[[nodiscard]] std::vector<NickedTooth> nickedTeeth(const SimulationSetup& station);
/// [{"tooth": 1, "fdi": 46, "name": "...", "removed_mm3": {"enamel": 0.012}}]
[[nodiscard]] std::string nickedJson(const std::vector<NickedTooth>& nicked);
/// A loaded tooth, yet uncut, and a state of it to cut; with what stands around it. Throws core::Error.
[[nodiscard]] SimulationSetup makeSimulation(const cases::Case& toothCase, SimulationSettings settings, bool useCache,
                                             const core::Progress& progress = {});

}  // namespace handpiece::simulation
