// SPDX-License-Identifier: Apache-2.0
// Makes teeth, drags a bur across each, cuts it and prints a hash of each stage: golden_session [THREADS]
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/built_in_motion.h"
#include "studies/cutting_motion.h"

namespace handpiece {
namespace {

/// A tooth and the bur it meets.
struct Meeting {
    const char* prefix;  ///< of what is printed
    starter::ToothKind tooth;
    const char* bur;
    double depthMm;  ///< of the plunge

    void print(const char* stage, std::uint64_t hash) const {
        std::printf("%s%-8s %016llx\n", prefix, stage, static_cast<unsigned long long>(hash));
    }
};

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
void cut(const Meeting& meeting, const std::shared_ptr<const tooth::ToothModel>& uncut) {
    const auto field = std::make_shared<tooth::ToothState>(uncut);
    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur(meeting.bur));
    const auto feeler = contact::makeFieldMethod(uncut, bur);
    studies::CuttingScene scene;
    scene.toothBounds = uncut->outer.bounds();
    scene.burRadiusMm = bur->maxRadiusMm();
    studies::CuttingOptions options;
    options.depthMm = meeting.depthMm;
    options.dwellS = 0.5;
    device::Motion motion = studies::cuttingMotionByName("plunge", *feeler, scene, options);
    device::SimulatedDeviceSettings arm;
    arm.rigidHand = true;
    const double duration = motion.durationS();
    loop::Work work{contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur),
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
    meeting.print("tissues", uncut->identity);
    meeting.print("cutting", samples.value());
    meeting.print("cut", field->stateHash());
}

void run(const Meeting& meeting) {
    const cases::Case made = starter::makeTooth(meeting.tooth, {10000, 2000, false});
    core::Hasher surfaces;
    addMesh(surfaces, made.outer);
    for (const cases::Part& part : made.parts)
        addMesh(surfaces, part.mesh);
    meeting.print("surfaces", surfaces.value());

    tooth::LoadSettings prepare;
    prepare.useCache = false;
    const auto tooth = tooth::loadModel(made, prepare);
    meeting.print("field", tooth->fieldHash);

    auto method =
        contact::makeFieldMethod(tooth, std::make_shared<const instrument::Bur>(instrument::makeBur(meeting.bur)));
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
    meeting.print("samples", samples.value());
    std::printf("%stouching %llu\n", meeting.prefix, static_cast<unsigned long long>(touching));
    cut(meeting, tooth);
}

}  // namespace
}  // namespace handpiece

int main(int argc, char** argv) {
    try {
        if (argc > 1) handpiece::core::setThreadCount(std::strtoull(argv[1], nullptr, 10));
        using handpiece::starter::ToothKind;
        handpiece::run({"", ToothKind::lowerFirstMolar, "330", 0.6});
        handpiece::run({"premolar ", ToothKind::upperPremolar, "cylinder-flat:1.2x4.0", 0.5});
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "golden_session: %s\n", e.what());
        return 1;
    }
}
