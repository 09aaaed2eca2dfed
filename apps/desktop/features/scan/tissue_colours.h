// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The colours of tissues over slices: the textbook's, and caries lighter: slices are dark.

#include <QBuffer>
#include <QColor>
#include <QImage>
#include <QString>

#include "handpiece/senses/view/look.h"

namespace handpiece::desktop {

[[nodiscard]] inline QColor tissueColour(cases::Tissue tissue) {
    if (tissue == cases::Tissue::none) return {0xc0, 0xc6, 0xce};
    const auto colour = view::colourOf(tissue, view::Palette::textbook);
    const QColor plain(colour[0], colour[1], colour[2]);
    return tissue == cases::Tissue::caries ? plain.lighter(220) : plain;
}

/// A square of it for rich text, with an edge: enamel is as white as paper.
[[nodiscard]] inline QString swatchHtml(cases::Tissue tissue) {
    QImage square(12, 12, QImage::Format_RGB32);
    square.fill(QColor(0x80, 0x86, 0x8e));
    for (int y = 1; y < 11; ++y)
        for (int x = 1; x < 11; ++x)
            square.setPixelColor(x, y, tissueColour(tissue));
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    square.save(&buffer, "PNG");
    return QStringLiteral("<img src='data:image/png;base64,%1'/>&nbsp;").arg(QString::fromLatin1(bytes.toBase64()));
}

}  // namespace handpiece::desktop
