// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is written and drawn on the picture: legend, scale, readings, measurements. Plain data in, paint out.

#include <QPainter>
#include <QRect>
#include <QString>
#include <optional>
#include <vector>

#include "desktop/picture/measuring.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/senses/view/camera.h"
#include "handpiece/senses/view/look.h"

namespace handpiece::desktop {

/// Everything the overlay shows at one moment.
struct OverlayState {
    view::Camera camera;
    bool compare = false;
    Tool tool = Tool::drill;
    std::vector<view::LegendEntry> legend;  ///< empty: none
    bool scaleBar = false;
    std::vector<QRectF> covered;               ///< where strips lie over the picture: names keep off
    std::optional<double> removedDepthMostMm;  ///< the end of that scale where it is shown

    // The hand; without one nothing of it is shown.
    bool hasHand = false;
    double loadN = 0.0;
    std::optional<double> stopMm, perPassMm;
    bool pedalDown = false, pedalLatched = false, away = false, pressed = false;

    std::vector<Measurement> measurements;
    std::optional<core::Vec3> calliperStartMm;
    std::optional<core::Vec3> pointerMm;  ///< the surface under the pointer
    std::optional<Measurement> reading;   ///< there, live
    std::optional<QPointF> pointer;
    std::optional<QPointF> cross;         ///< that keys move in the pointer's place
    std::optional<core::Vec3> burTipMm;   ///< as drawn
    std::optional<core::Vec3> restMm;     ///< where a finger rests
    bool mirrorView = false;              ///< only a mirror's picture is seen
    std::optional<Measurement> thinnest;  ///< over the pulp
    measure::PulpLimits pulpLimits;
    std::vector<ShownLandmark> landmarks;
    std::optional<core::Vec3> markMm;      ///< of what a result tells
    QString markWords;                     ///< beside it, in lines; empty: the ring alone
    bool isMarkHidden = false;             ///< by the tooth
    std::optional<LandmarkPoint> grabbed;  ///< of them, that is moved
    std::optional<SectionPlace> section;
    core::Box bounds;  ///< of the tooth
    QString hint;      ///< one line, what to do
    QString message;   ///< in the middle, instead of a picture
    QString remedy;    ///< under it
};

/// Paints it. `whole`: the widget; with `compare` what belongs to the tooth goes into the right half, and lines of
/// measurements into both.
void paintOverlay(QPainter& painter, const QRect& whole, const OverlayState& state);

/// Where the section's handle is seen; nothing without a section or behind the eye. `viewport`: that of one picture.
[[nodiscard]] std::optional<QPointF> sectionHandle(const OverlayState& state, const view::Viewport& viewport);
/// An eye that sees all of a tooth, as far back as leaves free the row in which hints and the hand's state are written.
[[nodiscard]] view::Camera clearOfWriting(const view::Camera& fitted, const view::Viewport& viewport);
/// A round length that is drawn as scale bar, and its pixels.
struct ScaleBar {
    double mm = 5.0, pixels = 0.0;
};
[[nodiscard]] ScaleBar scaleBarFor(const view::Camera& camera, const view::Viewport& viewport);

/// The frame of everything written on the picture: readable on light and dark alike.
void paintPanel(QPainter& painter, const QRectF& box);

}  // namespace handpiece::desktop
