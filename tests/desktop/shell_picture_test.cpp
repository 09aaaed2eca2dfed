// SPDX-License-Identifier: Apache-2.0
// What a person at work meets around the picture: it stays where it is, and what is told of the tooth is so.
#include <QCheckBox>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QListView>
#include <QSet>
#include <QSortFilterProxyModel>
#include <QTableWidget>
#include <fstream>
#include <sstream>

#include "desktop/features/drill/bur_list.h"
#include "desktop/features/drill/drill_bar.h"
#include "desktop/features/drill/welcome_strip.h"
#include "desktop/features/files/mend_dialog.h"
#include "desktop/framework/job_strip.h"
#include "desktop/widgets/force_gauge.h"
#include "desktop/widgets/notice_bar.h"
#include "desktop/widgets/press_words.h"
#include "handpiece/app/input/pointer_controller.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "shell_support.h"

namespace handpiece::desktop::shell_picture_test {
namespace {

namespace fs = std::filesystem;

class PictureTest : public ShellTest {
  protected:
    /// Where the picture lies in the window.
    [[nodiscard]] QRect place() {
        for (int k = 0; k < 5; ++k)
            QApplication::processEvents();
        return {view()->mapTo(&window(), QPoint(0, 0)), view()->size()};
    }
    [[nodiscard]] NoticeBar* notices() { return window().findChild<NoticeBar*>(); }
    [[nodiscard]] double pulpMm3() {
        return simulator().sample().removedMm3[static_cast<std::size_t>(cases::Tissue::pulp)];
    }
};

TEST_F(PictureTest, NothingTheWindowTellsMovesThePicture) {
    startWithTooth();
    ASSERT_TRUE(idle());
    const QStringList ids = noticeIds();
    ASSERT_GT(ids.size(), 25);
    const QString longText(400, QLatin1Char('w'));
    for (const QSize size : {QSize(1440, 900), QSize(1024, 700)}) {
        window().resize(size);
        for (const Detail detail : {Detail::practice, Detail::laboratory, Detail::paper}) {
            window().setDetail(detail);
            const QRect before = place();
            const auto same = [&](const QString& when) {
                EXPECT_EQ(place(), before)
                    << when.toStdString() << ", layout " << static_cast<int>(detail) << ", " << size.width() << " wide";
                EXPECT_EQ(window().size(), size) << when.toStdString();
            };
            for (const QString& id : ids) {
                window().notices().tell(*noticeOf(id), {longText, longText});
                EXPECT_TRUE(notices()->isVisible());
                same(id);
                notices()->remove(id);
                same(id + QStringLiteral(" gone"));
            }
            for (const QString& id : ids)
                window().notices().tell(*noticeOf(id), {longText, longText});
            same(QStringLiteral("all notices"));
            notices()->clear();
            auto* welcome = window().findChild<WelcomeStrip*>();
            for (const auto step : {WelcomeStrip::Step::hover, WelcomeStrip::Step::cut, WelcomeStrip::Step::orbit,
                                    WelcomeStrip::Step::zoom, WelcomeStrip::Step::undo}) {
                welcome->markDone(step);
                same(QStringLiteral("a first step"));
            }
            EXPECT_FALSE(welcome->isVisible());
            welcome->setDone({});
            same(QStringLiteral("the first steps again"));
            auto* job = window().findChild<JobStrip*>();
            job->begin(longText);
            ASSERT_TRUE(waitFor([&] { return job->isVisible(); }));
            same(QStringLiteral("long work"));
            job->end();
            window().tellSaved(QStringLiteral("/tmp/") + longText);
            window().notices().tell(Notice::pulpExposed);
            window().tellSaved(QStringLiteral("/tmp/") + longText);
            same(QStringLiteral("saved"));
            notices()->clear();
            same(QStringLiteral("the end"));
        }
    }
}

TEST_F(PictureTest, AMessageLiesOverThePictureAndAPressOnItCutsNothing) {
    startWithTooth();
    window().notices().tell(Notice::pulpExposed);
    (void)place();
    const QRect strip(notices()->mapTo(&window(), QPoint(0, 0)), notices()->size());
    EXPECT_TRUE(place().contains(strip));
    QTest::mousePress(notices(), Qt::LeftButton, Qt::NoModifier, QPoint(2, notices()->height() / 2));
    EXPECT_FALSE(view()->hand()->isPressed());
    QTest::mouseRelease(notices(), Qt::LeftButton, Qt::NoModifier, QPoint(2, notices()->height() / 2));
    // Two strips lie one below the other.
    auto* welcome = window().findChild<WelcomeStrip*>();
    ASSERT_TRUE(welcome->isVisible());
    EXPECT_FALSE(welcome->geometry().intersects(notices()->geometry()));
}

TEST_F(PictureTest, AToothThatWasResetHasNoOpenPulp) {
    startWithTooth();
    view()->setLoad(input::kMaxLoadN);
    // Straight down to the pulp.
    view()->setStop(std::nullopt);
    view()->setPerPass(std::nullopt);
    view()->showStandardView(view::StandardView::occlusal);
    const QPoint middle = view()->rect().center();
    ASSERT_TRUE(cut());
    const QRect before = place();
    QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, middle);
    ASSERT_TRUE(waitFor([&] { return notices()->current() == QLatin1String("pulp-exposed"); })) << pulpMm3();
    EXPECT_EQ(place(), before);
    // The message about a device's force is for those who hold a device.
    EXPECT_FALSE(notices()->current() == QLatin1String("force-limited"));
    QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, middle);
    ASSERT_TRUE(waitFor([&] { return !simulator().status().inStroke && action("actionReset")->isEnabled(); }));
    // On a busy machine the bur may touch once more on its way up: what it cuts then would come after the reset.
    const double upS = simulator().status().timeS;
    ASSERT_TRUE(waitFor([&] { return simulator().status().timeS > upS + 0.5 && !simulator().status().inStroke; }));
    EXPECT_EQ(notices()->current(), QLatin1String("pulp-exposed"));
    action("actionReset")->trigger();
    ASSERT_TRUE(waitFor([&] { return removedMm3() == 0.0; }));
    EXPECT_TRUE(waitFor([&] { return notices()->current() != QLatin1String("pulp-exposed"); }));
    action("actionUndo")->trigger();
    ASSERT_TRUE(waitFor([&] { return pulpMm3() > 1e-5; }));
    EXPECT_TRUE(waitFor([&] { return notices()->current() == QLatin1String("pulp-exposed"); }));
    // Another tooth has nothing of it.
    openTooth(11);
    ASSERT_TRUE(waitFor([&] { return simulator().toothCase()->kind == "upper-central-incisor"; }));
    EXPECT_NE(notices()->current(), QLatin1String("pulp-exposed"));
}

/// One view, one name: in the menus, on the panel's buttons, on the card of keys; in every language.
TEST_F(PictureTest, AViewHasOneName) {
    for (const char* language : {"en", "ja"}) {
        CommandLine line;
        line.language = QLatin1String(language);
        start(line);
        const std::tuple<const char*, const char*, Action> views[] = {
            {"actionViewOcclusal", "viewOcclusal", Action::viewOcclusal},
            {"actionViewBuccal", "viewBuccal", Action::viewBuccal},
            {"actionViewLingual", "viewLingual", Action::viewLingual},
            {"actionViewMesial", "viewMesial", Action::viewMesial},
            {"actionViewDistal", "viewDistal", Action::viewDistal},
            {"actionViewOblique", "viewOblique", Action::viewOblique}};
        for (const auto& [command, button, key] : views) {
            const QString name = action(command)->text();
            EXPECT_EQ(window().findChild<QAbstractButton*>(button)->text(), name) << language;
            EXPECT_EQ(infoOf(key).titleText(), name) << language;
        }
        EXPECT_EQ(infoOf(Action::fit).titleText(), action("actionFit")->text()) << language;
        EXPECT_EQ(infoOf(Action::goToBur).titleText(), action("actionGoToBur")->text()) << language;
        const auto* panel = window().findChild<QComboBox*>("sectionOrientation");
        for (const auto& [direction, at] :
             {std::pair(SectionPlace::Direction::buccoLingual, 0), std::pair(SectionPlace::Direction::mesioDistal, 1),
              std::pair(SectionPlace::Direction::horizontal, 2)})
            EXPECT_EQ(panel->itemText(at), directionName(direction)) << language;
    }
}

TEST_F(PictureTest, AnOpenSurfaceIsMendedWhenAskedAndWrittenWhereOneSays) {
    geometry::TriangleMesh open = eggTooth(46).outer;
    open.triangles.pop_back();
    geometry::writeStl(at("open.stl"), open);
    const auto size = fs::file_size(at("open.stl"));
    startWithTooth();
    window().openFile(own_.filePath("open.stl"));
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    EXPECT_EQ(window().errorDialog()->problem().id, "not-closed");
    auto* mend = window().errorDialog()->findChild<QAbstractButton*>("errorMend");
    ASSERT_TRUE(mend);
    mend->click();
    QAbstractButton* save = nullptr;
    ASSERT_TRUE(waitFor([&] {
        save = window().findChild<QAbstractButton*>("mendSave");
        return save && save->isEnabled();
    }));
    const QString told = window().findChild<QLabel*>("mendText")->text();
    EXPECT_TRUE(told.contains("Holes closed: 1")) << told.toStdString();
    EXPECT_TRUE(told.contains(QString::fromUtf8("mm²"))) << told.toStdString();
    EXPECT_FALSE(fs::exists(at("open-mended.stl")));
    file_ = {};  // not yet
    save->click();
    EXPECT_FALSE(fs::exists(at("open-mended.stl")));
    file_ = own_.filePath("closed.stl");
    save->click();
    ASSERT_TRUE(waitFor([this] { return simulator().document().name == "closed" && !simulator().isBusy(); }));
    EXPECT_TRUE(view()->hasTooth());
    EXPECT_EQ(fs::file_size(at("open.stl")), size);
    // What mending does not help against has no such button.
    std::ofstream(at("nothing.stl")) << "solid nothing\nendsolid nothing\n";
    window().openFile(own_.filePath("nothing.stl"));
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    EXPECT_FALSE(window().errorDialog()->findChild<QAbstractButton*>("errorMend"));
}

TEST_F(PictureTest, AnOpenArchIsOfferedAFlatBase) {
    geometry::TriangleMesh open = eggTooth(46).outer;
    const double middleMm = open.bounds().centre().z();
    std::erase_if(open.triangles, [&](const geometry::Triangle& t) { return open.vertices[t[0]].z() < middleMm; });
    geometry::writeStl(at("half.stl"), open);
    MendDialog dialog(at("half.stl"), nullptr);
    dialog.setAttribute(Qt::WA_DeleteOnClose, false);
    dialog.show();
    const auto* text = dialog.findChild<QLabel*>("mendText");
    auto* base = dialog.findChild<QCheckBox*>("mendBase");
    const auto* save = dialog.findChild<QAbstractButton*>("mendSave");
    ASSERT_TRUE(text && base && save);
    EXPECT_FALSE(base->isVisible());
    ASSERT_TRUE(waitFor([&] { return save->isEnabled(); }));
    EXPECT_TRUE(text->text().contains("flat base")) << text->text().toStdString();
    ASSERT_TRUE(base->isVisible());
    base->click();
    EXPECT_FALSE(save->isEnabled());
    ASSERT_TRUE(waitFor([&] { return save->isEnabled(); })) << text->text().toStdString();
    EXPECT_TRUE(text->text().contains("Stood on a flat base of")) << text->text().toStdString();
    EXPECT_FALSE(text->text().contains("Much of this surface")) << text->text().toStdString();
    EXPECT_TRUE(base->isVisible() && base->isEnabled());
}

TEST_F(PictureTest, WhatWasLeftOutOfAFileIsNoticed) {
    geometry::writeStl(at("glued.stl"), eggTooth(46).outer);
    // A second file behind the first.
    std::stringstream whole;
    whole << std::ifstream(at("glued.stl"), std::ios::binary).rdbuf();
    std::ofstream(at("glued.stl"), std::ios::binary | std::ios::app) << whole.str();
    startWithTooth();
    window().openFile(own_.filePath("glued.stl"));
    auto* notices = window().findChild<NoticeBar*>();
    ASSERT_TRUE(notices);
    EXPECT_TRUE(waitFor([&] { return notices->current() == "file-left-out"; })) << notices->current().toStdString();
    const QString told = window().findChild<QLabel*>("noticeText")->text();
    EXPECT_TRUE(told.contains("glued.stl") && told.contains("first of 2 STL files")) << told.toStdString();
    EXPECT_TRUE(waitFor([this] { return simulator().document().name == "glued" && !simulator().isBusy(); }));
    // Of another file it says nothing.
    geometry::writeStl(at("whole.stl"), eggTooth(46).outer);
    window().openFile(own_.filePath("whole.stl"));
    EXPECT_TRUE(waitFor([this] { return simulator().document().name == "whole" && !simulator().isBusy(); }));
    EXPECT_NE(notices->current(), "file-left-out");
}

TEST_F(PictureTest, AnOwnBurHasItsPictureAndItsName) {
    const auto made = instrument::makeInstrument("330");
    geometry::writeStl(at("my-pear.stl"), made.bur->mesh());
    startWithTooth();
    simulator().setBur(own_.filePath("my-pear.stl"));
    EXPECT_EQ(window().findChild<QLabel*>("burInHand")->text(), QStringLiteral("my-pear"));
    const auto* shown = qobject_cast<const QSortFilterProxyModel*>(window().findChild<QListView*>("burList")->model());
    const auto* burs = qobject_cast<const BurModel*>(shown->sourceModel());
    const int row = burs->rowOf(own_.filePath("my-pear.stl"));
    ASSERT_GE(row, 0);
    EXPECT_EQ(burs->index(row).data(BurModel::titleRole).toString(), QStringLiteral("my-pear"));
    EXPECT_NEAR(burs->face(row).diameterMm, 2.0 * made.bur->maxRadiusMm(), 0.02);
    EXPECT_FALSE(burs->face(row).outline.isEmpty());
}

TEST_F(PictureTest, NoTissueIsElidedInASmallWindow) {
    startWithTooth();
    window().resize(1024, 700);
    window().setDetail(Detail::laboratory);
    (void)place();
    auto* table = window().findChild<QTableWidget*>("tissueTable");
    ASSERT_GT(table->rowCount(), 2);
    EXPECT_LE(table->horizontalHeader()->length(), table->viewport()->width());
    for (int row = 0; row < table->rowCount(); ++row)
        for (int column = 0; column < table->columnCount(); ++column) {
            const QString text = table->item(row, column)->text();
            EXPECT_LE(QFontMetrics(table->font()).horizontalAdvance(text) + 6, table->columnWidth(column))
                << text.toStdString();
        }
}

TEST_F(PictureTest, TheForceOfAMouseIsNoDevicesLimit) {
    startWithTooth();
    EXPECT_FALSE(simulator().givesForce());
    view()->setLoad(input::kMaxLoadN);
    QSet<QString> told;
    QObject::connect(&simulator(), &Simulator::noticed, view(), [&](const QString& id) { told << id; });
    ASSERT_TRUE(cut());
    const QPoint middle = view()->rect().center();
    QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, middle);
    const std::uint64_t from = simulator().sample().tick;
    bool limited = false, stalled = false;
    double leastRpm = 1e9;
    auto* gauge = window().findChild<ForceGauge*>();
    ASSERT_TRUE(waitFor([&] {
        const messages::HapticSample& now = simulator().sample();
        limited = limited || (now.flags & messages::kForceLimited) != 0;
        stalled = stalled || (now.flags & messages::kStalled) != 0;
        if ((now.flags & messages::kCutting) != 0) leastRpm = std::min(leastRpm, now.speedRpm);
        EXPECT_NE(gauge->words(), QStringLiteral("More than the device gives"));
        return simulator().sample().tick > from + 4000;
    }));
    QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, middle);
    EXPECT_FALSE(told.contains(QStringLiteral("force-limited"))) << (limited ? "limited" : "never limited");
    // As the guide says: all that a mouse presses slows the turbine with a 330, and does not stop it.
    EXPECT_FALSE(stalled);
    EXPECT_LT(leastRpm, 0.99 * 400000.0);
    EXPECT_GT(leastRpm, 0.4 * 400000.0);
    RecordProperty("leastRpm", std::to_string(leastRpm));
    std::printf("330 at 3 N: %.0f rpm at least while cutting\n", leastRpm);
}

}  // namespace
}  // namespace handpiece::desktop::shell_picture_test
