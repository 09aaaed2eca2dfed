// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The bur's rings of surface points in the tooth's field, eight points at a time. Plain data, compiled once per
/// instruction set, the same bits at each.

#include "handpiece/model/field/field_view.h"

namespace handpiece::contact {

/// A ring of the bur's surface points and where its share of the arrays begins.
struct BurRing {
    double zMm, rhoMm;
    float areaMm2;         ///< of each point
    float chordMm;         ///< from the middle of eight points to the outermost
    std::int32_t count;    ///< its points
    std::int32_t eights;   ///< the same in eights, rounded up; the padding repeats the last point
    std::int32_t first;    ///< its first point in arrays by point; kRingPad values lie before and after its points
    std::int32_t mask;     ///< its first eight in arrays by eight
    std::int32_t angles;   ///< its cosines and sines
    std::int32_t middles;  ///< cosines and sines of the middles of its eights
};
inline constexpr std::int32_t kRingPad = 8;

struct BurRings {
    const BurRing* rings;
    std::int32_t count;
    const float *cosines, *sines;
    const float* heights;  ///< of the rings [mm], padded to a multiple of eight
};

/// Where the bur is and what is asked.
struct RingQuery {
    const double *tip, *x, *y, *z;  ///< of the BurFrame, three numbers each
    float thresholdMm;              ///< points this near the surface are live, and all inside
    float farOutMm, farInMm;        ///< where no brick is stored the surface is at least this far
    bool skipsDeep;                 ///< points inside where no brick is stored, or deeper than deepMm, are not live
    float deepMm;                   ///< values hold no more than this
    /// A point counts as creased, walls meeting in its cell, when its slope is less than this share of a distance's, or
    /// slopes along the cell's edges differ by more than that, no more than creaseMm outside the surface (zero: never)
    /// and creaseInMm inside. It is live then.
    float creaseSlope, creaseTwist, creaseMm, creaseInMm;
    std::uint8_t tissue;  ///< when everything is of one tissue, else kManyTissues
    bool onlyDistances;   ///< no gradients and tissues
    float windowMm;       ///< points this much farther than the nearest need not be told; 0 for all
};
inline constexpr std::uint8_t kManyTissues = 0xff;

/// What was found. Arrays by point hold the values of rings that are live.
struct RingTouch {
    float* axisMm;                             ///< by ring (padded): signed distance of its middle, or a lower bound
    float* distanceMm;                         ///< by point: signed distance; kNotLiveMm where not live
    float *gradientX, *gradientY, *gradientZ;  ///< by point: of the field, per voxel; zero where no brick is stored
    std::uint8_t* tissue;                      ///< by point: of the nearest node; unset when all is of one tissue
    std::uint8_t* live;                        ///< by eight: bit i for its point i
    std::uint8_t* creased;                     ///< by eight of live points
    std::uint8_t* liveRing;                    ///< by ring: has live points
    float* leastMm;                            ///< by ring: least distance of its live points; kNotLiveMm for none
    bool* skippedDeep;                         ///< whether there were points that skipsDeep left out
};
inline constexpr float kNotLiveMm = 1e3f;

/// Places beside a point, along three unit directions of the tooth frame [mm].
struct AroundQuery {
    double centre[3], alongU[3], alongArc[3], inward[3];
    float u[8], arc[8], in[8];
    double reachMm;  ///< how far the places are from the centre at most
    float farOutMm, farInMm;
};

/// A band of the bur's surface about a ring: what it weighs when the bur is pushed along a direction.
struct BearingBand {
    std::int32_t ring;
    float normalRho, normalZ;  ///< unit, out of the bur
    float areaMm2;             ///< of each point
};
struct BearingQuery {
    float x, y, z;  ///< unit direction, bur frame
    float leadMm, marginMm, leastRadiusMm;
    std::uint8_t tissue;  ///< when everything is of one tissue, else kManyTissues
};
/// By lane; tangents in the bur's frame.
struct alignas(32) BearingSums {
    float area[8], resistance[8], x[8], y[8];
};

/// Sums over points of weight w = area times (margin - distance), by lane.
struct alignas(32) TouchSums {
    float weight[8], x[8], y[8], z[8];  ///< of w, and of w times the place in the bur's frame [mm]
    float gradientX[8], gradientY[8], gradientZ[8];
    float least[8];  ///< distance
};

struct RingKernels {
    /// Finds the live points.
    void (*sense)(const field::FieldView& field, const BurRings& bur, const RingQuery& query,
                  const RingTouch& touch) noexcept;
    /// Signed distances of eight places; a signed bound where no brick is stored.
    void (*around)(const field::FieldView& field, const AroundQuery& query, float* out) noexcept;
    /// Adds what the live points of all bands bear, by tissue.
    void (*bear)(const BurRings& bur, const RingTouch& touch, const BearingBand* bands, std::int32_t count,
                 const BearingQuery& query, BearingSums* byTissue) noexcept;
    /// Adds points from .. to - 1 of a ring, all live.
    void (*addRun)(const BurRings& bur, const RingTouch& touch, std::int32_t ring, std::int32_t from, std::int32_t to,
                   float marginMm, TouchSums& sums) noexcept;
    /// Bit i tells that point 8 eight + i of a ring with live points is so near, and live.
    unsigned (*within)(const BurRings& bur, const RingTouch& touch, std::int32_t ring, std::int32_t eight,
                       float mm) noexcept;
    /// Bit i tells that none of the two neighbours of live point 8 eight + i in its ring is nearer.
    unsigned (*lowInRing)(const BurRings& bur, const RingTouch& touch, std::int32_t ring, std::int32_t eight) noexcept;
};

namespace simd_base {
RingKernels ringKernels() noexcept;
}
namespace simd_avx2 {
RingKernels ringKernels() noexcept;
}
namespace simd_avx512 {
RingKernels ringKernels() noexcept;
}

}  // namespace handpiece::contact
