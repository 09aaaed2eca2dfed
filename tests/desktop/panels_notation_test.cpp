// SPDX-License-Identifier: Apache-2.0
#include <QtTest>

#include "desktop/widgets/notation.h"

using namespace handpiece::desktop;

/// Against the tables as published (ADA; ISO 3950), typed out whole.
class PanelsNotationTest : public QObject {
    Q_OBJECT
  private slots:
    void universalPermanent() {
        const int fdi[32] = {18, 17, 16, 15, 14, 13, 12, 11, 21, 22, 23, 24, 25, 26, 27, 28,
                             38, 37, 36, 35, 34, 33, 32, 31, 41, 42, 43, 44, 45, 46, 47, 48};
        for (int i = 0; i < 32; ++i) {
            QCOMPARE(toothLabel(fdi[i], Notation::universal), QString::number(i + 1));
            QCOMPARE(toothOf(QString::number(i + 1), Notation::universal).value_or(0), fdi[i]);
        }
    }
    void universalPrimary() {
        const int fdi[20] = {55, 54, 53, 52, 51, 61, 62, 63, 64, 65, 75, 74, 73, 72, 71, 81, 82, 83, 84, 85};
        for (int i = 0; i < 20; ++i) {
            QCOMPARE(toothLabel(fdi[i], Notation::universal), QString(QChar('A' + i)));
            QCOMPARE(toothOf(QString(QChar('a' + i)), Notation::universal).value_or(0), fdi[i]);
        }
    }
    void palmer() {
        // The bracket is drawn on the midline's side: for the upper right after the number, its corner at the lower
        // right.
        QCOMPARE(toothLabel(16, Notation::palmer), QString("6") + QChar(0x23cc));
        QCOMPARE(toothLabel(26, Notation::palmer), QChar(0x23bf) + QString("6"));
        QCOMPARE(toothLabel(36, Notation::palmer), QChar(0x23be) + QString("6"));
        QCOMPARE(toothLabel(46, Notation::palmer), QString("6") + QChar(0x23cb));
        QCOMPARE(toothLabel(75, Notation::palmer), QChar(0x23be) + QString("E"));
        QCOMPARE(toothOf("LR6", Notation::palmer).value_or(0), 46);
        QCOMPARE(toothOf("6 lr", Notation::palmer).value_or(0), 46);
        QCOMPARE(toothOf("UL E", Notation::palmer).value_or(0), 65);
    }
    void everyLabelComesBack() {
        for (const bool primary : {false, true})
            for (const auto& arch : {upperArch(primary), lowerArch(primary)})
                for (const int fdi : arch)
                    for (const auto notation : {Notation::fdi, Notation::universal, Notation::palmer})
                        QCOMPARE(toothOf(toothLabel(fdi, notation), notation).value_or(0), fdi);
    }
    void whatIsNoTooth() {
        for (const int fdi : {0, 10, 19, 49, 50, 56, 86, 91, -11, 111})
            QVERIFY(toothLabel(fdi, Notation::fdi).isEmpty());
        for (const char* label : {"", "0", "33", "U", "XX", "1.5"})
            QVERIFY(!toothOf(label, Notation::universal));
        for (const char* label : {"", "19", "56", "A"})
            QVERIFY(!toothOf(label, Notation::fdi));
        for (const char* label : {"", "6", "LR9", "LR0", "LRF", "LR66"})
            QVERIFY(!toothOf(label, Notation::palmer));
    }
    void arches() {
        QCOMPARE(upperArch(false).size(), std::size_t(16));
        QCOMPARE(lowerArch(true).size(), std::size_t(10));
        QCOMPARE(upperArch(false).front(), 18);
        QCOMPARE(lowerArch(false).front(), 48);
        QCOMPARE(toothName(46), QString("Lower right first molar"));
        QCOMPARE(toothName(61), QString("Upper left primary central incisor"));
    }
};

QTEST_GUILESS_MAIN(PanelsNotationTest)
#include "panels_notation_test.moc"
