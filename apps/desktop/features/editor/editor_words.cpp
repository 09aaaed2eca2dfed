// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/editor_words.h"

#include <QCoreApplication>
#include <utility>

#include "desktop/framework/problem.h"
#include "handpiece/base/config/words.h"

namespace handpiece::desktop {
namespace {

constexpr std::pair<std::string_view, const char*> kTemplates[] = {
    {"access", QT_TRANSLATE_NOOP("Preparation", "Endodontic access cavity")},
    {"block-channel", QT_TRANSLATE_NOOP("Preparation", "Block: channel")},
    {"block-circle", QT_TRANSLATE_NOOP("Preparation", "Block: circle")},
    {"block-cross", QT_TRANSLATE_NOOP("Preparation", "Block: cross")},
    {"block-d-circle", QT_TRANSLATE_NOOP("Preparation", "Block: half circle")},
    {"block-hollow-circle", QT_TRANSLATE_NOOP("Preparation", "Block: ring")},
    {"block-line", QT_TRANSLATE_NOOP("Preparation", "Block: line")},
    {"block-steps", QT_TRANSLATE_NOOP("Preparation", "Block: steps")},
    {"class-five", QT_TRANSLATE_NOOP("Preparation", "Class V cavity")},
    {"class-one", QT_TRANSLATE_NOOP("Preparation", "Class I cavity")},
    {"class-three", QT_TRANSLATE_NOOP("Preparation", "Class III cavity")},
    {"class-two", QT_TRANSLATE_NOOP("Preparation", "Class II cavity")},
    {"crown", QT_TRANSLATE_NOOP("Preparation", "Full crown")},
    {"lesion", QT_TRANSLATE_NOOP("Preparation", "Removal of carious tissue")},
    {"onlay", QT_TRANSLATE_NOOP("Preparation", "Onlay")},
    {"painted", QT_TRANSLATE_NOOP("Preparation", "As painted")},
    {"recorded-work", QT_TRANSLATE_NOOP("Preparation", "As in recorded work")},
};
constexpr std::pair<std::string_view, const char*> kParameters[] = {
    {"depth_mm", QT_TRANSLATE_NOOP("Preparation", "Depth")},
    {"width_mm", QT_TRANSLATE_NOOP("Preparation", "Width")},
    {"height_mm", QT_TRANSLATE_NOOP("Preparation", "Height, incisogingivally")},
    {"length_mm", QT_TRANSLATE_NOOP("Preparation", "Length")},
    {"diameter_mm", QT_TRANSLATE_NOOP("Preparation", "Diameter")},
    {"inner_mm", QT_TRANSLATE_NOOP("Preparation", "Diameter of the island")},
    {"ridge_mm", QT_TRANSLATE_NOOP("Preparation", "Left of marginal ridges and walls")},
    {"wall_deg", QT_TRANSLATE_NOOP("Preparation", "Wall angle")},
    {"axial_mm", QT_TRANSLATE_NOOP("Preparation", "Axial depth")},
    {"other_axial_mm", QT_TRANSLATE_NOOP("Preparation", "Axial depth of the other box")},
    {"box_width_mm", QT_TRANSLATE_NOOP("Preparation", "Width of the box")},
    {"under_contact_mm", QT_TRANSLATE_NOOP("Preparation", "Gingival floor under the contact")},
    {"labial_mm", QT_TRANSLATE_NOOP("Preparation", "Kept of the labial surface")},
    {"corner_mm", QT_TRANSLATE_NOOP("Preparation", "Radius of the corners")},
    {"over_cervix_mm", QT_TRANSLATE_NOOP("Preparation", "Over the cemento-enamel junction")},
    {"occlusal_mm", QT_TRANSLATE_NOOP("Preparation", "Occlusal reduction")},
    {"margin_mm", QT_TRANSLATE_NOOP("Preparation", "Width of the margin")},
    {"convergence_deg", QT_TRANSLATE_NOOP("Preparation", "Total occlusal convergence")},
    {"round_mm", QT_TRANSLATE_NOOP("Preparation", "Round horns and orifices")},
    {"cap_mesiobuccal_mm", QT_TRANSLATE_NOOP("Preparation", "Off the mesiobuccal cusp")},
    {"cap_distobuccal_mm", QT_TRANSLATE_NOOP("Preparation", "Off the distobuccal cusp")},
    {"cap_mesiolingual_mm", QT_TRANSLATE_NOOP("Preparation", "Off the mesiolingual cusp")},
    {"cap_distolingual_mm", QT_TRANSLATE_NOOP("Preparation", "Off the distolingual cusp")},
    {"shoulder_mm", QT_TRANSLATE_NOOP("Preparation", "Shoulder under the capped cusps")},
    {"over_pulp_mm", QT_TRANSLATE_NOOP("Preparation", "Carious tissue left over the pulp")},
};

template <class Table>
QString found(const Table& table, std::string_view key) {
    for (const auto& [name, text] : table)
        if (name == key) return QCoreApplication::translate("Preparation", text);
    return QString::fromUtf8(key.data(), static_cast<qsizetype>(key.size()));
}

}  // namespace

QString templateWords(std::string_view id) {
    return found(kTemplates, id);
}
QString parameterWords(std::string_view name) {
    return found(kParameters, name);
}
QString measureWords(std::string_view id) {
    const std::string name = "measure." + std::string(id);
    return QString::fromStdString(config::words().has(name) ? config::words().text(name) : std::string(id));
}
QString statusWords(rubric::Status status) {
    return QString::fromStdString(config::words().text("rubric.status." + std::string(rubric::nameOf(status))));
}
QString textPlaceWords(const draft::TextPlace& place) {
    using Kind = draft::TextPlace::Kind;
    const QString id = QString::fromStdString(place.id);
    const auto said = [&](const char* text) { return QCoreApplication::translate("Preparation", text).arg(id); };
    switch (place.kind) {
        case Kind::title:
            return QCoreApplication::translate("Preparation", "Title of the rubric");
        case Kind::words:
            return QCoreApplication::translate("Preparation", "About the rubric");
        case Kind::band:
            return said(QT_TRANSLATE_NOOP("Preparation", "Band %1"));
        case Kind::step:
            return said(QT_TRANSLATE_NOOP("Preparation", "Step %1"));
        case Kind::criterion:
            return said(QT_TRANSLATE_NOOP("Preparation", "Criterion %1"));
        case Kind::criterionWords:
            return said(QT_TRANSLATE_NOOP("Preparation", "%1: what it is about"));
        case Kind::leavesOut:
            return said(QT_TRANSLATE_NOOP("Preparation", "%1: what it leaves out"));
        case Kind::criticalError:
            return said(QT_TRANSLATE_NOOP("Preparation", "%1: its critical error"));
        case Kind::rule:
            return said(QT_TRANSLATE_NOOP("Preparation", "Rule %1"));
    }
    return id;
}
QString problemWords(const draft::Problem& problem, bool withAbout) {
    QString what, remedy;
    if (!problem.said.empty()) {
        what = QString::fromStdString(config::words()(problem.said));
        if (!problem.advice.empty()) remedy = QString::fromStdString(config::words()(problem.advice));
        if (withAbout && !problem.about.empty())
            what = QString::fromStdString(config::words()(problem.about)) + QStringLiteral(": ") + what;
    } else if (const QString id = QString::fromStdString(problem.error); problemIds().contains(id)) {
        QStringList arguments;
        for (const std::string& argument : problem.arguments)
            arguments << QString::fromStdString(argument);
        const Problem known = problemById(id, arguments);
        what = known.what, remedy = known.remedy;
    } else {
        what = QString::fromStdString(problem.what), remedy = QString::fromStdString(problem.remedy);
    }
    return remedy.isEmpty() ? what : QStringLiteral("%1 (%2)").arg(what, remedy);
}
QString parameterUnit(std::string_view name) {
    return name.ends_with("_deg") ? QStringLiteral("°") : name.ends_with("_mm") ? QStringLiteral("mm") : QString();
}

}  // namespace handpiece::desktop
