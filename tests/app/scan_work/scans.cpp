// SPDX-License-Identifier: Apache-2.0
#include "app/scan_work/scans.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/assess/measures/measure.h"
#include "handpiece/assess/preparation/preparation.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/dentition/gingiva.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/senses/surface/brick_source.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "support/random.h"

namespace handpiece::scan_work::test {
namespace {

constexpr std::size_t kFaces = 12000;

preparation::Recipe recipeOf(Kind kind) {
    switch (kind) {
        case Kind::classTwo:
            return {"class-two", "mesial", {}, {0.2, 0.2}, 0.0};
        case Kind::classFive:
            return {"class-five", "", {}, {0.2, 0.2}, 0.0};
        case Kind::crown:
            return {"crown", "", {}, {0.2, 0.2}, 0.0};
        case Kind::lesion:
            return {"lesion", "", {}, {0.3, 0.3}, 0.0};
        case Kind::classOne:
            break;
    }
    return {
        "class-one", "", {{"depth_mm", 1.8}, {"width_mm", 1.3}, {"ridge_mm", 2.0}, {"wall_deg", 3.0}}, {0.2, 0.2}, 0.0};
}

}  // namespace

Bench benchOf(Kind kind, bool neighbours) {
    Bench bench;
    const dentition::Patient patient;
    const int fdi = kind == Kind::classFive ? 33 : 46;
    bench.task.id = "scanned";
    static_cast<cases::Tooth&>(bench.task.toothCase) = dentition::makeTooth(fdi, patient, {kFaces, 0});
    bench.task.toothCase.fdiNumber = fdi;
    bench.task.voxelMm = 0.1;
    bench.task.preparation = recipeOf(kind);
    constexpr const char* kRubrics[] = {"46-class-i", "46-class-ii-mo", "33-class-v", "46-crown"};
    bench.rubric = rubric::shippedRubric(kRubrics[static_cast<int>(kind)]);
    if (!neighbours) return bench;
    // The adjacent teeth stand straight beside it, contact to contact.
    const dentition::ToothForm own(fdi, patient);
    for (const int step : {-1, 1}) {
        const dentition::ToothForm form(fdi + step, patient);
        cases::PlacedTooth other;
        static_cast<cases::Tooth&>(other) = dentition::makeTooth(fdi + step, patient, {kFaces, 0});
        other.fdiNumber = fdi + step;
        constexpr double kGapMm = 0.03;
        other.inCase.positionMm = step < 0
                                      ? Vec3(own.mesialContactMm() - form.distalContactMm() + kGapMm * Vec3::UnitX())
                                      : Vec3(own.distalContactMm() - form.mesialContactMm() - kGapMm * Vec3::UnitX());
        bench.task.toothCase.others.push_back(std::move(other));
    }
    const std::array<dentition::ArchTooth, 3> arch{
        {{&bench.task.toothCase.others[0], bench.task.toothCase.others[0].inCase},
         {&bench.task.toothCase, {}},
         {&bench.task.toothCase.others[1], bench.task.toothCase.others[1].inCase}}};
    bench.gingiva = dentition::makePeriodontium(arch).gingiva;
    return bench;
}

Bench benchOf(const std::string& toothCase) {
    Bench bench;
    bench.task.id = "scanned";
    bench.task.toothCase = cases::readCase(toothCase);
    bench.task.voxelMm = 0.1;
    bench.task.preparation = recipeOf(Kind::lesion);
    bench.rubric = rubric::shippedRubric("46-deep-lesion");
    return bench;
}

preparation::Recipe varied(const preparation::Recipe& recipe, std::mt19937_64& generator) {
    preparation::Recipe made = recipe;
    for (const preparation::Parameter& parameter : preparation::findTemplate(recipe.preparation)->parameters) {
        const double off = handpiece::test::uniform(generator, -0.15, 0.15);
        const double is = recipe.number(parameter.name);
        made.numbers[std::string(parameter.name)] =
            std::clamp(is + off * std::max(std::abs(is), 0.5), parameter.least, parameter.most);
    }
    return made;
}

Cut cutBy(const tasks::Task& task, const preparation::Recipe& recipe) {
    tooth::LoadSettings settings;
    settings.field.voxelMm = task.voxelMm;
    settings.useCache = false;
    Cut cut;
    const auto whole = tooth::loadModel(task.toothCase, settings);
    cut.work.teeth = {whole};
    for (const cases::PlacedTooth& other : task.toothCase.others) {
        cases::Case alone;
        static_cast<cases::Tooth&>(alone) = other;
        cut.work.teeth.push_back(tooth::loadModel(alone, settings));
    }
    cut.work.noHand = "nobody cut it";
    cut.work.state = zones::idealState(*preparation::layOn(task.toothCase, recipe).zones, whole);
    tooth::ToothMirror mirror(whole);
    mirror.apply(cut.work.state);
    cut.mesh = surface::closedSurface(surface::MirrorSource(mirror));
    return cut;
}

TriangleMesh crownOf(const TriangleMesh& mesh, double fromZ) {
    TriangleMesh out{mesh.vertices, {}};
    for (const geometry::Triangle& t : mesh.triangles)
        if (std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return mesh.vertices[v].z() >= fromZ; }))
            out.triangles.push_back(t);
    return out;
}

TriangleMesh jawOf(const TriangleMesh& tooth, const Bench& bench, double fromZ, double spacingMm) {
    std::vector<TriangleTree> bodies;
    bodies.emplace_back(tooth);
    core::Box box = tooth.bounds();
    for (const cases::PlacedTooth& other : bench.task.toothCase.others)
        bodies.emplace_back(geometry::transformed(other.surface(), other.inCase));
    if (!bench.gingiva.triangles.empty()) bodies.emplace_back(bench.gingiva);
    constexpr double kAroundMm = 5.0, kRimMm = 0.4;
    box = box.grown(kAroundMm);
    box.min.z() = fromZ - kRimMm;
    box.max.z() = tooth.bounds().max.z() + 2.0;
    const auto f = [&](const Vec3& p) {
        double least = 1e9;
        for (const TriangleTree& body : bodies)
            least = std::min(least, body.signedDistance(p));
        return least;
    };
    const TriangleMesh all = geometry::isosurface(box, f, {spacingMm});
    TriangleMesh out{all.vertices, {}};
    const core::Box inner = box.grown(-kRimMm);
    for (const geometry::Triangle& t : all.triangles)
        if (std::all_of(t.begin(), t.end(), [&](std::uint32_t v) {
                const Vec3& p = all.vertices[v];
                return p.z() > inner.min.z() && p.x() > inner.min.x() && p.x() < inner.max.x() &&
                       p.y() > inner.min.y() && p.y() < inner.max.y();
            }))
            out.triangles.push_back(t);
    return out;
}

TriangleMesh scanned(TriangleMesh mesh, double noiseMm, std::mt19937_64& generator) {
    std::normal_distribution<double> noise(0.0, 1.0);
    const core::Pose pose{40.0 * handpiece::test::randomDirection(generator),
                          handpiece::test::randomRotation(generator)};
    for (Vec3& v : mesh.vertices) {
        const Vec3 off(noise(generator), noise(generator), noise(generator));
        v = pose.apply(v + noiseMm * off);
    }
    return mesh;
}

void compare(const assessment::Result& truth, const assessment::Result& scan, Tallies& tallies) {
    for (std::size_t k = 0; k < scan.assessment.criteria.size(); ++k) {
        const score::CriterionScore &is = scan.assessment.criteria[k], &own = truth.assessment.criteria[k];
        if (measures::findMeasureKind(is.measure)->subject == measures::Subject::hand) continue;
        if (!is.value && !own.value) continue;
        Tally& tally = tallies[is.id];
        tally.unit = is.unit;
        ++tally.count;
        if (!is.value || !own.value) {
            ++tally.missing;
            continue;
        }
        const double error = std::abs(*is.value - *own.value);
        tally.covered += error <= is.uncertainty + own.uncertainty;
        tally.worst = std::max(tally.worst, error);
        tally.stated = std::max(tally.stated, is.uncertainty);
        tally.statedSum += is.uncertainty;
        tally.errors.push_back(error);
    }
}

}  // namespace handpiece::scan_work::test
