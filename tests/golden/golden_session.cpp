// SPDX-License-Identifier: Apache-2.0
// Makes teeth, drags a bur across each, cuts it with every family of burs and prints a hash of each stage:
// golden_session [THREADS]
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/model/tooth/tooth_mirror.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/record/history/history.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/built_in_motion.h"
#include "studies/cutting_motion.h"

namespace handpiece {
namespace {

/// A tooth and the burs it meets.
struct Meeting {
    const char* prefix;  ///< of what is printed
    starter::ToothKind tooth;
    const char* bur;                  ///< for a drag and a plunge
    double depthMm;                   ///< of the plunge
    std::vector<const char*> others;  ///< for a plunge each; with one of them a bur that is a mesh
};

void print(const std::string& prefix, const char* stage, std::uint64_t hash) {
    std::printf("%s%-8s %016llx\n", prefix.c_str(), stage, static_cast<unsigned long long>(hash));
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

/// A plunge of a turning bur, which leans over on the way, undone and done again: the tooth that is left and every
/// sample on the way.
void cut(const std::string& prefix, const std::shared_ptr<const tooth::ToothModel>& uncut,
         const std::shared_ptr<const instrument::Bur>& bur, double depthMm) {
    const auto field = std::make_shared<tooth::ToothState>(uncut);
    const auto feeler = contact::makeFieldMethod(uncut, bur);
    studies::CuttingScene scene;
    scene.toothBounds = uncut->outer.bounds();
    scene.burRadiusMm = bur->maxRadiusMm();
    studies::CuttingOptions options;
    options.depthMm = depthMm;
    options.dwellS = 0.5;
    std::vector<device::TimedPose> poses = studies::cuttingMotionByName("plunge", *feeler, scene, options).poses();
    for (std::size_t i = 0; i < poses.size(); ++i) {
        core::Quat& turn = poses[i].burInTooth.orientation;
        turn = core::rotationAbout(core::Vec3::UnitX(), 0.1 * static_cast<double>(i)) * turn;
    }
    device::SimulatedDeviceSettings arm;
    arm.rigidHand = true;
    const double duration = poses.back().timeS;
    loop::Work work{contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur),
                    std::make_unique<cutting::Cutter>(field, bur, instrument::CuttingParameters{},
                                                      cases::builtInTissues(), cutting::Cutter::Settings{})};
    loop::HapticLoop haptic({}, std::make_unique<device::SimulatedDevice>(arm, device::Motion(std::move(poses))),
                            std::move(work), force::defaultParameters());
    core::Hasher samples;
    tooth::MouthMirror mirror({uncut});
    history::History strokes;
    strokes.start(field->state());
    const std::uint64_t whole = field->stateHash();
    const auto play = [&](double seconds) {
        (void)runSimulated(
            haptic, seconds,
            [&](const messages::HapticSample& s) {
                addSample(samples, s);
                samples.add(s.speedRpm);
                // Tissues that came later count once they are there, as in a tooth's own number.
                for (std::size_t t = 0; t < s.removedMm3.size(); ++t)
                    if (t < cases::kFirstTissueCount || s.removedMm3[t] > 0.0) samples.add(s.removedMm3[t]);
            },
            [&](const tooth::BrickSnapshot& brick) {
                mirror.apply(brick);
                strokes.noteTouched(brick.id);
            });
        return field->stateHash();
    };
    constexpr double kOutS = 0.5;  // all bricks are handed over, a change is put in place
    const std::uint64_t hash = play(duration + kOutS);
    strokes.endStroke(history::MirrorSource(mirror), field->state().removedMm3);
    haptic.restore(strokes.undo().value());
    if (play(kOutS) != whole) throw core::Error("the cut that was undone has left something", prefix);
    haptic.restore(strokes.redo().value());
    if (play(kOutS) != hash) throw core::Error("the cut that was done again is another", prefix);
    print(prefix, "cutting", samples.value());
    print(prefix, "cut", hash);
}

void run(const Meeting& meeting) {
    const cases::Case made = starter::makeTooth(meeting.tooth, {10000, 2000, false});
    core::Hasher surfaces;
    addMesh(surfaces, made.outer);
    for (const cases::Part& part : made.parts)
        addMesh(surfaces, part.mesh);
    print(meeting.prefix, "surfaces", surfaces.value());

    tooth::LoadSettings prepare;
    prepare.useCache = false;
    const auto tooth = tooth::loadModel(made, prepare);
    print(meeting.prefix, "field", tooth->fieldHash);

    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur(meeting.bur));
    auto method = contact::makeFieldMethod(tooth, bur);
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
    print(meeting.prefix, "samples", samples.value());
    std::printf("%stouching %llu\n", meeting.prefix, static_cast<unsigned long long>(touching));
    print(meeting.prefix, "tissues", tooth->identity);
    cut(meeting.prefix, tooth, bur, meeting.depthMm);
    for (const char* name : meeting.others)
        cut(std::string(name) + " ", tooth, std::make_shared<const instrument::Bur>(instrument::makeBur(name)), 0.5);
    if (meeting.others.empty()) return;
    const geometry::TriangleMesh mesh =
        instrument::turnedMesh(instrument::makeProfile(instrument::Shape::flame, 1.2, 4.0), 24, 0.2);
    cut("mesh ", tooth, std::make_shared<const instrument::Bur>(instrument::burFromMesh("mesh", mesh)), 0.5);
}

}  // namespace
}  // namespace handpiece

int main(int argc, char** argv) {
    try {
        if (argc > 1) handpiece::core::setThreadCount(std::strtoull(argv[1], nullptr, 10));
        using handpiece::starter::ToothKind;
        handpiece::run({"",
                        ToothKind::lowerFirstMolar,
                        "330",
                        0.6,
                        {"round:1.2x1.2", "inverted-cone:1.2x1.0", "cylinder-flat:1.0x3.0", "cylinder-round:1.0x3.0",
                         "taper-flat:1.2x4.0", "taper-round:1.2x4.0", "pear:0.8x1.5", "flame:1.0x3.0",
                         "torpedo:1.0x3.0", "wheel:1.6x0.7"}});
        handpiece::run({"premolar ", ToothKind::upperPremolar, "cylinder-flat:1.2x4.0", 0.5, {}});
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "golden_session: %s\n", e.what());
        return 1;
    }
}
