// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/render_thread.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "handpiece/app/input/working_position.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/rt/realtime_thread.h"

namespace handpiece::desktop {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kFramePeriod = std::chrono::microseconds(16667);
// A sample that shows something else, and the window, wake the thread. Bricks that come while the bur stands still, as
// after an undo, are looked for this often.
constexpr auto kPoll = std::chrono::milliseconds(15);
constexpr double kDebrisS = 1.5;                        // particles fly on for about this long
constexpr double kHeadHides = 0.82, kHeadClear = 0.78;  // cosines of bur's axis and line of sight, either way round
constexpr double kMaxSoftwarePixels = 1.6e6;            // more would be seen later than they are seen sharper

bool moved(const messages::HapticSample& a, const messages::HapticSample& b) {
    double most = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
        most = std::max(most, std::abs(a.proxyPositionMm[i] - b.proxyPositionMm[i]));
    double turned = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
        turned = std::max(turned, std::abs(a.proxyOrientation[i] - b.proxyOrientation[i]));
    return most > 5e-4 || turned > 5e-5;
}

bool turns(const messages::HapticSample& sample) {
    return sample.speedRpm > 1.0;
}

double removedMm3(const messages::HapticSample& sample) {
    return std::accumulate(sample.removedMm3.begin(), sample.removedMm3.end(), 0.0);
}

}  // namespace

core::Pose proxyPose(const messages::HapticSample& sample) {
    const auto& q = sample.proxyOrientation;
    return {core::toVec(sample.proxyPositionMm), core::Quat(q[0], q[1], q[2], q[3])};
}

/// Pictures that are handed to the window as they are and come back when it has done with them.
class RenderThread::PicturePool : public std::enable_shared_from_this<PicturePool> {
  public:
    /// The one that came back last: the least of it is out of date.
    [[nodiscard]] std::unique_ptr<view::Image> take() {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) {
            auto made = std::make_unique<view::Image>();
            made->blueFirst = true;  // as the window's own pictures: fast to paint
            return made;
        }
        std::unique_ptr<view::Image> taken = std::move(free_.back());
        free_.pop_back();
        return taken;
    }
    [[nodiscard]] QImage lend(std::unique_ptr<view::Image> image) {
        struct Loan {
            std::shared_ptr<PicturePool> pool;
            std::unique_ptr<view::Image> image;
        };
        const view::Image& lent = *image;
        return {lent.rgba.data(),
                lent.width,
                lent.height,
                static_cast<qsizetype>(4) * lent.width,
                QImage::Format_RGB32,
                [](void* loan) {
                    const std::unique_ptr<Loan> over(static_cast<Loan*>(loan));
                    over->pool->giveBack(std::move(over->image));
                },
                new Loan{shared_from_this(), std::move(image)}};
    }

  private:
    void giveBack(std::unique_ptr<view::Image> image) {
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(image));
    }
    std::mutex mutex_;
    std::vector<std::unique_ptr<view::Image>> free_;
};

struct RenderThread::Shared {
    std::mutex mutex;
    std::condition_variable wake;
    bool stop = false, poked = false, idle = false;  ///< idle: the thread waits for news

    RenderRequest renderRequest;
    std::shared_ptr<simulation::LiveTooth> tooth;
    std::shared_ptr<simulation::SampleFeed> feed;
    std::shared_ptr<const cases::Case> toothCase;
    std::shared_ptr<const std::vector<cases::Part>> scenery;
    std::shared_ptr<const instrument::Bur> bur;
    std::shared_ptr<const geometry::TriangleMesh> turbine;
    std::optional<view::SectionFace> face;
    std::optional<std::vector<view::GlassSurface>> glass;
    std::optional<messages::HapticSample> given;  ///< by setSample()
    bool newTooth = false, newBur = false, newTurbine = false, newFace = false, newRequest = false;

    messages::HapticSample sample;  ///< the newest seen
    std::optional<Frame> ready;
    QString description;

    messages::HapticSample told;  ///< that woke the thread last; the feed's writer's alone

    void poke() {
        {
            const std::lock_guard lock(mutex);
            poked = true;
            if (!idle) return;
        }
        wake.notify_all();
    }
    void hear(const messages::HapticSample& heard) {
        if (!moved(heard, told) && !turns(heard) && !turns(told)) return;
        told = heard;
        poke();
    }
};

/// All that belongs to the drawing thread.
struct RenderThread::Worker {
    std::unique_ptr<view::Renderer> renderer, before;  // `before` is made when it is first asked for
    std::shared_ptr<simulation::LiveTooth> tooth;
    std::shared_ptr<simulation::SampleFeed> feed;
    std::shared_ptr<const cases::Case> toothCase;
    std::shared_ptr<const std::vector<cases::Part>> scenery;
    std::shared_ptr<const instrument::Bur> bur;
    RenderRequest renderRequest;
    std::optional<view::Plane> cutPlane;
    messages::HapticSample sample, drawn;
    core::Vec3 down = -core::Vec3::UnitZ();
    std::uint64_t cutsVersion = 0;
    bool isFlowing = false;  ///< blood
    Clock::time_point seen{};
    bool headInTheWay = false, missing = false, dirty = true, beforeDirty = true, wantsDepths = false;
    double removalMm3S = 0.0;
    Clock::time_point animateUntil{};
    view::Image nowImage, beforeImage;  ///< beside each other
    std::shared_ptr<PicturePool> pictures = std::make_shared<PicturePool>();

    void setTooth(view::Renderer& to, bool alsoCuts) const {
        to.setTooth(tooth ? tooth->model().outer.bounds() : sketchBounds());
        std::shared_ptr<const std::vector<cases::PlacedTooth>> others;
        if (toothCase) others = std::shared_ptr<const std::vector<cases::PlacedTooth>>(toothCase, &toothCase->others);
        to.setOthers(std::move(others));
        if (scenery) to.setScenery(*scenery);
        if (!tooth) return;
        to.setParts(toothCase->parts);
        to.updateBricks(tooth->uncutSurface(), true);
        if (alsoCuts) to.updateBricks(tooth->takeNews());
    }

    /// Without a tooth: of what is shown in its place.
    [[nodiscard]] core::Box sketchBounds() const {
        core::Box box{core::Vec3::Zero(), core::Vec3::Zero()};
        if (scenery)
            for (const cases::Part& part : *scenery) {
                if (part.tissue == cases::Tissue::gum || part.tissue == cases::Tissue::bone ||
                    part.tissue == cases::Tissue::neighbour)
                    continue;
                for (const core::Vec3& v : part.mesh.vertices)
                    box.extend(v);
            }
        return box;
    }

    /// Looked at along the bur, the turbine's head would hide the tip and all that it does.
    void seeTip() {
        const core::Vec3 axis = proxyPose(sample).orientation * core::Vec3::UnitZ();
        const double towardsEye = axis.dot((renderRequest.camera.eyeMm - proxyPose(sample).positionMm).normalized());
        headInTheWay = towardsEye > (headInTheWay ? kHeadClear : kHeadHides);
    }

    /// What the gingiva has suffered since.
    void bleed() {
        if (!tooth || tooth->gingiva().version() == cutsVersion) return;
        cutsVersion = tooth->gingiva().version();
        renderer->setGingivaCuts(tooth->gingiva().all(), down);
        dirty = true;
    }

    [[nodiscard]] view::Look lookNow() const {
        view::Look look = renderRequest.look;
        look.scaleBar = false;  // the window writes its own, with its label
        if (cutPlane) look.cutAway = cutPlane;
        if (headInTheWay) look.turbine = false;
        if (!tooth || !bur) look.bur = look.turbine = false;
        if (renderRequest.compare) look.stereo = view::Stereo::none;
        return look;
    }

    [[nodiscard]] view::Moment momentNow() const {
        view::Moment moment;
        moment.timeS = sample.timeS;
        moment.burInTooth = proxyPose(sample);
        moment.burShown = bur != nullptr;
        moment.speedRpm = sample.speedRpm;
        moment.removalMm3S = removalMm3S;
        moment.tissue = static_cast<cases::Tissue>(sample.tissue);
        moment.water = sample.pedal > 0.0 && sample.speedRpm > 0.0;
        moment.contactNormal = core::toVec(sample.contactNormal);
        moment.contact = moment.contactNormal.norm() > 0.5;
        moment.contactPointMm = moment.contact ? core::toVec(sample.contactPointMm) : moment.burInTooth.positionMm;
        moment.forceN = core::toVec(sample.forceN);
        moment.mirror = renderRequest.mirror;
        return moment;
    }

    /// Pixels to draw: those of the screen on a GPU, at most kMaxSoftwarePixels without one.
    [[nodiscard]] view::Viewport pixels(QSize size) const {
        double scale = renderer->isSoftware() ? 1.0 : renderRequest.pixelRatio;
        const double area = scale * scale * renderRequest.size.width() * renderRequest.size.height();
        if (renderer->isSoftware() && area > kMaxSoftwarePixels) scale *= std::sqrt(kMaxSoftwarePixels / area);
        return {std::max(1, static_cast<int>(std::lround(size.width() * scale))),
                std::max(1, static_cast<int>(std::lround(size.height() * scale)))};
    }

    [[nodiscard]] Frame draw();
};

Frame RenderThread::Worker::draw() {
    seeTip();
    Frame frame;
    frame.camera = renderRequest.camera;
    frame.sample = sample;
    frame.compare = renderRequest.compare;
    std::unique_ptr<view::Image> image = pictures->take();
    if (!renderRequest.compare) {
        frame.report = renderer->draw(renderRequest.camera, pixels(renderRequest.size), lookNow(), momentNow(), *image);
        frame.image = pictures->lend(std::move(image));
        return frame;
    }
    const view::Viewport half = pixels({renderRequest.size.width() / 2, renderRequest.size.height()});
    if (!before) {
        before = std::make_unique<view::Renderer>();
        before->setResponsive(true);
        setTooth(*before, false);
        beforeDirty = true;
    }
    nowImage.blueFirst = beforeImage.blueFirst = true;
    frame.report = renderer->draw(renderRequest.camera, half, lookNow(), momentNow(), nowImage);
    if (beforeDirty) {
        view::Look look = lookNow();
        look.bur = look.turbine = look.removedDepthColours = false;
        look.tooth = view::ToothShown::now;
        look.cutAway.reset();
        view::Moment still;
        still.burShown = false;
        const view::FrameReport report = before->draw(renderRequest.camera, half, look, still, beforeImage);
        beforeDirty = report.refining;
        frame.report.drawMs += report.drawMs;
        frame.report.readMs += report.readMs;
        frame.report.triangles += report.triangles;
        frame.report.refining = frame.report.refining || report.refining;
    }
    view::Image& both = *image;
    both.picture = {};
    both.width = 2 * half.width;
    both.height = half.height;
    both.rgba.resize(4 * static_cast<std::size_t>(both.width) * static_cast<std::size_t>(both.height));
    for (int y = 0; y < half.height; ++y) {
        const auto row = 4 * static_cast<std::ptrdiff_t>(half.width);
        std::copy_n(beforeImage.at(0, y), row, both.rgba.begin() + 2 * row * y);
        std::copy_n(nowImage.at(0, y), row, both.rgba.begin() + 2 * row * y + row);
    }
    frame.image = pictures->lend(std::move(image));
    return frame;
}

RenderThread::RenderThread(Callbacks callbacks)
    : callbacks_(std::move(callbacks)), shared_(std::make_unique<Shared>()) {
    thread_ = std::thread([this] { run(); });
}

RenderThread::~RenderThread() {
    finish();
}

void RenderThread::listenTo(std::shared_ptr<simulation::SampleFeed> feed) {
    if (heard_) heard_->setWake({});
    heard_ = std::move(feed);
    if (heard_) heard_->setWake([this](const messages::HapticSample& sample) { shared_->hear(sample); });
}

void RenderThread::finish() {
    listenTo(nullptr);
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(shared_->mutex);
        shared_->stop = shared_->poked = true;
    }
    shared_->wake.notify_all();
    thread_.join();
}

void RenderThread::run() {
    rt::stepBack();  // before the renderer: a software renderer's own threads are as it is
    Worker worker;
    const auto giveUp = [&](const core::Error& error) {
        worker.missing = true;
        worker.renderer.reset();
        worker.before.reset();
        callbacks_.missing(error.problem(), error.remedy());
    };
    try {
        worker.renderer = std::make_unique<view::Renderer>();
        worker.renderer->setResponsive(true);
        const std::lock_guard lock(shared_->mutex);
        shared_->description = QString::fromStdString(worker.renderer->description());
    } catch (const std::exception& error) {
        giveUp(core::asError(error));
    }

    Clock::time_point lastFrame{};
    bool justDrawn = false;
    while (true) {
        bool newTooth = false, newBur = false, fresh = false;
        std::shared_ptr<const geometry::TriangleMesh> turbine;
        std::optional<std::optional<view::SectionFace>> face;
        std::optional<std::vector<view::GlassSurface>> glass;
        {
            std::unique_lock lock(shared_->mutex);
            // A picture that is due waits for its turn; else wait for a word from the window, or look for news.
            // Straight after a picture the next sample is there already.
            if (std::exchange(justDrawn, false))
                ;
            else if (worker.dirty && !worker.missing && worker.renderRequest.visible)
                shared_->wake.wait_until(lock, lastFrame + kFramePeriod, [&] { return shared_->stop; });
            else {
                shared_->idle = true;
                shared_->wake.wait_for(lock, kPoll, [&] { return shared_->poked; });
                shared_->idle = false;
            }
            if (shared_->stop) return;
            shared_->poked = false;
            if (std::exchange(shared_->newRequest, false)) {
                worker.renderRequest = shared_->renderRequest;
                worker.dirty = worker.beforeDirty = true;
            }
            if (std::exchange(shared_->newTooth, false)) {
                worker.tooth = shared_->tooth;
                worker.feed = shared_->feed;
                worker.toothCase = shared_->toothCase;
                worker.scenery = shared_->scenery;
                worker.sample = shared_->sample;
                worker.wantsDepths = false;
                if (worker.toothCase) worker.down = input::downInCase(*worker.toothCase);
                newTooth = true;
            }
            newBur = std::exchange(shared_->newBur, false);
            worker.bur = shared_->bur;
            if (std::exchange(shared_->newTurbine, false)) turbine = shared_->turbine;
            if (std::exchange(shared_->newFace, false)) face = std::exchange(shared_->face, std::nullopt);
            glass = std::exchange(shared_->glass, std::nullopt);
            const messages::HapticSample earlier = worker.sample;
            if (worker.feed && worker.feed->hasNews()) {
                worker.sample = worker.feed->read();
                fresh = true;
            } else if (shared_->given) {
                worker.sample = *std::exchange(shared_->given, std::nullopt);
                fresh = true;
            }
            if (fresh) {
                worker.seen = Clock::now();
                shared_->sample = worker.sample;
                const double dt = worker.sample.timeS - earlier.timeS;
                worker.removalMm3S =
                    dt > 0.0 ? std::max(0.0, removedMm3(worker.sample) - removedMm3(earlier)) / dt : 0.0;
            }
        }
        const auto now = Clock::now();
        if (worker.feed && fresh) {
            const std::lock_guard lock(meterMutex_);
            meter_.sampleSeen(worker.sample.timeS, worker.seen);
        }
        if (worker.removalMm3S > 0.0 || turns(worker.sample))
            worker.animateUntil = now + std::chrono::milliseconds(static_cast<int>(kDebrisS * 1000));
        if (moved(worker.sample, worker.drawn) ||
            ((now < worker.animateUntil || worker.isFlowing) && worker.sample.timeS != worker.drawn.timeS))
            worker.dirty = true;
        try {
            if (worker.tooth && worker.wantsDepths != worker.renderRequest.look.removedDepthColours) {
                worker.wantsDepths = worker.renderRequest.look.removedDepthColours;
                worker.tooth->wantRemovedDepths(worker.wantsDepths);
            }
            const bool news = worker.tooth && worker.tooth->hasNews();
            if (worker.missing) {
                if (news) {
                    (void)worker.tooth->takeNews();
                    callbacks_.toothChanged();
                }
                continue;
            }
            if (newTooth) {
                worker.before.reset();
                worker.cutPlane.reset();
                worker.setTooth(*worker.renderer, true);
                worker.renderer->setGingivaCuts({}, worker.down);
                worker.cutsVersion = 0;
            } else if (news) {
                worker.renderer->updateBricks(worker.tooth->takeNews());
            }
            worker.bleed();
            if (news || newTooth) callbacks_.toothChanged();
            if (newBur && worker.bur)
                worker.renderer->setBur(worker.bur->mesh(), worker.bur->lengthMm(), worker.bur->maxRadiusMm(),
                                        view::finishOf(*worker.bur));
            if (turbine) worker.renderer->setTurbine(*turbine);
            if (face) {
                worker.cutPlane = *face ? std::optional((*face)->plane) : std::nullopt;
                if (*face) worker.renderer->setSectionFace(std::move(**face));
            }
            if (glass) worker.renderer->setGlass(*glass);
            if (newTooth || news || newBur || turbine || face || glass) worker.dirty = true;
            if (!worker.dirty || !worker.renderRequest.visible || now < lastFrame + kFramePeriod) continue;
            lastFrame = now;
            Frame frame = worker.draw();
            frame.seen = worker.seen;
            frame.begun = now;
            frame.drawn = Clock::now();
            worker.drawn = worker.sample;
            worker.isFlowing = frame.report.bleeding;
            worker.dirty = frame.report.refining || frame.report.preparing;
            {
                const std::lock_guard lock(shared_->mutex);
                shared_->ready = std::move(frame);
            }
            callbacks_.frameReady();
            justDrawn = true;
        } catch (const std::exception& error) {
            giveUp(core::asError(error));
        }
    }
}

namespace {

template <class Shared, class F>
void tell(Shared& shared, F&& change) {
    {
        const std::lock_guard lock(shared.mutex);
        change(shared);
        shared.poked = true;
    }
    shared.wake.notify_all();
}

}  // namespace

void RenderThread::setTooth(std::shared_ptr<simulation::LiveTooth> tooth, std::shared_ptr<const cases::Case> toothCase,
                            std::shared_ptr<simulation::SampleFeed> feed) {
    std::vector<cases::Part> around = cases::surroundings(*toothCase);
    show(std::move(tooth), std::move(toothCase), std::move(around), std::move(feed));
}

void RenderThread::setSketch(std::vector<cases::Part> shown) {
    show(nullptr, nullptr, std::move(shown), nullptr);
}

void RenderThread::show(std::shared_ptr<simulation::LiveTooth> tooth, std::shared_ptr<const cases::Case> toothCase,
                        std::vector<cases::Part> scenery, std::shared_ptr<simulation::SampleFeed> feed) {
    auto kept = std::make_shared<const std::vector<cases::Part>>(std::move(scenery));
    listenTo(feed);
    tell(*shared_, [&](Shared& s) {
        s.tooth = std::move(tooth);
        s.toothCase = std::move(toothCase);
        s.scenery = std::move(kept);
        s.feed = std::move(feed);
        s.given.reset();
        s.face.reset();
        s.glass.reset();
        s.newFace = false;
        s.sample = messages::HapticSample{};
        s.newTooth = true;
    });
    resetLatency();
}

void RenderThread::setBur(std::shared_ptr<const instrument::Bur> bur) {
    tell(*shared_, [&](Shared& s) {
        s.bur = std::move(bur);
        s.newBur = true;
    });
}

void RenderThread::setTurbine(geometry::TriangleMesh mesh) {
    auto kept = std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
    tell(*shared_, [&](Shared& s) {
        s.turbine = std::move(kept);
        s.newTurbine = true;
    });
}

void RenderThread::setSample(const messages::HapticSample& sample) {
    tell(*shared_, [&](Shared& s) {
        s.given = sample;
        s.sample = sample;
    });
}

void RenderThread::setGlass(std::vector<view::GlassSurface> surfaces) {
    tell(*shared_, [&](Shared& s) { s.glass = std::move(surfaces); });
}

void RenderThread::setRequest(const RenderRequest& renderRequest) {
    tell(*shared_, [&](Shared& s) {
        s.renderRequest = renderRequest;
        s.newRequest = true;
    });
}

void RenderThread::setSectionFace(std::optional<view::SectionFace> face) {
    tell(*shared_, [&](Shared& s) {
        s.face = std::move(face);
        s.newFace = true;
    });
}

std::optional<Frame> RenderThread::takeFrame() {
    const std::lock_guard lock(shared_->mutex);
    return std::exchange(shared_->ready, std::nullopt);
}

messages::HapticSample RenderThread::sample() const {
    const std::lock_guard lock(shared_->mutex);
    return shared_->sample;
}

QString RenderThread::description() const {
    const std::lock_guard lock(shared_->mutex);
    return shared_->description;
}

void RenderThread::pointerMoved() {
    const std::lock_guard lock(meterMutex_);
    meter_.target(Clock::now());
}

void RenderThread::presented(const Frame& frame) {
    const std::lock_guard lock(meterMutex_);
    meter_.presented({frame.sample.timeS, frame.seen, frame.begun, frame.drawn}, Clock::now());
}

LatencyReport RenderThread::latency() const {
    const std::lock_guard lock(meterMutex_);
    return meter_.report();
}

void RenderThread::resetLatency() {
    const std::lock_guard lock(meterMutex_);
    meter_.reset();
}

}  // namespace handpiece::desktop
