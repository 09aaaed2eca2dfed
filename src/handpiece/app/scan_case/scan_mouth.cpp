// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_case/scan_mouth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "handpiece/app/scan_case/scan_scenery.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/model/case/work_on.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/scan/landmarks/find_landmarks.h"
#include "handpiece/scan/registration/place_arches.h"

namespace handpiece::scan_case {
namespace {

using core::Vec3;
using segmentation::LabelledTooth;

constexpr double kJawReachMm = 6.0;
constexpr double kSpeckOfToothMm3 = 0.5;  ///< a smaller loose piece is nothing to speak of

std::vector<LabelledTooth> wholeTeeth(const std::vector<LabelledTooth>& all) {
    std::vector<LabelledTooth> teeth;
    std::copy_if(all.begin(), all.end(), std::back_inserter(teeth), [](const auto& t) { return !isSpeck(t); });
    return teeth;
}

std::string listOf(std::vector<int> fdi) {
    std::sort(fdi.begin(), fdi.end());
    return fmt::format("{}", fmt::join(fdi, ", "));
}

std::vector<int> numbersOf(const std::vector<LabelledTooth>& teeth) {
    std::vector<int> numbers;
    for (const LabelledTooth& tooth : teeth)
        numbers.push_back(tooth.fdi);
    return numbers;
}

/// Molars are what most exercises are of, lower right ones first; teeth with others beside them.
LabelledTooth mostSuited(const std::vector<LabelledTooth>& teeth) {
    constexpr std::array<int, 8> kPlaces{6, 7, 5, 4, 1, 3, 2, 8};
    constexpr std::array<int, 4> kQuadrants{4, 3, 1, 2};
    const auto cost = [&](const LabelledTooth& tooth) {
        const auto beside = std::count_if(teeth.begin(), teeth.end(), [&](const LabelledTooth& o) {
            return cases::areAdjacentTeeth(tooth.fdi, o.fdi);
        });
        const int place = tooth.fdi % 10, quadrant = tooth.fdi / 10;
        const auto at = std::find(kPlaces.begin(), kPlaces.end(), place) - kPlaces.begin();
        const auto side = std::find(kQuadrants.begin(), kQuadrants.end(), (quadrant - 1) % 4 + 1) - kQuadrants.begin();
        return (tooth.isCutOff ? 1000 : 0) + (quadrant > 4 ? 500 : 0) + 100 * (2 - static_cast<int>(beside)) +
               10 * static_cast<int>(at) + static_cast<int>(side);
    };
    return *std::min_element(teeth.begin(), teeth.end(),
                             [&](const auto& a, const auto& b) { return cost(a) < cost(b); });
}

/// The tooth whose label lies at a place; 0: none does.
int fdiAt(const ScanResult& result, const Vec3& mm) {
    const auto at = result.labels->grid.indexAt(mm);
    if (!at) return 0;
    using What = segmentation::LabelMeaning::What;
    const auto& meaning = result.labelKey->of[result.labels->values[*at]];
    return meaning.what == What::tooth || meaning.what == What::pulp ? meaning.number : 0;
}

const LabelledTooth& chosen(ScanResult& result, const std::vector<LabelledTooth>& teeth) {
    int asked = result.job.placing.fdiNumber;
    if (asked == 0 && result.job.segmentation.toothAtMm) {
        asked = fdiAt(result, *result.job.segmentation.toothAtMm);
        if (asked == 0)
            throw core::Error("there is no tooth at the place that was pointed at", "labels",
                              "point at a labelled voxel")
                .as("no-tooth-there");
    }
    if (asked == 0) {
        asked = mostSuited(teeth).fdi;
        result.toothNotes.push_back(
            teeth.size() == 1
                ? fmt::format("the only tooth in the labels is {}", asked)
                : fmt::format("the tooth that is worked on is {}, for want of another choice; there are {}", asked,
                              listOf(numbersOf(teeth))));
    }
    const auto found = std::find_if(teeth.begin(), teeth.end(), [&](const LabelledTooth& t) { return t.fdi == asked; });
    if (found == teeth.end())
        throw core::Error(fmt::format("there is no tooth {} in the labels", asked), "labels",
                          fmt::format("there are {}", listOf(numbersOf(teeth))))
            .as("label-without-tooth", {std::to_string(asked), listOf(numbersOf(teeth))});
    return *found;
}

/// What is told of a tooth.
struct NoteOfTooth {
    int fdi;
    std::string text;
    double leftOutMm3 = 0.0;
};
using NotesOfTeeth = std::vector<NoteOfTooth>;

/// What is told of several teeth in the same words is one note.
std::vector<std::string> folded(const NotesOfTeeth& notes) {
    struct Alike {
        std::string text;
        std::vector<int> teeth;
        double leftOutMm3;
    };
    std::vector<Alike> all;
    for (const NoteOfTooth& note : notes) {
        auto alike = std::find_if(all.begin(), all.end(), [&](const Alike& a) { return a.text == note.text; });
        if (alike == all.end()) alike = all.insert(all.end(), {note.text, {}, 0.0});
        alike->teeth.push_back(note.fdi);
        alike->leftOutMm3 += note.leftOutMm3;
    }
    std::vector<std::string> told;
    for (const Alike& a : all)
        told.push_back(fmt::format("{}: {}{}", listOf(a.teeth), a.text,
                                   a.leftOutMm3 > 0.0 ? fmt::format(", {:.1f} mm3 are left out", a.leftOutMm3) : ""));
    return told;
}

/// One of the others, or the one that is worked on.
segmentation::Region regionOf(const ScanResult& result, const LabelledTooth& tooth,
                              const segmentation::Settings& settings, NotesOfTeeth& notes,
                              const core::Progress& progress) {
    const segmentation::ToothAlone alone = segmentation::alone(*result.labels, *result.labelKey, tooth);
    if (alone.pieces > 1 && alone.leftOutMm3 >= kSpeckOfToothMm3)
        notes.push_back({tooth.fdi, "in several pieces, of which the largest is kept", alone.leftOutMm3});
    if (!result.grey) return segmentation::segmentLabels(alone.labels, settings, progress);
    return segmentation::segmentWithin(result.grey->volume, result.greyLevels, *result.labels, *result.labelKey, alone,
                                       settings, progress);
}

/// A scan that the labels are not of, or that is shifted against them, shows by what is dark in their teeth.
void requireSamePlace(ScanResult& result) {
    constexpr double kRefused = 0.35, kTold = 0.7;
    using What = segmentation::LabelMeaning::What;
    const volume::Grid &labels = result.labels->grid, &grey = result.grey->volume.grid;
    std::size_t inTeeth = 0, bright = 0, n = 0;
    for (int k = 0; k < labels.size[2]; ++k)
        for (int j = 0; j < labels.size[1]; ++j)
            for (int i = 0; i < labels.size[0]; ++i, ++n) {
                if (result.labelKey->of[result.labels->values[n]].what != What::tooth) continue;
                const auto at = grey.indexAt(labels.toMm(Vec3(i, j, k)));
                if (!at) continue;
                ++inTeeth;
                if (result.grey->volume.values[*at] >= result.greyLevels.toothFrom) ++bright;
            }
    if (inTeeth == 0) return;  // which is told elsewhere, by tooth
    const double share = static_cast<double>(bright) / static_cast<double>(inTeeth);
    const std::string said =
        fmt::format("only {:.0f} % of what the labels call teeth is as bright as a tooth in the scan", 100.0 * share);
    if (share < kRefused)
        throw core::Error(said + ": it is another scan, or shifted against them", result.job.grey.filename().string(),
                          "give the scan that the labels were made from, or leave it out")
            .as("grey-elsewhere");
    if (share < kTold) result.toothNotes.push_back(said + ": are they of this scan?");
}

/// The same tooth of the other side.
int mirrored(int fdi) {
    const int quadrant = fdi / 10;
    return 10 * (quadrant % 2 == 1 ? quadrant + 1 : quadrant - 1) + fdi % 10;
}

}  // namespace

ToothWords wordsOf(int fdi) {
    if (fdi == 0) return {};
    if (!cases::isPermanentTooth(fdi)) return {fmt::format("deciduous tooth {}", fdi), {}};
    return {dentition::toothName(fdi), dentition::toothKindName(fdi)};
}

segmentation::Region segmentMouth(ScanResult& result, const core::Progress& progress) {
    result.teeth = segmentation::teethOf(*result.labels, *result.labelKey);
    const std::vector<LabelledTooth> teeth = wholeTeeth(result.teeth);
    if (teeth.empty())
        throw core::Error("no label of a tooth has more than a speck", "labels", "look at the labels: they hold none")
            .as("labels-empty");
    for (const LabelledTooth& tooth : result.teeth)
        if (isSpeck(tooth))
            result.toothNotes.push_back(fmt::format("{} is left out: its label has {} {} ({:.2g} mm3)", tooth.fdi,
                                                    tooth.voxels, tooth.voxels == 1 ? "voxel" : "voxels",
                                                    tooth.volumeMm3));
    std::vector<int> cut;
    for (const LabelledTooth& tooth : teeth)
        if (tooth.isCutOff) cut.push_back(tooth.fdi);
    if (!cut.empty())
        result.toothNotes.push_back(fmt::format("the border of the volume cuts off {}: closed there", listOf(cut)));
    const LabelledTooth& own = chosen(result, teeth);
    result.fdiNumber = own.fdi;
    const Vec3 spacing = result.labels->grid.spacingMm;
    if (spacing.maxCoeff() > 1.2 * spacing.minCoeff())
        result.toothNotes.push_back(fmt::format(
            "the voxels are {:.3g} x {:.3g} x {:.3g} mm: what lies between slices so far apart is filled in",
            spacing.x(), spacing.y(), spacing.z()));
    if (result.grey) {
        result.toothNotes.emplace_back(
            "the labels tell which tooth is where, the scan that they are of its tissues and its outline between "
            "voxels");
        const ScanJob& job = result.job;
        result.greyLevels = segmentation::findThresholds(result.grey->volume, core::part(progress, 0.0, 0.3));
        if (job.toothFrom) result.greyLevels.toothFrom = static_cast<float>(*job.toothFrom);
        if (job.enamelFrom) result.greyLevels.enamelFrom = static_cast<float>(*job.enamelFrom);
        requireSamePlace(result);
    } else {
        result.toothNotes.emplace_back(
            own.hasPulp ? "the labels tell the pulp, but no enamel from dentine: all around the pulp counts as enamel"
                        : "the labels tell no tissues in a tooth: all of it counts as enamel, without pulp");
    }
    segmentation::Settings settings = result.job.segmentation;
    settings.toothAtMm.reset();
    NotesOfTeeth notes;
    segmentation::Region region =
        regionOf(result, own, settings, notes, core::part(progress, result.grey ? 0.3 : 0.0, 1.0));
    for (std::string& note : folded(notes))
        result.toothNotes.push_back(std::move(note));
    return region;
}

void surfaceOthers(ScanResult& result, surfacing::Surfaces& own, const core::Progress& progress) {
    result.others.clear();
    result.mouthNotes.clear();
    const std::vector<LabelledTooth> teeth = wholeTeeth(result.teeth);
    segmentation::Settings settings;
    settings.spacingMm = result.job.segmentation.spacingMm;
    settings.thresholds = result.job.segmentation.thresholds;
    settings.damp = result.job.segmentation.damp;
    settings.findCaries = result.job.segmentation.findCaries;
    std::vector<int> fdi;
    NotesOfTeeth notes;
    std::vector<std::shared_ptr<surfacing::Surfaces>> made;
    for (std::size_t i = 0; i < teeth.size(); ++i) {
        core::report(progress, 0.8 * static_cast<double>(i) / static_cast<double>(teeth.size()));
        if (teeth[i].fdi == result.fdiNumber) continue;
        const segmentation::Region region = regionOf(result, teeth[i], settings, notes, {});
        made.push_back(std::make_shared<surfacing::Surfaces>(surfacing::makeSurfaces(region, {result.job.smooth})));
        fdi.push_back(teeth[i].fdi);
        for (const std::string& note : region.notes)
            notes.push_back({teeth[i].fdi, note});
        for (const std::string& note : made.back()->notes)
            notes.push_back({teeth[i].fdi, note});
    }
    result.mouthNotes = folded(notes);
    std::vector<surfacing::Surfaces*> all{&own};
    for (const auto& surfaces : made)
        all.push_back(surfaces.get());
    const surfacing::Parted parted =
        surfacing::partTeeth(all, result.labels->grid.spacingMm.minCoeff(), core::part(progress, 0.8, 1.0));
    if (parted.teeth > 0)
        result.mouthNotes.push_back(fmt::format(
            "{} {} reached into another where they touch, and {} drawn back by at most {:.3f} mm", parted.teeth,
            parted.teeth == 1 ? "tooth" : "teeth", parted.teeth == 1 ? "was" : "were", parted.movedMm));
    for (std::size_t i = 0; i < made.size(); ++i)
        result.others.push_back({fdi[i], made[i], {}});
}

void placeMouth(ScanResult& result, const core::Progress& progress) {
    std::vector<registration::ToothOfArch> teeth{{result.fdiNumber, &result.full->outer.mesh}};
    for (const OtherTooth& other : result.others)
        teeth.push_back({other.fdi, &other.full->outer.mesh});
    registration::PlacedArches arches = registration::placeArches(teeth);
    std::vector<int> byArch, guessed;
    for (std::size_t i = 0; i < teeth.size(); ++i) {
        core::report(progress, 0.6 * static_cast<double>(i) / static_cast<double>(teeth.size()));
        registration::Placed& placed = arches.teeth[i];
        const int form = arches.isMirrored ? mirrored(teeth[i].fdi) : teeth[i].fdi;
        if (placed.isMesialGuessed) guessed.push_back(teeth[i].fdi);
        if (const auto lie = landmarks::lieOf(form, *teeth[i].outer, placed.scanInTooth)) {
            placed.scanInTooth = lie->surfaceInTooth;
            if (!placed.isMesialGuessed) placed.confidence = 0.95;
        } else if (!placed.isMesialGuessed) {
            byArch.push_back(teeth[i].fdi);
        }
    }
    result.ownNotes.clear();
    if (arches.isMirrored)
        result.ownNotes.emplace_back(
            "by their numbers these teeth stand on the other side of the mouth than in the volume: it is a mirror "
            "image, or its numbers are. Look which, before it matters");
    if (!byArch.empty())
        result.ownNotes.push_back(
            fmt::format("{} {} as the arch tells: no average tooth of the number fits, and the cervix was put at "
                        "three fifths of the length",
                        listOf(byArch), byArch.size() == 1 ? "stands" : "stand"));
    if (!guessed.empty())
        result.ownNotes.push_back(
            fmt::format("where mesial is at {} is a guess: no other tooth of its jaw is there", listOf(guessed)));
    const registration::Hints& hints = result.job.placing;
    registration::Placed own = arches.teeth.front();
    if (hints.occlusal || hints.mesial) {
        // By hand as far as it was given.
        registration::Hints given = hints;
        given.fdiNumber = result.fdiNumber;
        const core::Quat toScan = own.scanInTooth.orientation.conjugate();
        if (!given.occlusal) given.occlusal = toScan * Vec3::UnitZ();
        if (!given.mesial) given.mesial = toScan * Vec3::UnitX();
        own = registration::place(*result.full, given);
    }
    result.placed = std::move(own);
    for (std::size_t i = 0; i < result.others.size(); ++i)
        result.others[i].placed = arches.teeth[i + 1];
    std::array<core::Box, 2> jaws;
    for (const registration::ToothOfArch& tooth : teeth) {
        core::Box& box = jaws[cases::isLowerTooth(tooth.fdi) ? 1 : 0];
        const core::Box own1 = tooth.outer->bounds();
        box.extend(own1.min);
        box.extend(own1.max);
    }
    result.scenery = jawsOf(*result.labels, *result.labelKey, jaws, kJawReachMm, core::part(progress, 0.6, 1.0));
    const auto unfelt = std::count_if(result.scenery.begin(), result.scenery.end(), [](const cases::Part& part) {
        return !part.isFelt && part.tissue != cases::Tissue::restoration;
    });
    if (unfelt > 0)
        result.ownNotes.push_back(fmt::format("{} {} of the jaws {} no closed solid, and can be seen but not felt",
                                              unfelt, unfelt == 1 ? "piece" : "pieces", unfelt == 1 ? "is" : "are"));
}

void addOthers(const ScanResult& result, double percent, cases::Case& made) {
    const core::Pose scanInCase = result.placed.scanInTooth;
    for (const OtherTooth& other : result.others) {
        registration::CaseText text;
        const ToothWords words = wordsOf(other.fdi);
        text.name = words.name;
        text.kind = words.kind;
        text.fdiNumber = other.fdi;
        const surfacing::Surfaces surfaces = surfacing::decimated(*other.full, percent);
        cases::PlacedTooth tooth;
        static_cast<cases::Tooth&>(tooth) = registration::makeCase(surfaces, other.placed, text);
        tooth.inCase = (scanInCase * other.placed.scanInTooth.inverse()).normalised();
        made.others.push_back(std::move(tooth));
    }
    cases::chooseCuttable(made);
}

}  // namespace handpiece::scan_case
