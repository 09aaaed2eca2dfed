// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/drill/bur_picture.h"

#include <QCoreApplication>
#include <QLinearGradient>
#include <QPainter>
#include <QPalette>
#include <QRandomGenerator>
#include <QRegularExpression>
#include <cmath>

#include "desktop/widgets/theme.h"
#include "handpiece/base/core/error.h"

namespace handpiece::desktop {

namespace {

QString text(const char* source) {
    return QCoreApplication::translate("BurPicture", source);
}

struct Ring {
    const char* word;
    const char* name;
    QRgb colour;
};
constexpr Ring kRings[] = {{"black", QT_TRANSLATE_NOOP("BurPicture", "black"), 0xff22262b},
                           {"green", QT_TRANSLATE_NOOP("BurPicture", "green"), 0xff2a9d4a},
                           {"blue", QT_TRANSLATE_NOOP("BurPicture", "blue"), 0xff2d6fd2},
                           {"red", QT_TRANSLATE_NOOP("BurPicture", "red"), 0xffd1363b},
                           {"yellow", QT_TRANSLATE_NOOP("BurPicture", "yellow"), 0xfff2c81f},
                           {"white", QT_TRANSLATE_NOOP("BurPicture", "white"), 0xfff4f5f6}};

/// Points of the outline's right half, arcs in chords fine enough for any picture.
std::vector<QPointF> rightHalf(const instrument::Profile& profile) {
    std::vector<QPointF> points;
    for (const auto& piece : profile.pieces) {
        if (points.empty()) points.emplace_back(piece.from.x(), piece.from.y());
        if (piece.isArc) {
            const double a0 = std::atan2(piece.from.y() - piece.centre.y(), piece.from.x() - piece.centre.x());
            double sweep = std::atan2(piece.to.y() - piece.centre.y(), piece.to.x() - piece.centre.x()) - a0;
            if (piece.convex && sweep < 0) sweep += 2 * M_PI;
            if (!piece.convex && sweep > 0) sweep -= 2 * M_PI;
            constexpr int kChords = 24;
            for (int i = 1; i < kChords; ++i) {
                const double a = a0 + sweep * i / kChords;
                points.emplace_back(piece.centre.x() + piece.radiusMm * std::cos(a),
                                    piece.centre.y() + piece.radiusMm * std::sin(a));
            }
        }
        points.emplace_back(piece.to.x(), piece.to.y());
    }
    return points;
}

void setCuttingParameters(BurFace& face, std::string_view cuttingParameters) {
    const auto name = QString::fromUtf8(cuttingParameters.data(), static_cast<qsizetype>(cuttingParameters.size()));
    face.metal = name.startsWith("diamond")   ? BurFace::Metal::diamond
                 : name.contains("finishing") ? BurFace::Metal::gold
                                              : BurFace::Metal::carbide;
    face.crossCut = name.contains("cross");
    face.finishing = name.contains("finishing");
    // The ring stands in the words of the abilities' file.
    for (const auto& row : instrument::builtInBurs().abilities) {
        if (row.cuttingParameters.name != cuttingParameters) continue;
        static const QRegularExpression pattern(QStringLiteral("(\\w+) ring"));
        const auto match = pattern.match(QString::fromStdString(row.description));
        for (const Ring& ring : kRings)
            if (match.captured(1) == QLatin1String(ring.word)) {
                face.ring = QColor(ring.colour);
                face.ringName = text(ring.name);
            }
    }
}

QLinearGradient turned(double radius, const QColor& dark, const QColor& mid, const QColor& light) {
    QLinearGradient gradient(-radius, 0, radius, 0);
    gradient.setColorAt(0.0, dark);
    gradient.setColorAt(0.3, light);
    gradient.setColorAt(0.42, light);
    gradient.setColorAt(0.75, mid);
    gradient.setColorAt(1.0, dark);
    return gradient;
}

struct Paints {
    QColor dark, mid, light, mark;
};
Paints paintsOf(BurFace::Metal metal) {
    switch (metal) {
        case BurFace::Metal::diamond:
            return {0xff7d8288, 0xffb4b8bb, 0xffe9eaea, 0xff5d6268};
        case BurFace::Metal::gold:
            return {0xff8a6a1c, 0xffc9a13a, 0xfff8e7a6, 0xff6b5012};
        case BurFace::Metal::carbide:
            break;
    }
    return {0xff565d65, 0xff8a929a, 0xffe2e6ea, 0xff3a4047};
}

constexpr double kShankMm = 0.8, kNeckMm = 2.2, kShankShownMm = 3.6;

}  // namespace

BurFace burFace(const instrument::Profile& profile, std::string_view cuttingParameters) {
    BurFace face;
    setCuttingParameters(face, cuttingParameters);
    const auto points = rightHalf(profile);
    if (points.size() < 2) return face;
    face.outline.moveTo(points.front());
    for (const QPointF& p : points)
        face.outline.lineTo(p);
    for (auto p = points.rbegin(); p != points.rend(); ++p)
        face.outline.lineTo(-p->x(), p->y());
    face.outline.closeSubpath();
    face.diameterMm = 2.0 * profile.maxRadiusMm();
    face.lengthMm = profile.lengthMm();
    return face;
}

BurFace burFace(const instrument::CatalogueEntry& entry) {
    if (entry.stl.empty()) {
        try {
            return burFace(instrument::makeProfile(entry.shape, entry.diameterMm, entry.lengthMm),
                           entry.cuttingParameters);
        } catch (const core::Error&) {
            // A size that the shape cannot have was told where the file was read; here it is only a picture.
        }
    }
    BurFace face;
    setCuttingParameters(face, entry.cuttingParameters);
    face.diameterMm = entry.diameterMm > 0 ? entry.diameterMm : 1.2;
    face.lengthMm = entry.lengthMm > 0 ? entry.lengthMm : 4.0;
    face.outline.addRoundedRect(QRectF(-face.diameterMm / 2, 0, face.diameterMm, face.lengthMm), face.diameterMm / 3,
                                face.diameterMm / 3);
    return face;
}

void paintBur(QPainter& painter, const QRectF& rect, const BurFace& face, const QPalette& palette, double pixelsPerMm,
              bool enabled) {
    if (face.outline.isEmpty()) return;
    const double height = face.lengthMm + kNeckMm + kShankShownMm;
    const double width = std::max(2 * kShankMm, face.diameterMm);
    const double scale = pixelsPerMm > 0 ? pixelsPerMm : std::min(rect.height() / height, 0.9 * rect.width() / width);
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setClipRect(rect, Qt::IntersectClip);
    if (!enabled) painter.setOpacity(0.35);
    // Tip at the bottom when it fits; with a common scale the tips stand on one line.
    const double bottom = rect.bottom() - std::max(0.0, (rect.height() - height * scale) / (pixelsPerMm > 0 ? 1e9 : 2));
    painter.translate(rect.center().x(), bottom);
    painter.scale(scale, -scale);

    const Paints head = paintsOf(face.metal);
    const Paints shank{0xff79818a, 0xffa9b0b7, 0xfff4f6f8, 0xff5d646c};
    const QPen edge(QColor(isDark(palette) ? 0x101214 : 0x3c434a), 0.8 / scale);

    // Neck: from as wide as the head's top to the shank.
    const double topRadius = [&face] {
        double radius = 0.0;
        for (int i = 0; i < face.outline.elementCount(); ++i) {
            const auto e = face.outline.elementAt(i);
            if (e.y > face.lengthMm - 1e-6) radius = std::max(radius, static_cast<double>(e.x));
        }
        return radius;
    }();
    const double neck = std::min(kShankMm * 0.8, std::max(0.2, std::min(topRadius * 0.8, face.diameterMm * 0.35)));
    const double top = face.lengthMm + kNeckMm;
    QPainterPath neckPath;
    neckPath.moveTo(-neck, face.lengthMm * 0.8);
    neckPath.lineTo(-neck, face.lengthMm + kNeckMm * 0.45);
    neckPath.lineTo(-kShankMm, top);
    neckPath.lineTo(kShankMm, top);
    neckPath.lineTo(neck, face.lengthMm + kNeckMm * 0.45);
    neckPath.lineTo(neck, face.lengthMm * 0.8);
    neckPath.closeSubpath();
    painter.setPen(edge);
    painter.setBrush(turned(kShankMm, shank.dark, shank.mid, shank.light));
    painter.drawPath(neckPath);
    painter.drawRect(QRectF(-kShankMm, top, 2 * kShankMm, kShankShownMm));
    if (face.ring.isValid()) {
        painter.setBrush(turned(kShankMm, face.ring.darker(140), face.ring, face.ring.lighter(135)));
        painter.drawRect(QRectF(-kShankMm, top + 0.5, 2 * kShankMm, 0.9));
    }

    const double radius = face.diameterMm / 2;
    painter.setBrush(turned(radius, head.dark, head.mid, head.light));
    painter.drawPath(face.outline);
    painter.setClipPath(face.outline, Qt::IntersectClip);
    if (face.metal == BurFace::Metal::diamond) {
        // Grains, the same in every picture of this size.
        QRandomGenerator random(7);
        painter.setPen(Qt::NoPen);
        const double grain = std::max(0.045, 0.7 / scale);
        const int count = std::min(700, static_cast<int>(face.diameterMm * face.lengthMm / (grain * grain) * 0.16));
        for (int i = 0; i < count; ++i) {
            const double x = (2 * random.generateDouble() - 1) * radius, y = random.generateDouble() * face.lengthMm;
            painter.setBrush(random.generateDouble() < 0.5 ? head.mark : QColor(0xffffff));
            painter.setOpacity((enabled ? 1.0 : 0.35) * 0.55);
            painter.drawEllipse(QPointF(x, y), grain / 2, grain / 2);
        }
    } else {
        // Blades wind about the head.
        const double pitch = face.finishing ? radius * 0.34 : radius * 0.62, lean = face.lengthMm * 0.35;
        painter.setPen(QPen(head.mark, (face.finishing ? 0.8 : 1.1) / scale));
        for (double x = -radius - lean; x < radius + lean; x += pitch)
            painter.drawLine(QPointF(x - lean / 2, 0), QPointF(x + lean / 2, face.lengthMm));
        if (face.crossCut) {
            painter.setPen(QPen(head.light, 1.0 / scale));
            for (double y = 0.25; y < face.lengthMm; y += 0.45)
                painter.drawLine(QPointF(-radius, y), QPointF(radius, y + 0.12));
        }
    }
    painter.restore();
}

QString shapeName(instrument::Shape shape) {
    using instrument::Shape;
    switch (shape) {
        case Shape::round:
            return text(QT_TRANSLATE_NOOP("BurPicture", "Round"));
        case Shape::invertedCone:
            return text(QT_TRANSLATE_NOOP("BurPicture", "Inverted cone"));
        case Shape::cylinderFlat:
            return text(QT_TRANSLATE_NOOP("BurPicture", "Cylinder, flat end"));
        case Shape::cylinderRound:
            return text(QT_TRANSLATE_NOOP("BurPicture", "Cylinder, round end"));
        case Shape::taperFlat:
            return text(QT_TRANSLATE_NOOP("BurPicture", "Taper, flat end"));
        case Shape::taperRound:
            return text(QT_TRANSLATE_NOOP("BurPicture", "Taper, round end"));
        case Shape::pear:
            return text(QT_TRANSLATE_NOOP("BurPicture", "Pear"));
        case Shape::flame:
            return text(QT_TRANSLATE_NOOP("BurPicture", "Flame"));
        case Shape::torpedo:
            return text(QT_TRANSLATE_NOOP("BurPicture", "Torpedo"));
        case Shape::wheel:
            return text(QT_TRANSLATE_NOOP("BurPicture", "Wheel"));
    }
    return {};
}

QString abilityName(std::string_view cuttingParameters) {
    struct Word {
        const char *name, *text;
    };
    static constexpr Word kWords[] = {{"diamond-extra-fine", QT_TRANSLATE_NOOP("BurPicture", "Diamond, extra fine")},
                                      {"diamond-fine", QT_TRANSLATE_NOOP("BurPicture", "Diamond, fine")},
                                      {"diamond-medium", QT_TRANSLATE_NOOP("BurPicture", "Diamond, medium")},
                                      {"diamond-coarse", QT_TRANSLATE_NOOP("BurPicture", "Diamond, coarse")},
                                      {"carbide", QT_TRANSLATE_NOOP("BurPicture", "Carbide")},
                                      {"carbide-cross-cut", QT_TRANSLATE_NOOP("BurPicture", "Carbide, cross-cut")},
                                      {"carbide-finishing", QT_TRANSLATE_NOOP("BurPicture", "Carbide, finishing")},
                                      {"steel", QT_TRANSLATE_NOOP("BurPicture", "Steel")}};
    for (const Word& word : kWords)
        if (cuttingParameters == word.name) return text(word.text);
    return QString::fromUtf8(cuttingParameters.data(), static_cast<qsizetype>(cuttingParameters.size()));
}

QString groupedIso(std::string_view isoNumber) {
    QString grouped;
    for (std::size_t i = 0; i < isoNumber.size(); ++i) {
        if (i > 0 && i % 3 == 0) grouped += QLatin1Char(' ');
        grouped += QLatin1Char(isoNumber[i]);
    }
    return grouped;
}

}  // namespace handpiece::desktop
