// SPDX-License-Identifier: Apache-2.0
// Makes a tooth, drags a bur across it and prints a hash of each stage: golden_session [THREADS]
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/model/tooth/cut_field.h"
#include "handpiece/model/tooth/cut_state_file.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/built_in_motion.h"
#include "studies/cutting_motion.h"

namespace handpiece {
namespace {

void print(const char* stage, std::uint64_t hash) {
    std::printf("%-8s %016llx\n", stage, static_cast<unsigned long long>(hash));
}

void addMesh(core::Hasher& hash, const geometry::TriangleMesh& mesh) {
    for (const core::Vec3& v : mesh.vertices)
        for (const double x : v)
            hash.add(x);
    for (const geometry::Triangle& t : mesh.triangles)
        for (const std::uint32_t i : t)
            hash.add(i);
}

/// Everything of a sample but the times it took.
void addSample(core::Hasher& hash, const messages::HapticSample& s) {
    hash.add(s.tick);
    hash.add(s.timeS);
    for (const auto* a : {&s.positionMm, &s.velocityMmS, &s.forceN, &s.torqueNmm, &s.truePositionMm, &s.proxyPositionMm,
                          &s.appliedForceN})
        for (const double x : *a)
            hash.add(x);
    for (const auto* a : {&s.orientation, &s.proxyOrientation})
        for (const double x : *a)
            hash.add(x);
    hash.add(s.depthMm);
    hash.add(s.contactAreaMm2);
    hash.add(s.tissue);
    hash.add(s.contactStatus);
    hash.add(s.patchCount);
    hash.add(s.flags);
}

/// A plunge of a turning bur: the tooth that is left, the parts that it is of, and every sample on the way.
void cut(const cases::Case& molar, const std::shared_ptr<const tooth::Tooth>& whole,
         const tooth::PrepareSettings& prepare) {
    const auto base = tooth::prepareCutting(molar, whole, prepare);
    const auto field = std::make_shared<tooth::CutField>(base);
    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur("330"));
    const auto feeler = contact::makeFieldMethod(whole, bur);
    studies::CuttingScene scene;
    scene.toothBounds = whole->outer.bounds();
    scene.burRadiusMm = bur->maxRadiusMm();
    studies::CuttingOptions options;
    options.depthMm = 0.6;
    options.dwellS = 0.5;
    device::Motion motion = studies::cuttingMotionByName("plunge", *feeler, scene, options);
    device::SimulatedDeviceSettings arm;
    arm.rigidHand = true;
    const double duration = motion.durationS();
    loop::Work work{contact::makeFieldMethod(std::shared_ptr<const tooth::CutField>(field), bur),
                    std::make_unique<cutting::Cutter>(field, bur, instrument::CuttingParameters{},
                                                      cases::builtInTissues(), cutting::Cutter::Settings{})};
    loop::HapticLoop haptic({}, std::make_unique<device::SimulatedDevice>(arm, std::move(motion)), std::move(work),
                            force::defaultParameters());
    core::Hasher samples;
    (void)runSimulated(haptic, duration, [&](const messages::HapticSample& s) {
        addSample(samples, s);
        samples.add(s.speedRpm);
        for (const double mm3 : s.removedMm3)
            samples.add(mm3);
    });
    print("tissues", tooth::identityOf(*base));
    print("cutting", samples.value());
    print("cut", field->stateHash());
}

void run() {
    const cases::Case molar = starter::makeTooth(starter::ToothKind::lowerFirstMolar, {10000, 2000, false});
    core::Hasher surfaces;
    addMesh(surfaces, molar.outer);
    for (const cases::Part& part : molar.parts)
        addMesh(surfaces, part.mesh);
    print("surfaces", surfaces.value());

    tooth::PrepareSettings prepare;
    prepare.useCache = false;
    const auto tooth = tooth::prepareTooth(molar, prepare);
    print("field", tooth->field.stateHash());

    auto method = contact::makeFieldMethod(tooth, std::make_shared<const instrument::Bur>(instrument::makeBur("330")));
    device::Motion drag = studies::motionByName("drag", *method, tooth->outer.bounds());
    method->reset();
    device::SimulatedDeviceSettings arm;
    arm.frictionN = 0.05;
    loop::HapticLoop haptic({}, std::make_unique<device::SimulatedDevice>(arm, std::move(drag)), std::move(method),
                            force::defaultParameters());
    core::Hasher samples;
    std::uint64_t touching = 0;
    (void)runSimulated(haptic, 2.0, [&](const messages::HapticSample& s) {
        addSample(samples, s);
        touching += s.patchCount > 0;
    });
    print("samples", samples.value());
    std::printf("touching %llu\n", static_cast<unsigned long long>(touching));
    cut(molar, tooth, prepare);
}

}  // namespace
}  // namespace handpiece

int main(int argc, char** argv) {
    try {
        if (argc > 1) handpiece::core::setThreadCount(std::strtoull(argv[1], nullptr, 10));
        handpiece::run();
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "golden_session: %s\n", e.what());
        return 1;
    }
}
