// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/notation.h"

#include <QCoreApplication>
#include <QRegularExpression>

namespace handpiece::desktop {

namespace {

QString text(const char* source) {
    return QCoreApplication::translate("Notation", source);
}

struct Tooth {
    int quadrant,
        place;  ///< quadrant 1 to 4 (upper right, upper left, lower left, lower right), place from the midline
    bool primary;
};

std::optional<Tooth> split(int fdi) {
    const int quadrant = fdi / 10, place = fdi % 10;
    if (quadrant >= 1 && quadrant <= 4 && place >= 1 && place <= 8) return Tooth{quadrant, place, false};
    if (quadrant >= 5 && quadrant <= 8 && place >= 1 && place <= 5) return Tooth{quadrant - 4, place, true};
    return {};
}

int joined(const Tooth& tooth) {
    return (tooth.quadrant + (tooth.primary ? 4 : 0)) * 10 + tooth.place;
}

/// Position along the Universal count, from 0: upper right last molar to upper left, then lower left to lower right.
int universalIndex(const Tooth& tooth) {
    const int n = tooth.primary ? 5 : 8;
    switch (tooth.quadrant) {
        case 1:
            return n - tooth.place;
        case 2:
            return n + tooth.place - 1;
        case 3:
            return 3 * n - tooth.place;
        default:
            return 3 * n + tooth.place - 1;
    }
}

Tooth ofUniversalIndex(int index, bool primary) {
    const int n = primary ? 5 : 8, quadrant = index / n, within = index % n;
    const int place = quadrant == 0 || quadrant == 2 ? n - within : within + 1;
    return {quadrant + 1, place, primary};
}

/// The corner drawn beside the number: the mouth's cross as seen by the dentist, so upper right shows as its lower
/// right corner.
QChar corner(int quadrant) {
    switch (quadrant) {
        case 1:
            return QChar(0x23cc);  // corner at the lower right
        case 2:
            return QChar(0x23bf);  // lower left
        case 3:
            return QChar(0x23be);  // upper left
        default:
            return QChar(0x23cb);  // upper right
    }
}

QString placeText(const Tooth& tooth) {
    return tooth.primary ? QString(QChar(u'A' + tooth.place - 1)) : QString::number(tooth.place);
}

}  // namespace

QString toothLabel(int fdi, Notation notation) {
    const auto tooth = split(fdi);
    if (!tooth) return {};
    switch (notation) {
        case Notation::fdi:
            return QString::number(fdi);
        case Notation::universal: {
            const int index = universalIndex(*tooth);
            return tooth->primary ? QString(QChar(u'A' + index)) : QString::number(index + 1);
        }
        case Notation::palmer: {
            // The bracket stands on the side of the midline.
            const bool right = tooth->quadrant == 1 || tooth->quadrant == 4;
            return right ? placeText(*tooth) + corner(tooth->quadrant) : corner(tooth->quadrant) + placeText(*tooth);
        }
    }
    return {};
}

std::optional<int> toothOf(const QString& label, Notation notation) {
    const QString word = label.simplified().remove(QLatin1Char(' ')).toUpper();
    bool number = false;
    const int value = word.toInt(&number);
    if (notation == Notation::fdi) return number && split(value) ? std::optional(value) : std::nullopt;
    if (notation == Notation::universal) {
        if (number)
            return value >= 1 && value <= 32 ? std::optional(joined(ofUniversalIndex(value - 1, false))) : std::nullopt;
        const int letter = word.size() == 1 ? word[0].unicode() - u'A' : -1;
        return letter >= 0 && letter < 20 ? std::optional(joined(ofUniversalIndex(letter, true))) : std::nullopt;
    }
    for (int quadrant = 1; quadrant <= 4; ++quadrant) {
        static const char* const kNames[] = {"UR", "UL", "LL", "LR"};
        const QString name = QLatin1String(kNames[quadrant - 1]);
        QString rest = word;
        if (word.contains(corner(quadrant)))
            rest.remove(corner(quadrant));
        else if (word.startsWith(name))
            rest = word.mid(2);
        else if (word.endsWith(name))
            rest = word.chopped(2);
        else
            continue;
        if (rest.size() != 1) return {};
        const char16_t c = rest[0].unicode();
        if (c >= u'A' && c <= u'E') return joined({quadrant, c - u'A' + 1, true});
        if (c >= u'1' && c <= u'8') return joined({quadrant, c - u'0', false});
        return {};
    }
    return {};
}

QString toothName(int fdi) {
    const auto tooth = split(fdi);
    if (!tooth) return {};
    static const char* const kPermanent[] = {
        QT_TRANSLATE_NOOP("Notation", "central incisor"), QT_TRANSLATE_NOOP("Notation", "lateral incisor"),
        QT_TRANSLATE_NOOP("Notation", "canine"),          QT_TRANSLATE_NOOP("Notation", "first premolar"),
        QT_TRANSLATE_NOOP("Notation", "second premolar"), QT_TRANSLATE_NOOP("Notation", "first molar"),
        QT_TRANSLATE_NOOP("Notation", "second molar"),    QT_TRANSLATE_NOOP("Notation", "third molar")};
    static const char* const kPrimary[] = {
        QT_TRANSLATE_NOOP("Notation", "primary central incisor"),
        QT_TRANSLATE_NOOP("Notation", "primary lateral incisor"), QT_TRANSLATE_NOOP("Notation", "primary canine"),
        QT_TRANSLATE_NOOP("Notation", "primary first molar"), QT_TRANSLATE_NOOP("Notation", "primary second molar")};
    static const char* const kQuadrants[] = {
        QT_TRANSLATE_NOOP("Notation", "Upper right %1"), QT_TRANSLATE_NOOP("Notation", "Upper left %1"),
        QT_TRANSLATE_NOOP("Notation", "Lower left %1"), QT_TRANSLATE_NOOP("Notation", "Lower right %1")};
    return text(kQuadrants[tooth->quadrant - 1])
        .arg(text(tooth->primary ? kPrimary[tooth->place - 1] : kPermanent[tooth->place - 1]));
}

namespace {

std::vector<int> arch(int right, int left, int places) {
    std::vector<int> teeth;
    for (int place = places; place >= 1; --place)
        teeth.push_back(right * 10 + place);
    for (int place = 1; place <= places; ++place)
        teeth.push_back(left * 10 + place);
    return teeth;
}

}  // namespace

std::vector<int> upperArch(bool primary) {
    return primary ? arch(5, 6, 5) : arch(1, 2, 8);
}
std::vector<int> lowerArch(bool primary) {
    return primary ? arch(8, 7, 5) : arch(4, 3, 8);
}

QString tissueName(cases::Tissue tissue) {
    const auto text = [](const char* word) { return QCoreApplication::translate("Tissue", word); };
    using cases::Tissue;
    switch (tissue) {
        case Tissue::none:
            return text(QT_TRANSLATE_NOOP("Tissue", "None"));
        case Tissue::enamel:
            return text(QT_TRANSLATE_NOOP("Tissue", "Enamel"));
        case Tissue::dentine:
            return text(QT_TRANSLATE_NOOP("Tissue", "Dentine"));
        case Tissue::pulp:
            return text(QT_TRANSLATE_NOOP("Tissue", "Pulp"));
        case Tissue::caries:
            return text(QT_TRANSLATE_NOOP("Tissue", "Caries"));
        case Tissue::cementum:
            return text(QT_TRANSLATE_NOOP("Tissue", "Cementum"));
        case Tissue::gum:
            return text(QT_TRANSLATE_NOOP("Tissue", "Gingiva"));
        case Tissue::bone:
            return text(QT_TRANSLATE_NOOP("Tissue", "Bone"));
        case Tissue::neighbour:
            return text(QT_TRANSLATE_NOOP("Tissue", "Adjacent tooth"));
        case Tissue::restoration:
            return text(QT_TRANSLATE_NOOP("Tissue", "Filling"));
        case Tissue::demineralisedEnamel:
            return text(QT_TRANSLATE_NOOP("Tissue", "Demineralised enamel"));
        case Tissue::cariesSoft:
            return text(QT_TRANSLATE_NOOP("Tissue", "Soft carious dentine"));
        case Tissue::cariesSoftToLeathery:
            return text(QT_TRANSLATE_NOOP("Tissue", "Soft to leathery carious dentine"));
        case Tissue::cariesLeathery:
            return text(QT_TRANSLATE_NOOP("Tissue", "Leathery carious dentine"));
        case Tissue::cariesLeatheryToFirm:
            return text(QT_TRANSLATE_NOOP("Tissue", "Leathery to firm carious dentine"));
        case Tissue::cariesFirm:
            return text(QT_TRANSLATE_NOOP("Tissue", "Firm carious dentine"));
        case Tissue::cariesFirmToHard:
            return text(QT_TRANSLATE_NOOP("Tissue", "Firm to hard carious dentine"));
        case Tissue::stainedEnamel:
            return text(QT_TRANSLATE_NOOP("Tissue", "Stained enamel"));
        case Tissue::calculus:
            return text(QT_TRANSLATE_NOOP("Tissue", "Calculus"));
    }
    return {};
}

}  // namespace handpiece::desktop
