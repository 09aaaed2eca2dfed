// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/mouth.h"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/work_on.h"
#include "handpiece/model/dentition/cheeks.h"
#include "handpiece/model/dentition/occlusion.h"

namespace handpiece::dentition {
namespace {

using core::Pose;

/// The gingiva's solid goes on through the bone.
constexpr int kBonePriority = 6;

/// Along an arch from one end to the other: 18 .. 11, 21 .. 28, or 48 .. 41, 31 .. 38.
std::vector<std::size_t> alongArch(bool upper) {
    std::vector<std::size_t> order;
    for (std::size_t i = 8; i-- > 0;)
        order.push_back((upper ? 0 : 24) + i);
    for (std::size_t i = 0; i < 8; ++i)
        order.push_back((upper ? 8 : 16) + i);
    return order;
}

/// What the system could give without taking it from others [bytes]; no bound where it does not say.
double freeMemoryBytes() {
    std::ifstream file("/proc/meminfo");
    for (std::string name, rest; file >> name; std::getline(file, rest))
        if (double kib = 0.0; name == "MemAvailable:" && file >> kib) return 1024.0 * kib;
    return std::numeric_limits<double>::infinity();
}

void requireMemory(const MouthOptions& options) {
    if (options.faces < kMinFaces || options.faces > kMaxFaces)
        throw core::Error(fmt::format("{} faces are not possible", options.faces), "--faces",
                          fmt::format("give a number from {} to {}", kMinFaces, kMaxFaces));
    const double needed = mouthBytes(options), there = freeMemoryBytes();
    if (needed > there)
        throw core::Error(
            fmt::format("a mouth of {} faces a tooth takes about {:.1f} GB of memory, and {:.1f} are free",
                        options.faces, 1e-9 * needed, 1e-9 * there),
            "--faces", "give fewer");
}

}  // namespace

double mouthBytes(const MouthOptions& options) {
    // Estimated, on the safe side (0.5 GB at 20,000 faces, where 0.32 were measured): what a face of the finished mouth
    // holds, and what one takes while its surface is sampled and thinned out.
    constexpr double kPerFaceKept = 60.0, kPerFaceAtWork = 900.0, kRest = 0.4e9;
    const double faces = static_cast<double>(options.faces);
    return kToothCount * 2.0 * faces * kPerFaceKept +
           static_cast<double>(core::threadCount()) * faces * kPerFaceAtWork + kRest;
}

cases::Case makeMouth(const Patient& patient, const MouthOptions& options, const core::Progress& progress) {
    const std::size_t own = indexOf(options.fdi);
    if (!(options.openingMm >= 0.0 && options.openingMm <= kWidestOpeningMm))
        throw core::Error(fmt::format("a mouth does not open by {} mm", options.openingMm), "--opening",
                          fmt::format("give 0 (in occlusion) to {} mm", kWidestOpeningMm));
    requireMemory(options);

    constexpr double kTeethShare = 0.75, kArchesShare = 0.85;
    std::vector<cases::Tooth> teeth(kToothCount);
    std::atomic<int> done{0};
    core::parallelFor(kToothCount, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const core::Progress share = core::part(progress, 0.0, kTeethShare);
            teeth[i] = makeTooth(fdiOf(i), patient, {options.faces, 0},
                                 [&](double) { return !share || share(done / static_cast<double>(kToothCount)); });
            ++done;
        }
    });

    const Arrangement arches = arrange(teeth, core::part(progress, kTeethShare, kArchesShare));
    grindFacets(teeth, arches);
    const Pose mandible = opened(arches, options.openingMm);
    std::array<Pose, kToothCount> inMouth = arches.toothInMouth;
    for (std::size_t i = 16; i < kToothCount; ++i)
        inMouth[i] = (mandible * inMouth[i]).normalised();
    const Pose caseFrame = inMouth[own];
    const Pose mouthInCase = caseFrame.inverse();

    std::array<Periodontium, 2> periodontia;
    for (const bool upper : {true, false}) {
        std::vector<ArchTooth> arch;
        for (const std::size_t i : alongArch(upper))
            arch.push_back({&teeth[i], arches.toothInMouth[i]});
        const double begun = upper ? kArchesShare : 0.5 * (1.0 + kArchesShare);
        periodontia[upper ? 0 : 1] = makePeriodontium(arch, options.periodontium,
                                                      core::part(progress, begun, begun + 0.5 * (1.0 - kArchesShare)));
    }

    Cheeks cheeks;
    if (options.cheeks) {
        std::vector<geometry::TriangleMesh> standing;
        for (std::size_t i = 0; i < kToothCount; ++i)
            standing.push_back(geometry::transformed(teeth[i].outer, inMouth[i]));
        cheeks = makeCheeks(standing);
    }
    cases::Case made;
    static_cast<cases::Tooth&>(made) = teeth[own];
    for (std::size_t i = 0; i < kToothCount; ++i) {
        if (i == own) continue;
        cases::PlacedTooth other;
        static_cast<cases::Tooth&>(other) = std::move(teeth[i]);
        other.inCase = (mouthInCase * inMouth[i]).normalised();
        made.others.push_back(std::move(other));
    }
    if (options.openingMm > 0.0) made.opening = (mouthInCase * mandible * caseFrame).normalised();
    cases::chooseCuttable(made);
    const auto add = [&](const char* name, cases::Tissue tissue, geometry::TriangleMesh mesh, const Pose& inCase) {
        made.scenery.push_back({name, tissue,
                                tissue == cases::Tissue::bone ? kBonePriority : cases::properties(tissue).priority,
                                geometry::transformed(std::move(mesh), inCase), true});
    };
    const std::array<Pose, 2> jaws{mouthInCase, (mouthInCase * mandible).normalised()};
    add("upper-gingiva", cases::Tissue::gum, std::move(periodontia[0].gingiva), jaws[0]);
    add("lower-gingiva", cases::Tissue::gum, std::move(periodontia[1].gingiva), jaws[1]);
    add("upper-bone", cases::Tissue::bone, std::move(periodontia[0].bone), jaws[0]);
    add("lower-bone", cases::Tissue::bone, std::move(periodontia[1].bone), jaws[1]);
    if (options.cheeks) {
        add("left-cheek", cases::Tissue::gum, std::move(cheeks.left), mouthInCase);
        add("right-cheek", cases::Tissue::gum, std::move(cheeks.right), mouthInCase);
        add("upper-lip", cases::Tissue::gum, std::move(cheeks.upperLip), mouthInCase);
        add("lower-lip", cases::Tissue::gum, std::move(cheeks.lowerLip), mouthInCase);
    }
    core::report(progress, 1.0);
    return made;
}

}  // namespace handpiece::dentition
