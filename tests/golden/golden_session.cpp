// SPDX-License-Identifier: Apache-2.0
// Makes a tooth, drags a bur across it and prints a hash of each stage: golden_session [THREADS]
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/built_in_motion.h"
#include "handpiece/tick/loop/haptic_loop.h"

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

void run() {
    const tooth::Case molar = starter::makeTooth(starter::ToothKind::lowerFirstMolar, {10000, 2000, false});
    core::Hasher surfaces;
    addMesh(surfaces, molar.outer);
    for (const tooth::Part& part : molar.parts)
        addMesh(surfaces, part.mesh);
    print("surfaces", surfaces.value());

    tooth::PrepareSettings prepare;
    prepare.useCache = false;
    const auto tooth = tooth::prepareTooth(molar, prepare);
    print("field", tooth->field.stateHash());

    auto method = contact::makeFieldMethod(tooth, std::make_shared<const instrument::Bur>(instrument::makeBur("330")));
    device::Motion drag = loop::motionByName("drag", *method, tooth->outer.bounds());
    method->reset();
    device::SimulatedDeviceSettings arm;
    arm.frictionN = 0.05;
    loop::HapticLoop haptic({}, std::make_unique<device::SimulatedDevice>(arm, std::move(drag)), std::move(method),
                            force::defaultParameters());
    core::Hasher samples;
    std::uint64_t touching = 0;
    (void)haptic.runSimulated(2.0, [&](const messages::HapticSample& s) {
        addSample(samples, s);
        touching += s.patchCount > 0;
    });
    print("samples", samples.value());
    std::printf("touching %llu\n", static_cast<unsigned long long>(touching));
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
