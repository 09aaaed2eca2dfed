// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/gingiva_cuts.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/instrument/bur.h"

namespace handpiece::simulation {
namespace {

/// A bur that has moved by less, or turned about its tip so that its axis ends by less elsewhere, cuts the same place.
constexpr double kApartMm = 0.2;

/// The bur as a turned body of few stations: its widest ring about each, narrower towards the tip.
void fillStations(const instrument::Bur& bur, messages::GingivaCut& cut) {
    cut.lengthMm = bur.lengthMm();
    const auto& rings = bur.rings();
    for (std::size_t k = 0; k < messages::kBurStations; ++k) {
        const double z = cut.lengthMm * static_cast<double>(k) / (messages::kBurStations - 1);
        const auto above = std::find_if(rings.begin(), rings.end(), [z](const auto& ring) { return ring.zMm >= z; });
        const auto& high = above == rings.end() ? rings.back() : *above;
        const auto& low = above == rings.begin() || above == rings.end() ? high : *(above - 1);
        const double share = high.zMm > low.zMm ? (z - low.zMm) / (high.zMm - low.zMm) : 1.0;
        cut.stationRadiusMm[k] = std::max(0.0, low.rhoMm + share * (high.rhoMm - low.rhoMm));
    }
    // A flat end has its rim's width at once.
    for (const auto& ring : rings)
        if (ring.zMm <= 1e-6) cut.stationRadiusMm.front() = std::max(cut.stationRadiusMm.front(), ring.rhoMm);
}

bool isSamePlace(const messages::GingivaCut& a, const messages::GingivaCut& b) {
    const core::Vec3 tip = core::toVec(a.tipMm) - core::toVec(b.tipMm);
    if (tip.squaredNorm() >= kApartMm * kApartMm || a.stationRadiusMm != b.stationRadiusMm) return false;
    const core::Vec3 end = tip + a.lengthMm * core::toVec(a.axis) - b.lengthMm * core::toVec(b.axis);
    return end.squaredNorm() < 4.0 * kApartMm * kApartMm;
}

}  // namespace

void GingivaCuts::hear(const messages::HapticSample& sample, const instrument::Bur& bur) {
    if ((sample.flags & messages::kCutsGingiva) == 0) return;
    messages::GingivaCut cut;
    // Whole microseconds: a replay counts time by its rate, the loop by its period, and the last bit differs.
    cut.timeS = std::round(1e6 * sample.timeS) / 1e6;
    cut.tipMm = sample.proxyPositionMm;
    const auto& q = sample.proxyOrientation;
    cut.axis = core::toArray(core::Vec3(core::Quat(q[0], q[1], q[2], q[3]) * core::Vec3::UnitZ()));
    fillStations(bur, cut);
    const std::lock_guard lock(mutex_);
    if (cuts_.size() >= kMost || (!cuts_.empty() && cut.timeS <= cuts_.back().timeS)) return;
    // The last ones first: one of them it is most of the time.
    if (std::any_of(cuts_.rbegin(), cuts_.rend(), [&](const auto& known) { return isSamePlace(known, cut); })) return;
    cuts_.push_back(cut);
    version_.fetch_add(1, std::memory_order_release);
}

void GingivaCuts::clear() {
    const std::lock_guard lock(mutex_);
    if (cuts_.empty()) return;
    cuts_.clear();
    version_.fetch_add(1, std::memory_order_release);
}

std::vector<messages::GingivaCut> GingivaCuts::all() const {
    const std::lock_guard lock(mutex_);
    return cuts_;
}

bool GingivaCuts::isEmpty() const {
    const std::lock_guard lock(mutex_);
    return cuts_.empty();
}

}  // namespace handpiece::simulation
