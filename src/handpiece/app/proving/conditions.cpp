// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "handpiece/app/proving/proving.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/rotor.h"
#include "handpiece/record/session/session_reader.h"

namespace handpiece::proving {
namespace {

using nlohmann::json;
using simulation::SimulationSettings;

class Conditions {
  public:
    explicit Conditions(const tasks::Task& task) : task_(task) {}

    void check(const SimulationSettings& s) {
        if (s.fullRemoval) tell("whatever the bur touched was gone at once");
        if (s.hull) tell("the tooth was felt as its hull");
        checkTissuesAndBur(s);
        checkDrive(s.drive);
    }
    /// Gingiva and bone as they were felt: without them nothing of them is touched.
    void checkAround(std::span<const std::byte> encodedCase, const std::string& where) {
        if (feltKey(cases::decodeCase(encodedCase, where).scenery) != feltKey(task_.toothCase.scenery))
            tell("gingiva or bone beside the tooth was another");
    }
    [[nodiscard]] std::vector<std::string> told() && { return std::move(told_); }

  private:
    void tell(std::string what) {
        if (std::find(told_.begin(), told_.end(), what) == told_.end()) told_.push_back(std::move(what));
    }
    /// Held against the exercise's own as a session keeps them, which is all that decides what is cut.
    void checkTissuesAndBur(const SimulationSettings& s) {
        const std::string& name = s.bur->name();
        const auto& exercise = task_.toothCase.exercise;
        if (exercise && !exercise->allowedBurs.empty() &&
            std::find(exercise->allowedBurs.begin(), exercise->allowedBurs.end(), name) == exercise->allowedBurs.end())
            tell(fmt::format("bur {} is none of the exercise's", name));
        SimulationSettings own = s;
        own.tissues = task_.toothCase.tissues;
        try {
            // A name out of a session opens no file here.
            if (geometry::meshFormatOf(name) != geometry::MeshFormat::unknown)
                throw core::Error("a bur's file", name, "name one of the catalogue's");
            const instrument::Instrument known = instrument::makeInstrument(name);
            own.bur = known.bur, own.cuttingParameters = known.cuttingParameters;
        } catch (const core::Error&) {
            tell(fmt::format("bur {} is not in the catalogue", name));
        }
        const json mine = json::parse(simulation::settingsJson(own)), its = json::parse(simulation::settingsJson(s));
        for (const auto& [tissue, row] : mine.at("tissues").items())
            if (its.at("tissues").at(tissue) != row) tell(fmt::format("{} was another than the exercise's", tissue));
        if (mine.at("outline_mm") != its.at("outline_mm")) tell(fmt::format("bur {} had another shape", name));
        if (mine.at("ability") != its.at("ability")) tell(fmt::format("bur {} cut otherwise than it does", name));
    }
    void checkDrive(const instrument::Drive& drive) {
        const auto& known = instrument::drives();
        const auto own = std::find_if(known.begin(), known.end(),
                                      [&](const instrument::Drive& one) { return one.name == drive.name; });
        if (own == known.end()) return tell(fmt::format("drive {} is not in the catalogue", drive.name));
        // Slower is the student's choice.
        if (drive.freeSpeedRpm > own->freeSpeedRpm || drive.stallTorqueNmm > own->stallTorqueNmm ||
            drive.inertiaNmmS2 != own->inertiaNmmS2)
            tell(fmt::format("drive {} was stronger than it is", drive.name));
    }

    static std::uint64_t feltKey(const std::vector<cases::Part>& parts) {
        cases::Tooth felt;
        for (const cases::Part& part : parts)
            if (part.isFelt && (part.tissue == cases::Tissue::gum || part.tissue == cases::Tissue::bone))
                felt.parts.push_back(part);
        return cases::contentKey(felt);
    }

    const tasks::Task& task_;
    std::vector<std::string> told_;
};

bool isNamed(const session::Event& event, session::EventName name) {
    return event.name == nameOf(name);
}

}  // namespace

std::vector<std::string> otherConditions(const std::filesystem::path& path, const tasks::Task& task) {
    const session::SessionReader reader(path);
    const std::string where = path.filename().string();
    SimulationSettings settings = simulation::settingsFromJson(reader.info().settings, where);
    Conditions conditions(task);
    conditions.check(settings);
    conditions.checkAround(reader.info().tooth, where);
    for (const session::Event& event : reader.events()) {
        if (isNamed(event, session::EventName::resume))
            settings = simulation::resumptionFromJson(event.text, where).settings;
        else if (isNamed(event, session::EventName::burChange) || isNamed(event, session::EventName::parameterChange))
            (void)simulation::applyChange(event.text, settings, where);
        else
            continue;
        conditions.check(settings);
    }
    return std::move(conditions).told();
}

}  // namespace handpiece::proving
