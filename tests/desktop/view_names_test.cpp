// SPDX-License-Identifier: Apache-2.0
// The whole window: every name belongs to one widget, and docs/desktop-objects.md tells what there is.
#include <QDialog>
#include <QFile>
#include <QMenu>
#include <QRegularExpression>
#include <QSet>

#include "shell_support.h"

namespace handpiece::desktop::view_names_test {
namespace {

class NamesTest : public ShellTest {
  protected:
    /// The arrows are those of every bar of tabs.
    static bool isQts(const QString& name) {
        return name.startsWith(QLatin1String("qt_")) || name == QLatin1String("ScrollLeftButton") ||
               name == QLatin1String("ScrollRightButton");
    }
    /// What the widgets under `root` are called, but for Qt's own; how often.
    static QMap<QString, int> namesUnder(const QObject& root) {
        QMap<QString, int> names;
        for (const QWidget* widget : root.findChildren<QWidget*>())
            if (const QString name = widget->objectName(); !name.isEmpty() && !isQts(name)) ++names[name];
        return names;
    }
    static void expectUnique(const QObject& root, const char* where) {
        const QMap<QString, int> names = namesUnder(root);
        for (auto it = names.begin(); it != names.end(); ++it)
            EXPECT_EQ(it.value(), 1) << it.key().toStdString() << ", " << where;
    }
    static QString guide() {
        QFile file(QStringLiteral(HANDPIECE_DESKTOP_OBJECTS));
        return file.open(QIODevice::ReadOnly) ? QString::fromUtf8(file.readAll()) : QString();
    }
    /// The names in the guide; of `drive_NAME` what stands before the placeholder.
    static QSet<QString> told(QSet<QString>& families) {
        static const QRegularExpression code(QStringLiteral("`([^`]+)`")),
            placeholder(QStringLiteral("^([A-Za-z]+_)[A-Z]+(_[A-Z]+)*$"));
        QSet<QString> names;
        for (auto all = code.globalMatch(guide()); all.hasNext();) {
            const QString name = all.next().captured(1);
            names << name;
            if (const auto family = placeholder.match(name); family.hasMatch()) families << family.captured(1);
        }
        families << QStringLiteral("actionPanel_") << QStringLiteral("actionRecent_");
        return names;
    }
};

TEST_F(NamesTest, EveryNameBelongsToOneWidget) {
    startWithTooth();
    for (const Detail detail : {Detail::practice, Detail::laboratory, Detail::paper}) {
        window().setDetail(detail);
        view()->setTool(Tool::section);
        view()->toggleHelpCard();
        expectUnique(window(), "with the card of keys and a section");
        view()->toggleHelpCard();
        QTest::qWait(20);
    }
    // Dialogs come into the window, too.
    for (const char* name : {"actionChooseTooth", "actionBindings", "actionCode", "actionAbout", "actionRecover"}) {
        // Some have a loop of their own: a timer looks for them.
        bool seen = false;
        QTimer look;
        QObject::connect(&look, &QTimer::timeout, [&] {
            for (QDialog* dialog : window().findChildren<QDialog*>()) {
                if (!dialog->isVisible()) continue;
                if (!seen) expectUnique(window(), name);
                seen = true;
                dialog->reject();
            }
        });
        look.start(20);
        action(name)->trigger();
        EXPECT_TRUE(waitFor([&] { return seen; })) << name;
    }
}

TEST_F(NamesTest, TheGuideTellsEveryName) {
    startWithTooth();
    QSet<QString> families;
    const QSet<QString> names = told(families);
    ASSERT_GT(names.size(), 100);
    const auto known = [&](const QString& name) {
        return names.contains(name) || std::any_of(families.begin(), families.end(),
                                                   [&](const QString& family) { return name.startsWith(family); });
    };
    const QMap<QString, int> widgets = namesUnder(window());
    for (auto it = widgets.begin(); it != widgets.end(); ++it)
        EXPECT_TRUE(known(it.key())) << "not in docs/desktop-objects.md: " << it.key().toStdString();
    const auto plain = [](const QString& text) { return QString(text).replace(QLatin1Char('|'), QLatin1String("")); };
    const QString text = guide();
    for (const QAction* command : window().findChildren<QAction*>()) {
        const QString name = command->objectName();
        if (name.isEmpty() || name.startsWith(QLatin1String("_q_"))) continue;
        EXPECT_TRUE(known(name)) << "not in docs/desktop-objects.md: " << name.toStdString();
        if (!window().commands().all().contains(const_cast<QAction*>(command))) continue;
        const QString row = QStringLiteral("| `%1` | %2 | %3 | %4 |")
                                .arg(name, plain(command->text()), plain(command->statusTip()),
                                     command->shortcut().toString(QKeySequence::PortableText));
        EXPECT_TRUE(text.contains(row)) << "the guide has another row for: " << row.toStdString();
    }
    // And the other way round: what the guide tells of the window's parts is there.
    for (const QString& name : names)
        if (name.startsWith(QLatin1String("action")) && !name.contains(QLatin1Char('_'))) {
            EXPECT_TRUE(window().findChild<QAction*>(name)) << "only in the guide: " << name.toStdString();
        }
}

TEST_F(NamesTest, F10OpensTheMenus) {
    startWithTooth();
    window().activateWindow();
    ASSERT_TRUE(QTest::qWaitForWindowActive(&window(), 60000));
    view()->setFocus();
    QTest::keyClick(view(), Qt::Key_F10);
    QWidget* open = QApplication::activePopupWidget();
    ASSERT_TRUE(open);
    EXPECT_EQ(open->objectName(), QStringLiteral("menuFile"));
    open->close();
}

}  // namespace
}  // namespace handpiece::desktop::view_names_test
