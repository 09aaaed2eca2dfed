// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/editor_words.h"

#include <QCoreApplication>
#include <utility>

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
    {"box_width_mm", QT_TRANSLATE_NOOP("Preparation", "Width of the box")},
    {"under_contact_mm", QT_TRANSLATE_NOOP("Preparation", "Gingival floor under the contact")},
    {"corner_mm", QT_TRANSLATE_NOOP("Preparation", "Radius of the corners")},
    {"over_cervix_mm", QT_TRANSLATE_NOOP("Preparation", "Over the cemento-enamel junction")},
    {"occlusal_mm", QT_TRANSLATE_NOOP("Preparation", "Occlusal reduction")},
    {"margin_mm", QT_TRANSLATE_NOOP("Preparation", "Width of the margin")},
    {"convergence_deg", QT_TRANSLATE_NOOP("Preparation", "Total occlusal convergence")},
    {"round_mm", QT_TRANSLATE_NOOP("Preparation", "Round horns and orifices")},
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
QString parameterUnit(std::string_view name) {
    return name.ends_with("_deg") ? QStringLiteral("°") : name.ends_with("_mm") ? QStringLiteral("mm") : QString();
}

}  // namespace handpiece::desktop
