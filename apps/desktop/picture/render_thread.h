// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Draws the picture beside the window: takes the latest wishes and samples, gives finished pictures.

#include <QImage>
#include <QSize>
#include <QString>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "desktop/picture/latency.h"
#include "handpiece/app/simulation/live_session.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/model/case/case.h"
#include "handpiece/senses/view/camera.h"
#include "handpiece/senses/view/look.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::desktop {

/// A finished picture and what it was made of.
struct Frame {
    QImage image;
    view::Camera camera;
    view::FrameReport report;
    messages::HapticSample sample;
    bool compare = false;                                ///< before and now beside each other
    LatencyMeter::Clock::time_point seen, begun, drawn;  ///< the sample; the drawing's begin and end
};

/// What is to be seen, by value: the latest counts.
struct RenderRequest {
    view::Camera camera;
    QSize size{1, 1};  ///< of the widget, in its own pixels
    double pixelRatio = 1.0;
    view::Look look;
    bool compare = false, visible = false;
    std::optional<view::MirrorPose> mirror;
};

/// Draws at most 60 times a second, and only when something has changed. Its functions are for the window's thread,
/// except setSectionFace(); the callbacks come from the drawing thread and must not wait.
class RenderThread {
  public:
    struct Callbacks {
        std::function<void()> frameReady;                                   ///< takeFrame() has a new one
        std::function<void(std::string what, std::string remedy)> missing;  ///< no OpenGL: nothing will be drawn
        std::function<void()> toothChanged;                                 ///< news of bricks have come
    };
    explicit RenderThread(Callbacks callbacks);
    ~RenderThread();
    /// Ends the drawing; nothing is called back any more.
    void finish();
    RenderThread(const RenderThread&) = delete;
    RenderThread& operator=(const RenderThread&) = delete;

    /// In what the case has around it.
    void setTooth(std::shared_ptr<simulation::LiveTooth> tooth, std::shared_ptr<const cases::Case> toothCase,
                  std::shared_ptr<simulation::SampleFeed> feed);
    /// Surfaces alone; none: an empty scene.
    void setSketch(std::vector<cases::Part> shown);
    void setBur(std::shared_ptr<const instrument::Bur> bur);
    void setTurbine(geometry::TriangleMesh mesh);
    void setSample(const messages::HapticSample& sample);
    /// Over the tooth until another one.
    void setGlass(std::vector<view::GlassSurface> surfaces);
    void setRequest(const RenderRequest& renderRequest);
    /// The section that is shown; its plane is the cut-away's. Any thread.
    void setSectionFace(std::optional<view::SectionFace> face);

    /// The newest picture; none when it was taken already.
    [[nodiscard]] std::optional<Frame> takeFrame();
    [[nodiscard]] messages::HapticSample sample() const;
    [[nodiscard]] QString description() const;

    void pointerMoved();                 ///< now: for the latency
    void presented(const Frame& frame);  ///< now
    [[nodiscard]] LatencyReport latency() const;
    void resetLatency();

  private:
    class PicturePool;
    struct Worker;
    struct Shared;
    void run();
    void listenTo(std::shared_ptr<simulation::SampleFeed> feed);
    void show(std::shared_ptr<simulation::LiveTooth> tooth, std::shared_ptr<const cases::Case> toothCase,
              std::vector<cases::Part> scenery, std::shared_ptr<simulation::SampleFeed> feed);

    Callbacks callbacks_;
    std::shared_ptr<simulation::SampleFeed> heard_;
    std::unique_ptr<Shared> shared_;
    mutable std::mutex meterMutex_;
    LatencyMeter meter_;
    std::thread thread_;
};

/// Where a sample shows the bur.
[[nodiscard]] core::Pose proxyPose(const messages::HapticSample& sample);

}  // namespace handpiece::desktop
