// SPDX-License-Identifier: Apache-2.0
// What scripts are told of eye, hand and tooth is what the window has.
#include <fmt/format.h>

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QMessageBox>

#include "desktop/program/hand_map.h"
#include "desktop/program/widget_map.h"
#include "handpiece/model/tooth/state_delta.h"
#include "shell_support.h"

namespace handpiece::desktop::hand_map_test {
namespace {

core::Vec3 vecOf(const QJsonValue& value) {
    const QJsonArray a = value.toArray();
    return {a[0].toDouble(), a[1].toDouble(), a[2].toDouble()};
}

class HandMapTest : public ShellTest {
  protected:
    [[nodiscard]] QString hash() {
        return QString::fromStdString(fmt::format("{:016x}", tooth::stateHash(simulator().tooth()->state({}))));
    }
    /// At rest the second asking has it.
    [[nodiscard]] QString hashTold(HandMap& map) {
        QString told;
        EXPECT_TRUE(waitFor([&] {
            told = map.now().value("stateHash").toString();
            return !told.isEmpty();
        }));
        return told;
    }
};

TEST_F(HandMapTest, TellsEyeAndHandAsTheyAre) {
    startWithTooth();
    ASSERT_TRUE(idle());
    HandMap map(*host_);
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 0; }));
    view()->setLoad(1.7);
    view()->setStop(0.9);
    const QJsonObject told = map.now();
    EXPECT_EQ(told.value("mode").toString(), "live");
    const QJsonObject camera = told.value("camera").toObject();
    EXPECT_EQ(vecOf(camera.value("eyeMm")), view()->camera().eyeMm);
    EXPECT_EQ(vecOf(camera.value("targetMm")), view()->camera().targetMm);
    EXPECT_EQ(told.value("viewport").toArray(), QJsonArray({view()->width(), view()->height()}));
    EXPECT_DOUBLE_EQ(told.value("loadN").toDouble(), 1.7);
    EXPECT_DOUBLE_EQ(told.value("stopMm").toDouble(), 0.9);
    EXPECT_FALSE(told.value("pressed").toBool());
    EXPECT_TRUE(told.value("isDrill").toBool());
    EXPECT_EQ(told.value("bur").toString(), simulator().burName());
    const core::Box box = simulator().tooth()->model().outer.bounds();
    EXPECT_LT((vecOf(told.value("toothMm").toArray()[0]) - box.min).norm(), 1e-9);
    EXPECT_LT((vecOf(told.value("toothMm").toArray()[1]) - box.max).norm(), 1e-9);
    view()->setStop(std::nullopt);
    view()->setCompare(true);
    const QJsonObject halves = map.now();
    EXPECT_FALSE(halves.contains("stopMm"));
    EXPECT_EQ(halves.value("viewport").toArray()[0].toInt(), view()->width() / 2);
}

TEST_F(HandMapTest, TheHashIsTheToothsAndComesBackWithUndo) {
    startWithTooth();
    ASSERT_TRUE(idle());
    HandMap map(*host_);
    const QString whole = hashTold(map);
    EXPECT_EQ(whole, hash());
    ASSERT_TRUE(cut());
    const QString cutOnce = hashTold(map);
    EXPECT_EQ(cutOnce, hash());
    EXPECT_NE(cutOnce, whole);
    EXPECT_EQ(map.now().value("undoSteps").toInt(), 1);
    ASSERT_TRUE(undoAll());
    EXPECT_EQ(hashTold(map), whole);
    EXPECT_EQ(map.now().value("redoSteps").toInt(), 1);
}

TEST_F(HandMapTest, AWidgetMapTellsWindowsAndTheButtonsOfAQuestion) {
    start();
    const QString file = own_.filePath(QStringLiteral("map.json"));
    writeWidgetMap(&window(), file, [] { return QJsonObject{{"mode", "as asked"}}; });
    QMessageBox box(QMessageBox::Question, "title", "text", QMessageBox::Save | QMessageBox::Discard, &window());
    box.setObjectName("aQuestion");
    box.open();
    QJsonObject told;
    ASSERT_TRUE(waitFor([&] {
        QFile in(file);
        if (in.open(QIODevice::ReadOnly)) told = QJsonDocument::fromJson(in.readAll()).object();
        return told.value("windows").toArray().contains("aQuestion");
    }));
    EXPECT_TRUE(told.value("windows").toArray().contains("mainWindow"));
    EXPECT_TRUE(told.value("places").toObject().contains("button/Discard"));
    EXPECT_EQ(told.value("hand").toObject().value("mode").toString(), "as asked");
}

}  // namespace
}  // namespace handpiece::desktop::hand_map_test
