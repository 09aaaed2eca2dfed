// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/hand/hand.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "handpiece/assess/hand/impulse.h"
#include "handpiece/assess/hand/smoothness.h"
#include "handpiece/assess/hand/standing_impulse.h"
#include "handpiece/assess/hand/tip_path.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::hand {
namespace {

using cases::Tissue;
using measures::Evidence;
using measures::Measured;
using measures::Request;

constexpr double kDegrees = 57.295779513082321;
/// A loop above 2 kHz cuts at some ticks only: a cut holds for so long after the last [s].
constexpr double kCutHoldsS = 0.005;
/// A bur that comes free for less is still stalled [s].
constexpr double kStallGapS = 0.1;
/// The path is what a ruler of so much measures of it, and another, which tells how sure that is [mm].
constexpr double kRulerMm = 0.2, kCheckRulerMm = 0.4;
/// Places are means over so long; smoothness: the speed's samples, the longest piece of a stroke and the shortest that
/// has a spectrum [s].
constexpr double kPlaceS = 0.02, kSpeedS = 0.01, kPieceS = 10.0, kShortestPieceS = 1.0;
/// Less of a stroke than this is a pedal that was touched [mm].
constexpr double kStandingMm = 0.1;
/// A direction counts from so much work on [s].
constexpr double kViewS = 1.0;
/// Steps in which a session keeps forces [N] and speeds [rpm]; tilts are counted in [deg].
constexpr double kForceStepN = 1.0 / 1024.0, kSpeedStepRpm = 4.0, kTiltStepDeg = 0.01;
constexpr double kMostForceN = 100.0, kMostSpeedRpm = 1e6, kMostTiltDeg = 180.0;
/// Half of the diagonal of a force's steps, and half a bin.
constexpr double kForceErrorN = 0.0014;
/// Held against closed forms and an encoder's noise (hand_test).
constexpr double kSmoothnessError = 0.03;
/// Of one measure.
constexpr std::size_t kMostTold = 20;
constexpr const char* kStanding = "impulse-not-undone";
/// Of StandingImpulse: all that must be kept.
constexpr int kOnProtected = -1;
constexpr const char *kNoSamples = "there are no samples", *kNoCut = "nothing was cut",
                     *kNoWay = "the record does not tell how one worked";

/// Values weighted by time, in bins.
class Spread {
  public:
    Spread(double step, double most) : step_(step), most_(most) {}

    void add(double value, double weight) {
        if (!(weight > 0.0) || !(value >= 0.0)) return;
        value = std::min(value, most_);
        const auto bin = static_cast<std::size_t>(value / step_);
        if (bin >= weight_.size()) weight_.resize(bin + 1, 0.0);
        weight_[bin] += weight;
        total_ += weight;
        sum_ += weight * value;
        least_ = total_ == weight ? value : std::min(least_, value);
        greatest_ = std::max(greatest_, value);
    }
    [[nodiscard]] double total() const { return total_; }
    [[nodiscard]] double statistic(std::string_view name) const {
        if (name == "mean") return sum_ / total_;
        if (name == "least") return least_;
        if (name == "greatest") return greatest_;
        return quantile(name == "p5" ? 0.05 : name == "p95" ? 0.95 : 0.5);
    }
    /// Of the values so near.
    [[nodiscard]] double weightAround(double value, double by) const {
        double weight = 0.0;
        const auto bin = [&](double v) { return static_cast<std::size_t>(std::max(0.0, v) / step_); };
        for (std::size_t i = bin(value - by); i <= bin(value + by) && i < weight_.size(); ++i)
            weight += weight_[i];
        return weight;
    }

  private:
    [[nodiscard]] double quantile(double share) const {
        double below = 0.0;
        for (std::size_t i = 0; i < weight_.size(); ++i) {
            if (weight_[i] > 0.0 && below + weight_[i] >= share * total_) {
                const double within = (share * total_ - below) / weight_[i];
                return std::clamp((static_cast<double>(i) + within) * step_, least_, greatest_);
            }
            below += weight_[i];
        }
        return greatest_;
    }

    double step_, most_;
    std::vector<double> weight_;
    double total_ = 0.0, sum_ = 0.0, least_ = 0.0, greatest_ = 0.0;
};

/// Time with more load than a limit.
struct OverLimit {
    double overS = 0.0;
    std::uint64_t times = 0;
    bool isOver = false;
    std::optional<Evidence> first;
    Moment worst;
};

/// Lays a ruler along a way: what stays within its length of where it lies is noise.
class Ruler {
  public:
    explicit Ruler(double mm) : mm_(mm) {}
    void take(const core::Vec3& place) {
        if (!from_) from_ = place;
        const double way = (place - *from_).norm();
        if (way < mm_) return;
        lengthMm_ += way;
        from_ = place;
    }
    void lift() { from_.reset(); }
    [[nodiscard]] double lengthMm() const { return lengthMm_; }

  private:
    double mm_, lengthMm_ = 0.0;
    std::optional<core::Vec3> from_;
};

/// A ball of the bur, in its frame.
struct Ball {
    core::Vec3 centre;
    double radiusMm;
};

std::vector<Ball> ballsOf(const instrument::Bur& bur) {
    constexpr std::size_t kRound = 12, kMostOfCurve = 24;
    static const std::array<std::pair<double, double>, kRound> kTurns = [] {
        std::array<std::pair<double, double>, kRound> turns;
        for (std::size_t i = 0; i < kRound; ++i)
            turns[i] = {core::cos(6.283185307179586 * static_cast<double>(i) / kRound),
                        core::sin(6.283185307179586 * static_cast<double>(i) / kRound)};
        return turns;
    }();
    std::vector<Ball> balls;
    for (const instrument::MedialCurve& curve : bur.medialAxis()) {
        const std::size_t step = curve.balls.size() / kMostOfCurve + 1;
        for (std::size_t i = 0;; i = std::min(i + step, curve.balls.size() - 1)) {
            const instrument::MedialBall& ball = curve.balls[i];
            if (ball.rhoMm <= 0.0)
                balls.push_back({core::Vec3(0, 0, ball.zMm), ball.radiusMm});
            else
                for (const auto& [c, s] : kTurns)
                    balls.push_back({core::Vec3(ball.rhoMm * c, ball.rhoMm * s, ball.zMm), ball.radiusMm});
            if (i + 1 == curve.balls.size()) break;
        }
    }
    return balls;
}

/// Whether a bur reaches into the protected zone; asks the zone only where it may have come near since.
class ProtectedReach {
  public:
    void take(const instrument::Bur& bur) {
        balls_ = ballsOf(bur);
        lengthMm_ = bur.lengthMm();
        known_.reset();
    }
    [[nodiscard]] bool reaches(const zones::Zones& zones, const core::Pose& burInTooth) {
        if (balls_.empty()) return false;
        const core::Vec3 axis = burInTooth.orientation * core::Vec3::UnitZ();
        if (known_) {
            const double moved =
                (burInTooth.positionMm - known_->tip).norm() + lengthMm_ * (axis - known_->axis).norm();
            if (moved < known_->clearMm) return false;
        }
        double clear = zones::kFarMm;
        for (const Ball& ball : balls_)
            clear = std::min(clear, zones.protectedMm(burInTooth.apply(ball.centre)) - ball.radiusMm);
        known_ = {burInTooth.positionMm, axis, clear};
        return clear < 0.0;
    }

  private:
    struct Known {
        core::Vec3 tip, axis;
        double clearMm;
    };
    std::vector<Ball> balls_;
    double lengthMm_ = 0.0;
    std::optional<Known> known_;
};

double number(double value) {
    return std::isfinite(value) ? value : 0.0;
}

}  // namespace

struct HandMeasures::State {
    State(std::span<const Request> asked, const Against& with)
        : requests(asked.begin(), asked.end()), against(with), overLimit(requests.size()) {
        for (const Request& request : requests)
            asksWhatStands = asksWhatStands || request.kind == kStanding;
    }

    const std::vector<Request> requests;
    const Against against;
    std::size_t session = 0;
    std::uint64_t samples = 0;
    double totalS = 0.0, idleS = 0.0, drillS = 0.0, contactS = 0.0, periodS = 0.0;
    std::uint64_t idles = 0, drills = 0, strokes = 0, steps = 0, burChanges = 0, stalls = 0;
    std::optional<bool> wasIdle;
    bool wasDown = false, wasDrilling = false;
    std::optional<double> lastCutS, lastStallS;
    std::vector<Evidence> stallAt, changeAt, stepAt;
    Spread force{kForceStepN, kMostForceN}, contactForce{kForceStepN, kMostForceN}, speed{kSpeedStepRpm, kMostSpeedRpm},
        tilt{kTiltStepDeg, kMostTiltDeg};
    Moment mostForce, leastSpeed, mostTilt;
    std::vector<OverLimit> overLimit;  ///< by request
    std::array<Impulse, cases::kTissueCount> onTissue{};
    Impulse onProtected;
    bool asksWhatStands = false, hasRemoved = false;  ///< the last: in the stroke under way
    StandingImpulse standing;
    std::string bur;
    ProtectedReach reach;
    std::optional<Way> way;
    double byMirrorS = 0.0, fingerRestS = 0.0, depthStopS = 0.0, depthStopKnownS = 0.0, wayKnownS = 0.0;
    std::map<int, double> atHourS;
    Ruler path{kRulerMm}, pathCheck{kCheckRulerMm};
    TipPath places{kPlaceS, [this](const core::Vec3& p, std::int64_t) { path.take(p); }};
    TipPath checkPlaces{2.0 * kPlaceS, [this](const core::Vec3& p, std::int64_t) { pathCheck.take(p); }};
    TipPath fine{kSpeedS, [this](const core::Vec3& p, std::int64_t stretch) { takePlace(p, stretch); }};
    // Of the piece of a stroke under way: the tip's speed [mm/s], from its first place on.
    std::vector<double> piece;
    std::optional<core::Vec3> lastPlace;
    std::int64_t lastStretch = 0;
    Evidence pieceAt;
    double pieceMm = 0.0, smoothSum = 0.0, smoothS = 0.0;
    std::size_t pieces = 0;
    Moment roughest;

    [[nodiscard]] Evidence here(const Sample& s) const {
        return {s.timeS, s.burInTooth.positionMm, s.forceN, {}, session};
    }

    void tell(std::vector<Evidence>& all, double atS, std::string text) const {
        if (all.size() >= kMostTold) return;
        all.push_back({atS, {}, {}, std::move(text), session});
    }

    void takePlace(const core::Vec3& place, std::int64_t stretch) {
        const double timeS = static_cast<double>(stretch) * kSpeedS;
        // A machine that stood for long leaves a hole, which ends the movement.
        if (lastPlace && stretch != lastStretch + 1) endPiece();
        if (lastPlace) {
            const double mm = (place - *lastPlace).norm();
            if (piece.empty()) pieceAt = {timeS, *lastPlace, {}, {}, session};
            piece.push_back(mm / kSpeedS);
            pieceMm += mm;
        }
        lastPlace = place;
        lastStretch = stretch;
        if (static_cast<double>(piece.size()) * kSpeedS >= kPieceS - 0.5 * kSpeedS) endPiece();
    }
    void endPiece() {
        const double lasts = static_cast<double>(piece.size()) * kSpeedS;
        if (lasts >= kShortestPieceS && pieceMm >= kStandingMm)
            if (const auto smooth = spectralArcLength(piece, 1.0 / kSpeedS)) {
                smoothSum += *smooth * lasts;
                smoothS += lasts;
                ++pieces;
                roughest.take(-*smooth, pieceAt);
            }
        piece.clear();
        pieceMm = 0.0;
        lastPlace.reset();
    }
    void endMovement() {
        fine.end();
        endPiece();
    }
    void pause() {
        endMovement();
        places.end();
        checkPlaces.end();
        path.lift();
        pathCheck.lift();
        wasDown = wasDrilling = false;
        wasIdle.reset();
        lastCutS.reset();
        lastStallS.reset();
        for (OverLimit& over : overLimit)
            over.isOver = false;
    }

    void press(Tissue tissue, const Sample& s) {
        onTissue[static_cast<std::size_t>(tissue)].take(number(s.forceN), s.lastsS, here(s));
        if (asksWhatStands) standing.take(static_cast<int>(tissue), number(s.forceN), s.lastsS, here(s));
    }

    void take(const Sample& s);
    void takeForces(const Sample& s);
    void takeWork(const Sample& s);
    [[nodiscard]] Measured measured(std::size_t request);
    [[nodiscard]] Measured protectedImpulse(Measured m) const;
};

void HandMeasures::State::take(const Sample& s) {
    ++samples;
    const double lasts = s.lastsS;
    totalS += lasts;
    periodS = std::max(periodS, lasts);
    if (s.isPedalDown && !wasDown) ++strokes;
    if (wasDown && !s.isPedalDown) endMovement();
    hasRemoved = hasRemoved || s.hasRemoved;
    wasDown = s.isPedalDown;
    const core::Vec3& tip = s.burInTooth.positionMm;
    if (s.burInTooth.isValid()) {
        places.take(s.timeS, tip);
        checkPlaces.take(s.timeS, tip);
        if (s.isPedalDown) fine.take(s.timeS, tip);
    }
    const bool isIdle = !s.isPedalDown && !(s.depthMm > 0.0);
    if (isIdle) idleS += lasts;
    if (!wasIdle || *wasIdle != isIdle) ++idles;
    wasIdle = isIdle;
    if (s.isStalled && s.depthMm > 0.0) {
        if (!lastStallS || s.timeS - *lastStallS > kStallGapS) {
            ++stalls;
            if (stallAt.size() < kMostTold) stallAt.push_back(here(s));
            if (!stallAt.empty()) stallAt.back().text = "stalled";
        }
        lastStallS = s.timeS;
    }
    if (s.isCutting) lastCutS = s.timeS;
    const bool isDrilling = lastCutS && s.timeS - *lastCutS <= kCutHoldsS;
    if (isDrilling && !wasDrilling) ++drills;
    wasDrilling = isDrilling;
    if (isDrilling) takeWork(s);
    if (s.depthMm > 0.0 || s.pressesGingiva) takeForces(s);
    if (!(s.depthMm > 0.0))
        for (OverLimit& over : overLimit)
            over.isOver = false;
}

void HandMeasures::State::takeWork(const Sample& s) {
    const double lasts = s.lastsS;
    drillS += lasts;
    force.add(number(s.forceN), lasts);
    mostForce.take(number(s.forceN), here(s));
    speed.add(number(s.speedRpm), lasts);
    leastSpeed.take(-number(s.speedRpm), here(s));
    if (s.burInTooth.isValid()) {
        const core::Vec3 axis = s.burInTooth.orientation * core::Vec3::UnitZ();
        const double degrees = kDegrees * core::acos(std::clamp(axis.dot(against.longAxis), -1.0, 1.0));
        tilt.add(degrees, lasts);
        mostTilt.take(degrees, here(s));
    }
    if (!way) return;
    wayKnownS += lasts;
    if (way->mirrorOnly) byMirrorS += lasts;
    if (way->fingerRest) fingerRestS += lasts;
    if (way->hour > 0) atHourS[way->hour] += lasts;
    if (way->depthStop) {
        depthStopKnownS += lasts;
        if (*way->depthStop) depthStopS += lasts;
    }
}

void HandMeasures::State::takeForces(const Sample& s) {
    const double load = number(s.forceN), lasts = s.lastsS;
    if (s.pressesGingiva) press(Tissue::gum, s);
    if (!(s.depthMm > 0.0)) return;
    contactS += lasts;
    contactForce.add(load, lasts);
    for (std::size_t i = 0; i < requests.size(); ++i) {
        if (!requests[i].of.limit) continue;
        OverLimit& over = overLimit[i];
        const bool isOver = load > *requests[i].of.limit;
        if (isOver) {
            over.overS += lasts;
            if (!over.isOver) ++over.times;
            if (!over.first) over.first = here(s);
            over.worst.take(load, here(s));
        }
        over.isOver = isOver;
    }
    // A tooth beside may be a part of the case's one surface, or a tooth of its own.
    const bool isBeside = s.tooth > 0 || s.tissue == Tissue::neighbour;
    const Tissue on = isBeside ? Tissue::neighbour : s.tissue;
    if (on != Tissue::gum || !s.pressesGingiva) press(on, s);
    const bool isKept =
        isBeside || on == Tissue::pulp ||
        (against.zones != nullptr && s.burInTooth.isValid() && reach.reaches(*against.zones, s.burInTooth));
    if (!isKept) return;
    onProtected.take(load, lasts, here(s));
    if (asksWhatStands) standing.take(kOnProtected, load, lasts, here(s));
}

Measured HandMeasures::State::protectedImpulse(Measured m) const {
    const auto index =
        m.of.tissue.empty() ? std::size_t{0} : static_cast<std::size_t>(cases::tissueByName(m.of.tissue));
    const Impulse on = m.kind == kStanding   ? standing.on(m.of.tissue.empty() ? kOnProtected : static_cast<int>(index))
                       : m.of.tissue.empty() ? onProtected
                                             : onTissue[index];
    m.value = on.newtonSeconds;
    m.uncertainty = kForceErrorN * on.lastsS;
    if (on.first) {
        m.evidence.push_back(*on.first);
        m.evidence.back().text = "first";
        m.evidence.push_back(on.worst.at);
        m.evidence.back().text = "most load";
    }
    return m;
}

Measured HandMeasures::State::measured(std::size_t index) {
    const Request& request = requests[index];
    const std::string& kind = request.kind;
    Measured m{kind, request.of, {}, 0.0, {}, {}};
    const auto none = [&m](std::string reason) {
        m.reason = std::move(reason);
        return m;
    };
    const auto is = [&m](double value, double uncertainty, std::vector<Evidence> evidence = {}) {
        m.value = value;
        m.uncertainty = std::min(uncertainty, std::abs(value));
        m.evidence = std::move(evidence);
        return m;
    };
    if (samples == 0) return none(kNoSamples);
    const bool hasWork = drillS > 0.0;
    const std::string statistic = request.of.statistic.empty() ? std::string("median") : request.of.statistic;

    if (kind == "time") return is(totalS, periodS);
    if (kind == "drill-time") return is(drillS, kCutHoldsS * static_cast<double>(drills));
    if (kind == "idle-time") return is(idleS, periodS * static_cast<double>(idles));
    if (kind == "strokes") return is(static_cast<double>(strokes), 0.0);
    if (kind == "stalls") return is(static_cast<double>(stalls), 0.0, stallAt);
    if (kind == "bur-changes") return is(static_cast<double>(burChanges), 0.0, changeAt);
    if (kind == "undos") return is(static_cast<double>(steps), 0.0, stepAt);
    if (kind == "path-length") {
        // Of a curve the error goes with the square of ruler and time: it is a third of the difference. At both ends
        // less than a ruler is lost.
        m = is(path.lengthMm(), 0.0);
        m.uncertainty = kCheckRulerMm + std::abs(path.lengthMm() - pathCheck.lengthMm());
        return m;
    }
    if (kind == "smoothness") {
        if (pieces == 0) return none(fmt::format("no stroke moved for {:g} s", kShortestPieceS));
        m = is(smoothSum / smoothS, 0.0, roughest.told("least smooth stroke"));
        m.uncertainty = kSmoothnessError;
        return m;
    }
    if (kind == "impulse-on-protected" || kind == kStanding) return protectedImpulse(std::move(m));
    if (kind == "load-over-limit" || kind == "load-over-limit-share") {
        if (!request.of.limit) return none("it needs a limit");
        if (!(contactS > 0.0)) return none("the bur touched nothing");
        const OverLimit& over = overLimit[index];
        const double unsure =
            contactForce.weightAround(*request.of.limit, kForceErrorN) + periodS * static_cast<double>(over.times);
        if (over.first) {
            m.evidence = {*over.first, over.worst.at};
            m.evidence[0].text = "first over the limit";
            m.evidence[1].text = "most load";
        }
        const bool isShare = kind == "load-over-limit-share";
        m.value = isShare ? std::min(100.0, 100.0 * over.overS / contactS) : over.overS;
        m.uncertainty = isShare ? 100.0 * unsure / contactS : unsure;
        return m;
    }
    if (!hasWork) return none(kNoCut);
    if (kind == "force") return is(force.statistic(statistic), kForceErrorN, mostForce.told("most load"));
    if (kind == "speed-under-load") return is(speed.statistic(statistic), kSpeedStepRpm, leastSpeed.told("slowest"));
    if (kind == "tilt") {
        if (!(tilt.total() > 0.0)) return none("no pose was told");
        m = is(tilt.statistic(statistic), 0.0, mostTilt.told("most tilted"));
        m.uncertainty = kTiltStepDeg;
        return m;
    }
    if (kind == "depth-stop-share") {
        if (!(depthStopKnownS > 0.0)) return none("the record does not tell of a depth stop");
        return is(std::min(100.0, 100.0 * depthStopS / depthStopKnownS), 100.0 * kCutHoldsS / depthStopKnownS);
    }
    if (!(wayKnownS > 0.0)) return none(kNoWay);
    if (kind == "mirror-share")
        return is(std::min(100.0, 100.0 * byMirrorS / wayKnownS), 100.0 * kCutHoldsS / wayKnownS);
    if (kind == "finger-rest-share")
        return is(std::min(100.0, 100.0 * fingerRestS / wayKnownS), 100.0 * kCutHoldsS / wayKnownS);
    if (kind == "views") {
        if (atHourS.empty()) return none("no position at the clock was chosen");
        const auto views =
            std::count_if(atHourS.begin(), atHourS.end(), [](const auto& at) { return at.second >= kViewS; });
        if (views == 0) return none(fmt::format("nothing was cut for {:g} s from any position", kViewS));
        return is(static_cast<double>(views), 0.0);
    }
    return none("not taken by this version");
}

HandMeasures::HandMeasures(std::span<const Request> requests, const Against& against) {
    for (const Request& request : requests)
        if (measures::requireKind(request).subject != measures::Subject::hand)
            throw core::Error("this measure is of the tooth", request.kind, "take it of a preparation");
    state_ = std::make_unique<State>(requests, against);
}
HandMeasures::~HandMeasures() = default;

void HandMeasures::goOn(std::size_t session) {
    state_->pause();
    state_->session = session;
}

void HandMeasures::takeBur(double atS, const std::string& name, const instrument::Bur* bur) {
    State& s = *state_;
    if (!s.bur.empty() && s.bur != name) {
        ++s.burChanges;
        s.tell(s.changeAt, atS, name);
    }
    s.bur = name;
    if (bur != nullptr) s.reach.take(*bur);
}

void HandMeasures::takeWay(const Way& way) {
    state_->way = way;
}

void HandMeasures::takeStep(double atS, Step step) {
    State& s = *state_;
    ++s.steps;
    s.tell(s.stepAt, atS, "taken back or done again");
    switch (step) {
        case Step::undo:
            return s.standing.undo();
        case Step::redo:
            return s.standing.redo();
        case Step::reset:
            return s.standing.reset();
    }
}

void HandMeasures::endStroke() {
    state_->standing.endStroke(std::exchange(state_->hasRemoved, false));
}

void HandMeasures::take(const Sample& sample) {
    state_->take(sample);
}

std::vector<Measured> HandMeasures::measured() {
    State& s = *state_;
    s.pause();
    std::vector<Measured> all;
    for (std::size_t i = 0; i < s.requests.size(); ++i)
        all.push_back(s.measured(i));
    return all;
}

}  // namespace handpiece::hand
