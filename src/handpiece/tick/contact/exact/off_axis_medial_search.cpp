// SPDX-License-Identifier: Apache-2.0
// depth = max over the medial balls (c, R) of R - phiT(c), here over the balls of the sheets: docs/contact.md, "Depth
// lies on the medial axis" for why, "Rims" for the way, "Every tolerance" for the constants. A sheet is a curve
// (rho(u), z(u), R(u)), u its length, turned about the axis: c(u, a) = tip + rho (cos a x + sin a y) + z axis. The
// field tells which of its balls are promising, the triangles how deep those are.
#include "handpiece/tick/contact/exact/off_axis_medial_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::contact {

using core::Vec3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSpacingMm = MedialSheets::kSpacingMm, kCoveredMm = MedialSheets::kCoveredMm;
// A top between balls of the grid is taken to rise over the highest of them by no more than this. An assumption,
// judged by depths against brute force.
constexpr double kRiseMm = 0.05;
// A trilinear cell is taken to miss the distance by no more voxels than this. An assumption too.
constexpr double kFieldErrorVoxels = 0.2;
constexpr double kOnAxisMm = 1e-9;
// From any place of a sheet to the nearest ball of its grid, in spacings.
constexpr double kToGrid = 0.75;
// A radius changes by no more than the way along the curve: so many spacings farther on are still looked at.
constexpr double kRadiusSpacings = 2.0;
constexpr double kSameTopMm = 0.05;
constexpr float kDropped = 1e9f;
constexpr float kKnownMm = 0.5f * kBoundMm;  // distances are less, bounds more
constexpr double kRefinedMm = 0.004;
constexpr double kFieldWindowMm = 0.02;
// A climb ends when another top is higher than so many times what it hopes for.
constexpr double kFarBehind = 4.0;
constexpr double kToleranceMm = 2e-8;
constexpr double kFinalWindowMm = 5e-6;
constexpr int kMaxSteps = 48, kMaxLooks = 24;
constexpr float kFarMm = 1e3f;
// Nearer to the surface a place of it says little about the balls beside it, and the field knows more.
constexpr double kDeepMm = 0.2;
constexpr double kArcFloorMm = 0.05;  // about the axis an angle is no measure of length

bool isFine(float d) {
    return d < kKnownMm && d > -kKnownMm;
}
/// The distance, or its bound.
double distanceOf(float d) {
    return static_cast<double>(isFine(d) ? d : d > 0.0f ? d - kBoundMm : d + kBoundMm);
}

/// Largest of min over supports of (value + slopes . step) within the box: a linear program in two unknowns, whose best
/// lies at a corner. A corner is where two of these meet: sides of the box, and lines along which two supports are
/// equal. Four supports and four sides leave few, so all are tried.
template <class Support>
double solve(const Support* supports, int count, double lowU, double highU, double lowArc, double highArc,
             double& stepU, double& stepArc) noexcept {
    double best = -std::numeric_limits<double>::infinity();
    const auto offer = [&](double u, double arc) {
        constexpr double kSlack = 1e-12;
        if (!(u >= lowU - kSlack && u <= highU + kSlack && arc >= lowArc - kSlack && arc <= highArc + kSlack)) return;
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < count; ++i)
            least = std::min(least, supports[i].value + supports[i].alongU * u + supports[i].alongArc * arc);
        if (least > best) {
            best = least;
            stepU = u;
            stepArc = arc;
        }
    };
    for (const double u : {lowU, highU})
        for (const double arc : {lowArc, highArc})
            offer(u, arc);
    for (int i = 0; i < count; ++i)
        for (int j = i + 1; j < count; ++j) {
            // Where two are equal: a U + b arc = c.
            const double a = supports[i].alongU - supports[j].alongU, b = supports[i].alongArc - supports[j].alongArc;
            const double c = supports[j].value - supports[i].value;
            if (std::abs(b) > 1e-12)
                for (const double u : {lowU, highU})
                    offer(u, (c - a * u) / b);
            if (std::abs(a) > 1e-12)
                for (const double arc : {lowArc, highArc})
                    offer((c - b * arc) / a, arc);
            for (int k = j + 1; k < count; ++k) {
                const double d = supports[i].alongU - supports[k].alongU,
                             e = supports[i].alongArc - supports[k].alongArc;
                const double f = supports[k].value - supports[i].value, det = a * e - b * d;
                if (std::abs(det) > 1e-14) offer((c * e - b * f) / det, (a * f - c * d) / det);
            }
        }
    return best;
}

}  // namespace

OffAxisMedialSearch::OffAxisMedialSearch(std::shared_ptr<const MedialSheets> sheets, const field::DistanceField& field,
                                         core::SimdLevel level)
    : sheets_(std::move(sheets)),
      field_(field.view()),
      lookup_(HANDPIECE_AT_SIMD_LEVEL(level, fieldLookup)()),
      lowerCells_(HANDPIECE_AT_SIMD_LEVEL(level, lowerCells)()),
      bandOutMm_(static_cast<float>(field.settings().bandOutMm)),
      bandInMm_(static_cast<float>(field.settings().bandInMm)),
      errorMm_(kFieldErrorVoxels * field.settings().voxelMm),
      brickDiagonalMm_(std::numbers::sqrt3 * field::kBrickCells * field.settings().voxelMm) {
    // Hundreds of these stand round a mouth: no more room than the largest sheet takes.
    std::size_t balls = 0, cells = 0;
    for (const Sheet& sheet : sheets_->searched) {
        balls = std::max(balls, sheet.cosine.size());
        cells = std::max(cells, sheet.cellU.size());
    }
    grid_.resize(balls);
    for (std::vector<float>& corner : corner_)
        corner.resize(cells);
    upper_.resize(cells);
    unknown_.resize(balls);
}

bool OffAxisMedialSearch::isDeep(const ExactSurface& surface, const BurFrame& frame, double depthMm) const noexcept {
    return std::any_of(sheets_->searched.begin(), sheets_->searched.end(), [&](const Sheet& sheet) {
        return sheet.promiseMm - surface.farBound(frame.onAxis(sheet.centreZ)) - surface.sureMm() >= depthMm;
    });
}

/// A distance is 1-Lipschitz: at phiT(m) outside, with m the middle of the ball of reach about all of a sheet's, none
/// of them is deeper than reach - phiT(m); and none has its centre in the tooth when phiT(m) is more than the centres'
/// reach.
void OffAxisMedialSearch::search(const ExactSurface& surface, const BurFrame& frame, bool outsideKnown,
                                 double largestMm, BallDepth& best, double& mostMm) noexcept {
    for (const Sheet& sheet : sheets_->searched) {
        if (sheet.minRadius > largestMm) continue;
        const Vec3 centre = frame.onAxis(sheet.centreZ);
        const double far = surface.farBound(centre);
        if (far > 0.0 && (outsideKnown ? far > sheet.centresMm : sheet.reachMm - far <= best.depthMm)) continue;
        std::uint32_t seed = best.triangle;
        if (far > 0.0 && !outsideKnown) {
            const BallDepth around = surface.ball(centre, sheet.reachMm, seed, sheet.reachMm - best.depthMm);
            if (around.triangle == geometry::kNoTriangle) continue;
            seed = around.triangle;
        }
        if (std::max(best.depthMm, sheet.promiseMm - far - surface.sureMm()) >= sheet.maxRadius + kDeepMm) {
            searchDeep(surface, sheet, frame, seed, best, mostMm);
            continue;
        }
        mostRadiusMm_ = largestMm + kRadiusSpacings * sheet.spacingMm;
        mostOutsideMm_ = outsideKnown ? kToGrid * sheet.spacingMm + errorMm_ : std::numeric_limits<double>::infinity();
        searchSheet(surface, sheet, frame, seed, best, mostMm);
    }
    // Twice: a deeper ball has its own nearest place.
    if (askCovered(surface, frame, best)) askCovered(surface, frame, best);
    if (!sheets_->covered.empty()) mostMm = std::max(mostMm, best.depthMm) + kCoveredMm;
}

/// Of a sheet that is not searched, the balls at the angle of the one that was found: R + |c - q| bounds each from
/// above, with q the tooth's place, and the few that could be deeper are measured.
bool OffAxisMedialSearch::askCovered(const ExactSurface& surface, const BurFrame& frame,
                                     BallDepth& best) const noexcept {
    if (sheets_->covered.empty() || best.triangle == geometry::kNoTriangle || best.depthMm <= 0.0) return false;
    // The ball's meridian is the touched place's where that lies in a triangle, and right where several decide.
    double along = 0.0, across = 0.0, rho = 0.0;
    for (const Vec3* place : {&best.centreMm, &best.surfaceMm}) {
        if (rho >= kOnAxisMm) break;
        const Vec3 w = *place - frame.tip;
        along = w.dot(frame.x);
        across = w.dot(frame.y);
        rho = core::hypot(along, across);
    }
    if (rho < kOnAxisMm) return false;
    bool deeper = false;
    const Vec3 outward = (along * frame.x + across * frame.y) / rho;
    for (const instrument::MedialBall& ball : sheets_->covered) {
        const Vec3 centre = frame.tip + ball.rhoMm * outward + ball.zMm * frame.z;
        // Inside the tooth the nearest point is no farther than the one known.
        if (ball.radiusMm + (centre - best.surfaceMm).norm() <= best.depthMm) continue;
        const BallDepth found = surface.ball(centre, ball.radiusMm, best.triangle);
        if (found.depthMm <= best.depthMm) continue;
        best = found;
        deeper = true;
    }
    return deeper;
}

/// At a corner of the curve the slopes are those above it, or `isBelow`. c(u, a) and its slopes: dc/du = rho' e_r + z'
/// axis, and along the arc (rho / r) e_t, where r = max(rho, kArcFloorMm) turns a length into an angle.
OffAxisMedialSearch::Spot OffAxisMedialSearch::spotAt(const Sheet& sheet, const BurFrame& frame, double u, double angle,
                                                      bool isBelow) const noexcept {
    std::size_t low = 0, high = sheet.u.size() - 1;
    while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (u < sheet.u[middle] || (isBelow && u == sheet.u[middle]) ? high : low) = middle;
    }
    const double span = sheet.u[high] - sheet.u[low], scale = span > 0.0 ? 1.0 / span : 0.0,
                 t = (u - sheet.u[low]) * scale;
    const double dRho = (sheet.rho[high] - sheet.rho[low]) * scale, dZ = (sheet.z[high] - sheet.z[low]) * scale;
    const double rho = sheet.rho[low] + t * (sheet.rho[high] - sheet.rho[low]);
    const double z = sheet.z[low] + t * (sheet.z[high] - sheet.z[low]);
    const double c = core::cos(angle), s = core::sin(angle);
    const Vec3 outward = c * frame.x + s * frame.y, around = c * frame.y - s * frame.x;
    Spot spot;
    spot.centre = frame.tip + rho * outward + z * frame.z;
    spot.alongU = dRho * outward + dZ * frame.z;
    spot.arcPerRad = std::max(rho, kArcFloorMm);
    spot.alongArc = (rho / spot.arcPerRad) * around;
    spot.radius = sheet.radius[low] + t * (sheet.radius[high] - sheet.radius[low]);
    spot.radiusAlongU = (sheet.radius[high] - sheet.radius[low]) * scale;
    spot.lowU = sheet.u[low];
    spot.highU = sheet.u[high];
    return spot;
}

/// Distances of the grid's balls. Of eight neighbours none is farther than a chord from their middle, so by the
/// Lipschitz bound none is deeper than R + chord - phiT(middle): where that is not enough, none of the eight is looked
/// up.
void OffAxisMedialSearch::scan(const Sheet& sheet, const BurFrame& frame, double atLeast) noexcept {
    for (const Row& r : sheet.rows) {
        if (r.radius > mostRadiusMm_) {
            std::fill_n(&grid_[r.first], r.count, kDropped);
            continue;
        }
        FieldRow row;
        for (int k = 0; k < 3; ++k) {
            row.centre[k] = frame.tip[k] + r.z * frame.z[k];
            row.x[k] = r.rho * frame.x[k];
            row.y[k] = r.rho * frame.y[k];
        }
        row.farOutMm = bandOutMm_;
        row.farInMm = bandInMm_;
        const double chord = 2.0 * r.rho * core::sin(std::min(0.5 * 3.5 * 2.0 * kPi / r.count, 0.5 * kPi));
        float middle[8] = {};
        for (std::uint32_t j = 0; j < r.count; j += 8) {
            if (r.count >= 24) {
                if (j % 64 == 0) {
                    row.cosines = sheet.middleCosine.data() + r.firstMiddle;
                    row.sines = sheet.middleSine.data() + r.firstMiddle;
                    lookup_(field_, row, static_cast<int>(j / 8), middle);
                }
                const double d = distanceOf(middle[j / 8 % 8]);
                if (d > 0.0 && (r.radius + chord - d + errorMm_ < atLeast || d - chord > mostOutsideMm_)) {
                    std::fill_n(&grid_[r.first + j], 8, kDropped);
                    continue;
                }
            }
            row.cosines = sheet.cosine.data() + r.first;
            row.sines = sheet.sine.data() + r.first;
            lookup_(field_, row, static_cast<int>(j), &grid_[r.first + j]);
        }
    }
}

/// Of the grid's balls the one that is deepest by what the field knows at least.
OffAxisMedialSearch::Candidate OffAxisMedialSearch::highestOfGrid(const Sheet& sheet) const noexcept {
    Candidate highest{-std::numeric_limits<double>::infinity(), 0.0, 0.0};
    for (const Row& r : sheet.rows)
        for (std::uint32_t j = 0; r.radius <= mostRadiusMm_ && j < r.count; ++j)
            if (const double value = r.radius - distanceOf(grid_[r.first + j]); value > highest.value)
                highest = {value, r.u, 2.0 * kPi * j / r.count};
    return highest;
}

/// Tops of the grid (no neighbour on its circle or the two beside it is higher) where the field holds distances, and
/// all balls elsewhere that might beat `atLeast`. A top within kRiseMm of the highest that is sure is kept.
void OffAxisMedialSearch::collect(const Sheet& sheet, const BurFrame& frame, double atLeast) noexcept {
    candidateCount_ = unknownCount_ = 0;
    double least = atLeast;
    for (const Row& r : sheet.rows)
        for (std::uint32_t j = 0; r.radius <= mostRadiusMm_ && j < r.count; ++j)
            if (const float d = grid_[r.first + j]; isFine(d))
                least = std::max(least, r.radius - static_cast<double>(d) - errorMm_);
    for (std::size_t i = 0; i < sheet.rows.size(); ++i) {
        const Row& r = sheet.rows[i];
        if (r.radius > mostRadiusMm_) continue;
        const bool onAxis = r.rho < kOnAxisMm;  // one ball, many angles
        for (std::uint32_t j = 0; j < (onAxis ? 1 : r.count); ++j) {
            const float d = grid_[r.first + j];
            if (distanceOf(d) > mostOutsideMm_) continue;
            const double value = r.radius - distanceOf(d), angle = 2.0 * kPi * j / r.count;
            if (!isFine(d)) {
                // A brick's bound of an inside distance is short by its diagonal at most.
                const double upper = d < 0.0f ? value + brickDiagonalMm_ : value;
                if (upper > atLeast) {
                    const double c = sheet.cosine[r.first + j], s = sheet.sine[r.first + j];
                    unknown_[unknownCount_++] = {frame.tip + r.z * frame.z + r.rho * (c * frame.x + s * frame.y),
                                                 r.radius,
                                                 upper,
                                                 r.u,
                                                 angle,
                                                 d > 0.0f};
                }
                continue;
            }
            if (value + kRiseMm < least) continue;
            const auto isHigher = [&](const Row& other, std::uint32_t at) {
                const float there = grid_[other.first + at % other.count];
                return isFine(there) && other.radius - static_cast<double>(there) > value;
            };
            bool top = onAxis || (!isHigher(r, j + 1) && !isHigher(r, j + r.count - 1));
            for (const std::size_t k : {i - 1, i + 1}) {
                if (k >= sheet.rows.size()) continue;
                const Row& other = sheet.rows[k];
                if (!onAxis) top = top && !isHigher(other, (j * other.count + r.count / 2) / r.count);
                for (std::uint32_t a = 0; onAxis && top && a < other.count; ++a)
                    top = !isHigher(other, a);
            }
            if (!top) continue;
            const Candidate candidate{value, r.u, angle};
            if (candidateCount_ < kMaxCandidates) {
                candidates_[candidateCount_++] = candidate;
                continue;
            }
            const auto lowest =
                std::min_element(candidates_.begin(), candidates_.end(),
                                 [](const Candidate& a, const Candidate& b) { return a.value < b.value; });
            if (lowest->value < value) *lowest = candidate;
        }
    }
}

/// Climbs in the field by looks in eight directions; the step shrinks where none leads up (a pattern search: the field
/// is trilinear and has no slope worth following within a voxel).
void OffAxisMedialSearch::refine(const Sheet& sheet, const BurFrame& frame, Candidate& candidate) const noexcept {
    constexpr double kHalf = std::numbers::sqrt2 / 2.0;
    static constexpr double kCosine[8] = {1, kHalf, 0, -kHalf, -1, -kHalf, 0, kHalf};
    static constexpr double kSine[8] = {0, kHalf, 1, kHalf, 0, -kHalf, -1, -kHalf};
    double step = 0.5 * kSpacingMm;
    for (int look = 0; look < kMaxLooks && step > kRefinedMm; ++look) {
        const Spot spot = spotAt(sheet, frame, candidate.u, candidate.angle);
        FieldRow row;
        for (int k = 0; k < 3; ++k) {
            row.centre[k] = spot.centre[k];
            row.x[k] = step * spot.alongU[k];
            row.y[k] = step * spot.alongArc[k];
        }
        row.cosines = kCosine;
        row.sines = kSine;
        row.farOutMm = bandOutMm_;
        row.farInMm = bandInMm_;
        float d[8];
        lookup_(field_, row, 0, d);
        int best = -1;
        double bestValue = candidate.value;
        for (int k = 0; k < 8; ++k) {
            const double u = candidate.u + step * kCosine[k];
            const double value = spot.radius + step * kCosine[k] * spot.radiusAlongU - static_cast<double>(d[k]);
            if (u < -1e-9 || u > sheet.u.back() + 1e-9 || !isFine(d[k])) continue;
            if (value > bestValue) {
                bestValue = value;
                best = k;
            }
        }
        if (best < 0) {
            step *= 0.4;
            continue;
        }
        candidate.value = bestValue;
        candidate.u = std::clamp(candidate.u + step * kCosine[best], 0.0, sheet.u.back());
        candidate.angle += step * kSine[best] / spot.arcPerRad;
    }
}

/// Where the curve runs along the touched wall's normal its balls are nearly alike, outside the tooth and in it, and a
/// climb that begins outside ends there: its ends at that angle are asked as well, where the place that is touched lets
/// them be deeper.
void OffAxisMedialSearch::askEnds(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame, double angle,
                                  std::uint32_t& seed, BallDepth& best) noexcept {
    for (const double u : {0.0, sheet.u.back()}) {
        const Spot spot = spotAt(sheet, frame, u, angle);
        if (spot.radius + (spot.centre - best.surfaceMm).norm() <= best.depthMm + kToleranceMm) continue;
        const BallDepth found = surface.ball(spot.centre, spot.radius, seed);
        if (found.inside && found.depthMm + errorMm_ > best.depthMm)
            climbOnce(surface, sheet, frame, {found.depthMm, u, angle}, found, seed, kFieldWindowMm, best);
        if (found.depthMm > best.depthMm) best = found;
    }
}

bool OffAxisMedialSearch::remember(std::uint32_t triangle) noexcept {
    if (std::find(known_.begin(), known_.begin() + knownCount_, triangle) != known_.begin() + knownCount_) return false;
    known_[static_cast<std::size_t>(knownCount_ < kMaxKnown ? knownCount_++ : oldest_++ % kMaxKnown)] = triangle;
    return true;
}

/// `here`: the ball there, where it is known.
void OffAxisMedialSearch::climbOnce(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame,
                                    const Candidate& from, const BallDepth& here, std::uint32_t& seed, double reach,
                                    BallDepth& best) noexcept {
    const auto isNear = [&](double u, double angle) {
        return std::abs(u - from.u) < kSameTopMm &&
               sheet.maxRho * std::abs(std::remainder(angle - from.angle, 2.0 * kPi)) < kSameTopMm;
    };
    if (climbs_ == kMaxClimbs) return;
    for (int i = 0; i < climbs_; ++i) {
        const Top& top = tops_[static_cast<std::size_t>(i)];
        if (isNear(top.u, top.angle) || isNear(top.endU, top.endAngle)) return;
    }
    Top& top = tops_[static_cast<std::size_t>(climbs_++)];
    top = {from.u, from.angle, from.u, from.angle};
    BallDepth start = here;
    if (start.triangle == geometry::kNoTriangle) {
        const Spot spot = spotAt(sheet, frame, from.u, from.angle);
        start = surface.ball(spot.centre, spot.radius, seed);
        if (start.triangle == geometry::kNoTriangle) return;
        if (start.depthMm > best.depthMm) best = start;
    }
    climb(surface, sheet, frame, top, start, reach, best);
    seed = best.triangle != geometry::kNoTriangle ? best.triangle : seed;
}

/// Balls that the field cannot tell, the one with the highest bound first. Each one measured bounds the others: a ball
/// (c', R') is at most R' + |c' - q| deep, with q the tooth's place that a ball inside has found, and at most
/// R' - R + |c' - c| deeper than a ball (c, R) anywhere. What can no longer be the deepest is dropped.
void OffAxisMedialSearch::measure(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame,
                                  std::uint32_t& seed, BallDepth& best) noexcept {
    for (int count = 0; count < kMaxMeasured && unknownCount_ > 0; ++count) {
        std::size_t at = 0;
        for (std::size_t i = 1; i < unknownCount_; ++i)
            if (unknown_[i].upper > unknown_[at].upper) at = i;
        const Unknown here = unknown_[at];
        if (here.upper <= best.depthMm + kToleranceMm) return;
        // Outside, a surface too far to matter need not be found.
        const double bound =
            here.outside ? here.radius - best.depthMm + kRiseMm : std::numeric_limits<double>::infinity();
        const BallDepth found = surface.ball(here.centre, here.radius, seed, bound);
        const bool isFound = found.triangle != geometry::kNoTriangle;
        if (isFound) seed = found.triangle;
        const double value = isFound ? found.depthMm : best.depthMm - kRiseMm;
        if (value > best.depthMm) best = found;
        if (value + kRiseMm > best.depthMm && isFound)
            climbOnce(surface, sheet, frame, {value, here.u, here.angle}, found, seed, kSpacingMm, best);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < unknownCount_; ++i) {
            Unknown other = unknown_[i];
            if (i == at) continue;
            const double upper = isFound && found.inside
                                     ? other.radius + (other.centre - found.surfaceMm).norm()
                                     : value + other.radius - here.radius + (other.centre - here.centre).norm();
            other.upper = std::min(other.upper, upper);
            if (other.upper > best.depthMm + kToleranceMm) unknown_[kept++] = other;
        }
        unknownCount_ = kept;
    }
}

void OffAxisMedialSearch::searchSheet(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame,
                                      std::uint32_t seed, BallDepth& best, double& mostMm) noexcept {
    scan(sheet, frame, best.depthMm);
    if (const Candidate promising = highestOfGrid(sheet); promising.value > sheet.maxRadius + kDeepMm) {
        const Spot spot = spotAt(sheet, frame, promising.u, promising.angle);
        const BallDepth found = surface.ball(spot.centre, spot.radius, seed);
        seed = found.triangle;
        if (found.depthMm > best.depthMm) best = found;
        if (best.depthMm >= sheet.maxRadius + kDeepMm) {
            searchDeep(surface, sheet, frame, seed, best, mostMm);
            return;
        }
    }
    collect(sheet, frame, best.depthMm);
    climbs_ = knownCount_ = oldest_ = 0;
    const auto higher = [](const Candidate& a, const Candidate& b) {
        return a.value != b.value ? a.value > b.value : a.u != b.u ? a.u < b.u : a.angle < b.angle;
    };
    const auto end = candidates_.begin() + static_cast<std::ptrdiff_t>(candidateCount_);
    std::sort(candidates_.begin(), end, higher);
    double least = best.depthMm;
    for (auto c = candidates_.begin(); c != end; ++c) {
        if (c->value + kRiseMm < least) continue;
        refine(sheet, frame, *c);
        least = std::max(least, c->value - errorMm_);
    }
    std::sort(candidates_.begin(), end, higher);
    for (auto c = candidates_.begin(); c != end && c->value + errorMm_ > best.depthMm; ++c) {
        const int before = climbs_;
        climbOnce(surface, sheet, frame, *c, {}, seed, kFieldWindowMm, best);
        if (climbs_ > before)
            askEnds(surface, sheet, frame, tops_[static_cast<std::size_t>(before)].endAngle, seed, best);
    }
    measure(surface, sheet, frame, seed, best);
}

HighestCell OffAxisMedialSearch::lower(const Sheet& sheet, const BurFrame& frame, const Vec3& place, double freeMm,
                                       double floorMm) noexcept {
    const Vec3 w = place - frame.tip;
    const float inBur[3] = {static_cast<float>(w.dot(frame.x)), static_cast<float>(w.dot(frame.y)),
                            static_cast<float>(w.dot(frame.z))};
    SheetCells cells;
    for (std::size_t k = 0; k < 4; ++k) {
        cells.x[k] = sheet.cellX[k].data();
        cells.y[k] = sheet.cellY[k].data();
        cells.z[k] = sheet.cellZ[k].data();
        cells.corner[k] = corner_[k].data();
    }
    cells.lowRadius = sheet.cellLowRadius.data();
    cells.highRadius = sheet.cellHighRadius.data();
    cells.upper = upper_.data();
    cells.count = static_cast<int>(sheet.cellU.size());
    return lowerCells_(cells, inBur, static_cast<float>(freeMm), static_cast<float>(floorMm));
}

HighestCell OffAxisMedialSearch::highest(const Sheet& sheet) const noexcept {
    const auto end = upper_.begin() + static_cast<std::ptrdiff_t>(sheet.cellU.size());
    const auto top = std::max_element(upper_.begin(), end);
    return {*top, static_cast<int>(top - upper_.begin())};
}

/// With a depth known that no ball outside the tooth can have, the field is not asked: each place of the tooth that is
/// found bounds all cells, the one with the highest bound is measured, until no other could be deeper.
void OffAxisMedialSearch::searchDeep(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame,
                                     std::uint32_t seed, BallDepth& best, double& mostMm) noexcept {
    climbs_ = knownCount_ = oldest_ = 0;
    for (std::vector<float>& corner : corner_)
        std::fill_n(corner.begin(), sheet.cellU.size(), kFarMm);
    std::fill_n(upper_.begin(), sheet.cellU.size(), kFarMm);
    const auto floorMm = [&] { return best.depthMm + kDepthToleranceMm; };
    HighestCell top = best.triangle != geometry::kNoTriangle ? lower(sheet, frame, best.surfaceMm, 0.0, floorMm())
                                                             : HighestCell{kFarMm, 0};
    int measured = 0;
    for (; measured < kMaxMeasured && floorMm() < static_cast<double>(top.upper); ++measured) {
        const auto cell = static_cast<std::size_t>(top.cell);
        const Spot spot = spotAt(sheet, frame, sheet.cellU[cell], sheet.cellAngle[cell]);
        const BallDepth found = surface.ball(spot.centre, spot.radius, seed);
        seed = found.triangle;
        settled_[static_cast<std::size_t>(measured)] = top.cell;
        if (!found.inside) {
            top = lower(sheet, frame, spot.centre, (spot.centre - found.surfaceMm).norm(), floorMm());
        } else {
            const double before = best.depthMm;
            if (found.depthMm > best.depthMm) best = found;
            top = lower(sheet, frame, found.surfaceMm, 0.0, floorMm());
            if (static_cast<double>(upper_[cell]) > best.depthMm + kCoveredMm)
                climbOnce(surface, sheet, frame, {found.depthMm, sheet.cellU[cell], sheet.cellAngle[cell]}, found, seed,
                          2.0 * sheet.spacingMm, best);
            if (best.depthMm > before) top = lower(sheet, frame, best.surfaceMm, 0.0, floorMm());
        }
        upper_[cell] = -kFarMm;
        if (top.cell == settled_[static_cast<std::size_t>(measured)]) top = highest(sheet);
    }
    if (measured == kMaxMeasured) mostMm = std::max(mostMm, static_cast<double>(top.upper));
    for (int i = 0; i < measured; ++i) {
        const auto cell = static_cast<std::size_t>(settled_[static_cast<std::size_t>(i)]);
        float upper = corner_[0][cell];
        for (std::size_t k = 1; k < 4; ++k)
            upper = std::max(upper, corner_[k][cell]);
        if (static_cast<double>(upper) > floorMm()) mostMm = std::max(mostMm, static_cast<double>(upper));
    }
}

/// What the triangles seen so far allow at a place of the sheet: inside the tooth D(c) <= R + |c - q| for the nearest
/// place q of each, with the slope R' - n . c' (n from c to q); outside the one that is nearest is followed.
OffAxisMedialSearch::Model OffAxisMedialSearch::modelAt(const ExactSurface& surface, const Sheet& sheet,
                                                        const BurFrame& frame, const BallDepth& here, double u,
                                                        double angle, bool isBelow) const noexcept {
    Model model;
    const Spot spot = spotAt(sheet, frame, u, angle, isBelow);
    model.arcPerRad = spot.arcPerRad;
    model.lowU = spot.lowU;
    model.highU = spot.highU;
    const auto add = [&](std::uint32_t triangle, double sign) {
        const Vec3 to = surface.closestOn(triangle, spot.centre) - spot.centre;
        const double distance = to.norm();
        const Vec3 n = distance > kOnAxisMm ? Vec3(sign * to / distance) : surface.outward(here);
        model.supports[static_cast<std::size_t>(model.count++)] = {
            spot.radius + sign * distance, spot.radiusAlongU - n.dot(spot.alongU), -n.dot(spot.alongArc)};
    };
    if (here.inside)
        for (int i = 0; i < knownCount_; ++i)
            add(known_[static_cast<std::size_t>(i)], 1.0);
    else
        add(here.triangle, -1.0);
    // The lowest few decide.
    constexpr int kActive = 4;
    const auto end = model.supports.begin() + model.count;
    model.count = std::min(model.count, kActive);
    std::partial_sort(model.supports.begin(), model.supports.begin() + model.count, end,
                      [](const Support& a, const Support& b) { return a.value < b.value; });
    return model;
}

/// From a ball to the deepest one nearby. What the triangles seen so far allow is climbed first (solve(), in a window
/// that grows when the gain keeps the promise and shrinks when it does not: a bundle method with a trust region); its
/// top is measured, and each triangle found there lowers it, until it holds. docs/contact.md, "Rims".
void OffAxisMedialSearch::climb(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame, Top& top,
                                BallDepth here, double reach, BallDepth& best) noexcept {
    double u = top.u, angle = top.angle;
    remember(here.triangle);
    if (const Spot spot = spotAt(sheet, frame, u, angle);
        spot.alongArc.isZero(1e-9)) {  // on the axis every angle is as good: look up the slope
        const Vec3 away = (here.inside ? -1.0 : 1.0) * (spot.centre - here.surfaceMm);
        angle = core::atan2(-away.dot(frame.y), -away.dot(frame.x));
    }
    for (int step = 0; step < kMaxSteps; ++step) {
        double newU = u, newAngle = angle;
        Model model = modelAt(surface, sheet, frame, here, u, angle);
        double window = reach;
        for (int look = 0; look < kMaxLooks && window > kFinalWindowMm; ++look) {
            // No farther than the triangles seen can be trusted to tell, nor past a corner of the curve.
            const double before = model.supports[0].value, goneU = newU - u;
            double hoped = 0.0, nextU = newU, nextAngle = newAngle;
            const auto offer = [&](const Model& m) {
                const double lowU = std::max({-window, m.lowU - newU, -reach - goneU}),
                             highU = std::min({window, m.highU - newU, reach - goneU}),
                             goneArc = m.arcPerRad * (newAngle - angle);
                double stepU = 0.0, stepArc = 0.0;
                const double gain = solve(m.supports.data(), m.count, lowU, highU, std::max(-window, -reach - goneArc),
                                          std::min(window, reach - goneArc), stepU, stepArc) -
                                    before;
                if (gain <= hoped) return;
                hoped = gain;
                nextU = newU + stepU;
                for (const double end : {m.lowU, m.highU})
                    if (std::abs(nextU - end) < kOnAxisMm) nextU = end;
                nextAngle = newAngle + stepArc / m.arcPerRad;
            };
            offer(model);
            if (newU == model.lowU && newU > 0.0) offer(modelAt(surface, sheet, frame, here, newU, newAngle, true));
            if (hoped < kToleranceMm) break;
            const Model next = modelAt(surface, sheet, frame, here, nextU, nextAngle);
            const double gained = next.supports[0].value - before;
            if (gained > 0.0) {
                newU = nextU;
                newAngle = nextAngle;
                model = next;
            }
            window *= gained > 0.75 * hoped ? 1.5 : gained > 0.25 * hoped ? 0.7 : 0.3;
        }
        const double allowed = model.supports[0].value;
        const bool isLimited =
            std::max(std::abs(newU - u), model.arcPerRad * std::abs(newAngle - angle)) > 0.99 * reach;
        const double hoped = allowed - here.depthMm;
        if (here.depthMm + (isLimited || !here.inside ? kFarBehind : 1.0) * hoped < best.depthMm + kToleranceMm) break;
        const Spot there = spotAt(sheet, frame, newU, newAngle);
        const BallDepth found = surface.ball(there.centre, there.radius, here.triangle);
        const bool isNews = remember(found.triangle);
        const bool isTop =
            !isLimited && found.depthMm > allowed - kToleranceMm && (found.inside || found.triangle == here.triangle);
        if (found.depthMm > here.depthMm) {
            here = found;
            u = newU;
            angle = newAngle;
        } else {
            reach *= isNews ? 0.8 : 0.5;
        }
        if (found.depthMm > best.depthMm) best = found;
        if (isTop || reach < kFinalWindowMm) break;
    }
    top.endU = u;
    top.endAngle = angle;
}

}  // namespace handpiece::contact
