// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/measuring.h"

#include <QCoreApplication>
#include <QLocale>

namespace handpiece::desktop {

namespace {

struct Texts {
    Q_DECLARE_TR_FUNCTIONS(Measuring)
};
QString millimetres(double mm) {
    return Texts::tr("%1 mm").arg(QLocale().toString(mm, 'f', 2));
}

}  // namespace

QString Measurement::text() const {
    switch (kind) {
        case Kind::distance:
            break;
        case Kind::depth:
            return alongAxisMm
                       ? Texts::tr("%1 deep, %2 along the bur").arg(millimetres(valueMm), millimetres(*alongAxisMm))
                       : Texts::tr("%1 deep").arg(millimetres(valueMm));
        case Kind::pulp:
            return Texts::tr("%1 of dentine to the pulp").arg(millimetres(valueMm));
    }
    return millimetres(valueMm);
}

view::Plane planeOf(const SectionPlace& place) {
    view::Plane plane;
    switch (place.direction) {
        case SectionPlace::Direction::buccoLingual:
            plane.normal = core::Vec3::UnitX();
            break;
        case SectionPlace::Direction::mesioDistal:
            plane.normal = core::Vec3::UnitY();
            break;
        case SectionPlace::Direction::horizontal:
            plane.normal = core::Vec3::UnitZ();
            break;
    }
    plane.offsetMm = place.offsetMm;
    if (place.flipped) {
        plane.normal = -plane.normal;
        plane.offsetMm = -plane.offsetMm;
    }
    return plane;
}

QString directionName(SectionPlace::Direction direction) {
    switch (direction) {
        case SectionPlace::Direction::buccoLingual:
            return Texts::tr("Bucco-lingual");
        case SectionPlace::Direction::mesioDistal:
            return Texts::tr("Mesio-distal");
        case SectionPlace::Direction::horizontal:
            return Texts::tr("Horizontal");
    }
    return {};
}

QString tissueText(cases::Tissue tissue) {
    switch (tissue) {
        case cases::Tissue::none:
            return Texts::tr("none");
        case cases::Tissue::enamel:
            return Texts::tr("Enamel");
        case cases::Tissue::dentine:
            return Texts::tr("Dentine");
        case cases::Tissue::pulp:
            return Texts::tr("Pulp");
        case cases::Tissue::caries:
            return Texts::tr("Caries");
        case cases::Tissue::cementum:
            return Texts::tr("Cementum");
        case cases::Tissue::gum:
            return Texts::tr("Gingiva");
        case cases::Tissue::bone:
            return Texts::tr("Bone");
        case cases::Tissue::neighbour:
            return Texts::tr("Adjacent tooth");
        case cases::Tissue::restoration:
            return Texts::tr("Restoration");
        case cases::Tissue::demineralisedEnamel:
            return Texts::tr("Demineralised enamel");
        case cases::Tissue::cariesSoft:
            return Texts::tr("Soft carious dentine");
        case cases::Tissue::cariesSoftToLeathery:
            return Texts::tr("Soft to leathery carious dentine");
        case cases::Tissue::cariesLeathery:
            return Texts::tr("Leathery carious dentine");
        case cases::Tissue::cariesLeatheryToFirm:
            return Texts::tr("Leathery to firm carious dentine");
        case cases::Tissue::cariesFirm:
            return Texts::tr("Firm carious dentine");
        case cases::Tissue::cariesFirmToHard:
            return Texts::tr("Firm to hard carious dentine");
        case cases::Tissue::stainedEnamel:
            return Texts::tr("Stained enamel");
        case cases::Tissue::calculus:
            return Texts::tr("Calculus");
    }
    return {};
}

}  // namespace handpiece::desktop
