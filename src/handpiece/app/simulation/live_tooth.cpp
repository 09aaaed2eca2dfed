// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/live_tooth.h"

#include <algorithm>
#include <chrono>
#include <future>
#include <iterator>
#include <map>
#include <utility>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/senses/surface/brick_source.h"
#include "handpiece/senses/surface/scan_colours.h"

namespace handpiece::simulation {
namespace {

constexpr int kCoarseLevel = surface::kMaxLevel;
constexpr std::uint32_t kNoNews = 0xffffffffu;

}  // namespace

struct LiveTooth::Parts {
    Parts(const std::shared_ptr<const tooth::ToothModel>& model, std::uint16_t toothNumber,
          const core::Pose& toothInScene)
        : number(toothNumber),
          inScene(toothInScene),
          turns(!inScene.isIdentity()),
          mirror(model, number),
          strokeStart(model, number),
          source(mirror),
          fine(source, &model->tissues),
          coarse(source, &model->tissues),
          newsAt(source.grid().count(), kNoNews),
          pendingAt(source.grid().count(), kNoNews) {}

    const std::uint16_t number;
    const core::Pose inScene;
    const bool turns;
    tooth::ToothMirror mirror;
    tooth::ToothMirror strokeStart;  ///< as it was when the last stroke began; under the mutex
    surface::MirrorSource source;
    // The feeder's alone.
    surface::Surface fine, coarse;
    std::vector<tooth::BrickSnapshot> pending;  ///< heard, not yet in the mirror; the latest of each brick
    // Under the mutex, as writing the mirror is.
    std::vector<surface::BrickUpdate> uncut;
    std::vector<surface::BrickUpdate> news;
    std::vector<std::uint32_t> newsAt;                   ///< by dense brick: where in `news`
    std::vector<std::uint32_t> pendingAt;                ///< by dense brick: where in `pending`; the feeder's
    std::map<std::uint32_t, surface::BrickUpdate> told;  ///< the latest of each brick that was news
    bool wantsDepths = false, depthsAgain = false;

    [[nodiscard]] std::shared_ptr<const surface::BrickMesh> placed(
        std::shared_ptr<const surface::BrickMesh> mesh) const {
        if (!turns || mesh == nullptr) return mesh;
        auto moved = std::make_shared<surface::BrickMesh>(*mesh);
        for (surface::SurfaceVertex& v : moved->vertices) {
            const auto vec = [](const std::array<float, 3>& a) { return core::Vec3(a[0], a[1], a[2]); };
            const auto floats = [](const core::Vec3& a) {
                return std::array{static_cast<float>(a.x()), static_cast<float>(a.y()), static_cast<float>(a.z())};
            };
            v.positionMm = floats(inScene.apply(vec(v.positionMm)));
            v.normal = floats(inScene.orientation * vec(v.normal));
        }
        return moved;
    }
    /// The feeder's, and without the mutex: what a scan's colours are looked up in changes only with the surfaces.
    [[nodiscard]] std::vector<surface::BrickUpdate> updatesOf(const std::vector<std::uint32_t>& dense) const {
        std::vector<surface::BrickUpdate> updates(dense.size());
        core::parallelFor(dense.size(), 16, [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i)
                updates[i] = updateOf(dense[i]);
        });
        return updates;
    }
    [[nodiscard]] surface::BrickUpdate updateOf(std::uint32_t dense) const {
        const tooth::ToothModel& model = mirror.model();
        return {tooth::brickId(number, dense),
                false,
                placed(fine.mesh(dense)),
                placed(coarse.mesh(dense)),
                nullptr,
                surface::scanColours(model, fine.mesh(dense).get()),
                surface::scanColours(model, coarse.mesh(dense).get())};
    }
    void tell(const surface::BrickUpdate& update) {
        told[tooth::denseOf(update.id)] = update;
        add(update);
    }
    void add(surface::BrickUpdate update) {
        std::uint32_t& at = newsAt[tooth::denseOf(update.id)];
        if (at == kNoNews) {
            at = static_cast<std::uint32_t>(news.size());
            news.push_back(std::move(update));
        } else {
            news[at] = std::move(update);
        }
    }
};

/// The teeth around the one worked on: nothing of them is kept until they are cut.
class LiveTooth::Neighbours {
  public:
    explicit Neighbours(const SimulationSetup& station) {
        for (const StandingTooth& other : station.others)
            if (other.field) teeth_.push_back({other, nullptr, {}, nullptr, false});
    }

    void hear(const tooth::BrickSnapshot& brick) {
        const std::lock_guard lock(mutex_);
        Tooth* const tooth = tellable(tooth::toothOf(brick.id));
        if (tooth == nullptr) return;
        if (tooth->live)
            tooth->live->hear(brick);
        else
            tooth->mirror->apply(brick);
    }
    void apply(const tooth::StateDelta& change) {
        const std::lock_guard lock(mutex_);
        std::uint16_t told = 0;  // no neighbour
        for (const tooth::StateDelta::Brick& brick : change.bricks) {
            const std::uint16_t number = tooth::toothOf(brick.id);
            if (number == told) continue;
            told = number;
            Tooth* const tooth = tellable(number);
            if (tooth == nullptr) continue;
            if (tooth->live)
                tooth->live->apply(change);
            else
                tooth->mirror->apply(change);
        }
    }
    /// `wait`: for what is being made.
    void refresh(bool wait) {
        const std::lock_guard lock(mutex_);
        for (Tooth& tooth : teeth_) {
            if (tooth.making.valid() &&
                (wait || tooth.making.wait_for(std::chrono::seconds(0)) == std::future_status::ready)) {
                std::shared_ptr<LiveTooth> made = tooth.making.get();
                made->wantRemovedDepths(wantsDepths_);
                made->apply(tooth.mirror->state({}));
                tooth.live = std::move(made);
                tooth.mirror.reset();
            }
            if (tooth.live) tooth.live->refresh();
        }
    }
    void append(tooth::StateDelta& state) const {
        const std::lock_guard lock(mutex_);
        for (const Tooth& tooth : teeth_)
            if (tooth.live || tooth.mirror) state.append(tooth.live ? tooth.live->state({}) : tooth.mirror->state({}));
    }
    void addUncut(std::vector<surface::BrickUpdate>& to) {
        const std::lock_guard lock(mutex_);
        for (Tooth& tooth : teeth_)
            if (tooth.live) tooth.addUncut(to);
    }
    void addNews(std::vector<surface::BrickUpdate>& to) {
        const std::lock_guard lock(mutex_);
        for (Tooth& tooth : teeth_) {
            if (!tooth.live) continue;
            if (!tooth.isShown) tooth.addUncut(to);
            std::vector<surface::BrickUpdate> news = tooth.live->takeNews();
            std::move(news.begin(), news.end(), std::back_inserter(to));
        }
    }
    [[nodiscard]] bool hasNews() const {
        const std::lock_guard lock(mutex_);
        return std::any_of(teeth_.begin(), teeth_.end(),
                           [](const Tooth& t) { return t.live && (!t.isShown || t.live->hasNews()); });
    }
    void wantRemovedDepths(bool wanted) {
        const std::lock_guard lock(mutex_);
        wantsDepths_ = wanted;
        for (const Tooth& tooth : teeth_)
            if (tooth.live) tooth.live->wantRemovedDepths(wanted);
    }

  private:
    struct Tooth {
        StandingTooth standing;
        std::unique_ptr<tooth::ToothMirror> mirror;  ///< what was heard until its surface is there
        std::future<std::shared_ptr<LiveTooth>> making;
        std::shared_ptr<LiveTooth> live;
        bool isShown = false;  ///< its uncut surface has been told

        void addUncut(std::vector<surface::BrickUpdate>& to) {
            isShown = true;
            for (surface::BrickUpdate& update : live->uncutSurface()) {
                to.push_back(update);
                to.back().isUncut = true;
            }
        }
    };

    /// With its surface, or with one that is being made; null where it cannot be cut.
    Tooth* tellable(std::uint16_t number) {
        const auto tooth = std::find_if(teeth_.begin(), teeth_.end(),
                                        [number](const Tooth& t) { return t.standing.field->toothNumber() == number; });
        if (tooth == teeth_.end()) return nullptr;
        if (!tooth->live && !tooth->mirror) {
            tooth->mirror = std::make_unique<tooth::ToothMirror>(tooth->standing.model, number);
            tooth->making = std::async(std::launch::async, [standing = tooth->standing] {
                return std::shared_ptr<LiveTooth>(new LiveTooth(standing, {}));
            });
        }
        return &*tooth;
    }

    std::vector<Tooth> teeth_;
    bool wantsDepths_ = false;
    mutable std::mutex mutex_;
};

LiveTooth::LiveTooth(std::shared_ptr<const tooth::ToothModel> model, const tooth::StateDelta& state,
                     const core::Progress& progress)
    : model_(std::move(model)), teeth_{model_}, parts_(std::make_unique<Parts>(model_, number_, inScene_)) {
    build(state, progress);
}

LiveTooth::LiveTooth(const SimulationSetup& station, const tooth::StateDelta& state, const core::Progress& progress)
    : model_(station.tooth),
      teeth_(station.teeth()),
      parts_(std::make_unique<Parts>(model_, number_, inScene_)),
      standing_(station.others) {
    if (!station.others.empty()) neighbours_ = std::make_unique<Neighbours>(station);
    build(state, progress);
}

LiveTooth::LiveTooth(const StandingTooth& standing, const tooth::StateDelta& state)
    : model_(standing.model),
      number_(standing.field->toothNumber()),
      inScene_(standing.inCase),
      parts_(std::make_unique<Parts>(model_, number_, inScene_)) {
    build(state, {});
}

void LiveTooth::build(const tooth::StateDelta& state, const core::Progress& progress) {
    Parts& p = *parts_;
    probe_ = std::make_unique<measure::ToothProbe>(p.mirror);
    strokeStart_ = std::make_unique<measure::ToothProbe>(p.strokeStart);
    // The probe makes the pulp's surface when it is first asked for, a tenth of a second: not under somebody's hands.
    const std::future<void> warmed =
        std::async(std::launch::async, [this] { (void)probe_->leftOverPulpMm(model_->outer.bounds().centre()); });
    const auto count = static_cast<std::uint32_t>(p.source.grid().count());
    for (std::uint32_t dense = 0; dense < count; ++dense)
        p.coarse.setLevel(dense, kCoarseLevel);
    p.fine.build(core::part(progress, 0.0, 0.6));
    p.coarse.build(core::part(progress, 0.6, 0.9));
    std::vector<std::uint32_t> shown;
    for (std::uint32_t dense = 0; dense < count; ++dense)
        if (p.fine.mesh(dense) != nullptr || p.coarse.mesh(dense) != nullptr) shown.push_back(dense);
    p.uncut = p.updatesOf(shown);
    warmed.wait();
    if (!state.bricks.empty()) {
        apply(state);
        refresh();
    }
    core::report(progress, 1.0);
}

LiveTooth::~LiveTooth() = default;

void LiveTooth::hear(const tooth::BrickSnapshot& brick) {
    if (tooth::toothOf(brick.id) != number_) {
        if (neighbours_) neighbours_->hear(brick);
        return;
    }
    Parts& p = *parts_;
    std::uint32_t& at = p.pendingAt[tooth::denseOf(brick.id)];
    if (at == kNoNews) {
        at = static_cast<std::uint32_t>(p.pending.size());
        p.pending.push_back(brick);
    } else {
        p.pending[at] = brick;
    }
}

void LiveTooth::apply(const tooth::StateDelta& change) {
    if (neighbours_) neighbours_->apply(change);
    const std::lock_guard lock(mutex_);
    takeUpPending();
    parts_->mirror.apply(change);
}

void LiveTooth::takeUpPending() {
    Parts& p = *parts_;
    for (const tooth::BrickSnapshot& brick : p.pending) {
        p.mirror.apply(brick);
        p.pendingAt[tooth::denseOf(brick.id)] = kNoNews;
    }
    p.pending.clear();
}

void LiveTooth::refresh() {
    if (neighbours_) neighbours_->refresh(false);
    std::unique_lock lock(mutex_);
    takeUpPending();
    shape(std::move(lock));
}

void LiveTooth::beginStroke() {
    const std::lock_guard lock(mutex_);
    parts_->strokeStart.follow(parts_->mirror);
}

void LiveTooth::settle() {
    if (neighbours_) neighbours_->refresh(true);
    refresh();
}

bool LiveTooth::tryRefresh() {
    std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) return false;
    if (neighbours_) neighbours_->refresh(false);
    takeUpPending();
    shape(std::move(lock));
    return true;
}

void LiveTooth::shape(std::unique_lock<std::mutex> lock) {
    Parts& p = *parts_;
    const std::vector<std::uint32_t> touched = p.mirror.takeTouched();
    const bool depthsAgain = std::exchange(p.depthsAgain, false);
    if (touched.empty() && !depthsAgain) return tellWhetherNews();
    // The surfaces only read the mirror, and only this thread writes it: whoever measures may go on meanwhile.
    lock.unlock();
    std::vector<std::uint32_t> changed;
    if (!touched.empty()) {
        const std::vector<std::uint32_t> fine = p.fine.update(touched), coarse = p.coarse.update(touched);
        std::set_union(fine.begin(), fine.end(), coarse.begin(), coarse.end(), std::back_inserter(changed));
    }
    if (depthsAgain) {
        std::vector<std::uint32_t> all;
        const auto count = static_cast<std::uint32_t>(p.source.grid().count());
        for (std::uint32_t dense = 0; dense < count; ++dense)
            if (std::binary_search(changed.begin(), changed.end(), dense) || isNearCut(dense)) all.push_back(dense);
        changed = std::move(all);
    }
    std::vector<surface::BrickUpdate> updates = p.updatesOf(changed);
    lock.lock();
    for (surface::BrickUpdate& update : updates) {
        if (const auto mesh = p.fine.mesh(tooth::denseOf(update.id)); p.wantsDepths && mesh != nullptr) {
            std::vector<std::array<float, 3>> places;
            places.reserve(mesh->vertices.size());
            for (const surface::SurfaceVertex& v : mesh->vertices)
                places.push_back(v.positionMm);
            update.removedDepthMm = std::make_shared<const std::vector<float>>(probe_->removedDepths(places));
        }
        p.tell(update);
    }
    tellWhetherNews();
}

/// Under the mutex.
void LiveTooth::tellWhetherNews() {
    hasNews_.store(!parts_->news.empty() || (neighbours_ && neighbours_->hasNews()), std::memory_order_release);
}

bool LiveTooth::isNearCut(std::uint32_t dense) const {
    const Parts& p = *parts_;
    if (p.fine.mesh(dense) == nullptr) return false;
    // A brick's triangles reach into its neighbours' vertices.
    for (int slot = 0; slot < 27; ++slot) {
        const std::int64_t other = p.source.grid().neighbour(dense, slot % 3 - 1, slot / 3 % 3 - 1, slot / 9 - 1);
        if (other >= 0 && p.mirror.isChanged(static_cast<std::uint32_t>(other))) return true;
    }
    return false;
}

std::vector<surface::BrickUpdate> LiveTooth::uncutSurface() {
    const std::lock_guard lock(mutex_);
    for (const auto& [dense, update] : parts_->told)
        parts_->add(update);
    std::vector<surface::BrickUpdate> uncut = parts_->uncut;
    if (neighbours_) neighbours_->addUncut(uncut);
    tellWhetherNews();
    return uncut;
}

std::vector<surface::BrickUpdate> LiveTooth::takeNews() {
    std::vector<surface::BrickUpdate> taken;
    const std::lock_guard lock(mutex_);
    taken.swap(parts_->news);
    for (const surface::BrickUpdate& update : taken)
        parts_->newsAt[tooth::denseOf(update.id)] = kNoNews;
    if (neighbours_) neighbours_->addNews(taken);
    tellWhetherNews();
    return taken;
}

void LiveTooth::wantRemovedDepths(bool wanted) {
    const std::lock_guard lock(mutex_);
    if (wanted && !parts_->wantsDepths) parts_->depthsAgain = true;
    parts_->wantsDepths = wanted;
    if (neighbours_) neighbours_->wantRemovedDepths(wanted);
}

tooth::StateDelta LiveTooth::state(const tooth::RemovedMm3& removedMm3) const {
    const std::lock_guard lock(mutex_);
    tooth::StateDelta state = parts_->mirror.state({});
    if (neighbours_) neighbours_->append(state);
    state.removedMm3 = removedMm3;
    return state;
}

}  // namespace handpiece::simulation
