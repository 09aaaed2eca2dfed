// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/simulation_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <concepts>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/held_aside.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/contact/hull/hull_method.h"
#include "handpiece/tick/contact/mouth_method.h"
#include "handpiece/tick/device/capability.h"

namespace handpiece::simulation {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxPieces = 1000;
constexpr double kCheekVoxelMm = 0.5;  // of lips and cheeks, which are plain and large
constexpr double kMaxBandMm = 5.0, kMaxReserveBricks = 3e6;

// What a session keeps of each thing, named once: Write puts the members into JSON, Read takes them out.

template <class Visit, class CuttingParameters>
void members(Visit&& visit, CuttingParameters& a) requires
    std::same_as<std::remove_const_t<CuttingParameters>, instrument::CuttingParameters> {
    visit("name", a.name);
    visit("cutting", a.cutting);
    visit("load_cap_n", a.loadCapN);
    visit("friction_cutting", a.frictionCutting);
    visit("chip_mm", a.chipMm);
    visit("edges", a.edges);
    visit("centre_radius", a.centreRadius);
}

template <class Visit, class Drive>
void members(Visit&& visit, Drive& d) requires std::same_as<std::remove_const_t<Drive>, instrument::Drive> {
    visit("name", d.name);
    visit("free_speed_rpm", d.freeSpeedRpm);
    visit("stall_torque_nmm", d.stallTorqueNmm);
    visit("inertia_nmms2", d.inertiaNmmS2);
    visit("bearing_torque_nmm", d.bearingTorqueNmm);
}

template <class Visit, class Properties>
void members(Visit&& visit,
             Properties& t) requires std::same_as<std::remove_const_t<Properties>, cases::TissueProperties> {
    visit("stiffness", t.stiffnessFraction);
    visit("damping", t.dampingNSPerMm);
    visit("friction", t.friction);
    visit("cutting", t.cuttingMm2PerN);
    visit("priority", t.priority);
    visit("colour", t.colour);
}

template <class Visit, class Table>
void members(Visit&& visit, Table& table) requires std::same_as<std::remove_const_t<Table>, cases::TissueTable> {
    for (auto& row : table.rows)
        visit(std::string(row.name), row);
}

template <class Visit, class Capability>
void members(Visit&& visit, Capability& c) requires std::same_as<std::remove_const_t<Capability>, device::Capability> {
    visit("name", c.name);
    visit("max_force_n", c.maxForceN);
    visit("continuous_force_n", c.continuousForceN);
    visit("max_stiffness_n_per_mm", c.maxStiffnessNPerMm);
    visit("max_damping_ns_per_mm", c.maxDampingNSPerMm);
    visit("max_force_slope_n_per_s", c.maxForceSlopeNPerS);
    visit("max_torque_nmm", c.maxTorqueNmm);
    visit("encoder_step_mm", c.encoderStepMm);
    visit("workspace_mm", c.workspaceMm);
    visit("sensed_axes", c.sensedAxes);
    visit("driven_axes", c.drivenAxes);
    visit("rate_hz", c.rateHz);
}

/// A part of the force that is felt and cuts nothing; sessions from before there was one are without it.
template <class T>
concept Crisp = std::same_as<std::remove_const_t<T>, force::ContactTransients> ||
    std::same_as<std::remove_const_t<T>, force::CuttingVibration>;

template <class Visit, Crisp Part>
void members(Visit&& visit, Part& part) {
    visit("on", part.on);
    visit("gain", part.gain);
}

template <class Visit, class Parameters>
void members(Visit&& visit, Parameters& p) requires std::same_as<std::remove_const_t<Parameters>, force::Parameters> {
    visit("mode", p.law);
    visit("stiffness_multiplier", p.stiffnessMultiplier);
    visit("damping_multiplier", p.dampingMultiplier);
    visit("friction_multiplier", p.frictionMultiplier);
    visit("cutting_force_multiplier", p.cuttingForceMultiplier);
    visit("tissues", p.tissues);
    visit("penalty_stiffness_n_per_mm", p.penaltyStiffnessNPerMm);
    visit("penalty_damping_ns_per_mm", p.penaltyDampingNSPerMm);
    visit("velocity_tau_s", p.velocityTauS);
    visit("damping_ramp_mm", p.dampingRampMm);
    visit("grip_mm", p.gripMm);
    visit("fade_in_s", p.fadeInS);
    visit("proxy_iterations", p.proxy.iterations);
    visit("proxy_max_step_mm", p.proxy.maxStepMm);
    visit("proxy_tolerance_mm", p.proxy.toleranceMm);
    visit("transients", p.transients);
    visit("vibration", p.vibration);
}

using TissueFeels = decltype(force::Parameters::tissues);

struct Write {
    Json json = Json::object();
    template <class T>
    void operator()(const std::string& key, const T& value) {
        if constexpr (requires { Json(value); } && !std::is_enum_v<T>) {
            json[key] = value;
        } else {
            Write inner;
            members(inner, value);
            json[key] = std::move(inner.json);
        }
    }
    void operator()(const std::string& key, const core::Vec3& v) { json[key] = {v.x(), v.y(), v.z()}; }
    void operator()(const std::string& key, force::LawId law) { json[key] = force::nameOf(law); }
    void operator()(const std::string& key, const TissueFeels& tissues) {
        for (const force::TissueFeel& t : tissues)
            json[key].push_back({t.stiffnessFraction, t.dampingNSPerMm, t.friction});
    }
};

/// What a file says that nothing here can mean.
struct Senseless {
    std::string what;
};

void requireRange(std::string_view name, double value, double low, double high) {
    if (!(value >= low && value <= high))
        throw Senseless{fmt::format("{} is {}, and may be {} to {}", name, value, low, high)};
}

struct Read {
    const Json& json;
    template <std::integral T>
    void operator()(const std::string& key, T& value) const requires(!std::same_as<T, bool>) {
        const Json& found = json.at(key);
        // What lies outside a type would come out of it as any number.
        const bool isBig = found.is_number_unsigned() && !std::in_range<T>(found.get<std::uint64_t>());
        if (!found.is_number_integer() || isBig ||
            (!found.is_number_unsigned() && !std::in_range<T>(found.get<std::int64_t>())))
            throw Senseless{fmt::format("{} is no whole number that can be meant", key)};
        found.get_to(value);
    }
    void operator()(const std::string& key, std::array<std::uint8_t, 3>& colour) const {
        for (std::size_t k = 0; k < 3; ++k) {
            const double value = json.at(key).at(k).get<double>();
            requireRange(key, value, 0.0, 255.0);
            colour[k] = static_cast<std::uint8_t>(value);
        }
    }
    template <class T>
    void operator()(const std::string& key, T& value) const {
        if constexpr (requires(const Json& j) { j.get_to(value); }) {
            json.at(key).get_to(value);
        } else {
            members(Read{json.at(key)}, value);
        }
    }
    void operator()(const std::string& key, core::Vec3& v) const {
        for (std::size_t k = 0; k < 3; ++k)
            v[static_cast<int>(k)] = json.at(key).at(k).get<double>();
    }
    void operator()(const std::string& key, force::LawId& law) const {
        law = force::lawByName(json.at(key).get<std::string>());
    }
    template <Crisp Part>
    void operator()(const std::string& key, Part& part) const {
        if (json.contains(key)) members(Read{json.at(key)}, part);
    }
    /// Tissues that came after a session are as shipped.
    void operator()(const std::string& key, cases::TissueTable& table) const {
        const Json& told = json.at(key);
        for (std::size_t i = 0; i < table.rows.size(); ++i)
            if (const std::string name(table.rows[i].name); i < cases::kFirstTissueCount || told.contains(name))
                members(Read{told.at(name)}, table.rows[i]);
    }
    void operator()(const std::string& key, TissueFeels& tissues) const {
        tissues = force::defaultParameters(cases::builtInTissues()).tissues;
        const Json& told = json.at(key);
        for (std::size_t i = 0; i < tissues.size() && (i < cases::kFirstTissueCount || i < told.size()); ++i) {
            const Json& row = told.at(i);
            tissues[i] = {row.at(0), row.at(1), row.at(2)};
        }
    }
};

template <class T>
Json toJson(const T& value) {
    Write write;
    members(write, value);
    return std::move(write.json);
}

Json toJson(const instrument::Profile& profile) {
    Json pieces = Json::array();
    for (const instrument::ProfilePiece& p : profile.pieces) {
        Json piece = {p.from.x(), p.from.y(), p.to.x(), p.to.y()};
        if (p.isArc)
            for (const double v : {p.centre.x(), p.centre.y(), p.radiusMm, p.convex ? 1.0 : 0.0})
                piece.push_back(v);
        pieces.push_back(std::move(piece));
    }
    return pieces;
}

void from(const Json& j, instrument::Profile& profile) {
    if (j.size() > kMaxPieces) throw Senseless{fmt::format("a bur's outline of {} pieces", j.size())};
    for (const Json& row : j) {
        instrument::ProfilePiece p;
        p.from = core::Vec2(row.at(0).get<double>(), row.at(1).get<double>());
        p.to = core::Vec2(row.at(2).get<double>(), row.at(3).get<double>());
        p.isArc = row.size() > 4;
        if (p.isArc) {
            p.centre = core::Vec2(row.at(4).get<double>(), row.at(5).get<double>());
            p.radiusMm = row.at(6);
            p.convex = row.at(7).get<double>() > 0.5;
        }
        profile.pieces.push_back(p);
    }
}

/// A bur may be named by a file, and a file by a folder, and a folder by its owner: the last name is enough.
std::string plainNameOf(const instrument::Bur& bur) {
    return fs::path(bur.name()).filename().string();
}

std::string textOf(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

/// Calls read(), and says as core::Error what it stumbles over.
template <class F>
void reading(const std::string& where, F&& read) {
    const auto refuse = [&where](std::string_view why) {
        return core::Error(fmt::format("the settings inside cannot be read: {}", why), where,
                           "record the session anew, or use the version that wrote it");
    };
    try {
        read();
    } catch (const Json::exception& e) {
        throw refuse(e.what());
    } catch (const Senseless& e) {
        throw refuse(e.what);
    }
}

/// A file may come from anybody: no figure of it is used that would never have been recorded.
void validate(const SimulationSettings& s) {
    requireRange("rate_hz", s.rateHz, 100.0, 10000.0);
    requireRange("voxel_mm", s.field.voxelMm, 0.005, 1.0);
    requireRange("band_out_mm", s.field.bandOutMm, 0.0, kMaxBandMm);
    requireRange("band_in_mm", s.field.bandInMm, 0.0, kMaxBandMm);
    requireRange("band_mm", s.cut.bandMm, 0.0, kMaxBandMm);
    requireRange("reserve_bricks", static_cast<double>(s.cut.reserveBricks), 0.0, kMaxReserveBricks);
    const device::Capability& c = s.capability;
    // A device that is stronger than any: forces are held to what it says.
    for (const double figure : {c.maxForceN, c.continuousForceN, c.maxStiffnessNPerMm, c.maxDampingNSPerMm,
                                c.maxTorqueNmm, c.encoderStepMm, c.workspaceMm.minCoeff(), c.workspaceMm.maxCoeff()})
        requireRange("a figure of the device", figure, 0.0, 1e6);
    requireRange("max_force_slope_n_per_s", c.maxForceSlopeNPerS, 0.0, 1e9);
    requireRange("the device's rate_hz", c.rateHz, 0.0, 1e6);
    requireRange("sensed_axes", c.sensedAxes, 0, 7);
    requireRange("driven_axes", c.drivenAxes, 0, 7);
    device::validate(c);
    cases::validate(s.tissues);
    instrument::validate(s.cuttingParameters);
    instrument::validate(s.drive);
    force::validate(s.parameters);
}

std::shared_ptr<const instrument::Bur> burFrom(const Json& json) {
    instrument::Profile outline;
    from(json.at("outline_mm"), outline);
    return std::make_shared<const instrument::Bur>(json.at("bur").get<std::string>(), std::move(outline));
}

Json settingsOf(const SimulationSettings& s) {
    return {{"rate_hz", s.rateHz},
            {"field",
             {{"voxel_mm", s.field.voxelMm}, {"band_out_mm", s.field.bandOutMm}, {"band_in_mm", s.field.bandInMm}}},
            {"cut", {{"band_mm", s.cut.bandMm}, {"reserve_bricks", s.cut.reserveBricks}}},
            {"bur", plainNameOf(*s.bur)},
            {"outline_mm", toJson(s.bur->profile())},
            {"ability", toJson(s.cuttingParameters)},
            {"drive", toJson(s.drive)},
            {"tissues", toJson(s.tissues)},
            {"device", toJson(s.capability)},
            {"force", toJson(s.parameters)},
            {"full_removal", s.fullRemoval},
            {"hull", s.hull},
            {"resumed", s.resumed}};
}

}  // namespace

field::FieldSettings fieldSettingsAt(double voxelMm) {
    field::FieldSettings settings;
    settings.voxelMm = voxelMm;
    settings.bandOutMm = std::max(settings.bandOutMm, 2.0 * voxelMm);
    settings.bandInMm = std::max(settings.bandInMm, 4.0 * voxelMm);
    return settings;
}

std::string settingsJson(const SimulationSettings& s) {
    return textOf(settingsOf(s), 2);
}

std::string resumptionJson(const Resumption& resumption) {
    return textOf({{"state_hash", resumption.stateHash},
                   {"recovered", resumption.isRecovered},
                   {"settings", settingsOf(resumption.settings)}});
}

Resumption resumptionFromJson(const std::string& text, const std::string& where) {
    Resumption resumption;
    std::string settings;
    reading(where, [&] {
        const Json json = config::requireOutsideJson<Json>(text);
        json.at("state_hash").get_to(resumption.stateHash);
        json.at("recovered").get_to(resumption.isRecovered);
        settings = json.at("settings").dump();
    });
    resumption.settings = settingsFromJson(settings, where);
    return resumption;
}

std::string burChangeJson(const SimulationSettings& s) {
    return textOf({{"bur", plainNameOf(*s.bur)},
                   {"outline_mm", toJson(s.bur->profile())},
                   {"ability", toJson(s.cuttingParameters)},
                   {"hull", s.hull}});
}

std::string driveChangeJson(const SimulationSettings& s) {
    return textOf({{"drive", toJson(s.drive)}});
}

std::string parameterChangeJson(const SimulationSettings& s) {
    return textOf({{"force", toJson(s.parameters)}});
}

Changed applyChange(const std::string& text, SimulationSettings& settings, const std::string& where) {
    Changed changed;
    SimulationSettings next = settings;
    reading(where, [&] {
        const Json json = config::requireOutsideJson<Json>(text);
        const Read read{json};
        if ((changed.work = json.contains("outline_mm"))) {
            next.bur = burFrom(json);
            read("ability", next.cuttingParameters);
            next.hull = json.at("hull");
            instrument::validate(next.cuttingParameters);
        }
        if ((changed.drive = json.contains("drive"))) {
            read("drive", next.drive);
            instrument::validate(next.drive);
        }
        if ((changed.parameters = json.contains("force"))) {
            read("force", next.parameters);
            force::validate(next.parameters);
        }
    });
    settings = std::move(next);
    return changed;
}

SimulationSettings settingsFromJson(const std::string& text, const std::string& where) {
    SimulationSettings s;
    reading(where, [&] {
        const Json json = config::requireOutsideJson<Json>(text);
        const Read read{json};
        s.rateHz = json.at("rate_hz");
        s.field.voxelMm = json.at("field").at("voxel_mm");
        s.field.bandOutMm = json.at("field").at("band_out_mm");
        s.field.bandInMm = json.at("field").at("band_in_mm");
        s.cut.bandMm = json.at("cut").at("band_mm");
        Read{json.at("cut")}("reserve_bricks", s.cut.reserveBricks);
        s.bur = burFrom(json);
        read("ability", s.cuttingParameters);
        read("drive", s.drive);
        read("tissues", s.tissues);
        read("device", s.capability);
        read("force", s.parameters);
        s.fullRemoval = json.at("full_removal");
        s.hull = json.value("hull", false);
        s.resumed = json.at("resumed");
        validate(s);
    });
    return s;
}

tooth::Teeth SimulationSetup::teeth() const {
    tooth::Teeth teeth{tooth};
    for (std::size_t i = 0; i < others.size(); ++i)
        if (others[i].field) {
            teeth.resize(i + 2);
            teeth.back() = others[i].model;
        }
    return teeth;
}

tooth::StateDelta SimulationSetup::state() const {
    tooth::StateDelta state = field->state();
    for (const StandingTooth& other : others)
        if (other.field) state.append(other.field->state());
    return state;
}

void SimulationSetup::renewFields() {
    field = std::make_shared<tooth::ToothState>(tooth);
    for (StandingTooth& other : others)
        if (other.field) other.field = std::make_shared<tooth::ToothState>(other.model, other.field->toothNumber());
}

void SimulationSetup::put(const tooth::StateDelta& change) const {
    const auto putInto = [&change](tooth::ToothState& into) {
        const auto first = std::partition_point(
            change.bricks.begin(), change.bricks.end(),
            [&into](const tooth::StateDelta::Brick& b) { return tooth::toothOf(b.id) < into.toothNumber(); });
        (void)into.restore(change, static_cast<std::size_t>(first - change.bricks.begin()), change.bricks.size() + 1);
    };
    putInto(*field);
    for (const StandingTooth& other : others)
        if (other.field) putInto(*other.field);
}

void SimulationSetup::resume(const tooth::StateDelta& state) const {
    put(state);
    discardBricks();
}

void SimulationSetup::discardBricks() const {
    const auto discard = [](tooth::ToothState& of) {
        while (of.handOver(of.waitingBricks(), [](const tooth::BrickSnapshot&) { return true; }) > 0) {
        }
    };
    discard(*field);
    for (const StandingTooth& other : others)
        if (other.field) discard(*other.field);
}

loop::Work SimulationSetup::work() const {
    if (settings.hull) {
        // Of the outline, which is what a session keeps of a bur.
        const instrument::Bur bur(settings.bur->name(), settings.bur->profile());
        return {contact::makeHullMethod(tooth->outer, bur.mesh()), nullptr};
    }
    std::vector<cutting::CutTooth> cut{{field, {}}};
    for (const StandingTooth& other : others)
        if (other.field) cut.push_back({other.field, other.inCase});
    auto cutter = std::make_unique<cutting::Cutter>(std::move(cut), settings.bur, settings.cuttingParameters,
                                                    settings.tissues, cutting::Cutter::Settings{settings.fullRemoval});
    const std::shared_ptr<const tooth::ToothState> own(field);
    if (others.empty()) return {contact::makeFieldMethod(own, settings.bur), std::move(cutter)};
    std::vector<contact::PlacedMethod> placed;
    const contact::FeltInstrument felt(settings.bur);
    felt.place(own, {}, placed);
    for (std::size_t i = 0; i < others.size(); ++i) {
        const StandingTooth& other = others[i];
        const contact::FeltInstrument::Standing standing{other.inCase, static_cast<std::uint16_t>(i + 1),
                                                         other.isYielding, other.isBone, other.field != nullptr};
        if (other.field)
            felt.place(std::shared_ptr<const tooth::ToothState>(other.field), standing, placed);
        else
            felt.place(other.model, standing, placed);
    }
    return {contact::makeMouthMethod(std::move(placed)), std::move(cutter)};
}

std::vector<NickedTooth> nickedTeeth(const SimulationSetup& station) {
    std::vector<NickedTooth> nicked;
    for (const StandingTooth& other : station.others)
        if (other.field && tooth::sumOf(other.field->removedMm3()) > 0.0)
            nicked.push_back(
                {other.field->toothNumber(), other.fdiNumber, other.model->name, other.field->removedMm3()});
    return nicked;
}

std::string nickedJson(const std::vector<NickedTooth>& nicked) {
    Json list = Json::array();
    for (const NickedTooth& tooth : nicked) {
        Json removed = Json::object();
        for (std::size_t t = 0; t < cases::kTissueCount; ++t)
            if (tooth.removedMm3[t] > 0.0)
                removed[std::string(cases::properties(static_cast<cases::Tissue>(t)).name)] = tooth.removedMm3[t];
        list.push_back(
            {{"tooth", tooth.number}, {"fdi", tooth.fdiNumber}, {"name", tooth.name}, {"removed_mm3", removed}});
    }
    return textOf(list);
}

SimulationSetup makeSimulation(const cases::Case& toothCase, SimulationSettings settings, bool useCache,
                               const core::Progress& progress) {
    SimulationSetup station;
    const double own = toothCase.others.empty() ? 1.0 : 0.3;  // of the work
    station.tooth =
        tooth::loadModel(toothCase, {settings.field, settings.cut, useCache}, core::part(progress, 0.0, own));
    station.field = std::make_shared<tooth::ToothState>(station.tooth);
    station.settings = std::move(settings);
    std::vector<const cases::Part*> periodontium;
    for (const cases::Part& part : toothCase.scenery)
        if (part.isFelt && (part.tissue == cases::Tissue::gum || part.tissue == cases::Tissue::bone))
            periodontium.push_back(&part);
    const std::size_t teeth = toothCase.others.size(), count = teeth + periodontium.size();
    station.others.resize(count);
    std::vector<std::exception_ptr> failures(count);
    std::atomic<std::size_t> done{0};
    const auto stand = [&](std::size_t i) {
        const cases::PlacedTooth* const other = i < teeth ? &toothCase.others[i] : nullptr;
        const cases::Part* const plain = other == nullptr ? periodontium[i - teeth] : nullptr;
        const bool isCut = other != nullptr && other->isCuttable;
        cases::Case alone;
        if (isCut) {
            static_cast<cases::Tooth&>(alone) = *other;
        } else {
            alone.parts = {other != nullptr ? cases::Part{other->name, cases::Tissue::neighbour, 0, other->surface()}
                                            : *plain};
            alone.name = alone.parts.front().name;
        }
        alone.source = toothCase.source;
        const double voxelMm = plain == nullptr             ? kStandingVoxelMm
                               : cases::isHeldAside(*plain) ? kCheekVoxelMm
                                                            : kPlainVoxelMm;
        const tooth::LoadSettings loading =
            isCut ? tooth::LoadSettings{station.settings.field,
                                        {station.settings.cut.bandMm, kStandingReserveBricks},
                                        useCache}
                  : tooth::LoadSettings{fieldSettingsAt(voxelMm), {}, useCache};
        const core::Progress share = [&](double) {
            return !progress || progress(own + (1.0 - own) * static_cast<double>(done) / static_cast<double>(count));
        };
        try {
            StandingTooth& made = station.others[i];
            made.model = tooth::loadModel(alone, loading, share);
            if (plain == nullptr) {
                made.inCase = other->inCase;
                made.fdiNumber = other->fdiNumber;
            } else {
                made.isYielding = plain->tissue == cases::Tissue::gum;
                made.isBone = !made.isYielding;
            }
            if (isCut) made.field = std::make_shared<tooth::ToothState>(made.model, static_cast<std::uint16_t>(i + 1));
        } catch (const core::Error& e) {
            failures[i] = std::make_exception_ptr(
                core::Error(fmt::format("{}: {}", alone.name, e.problem()), e.where(), e.remedy())
                    .as(e.id(), e.arguments()));
        }
        ++done;
    };
    core::parallelFor(count, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i)
            stand(i);
    });
    core::report(progress, 1.0);  // cancelled
    // The same one is told whoever was first.
    for (const std::exception_ptr& failure : failures)
        if (failure) std::rethrow_exception(failure);
    return station;
}

}  // namespace handpiece::simulation
