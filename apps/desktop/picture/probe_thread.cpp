// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/probe_thread.h"

#include <chrono>
#include <utility>

namespace handpiece::desktop {

namespace {

constexpr auto kRest = std::chrono::milliseconds(120);  // between two measurements of a tooth that is being cut

view::SectionFace faceOf(const measure::Section& section, const view::Plane& plane) {
    view::SectionFace face;
    face.plane = plane;
    face.originMm = section.originMm;
    face.uAxis = section.uAxis;
    face.vAxis = section.vAxis;
    face.mmPerPixel = section.mmPerPixel;
    face.width = section.width;
    face.height = section.height;
    face.tissue = section.tissue;
    face.away = section.away;
    return face;
}

}  // namespace

ProbeThread::ProbeThread(Callbacks callbacks) : callbacks_(std::move(callbacks)) {
    thread_ = std::thread([this] { run(); });
}

ProbeThread::~ProbeThread() {
    tell([&] { stop_ = true; });
    thread_.join();
}

template <class F>
void ProbeThread::tell(F&& change) {
    {
        const std::lock_guard lock(mutex_);
        change();
    }
    wake_.notify_all();
}

void ProbeThread::setTooth(std::shared_ptr<simulation::LiveTooth> tooth) {
    tell([&] {
        tooth_ = std::move(tooth);
        planeNews_ = thinnestNews_ = true;
    });
}

void ProbeThread::setPlane(std::optional<view::Plane> plane) {
    tell([&] {
        plane_ = plane;
        planeNews_ = true;
    });
}

void ProbeThread::wantThinnest(bool wanted) {
    tell([&] {
        wantsThinnest_ = wanted;
        thinnestNews_ = true;
    });
}

void ProbeThread::toothChanged() {
    tell([&] { toothNews_ = true; });
}

void ProbeThread::run() {
    std::unique_lock lock(mutex_);
    while (true) {
        wake_.wait(lock, [&] { return stop_ || planeNews_ || thinnestNews_ || toothNews_; });
        if (stop_) return;
        const bool byCut = std::exchange(toothNews_, false);
        const bool doSection = std::exchange(planeNews_, false) || (byCut && plane_);
        const bool doThinnest = std::exchange(thinnestNews_, false) || (byCut && wantsThinnest_);
        const std::shared_ptr<simulation::LiveTooth> tooth = tooth_;
        const std::optional<view::Plane> plane = plane_;
        const bool wantsThinnest = wantsThinnest_;
        lock.unlock();
        if (doSection) {
            std::optional<view::SectionFace> face;
            if (tooth && plane)
                face = faceOf(tooth->withProbe([&](const measure::ToothProbe& probe) {
                    return probe.section(plane->normal, plane->offsetMm);
                }),
                              *plane);
            callbacks_.section(std::move(face));
        }
        if (doThinnest) {
            std::optional<measure::ToothProbe::Thinnest> thinnest;
            if (tooth && wantsThinnest)
                thinnest = tooth->withProbe([](const measure::ToothProbe& probe) { return probe.thinnestOverPulp(); });
            callbacks_.thinnest(thinnest);
        }
        lock.lock();
        // While one cuts there is always news: others need the processor too.
        if (byCut) wake_.wait_for(lock, kRest, [&] { return stop_ || planeNews_ || thinnestNews_; });
    }
}

}  // namespace handpiece::desktop
