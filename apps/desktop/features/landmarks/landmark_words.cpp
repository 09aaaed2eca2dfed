// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/landmarks/landmark_words.h"

#include <QCoreApplication>
#include <QStringList>
#include <algorithm>
#include <array>
#include <iterator>

namespace handpiece::desktop {
namespace {

struct Texts {
    Q_DECLARE_TR_FUNCTIONS(Landmarks)
};

// In the order of cases::LandmarkKind.
constexpr std::array<const char*, cases::kLandmarkKindCount> kKinds = {
    QT_TRANSLATE_NOOP("Landmarks", "Cusp tip"),
    QT_TRANSLATE_NOOP("Landmarks", "Pit"),
    QT_TRANSLATE_NOOP("Landmarks", "Contact"),
    QT_TRANSLATE_NOOP("Landmarks", "Pulp horn"),
    QT_TRANSLATE_NOOP("Landmarks", "Orifice"),
    QT_TRANSLATE_NOOP("Landmarks", "Furcation"),
    QT_TRANSLATE_NOOP("Landmarks", "Apex"),
    QT_TRANSLATE_NOOP("Landmarks", "Fissure"),
    QT_TRANSLATE_NOOP("Landmarks", "Marginal ridge"),
    QT_TRANSLATE_NOOP("Landmarks", "Ridge"),
    QT_TRANSLATE_NOOP("Landmarks", "Height of contour"),
    QT_TRANSLATE_NOOP("Landmarks", "Cemento-enamel junction"),
    QT_TRANSLATE_NOOP("Landmarks", "Long axis"),
    QT_TRANSLATE_NOOP("Landmarks", "Path of insertion"),
};
constexpr std::array<const char*, cases::kLandmarkSources.size()> kSources = {
    QT_TRANSLATE_NOOP("Landmarks", "generated"), QT_TRANSLATE_NOOP("Landmarks", "found"),
    QT_TRANSLATE_NOOP("Landmarks", "set by hand")};
/// The words that names are made of; what is none of them stays as the case has it.
constexpr const char* kWords[] = {
    QT_TRANSLATE_NOOP("Landmarks", "mesiobuccal"),  QT_TRANSLATE_NOOP("Landmarks", "distobuccal"),
    QT_TRANSLATE_NOOP("Landmarks", "mesiolingual"), QT_TRANSLATE_NOOP("Landmarks", "distolingual"),
    QT_TRANSLATE_NOOP("Landmarks", "mesiopalatal"), QT_TRANSLATE_NOOP("Landmarks", "distopalatal"),
    QT_TRANSLATE_NOOP("Landmarks", "mesial"),       QT_TRANSLATE_NOOP("Landmarks", "distal"),
    QT_TRANSLATE_NOOP("Landmarks", "buccal"),       QT_TRANSLATE_NOOP("Landmarks", "lingual"),
    QT_TRANSLATE_NOOP("Landmarks", "palatal"),      QT_TRANSLATE_NOOP("Landmarks", "labial"),
    QT_TRANSLATE_NOOP("Landmarks", "central"),      QT_TRANSLATE_NOOP("Landmarks", "second"),
    QT_TRANSLATE_NOOP("Landmarks", "triangular"),   QT_TRANSLATE_NOOP("Landmarks", "transverse"),
    QT_TRANSLATE_NOOP("Landmarks", "oblique"),      QT_TRANSLATE_NOOP("Landmarks", "marginal"),
    QT_TRANSLATE_NOOP("Landmarks", "incisal"),      QT_TRANSLATE_NOOP("Landmarks", "edge"),
    QT_TRANSLATE_NOOP("Landmarks", "cusp"),         QT_TRANSLATE_NOOP("Landmarks", "ridge"),
};

}  // namespace

QString kindText(cases::LandmarkKind kind) {
    return Texts::tr(kKinds[static_cast<std::size_t>(kind)]);
}

QString sourceText(cases::LandmarkSource source) {
    return Texts::tr(kSources[static_cast<std::size_t>(source)]);
}

QString nameText(const std::string& name) {
    QStringList words = QString::fromStdString(name).split(QLatin1Char(' '));
    for (QString& word : words) {
        const auto* known =
            std::find_if(std::begin(kWords), std::end(kWords), [&](const char* w) { return word == QLatin1String(w); });
        if (known != std::end(kWords)) word = Texts::tr(*known);
    }
    return words.join(QLatin1Char(' '));
}

QString landmarkText(const cases::Landmark& mark) {
    if (mark.name.empty()) return kindText(mark.kind);
    return Texts::tr("%1, %2").arg(kindText(mark.kind), nameText(mark.name));
}

}  // namespace handpiece::desktop
