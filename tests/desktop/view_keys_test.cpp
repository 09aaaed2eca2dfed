// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <QApplication>
#include <QLabel>
#include <QPushButton>
#include <algorithm>

#include "desktop/picture/help_card.h"
#include "desktop/picture/key_bindings_dialog.h"
#include "desktop/picture/latency.h"

namespace handpiece::desktop::view_keys_test {
namespace {

using namespace std::chrono_literals;

TEST(KeyBindings, NoKeyHasTwoMeaningsInEitherSet) {
    for (const auto set : {KeyBindings::Set::rightHanded, KeyBindings::Set::leftHanded}) {
        const KeyBindings bindings = KeyBindings::of(set);
        for (const KeyBindings::Conflict& conflict : bindings.conflicts())
            ADD_FAILURE() << infoOf(conflict.first).name << " and " << infoOf(conflict.second).name << " both on "
                          << conflict.binding.id().toStdString();
        for (const ActionInfo& info : actionInfos()) {
            EXPECT_FALSE(bindings.text(info.action).isEmpty()) << info.name;
            EXPECT_EQ(&infoOf(info.action), &info) << "the table is in the order of Action";
        }
    }
}

TEST(KeyBindings, EveryBindingSurvivesAsText) {
    for (const auto set : {KeyBindings::Set::rightHanded, KeyBindings::Set::leftHanded}) {
        const KeyBindings bindings = KeyBindings::of(set);
        for (const ActionInfo& info : actionInfos())
            for (const Binding& one : bindings.of(info.action)) {
                const auto back = Binding::fromId(one.id());
                ASSERT_TRUE(back) << one.id().toStdString();
                EXPECT_EQ(*back, one) << one.id().toStdString();
            }
        KeyBindings copy;
        EXPECT_TRUE(copy.fromMap(bindings.toMap()).isEmpty());
        EXPECT_EQ(copy, bindings);
    }
}

TEST(KeyBindings, BrokenSettingsAreRefusedByNameAndChangeNothing) {
    KeyBindings bindings;
    QVariantMap map;
    map["cut"] = QStringList{"key:A"};             // a mouse action takes no key
    map["fit"] = QStringList{"key:Nonsense key"};  // no such key
    map["zoom"] = QStringList{"Alt+wheel"};        // Alt belongs to the window manager
    map["no-such-action"] = QStringList{"key:A"};
    map["measure"] = QStringList{"key:A", "key:B", "key:Z"};  // more than there is room for
    QStringList refused = bindings.fromMap(map);
    refused.sort();
    EXPECT_EQ(refused, (QStringList{"cut", "fit", "measure", "no-such-action", "zoom"}));
    EXPECT_EQ(bindings, KeyBindings());

    EXPECT_FALSE(bindings.fromMap({{"measure", QStringList{"key:P"}}}).isEmpty()) << "P latches the pedal";
    EXPECT_EQ(bindings, KeyBindings());
    EXPECT_TRUE(bindings.fromMap({{"measure", QStringList{"key:Z"}}}).isEmpty());
    EXPECT_EQ(bindings.of(Action::measure)[0].id(), "key:Z");
}

TEST(KeyBindings, SettingsOfAnOlderProgramKeepWhatAPersonChose) {
    // Written before there was a key for the load, by somebody who measures with W.
    QVariantMap older = KeyBindings().toMap();
    for (const char* added : {"more-load", "less-load", "touch-key", "nearer", "farther"})
        older.remove(added);
    older["measure"] = QStringList{"key:W"};
    KeyBindings bindings;
    bindings.giveWayTo(older);
    EXPECT_TRUE(bindings.fromMap(older).isEmpty());
    EXPECT_EQ(bindings.of(Action::measure)[0].id(), "key:W");
    EXPECT_EQ(bindings.of(Action::moreLoad)[0].kind, Binding::Kind::none);
    EXPECT_EQ(bindings.of(Action::lessLoad)[0].id(), "key:S");
}

TEST(KeyBindings, ShiftBesideAStepMakesItFineAndElsewhereIsAnotherKey) {
    const KeyBindings bindings;
    const auto of = [&](const char* id) { return bindings.actionFor(*Binding::fromId(id)); };
    EXPECT_EQ(of("Shift+key:PgUp"), Action::retreat);
    EXPECT_EQ(of("Shift+key:Space"), Action::panHold);
    EXPECT_EQ(of("key:Space"), Action::orbitHold);
    EXPECT_EQ(of("Shift+button:right"), Action::pan);
    EXPECT_EQ(of("Shift+button:left"), Action::cut) << "slowly";
    EXPECT_EQ(of("Ctrl+button:left"), Action::touch);
    EXPECT_EQ(of("Ctrl+key:C"), std::nullopt) << "a menu's";
    EXPECT_EQ(of("Shift+key:D"), std::nullopt);
    QKeyEvent plus(QEvent::KeyPress, Qt::Key_Plus, Qt::ShiftModifier | Qt::KeypadModifier);
    EXPECT_EQ(bindings.actionFor(bindingOf(plus)), Action::faster);
}

TEST(KeyBindingsDialog, AsksBeforeItTakesAKeyFromAnotherAction) {
    KeyBindingsDialog dialog((KeyBindings()));
    const Binding p = *Binding::fromId("key:P");
    EXPECT_FALSE(dialog.assign(Action::measure, 0, p));
    EXPECT_EQ(dialog.bindings(), KeyBindings()) << "nothing changed yet";
    EXPECT_FALSE(dialog.findChild<QLabel*>("keyBindingsMessage")->text().isEmpty());
    EXPECT_FALSE(dialog.findChild<QPushButton*>("keyBindingsTakeOver")->isHidden());
    dialog.takeOver();
    EXPECT_EQ(dialog.bindings().of(Action::measure)[0], p);
    EXPECT_EQ(dialog.bindings().of(Action::latchPedal)[0].kind, Binding::Kind::none);
    EXPECT_TRUE(dialog.bindings().conflicts().empty());
    EXPECT_FALSE(dialog.assign(Action::cut, 0, *Binding::fromId("key:G"))) << "cut takes a button";
    EXPECT_TRUE(dialog.assign(Action::cut, 0, *Binding::fromId("Shift+button:left")));
    dialog.findChild<QPushButton*>("keyBindingsLeftHanded")->click();
    EXPECT_EQ(dialog.bindings(), KeyBindings::of(KeyBindings::Set::leftHanded));
}

TEST(HelpCard, ShowsTheKeysAsTheyAreBound) {
    QWidget window;
    window.resize(1000, 700);
    HelpCard card(&window);
    KeyBindings bindings;
    ASSERT_TRUE(bindings.set(Action::fit, 0, *Binding::fromId("key:G")));
    card.setBindings(bindings);
    EXPECT_TRUE(card.accessibleDescription().contains(infoOf(Action::fit).titleText() + ": G"));
    EXPECT_EQ(card.size(), window.size());
    const QImage plain = card.grab().toImage();
    card.setBindings(KeyBindings());
    EXPECT_NE(card.grab().toImage(), plain);
}

TEST(HelpCard, IsReadAsAWholeInSmallWindowsToo) {
    const HelpCard::Commands commands = {
        {"Undo", "Ctrl+Z"}, {"Redo", "Ctrl+Shift+Z"}, {"Reset the tooth", "Ctrl+Backspace"},
        {"Save", "Ctrl+S"}, {"Picture...", "Ctrl+P"}, {"Full screen", "F11"}};
    for (const auto set : {KeyBindings::Set::rightHanded, KeyBindings::Set::leftHanded})
        for (const QSize size :
             {QSize(1440, 900), QSize(1366, 768), QSize(1280, 720), QSize(1024, 700), QSize(600, 300)}) {
            QWidget window;
            window.resize(size);
            HelpCard card(&window);
            QFont font = card.font();
            font.setPointSizeF(10);
            card.setFont(font);
            card.setBindings(KeyBindings::of(set));
            card.setCommands(commands);
            EXPECT_TRUE(QRectF(QPointF(), QSizeF(size)).contains(card.cardArea())) << size.width();
            if (size.height() >= 700) {
                EXPECT_GE(card.letterPt(), 8.0) << size.width() << " x " << size.height();
            }
            EXPECT_TRUE(card.accessibleDescription().contains("Undo: Ctrl+Z"));
        }
}

TEST(LatencyMeter, CountsFromTheEventToThePictureOfATickThatKnewIt) {
    LatencyMeter meter;
    const LatencyMeter::Clock::time_point start{100s};
    // The tick's time 0 is our second 100; samples reach the reader 1 ms after their tick.
    for (int ms = 0; ms < 200; ++ms)
        meter.sampleSeen(ms * 1e-3, start + std::chrono::milliseconds(ms + 1));
    meter.target(start + 200ms);
    const auto shown = [&](double timeS, LatencyMeter::Clock::time_point at) {
        meter.presented({timeS, at - 6ms, at - 5ms, at - 2ms}, at);
    };
    shown(0.199, start + 205ms);
    EXPECT_EQ(meter.report().count, 0u) << "that tick was before the event";
    shown(0.2005, start + 208ms);
    EXPECT_EQ(meter.report().count, 0u) << "too close to be sure";
    shown(0.204, start + 220ms);
    ASSERT_EQ(meter.report().count, 1u);
    EXPECT_NEAR(meter.report().p50Ms, 20.0, 1e-6);
    // That tick's sample is of our 205th millisecond, told by the soonest.
    constexpr std::array kStagesMs{5.0, 9.0, 1.0, 3.0, 2.0};
    for (std::size_t i = 0; i < kStagesMs.size(); ++i) {
        EXPECT_NEAR(meter.report().stages[i].p50Ms, kStagesMs[i], 1e-6) << kLatencyStages[i];
        EXPECT_NEAR(meter.report().stages[i].inSlowestMs, kStagesMs[i], 1e-6) << kLatencyStages[i];
    }
    for (int i = 0; i < 99; ++i) {
        meter.target(start + 300ms);
        shown(0.310, start + 310ms);
    }
    EXPECT_NEAR(meter.report().p50Ms, 10.0, 1e-6);
    EXPECT_NEAR(meter.report().worstMs, 20.0, 1e-6);
    meter.reset();
    EXPECT_EQ(meter.report().count, 0u);
}

TEST(LatencyMeter, FollowsATickThatFallsBehind) {
    LatencyMeter meter;
    const LatencyMeter::Clock::time_point start{0s};
    meter.sampleSeen(0.0, start);
    // Half a second of periods is missed; nominal time stays behind by that for good.
    for (int ms = 500; ms < 6000; ++ms)
        meter.sampleSeen((ms - 500) * 1e-3, start + std::chrono::milliseconds(ms));
    meter.target(start + 6000ms);
    meter.presented({5.505, start + 6006ms, start + 6007ms, start + 6009ms}, start + 6010ms);
    ASSERT_EQ(meter.report().count, 1u);
    EXPECT_NEAR(meter.report().p50Ms, 10.0, 1e-6);
}

}  // namespace
}  // namespace handpiece::desktop::view_keys_test
