// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A bur drawn from its outline: gold, steel or diamond, with the ring of colour that tells its grit.

#include <QColor>
#include <QPainterPath>
#include <QString>

#include "handpiece/model/instrument/catalogue.h"

class QPainter;
class QPalette;
class QRectF;

namespace handpiece::desktop {

/// What a bur looks like.
struct BurFace {
    enum class Metal { diamond, carbide, gold };
    Metal metal = Metal::carbide;
    bool crossCut = false;   ///< blades that are notched
    bool finishing = false;  ///< many fine blades
    QColor ring;             ///< invalid: none
    QString ringName;        ///< "blue", translated; empty: none
    QPainterPath outline;    ///< of the working head [mm], x across, y up the shank, tip at the origin
    double diameterMm = 0.0, lengthMm = 0.0;
};

/// Of a catalogue's bur. One made of a mesh gets a plain outline of its own size.
[[nodiscard]] BurFace burFace(const instrument::CatalogueEntry& entry);
/// Of an outline.
[[nodiscard]] BurFace burFace(const instrument::Profile& profile, std::string_view cuttingParameters);

/// Upright, tip down, centred in `rect`, `pixelsPerMm` large (0: as large as fits). Head, neck, shank and ring.
void paintBur(QPainter& painter, const QRectF& rect, const BurFace& face, const QPalette& palette,
              double pixelsPerMm = 0.0, bool enabled = true);

/// "Round diamond, medium": shape and ability in words, translated.
[[nodiscard]] QString shapeName(instrument::Shape shape);
[[nodiscard]] QString abilityName(std::string_view cuttingParameters);
/// "500 314 001 001 014": groups of the ISO 6360 number.
[[nodiscard]] QString groupedIso(std::string_view isoNumber);

}  // namespace handpiece::desktop
