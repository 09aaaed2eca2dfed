// SPDX-License-Identifier: Apache-2.0
#include "studies/told_json.h"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "handpiece/app/report/report_figures.h"

namespace handpiece::studies {

using Json = nlohmann::ordered_json;

namespace {

Json toJson(const core::Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

}  // namespace

Json toJson(const geometry::MeshReport& r) {
    Json json{{"vertices", r.vertices},
              {"faces", r.faces},
              {"edges", r.edges},
              {"box_min_mm", toJson(r.boxMm.min)},
              {"box_max_mm", toJson(r.boxMm.max)},
              {"box_size_mm", toJson(r.boxMm.size())},
              {"area_mm2", r.areaMm2},
              {"volume_mm3", r.volumeMm3},
              {"shells", r.shells},
              {"open_edges", r.openEdges},
              {"boundary_loops", r.boundaryLoops},
              {"non_manifold_edges", r.nonManifoldEdges},
              {"non_manifold_vertices", r.nonManifoldVertices},
              {"flipped_faces", r.flippedFaces},
              {"inside_out_shells", r.insideOutShells},
              {"duplicate_vertices", r.duplicateVertices},
              {"unused_vertices", r.unusedVertices},
              {"degenerate_faces", r.degenerateFaces},
              {"duplicate_faces", r.duplicateFaces},
              {"orientable", r.orientable},
              {"closed", r.closed()},
              {"oriented", r.oriented()},
              {"euler_characteristic", r.eulerCharacteristic},
              {"genus", r.genus ? Json(*r.genus) : Json(nullptr)},
              {"probable_unit", geometry::unitName(r.unit.unit)},
              {"probable_unit_reason", r.unit.reason}};
    return json;
}

Json toJson(const geometry::RepairReport& r) {
    Json holes = Json::array();
    for (const geometry::ClosedHole& h : r.holes)
        holes.push_back({{"edges", h.edges},
                         {"perimeter_mm", h.perimeterMm},
                         {"area_mm2", h.areaMm2},
                         {"centre_mm", toJson(h.centreMm)}});
    Json bases = Json::array();
    for (const geometry::MadeBase& b : r.bases)
        bases.push_back({{"edges", b.edges},
                         {"perimeter_mm", b.perimeterMm},
                         {"depth_mm", b.depthMm},
                         {"area_mm2", b.areaMm2},
                         {"down", toJson(b.downMm)}});
    return {{"weld_mm", r.weldMm},
            {"welded_vertices", r.weldedVertices},
            {"removed_degenerate_faces", r.removedDegenerateFaces},
            {"removed_duplicate_faces", r.removedDuplicateFaces},
            {"removed_fin_faces", r.removedFinFaces},
            {"removed_fin_area_mm2", r.removedFinAreaMm2},
            {"split_edges", r.splitEdges},
            {"split_vertices", r.splitVertices},
            {"dropped_shells", r.droppedShells},
            {"dropped_faces", r.droppedFaces},
            {"dropped_area_mm2", r.droppedAreaMm2},
            {"dropped_volume_mm3", r.droppedVolumeMm3},
            {"turned_faces", r.turnedFaces},
            {"closed_holes", r.holes.size()},
            {"added_faces", r.addedFaces},
            {"holes", std::move(holes)},
            {"bases", std::move(bases)},
            {"turned_flat_faces", r.turnedFlatFaces},
            {"removed_crossing_faces", r.removedCrossingFaces},
            {"removed_crossing_area_mm2", r.removedCrossingAreaMm2},
            {"lost_area_mm2", r.lostAreaMm2},
            {"crossing_faces", r.crossingFaces},
            {"before", toJson(r.before)},
            {"after", toJson(r.after)}};
}

Json toJson(const simulation::Verdict& v, const simulation::SessionPlayer& player) {
    const report::SessionFigures figures = report::figuresOf(player.reader());
    Json out{{"state_hash", v.hash}, {"recorded_hash", v.recorded},         {"matches", v.matches},
             {"ticks", v.ticks},     {"differing_ticks", v.differingTicks}, {"complete", v.complete},
             {"seams", v.seams},     {"broken_seams", v.brokenSeams},       {"engine_revision", v.engineRevision}};
    if (!player.toothCase().others.empty())
        out["other_teeth"] = Json::parse(simulation::nickedJson(simulation::nickedTeeth(player.station())));
    Json hours = Json::object();
    for (const auto& [hour, seconds] : figures.atHourS)
        hours[std::to_string(hour)] = seconds;
    out["time_s"] = {{"total", figures.totalS},
                     {"by_mirror", figures.byMirrorS},
                     {"finger_rest", figures.fingerRestS},
                     {"at_hour", hours}};
    return out;
}

}  // namespace handpiece::studies
