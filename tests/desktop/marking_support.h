// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A teacher's marking desk under the offscreen platform: an exercise on the egg, returned work, and the desk's widgets
/// by clicks and keys.

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QHeaderView>
#include <QLineEdit>
#include <QTabWidget>
#include <QTableView>
#include <QTreeWidget>

#include "desktop/features/marking/marking_feature.h"
#include "handpiece/base/core/file.h"
#include "shell_support.h"

namespace handpiece::desktop {

inline const char* const kLittleRubric = R"(
format = 1
id = "little"
version = "1"
status = "proposal"
pass_mark = 60
title = { en = "Take little" }
[[band]]
id = "little"
title = { en = "little" }
[[band]]
id = "much"
title = { en = "much" }
[[criterion]]
id = "enamel"
measure = "removed"
tissue = "enamel"
unit = "mm3"
weight = 80
knots = [[0.03, 100], [0.5, 0]]
bands = [{ id = "little", to = 0.06 }, { id = "much", from = 0.06 }]
title = { en = "enamel taken" }
[[criterion]]
id = "beside"
measure = "removed"
tissue = "dentine"
unit = "mm3"
weight = 20
knots = [[0, 100], [1, 0]]
critical = { above = 0.5 }
title = { en = "dentine taken" }
)";

class MarkingTest : public ShellTest {
  protected:
    template <class W>
    [[nodiscard]] W* part(const char* name) {
        W* found = window().findChild<W*>(QLatin1String(name));
        EXPECT_NE(found, nullptr) << name;
        return found;
    }
    [[nodiscard]] MarkingFeature& feature() { return *window().findChild<MarkingFeature*>(); }
    [[nodiscard]] const marking::Desk& desk() { return *feature().desk(); }
    /// Where exercise and works lie.
    [[nodiscard]] virtual std::filesystem::path root() const { return toPath(own_.path()); }
    [[nodiscard]] std::filesystem::path works() const { return root() / "works"; }
    [[nodiscard]] std::filesystem::path exercise() const { return root() / "exercise"; }

    void makeExercise() {
        tasks::Task task;
        task.id = "little";
        task.toothCase = eggTooth(46);
        task.voxelMm = 1e-3 * kVoxelUm;
        task.rubric = kLittleRubric;
        tasks::writeTask(task, exercise());
        std::filesystem::create_directories(works());
    }
    /// Two hand-ins of one sitting, its recording, and a file that is none.
    void makeWork() {
        makeExercise();
        CommandLine line;
        line.file = toQString(exercise() / "case");
        startWithTooth(line);
        simulator().setCode(QStringLiteral("S-07"));
        ASSERT_TRUE(idle());
        ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
        ASSERT_TRUE(cut());
        save("S-07-first.handpiece");
        ASSERT_TRUE(cut());
        ASSERT_TRUE(cut());
        save("S-08-second.handpiece");
        const std::filesystem::path recording = simulator().recording();
        simulator().close();
        std::filesystem::copy_file(recording, works() / "S-09.h5");
        core::writeFile(works() / "broken.handpiece", std::string_view("no zip"));
    }
    void save(const char* name) {
        file_ = toQString(works() / name);
        action("actionSaveAs")->trigger();
        ASSERT_TRUE(waitFor([this] { return std::filesystem::exists(toPath(file_)) && !simulator().isBusy(); }));
    }
    void click(const char* name) {
        auto* button = part<QAbstractButton>(name);
        ASSERT_TRUE(button->isEnabled()) << name;
        ASSERT_TRUE(button->isVisible()) << name;
        QTest::mouseClick(button, Qt::LeftButton, Qt::NoModifier, QPoint(8, button->height() / 2));
    }
    void type(const char* name, const QString& text) {
        auto* line = part<QLineEdit>(name);
        line->setFocus();
        line->selectAll();
        QTest::keyClicks(line, text);
    }
    void begin(const QString& marker, bool isBlind) {
        action("actionMarkingDesk")->trigger();
        ASSERT_TRUE(part<QDialog>("markingDesk")->isVisible());
        part<QTabWidget>("markingTabs")->setCurrentIndex(0);
        type("markingFolder", toQString(works()));
        type("markingExercise", toQString(exercise()));
        type("markingMarker", marker);
        if (part<QCheckBox>("markingBlind")->isChecked() != isBlind) click("markingBlind");
        click("markingBegin");
        ASSERT_TRUE(waitFor([this] { return !feature().isAtWork() || window().errorDialog() != nullptr; }));
    }
    [[nodiscard]] QTableView* table() { return part<QTableView>("markingTable"); }
    [[nodiscard]] QString cell(int row, int column) { return table()->model()->index(row, column).data().toString(); }
    [[nodiscard]] int rows() { return table()->model()->rowCount(); }
    [[nodiscard]] int rowOf(const QString& file) {
        for (int row = 0; row < rows(); ++row)
            if (cell(row, WorkTable::kFile) == file) return row;
        return -1;
    }
    void sortBy(int column) {
        QHeaderView* head = table()->horizontalHeader();
        QTest::mouseClick(
            head->viewport(), Qt::LeftButton, Qt::NoModifier,
            QPoint(head->sectionViewportPosition(column) + head->sectionSize(column) / 2, head->height() / 2));
    }
    void openRow(int row) {
        const QRect place = table()->visualRect(table()->model()->index(row, 0));
        QTest::mouseClick(table()->viewport(), Qt::LeftButton, Qt::NoModifier, place.center());
        click("markingOpen");
    }
    void chooseCriterion(int row) {
        auto* tree = part<QTreeWidget>("sheetCriteria");
        tree->scrollToItem(tree->topLevelItem(row));
        const QRect place = tree->visualItemRect(tree->topLevelItem(row));
        QTest::mouseClick(tree->viewport(), Qt::LeftButton, Qt::NoModifier,
                          QPoint(place.left() + 8, place.center().y()));
        ASSERT_EQ(tree->currentItem(), tree->topLevelItem(row));
    }
    void setPoints(double points) {
        auto* spin = part<QDoubleSpinBox>("sheetPoints");
        ASSERT_TRUE(spin->isVisible());
        spin->setFocus();
        spin->selectAll();
        QTest::keyClicks(spin, QString::number(points));
        QTest::keyClick(spin, Qt::Key_Tab);
        ASSERT_DOUBLE_EQ(spin->value(), points);
    }
    /// By the arrow keys.
    void chooseBand(int row) {
        auto* box = part<QComboBox>("sheetBand");
        ASSERT_TRUE(box->isVisible());
        box->setFocus();
        QTest::keyClick(box, Qt::Key_Home);
        for (int i = 0; i < row; ++i)
            QTest::keyClick(box, Qt::Key_Down);
        ASSERT_EQ(box->currentIndex(), row);
    }
    void keep(QWidget* widget, const char* name) {
        const char* folder = std::getenv("HANDPIECE_TEST_PICTURES");
        if (folder == nullptr) return;
        QTest::qWait(1500);  // for the picture to be drawn
        widget->grab().save(QString::fromLocal8Bit(folder) + QLatin1Char('/') + QLatin1String(name));
    }
};

}  // namespace handpiece::desktop
