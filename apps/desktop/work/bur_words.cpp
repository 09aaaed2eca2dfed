// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/bur_words.h"

#include <QCoreApplication>
#include <QFileInfo>

#include "handpiece/base/geometry/mesh_io.h"

namespace handpiece::desktop {

QString burTitle(const QString& name) {
    // A file's is what it is called, without its place.
    if (geometry::meshFormatOf(name.toStdString()) != geometry::MeshFormat::unknown)
        return QFileInfo(name).completeBaseName();
    if (name.isEmpty() || !name.front().isLetter()) return name;
    // The catalogue's own names; burs from files keep theirs.
    for (const auto& [front, text] :
         {std::pair(QLatin1String("round-"), QT_TRANSLATE_NOOP("handpiece::desktop::BurModel", "Round %1")),
          std::pair(QLatin1String("steel-round-"),
                    QT_TRANSLATE_NOOP("handpiece::desktop::BurModel", "Steel round %1"))})
        if (name.startsWith(front))
            return QCoreApplication::translate("handpiece::desktop::BurModel", text).arg(name.mid(front.size()));
    QString title = name;
    title.replace(QLatin1Char('-'), QLatin1Char(' '));
    title[0] = title[0].toUpper();
    return title;
}

QString driveTitle(const QString& name) {
    for (const auto& [drive, text] :
         {std::pair("turbine", QT_TRANSLATE_NOOP("handpiece::desktop::DrillBar", "High speed (air turbine)")),
          std::pair("weak-turbine", QT_TRANSLATE_NOOP("handpiece::desktop::DrillBar", "High speed, weak air")),
          std::pair("low-speed", QT_TRANSLATE_NOOP("handpiece::desktop::DrillBar", "Low speed")),
          std::pair("speed-increasing",
                    QT_TRANSLATE_NOOP("handpiece::desktop::DrillBar", "Red band 1:5 (speed-increasing)"))})
        if (name == QLatin1String(drive)) return QCoreApplication::translate("handpiece::desktop::DrillBar", text);
    return name;
}

}  // namespace handpiece::desktop
