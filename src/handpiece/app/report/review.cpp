// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/review.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "handpiece/app/report/assessment_report.h"
#include "handpiece/app/report/assessment_words.h"
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
        while (stride < field::kBrickCells && view.voxelMm * stride < kGridMm * 0.99)
            stride *= 2;
        edge = field::kBrickCells / stride;
        for (int k = 0; k < 3; ++k)
            nodes[static_cast<std::size_t>(k)] = view.bricks[k] * edge + 1;
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

Json threeOf(const Vec3& p) {
    return Json::array({rounded(p.x(), 0.001), rounded(p.y(), 0.001), rounded(p.z(), 0.001)});
}

std::string hexOf(const std::array<std::uint8_t, 3>& colour) {
    return fmt::format("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2]);
}

}  // namespace

struct ReviewGatherer::State {
    explicit State(const simulation::SessionPlayer& of)
        : player(of), model(of.station().tooth), grid(model->field.view()) {
        uncut.nodes = tissue.nodes = grid.nodes;
        const std::size_t count = static_cast<std::size_t>(grid.nodes[0]) * static_cast<std::size_t>(grid.nodes[1]) *
                                  static_cast<std::size_t>(grid.nodes[2]);
        uncut.values.resize(count);
        tissue.values.resize(count);
        core::parallelFor(grid.bricks(), 64, [&](std::size_t begin, std::size_t end) {
            std::array<float, field::kBrickValues> values;
            for (std::size_t b = begin; b < end; ++b) {
                const auto dense = static_cast<std::uint32_t>(b);
                model->uncutBrick(dense, values.data());
                const std::uint8_t* tissues = model->field.storage().tissues->of(dense);
                grid.eachNode(dense, [&](int x, int y, int z, std::size_t node) {
                    uncut.values[uncut.index(x, y, z)] = coded(values[node]);
                    tissue.values[tissue.index(x, y, z)] = tissues[node];
                });
            }
        });
        now = uncut;
        isChanged.resize(grid.bricks());
    }

    [[nodiscard]] std::uint8_t coded(float distanceMm) const {
        return eightBits(static_cast<double>(distanceMm) / grid.voxelMm(), kStepsAVoxel);
    }
    [[nodiscard]] std::size_t perBrick() const {
        return static_cast<std::size_t>(grid.edge) * static_cast<std::size_t>(grid.edge) *
               static_cast<std::size_t>(grid.edge);
    }

    void lookAtTooth(double timeS) {
        const tooth::StateDelta state = player.state();
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
            const auto brick = field::brickAt(grid.view.bricks, dense);
            grid.eachNode(dense, [&](int x, int y, int z, std::size_t node) {
                // The grid's last nodes lie outside of the tooth: they never change.
                if (x == (brick[0] + 1) * grid.edge || y == (brick[1] + 1) * grid.edge ||
                    z == (brick[2] + 1) * grid.edge)
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
        const messages::HapticSample& sample = player.sample();
        const std::array<double, 3>& p = sample.proxyPositionMm;
        const std::array<double, 4>& q = sample.proxyOrientation;
        poses.push_back({sample.timeS, Vec3(p[0], p[1], p[2]), q, (sample.flags & messages::kCutting) != 0});
        if (burs.empty() || burs.back().second != player.station().settings.bur)
            burs.emplace_back(sample.timeS, player.station().settings.bur);
        if (looks++ % kPosesAKey == 0 || sample.timeS >= player.durationS()) lookAtTooth(sample.timeS);
    }

    /// What stands for the whole tooth's distances in those to the ideal.
    [[nodiscard]] std::array<std::uint8_t, 256> wholeAsIdeal() const {
        std::array<std::uint8_t, 256> whole{};
        for (int i = 0; i < 256; ++i)
            whole[static_cast<std::size_t>(i)] =
                eightBits((i - kMiddle) / kStepsAVoxel * grid.voxelMm(), kMost / kDeviationMostMm);
        return whole;
    }

    /// How far places lie from the ideal tooth, positive where tissue should be gone: less (modulo 256) what
    /// wholeAsIdeal() says, which is nothing away from all that was cut or is to be.
    [[nodiscard]] Volume idealOf(const tasks::Task& task) const {
        const preparation::Laid laid = preparation::layOn(task.toothCase, *task.preparation);
        const zones::Zones& zones = *laid.zones;
        const Vec3 around = Vec3::Constant(kDeviationMostMm + 2.0 * grid.voxelMm());
        const Vec3 low = zones.box().min - around, high = zones.box().max + around;
        const auto whole = wholeAsIdeal();
        Volume ideal;
        ideal.nodes = grid.nodes;
        ideal.values.resize(uncut.values.size());
        core::parallelFor(grid.bricks(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t b = begin; b < end; ++b) {
                const bool isCut = b < everChanged.size() && everChanged[b];
                grid.eachNode(static_cast<std::uint32_t>(b), [&](int x, int y, int z, std::size_t) {
                    const std::size_t at = uncut.index(x, y, z);
                    const Vec3 p = grid.placeMm(x, y, z);
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

    struct Pose {
        double timeS;
        Vec3 placeMm;
        std::array<double, 4> turn;
        bool isCutting;
    };

    const simulation::SessionPlayer& player;
    std::shared_ptr<const tooth::ToothModel> model;
    PageGrid grid;
    Volume uncut, tissue, now;
    std::vector<bool> isChanged, everChanged;  ///< by dense brick
    std::vector<ChangedAt> keys;
    std::vector<Pose> poses;
    std::vector<std::pair<double, std::shared_ptr<const instrument::Bur>>> burs;
    std::size_t looks = 0;
};

namespace {

Json burOf(double fromS, const instrument::Bur& bur) {
    Json outline = Json::array();
    for (const instrument::SurfaceRing& ring : bur.rings())
        outline.push_back(Json::array({rounded(ring.rhoMm, 0.001), rounded(ring.zMm, 0.001)}));
    return {{"fromS", rounded(fromS, 0.001)}, {"name", bur.name()}, {"outlineMm", std::move(outline)}};
}

/// Events worth a place in the list, each run of the same within a second once.
Json momentsOf(const simulation::SessionPlayer& player) {
    using session::EventName;
    constexpr std::array kShown{
        EventName::burChange,    EventName::firstDentine, EventName::pulpExposure, EventName::neighbourTouched,
        EventName::neighbourCut, EventName::stall,        EventName::forceLimit,   EventName::undo,
        EventName::redo,         EventName::reset,        EventName::gingivaCut,   EventName::headTouched,
        EventName::fault,        EventName::resume};
    Json moments = Json::array();
    std::map<std::string, double> lastS;
    for (const session::Event& event : player.events()) {
        if (std::none_of(kShown.begin(), kShown.end(),
                         [&](EventName name) { return session::nameOf(name) == event.name; }))
            continue;
        const double timeS = static_cast<double>(event.tick) / player.reader().info().rateHz;
        const auto last = lastS.find(event.name);
        const bool isRun = last != lastS.end() && timeS - last->second < 1.0;
        lastS[event.name] = timeS;
        if (isRun) continue;
        std::string id = "review.event-" + event.name;
        std::replace(id.begin(), id.end(), ' ', '-');
        moments.push_back({{"timeS", rounded(timeS, 0.001)}, {"text", words().text(id)}});
    }
    return moments;
}

Json strokesOf(const simulation::SessionPlayer& player) {
    Json strokes = Json::array();
    for (const session::Event& event : player.events()) {
        const double timeS = rounded(static_cast<double>(event.tick) / player.reader().info().rateHz, 0.001);
        if (event.name == session::nameOf(session::EventName::strokeBegin))
            strokes.push_back(Json::array({timeS, rounded(player.durationS(), 0.001)}));
        else if (event.name == session::nameOf(session::EventName::strokeEnd) && !strokes.empty())
            strokes.back()[1] = timeS;
    }
    return strokes;
}

Json errorsOf(const ReviewedAgainst& against) {
    Json errors = Json::array();
    const score::Assessment& a = against.result->assessment;
    for (const std::size_t i : costliest(a)) {
        const score::CriterionScore& c = a.criteria[i];
        Json error{{"title", criterionTitle(*against.rubric, c.id)},
                   {"lost", c.critical == score::Verdict::yes
                                ? words()("rubric.critical")
                                : words()("assessment.points-lost",
                                          fmt::format("{:.1f}", c.maxPoints - c.points.value_or(0.0)))},
                   {"measured", c.value ? valueOf(c) : said(c.reason)},
                   {"practise", drillFor(c.measure)}};
        for (const measures::Evidence& e : c.evidence) {
            if (e.placeMm && !error.contains("placeMm")) error["placeMm"] = threeOf(*e.placeMm);
            if (e.timeS && e.session == against.session && !error.contains("timeS"))
                error["timeS"] = rounded(*e.timeS, 0.001);
        }
        errors.push_back(std::move(error));
    }
    return errors;
}

}  // namespace

ReviewGatherer::ReviewGatherer(const simulation::SessionPlayer& player) : state_(std::make_unique<State>(player)) {}
ReviewGatherer::~ReviewGatherer() = default;

void ReviewGatherer::look() {
    state_->look();
}

double ReviewGatherer::stepS() {
    return kPoseStepS;
}

Review ReviewGatherer::review(const std::string& title, const ReviewedAgainst& against, std::size_t mostBytes) const {
    const State& s = *state_;
    const simulation::SessionPlayer& player = s.player;
    const field::FieldView& view = s.grid.view;

    Json json{{"format", "handpiece-review"}, {"version", 1}, {"language", words().language()}, {"title", title}};
    Json said = Json::object();
    for (const auto& [id, text] : words().texts())
        if (id.rfind("review.", 0) == 0 && id.rfind("review.event-", 0) != 0) said[id.substr(7)] = text;
    json["words"] = std::move(said);
    json["durationS"] = rounded(player.durationS(), 0.001);
    json["buccalSign"] = player.toothCase().buccalSign < 0 ? -1 : 1;
    json["grid"] = {{"originMm", Json::array({view.originMm[0], view.originMm[1], view.originMm[2]})},
                    {"voxelMm", s.grid.voxelMm()},
                    {"nodes", s.grid.nodes},
                    {"bricks", Json::array({view.bricks[0], view.bricks[1], view.bricks[2]})},
                    {"brickEdge", s.grid.edge},
                    {"stepsAVoxel", kStepsAVoxel}};
    Json tissues = Json::array();
    for (const view::LegendEntry& entry : view::legendOf(s.model->tissues.tissues(), view::Palette::textbook))
        tissues.push_back(
            {{"id", static_cast<int>(entry.tissue)}, {"name", nameOf(entry.tissue)}, {"colour", hexOf(entry.colour)}});
    json["tissues"] = std::move(tissues);
    json["burs"] = Json::array();
    for (const auto& [fromS, bur] : s.burs)
        json["burs"].push_back(burOf(fromS, *bur));
    json["strokes"] = strokesOf(player);
    json["moments"] = momentsOf(player);
    if (against.result != nullptr && against.rubric != nullptr) json["errors"] = errorsOf(against);

    std::vector<double> tipMm(s.poses.size());
    core::parallelFor(s.poses.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            tipMm[i] = -s.model->tree.signedDistance(s.poses[i].placeMm);
    });
    std::vector<std::vector<std::uint16_t>> poses(9);
    for (std::size_t i = 0; i < s.poses.size(); ++i) {
        const State::Pose& p = s.poses[i];
        poses[0].push_back(static_cast<std::uint16_t>(std::min<std::size_t>(
            static_cast<std::size_t>((p.timeS - (i > 0 ? s.poses[i - 1].timeS : 0.0)) * 1000.0 + 0.5), 65535)));
        for (std::size_t k = 0; k < 3; ++k)
            poses[1 + k].push_back(sixteenBits(p.placeMm[static_cast<Eigen::Index>(k)], kPlaceStepMm));
        for (std::size_t k = 0; k < 4; ++k)
            poses[4 + k].push_back(sixteenBits(p.turn[k], kTurnStep));
        poses[8].push_back(sixteenBits(std::max(tipMm[i], -1.0), kDepthStepMm));
    }
    const std::vector<simulation::PlotPoint> points =
        player.plot(std::max(simulation::kPlotStepS, player.durationS() / static_cast<double>(kMostPoints)));
    std::vector<std::vector<std::uint16_t>> curves(2);
    for (const simulation::PlotPoint& p : points) {
        curves[0].push_back(static_cast<std::uint16_t>(
            std::clamp(p.timeS / std::max(player.durationS(), 1e-9), 0.0, 1.0) * 65535.0 + 0.5));
        curves[1].push_back(sixteenBits(static_cast<double>(p.forceN), kForceStepN));
    }

    const std::vector<std::uint8_t> uncut = differencesOf(s.uncut), tissue = stepsOf(s.tissue.values),
                                    posed = planesOf(poses), curved = planesOf(curves);
    std::vector<std::uint8_t> ideal;
    if (against.task != nullptr && against.task->preparation) {
        if (cases::caseKey(against.task->toothCase) != cases::caseKey(player.toothCase()))
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
        json["poses"] = s.poses.size();
        json["curvePoints"] = points.size();
        json["sections"] = Json::array();
        const std::array<std::pair<const char*, const std::vector<std::uint8_t>*>, 7> sections{{{"uncut", &uncut},
                                                                                                {"tissue", &tissue},
                                                                                                {"ideal", &ideal},
                                                                                                {"poses", &posed},
                                                                                                {"curves", &curved},
                                                                                                {"bricks", &ids},
                                                                                                {"changes", &changes}}};
        std::array<const std::vector<std::uint8_t>*, 7> all{};
        for (std::size_t i = 0; i < sections.size(); ++i) {
            all[i] = sections[i].second;
            json["sections"].push_back({{"name", sections[i].first}, {"bytes", all[i]->size()}});
        }
        Review review;
        review.data = compressed(all);
        if (review.data.size() > mostBytes && keys.size() > 2) {
            std::vector<ChangedAt> fewer;
            for (std::size_t i = 0; i < keys.size(); i += 2)
                fewer.push_back(i + 1 < keys.size() ? joined(keys[i], keys[i + 1], s.perBrick()) : std::move(keys[i]));
            keys = std::move(fewer);
            continue;
        }
        for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace))
            if (c == '<')
                review.json += "\\u003c";
            else
                review.json += c;
        return review;
    }
}

Review reviewOf(simulation::SessionPlayer& player, const std::string& title, const ReviewedAgainst& against,
                const core::Progress& progress, std::size_t mostBytes) {
    ReviewGatherer gatherer(player);
    (void)player.compareAll(progress, {ReviewGatherer::stepS(), [&gatherer] { gatherer.look(); }});
    return gatherer.review(title, against, mostBytes);
}

}  // namespace handpiece::report
