// SPDX-License-Identifier: Apache-2.0
// The window in Japanese: every text has its translation, the program shows it, and without the file it speaks English.
#include <QComboBox>
#include <QDockWidget>
#include <QFile>
#include <QGroupBox>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QProcess>
#include <QRegularExpression>
#include <QTableWidget>
#include <QToolBar>
#include <QXmlStreamReader>
#include <map>
#include <set>

#include "desktop/framework/language.h"
#include "shell_support.h"

// These speak of the global namespace.
static void removeTranslations() {
    Q_CLEANUP_RESOURCE(translations);
}
static void bringTranslationsBack() {
    Q_INIT_RESOURCE(translations);
}

namespace handpiece::desktop::translation_test {
namespace {

using Key = std::pair<QString, QString>;  // context, source
struct Entry {
    QString translation, type;
    bool counts = false;  // %n
};
struct Ts {
    QString language, error;
    std::map<Key, Entry> entries;
};

Ts readTs(const QString& path) {
    Ts ts;
    QFile file(path);
    if (!file.open(QIODevice::ReadOnly)) {
        ts.error = file.errorString();
        return ts;
    }
    QXmlStreamReader xml(&file);
    QString context, source;
    Entry entry;
    while (!xml.atEnd()) {
        const auto token = xml.readNext();
        if (token == QXmlStreamReader::StartElement) {
            if (xml.name() == QLatin1String("TS")) ts.language = xml.attributes().value("language").toString();
            if (xml.name() == QLatin1String("name")) context = xml.readElementText();
            if (xml.name() == QLatin1String("message"))
                entry = {{}, {}, xml.attributes().value("numerus") == QLatin1String("yes")};
            if (xml.name() == QLatin1String("source")) source = xml.readElementText();
            if (xml.name() == QLatin1String("translation")) {
                entry.type = xml.attributes().value("type").toString();
                entry.translation = xml.readElementText(QXmlStreamReader::IncludeChildElements);
                if (entry.counts) entry.translation = entry.translation.trimmed();  // Japanese has one form
            }
        } else if (token == QXmlStreamReader::EndElement && xml.name() == QLatin1String("message")) {
            ts.entries[{context, source}] = entry;
        }
    }
    if (xml.hasError()) ts.error = xml.errorString();
    return ts;
}

const Ts& japanese() {
    static const Ts ts = readTs(QStringLiteral(HANDPIECE_TRANSLATIONS "/handpiece_ja.ts"));
    return ts;
}

bool isJapanese(const QString& text) {
    static const QRegularExpression signs(QStringLiteral("[\\x{3040}-\\x{30ff}\\x{4e00}-\\x{9fff}]"));
    return text.contains(signs);
}

/// %1, %L2, %n and tags, sorted: what must be the same on both sides.
QStringList fixedParts(const QString& text) {
    static const QRegularExpression parts(QStringLiteral("%L?\\d+|%n|</?\\w+>|&(?=\\w)|\\*\\.\\w+|\n"));
    QStringList found;
    for (auto it = parts.globalMatch(text); it.hasNext();)
        found << it.next().captured();
    found.sort();
    return found;
}

std::string said(const Key& key) {
    return (key.first + QStringLiteral(": \"") + key.second + QLatin1Char('"')).toStdString();
}

TEST(Translation, IsComplete) {
    const Ts& ts = japanese();
    ASSERT_TRUE(ts.error.isEmpty()) << ts.error.toStdString();
    EXPECT_EQ(ts.language, QStringLiteral("ja_JP"));
    ASSERT_GT(ts.entries.size(), 700u);
    const QRegularExpression letters(QStringLiteral("[A-Za-z]"));
    for (const auto& [key, entry] : ts.entries) {
        EXPECT_TRUE(entry.type.isEmpty()) << said(key) << " is " << entry.type.toStdString();
        EXPECT_FALSE(entry.translation.trimmed().isEmpty()) << said(key);
        // Units, formats and names of keys stay as they are; whatever is said is said in Japanese.
        EXPECT_TRUE(entry.translation == key.second || isJapanese(entry.translation) ||
                    !entry.translation.contains(letters))
            << said(key) << " -> " << entry.translation.toStdString();
    }
}

TEST(Translation, KeepsPlaceholdersTagsAndBlanks) {
    const QRegularExpression front(QStringLiteral("^\\s*")), back(QStringLiteral("\\s*$"));
    for (const auto& [key, entry] : japanese().entries) {
        const QString& t = entry.translation;
        EXPECT_TRUE(fixedParts(key.second) == fixedParts(t)) << said(key) << " -> " << t.toStdString();
        EXPECT_EQ(front.match(key.second).captured(), front.match(t).captured()) << said(key);
        EXPECT_EQ(back.match(key.second).captured(), back.match(t).captured()) << said(key);
        EXPECT_EQ(key.second.endsWith(QLatin1String("...")), t.endsWith(QLatin1String("..."))) << said(key);
        EXPECT_EQ(key.second.endsWith(QChar(0x2026)), t.endsWith(QChar(0x2026))) << said(key);
    }
}

TEST(Translation, KnowsEveryTextOfTheProgram) {
    const QTemporaryDir folder;
    const QString fresh = folder.filePath(QStringLiteral("fresh_ja.ts"));
    const QString apps = QStringLiteral(HANDPIECE_APPS);
    QProcess lupdate;
    lupdate.setProcessChannelMode(QProcess::SeparateChannels);
    lupdate.start(QStringLiteral(HANDPIECE_LUPDATE),
                  {"-I", apps, apps + "/desktop", "-locations", "none", "-ts", fresh});
    ASSERT_TRUE(lupdate.waitForFinished(60000)) << lupdate.errorString().toStdString();
    ASSERT_EQ(lupdate.exitCode(), 0);
    // A warning is a text whose context nobody knows: the program would look it up elsewhere, and find nothing.
    EXPECT_EQ(lupdate.readAllStandardError().toStdString(), "");
    const Ts now = readTs(fresh);
    ASSERT_GT(now.entries.size(), 700u);
    const char* remedy =
        ": in the repository's root, lupdate -I apps apps/desktop -locations none "
        "-no-obsolete -ts apps/desktop/translations/handpiece_ja.ts, then translate";
    for (const auto& [key, entry] : now.entries)
        EXPECT_TRUE(japanese().entries.count(key)) << said(key) << " has no translation" << remedy;
    for (const auto& [key, entry] : japanese().entries)
        EXPECT_TRUE(now.entries.count(key)) << said(key) << " is no text of the program any more" << remedy;
}

TEST(Translation, IsWhatTheProgramLooksUp) {
    Language language;
    ASSERT_TRUE(language.use(QStringLiteral("ja")));
    for (const auto& [key, entry] : japanese().entries) {
        QString expected = entry.translation;
        expected.replace(QLatin1String("%n"), QLatin1String("3"));
        EXPECT_EQ(QCoreApplication::translate(key.first.toUtf8(), key.second.toUtf8(), nullptr, entry.counts ? 3 : -1)
                      .toStdString(),
                  expected.toStdString())
            << said(key);
    }
    ASSERT_TRUE(language.use(QStringLiteral("en")));
    EXPECT_EQ(QCoreApplication::translate("Commands", "Undo"), QStringLiteral("Undo"));
}

/// What a person may read or hear of a widget and its children; the place it stands at -> the text.
std::vector<std::pair<QString, QString>> textsOf(QWidget* top) {
    std::vector<std::pair<QString, QString>> texts;
    const auto add = [&](const QObject* of, const char* what, const QString& text) {
        if (!text.isEmpty()) texts.emplace_back(of->objectName() + QLatin1Char('.') + QLatin1String(what), text);
    };
    QList<QWidget*> widgets = top->findChildren<QWidget*>();
    widgets << top;
    for (QWidget* w : widgets) {
        // Qt's own: its translations are not on every machine.
        if (w->objectName().startsWith(QLatin1String("qt_")) || w->objectName().startsWith(QLatin1String("Scroll")))
            continue;
        add(w, "toolTip", w->toolTip());
        add(w, "accessibleName", w->accessibleName());
        add(w, "accessibleDescription", w->accessibleDescription());
        if (const auto* label = qobject_cast<QLabel*>(w)) add(w, "text", label->text());
        if (const auto* button = qobject_cast<QAbstractButton*>(w)) add(w, "text", button->text());
        if (const auto* group = qobject_cast<QGroupBox*>(w)) add(w, "title", group->title());
        if (const auto* menu = qobject_cast<QMenu*>(w)) add(w, "title", menu->title());
        if (const auto* edit = qobject_cast<QLineEdit*>(w)) add(w, "placeholder", edit->placeholderText());
        if (qobject_cast<QDockWidget*>(w) || qobject_cast<QToolBar*>(w)) add(w, "title", w->windowTitle());
        if (const auto* box = qobject_cast<QComboBox*>(w))
            for (int i = 0; i < box->count(); ++i)
                add(w, "item", box->itemText(i));
        if (const auto* table = qobject_cast<QTableWidget*>(w))
            for (int i = 0; i < table->columnCount(); ++i) {
                if (const auto* head = table->horizontalHeaderItem(i)) add(w, "head", head->text());
                for (int row = 0; row < table->rowCount(); ++row)
                    if (const auto* item = table->item(row, i)) add(w, "cell", item->text() + '\n' + item->toolTip());
            }
    }
    for (const QAction* action : top->findChildren<QAction*>()) {
        if (action->objectName().startsWith(QLatin1String("_q_"))) continue;  // Qt's own
        add(action, "text", action->text());
        add(action, "toolTip", action->toolTip());
        add(action, "statusTip", action->statusTip());
    }
    return texts;
}

/// English words that stand in a Japanese window too: names, units, formats, keys.
QString leftInEnglish(QString text) {
    // What is typed as it stands, in a file's own words, is no language's.
    static const QRegularExpression tags(QStringLiteral("<code>.*?</code>|<[^>]*>")),
        words(QStringLiteral("[A-Za-z]{3,}"));
    static const std::set<QString> names = {"Handpiece", "STL",    "PNG",   "SVG",       "CSV",       "FDI",      "ISO",
                                            "PLY",       "OBJ",    "Ctrl",  "Shift",     "Home",      "End",      "Esc",
                                            "Del",       "Return", "Enter", "Backspace", "Left",      "Right",    "Up",
                                            "Down",      "PgUp",   "PgDn",  "Space",     "DICOM",     "rpm",      "min",
                                            "English",   "OpenGL", "Tab",   "Palmer",    "Universal", "handpiece"};
    text.remove(tags);
    QStringList found;
    for (auto it = words.globalMatch(text); it.hasNext();)
        if (const QString word = it.next().captured(); !names.count(word)) found << word;
    return found.join(QLatin1Char(' '));
}

class JapaneseWindow : public ShellTest {};

TEST_F(JapaneseWindow, SpeaksJapaneseEverywhere) {
    CommandLine line;
    line.language = QStringLiteral("ja");
    startWithTooth(line);
    EXPECT_EQ(action("actionUndo")->text(), QStringLiteral("元に戻す"));
    EXPECT_EQ(action("actionOpenCase")->text(), QStringLiteral("症例を開く..."));
    for (const Detail detail : {Detail::practice, Detail::laboratory, Detail::paper}) {
        window().setDetail(detail);
        QTest::qWait(300);
        std::size_t inJapanese = 0;
        for (const auto& [place, text] : textsOf(&window())) {
            if (isJapanese(text)) ++inJapanese;
            EXPECT_EQ(leftInEnglish(text).toStdString(), "") << place.toStdString() << ": " << text.toStdString();
        }
        EXPECT_GT(inJapanese, 300u);
    }
}

TEST_F(JapaneseWindow, WithoutItsFileSpeaksEnglish) {
    removeTranslations();
    Language language;
    EXPECT_FALSE(language.use(QStringLiteral("ja")));
    CommandLine line;
    line.language = QStringLiteral("ja");
    startWithTooth(line);
    EXPECT_EQ(action("actionUndo")->text(), QStringLiteral("Undo"));
    bool told = false;
    for (const QLabel* label : window().findChildren<QLabel*>())
        told |= label->text().contains(QLatin1String("There is no translation into this language"));
    EXPECT_TRUE(told);
    EXPECT_TRUE(cut());
    host_.reset();
    bringTranslationsBack();
    EXPECT_TRUE(language.use(QStringLiteral("ja")));
    EXPECT_EQ(QCoreApplication::translate("Commands", "Undo"), QStringLiteral("元に戻す"));
}

}  // namespace
}  // namespace handpiece::desktop::translation_test
