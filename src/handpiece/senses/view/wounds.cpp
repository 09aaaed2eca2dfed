// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/wounds.h"

#include <algorithm>
#include <cmath>

namespace handpiece::view {
namespace {

constexpr double kStepS = 0.025;
/// A cut bleeds and what it bled runs for so long.
constexpr double kFlowsS = 15.0;
/// About a cut edges are short enough for its edge to swell; along the way that blood takes for it to run.
constexpr double kAboutMm = 1.5, kTrickleMm = 9.0;

std::int64_t stepAt(double timeS) {
    return static_cast<std::int64_t>(std::floor(timeS / kStepS));
}

/// The bur's head, and as far as blood may run from it; nothing more of it than can lie in gingiva.
core::Box boxOf(const messages::GingivaCut& cut, const core::Vec3& down) {
    constexpr double kMostInGingivaMm = 5.0;
    const core::Vec3 tip = core::toVec(cut.tipMm),
                     end = tip + std::min(cut.lengthMm, kMostInGingivaMm) * core::toVec(cut.axis);
    const double radius = *std::max_element(cut.stationRadiusMm.begin(), cut.stationRadiusMm.end());
    core::Box box;
    for (const core::Vec3& p : {tip, end})
        box.extend(p);
    box = box.grown(radius + kAboutMm);
    const core::Box head = box;
    box.extend(head.min + kTrickleMm * down);
    box.extend(head.max + kTrickleMm * down);
    return box;
}

}  // namespace

void Wounds::setGingiva(std::vector<Piece> pieces) {
    pieces_ = std::move(pieces);
    shown_.clear();
    beginAnew();
}

void Wounds::beginAnew() {
    wounded_.reset();
    taken_ = 0;
    isAnew_ = true;
}

void Wounds::setCuts(std::vector<messages::GingivaCut> cuts, const core::Vec3& down) {
    const bool isMore = down == down_ && cuts.size() >= taken_ &&
                        std::equal(cuts.begin(), cuts.begin() + static_cast<std::ptrdiff_t>(taken_), cuts_.begin());
    cuts_ = std::move(cuts);
    down_ = down;
    if (!isMore) beginAnew();
}

std::vector<std::pair<std::uint32_t, MeshPiece>> Wounds::at(double timeS) {
    const bool isLater = taken_ == 0 || (cuts_[taken_ - 1].timeS <= timeS && step_ <= stepAt(timeS));
    const bool isLate = taken_ < cuts_.size() && taken_ > 0 && stepAt(cuts_[taken_].timeS) < step_;
    if (!isLater || isLate) beginAnew();
    goTo(timeS);
    std::vector<std::pair<std::uint32_t, MeshPiece>> changed;
    if (wounded_) changed = wounded_->takeChanged(std::exchange(isAnew_, false));
    std::set<std::uint32_t> shown;
    // What is whole again is shown as it was.
    for (const Piece& piece : pieces_)
        if (wounded_ && wounded_->has(piece.number))
            shown.insert(piece.number);
        else if (shown_.contains(piece.number))
            changed.emplace_back(piece.number, *piece.mesh);
    shown_ = std::move(shown);
    isFlowing_ = taken_ > 0 && timeS < cuts_[taken_ - 1].timeS + kFlowsS;
    return changed;
}

/// Cuts and steps of time in their order, whatever pictures were drawn between them.
void Wounds::goTo(double timeS) {
    const auto flowTo = [this](double toS) {
        if (taken_ == 0) return;
        const std::int64_t last = stepAt(std::min(toS, cuts_[taken_ - 1].timeS + kFlowsS));
        for (; step_ < last; ++step_)
            wounded_->flow(static_cast<double>(step_) * kStepS, kStepS, down_);
    };
    while (taken_ < cuts_.size() && cuts_[taken_].timeS <= timeS) {
        const messages::GingivaCut& next = cuts_[taken_];
        flowTo(next.timeS);
        step_ = stepAt(next.timeS);
        take(next);
        ++taken_;
    }
    flowTo(timeS);
}

void Wounds::take(const messages::GingivaCut& cut) {
    if (!wounded_) wounded_.emplace();
    const core::Box box = boxOf(cut, down_);
    const gl::Vec3f low = box.min.cast<float>(), high = box.max.cast<float>();
    for (const Piece& piece : pieces_)
        if ((piece.minMm.array() <= high.array()).all() && (piece.maxMm.array() >= low.array()).all())
            wounded_->add(piece.number, *piece.mesh);
    wounded_->cut(cut, box);
}

}  // namespace handpiece::view
