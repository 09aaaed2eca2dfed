// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/mouth_method.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/tick/contact/bur_frame.h"

namespace handpiece::contact {
namespace {

using core::Pose;
using core::Vec3;

/// What was looked at stays near until the instrument has moved so far.
constexpr double kNearSlackMm = 1.0;
constexpr double kFarthestToothMm = 200.0;

bool isSame(const Pose& a, const Pose& b) noexcept {
    return a.positionMm == b.positionMm && a.orientation.coeffs() == b.orientation.coeffs();
}

/// A pair, with what is known of it between calls.
struct Pair : PlacedMethod {
    explicit Pair(PlacedMethod placed)
        : PlacedMethod(std::move(placed)),
          sceneInTooth(toothInScene.inverse()),
          moves(!pieceInBur.isIdentity()),
          turns(!toothInScene.isIdentity()) {}

    /// The piece in the tooth's frame and no more than the distance between the two, for the pose that all ask about in
    /// turn. Where nothing is moved nothing is rounded.
    struct Place {
        Pose local;
        double gapMm = 0.0;
    };
    [[nodiscard]] const Place& at(const Pose& bur) const noexcept {
        if (!isPlaced_ || !isSame(bur, placedFor_)) {
            const Pose own = moves ? bur * pieceInBur : bur;
            place_.local = turns ? sceneInTooth * own : own;
            place_.gapMm = gapOf(place_.local);
            placedFor_ = bur;
            isPlaced_ = true;
        }
        return place_;
    }
    [[nodiscard]] Vec3 direction(const Vec3& inTooth) const noexcept {
        return turns ? Vec3(toothInScene.orientation * inTooth) : inTooth;
    }
    [[nodiscard]] Vec3 place(const Vec3& inTooth) const noexcept {
        return turns ? toothInScene.apply(inTooth) : inTooth;
    }
    /// No less than the distance by what was last answered: no point of the piece has moved farther since. Where the
    /// answer came from a field that has been cut it is none too sure.
    [[nodiscard]] double clearMm(const Pose& local) const noexcept {
        if (!wasAsked || answer.slackMm > 0.0 || method->toothVersion() != askedVersion) return 0.0;
        const double armMm = core::hypot(solid->lengthMm(), solid->maxRadiusMm());
        return -answer.depthMm - core::mostMovedMm(askedAt, local, armMm);
    }
    [[nodiscard]] bool isBur() const noexcept { return piece == Piece::bur; }
    [[nodiscard]] bool cuts() const noexcept { return isBur() && isCuttable; }
    [[nodiscard]] bool hasPoints() const noexcept { return isBur() && !isPlain; }

    Pose sceneInTooth;
    bool moves, turns;
    Pose askedAt;  // many ask for depth at one pose
    double askedFloorMm = 0.0;
    std::uint64_t askedVersion = 0;
    bool wasAsked = false;
    Depth answer;  // Method::depthBeyond(askedFloorMm)

  private:
    [[nodiscard]] double gapOf(const Pose& local) const noexcept {
        const core::Box box = BurFrame(local).boxAround(solid->lengthMm(), solid->maxRadiusMm(), 0.0);
        const Vec3 apart = (box.min - toothBoxMm.max).cwiseMax(toothBoxMm.min - box.max).cwiseMax(0.0);
        return apart.norm();
    }
    mutable Place place_;
    mutable Pose placedFor_;
    mutable bool isPlaced_ = false;
};

class MouthMethod final : public Method {
  public:
    MouthMethod(std::vector<PlacedMethod> placed, double reachMm) : reachMm_(reachMm) {
        pairs_.reserve(placed.size());
        soft_.reserve(placed.size());
        for (PlacedMethod& p : placed) {
            if (!p.method || !p.solid || !p.pieceInBur.isValid() || !p.toothInScene.isValid() ||
                p.toothInScene.positionMm.norm() > kFarthestToothMm)
                throw core::Error("a tooth of the mouth stands nowhere", "contact",
                                  "give it a rigid pose near the others");
            Pair& pair = p.isYielding ? soft_.emplace_back(std::move(p)) : pairs_.emplace_back(std::move(p));
            if (!pair.isYielding && pair.cuts()) cutting_.push_back(static_cast<std::uint16_t>(pairs_.size() - 1));
            farthestMm_ = std::max(farthestMm_, pair.pieceInBur.positionMm.norm() +
                                                    core::hypot(pair.solid->lengthMm(), pair.solid->maxRadiusMm()));
        }
    }

    [[nodiscard]] const char* name() const noexcept override { return "mouth"; }

    [[nodiscard]] Depth depth(const Pose& bur) noexcept override { return deepest(bur, nullptr); }
    [[nodiscard]] Depth depthUpTo(double enoughMm, const Pose& bur) noexcept override {
        return deepest(bur, &enoughMm);
    }

    void patches(const Pose& bur, PatchSet& out) noexcept override {
        out = PatchSet{};
        if (!bur.isValid()) {
            out.status = Status::invalidPose;
            return;
        }
        lookAround(bur);
        std::array<Pair*, kMaxSets> touched;
        std::size_t count = 0;
        for (std::size_t n = 0; n < nearCount_; ++n) {
            Pair& pair = pairs_[near_[n]];
            if (!pair.hasPoints() || pair.at(bur).gapMm > kContactMarginMm) continue;
            if (count == kMaxSets) out.status = Status::truncated;
            if (count < kMaxSets) touched[count++] = &pair;
        }
        if (count == 1) {
            touched[0]->method->patches(touched[0]->at(bur).local, out);
            for (Patch& p : out.patches)
                p = inScene(*touched[0], p);
            return;
        }
        merged_.clear();
        for (std::size_t n = 0; n < count; ++n) {
            Pair& pair = *touched[n];
            pair.method->patches(pair.at(bur).local, scratchPatches_);
            const PatchSet& own = scratchPatches_;
            if (out.status == Status::ok) out.status = own.status;
            out.areaMm2 += own.areaMm2;
            out.pressureMm3 += own.pressureMm3;
            for (std::size_t t = 0; t < cases::kTissueCount; ++t)
                out.tissueShare[t] += own.pressureMm3 * own.tissueShare[t];
            for (const Patch& p : own.patches) {
                merged_.pushBack(inScene(pair, p));
                merged_[merged_.size() - 1].pressureShare *= own.pressureMm3;
            }
        }
        if (!(out.pressureMm3 > 0.0)) return;
        for (double& share : out.tissueShare)
            share /= out.pressureMm3;
        // Of equals the tooth with the lower number comes first.
        std::sort(merged_.begin(), merged_.end(), [](const Patch& a, const Patch& b) {
            return a.pressureShare != b.pressureShare ? a.pressureShare > b.pressureShare : a.tooth < b.tooth;
        });
        for (Patch& p : merged_) {
            p.pressureShare /= out.pressureMm3;
            if (!out.patches.pushBack(p)) out.status = Status::truncated;
        }
    }

    Status constraints(const Pose& bur, double reachMm, ConstraintSet& out) noexcept override {
        out.clear();
        if (!bur.isValid()) return Status::invalidPose;
        lookAround(bur);
        Status status = Status::ok;
        std::size_t sets = 0;
        for (std::size_t n = 0; n < nearCount_; ++n) {
            Pair& pair = pairs_[near_[n]];
            const auto& [local, gapMm] = pair.at(bur);
            if (gapMm > reachMm || pair.clearMm(local) > reachMm) continue;
            if (sets == kMaxSets) {
                status = Status::truncated;
                break;
            }
            ConstraintSet& own = sets_[sets];
            const Status said =
                pair.hasPoints() ? pair.method->constraints(local, reachMm, own) : ofPiece(pair, local, reachMm, own);
            if (said == Status::truncated) status = said;
            if (own.empty()) continue;
            setOf_[sets++] = &pair;
        }
        // Where several hold the bur the depth names but one: each adds its own, or the proxy would find them pass by
        // pass. Of a field that has been cut the points say it as well.
        const auto isOfBur = [](const Pair* pair) { return pair->hasPoints(); };
        const auto setsEnd = setOf_.begin() + static_cast<std::ptrdiff_t>(sets);
        if (std::count_if(setOf_.begin(), setsEnd, isOfBur) > 1)
            for (auto pair = setOf_.begin(); pair != setsEnd; ++pair) {
                if (!isOfBur(*pair)) continue;
                const Depth& d = depthOf(**pair, (*pair)->at(bur).local, -reachMm);
                if (d.status != Status::ok || d.slackMm > 0.0 || -d.depthMm > reachMm) continue;
                out.pushBack(inScene(**pair, Constraint{d.normal, -d.depthMm, d.toothPointMm, d.tissue}));
            }
        // The most important of each tooth first, turn by turn.
        for (std::size_t k = 0; k < kMaxConstraints; ++k) {
            bool any = false;
            for (std::size_t s = 0; s < sets; ++s) {
                if (k >= sets_[s].size()) continue;
                any = true;
                if (!out.pushBack(inScene(*setOf_[s], sets_[s][k]))) return Status::truncated;
            }
            if (!any) break;
        }
        return status;
    }

    void yielding(const Pose& bur, SoftSet& out) noexcept override {
        out.clear();
        if (!bur.isValid()) return;
        for (Pair& pair : soft_) {
            const auto& [local, gapMm] = pair.at(bur);
            if (gapMm > 0.0) continue;
            const Depth d = pair.method->depthBeyond(0.0, local);
            if (d.status == Status::ok && d.depthMm > 0.0)
                out.pushBack({pair.direction(d.normal), d.depthMm, pair.place(d.toothPointMm), d.tissue, pair.piece});
        }
    }

    void bearing(const Pose& bur, const Vec3& direction, double leadMm, double leastRadiusMm,
                 Bearing& out) noexcept override {
        out = Bearing{};
        for (Vec3& t : out.tangentMm)
            t.setZero();
        if (!bur.isValid() || !direction.allFinite()) {
            out.status = Status::invalidPose;
            return;
        }
        lookAround(bur);
        const double withinMm = kContactMarginMm + std::max(leadMm, 0.0);
        for (std::size_t n = 0; n < nearCount_; ++n) {
            Pair& pair = pairs_[near_[n]];
            if (!pair.cuts()) continue;
            const auto& [local, gapMm] = pair.at(bur);
            if (gapMm > withinMm) continue;
            const Vec3 along = pair.turns ? Vec3(pair.sceneInTooth.orientation * direction) : direction;
            Bearing own;
            pair.method->bearing(local, along, leadMm, leastRadiusMm, own);
            if (out.status == Status::ok) out.status = own.status;
            for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
                out.areaMm2[t] += own.areaMm2[t];
                out.resistanceMm[t] += own.resistanceMm[t];
                out.tangentMm[t] += pair.direction(own.tangentMm[t]);
            }
        }
    }

    [[nodiscard]] std::uint64_t toothVersion() const noexcept override {
        std::uint64_t sum = 0;
        for (const std::uint16_t i : cutting_)
            sum += pairs_[i].method->toothVersion();
        return sum;
    }
    [[nodiscard]] double slackMm() const noexcept override {
        double most = 0.0;
        for (const std::uint16_t i : cutting_)
            most = std::max(most, pairs_[i].method->slackMm());
        return most;
    }
    [[nodiscard]] bool isCutNear(const Pose& bur) const noexcept override {
        if (!bur.isValid()) return false;
        return std::any_of(cutting_.begin(), cutting_.end(), [&](std::uint16_t i) {
            const auto& [local, gapMm] = pairs_[i].at(bur);
            return gapMm <= kNearSlackMm && pairs_[i].method->isCutNear(local);
        });
    }
    void noteCut(const Pose& bur) noexcept override {
        for (const std::uint16_t i : cutting_)
            if (pairs_[i].at(bur).gapMm <= kNearSlackMm) pairs_[i].method->noteCut(pairs_[i].at(bur).local);
    }
    void reset() noexcept override {
        for (Pair& pair : pairs_) {
            pair.method->reset();
            pair.wasAsked = false;
        }
        for (Pair& pair : soft_)
            pair.method->reset();
        hasLooked_ = false;
        decided_ = kMaxPlaced;
    }

  private:
    static constexpr std::size_t kMaxSets = 12;

    [[nodiscard]] static Patch inScene(const Pair& pair, Patch p) noexcept {
        p.centreMm = pair.place(p.centreMm);
        p.normal = pair.direction(p.normal);
        p.tooth = pair.tooth;
        return p;
    }

    [[nodiscard]] static Constraint inScene(const Pair& pair, Constraint c) noexcept {
        c.normal = pair.direction(c.normal);
        c.pointMm = pair.place(c.pointMm);
        c.tooth = pair.tooth;
        c.piece = pair.piece;
        c.isHeldOnly = !pair.cuts();
        return c;
    }

    /// Which pairs can touch from here, until the instrument has moved by kNearSlackMm.
    void lookAround(const Pose& bur) noexcept {
        if (hasLooked_ && core::mostMovedMm(lookedAt_, bur, farthestMm_) <= kNearSlackMm) return;
        nearCount_ = 0;
        for (std::size_t i = 0; i < pairs_.size(); ++i)
            if (pairs_[i].at(bur).gapMm <= reachMm_ + kNearSlackMm) near_[nearCount_++] = static_cast<std::uint16_t>(i);
        lookedAt_ = bur;
        hasLooked_ = true;
    }

    /// As Method::depthBeyond(). Where nothing is cut one depth serves all who ask at a pose.
    [[nodiscard]] const Depth& depthOf(Pair& pair, const Pose& local, double floorMm) noexcept {
        const std::uint64_t version = pair.method->toothVersion();
        const bool isKnown =
            pair.wasAsked && !(pair.answer.slackMm > 0.0) && version == pair.askedVersion &&
            isSame(local, pair.askedAt) &&
            (pair.answer.status == Status::ok || pair.askedFloorMm <= floorMm || pair.answer.depthMm <= floorMm);
        if (!isKnown) {
            pair.answer = pair.method->depthBeyond(floorMm, local);
            pair.askedFloorMm = floorMm;
            pair.askedAt = local;
            pair.askedVersion = version;
            pair.wasAsked = true;
        }
        return pair.answer;
    }
    Status ofPiece(Pair& pair, const Pose& local, double reachMm, ConstraintSet& out) noexcept {
        out.clear();
        const Depth& d = depthOf(pair, local, -reachMm);
        if (d.status != Status::ok) return d.status;
        if (-d.depthMm <= reachMm) out.pushBack({d.normal, -d.depthMm, d.toothPointMm, d.tissue});
        return Status::ok;
    }

    [[nodiscard]] Depth deepest(const Pose& bur, const double* enoughMm) noexcept {
        Depth best;
        best.depthMm = -reachMm_;
        if (!bur.isValid()) {
            best.status = Status::invalidPose;
            return best;
        }
        lookAround(bur);
        // Who decided last is asked first, then the nearest, by their boxes or by what was last answered: whoever is
        // farther than what was found cannot be deeper, and the others are only asked whether they are.
        struct Candidate {
            double atLeastMm;
            std::uint16_t pair;
        };
        std::array<Candidate, kMaxPlaced> order;
        std::size_t count = 0;
        for (std::size_t n = 0; n < nearCount_; ++n) {
            const auto& [local, gapMm] = pairs_[near_[n]].at(bur);
            const double atLeastMm = std::max(gapMm, pairs_[near_[n]].clearMm(local));
            if (atLeastMm <= reachMm_) order[count++] = {atLeastMm, near_[n]};
        }
        std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count),
                  [this](const Candidate& a, const Candidate& b) {
                      if (a.pair == decided_ || b.pair == decided_) return a.pair == decided_ && b.pair != decided_;
                      return a.atLeastMm != b.atLeastMm ? a.atLeastMm < b.atLeastMm : a.pair < b.pair;
                  });
        const Pair* decides = nullptr;
        for (std::size_t n = 0; n < count; ++n) {
            // Boxes that meet say nothing.
            if (decides != nullptr && order[n].atLeastMm > std::max(0.0, -best.depthMm)) break;
            Pair& pair = pairs_[order[n].pair];
            const Pose& local = pair.at(bur).local;
            const double floorMm = decides != nullptr ? best.depthMm : -std::numeric_limits<double>::infinity();
            const Depth found =
                enoughMm != nullptr ? pair.method->depthUpTo(*enoughMm, local) : depthOf(pair, local, floorMm);
            if (decides != nullptr && !(found.depthMm > best.depthMm)) continue;
            best = found;
            decides = &pair;
            decided_ = order[n].pair;
        }
        if (decides == nullptr) return best;
        best.normal = decides->direction(best.normal);
        best.toothPointMm = decides->place(best.toothPointMm);
        best.tooth = decides->tooth;
        best.piece = decides->piece;
        best.isHeldOnly = !decides->cuts();
        return best;
    }

    double reachMm_, farthestMm_ = 0.0;
    std::vector<Pair> pairs_, soft_;
    std::vector<std::uint16_t> cutting_;  ///< pairs of the bur with teeth that it cuts
    std::array<std::uint16_t, kMaxPlaced> near_{};
    std::size_t nearCount_ = 0;
    std::size_t decided_ = kMaxPlaced;  ///< pair that was deepest when last asked
    Pose lookedAt_;
    bool hasLooked_ = false;
    std::array<ConstraintSet, kMaxSets> sets_;
    std::array<Pair*, kMaxSets> setOf_{};
    PatchSet scratchPatches_;
    core::FixedVector<Patch, kMaxSets * kMaxPatches> merged_;
};

}  // namespace

FeltInstrument::FeltInstrument(std::shared_ptr<const instrument::Bur> bur) {
    const std::vector<instrument::BodyPiece> body = instrument::bodyPieces(*bur);
    const auto add = [this](std::shared_ptr<const instrument::Bur> solid, const Pose& inBur, contact::Piece part) {
        std::shared_ptr<const MedialSheets> sheets = makeMedialSheets(*solid);
        pieces_.push_back({std::move(solid), inBur, part, std::move(sheets)});
    };
    add(std::move(bur), {}, contact::Piece::bur);
    for (const instrument::BodyPiece& piece : body)
        add(piece.solid, piece.inBur, piece.part);
}

template <class Tooth>
void FeltInstrument::placeAll(const std::shared_ptr<const Tooth>& tooth, const core::Box& box, const Standing& standing,
                              std::vector<PlacedMethod>& to) const {
    for (const Piece& piece : pieces_) {
        FieldMethodSettings settings;
        settings.depthOnly = standing.isYielding || standing.isPlain || piece.part != contact::Piece::bur;
        settings.sheets = piece.sheets;
        to.push_back({makeFieldMethod(tooth, piece.solid, settings), piece.solid, piece.inBur, standing.inScene, box,
                      standing.tooth, piece.part, standing.isYielding, standing.isPlain, standing.isCuttable});
    }
}

void FeltInstrument::place(const std::shared_ptr<const tooth::ToothModel>& tooth, const Standing& standing,
                           std::vector<PlacedMethod>& to) const {
    placeAll(tooth, tooth->outer.bounds(), standing, to);
}

void FeltInstrument::place(const std::shared_ptr<const tooth::ToothState>& tooth, const Standing& standing,
                           std::vector<PlacedMethod>& to) const {
    placeAll(tooth, tooth->model().outer.bounds(), standing, to);
}

std::unique_ptr<Method> makeMouthMethod(std::vector<PlacedMethod> placed, double reachMm) {
    if (placed.empty() || placed.size() > kMaxPlaced)
        throw core::Error("a mouth has no teeth, or more than can be felt", "contact", "take teeth away from the case");
    return std::make_unique<MouthMethod>(std::move(placed), reachMm);
}

}  // namespace handpiece::contact
