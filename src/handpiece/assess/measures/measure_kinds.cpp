// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "handpiece/assess/measures/measure.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/tissue.h"

namespace handpiece::measures {
namespace {
constexpr unsigned kZone = static_cast<unsigned>(Selector::zone), kTissue = static_cast<unsigned>(Selector::tissue),
                   kSide = static_cast<unsigned>(Selector::side), kStat = static_cast<unsigned>(Selector::statistic),
                   kLimit = static_cast<unsigned>(Selector::limit);
constexpr Subject kTooth = Subject::tooth, kHand = Subject::hand;

// Sorted by id; the test holds that.
constexpr std::array kKinds{
    MeasureKind{"adjacent-depth", "mm", kTooth, 0, 0, 20, "deepest cut into any tooth beside"},
    MeasureKind{"adjacent-removed", "mm3", kTooth, 0, 0, 1e4, "taken from all teeth beside"},
    MeasureKind{"axial-depth", "mm", kTooth, kSide | kStat, 0, 20,
                "from the uncut side of the crown to the axial wall, square to it"},
    MeasureKind{"bur-changes", "", kHand, 0, 0, 1e6, "how often another bur was taken"},
    MeasureKind{"caries-left", "mm3", kTooth, kZone | kTissue, 0, 1e4, "carious tissue that is left"},
    MeasureKind{"caries-left-periphery", "mm3", kTooth, kTissue, 0, 1e4,
                "carious tissue left within 1 mm of the enamel-dentine junction"},
    MeasureKind{"caries-left-pulpal", "mm3", kTooth, kTissue, 0, 1e4,
                "carious tissue left towards the pulp, farther in than that"},
    MeasureKind{"cavosurface-angle", "deg", kTooth, kSide | kStat, 0, 360,
                "between wall and uncut surface, in the tooth"},
    MeasureKind{"depth-stop-share", "%", kHand, 0, 0, 100, "of the drill time with the depth stop on"},
    MeasureKind{"drill-time", "s", kHand, 0, 0, 1e7, "with the bur turning and tissue going"},
    MeasureKind{"finger-rest-share", "%", kHand, 0, 0, 100, "of the drill time with a finger rest"},
    MeasureKind{"floor-depth", "mm", kTooth, kSide | kStat, 0, 20,
                "from the uncut surface to the floor along the path of draw"},
    MeasureKind{"floor-depth-shortest", "mm", kTooth, kSide | kStat, 0, 20,
                "from the floor to the uncut surface, the shortest way"},
    MeasureKind{"floor-flatness", "mm", kTooth, kSide, 0, 10, "spread of the floor about its plane: p97.5 less p2.5"},
    MeasureKind{"floor-tilt", "deg", kTooth, kSide, 0, 90, "between the floor's plane and the path of draw's"},
    MeasureKind{"force", "N", kHand, kStat, 0, 100, "load on the bur while it cuts"},
    MeasureKind{"gouge-depth", "mm", kTooth, 0, 0, 20, "deepest cut into floor or walls of the pulp chamber"},
    MeasureKind{"idle-time", "s", kHand, 0, 0, 1e7, "pedal up and bur off the tooth"},
    MeasureKind{"impulse-not-undone", "N s", kHand, kTissue, 0, 1e6,
                "as impulse-on-protected, without what was done in strokes that were taken back"},
    MeasureKind{"impulse-on-protected", "N s", kHand, kTissue, 0, 1e6,
                "load by time on the pulp, a protected zone or a tooth beside"},
    MeasureKind{"isthmus", "mm", kTooth, kStat, 0, 20,
                "width of the cavity between its buccal and lingual walls at half their height"},
    MeasureKind{"isthmus-share", "%", kTooth, 0, 0, 1000,
                "narrowest isthmus over the distance of the buccal and lingual cusp tips"},
    MeasureKind{"load-over-limit", "s", kHand, kLimit, 0, 1e7, "time with more load than the limit [N]"},
    MeasureKind{"load-over-limit-share", "%", kHand, kLimit, 0, 100,
                "of the time in contact, with more load than the limit [N]"},
    MeasureKind{"margin-continuity", "%", kTooth, 0, 0, 100, "of the way round on which the margin has a width"},
    MeasureKind{"margin-height", "mm", kTooth, kSide | kStat, -20, 20, "of the margin over the gingiva's edge"},
    MeasureKind{"margin-width", "mm", kTooth, kSide | kStat, 0, 10, "of the finish line, square to the axial wall"},
    MeasureKind{"marginal-ridge-left", "mm", kTooth, kSide, 0, 20,
                "least distance from the cavity to the outside of the ridge"},
    MeasureKind{"mirror-share", "%", kHand, 0, 0, 100, "of the drill time by mirror alone"},
    MeasureKind{"occlusal-convergence", "deg", kTooth, kSide | kStat, -90, 90,
                "total, of opposite axial walls, their middle part, in eight sections or more"},
    MeasureKind{"orifices-reached", "%", kTooth, 0, 0, 100,
                "of the root canals' orifices, those that a straight line along the canal meets in the open"},
    MeasureKind{"outline-extent", "mm", kTooth, kSide, 0, 30,
                "of the cavity's outline on the uncut surface, along the axis of the side: mesial, mesiodistally"},
    MeasureKind{"path-length", "mm", kHand, 0, 0, 1e9, "way of the bur's tip"},
    MeasureKind{"proximal-clearance", "mm", kTooth, kSide | kStat, 0, 10,
                "from the cavity's margins at the contact to the tooth beside"},
    MeasureKind{"pulp-exposed", "mm2", kTooth, 0, 0, 1e3, "surface at which the pulp is open"},
    MeasureKind{"reduction", "mm", kTooth, kSide | kStat, 0, 20,
                "from the uncut surface, square to it; of a cusp or side"},
    MeasureKind{"remaining-dentine", "mm", kTooth, 0, 0, 20, "least thickness over the pulp under what was cut"},
    MeasureKind{"removed", "mm3", kTooth, kZone | kTissue, 0, 1e4, "what is gone of the tooth"},
    MeasureKind{"removed-share", "%", kTooth, kZone | kTissue, 0, 100, "what is gone of what there was"},
    MeasureKind{"roughness", "um", kTooth, kSide, 0, 1e3,
                "of a wall or floor about its fitted surface: root mean square, waves under 0.8 mm"},
    MeasureKind{"smoothness", "", kHand, 0, -1e3, 0, "spectral arc length of the tip's speed"},
    MeasureKind{"speed-under-load", "rpm", kHand, kStat, 0, 1e6, "of the bur while it cuts"},
    MeasureKind{"stalls", "", kHand, 0, 0, 1e6, "how often the bur stood under load"},
    MeasureKind{"strokes", "", kHand, 0, 0, 1e6, "pedal down to pedal up"},
    MeasureKind{"tilt", "deg", kHand, kStat, 0, 180, "of the bur against the long axis while it cuts"},
    MeasureKind{"time", "s", kHand, 0, 0, 1e7, "from the first to the last sample, pauses left out"},
    MeasureKind{"undercut-area", "mm2", kTooth, kSide, 0, 1e3,
                "wall that the path of draw cannot see, deeper than its roughness"},
    MeasureKind{"undercut-depth", "mm", kTooth, kSide, 0, 10, "deepest undercut, square to the path of draw"},
    MeasureKind{"undos", "", kHand, 0, 0, 1e6, "how often something was undone, redone or reset"},
    MeasureKind{"unsupported-enamel", "mm3", kTooth, 0, 0, 1e3,
                "enamel with no dentine left under it along its prisms"},
    MeasureKind{"views", "", kHand, 0, 0, 1e6, "directions from which was worked"},
    MeasureKind{"wall-angle", "deg", kTooth, kSide | kStat, -90, 90,
                "of a wall against the path of draw; positive opens outwards, negative is undercut"},
    MeasureKind{"wall-height", "mm", kTooth, kSide | kStat, 0, 20,
                "from floor to cavosurface, where a probe stands at the wall"},
};

void validate(const MeasureKind& kind, const Selection& of) {
    const auto refuse = [&](std::string_view what) {
        throw core::Error("a " + std::string(what) + " says nothing to this measure", std::string(kind.id),
                          "leave it out");
    };
    const auto takes = [&](Selector selector) { return (kind.takes & static_cast<unsigned>(selector)) != 0; };
    if (!of.zone.empty() && !takes(Selector::zone)) refuse("zone");
    if (!of.tissue.empty() && !takes(Selector::tissue)) refuse("tissue");
    if (!of.side.empty() && !takes(Selector::side)) refuse("side");
    if (!of.statistic.empty() && !takes(Selector::statistic)) refuse("statistic");
    if (of.limit && !takes(Selector::limit)) refuse("limit");
    if (!of.tissue.empty()) (void)cases::tissueByName(of.tissue);
    if (!of.statistic.empty() &&
        std::find(std::begin(kStatistics), std::end(kStatistics), of.statistic) == std::end(kStatistics))
        throw core::Error("there is no statistic \"" + of.statistic + "\"", std::string(kind.id),
                          "mean, median, least, greatest, p5 or p95");
}

}  // namespace

std::span<const MeasureKind> measureKinds() {
    return kKinds;
}

const MeasureKind* findMeasureKind(std::string_view id) {
    const auto at = std::lower_bound(kKinds.begin(), kKinds.end(), id,
                                     [](const MeasureKind& kind, std::string_view name) { return kind.id < name; });
    return at != kKinds.end() && at->id == id ? &*at : nullptr;
}

const MeasureKind& requireKind(const Request& request) {
    const MeasureKind* kind = findMeasureKind(request.kind);
    if (kind == nullptr)
        throw core::Error("there is no measure \"" + request.kind + "\"", "measure", "see docs/assessment.md");
    validate(*kind, request.of);
    return *kind;
}

}  // namespace handpiece::measures
