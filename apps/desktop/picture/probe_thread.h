// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Measures beside the window what takes longer than a moment: sections, and the thinnest place over the pulp.

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/senses/measure/tooth_probe.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::desktop {

/// Keeps what is asked for up to date while one cuts, at most some times a second; a moved plane is answered at once.
/// Any thread; the callbacks come from its own and must not wait.
class ProbeThread {
  public:
    struct Callbacks {
        std::function<void(std::optional<view::SectionFace>)> section;  ///< none: no section any more
        std::function<void(std::optional<measure::ToothProbe::Thinnest>)> thinnest;
    };
    explicit ProbeThread(Callbacks callbacks);
    ~ProbeThread();
    ProbeThread(const ProbeThread&) = delete;
    ProbeThread& operator=(const ProbeThread&) = delete;

    void setTooth(std::shared_ptr<simulation::LiveTooth> tooth);
    void setPlane(std::optional<view::Plane> plane);
    void wantThinnest(bool wanted);
    /// Something was cut or came back.
    void toothChanged();

  private:
    void run();
    template <class F>
    void tell(F&& change);

    Callbacks callbacks_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::shared_ptr<simulation::LiveTooth> tooth_;
    std::optional<view::Plane> plane_;
    bool stop_ = false, wantsThinnest_ = false;
    bool planeNews_ = false, thinnestNews_ = false, toothNews_ = false;
    std::thread thread_;
};

}  // namespace handpiece::desktop
