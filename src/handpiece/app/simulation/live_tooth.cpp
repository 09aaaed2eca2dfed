// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/live_tooth.h"

#include <algorithm>
#include <future>
#include <map>
#include <utility>

#include "handpiece/senses/surface/brick_source.h"

namespace handpiece::simulation {
namespace {

constexpr int kCoarseLevel = surface::kMaxLevel;
constexpr std::uint32_t kNoNews = 0xffffffffu;

}  // namespace

struct LiveTooth::Parts {
    explicit Parts(const std::shared_ptr<const tooth::ToothModel>& model)
        : mirror(model),
          source(mirror),
          fine(source, &model->tissues),
          coarse(source, &model->tissues),
          newsAt(source.grid().count(), kNoNews),
          pendingAt(source.grid().count(), kNoNews) {}

    tooth::ToothMirror mirror;
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

    [[nodiscard]] surface::BrickUpdate updateOf(std::uint32_t dense) const {
        return {dense, fine.mesh(dense), coarse.mesh(dense), nullptr};
    }
    void tell(const surface::BrickUpdate& update) {
        told[update.dense] = update;
        add(update);
    }
    void add(surface::BrickUpdate update) {
        std::uint32_t& at = newsAt[update.dense];
        if (at == kNoNews) {
            at = static_cast<std::uint32_t>(news.size());
            news.push_back(std::move(update));
        } else {
            news[at] = std::move(update);
        }
    }
};

LiveTooth::LiveTooth(std::shared_ptr<const tooth::ToothModel> model, const tooth::StateDelta& state,
                     const core::Progress& progress)
    : model_(std::move(model)), parts_(std::make_unique<Parts>(model_)) {
    Parts& p = *parts_;
    probe_ = std::make_unique<measure::ToothProbe>(p.mirror);
    // The probe makes the pulp's surface when it is first asked for, a tenth of a second: not under somebody's hands.
    const std::future<void> warmed =
        std::async(std::launch::async, [this] { (void)probe_->leftOverPulpMm(model_->outer.bounds().centre()); });
    const auto count = static_cast<std::uint32_t>(p.source.grid().count());
    for (std::uint32_t dense = 0; dense < count; ++dense)
        p.coarse.setLevel(dense, kCoarseLevel);
    p.fine.build(core::part(progress, 0.0, 0.6));
    p.coarse.build(core::part(progress, 0.6, 0.9));
    for (std::uint32_t dense = 0; dense < count; ++dense) {
        surface::BrickUpdate update = p.updateOf(dense);
        if (update.mesh != nullptr || update.coarse != nullptr) p.uncut.push_back(std::move(update));
    }
    warmed.wait();
    if (!state.bricks.empty()) {
        apply(state);
        refresh();
    }
    core::report(progress, 1.0);
}

LiveTooth::~LiveTooth() = default;

void LiveTooth::hear(const tooth::BrickSnapshot& brick) {
    Parts& p = *parts_;
    std::uint32_t& at = p.pendingAt[brick.dense];
    if (at == kNoNews) {
        at = static_cast<std::uint32_t>(p.pending.size());
        p.pending.push_back(brick);
    } else {
        p.pending[at] = brick;
    }
}

void LiveTooth::apply(const tooth::StateDelta& change) {
    const std::lock_guard lock(mutex_);
    takeUpPending();
    parts_->mirror.apply(change);
}

void LiveTooth::takeUpPending() {
    Parts& p = *parts_;
    for (const tooth::BrickSnapshot& brick : p.pending) {
        p.mirror.apply(brick);
        p.pendingAt[brick.dense] = kNoNews;
    }
    p.pending.clear();
}

void LiveTooth::refresh() {
    std::unique_lock lock(mutex_);
    takeUpPending();
    shape(std::move(lock));
}

bool LiveTooth::tryRefresh() {
    std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) return false;
    takeUpPending();
    shape(std::move(lock));
    return true;
}

void LiveTooth::shape(std::unique_lock<std::mutex> lock) {
    Parts& p = *parts_;
    const std::vector<std::uint32_t> touched = p.mirror.takeTouched();
    const bool depthsAgain = std::exchange(p.depthsAgain, false);
    if (touched.empty() && !depthsAgain) return;
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
    lock.lock();
    for (const std::uint32_t dense : changed) {
        surface::BrickUpdate update = p.updateOf(dense);
        if (p.wantsDepths && update.mesh != nullptr) {
            std::vector<std::array<float, 3>> places;
            places.reserve(update.mesh->vertices.size());
            for (const surface::SurfaceVertex& v : update.mesh->vertices)
                places.push_back(v.positionMm);
            update.removedDepthMm = std::make_shared<const std::vector<float>>(probe_->removedDepths(places));
        }
        p.tell(update);
    }
    hasNews_.store(!p.news.empty(), std::memory_order_release);
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
    hasNews_.store(!parts_->news.empty(), std::memory_order_release);
    return parts_->uncut;
}

std::vector<surface::BrickUpdate> LiveTooth::takeNews() {
    std::vector<surface::BrickUpdate> taken;
    const std::lock_guard lock(mutex_);
    taken.swap(parts_->news);
    for (const surface::BrickUpdate& update : taken)
        parts_->newsAt[update.dense] = kNoNews;
    hasNews_.store(false, std::memory_order_release);
    return taken;
}

void LiveTooth::wantRemovedDepths(bool wanted) {
    const std::lock_guard lock(mutex_);
    if (wanted && !parts_->wantsDepths) parts_->depthsAgain = true;
    parts_->wantsDepths = wanted;
}

tooth::StateDelta LiveTooth::state(const tooth::TissueVolumes& removedMm3) const {
    const std::lock_guard lock(mutex_);
    return parts_->mirror.state(removedMm3);
}

}  // namespace handpiece::simulation
