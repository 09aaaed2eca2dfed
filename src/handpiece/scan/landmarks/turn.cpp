// SPDX-License-Identifier: Apache-2.0
// Which way a crown is turned: a scan of one tooth does not say where mesial is, the crown's shape may.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/scan/landmarks/find_landmarks.h"
#include "handpiece/scan/landmarks/finder.h"
#include "handpiece/scan/landmarks/relief.h"

namespace handpiece::landmarks {
namespace {
using core::Vec2;
using core::Vec3;

constexpr double kTurnBlurMm = 0.3, kSampleMm = 0.3;
/// Of the crown's height: below is what it hides of itself.
constexpr double kCrownFrom = 0.3;
/// A difference of heights that says no more than that it does not fit.
constexpr double kNoFitMm = 1.5;
constexpr int kCoarseDegrees = 6;
/// Within so much a crown stands as it should: real ones differ as much from the average.
constexpr double kAsItShould = 25.0;
/// So much better must it fit turned: premolars and incisors look alike from both ends.
constexpr double kBetter = 0.8;

/// A crown from above: its heights, the middle and the size of its outline.
struct Crown {
    Relief relief;
    Vec2 centre = Vec2::Zero();
    double top = 0.0, areaMm2 = 0.0;

    explicit Crown(const geometry::TriangleMesh& mesh) : relief(mesh, kTurnBlurMm) {
        core::Box box;
        for (const Vec3& v : mesh.vertices) {
            top = std::max(top, v.z());
            box.extend(v);
        }
        double count = 0.0;
        for (double y = box.min.y(); y <= box.max.y(); y += kSampleMm)
            for (double x = box.min.x(); x <= box.max.x(); x += kSampleMm)
                if (heightAt(Vec2(x, y))) {
                    centre += Vec2(x, y);
                    ++count;
                }
        if (count > 0.0) centre /= count;
        areaMm2 = count * kSampleMm * kSampleMm;
    }
    [[nodiscard]] std::optional<double> heightAt(const Vec2& p) const {
        const auto h = relief.heightAt(p);
        return h && *h > kCrownFrom * top ? h : std::nullopt;
    }
};

struct Sample {
    Vec2 at;  ///< from the crown's centre
    double z;
};

/// Mean difference of heights where one of the two is, when the average crown is laid over the other so.
double misfit(const std::vector<Sample>& average, const Crown& crown, double scale, double lift, double rad,
              const Vec2& shift) {
    const double c = core::cos(rad), s = core::sin(rad);
    double sum = 0.0, both = 0.0;
    for (const Sample& a : average) {
        const Vec2 p = crown.centre + shift + scale * Vec2(c * a.at.x() - s * a.at.y(), s * a.at.x() + c * a.at.y());
        if (const auto h = crown.heightAt(p)) {
            sum += std::min(kNoFitMm, std::abs(*h - lift - scale * a.z));
            ++both;
        } else {
            sum += kNoFitMm;
        }
    }
    // What of the crown lies beyond the average one's outline.
    const double cell = scale * scale * kSampleMm * kSampleMm;
    const double beyond = std::max(0.0, crown.areaMm2 / cell - both);
    return (sum + kNoFitMm * beyond) / (static_cast<double>(average.size()) + beyond);
}

}  // namespace

Turn turnOf(int fdiNumber, const geometry::TriangleMesh& outer) {
    const dentition::ToothForm form(fdiNumber, {0, kAverageAgeYears});
    geometry::IsosurfaceSettings settings;
    settings.lipschitz = dentition::ToothForm::kLipschitz;
    settings.usualSlope = 1.0;
    settings.spacingMm = 0.25;
    core::Box box = form.bounds();
    box.min.z() = std::max(box.min.z(), -0.5);
    const Crown average(geometry::isosurface(
        box, [&](const Vec3& p) { return form.outer(p); }, settings));
    const Crown crown(outer);
    if (!(crown.areaMm2 > 0.0)) return {};
    const double scale = std::sqrt(crown.areaMm2 / average.areaMm2);
    const double reach = std::sqrt(average.areaMm2);
    std::vector<Sample> samples;
    for (double y = -reach; y <= reach; y += kSampleMm)
        for (double x = -reach; x <= reach; x += kSampleMm)
            if (const auto h = average.heightAt(average.centre + Vec2(x, y))) samples.push_back({Vec2(x, y), *h});
    // The two are as high, on the whole.
    double mean = 0.0, meanAverage = 0.0, count = 0.0;
    for (double y = -reach * scale; y <= reach * scale; y += kSampleMm)
        for (double x = -reach * scale; x <= reach * scale; x += kSampleMm)
            if (const auto h = crown.heightAt(crown.centre + Vec2(x, y))) {
                mean += *h;
                ++count;
            }
    for (const Sample& s : samples)
        meanAverage += s.z / static_cast<double>(samples.size());
    const double lift = mean / count - scale * meanAverage;

    const auto about = [&](double degrees) {
        double least = std::numeric_limits<double>::infinity();
        for (const double dx : {-0.4, 0.0, 0.4})
            for (const double dy : {-0.4, 0.0, 0.4})
                least = std::min(least,
                                 misfit(samples, crown, scale, lift, degrees * std::numbers::pi / 180.0, Vec2(dx, dy)));
        return least;
    };
    double best = std::numeric_limits<double>::infinity(), bestDegrees = 0.0, asGiven = best;
    const auto tried = [&](double degrees) {
        const double here = about(degrees);
        if (here < best) best = here, bestDegrees = degrees;
        return here;
    };
    for (int degrees = -180; degrees < 180; degrees += kCoarseDegrees) {
        const double here = tried(degrees);
        if (std::abs(degrees) <= kAsItShould) asGiven = std::min(asGiven, here);
    }
    const double coarse = bestDegrees;
    for (int off = 1; off < kCoarseDegrees; ++off)
        for (const int sign : {-1, 1})
            tried(coarse + sign * off);
    Turn turn{0.0, best, asGiven};
    if (std::abs(bestDegrees) > kAsItShould && best < kBetter * asGiven)
        turn.rad = bestDegrees * std::numbers::pi / 180.0;
    return turn;
}

}  // namespace handpiece::landmarks
