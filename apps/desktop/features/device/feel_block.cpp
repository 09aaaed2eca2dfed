// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/device/feel_block.h"

#include "handpiece/base/core/error.h"

namespace handpiece::desktop {
namespace {

constexpr int kPollMs = 33;

cases::Case blockCase() {
    cases::Case block;
    block.name = "block";
    const double h = FeelBlock::kHalfMm, d = FeelBlock::kDepthMm;
    geometry::TriangleMesh& mesh = block.outer;
    for (const double z : {-d, 0.0})
        for (const double y : {-h, h})
            for (const double x : {-h, h})
                mesh.vertices.emplace_back(x, y, z);
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return block;
}

}  // namespace

input::ToothPlace FeelBlock::place() {
    return {core::Box{core::Vec3(-kHalfMm, -kHalfMm, -kDepthMm), core::Vec3(kHalfMm, kHalfMm, 0.0)}, 0, 1};
}

FeelBlock::FeelBlock(bool realTime, QObject* parent) : QObject(parent), realTime_(realTime) {
    timer_.setInterval(kPollMs);
    connect(&timer_, &QTimer::timeout, this, [this] {
        if (!liveSession_) return;
        sample_ = feed_->read();
        status_ = liveSession_->status();
        emit ticked();
    });
}

FeelBlock::~FeelBlock() {
    stop();
}

void FeelBlock::stop() {
    timer_.stop();
    making_.reset();
    liveSession_.reset();
    feed_.reset();
    sample_ = {};
}

void FeelBlock::start(std::shared_ptr<Hand> hand) {
    stop();
    struct Made {
        cases::Case block;
        simulation::SimulationSetup station;
    };
    const auto made = std::make_shared<Made>();
    const instrument::Instrument bur = instrument::makeInstrument("330");
    simulation::SimulationSettings settings;
    settings.bur = bur.bur;
    settings.cuttingParameters = bur.cuttingParameters;
    settings.field.voxelMm = 0.2;
    settings.capability = hand->device().capability();
    settings.parameters = hand->fitted(settings.parameters);
    // The block's hull is the block: touched, never cut.
    settings.hull = true;
    making_ = std::make_unique<Job>(QString(), [made, settings](const core::Progress& progress) {
        made->block = blockCase();
        made->station = simulation::makeSimulation(made->block, settings, false, progress);
    });
    connect(making_.get(), &Job::done, this, [this, made, hand = std::move(hand)] {
        making_.release()->deleteLater();
        hand->placeFor(place());
        simulation::LiveSessionSettings liveSession;
        liveSession.realTime = realTime_;
        liveSession.lowerButtonUndoes = false;
        try {
            liveSession_ = std::make_unique<simulation::LiveSession>(
                made->station, made->block, std::make_unique<LentDevice>(hand), liveSession, nullptr);
        } catch (const core::Error& error) {
            emit failed(problemOf(error));
            return;
        }
        feed_ = liveSession_->subscribe();
        timer_.start();
    });
    connect(making_.get(), &Job::failed, this, [this](const Problem& problem) {
        making_.release()->deleteLater();
        emit failed(problem);
    });
    making_->start();
}

}  // namespace handpiece::desktop
