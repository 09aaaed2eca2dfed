// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/ray_tissues.h"

#include <algorithm>

#include "handpiece/base/core/error.h"

namespace handpiece::cases {

using Role = RaySurface::Role;

RayTissues::RayTissues(std::vector<RaySurface> surfaces)
    : surfaces_(std::move(surfaces)), rank_(surfaces_.size(), kNone) {
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
        const RaySurface& surface = surfaces_[s];
        if (surface.role != Role::scenery && surface.tooth >= teeth_.size()) teeth_.resize(surface.tooth + 1);
        if (surface.role == Role::outer)
            teeth_[surface.tooth].outer = s;
        else
            ranked_.insert(ranked_.begin(), s);
        if (surface.role == Role::part) teeth_[surface.tooth].hasParts = true;
    }
    std::stable_sort(ranked_.begin(), ranked_.end(), [&](std::uint32_t a, std::uint32_t b) {
        if (surfaces_[a].role != surfaces_[b].role) return surfaces_[a].role == Role::part;
        return surfaces_[a].priority > surfaces_[b].priority;
    });
    for (std::uint32_t r = 0; r < ranked_.size(); ++r)
        rank_[ranked_[r]] = r;
}

void RayTissues::follow(std::span<const RayCrossing> crossings, const FillGap& fillGap, Work& work,
                        std::vector<RayStretch>& out) const {
    std::vector<Work::Piece>& pieces = work.pieces;
    pieces.clear();
    out.clear();
    work.winding.assign(surfaces_.size(), 0);
    work.inside.clear();
    for (std::size_t c = 0; c < crossings.size(); ++c) {
        const std::uint32_t crossed = crossings[c].surface;
        int& winding = work.winding[crossed];
        const bool wasIn = winding > 0;
        winding += crossings[c].step;
        if (const std::uint32_t rank = rank_[crossed]; rank != kNone && wasIn != (winding > 0)) {
            const auto at = std::lower_bound(work.inside.begin(), work.inside.end(), rank);
            if (wasIn)
                work.inside.erase(at);
            else
                work.inside.insert(at, rank);
        }
        if (c + 1 == crossings.size()) break;
        const double from = crossings[c].at, to = crossings[c + 1].at;
        if (!(to > from)) continue;
        std::uint32_t tooth = kNone;  // the first whose outer surface holds the stretch
        for (std::uint32_t t = 0; t < teeth_.size() && tooth == kNone; ++t)
            if (teeth_[t].outer != kNone && work.winding[teeth_[t].outer] > 0) tooth = t;
        const RaySurface* owner = nullptr;
        for (const std::uint32_t rank : work.inside) {
            const RaySurface& surface = surfaces_[ranked_[rank]];
            const std::uint32_t outer = surface.role == Role::part ? teeth_[surface.tooth].outer : kNone;
            const bool counts =
                surface.role == Role::scenery ? tooth == kNone : outer == kNone || work.winding[outer] > 0;
            if (counts) {
                owner = &surface;
                break;
            }
        }
        if (owner == nullptr && tooth == kNone) continue;
        Work::Piece piece{{from, to, Tissue::enamel, false}, kNone};
        if (owner != nullptr) {
            piece.stretch.tissue = owner->tissue;
            piece.stretch.isScenery = owner->role == Role::scenery;
        } else if (teeth_[tooth].hasParts) {
            piece.stretch.tissue = Tissue::none;
            piece.tooth = tooth;
        }
        Work::Piece* last = pieces.empty() ? nullptr : &pieces.back();
        if (last != nullptr && last->stretch.to == from && last->stretch.tissue == piece.stretch.tissue &&
            last->stretch.isScenery == piece.stretch.isScenery && last->tooth == piece.tooth)
            last->stretch.to = to;
        else
            pieces.push_back(piece);
    }
    for (const RayCrossing& c : crossings)
        if (work.winding[c.surface] != 0)
            throw core::Error("the surface is not closed: a ray goes in and does not come out",
                              surfaces_[c.surface].name, "mend it with `handpiece mesh repair`");
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        const RayStretch& gap = pieces[p].stretch;
        if (gap.tissue != Tissue::none) {
            out.push_back(gap);
            continue;
        }
        const RayStretch* next = p + 1 < pieces.size() ? &pieces[p + 1].stretch : nullptr;
        const RayStretch* after =
            next != nullptr && next->from == gap.to && next->tissue != Tissue::none ? next : nullptr;
        const bool isTouched = !out.empty() && out.back().to == gap.from;
        const RayStretch before = isTouched ? out.back() : RayStretch{};
        fillGap(pieces[p].tooth, gap.from, gap.to, isTouched ? &before : nullptr, after, out);
    }
}

}  // namespace handpiece::cases
