// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/review_gather.h"

#include "handpiece/app/report/page_png.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/model/field/brick_tissues.h"

namespace handpiece::report {
namespace {

using config::words;
using core::Vec3;

/// The page's grid: finer is not seen, and a finer session is thinned out to it.
constexpr double kGridMm = 0.1;
/// Poses and, every fifth of them, what has changed of the tooth.
constexpr double kPoseStepS = 0.05;
constexpr std::size_t kPosesAKey = 5;
constexpr std::size_t kMostPoints = 3000;
/// Events of the same kind that follow one another within this are one moment.
constexpr double kRunS = 5.0;
/// Of the page's grid: more is no tooth, and no browser's. Along an axis, and in all.
constexpr std::int32_t kMostNodesAlong = 2048;
constexpr std::size_t kMostNodes = 24'000'000;
constexpr int kPictureWidth = 400, kPictureHeight = 300;

}  // namespace

PageGrid::PageGrid(const field::FieldView& of) : view(of) {
    while (stride < field::kBrickCells && (view.voxelMm * stride < kGridMm * 0.99 || isTooLarge()))
        stride *= 2;
    edge = field::kBrickCells / stride;
    for (std::size_t k = 0; k < 3; ++k)
        nodes[k] = nodesAlong(k);
}

std::int32_t PageGrid::nodesAlong(std::size_t k) const {
    return view.bricks[k] * (field::kBrickCells / stride) + 1;
}

bool PageGrid::isTooLarge() const {
    std::size_t all = 1;
    for (std::size_t k = 0; k < 3; ++k)
        all *= static_cast<std::size_t>(nodesAlong(k));
    return all > kMostNodes || std::max({nodesAlong(0), nodesAlong(1), nodesAlong(2)}) > kMostNodesAlong;
}

bool PageGrid::isAs(const field::FieldView& other) const {
    for (int k = 0; k < 3; ++k)
        if (view.bricks[k] != other.bricks[k] || view.originMm[k] != other.originMm[k]) return false;
    return view.voxelMm == other.voxelMm;
}

Gathered::Gathered(std::size_t ofEach, const tasks::Task* task) : picturesOfEach(ofEach) {
    if (task != nullptr && task->toothCase.exercise) view = task->toothCase.exercise->view;
}

void Gathered::follow(const simulation::SessionPlayer& next, const std::string& name,
                      std::optional<std::uint64_t> untilTick) {
    if (!model)
        takeTooth(next);
    else if (!grid->isAs(next.station().tooth->field.view()) || model->identity != next.station().tooth->identity)
        throw core::Error("this session is of another tooth or voxel than those before it", name,
                          "give the sessions of one work");
    player = &next;
    const double rateHz = next.reader().info().rateHz;
    Sitting sitting{name, durationS(), next.durationS(), next.reader().endTick()};
    if (untilTick && *untilTick < sitting.lastTick) {
        sitting.lastTick = *untilTick;
        sitting.lengthS = std::min(sitting.lengthS, static_cast<double>(*untilTick) / rateHz);
    }
    if (!sittings.empty()) moments.push_back({sitting.fromS, words()("review.next-session", name)});
    sittings.push_back(sitting);
    addEvents();
    const double stepS = std::max(simulation::kPlotStepS, next.durationS() / static_cast<double>(kMostPoints));
    for (simulation::PlotPoint point : next.plot(stepS)) {
        if (point.timeS > sitting.lengthS) break;
        point.timeS += sitting.fromS;
        points.push_back(point);
    }
    looks = picturesNow = 0;
    artist.reset();
    if (picturesOfEach > 0 && next.tooth()) {
        try {
            artist.emplace(next, view::Viewport{kPictureWidth, kPictureHeight});
        } catch (const core::Error&) {
            // Without OpenGL there are no pictures; the page does without.
        }
    }
}

void Gathered::takeTooth(const simulation::SessionPlayer& of) {
    model = of.station().tooth;
    grid.emplace(model->field.view());
    buccalSign = of.toothCase().buccalSign < 0 ? -1 : 1;
    isUpper = cases::isUpperTooth(of.toothCase().fdiNumber);
    caseKey = cases::caseKey(of.toothCase());
    uncut.nodes = tissue.nodes = grid->nodes;
    const std::size_t count = static_cast<std::size_t>(grid->nodes[0]) * static_cast<std::size_t>(grid->nodes[1]) *
                              static_cast<std::size_t>(grid->nodes[2]);
    uncut.values.resize(count);
    tissue.values.resize(count);
    core::parallelFor(grid->bricks(), 64, [&](std::size_t begin, std::size_t end) {
        std::array<float, field::kBrickValues> values;
        for (std::size_t b = begin; b < end; ++b) {
            const auto dense = static_cast<std::uint32_t>(b);
            model->uncutBrick(dense, values.data());
            const std::uint8_t* tissues = model->field.storage().tissues->of(dense);
            grid->eachNode(dense, [&](int x, int y, int z, std::size_t node) {
                uncut.values[uncut.index(x, y, z)] = coded(values[node]);
                tissue.values[tissue.index(x, y, z)] = tissues[node];
            });
        }
    });
    now = uncut;
    isChanged.resize(grid->bricks());
    if (!of.toothCase().others.empty() || !of.toothCase().scenery.empty()) {
        const auto [lowMm, highMm] = toothBoundsMm();
        around = aroundOf(of.toothCase(), lowMm, highMm);
    }
    if (!around.parts.empty()) notes.push_back(words().text("review.around-uncut"));
}

std::pair<Vec3, Vec3> Gathered::toothBoundsMm() const {
    Vec3 low = Vec3::Constant(1e9), high = Vec3::Constant(-1e9);
    for (int z = 0; z < grid->nodes[2]; ++z)
        for (int y = 0; y < grid->nodes[1]; ++y)
            for (int x = 0; x < grid->nodes[0]; ++x)
                if (uncut.values[uncut.index(x, y, z)] <= kMiddle) {
                    low = low.cwiseMin(grid->placeMm(x, y, z));
                    high = high.cwiseMax(grid->placeMm(x, y, z));
                }
    return {low, high};
}

void Gathered::lookAtTooth(double timeS) {
    const tooth::StateDelta state = player->state();
    ChangedAt key;
    key.timeS = timeS;
    std::vector<std::uint8_t> changes;
    // What was cut and is in the state no more is whole again.
    std::size_t i = 0;
    for (std::uint32_t dense = 0; dense < isChanged.size(); ++dense) {
        while (i < state.bricks.size() && state.bricks[i].id < dense)
            ++i;
        const bool isNow = i < state.bricks.size() && state.bricks[i].id == dense && !state.bricks[i].uncut;
        if (!isNow && !isChanged[dense]) continue;
        isChanged[dense] = isNow;
        changes.clear();
        bool isOther = false;
        const auto brick = field::brickAt(grid->view.bricks, dense);
        grid->eachNode(dense, [&](int x, int y, int z, std::size_t node) {
            // The grid's last nodes lie outside of the tooth: they never change.
            if (x == (brick[0] + 1) * grid->edge || y == (brick[1] + 1) * grid->edge ||
                z == (brick[2] + 1) * grid->edge)
                return;
            const std::size_t at = now.index(x, y, z);
            const std::uint8_t value = isNow ? coded(state.bricks[i].values[node]) : uncut.values[at];
            changes.push_back(static_cast<std::uint8_t>(value - now.values[at]));
            isOther |= value != now.values[at];
            now.values[at] = value;
        });
        if (!isOther) continue;
        everChanged.resize(isChanged.size());
        everChanged[dense] = true;
        key.bricks.push_back(dense);
        key.changes.insert(key.changes.end(), changes.begin(), changes.end());
    }
    if (!key.bricks.empty()) keys.push_back(std::move(key));
}

void Gathered::look() {
    const messages::HapticSample& sample = player->sample();
    const Sitting& sitting = sittings.back();
    if (sample.tick > sitting.lastTick) return;
    const double timeS = sitting.fromS + sample.timeS;
    const std::array<double, 3>& p = sample.proxyPositionMm;
    const std::array<double, 4>& q = sample.proxyOrientation;
    poses.push_back({timeS, Vec3(p[0], p[1], p[2]), q});
    if (burs.empty() || burs.back().second != player->station().settings.bur)
        burs.emplace_back(timeS, player->station().settings.bur);
    const bool isLast = sample.timeS >= sitting.lengthS;
    if (looks++ % kPosesAKey == 0 || isLast) lookAtTooth(timeS);
    if (artist && (isLast || sample.timeS >= sitting.lengthS * static_cast<double>(picturesNow) /
                                                 static_cast<double>(std::max<std::size_t>(picturesOfEach, 2) - 1)))
        draw(timeS);
}

void Gathered::draw(double timeS) {
    ++picturesNow;
    if (!pictures.empty() && picturesAtKey == keys.size()) return;
    picturesAtKey = keys.size();
    player->tooth()->settle();
    artist->cut(player->tooth()->takeNews());
    pictures.push_back({timeS, pagePng(artist->pictureFrom(view))});
}

/// Events worth a place in the list, each run of the same once; and the strokes.
void Gathered::addEvents() {
    using session::EventName;
    constexpr std::array kShown{
        EventName::burChange,    EventName::firstDentine, EventName::pulpExposure, EventName::neighbourTouched,
        EventName::neighbourCut, EventName::stall,        EventName::forceLimit,   EventName::undo,
        EventName::redo,         EventName::reset,        EventName::gingivaCut,   EventName::headTouched,
        EventName::fault,        EventName::resume};
    const Sitting& sitting = sittings.back();
    std::map<std::string, double> lastS;
    bool isDown = false;
    for (const session::Event& event : player->events()) {
        if (event.tick > sitting.lastTick) break;
        const double timeS =
            sitting.fromS + std::min(static_cast<double>(event.tick) / player->reader().info().rateHz, sitting.lengthS);
        if (event.name == session::nameOf(EventName::strokeBegin)) {
            strokes.push_back({timeS, durationS()});
            isDown = true;
        } else if (event.name == session::nameOf(EventName::strokeEnd) && isDown) {
            strokes.back().toS = timeS;
            isDown = false;
        }
        if (std::none_of(kShown.begin(), kShown.end(),
                         [&](EventName name) { return session::nameOf(name) == event.name; }))
            continue;
        const auto last = lastS.find(event.name);
        const bool isRun = last != lastS.end() && timeS - last->second < kRunS;
        lastS[event.name] = timeS;
        if (isRun) continue;
        std::string id = "review.event-" + event.name;
        std::replace(id.begin(), id.end(), ' ', '-');
        moments.push_back({timeS, words().text(id)});
    }
}

ReviewGatherer::ReviewGatherer(std::size_t pictures, const tasks::Task* task)
    : gathered_(std::make_unique<Gathered>(pictures, task)) {}
ReviewGatherer::~ReviewGatherer() = default;

void ReviewGatherer::follow(const simulation::SessionPlayer& player, const std::string& name,
                            std::optional<std::uint64_t> untilTick) {
    gathered_->follow(player, name, untilTick);
}

void ReviewGatherer::look() {
    gathered_->look();
}

void ReviewGatherer::note(const std::string& text) {
    gathered_->notes.push_back(text);
}

double ReviewGatherer::stepS() {
    return kPoseStepS;
}

}  // namespace handpiece::report
