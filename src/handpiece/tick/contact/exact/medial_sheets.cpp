// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/exact/medial_sheets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::contact {
namespace {

/// Whether the balls of a sheet add nothing that is felt to one of `kept`. A ball (c, R) is at most |c - e| + R - r
/// deeper than a ball (e, r), whatever the tooth.
bool isCovered(const instrument::MedialCurve& sheet, const std::vector<instrument::MedialBall>& kept) {
    return std::any_of(kept.begin(), kept.end(), [&](const instrument::MedialBall& e) {
        // A curve turned about the axis: the ball e that is nearest lies at the same angle.
        return std::all_of(sheet.balls.begin(), sheet.balls.end(), [&](const instrument::MedialBall& b) {
            return core::hypot(b.rhoMm - e.rhoMm, b.zMm - e.zMm) + b.radiusMm - e.radiusMm <= MedialSheets::kCoveredMm;
        });
    });
}

}  // namespace

MedialSheets::MedialSheets(const instrument::Bur& bur) {
    std::vector<instrument::MedialBall> kept;
    for (const instrument::MedialCurve& curve : bur.medialAxis()) {
        if (curve.balls.empty()) continue;
        const bool searchedHere = !curve.onAxis && !isCovered(curve, kept);
        if (curve.onAxis || searchedHere) kept.insert(kept.end(), curve.balls.begin(), curve.balls.end());
        if (!curve.onAxis && !searchedHere) covered.insert(covered.end(), curve.balls.begin(), curve.balls.end());
        if (!searchedHere) continue;
        Sheet sheet;
        for (const instrument::MedialBall& ball : curve.balls) {
            double u = 0.0;
            if (!sheet.u.empty()) {
                const double length = core::hypot(ball.rhoMm - sheet.rho.back(), ball.zMm - sheet.z.back());
                if (length < 1e-10) continue;
                u = sheet.u.back() + length;
            }
            sheet.u.push_back(u);
            sheet.rho.push_back(ball.rhoMm);
            sheet.z.push_back(ball.zMm);
            sheet.radius.push_back(ball.radiusMm);
            sheet.maxRho = std::max(sheet.maxRho, ball.rhoMm);
            sheet.minRadius = sheet.u.size() == 1 ? ball.radiusMm : std::min(sheet.minRadius, ball.radiusMm);
            sheet.maxRadius = std::max(sheet.maxRadius, ball.radiusMm);
        }
        const auto reachFrom = [&](double z) {
            double reach = 0.0;
            for (std::size_t i = 0; i < sheet.u.size(); ++i)
                reach = std::max(reach, sheet.radius[i] + core::hypot(sheet.rho[i], sheet.z[i] - z));
            return reach;
        };
        // The smallest ball about the axis that holds the sheet's: its reach is convex in z, so thirds close in on it.
        double low = -1.0, high = bur.lengthMm() + 1.0;
        for (int i = 0; i < 80; ++i) {
            const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
            (reachFrom(a) < reachFrom(b) ? high : low) = reachFrom(a) < reachFrom(b) ? b : a;
        }
        sheet.centreZ = 0.5 * (low + high);
        sheet.reachMm = reachFrom(sheet.centreZ);
        sheet.promiseMm = -std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < sheet.u.size(); ++i) {
            const double away = core::hypot(sheet.rho[i], sheet.z[i] - sheet.centreZ);
            sheet.centresMm = std::max(sheet.centresMm, away);
            sheet.promiseMm = std::max(sheet.promiseMm, sheet.radius[i] - away);
        }
        addGrid(sheet);
        searched.push_back(std::move(sheet));
    }
}

/// Balls of the sheet about kSpacingMm apart along the curve and around, in circles of whole eights; farther apart
/// where there would be more than kMaxGrid.
void MedialSheets::addGrid(Sheet& sheet) {
    const double length = sheet.u.back();
    for (double spacing = kSpacingMm;; spacing *= 1.2) {
        sheet.rows.clear();
        sheet.cosine.clear();
        sheet.sine.clear();
        sheet.middleCosine.clear();
        sheet.middleSine.clear();
        const int steps = std::max(1, static_cast<int>(std::ceil(length / spacing)));
        std::size_t total = 0, piece = 0;
        for (int i = 0; i <= steps; ++i) {
            const double u = length * i / steps;
            while (piece + 2 < sheet.u.size() && sheet.u[piece + 1] < u)
                ++piece;
            const std::size_t next = std::min(piece + 1, sheet.u.size() - 1);
            const double span = sheet.u[next] - sheet.u[piece], t = span > 0.0 ? (u - sheet.u[piece]) / span : 0.0;
            Row row;
            row.u = u;
            row.rho = sheet.rho[piece] + t * (sheet.rho[next] - sheet.rho[piece]);
            row.z = sheet.z[piece] + t * (sheet.z[next] - sheet.z[piece]);
            row.radius = sheet.radius[piece] + t * (sheet.radius[next] - sheet.radius[piece]);
            row.first = static_cast<std::uint32_t>(total);
            row.count = 8 * static_cast<std::uint32_t>(
                                std::max(1.0, std::ceil(2.0 * std::numbers::pi * row.rho / spacing / 8.0)));
            total += row.count;
            if (total > kMaxGrid) break;
            for (std::uint32_t j = 0; j < row.count; ++j) {
                sheet.cosine.push_back(core::cos(2.0 * std::numbers::pi * j / row.count));
                sheet.sine.push_back(core::sin(2.0 * std::numbers::pi * j / row.count));
            }
            row.firstMiddle = static_cast<std::uint32_t>(sheet.middleCosine.size());
            for (std::uint32_t j = 0; j < (row.count / 8 + 7) / 8 * 8; ++j) {
                sheet.middleCosine.push_back(core::cos(2.0 * std::numbers::pi * (8 * j + 3.5) / row.count));
                sheet.middleSine.push_back(core::sin(2.0 * std::numbers::pi * (8 * j + 3.5) / row.count));
            }
            sheet.rows.push_back(row);
        }
        if (total > kMaxGrid) continue;
        sheet.spacingMm = spacing;
        addCells(sheet, spacing);
        if (sheet.cellU.size() <= kMaxGrid) return;
    }
}

/// Flat cells between the grid's circles. A circle is off its polygon by no more than r (1 - cos h) / (1 + cos h), with
/// half a side's angle h and the corners as far without as the sides' middles are within; the curve is off its chord
/// where it bends. Both are added to the radius.
void MedialSheets::addCells(Sheet& sheet, double spacing) {
    for (auto* each : {&sheet.cellX, &sheet.cellY, &sheet.cellZ})
        for (std::vector<float>& v : *each)
            v.clear();
    sheet.cellLowRadius.clear();
    sheet.cellHighRadius.clear();
    sheet.cellU.clear();
    sheet.cellAngle.clear();
    for (std::size_t i = 0; i + 1 < sheet.rows.size(); ++i) {
        const Row &low = sheet.rows[i], &high = sheet.rows[i + 1];
        double off = 0.0, mostRho = std::max(low.rho, high.rho);
        for (std::size_t k = 0; k < sheet.u.size(); ++k) {
            if (!(sheet.u[k] > low.u && sheet.u[k] < high.u)) continue;
            const double t = (sheet.u[k] - low.u) / (high.u - low.u);
            off = std::max(off, core::hypot(sheet.rho[k] - low.rho - t * (high.rho - low.rho),
                                            sheet.z[k] - low.z - t * (high.z - low.z)) +
                                    std::abs(sheet.radius[k] - low.radius - t * (high.radius - low.radius)));
            mostRho = std::max(mostRho, sheet.rho[k]);
        }
        const int count =
            8 * std::max(1, static_cast<int>(std::ceil(2.0 * std::numbers::pi * mostRho / spacing / 8.0)));
        const double half = std::numbers::pi / count, cosine = core::cos(half), out = 2.0 / (1.0 + cosine);
        off += mostRho * (1.0 - cosine) / (1.0 + cosine);
        for (int j = 0; j < count; ++j) {
            for (std::size_t k = 0; k < 4; ++k) {
                const Row& row = k < 2 ? low : high;
                const double angle = 2.0 * half * (j + static_cast<int>(k % 2));
                sheet.cellX[k].push_back(static_cast<float>(out * row.rho * core::cos(angle)));
                sheet.cellY[k].push_back(static_cast<float>(out * row.rho * core::sin(angle)));
                sheet.cellZ[k].push_back(static_cast<float>(row.z));
            }
            sheet.cellLowRadius.push_back(static_cast<float>(low.radius + off));
            sheet.cellHighRadius.push_back(static_cast<float>(high.radius + off));
            sheet.cellU.push_back(0.5 * (low.u + high.u));
            sheet.cellAngle.push_back(half * (2 * j + 1));
        }
    }
}

}  // namespace handpiece::contact
