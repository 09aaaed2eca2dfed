// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/review.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "handpiece/app/report/artist.h"
#include "handpiece/app/report/assessment_report.h"
#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/page_png.h"
#include "handpiece/app/report/review_around.h"
#include "handpiece/app/report/review_data.h"
#include "handpiece/app/report/session_report.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/brick_index.h"
#include "handpiece/model/field/brick_tissues.h"
#include "handpiece/senses/view/look.h"

namespace handpiece::report {
namespace {

using config::words;
using core::Vec3;
using Json = nlohmann::ordered_json;

/// The page's grid: finer is not seen, and a finer session is thinned out to it.
constexpr double kGridMm = 0.1;
/// Of the distances: steps a voxel of the grid; eight bits reach two and a half voxels.
constexpr double kStepsAVoxel = 50.0;
constexpr int kMiddle = 128, kMost = 127;
/// Poses and, every fifth of them, what has changed of the tooth.
constexpr double kPoseStepS = 0.05;
constexpr std::size_t kPosesAKey = 5;
constexpr std::size_t kMostPoints = 3000;
/// Events of the same kind that follow one another within this are one moment.
constexpr double kRunS = 5.0;
/// Of the page's grid: more is no tooth, and no browser's. Along an axis, and in all.
constexpr std::int32_t kMostNodesAlong = 2048;
constexpr std::size_t kMostNodes = 24'000'000;
/// Of the bytes there are, the share that pictures may have, and that poses may have.
constexpr double kPictureShare = 0.5, kPoseShare = 0.4;
constexpr int kPictureWidth = 400, kPictureHeight = 300;
constexpr double kPlaceStepMm = 0.002, kTurnStep = 1.0 / 32767.0, kForceStepN = 0.001, kDepthStepMm = 0.001;

std::uint8_t eightBits(double value, double steps) {
    const double rounded = std::floor(value * steps + 0.5);
    return static_cast<std::uint8_t>(std::clamp(rounded, static_cast<double>(-kMost), static_cast<double>(kMost)) +
                                     kMiddle);
}

std::uint16_t sixteenBits(double value, double step) {
    const double rounded = std::floor(value / step + 0.5);
    return static_cast<std::uint16_t>(static_cast<std::int16_t>(std::clamp(rounded, -32767.0, 32767.0)));
}

double rounded(double value, double step) {
    return std::floor(value / step + 0.5) * step;
}

/// Bricks of the tooth's field on the page's grid: each brings `edge`^3 nodes of its own.
struct PageGrid {
    explicit PageGrid(const field::FieldView& of) : view(of) {
        while (stride < field::kBrickCells && (view.voxelMm * stride < kGridMm * 0.99 || isTooLarge()))
            stride *= 2;
        edge = field::kBrickCells / stride;
        for (std::size_t k = 0; k < 3; ++k)
            nodes[k] = nodesAlong(k);
    }
    [[nodiscard]] std::int32_t nodesAlong(std::size_t k) const {
        return view.bricks[k] * (field::kBrickCells / stride) + 1;
    }
    [[nodiscard]] bool isTooLarge() const {
        std::size_t all = 1;
        for (std::size_t k = 0; k < 3; ++k)
            all *= static_cast<std::size_t>(nodesAlong(k));
        return all > kMostNodes || std::max({nodesAlong(0), nodesAlong(1), nodesAlong(2)}) > kMostNodesAlong;
    }
    /// Nodes of both lie at the same places.
    [[nodiscard]] bool isAs(const field::FieldView& other) const {
        for (int k = 0; k < 3; ++k)
            if (view.bricks[k] != other.bricks[k] || view.originMm[k] != other.originMm[k]) return false;
        return view.voxelMm == other.voxelMm;
    }
    [[nodiscard]] double voxelMm() const { return view.voxelMm * stride; }
    [[nodiscard]] std::size_t bricks() const {
        return static_cast<std::size_t>(view.bricks[0]) * static_cast<std::size_t>(view.bricks[1]) *
               static_cast<std::size_t>(view.bricks[2]);
    }
    [[nodiscard]] Vec3 placeMm(int x, int y, int z) const {
        return Vec3(view.originMm[0], view.originMm[1], view.originMm[2]) + voxelMm() * Vec3(x, y, z);
    }
    /// Calls f(x, y, z of the grid, number in the brick) for its own nodes; at the upper ends of the grid those of the
    /// brick's upper faces too.
    template <class F>
    void eachNode(std::uint32_t dense, F&& f) const {
        const auto brick = field::brickAt(view.bricks, dense);
        std::array<int, 3> end{};
        for (std::size_t k = 0; k < 3; ++k)
            end[k] = brick[k] + 1 == view.bricks[k] ? edge + 1 : edge;
        for (int z = 0; z < end[2]; ++z)
            for (int y = 0; y < end[1]; ++y)
                for (int x = 0; x < end[0]; ++x)
                    f(brick[0] * edge + x, brick[1] * edge + y, brick[2] * edge + z,
                      static_cast<std::size_t>(stride * (x + field::kBrickNodes * (y + field::kBrickNodes * z))));
    }

    field::FieldView view;
    int stride = 1, edge = field::kBrickCells;
    std::array<std::int32_t, 3> nodes{};
};

struct ChangedAt {
    double timeS = 0.0;
    std::vector<std::uint32_t> bricks;  ///< rising
    std::vector<std::uint8_t> changes;  ///< of each its edge^3 nodes: now less before, modulo 256
};

/// Both in one: of a brick in both the changes add up.
ChangedAt joined(const ChangedAt& first, const ChangedAt& second, std::size_t perBrick) {
    ChangedAt both;
    both.timeS = second.timeS;
    std::size_t i = 0, j = 0;
    const auto take = [&](const ChangedAt& key, std::size_t at) {
        both.changes.insert(both.changes.end(), key.changes.begin() + static_cast<std::ptrdiff_t>(at * perBrick),
                            key.changes.begin() + static_cast<std::ptrdiff_t>((at + 1) * perBrick));
    };
    while (i < first.bricks.size() || j < second.bricks.size()) {
        const bool isFirst =
            j == second.bricks.size() || (i < first.bricks.size() && first.bricks[i] <= second.bricks[j]);
        const bool isBoth = i < first.bricks.size() && j < second.bricks.size() && first.bricks[i] == second.bricks[j];
        both.bricks.push_back(isFirst ? first.bricks[i] : second.bricks[j]);
        take(isFirst ? first : second, isFirst ? i : j);
        if (isBoth)
            for (std::size_t n = 0; n < perBrick; ++n) {
                std::uint8_t& sum = both.changes[both.changes.size() - perBrick + n];
                sum = static_cast<std::uint8_t>(sum + second.changes[j * perBrick + n]);
            }
        i += isFirst;
        j += !isFirst || isBoth;
    }
    return both;
}

struct Pose {
    double timeS;
    Vec3 placeMm;
    std::array<double, 4> turn;
};
/// A session of a chain.
struct Sitting {
    std::string name;
    double fromS = 0.0, lengthS = 0.0;
    std::uint64_t lastTick = 0;
};

Json threeOf(const Vec3& p) {
    return Json::array({rounded(p.x(), 0.001), rounded(p.y(), 0.001), rounded(p.z(), 0.001)});
}

std::string hexOf(const std::array<std::uint8_t, 3>& colour) {
    return fmt::format("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2]);
}

}  // namespace

struct ReviewGatherer::State {
    State(std::size_t ofEach, const tasks::Task* task) : picturesOfEach(ofEach) {
        if (task != nullptr && task->toothCase.exercise) view = task->toothCase.exercise->view;
    }

    void follow(const simulation::SessionPlayer& next, const std::string& name,
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
        if (!sittings.empty())
            moments.push_back(
                {{"timeS", rounded(sitting.fromS, 0.001)}, {"text", words()("review.next-session", name)}});
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

    void takeTooth(const simulation::SessionPlayer& of) {
        model = of.station().tooth;
        grid.emplace(model->field.view());
        buccalSign = of.toothCase().buccalSign < 0 ? -1 : 1;
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

    /// Of the uncut tooth.
    [[nodiscard]] std::pair<Vec3, Vec3> toothBoundsMm() const {
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

    [[nodiscard]] double durationS() const {
        return sittings.empty() ? 0.0 : sittings.back().fromS + sittings.back().lengthS;
    }

    [[nodiscard]] std::uint8_t coded(float distanceMm) const {
        return eightBits(static_cast<double>(distanceMm) / grid->voxelMm(), kStepsAVoxel);
    }
    [[nodiscard]] std::size_t perBrick() const {
        return static_cast<std::size_t>(grid->edge) * static_cast<std::size_t>(grid->edge) *
               static_cast<std::size_t>(grid->edge);
    }

    void lookAtTooth(double timeS) {
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

    void look() {
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

    /// Again only what has changed since the picture before it.
    void draw(double timeS) {
        ++picturesNow;
        if (!pictures.empty() && picturesAtKey == keys.size()) return;
        picturesAtKey = keys.size();
        player->tooth()->settle();
        artist->cut(player->tooth()->takeNews());
        pictures.push_back({timeS, pagePng(artist->pictureFrom(view))});
    }

    void addEvents();

    /// What stands for the whole tooth's distances in those to the ideal.
    [[nodiscard]] std::array<std::uint8_t, 256> wholeAsIdeal() const {
        std::array<std::uint8_t, 256> whole{};
        for (int i = 0; i < 256; ++i)
            whole[static_cast<std::size_t>(i)] =
                eightBits((i - kMiddle) / kStepsAVoxel * grid->voxelMm(), kMost / kDeviationMostMm);
        return whole;
    }

    /// How far places lie from the ideal tooth, positive where tissue should be gone: less (modulo 256) what
    /// wholeAsIdeal() says, which is nothing away from all that was cut or is to be.
    [[nodiscard]] Volume idealOf(const tasks::Task& task) const {
        const preparation::Laid laid = preparation::layOn(task.toothCase, *task.preparation);
        const zones::Zones& zones = *laid.zones;
        const Vec3 around = Vec3::Constant(kDeviationMostMm + 2.0 * grid->voxelMm());
        const Vec3 low = zones.box().min - around, high = zones.box().max + around;
        const auto whole = wholeAsIdeal();
        Volume ideal;
        ideal.nodes = grid->nodes;
        ideal.values.resize(uncut.values.size());
        core::parallelFor(grid->bricks(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t b = begin; b < end; ++b) {
                const bool isCut = b < everChanged.size() && everChanged[b];
                grid->eachNode(static_cast<std::uint32_t>(b), [&](int x, int y, int z, std::size_t) {
                    const std::size_t at = uncut.index(x, y, z);
                    const Vec3 p = grid->placeMm(x, y, z);
                    const bool isNear =
                        isCut || ((p.array() >= low.array()).all() && (p.array() <= high.array()).all());
                    // Far outside nothing is ever asked.
                    if (!isNear || uncut.values[at] == kMiddle + kMost) return;
                    const double toIdealMm =
                        std::max(model->tree.signedDistance(p), std::min(-zones.targetMm(p), zones.protectedMm(p)));
                    ideal.values[at] = static_cast<std::uint8_t>(eightBits(toIdealMm, kMost / kDeviationMostMm) -
                                                                 whole[uncut.values[at]]);
                });
            }
        });
        return ideal;
    }

    const std::size_t picturesOfEach;
    std::optional<cases::View> view;
    const simulation::SessionPlayer* player = nullptr;  ///< of the session that is played
    std::shared_ptr<const tooth::ToothModel> model;
    std::optional<PageGrid> grid;
    int buccalSign = 1;
    std::uint64_t caseKey = 0;
    std::vector<std::string> notes;
    Around around;
    std::vector<Sitting> sittings;
    Json moments = Json::array(), strokes = Json::array();
    std::vector<simulation::PlotPoint> points;
    Volume uncut, tissue, now;
    std::vector<bool> isChanged, everChanged;  ///< by dense brick
    std::vector<ChangedAt> keys;
    std::vector<Pose> poses;
    std::vector<std::pair<double, std::shared_ptr<const instrument::Bur>>> burs;
    std::optional<Artist> artist;
    std::vector<Review::Picture> pictures;
    std::size_t looks = 0, picturesNow = 0, picturesAtKey = 0;
};

namespace {

Json burOf(double fromS, const instrument::Bur& bur) {
    Json outline = Json::array();
    for (const instrument::SurfaceRing& ring : bur.rings())
        outline.push_back(Json::array({rounded(ring.rhoMm, 0.001), rounded(ring.zMm, 0.001)}));
    return {{"fromS", rounded(fromS, 0.001)}, {"name", bur.name()}, {"outlineMm", std::move(outline)}};
}

/// What was lost because the work is not done, then the criteria, the dearest first.
Json errorsOf(const ReviewedAgainst& against, std::span<const Sitting> sittings) {
    Json errors = Json::array();
    const score::Assessment& a = against.result->assessment;
    const auto lead = [&](Json& error, const std::vector<measures::Evidence>& evidence) {
        for (const measures::Evidence& e : evidence) {
            if (e.placeMm && !error.contains("placeMm")) error["placeMm"] = threeOf(*e.placeMm);
            if (e.timeS && !error.contains("timeS") && e.session < sittings.size() &&
                *e.timeS <= sittings[e.session].lengthS + 0.001)
                error["timeS"] = rounded(sittings[e.session].fromS + *e.timeS, 0.001);
        }
    };
    const auto lost = [](double points) { return words()("assessment.points-lost", fmt::format("{:.1f}", points)); };
    if (costsUndone(a)) {
        const score::Completeness& c = *a.completeness;
        Json error{{"title", words().text("assessment.not-finished")},
                   {"lost", lost(a.lostUndone())},
                   {"measured", fmt::format("{:.1f} ± {:.1f} {}", *c.value, c.uncertainty, c.unit)},
                   {"practise", std::string()}};
        lead(error, c.evidence);
        errors.push_back(std::move(error));
    }
    for (const std::size_t i : costliest(a)) {
        const score::CriterionScore& c = a.criteria[i];
        Json error{{"title", criterionTitle(*against.rubric, c.id)},
                   {"lost", c.critical == score::Verdict::yes ? words().text("rubric.critical")
                                                              : lost(c.maxPoints - c.ownPoints)},
                   {"measured", c.value ? valueOf(c) : said(c.reason)},
                   {"practise", drillFor(c.measure)}};
        lead(error, c.evidence);
        errors.push_back(std::move(error));
    }
    return errors;
}

}  // namespace

/// Events worth a place in the list, each run of the same once; and the strokes.
void ReviewGatherer::State::addEvents() {
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
            strokes.push_back(Json::array({rounded(timeS, 0.001), rounded(durationS(), 0.001)}));
            isDown = true;
        } else if (event.name == session::nameOf(EventName::strokeEnd) && isDown) {
            strokes.back()[1] = rounded(timeS, 0.001);
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
        moments.push_back({{"timeS", rounded(timeS, 0.001)}, {"text", words().text(id)}});
    }
}

namespace {

/// The last stays.
template <class T>
std::vector<T> everyOther(std::vector<T> all) {
    std::vector<T> fewer;
    for (std::size_t i = 0; i < all.size(); ++i)
        if ((all.size() - 1 - i) % 2 == 0) fewer.push_back(std::move(all[i]));
    return fewer;
}

/// Columns of threes as rows, part by part.
std::vector<std::uint8_t> aroundBytes(const Around& around) {
    std::vector<std::uint8_t> all;
    for (const AroundPart& part : around.parts)
        for (const auto* threes : {&part.vertices, &part.triangles}) {
            std::vector<std::vector<std::uint16_t>> rows(3);
            for (const std::array<std::uint16_t, 3>& three : *threes)
                for (std::size_t k = 0; k < 3; ++k)
                    rows[k].push_back(three[k]);
            const std::vector<std::uint8_t> planes = planesOf(rows);
            all.insert(all.end(), planes.begin(), planes.end());
        }
    return all;
}

std::vector<std::uint8_t> posedOf(const std::vector<Pose>& all, const tooth::ToothModel& model) {
    std::vector<double> tipMm(all.size());
    core::parallelFor(all.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            tipMm[i] = -model.tree.signedDistance(all[i].placeMm);
    });
    std::vector<std::vector<std::uint16_t>> rows(9);
    double beforeMs = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Pose& p = all[i];
        // Of the rounded times, so that they do not run off.
        const double ms = std::min(std::floor(p.timeS * 1000.0 + 0.5), beforeMs + 65535.0);
        rows[0].push_back(static_cast<std::uint16_t>(ms - beforeMs));
        beforeMs = ms;
        for (std::size_t k = 0; k < 3; ++k)
            rows[1 + k].push_back(sixteenBits(p.placeMm[static_cast<Eigen::Index>(k)], kPlaceStepMm));
        for (std::size_t k = 0; k < 4; ++k)
            rows[4 + k].push_back(sixteenBits(p.turn[k], kTurnStep));
        rows[8].push_back(sixteenBits(std::max(tipMm[i], -1.0), kDepthStepMm));
    }
    return planesOf(rows);
}

}  // namespace

ReviewGatherer::ReviewGatherer(std::size_t pictures, const tasks::Task* task)
    : state_(std::make_unique<State>(pictures, task)) {}
ReviewGatherer::~ReviewGatherer() = default;

void ReviewGatherer::follow(const simulation::SessionPlayer& player, const std::string& name,
                            std::optional<std::uint64_t> untilTick) {
    state_->follow(player, name, untilTick);
}

void ReviewGatherer::look() {
    state_->look();
}

void ReviewGatherer::note(const std::string& text) {
    state_->notes.push_back(text);
}

double ReviewGatherer::stepS() {
    return kPoseStepS;
}

Review ReviewGatherer::review(const std::string& title, const ReviewedAgainst& against, std::size_t mostBytes) const {
    const State& s = *state_;
    const field::FieldView& view = s.grid->view;

    Json json{{"format", "handpiece-review"}, {"version", 2}, {"language", words().language()}, {"title", title}};
    Json said = Json::object();
    for (const auto& [id, text] : words().texts())
        if (id.rfind("review.", 0) == 0 && id.rfind("review.event-", 0) != 0) said[id.substr(7)] = text;
    json["words"] = std::move(said);
    json["durationS"] = rounded(s.durationS(), 0.001);
    json["buccalSign"] = s.buccalSign;
    json["notes"] = s.notes;
    json["grid"] = {{"originMm", Json::array({view.originMm[0], view.originMm[1], view.originMm[2]})},
                    {"voxelMm", s.grid->voxelMm()},
                    {"nodes", s.grid->nodes},
                    {"bricks", Json::array({view.bricks[0], view.bricks[1], view.bricks[2]})},
                    {"brickEdge", s.grid->edge},
                    {"stepsAVoxel", kStepsAVoxel}};
    Json tissues = Json::array();
    for (const view::LegendEntry& entry : view::legendOf(s.model->tissues.tissues(), view::Palette::textbook))
        tissues.push_back(
            {{"id", static_cast<int>(entry.tissue)}, {"name", nameOf(entry.tissue)}, {"colour", hexOf(entry.colour)}});
    json["tissues"] = std::move(tissues);
    json["around"] = {{"lowMm", threeOf(s.around.lowMm)}, {"stepMm", Around::kStepMm}, {"parts", Json::array()}};
    for (const AroundPart& part : s.around.parts)
        json["around"]["parts"].push_back({{"name", part.name},
                                           {"colour", hexOf(view::colourOf(part.tissue, view::Palette::textbook))},
                                           {"vertices", part.vertices.size()},
                                           {"triangles", part.triangles.size()}});
    json["burs"] = Json::array();
    for (const auto& [fromS, bur] : s.burs)
        json["burs"].push_back(burOf(fromS, *bur));
    json["strokes"] = s.strokes;
    json["moments"] = s.moments;
    if (against.result != nullptr && against.rubric != nullptr) json["errors"] = errorsOf(against, s.sittings);

    Review review;
    review.pictures = s.pictures;
    const auto pictureBytes = [&] {
        std::size_t all = 0;
        for (const Review::Picture& picture : review.pictures)
            all += picture.png.size();
        return all;
    };
    while (!review.pictures.empty() &&
           static_cast<double>(pictureBytes()) > kPictureShare * static_cast<double>(mostBytes))
        review.pictures = everyOther(std::move(review.pictures));
    mostBytes -= std::min(mostBytes, pictureBytes());

    std::vector<Pose> kept = s.poses;
    std::vector<std::uint8_t> posed = posedOf(kept, *s.model);
    while (kept.size() > 2 &&
           static_cast<double>(compressed({{&posed}}).size()) > kPoseShare * static_cast<double>(mostBytes)) {
        kept = everyOther(std::move(kept));
        posed = posedOf(kept, *s.model);
    }
    std::vector<std::vector<std::uint16_t>> curves(2);
    for (const simulation::PlotPoint& p : s.points) {
        curves[0].push_back(
            static_cast<std::uint16_t>(std::clamp(p.timeS / std::max(s.durationS(), 1e-9), 0.0, 1.0) * 65535.0 + 0.5));
        curves[1].push_back(sixteenBits(static_cast<double>(p.forceN), kForceStepN));
    }

    const std::vector<std::uint8_t> uncut = differencesOf(s.uncut), tissue = stepsOf(s.tissue.values),
                                    curved = planesOf(curves), around = aroundBytes(s.around);
    std::vector<std::uint8_t> ideal;
    if (against.task != nullptr && against.task->preparation) {
        if (cases::caseKey(against.task->toothCase) != s.caseKey)
            throw core::Error("this is work on another tooth than the exercise's", against.task->id,
                              "name the exercise that it was made in");
        ideal = differencesOf(s.idealOf(*against.task));
        Json scale = Json::array();
        constexpr int kColours = 33;
        for (int i = 0; i < kColours; ++i)
            scale.push_back(
                hexOf(view::deviationColour((2.0 * i / (kColours - 1) - 1.0) * kDeviationMostMm, kDeviationMostMm)));
        json["deviation"] = {{"mostMm", kDeviationMostMm}, {"scale", std::move(scale)}, {"whole", s.wholeAsIdeal()}};
    }

    std::vector<ChangedAt> keys = s.keys;
    for (;;) {
        std::vector<std::uint8_t> ids, changes;
        Json times = Json::array(), counts = Json::array();
        for (const ChangedAt& key : keys) {
            times.push_back(rounded(key.timeS, 0.001));
            counts.push_back(key.bricks.size());
            std::uint32_t before = 0;
            for (const std::uint32_t brick : key.bricks) {
                for (int shift = 0; shift < 24; shift += 8)
                    ids.push_back(static_cast<std::uint8_t>((brick - before) >> shift));
                before = brick;
            }
            changes.insert(changes.end(), key.changes.begin(), key.changes.end());
        }
        json["keys"] = {{"timesS", std::move(times)}, {"bricks", std::move(counts)}};
        json["poses"] = kept.size();
        json["curvePoints"] = s.points.size();
        json["sections"] = Json::array();
        const std::array<std::pair<const char*, const std::vector<std::uint8_t>*>, 8> sections{{{"uncut", &uncut},
                                                                                                {"tissue", &tissue},
                                                                                                {"ideal", &ideal},
                                                                                                {"around", &around},
                                                                                                {"poses", &posed},
                                                                                                {"curves", &curved},
                                                                                                {"bricks", &ids},
                                                                                                {"changes", &changes}}};
        std::array<const std::vector<std::uint8_t>*, 8> all{};
        for (std::size_t i = 0; i < sections.size(); ++i) {
            all[i] = sections[i].second;
            json["sections"].push_back({{"name", sections[i].first}, {"bytes", all[i]->size()}});
        }
        review.data = compressed(all);
        if (review.data.size() > mostBytes && keys.size() > 2) {
            std::vector<ChangedAt> fewer;
            for (std::size_t i = 0; i < keys.size(); i += 2)
                fewer.push_back(i + 1 < keys.size() ? joined(keys[i], keys[i + 1], s.perBrick()) : std::move(keys[i]));
            keys = std::move(fewer);
            continue;
        }
        if (review.data.size() > mostBytes) review.data.clear();
        for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace))
            if (c == '<')
                review.json += "\\u003c";
            else
                review.json += c;
        return review;
    }
}

Review reviewOf(std::span<const Reviewed> chain, const std::string& title, const ReviewedAgainst& against,
                bool pictures, std::size_t mostBytes, const core::Progress& progress) {
    ReviewGatherer gatherer(
        pictures ? std::max<std::size_t>(2, kReviewPictures / std::max<std::size_t>(chain.size(), 1)) : 0,
        against.task);
    const auto share = [&](std::size_t i) { return static_cast<double>(i) / static_cast<double>(chain.size()); };
    for (std::size_t i = 0; i < chain.size(); ++i) {
        const Reviewed& one = chain[i];
        const core::Progress part = core::part(progress, share(i), share(i + 1));
        simulation::SessionPlayer player(one.path, {true, pictures, {}}, core::part(part, 0.0, 0.2));
        gatherer.follow(player, one.name, one.untilTick);
        const core::Progress playing = core::part(part, 0.2, 1.0);
        if (!one.untilTick) {
            (void)player.compareAll(playing, {ReviewGatherer::stepS(), [&] { gatherer.look(); }});
        } else {
            // Not a tick farther: the tooth is to be the one that was saved.
            const double endS = static_cast<double>(*one.untilTick) / player.reader().info().rateHz;
            gatherer.look();
            for (double timeS = ReviewGatherer::stepS(); timeS < endS + ReviewGatherer::stepS();
                 timeS += ReviewGatherer::stepS()) {
                player.advance(std::min(timeS, endS));
                gatherer.look();
                core::report(playing, std::min(1.0, timeS / endS));
            }
        }
    }
    if (against.result != nullptr && !against.result->identity.proven)
        gatherer.note(fmt::format("{}: {}", words().text("assessment.not-proven"), said(against.result->proof)));
    return gatherer.review(title, against, mostBytes);
}

}  // namespace handpiece::report
