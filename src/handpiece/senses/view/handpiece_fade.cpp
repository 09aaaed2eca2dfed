// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/handpiece_fade.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace handpiece::view {
namespace {

using gl::Vec3f;

/// About the tip, as wide as what one looks at while one cuts.
constexpr float kSiteMm = 2.5f;
/// So far a piece may reach over the crown's edge before it fades, and gone it is so much farther.
constexpr float kMayCoverMm = -0.5f, kGoneMm = 1.5f;
/// Cosines of the bur's axis and the line of sight between which the handpiece goes from the head to its end: along the
/// bur it would cover all of the picture.
constexpr float kBeside = 0.70f, kAlong = 0.92f;
/// The head goes as one: cut through, what holds the bur would float.
constexpr float kHeadMm = 5.0f;
constexpr float kFadeMm = 6.0f;  // half of the way along the handle on which it fades
constexpr float kCellMm = 5.0f;  // of the balls that stand for it

float smooth(float from, float to, float x) {
    const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

/// By how much a ball lies over a disc that faces the eye: 0 not at all, 1 so far that it must go.
float over(const Vec3f& ballMm, float ballRadiusMm, const Vec3f& discMm, float discRadiusMm, const Vec3f& eyeMm,
           float beforeMm) {
    const Vec3f toEye = eyeMm - discMm;
    const float eye = std::max(1e-3f, toEye.norm());
    const Vec3f way = ballMm - discMm;
    const float high = way.dot(toEye) / eye;
    const float nearer = eye / std::max(0.05f * eye, eye - high);  // as large as it looks at the disc's distance
    const float away = (way - high * toEye / eye).norm() * nearer;
    return smooth(beforeMm - 2.0f, beforeMm + 2.0f, high) *
           smooth(kMayCoverMm, kGoneMm, discRadiusMm + ballRadiusMm * nearer - away);
}

}  // namespace

CrownBall crownOf(const core::Box& tooth) {
    if (tooth.isEmpty()) return {};
    const core::Vec3 size = tooth.size();
    const double wide = std::max(size.x(), size.y()), high = std::min(size.z(), wide);
    const core::Vec3 centre(tooth.centre().x(), tooth.centre().y(), tooth.max.z() - 0.5 * high);
    return {centre.cast<float>(), static_cast<float>(0.5 * wide)};
}

std::array<float, 2> HandpieceFade::Solid::between(float lowMm, float highMm) const {
    const auto at = [this](float mm) {
        return std::clamp(static_cast<int>(std::floor((mm - fromMm) / stepMm - 0.5f)), 0, kSlices - 1);
    };
    std::array<float, 2> found{1.0f, 0.0f};
    for (int i = at(lowMm); i <= std::min(kSlices - 1, at(highMm) + 1); ++i) {
        found[0] = std::min(found[0], share[static_cast<std::size_t>(i)]);
        found[1] = std::max(found[1], share[static_cast<std::size_t>(i)]);
    }
    return found;
}

float HandpieceFade::Solid::ofHead() const {
    return smooth(0.36f, 0.64f, share[0]);
}

void HandpieceFade::set(const geometry::TriangleMesh& handpiece) {
    balls_.clear();
    const core::Box box = handpiece.bounds();
    if (box.isEmpty()) return;
    fromMm_ = static_cast<float>(box.min.x());
    stepMm_ = std::max(0.1f, static_cast<float>(box.size().x()) / kSlices);
    // Of triangles, not of vertices: a smooth handle has long ones.
    std::map<std::array<int, 3>, core::Box> cells;
    const auto put = [&](const core::Vec3& p) {
        const auto cell = [](double mm) { return static_cast<int>(std::floor(mm / kCellMm)); };
        const int slice = std::clamp(static_cast<int>((p.x() - fromMm_) / stepMm_), 0, kSlices - 1);
        cells[{slice, cell(p.y()), cell(p.z())}].extend(p);
    };
    for (const auto& t : handpiece.triangles) {
        const core::Vec3 &a = handpiece.vertices[t[0]], &b = handpiece.vertices[t[1]], &c = handpiece.vertices[t[2]];
        const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
        const int parts = std::clamp(static_cast<int>(longest / (0.7 * stepMm_)), 1, 40);
        for (int i = 0; i <= parts; ++i)
            for (int k = 0; i + k <= parts; ++k)
                put(a + (b - a) * (static_cast<double>(i) / parts) + (c - a) * (static_cast<double>(k) / parts));
    }
    for (const auto& [at, cell] : cells)
        balls_.push_back({cell.centre().cast<float>(), static_cast<float>(0.5 * cell.size().norm()), at[0]});
}

HandpieceFade::Solid HandpieceFade::seenFrom(const Vec3f& eyeMm, const Vec3f& crownMm, float crownRadiusMm,
                                             float headLengthMm) const {
    Solid solid;
    solid.fromMm = fromMm_, solid.stepMm = stepMm_;
    solid.share.fill(1.0f);
    for (const Ball& ball : balls_) {
        float covers = over(ball.centreMm, ball.radiusMm, Vec3f::Zero(), kSiteMm, eyeMm, headLengthMm + 1.0f);
        if (crownRadiusMm > 0.0f)
            covers = std::max(covers, over(ball.centreMm, ball.radiusMm, crownMm, crownRadiusMm, eyeMm, 0.0f));
        float& share = solid.share[static_cast<std::size_t>(ball.slice)];
        share = std::min(share, 1.0f - covers);
    }
    // All that lies between such a place and the head goes with it.
    for (std::size_t i = kSlices - 1; i-- > 0;)
        solid.share[i] = std::min(solid.share[i], solid.share[i + 1]);
    const float along = smooth(kBeside, kAlong, eyeMm.z() / std::max(1e-3f, eyeMm.norm()));
    const float endMm = fromMm_ + stepMm_ * kSlices + 2.0f * kFadeMm;
    const float goneMm = fromMm_ - 2.0f * kFadeMm + along * (endMm - fromMm_ + 2.0f * kFadeMm);
    for (std::size_t i = 0; i < kSlices; ++i) {
        const float x = fromMm_ + (static_cast<float>(i) + 0.5f) * stepMm_;
        if (along > 0.0f) solid.share[i] *= smooth(goneMm - kFadeMm, goneMm + kFadeMm, x);
        if (x < kHeadMm) solid.share[i] = solid.share[0];
    }
    return solid;
}

}  // namespace handpiece::view
