// SPDX-License-Identifier: Apache-2.0
// handpiece make mouth: 32 teeth in their arches, with gingiva and bone.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/package.h"
#include "handpiece/model/dentition/mouth.h"
#include "handpiece/model/lesion/lesion.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

using Json = nlohmann::ordered_json;

struct MakeMouthOptions {
    std::string out, lesions;  // lesions: FDI:SURFACE:DEPTH,...
    dentition::Patient patient;
    dentition::MouthOptions mouth;
    std::size_t threads = 0;
    bool json = false;
};

Json toJson(const cases::Case& made, const MakeMouthOptions& o, double tookS) {
    Json teeth = Json::array(), scenery = Json::array();
    const auto add = [&](const cases::Tooth& tooth, const core::Pose& pose, bool isCuttable) {
        const core::Vec3& p = pose.positionMm;
        const core::Quat& q = pose.orientation;
        teeth.push_back({{"fdi", tooth.fdiNumber},
                         {"faces", tooth.outer.triangles.size()},
                         {"volume_mm3", geometry::enclosedVolumeMm3(tooth.outer)},
                         {"cuttable", isCuttable},
                         {"position_mm", {p.x(), p.y(), p.z()}},
                         {"orientation_wxyz", {q.w(), q.x(), q.y(), q.z()}}});
    };
    add(made, {}, true);
    for (const cases::PlacedTooth& other : made.others)
        add(other, other.inCase, other.isCuttable);
    for (const cases::Part& part : made.scenery)
        scenery.push_back({{"name", part.name},
                           {"faces", part.mesh.triangles.size()},
                           {"volume_mm3", geometry::enclosedVolumeMm3(part.mesh)}});
    return {{"out", o.out},
            {"seed", o.patient.seed},
            {"age", o.patient.ageYears},
            {"fdi", o.mouth.fdi},
            {"opening_mm", o.mouth.openingMm},
            {"teeth", teeth},
            {"scenery", scenery},
            {"took_s", tookS}};
}

void makeMouthCase(const MakeMouthOptions& o) {
    if (o.out.empty()) throw core::Error("a mouth needs a folder", "--out", "name one");
    if (!cases::isPackageName(o.out)) core::requireReplaceable(o.out, "case.toml");
    core::setThreadCount(o.threads);
    const lesion::MouthLesions lesions = lesion::mouthLesionsByName(o.lesions);
    const auto begun = std::chrono::steady_clock::now();
    studies::ProgressBar bar("making the mouth");
    cases::Case made = dentition::makeMouth(o.patient, o.mouth, core::part(bar.listener(), 0.0, 0.9));
    lesion::addLesions(made, lesions, {.seed = o.patient.seed}, core::part(bar.listener(), 0.9, 1.0));
    bar.finish();
    const double tookS = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    cases::writeCase(made, o.out);
    if (o.json) {
        fmt::print("{}\n", toJson(made, o, tookS).dump(2));
        return;
    }
    std::size_t faces = made.outer.triangles.size(), cuttable = 1;
    for (const cases::PlacedTooth& other : made.others) {
        faces += other.outer.triangles.size();
        cuttable += other.isCuttable ? 1 : 0;
    }
    fmt::print("{}: {}\n  {} teeth, {} faces, {} of them to be cut; made in {:.1f} s on {} threads\n", o.out, made.name,
               made.others.size() + 1, faces, cuttable, tookS, core::threadCount());
    for (const cases::Part& part : made.scenery)
        fmt::print("  {:<14} {:>8} faces {:>10.2f} mm3\n", part.name, part.mesh.triangles.size(),
                   geometry::enclosedVolumeMm3(part.mesh));
}

}  // namespace

void addMakeMouthCommand(Command& make) {
    Command mouth = make.subcommand("mouth", "32 teeth in two arches, with gingiva and bone, as a case");
    const auto options = std::make_shared<MakeMouthOptions>();
    MakeMouthOptions& o = *options;
    mouth.option("--out", o.out, "folder or .handpiece file to write").required();
    mouth.option("--seed", o.patient.seed, "another number is another patient").showDefault();
    mouth.option("--age", o.patient.ageYears, "of the patient [years]: moves pulp and wear").showDefault();
    mouth.option("--fdi", o.mouth.fdi, "the tooth that is worked on, 11 to 48").showDefault();
    mouth.option("--faces", o.mouth.faces, "triangles of each tooth's outer surface").showDefault();
    mouth.option("--opening", o.mouth.openingMm, "between the incisal edges [mm]; 0: in occlusion").showDefault();
    mouth.option("--lesion", o.lesions,
                 "FDI:SURFACE:DEPTH,...: caries and what else is found, as 46:mesial:D2,36:occlusal:filling; surfaces "
                 "and depths as in make tooth");
    mouth.flag("--cheeks", o.mouth.cheeks, "lips and cheeks too: felt, and held aside in pictures");
    mouth.option("--threads", o.threads, "0: all; the mouth is the same at any number")
        .check(range(0, 1024))
        .showDefault();
    mouth.flag("--json", o.json, "what was made, and where each tooth stands, for programs");
    mouth.footer(
        "Adjacent teeth and antagonists of the tooth can be cut too, the others are felt.\n"
        "Examples:\n  handpiece make mouth --seed 7 --age 40 --fdi 16 --out mouth\n"
        "  handpiece make mouth --lesion 46:mesial:D2,45:distal:E2,36:occlusal:filling,41:lingual:calculus --out "
        "mouth");
    mouth.callback([options] { makeMouthCase(*options); });
}

}  // namespace handpiece::cli
