// SPDX-License-Identifier: Apache-2.0
#include "cli/station.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/progress_bar.h"
#include "handpiece/base/core/error.h"
#include "handpiece/tick/contact/field_method.h"

namespace handpiece::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json toJson(const core::Vec3& v) {
    return Json::array({v.x(), v.y(), v.z()});
}

Json toJson(const instrument::Ability& a) {
    return {{"name", a.name},
            {"cutting", a.cutting},
            {"load_cap_n", a.loadCapN},
            {"friction_cutting", a.frictionCutting},
            {"chip_mm", a.chipMm},
            {"edges", a.edges},
            {"centre_radius", a.centreRadius}};
}

Json toJson(const instrument::Drive& d) {
    return {{"name", d.name},
            {"free_speed_rpm", d.freeSpeedRpm},
            {"stall_torque_nmm", d.stallTorqueNmm},
            {"inertia_nmms2", d.inertiaNmmS2},
            {"bearing_torque_nmm", d.bearingTorqueNmm}};
}

Json toJson(const tooth::TissueTable& table) {
    Json rows;
    for (const tooth::TissueProperties& t : table.rows)
        rows[std::string(t.name)] = {{"stiffness", t.stiffnessFraction}, {"damping", t.dampingNSPerMm},
                                     {"friction", t.friction},           {"cutting", t.cuttingMm2PerN},
                                     {"priority", t.priority},           {"colour", t.colour}};
    return rows;
}

Json toJson(const device::Capability& c) {
    return {{"name", c.name},
            {"max_force_n", c.maxForceN},
            {"continuous_force_n", c.continuousForceN},
            {"max_stiffness_n_per_mm", c.maxStiffnessNPerMm},
            {"max_damping_ns_per_mm", c.maxDampingNSPerMm},
            {"max_force_slope_n_per_s", c.maxForceSlopeNPerS},
            {"max_torque_nmm", c.maxTorqueNmm},
            {"encoder_step_mm", c.encoderStepMm},
            {"workspace_mm", toJson(c.workspaceMm)},
            {"sensed_axes", c.sensedAxes},
            {"driven_axes", c.drivenAxes},
            {"rate_hz", c.rateHz}};
}

Json toJson(const force::Parameters& p) {
    Json tissues = Json::array();
    for (const force::TissueFeel& t : p.tissues)
        tissues.push_back({t.stiffnessFraction, t.dampingNSPerMm, t.friction});
    return {{"mode", p.mode == force::Mode::proxy ? "proxy" : "penalty"},
            {"stiffness_multiplier", p.stiffnessMultiplier},
            {"damping_multiplier", p.dampingMultiplier},
            {"friction_multiplier", p.frictionMultiplier},
            {"cutting_force_multiplier", p.cuttingForceMultiplier},
            {"tissues", tissues},
            {"penalty_stiffness_n_per_mm", p.penaltyStiffnessNPerMm},
            {"penalty_damping_ns_per_mm", p.penaltyDampingNSPerMm},
            {"velocity_tau_s", p.velocityTauS},
            {"damping_ramp_mm", p.dampingRampMm},
            {"grip_mm", toJson(p.gripMm)},
            {"fade_in_s", p.fadeInS},
            {"proxy_iterations", p.proxy.iterations},
            {"proxy_max_step_mm", p.proxy.maxStepMm},
            {"proxy_tolerance_mm", p.proxy.toleranceMm}};
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

void from(const Json& j, core::Vec3& v) {
    for (std::size_t k = 0; k < 3; ++k)
        v[static_cast<int>(k)] = j.at(k).get<double>();
}

void from(const Json& j, instrument::Ability& a) {
    a.name = j.at("name");
    a.cutting = j.at("cutting");
    a.loadCapN = j.at("load_cap_n");
    a.frictionCutting = j.at("friction_cutting");
    a.chipMm = j.at("chip_mm");
    a.edges = j.at("edges");
    a.centreRadius = j.at("centre_radius");
}

void from(const Json& j, instrument::Drive& d) {
    d.name = j.at("name");
    d.freeSpeedRpm = j.at("free_speed_rpm");
    d.stallTorqueNmm = j.at("stall_torque_nmm");
    d.inertiaNmmS2 = j.at("inertia_nmms2");
    d.bearingTorqueNmm = j.at("bearing_torque_nmm");
}

void from(const Json& j, tooth::TissueTable& table) {
    for (tooth::TissueProperties& t : table.rows) {
        const Json& row = j.at(std::string(t.name));
        t.stiffnessFraction = row.at("stiffness");
        t.dampingNSPerMm = row.at("damping");
        t.friction = row.at("friction");
        t.cuttingMm2PerN = row.at("cutting");
        t.priority = row.at("priority");
        t.colour = row.at("colour");
    }
}

void from(const Json& j, device::Capability& c) {
    c.name = j.at("name");
    c.maxForceN = j.at("max_force_n");
    c.continuousForceN = j.at("continuous_force_n");
    c.maxStiffnessNPerMm = j.at("max_stiffness_n_per_mm");
    c.maxDampingNSPerMm = j.at("max_damping_ns_per_mm");
    c.maxForceSlopeNPerS = j.at("max_force_slope_n_per_s");
    c.maxTorqueNmm = j.at("max_torque_nmm");
    c.encoderStepMm = j.at("encoder_step_mm");
    from(j.at("workspace_mm"), c.workspaceMm);
    c.sensedAxes = j.at("sensed_axes");
    c.drivenAxes = j.at("driven_axes");
    c.rateHz = j.at("rate_hz");
}

void from(const Json& j, force::Parameters& p) {
    p.mode = force::modeByName(j.at("mode").get<std::string>());
    p.stiffnessMultiplier = j.at("stiffness_multiplier");
    p.dampingMultiplier = j.at("damping_multiplier");
    p.frictionMultiplier = j.at("friction_multiplier");
    p.cuttingForceMultiplier = j.at("cutting_force_multiplier");
    for (std::size_t i = 0; i < p.tissues.size(); ++i) {
        const Json& row = j.at("tissues").at(i);
        p.tissues[i] = {row.at(0), row.at(1), row.at(2)};
    }
    p.penaltyStiffnessNPerMm = j.at("penalty_stiffness_n_per_mm");
    p.penaltyDampingNSPerMm = j.at("penalty_damping_ns_per_mm");
    p.velocityTauS = j.at("velocity_tau_s");
    p.dampingRampMm = j.at("damping_ramp_mm");
    from(j.at("grip_mm"), p.gripMm);
    p.fadeInS = j.at("fade_in_s");
    p.proxy.iterations = j.at("proxy_iterations");
    p.proxy.maxStepMm = j.at("proxy_max_step_mm");
    p.proxy.toleranceMm = j.at("proxy_tolerance_mm");
}

}  // namespace

std::string settingsJson(const StationSettings& s) {
    // A bur may be named by a file, and a file by a folder, and a folder by its owner: the last name is enough.
    const std::string bur = fs::path(s.bur->name()).filename().string();
    const Json json = {
        {"rate_hz", s.rateHz},
        {"field",
         {{"voxel_mm", s.field.voxelMm}, {"band_out_mm", s.field.bandOutMm}, {"band_in_mm", s.field.bandInMm}}},
        {"cut", {{"band_mm", s.cut.bandMm}, {"reserve_bricks", s.cut.reserveBricks}}},
        {"bur", bur},
        {"outline_mm", toJson(s.bur->profile())},
        {"ability", toJson(s.ability)},
        {"drive", toJson(s.drive)},
        {"tissues", toJson(s.tissues)},
        {"device", toJson(s.capability)},
        {"force", toJson(s.parameters)},
        {"full_removal", s.fullRemoval},
        {"resumed", s.resumed}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

StationSettings settingsFromJson(const std::string& text, const std::string& where) {
    StationSettings s;
    instrument::Profile outline;
    std::string bur;
    try {
        const Json json = Json::parse(text);
        s.rateHz = json.at("rate_hz");
        s.field.voxelMm = json.at("field").at("voxel_mm");
        s.field.bandOutMm = json.at("field").at("band_out_mm");
        s.field.bandInMm = json.at("field").at("band_in_mm");
        s.cut.bandMm = json.at("cut").at("band_mm");
        s.cut.reserveBricks = json.at("cut").at("reserve_bricks");
        from(json.at("outline_mm"), outline);
        bur = json.at("bur");
        from(json.at("ability"), s.ability);
        from(json.at("drive"), s.drive);
        from(json.at("tissues"), s.tissues);
        from(json.at("device"), s.capability);
        from(json.at("force"), s.parameters);
        s.fullRemoval = json.at("full_removal");
        s.resumed = json.at("resumed");
    } catch (const Json::exception& e) {
        throw core::Error(fmt::format("the settings inside cannot be read: {}", e.what()), where,
                          "record the session anew, or use the version that wrote it");
    }
    s.bur = std::make_shared<const instrument::Bur>(bur, std::move(outline));
    instrument::validate(s.ability);
    instrument::validate(s.drive);
    force::validate(s.parameters);
    return s;
}

void Station::resume(const tooth::CutState& state) const {
    for (std::size_t next = 0; next < state.bricks.size();)
        next = field->restore(state, next, state.bricks.size());
    while (field->handOver(state.bricks.size(), [](const tooth::BrickSnapshot&) { return true; }) > 0) {
        // Whoever listens begins with this state.
    }
}

loop::Work Station::work() const {
    return {contact::makeFieldMethod(std::shared_ptr<const tooth::CutField>(field), settings.bur),
            std::make_unique<cutting::Cutter>(field, settings.bur, settings.ability, settings.tissues,
                                              cutting::Cutter::Settings{settings.fullRemoval})};
}

Station makeStation(const tooth::Case& toothCase, StationSettings settings, bool useCache) {
    tooth::PrepareSettings prepare;
    prepare.field = settings.field;
    prepare.useCache = useCache;
    Station station;
    ProgressBar bar("preparing the tooth");
    const core::Progress progress = bar.listener();
    const auto tooth = tooth::prepareTooth(toothCase, prepare, core::part(progress, 0.0, 0.6));
    station.tooth = tooth::prepareCutting(toothCase, tooth, prepare, settings.cut, core::part(progress, 0.6, 1.0));
    station.field = std::make_shared<tooth::CutField>(station.tooth);
    station.settings = std::move(settings);
    return station;
}

}  // namespace handpiece::cli
