// SPDX-License-Identifier: Apache-2.0
// What the window stands on: settings, recordings kept, errors in words, the command line.
#include <QDir>
#include <QDirIterator>
#include <QFile>
#include <QFileInfo>
#include <QRegularExpression>
#include <QSet>
#include <cerrno>
#include <cmath>
#include <fstream>

#include "desktop/framework/application.h"
#include "desktop/framework/language.h"
#include "desktop/program/command_line.h"
#include "desktop/program/run_statistics.h"
#include "desktop/work/session_shelf.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/record/session/recorder.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/senses/sound/player.h"
#include "handpiece/tick/device/simulated_device.h"
#include "shell_support.h"

namespace handpiece::desktop::shell_parts_test {
namespace {

namespace fs = std::filesystem;

void put(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
}

TEST(Application, TellsWhatASlotThrowsAndGoesOn) {
    auto* application = dynamic_cast<Application*>(qApp);
    ASSERT_NE(application, nullptr);
    std::vector<core::Error> told;
    application->whenThrown = [&](const core::Error& error) { told.push_back(error); };
    QObject slot;
    const auto later = [&](auto throwing) {
        QMetaObject::invokeMethod(&slot, throwing, Qt::QueuedConnection);
        QCoreApplication::processEvents();
    };
    later([] { throw core::Error("one", "here").as("no-space"); });
    later([] { (void)fs::exists(fs::path(std::string(5000, 'x'))); });
    later([] { throw std::bad_alloc(); });
    bool goesOn = false;
    later([&] { goesOn = true; });
    application->whenThrown = nullptr;
    EXPECT_TRUE(goesOn);
    ASSERT_EQ(told.size(), 3u);
    EXPECT_EQ(told[0].id(), "no-space");
    EXPECT_EQ(told[1].where(), std::string(5000, 'x'));
    EXPECT_EQ(told[2].problem(), "there is not enough memory");
}

TEST(Settings, KeepWhatTheyAreTold) {
    const QTemporaryDir folder;
    const fs::path file = toPath(folder.filePath("handpiece.ini"));
    {
        Settings settings(file);
        settings.set("a/number", 2.5);
        settings.set("a/text", QStringLiteral("=[Zähne] \n歯"));
        for (int i = 0; i < 12; ++i)
            settings.addRecent(QString::number(i));
        settings.addRecent("7");
        EXPECT_TRUE(settings.sync());
    }
    const Settings again(file);
    EXPECT_TRUE(again.setAside().isEmpty());
    EXPECT_EQ(again.number("a/number", 0, 0, 10), 2.5);
    EXPECT_EQ(again.number("a/number", 0, 0, 2), 2.0);
    EXPECT_EQ(again.number("a/text", 4, 0, 10), 4.0);
    EXPECT_EQ(again.value("a/text").toString(), QStringLiteral("=[Zähne] \n歯"));
    EXPECT_EQ(again.recentFiles(), QStringList({"7", "11", "10", "9", "8", "6", "5", "4", "3", "2"}));
}

TEST(Settings, FilesAreLookedForInAFolderThatIsThere) {
    const QTemporaryDir home;
    const QByteArray before = qgetenv("HOME"), config = qgetenv("XDG_CONFIG_HOME");
    qputenv("HOME", home.path().toLocal8Bit());
    qputenv("XDG_CONFIG_HOME", home.filePath("config").toLocal8Bit());
    EXPECT_EQ(workFolder(), home.path());
    QDir(home.path()).mkdir("Documents");
    EXPECT_EQ(workFolder(), home.filePath("Documents"));
    qputenv("HOME", home.filePath("not/there").toLocal8Bit());
    EXPECT_TRUE(QFileInfo(workFolder()).isDir());
    qputenv("HOME", before);
    config.isNull() ? qunsetenv("XDG_CONFIG_HOME") : qputenv("XDG_CONFIG_HOME", config);
}

TEST(Settings, AreSetAsideWhenBroken) {
    for (const std::string& text : {std::string("\0\1\2 rubbish", 11), std::string("this is no ini file\n[half")}) {
        const QTemporaryDir folder;
        const fs::path file = toPath(folder.filePath("handpiece.ini"));
        put(file, text);
        Settings settings(file);
        EXPECT_EQ(settings.setAside(), folder.filePath("handpiece.ini.broken"));
        EXPECT_EQ(fs::file_size(toPath(settings.setAside())), text.size());
        settings.set("a", 1);
        EXPECT_TRUE(settings.sync());
        EXPECT_EQ(Settings(file).number("a", 0, 0, 9), 1.0);
    }
}

TEST(Histogram, KnowsSharesToWithinItsCells) {
    std::vector<double> all;
    simulation::Histogram histogram;
    for (int i = 0; i < 5000; ++i) {
        all.push_back(3.0 * std::exp(2.0 * std::sin(0.37 * i)));
        histogram.add(all.back());
    }
    std::sort(all.begin(), all.end());
    EXPECT_EQ(histogram.count(), all.size());
    EXPECT_EQ(histogram.most(), all.back());
    for (const double share : {0.01, 0.5, 0.99, 0.999}) {
        const double truth = all[static_cast<std::size_t>(share * 5000.0) - 1];
        EXPECT_NEAR(histogram.at(share) / truth, 1.0, 0.012) << share;
    }
    EXPECT_EQ(simulation::Histogram{}.at(0.5), 0.0);
}

TEST(CommandLine, TakesWhatMeasuringScriptsNeed) {
    const CommandLine line = parseCommandLine({"handpiece-desktop", "--stats=a.json", "--run-for", "20"});
    EXPECT_TRUE(line.wrong.isEmpty());
    EXPECT_EQ(line.stats, "a.json");
    EXPECT_EQ(line.runForS, 20.0);
    for (const char* bad : {"--run-for=0", "--run-for=x", "--run-for=-1"})
        EXPECT_FALSE(parseCommandLine({"handpiece-desktop", bad}).wrong.isEmpty()) << bad;
    const double then = sinceProgramStartMs();
    EXPECT_GT(then, 0.0);
    EXPECT_LT(then, 3.6e6);
    EXPECT_GE(sinceProgramStartMs(), then);
}

TEST(SessionShelf, OffersOnlyUnsavedWorkOfProgramsThatAreGone) {
    const QTemporaryDir folder;
    const fs::path path = toPath(folder.filePath("sessions"));
    SessionShelf alive(path);
    const fs::path session = alive.begin({"case", "Molar", "", true});
    put(session, "x");
    EXPECT_TRUE(SessionShelf(path).crashed().empty());  // its program lives
    alive.leave();
    const auto found = SessionShelf(path).crashed();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].session, session);
    EXPECT_EQ(found[0].note.title, "Molar");
    SessionShelf(path).settle(session);
    EXPECT_TRUE(SessionShelf(path).crashed().empty());
    EXPECT_TRUE(fs::exists(session));
}

TEST(SessionShelf, NobodyElseLooksIntoIt) {
    const QTemporaryDir folder;
    const fs::path path = toPath(folder.filePath("sessions"));
    SessionShelf shelf(path);
    const fs::path session = shelf.begin({"case", "Molar", "", true});
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    EXPECT_EQ(fs::status(fs::path(session).replace_extension(".json")).permissions(),
              fs::perms::owner_read | fs::perms::owner_write);
}

TEST(SessionShelf, ClearsAwayWhatWasKilledBeforeItBegan) {
    const QTemporaryDir folder;
    const fs::path path = toPath(folder.path());
    put(path / "20260101-000000-000-1.h5.begun", "x");
    put(path / "20260101-000000-000-1.json", R"({"unsaved": true})");
    SessionShelf alive(path);
    const fs::path mine = alive.begin({"case", "Molar", "", true});
    put(fs::path(mine) += ".begun", "x");
    EXPECT_TRUE(SessionShelf(path).crashed().empty());
    SessionShelf(path).tidy();
    EXPECT_FALSE(fs::exists(path / "20260101-000000-000-1.h5.begun"));
    EXPECT_FALSE(fs::exists(path / "20260101-000000-000-1.json"));
    EXPECT_TRUE(fs::exists(fs::path(mine) += ".begun")) << "its program lives";
}

TEST(SessionShelf, DeletesTheOldestButNeverUnsavedWork) {
    const QTemporaryDir folder;
    const fs::path path = toPath(folder.path());
    for (int i = 0; i < 8; ++i)
        put(path / ("2026010" + std::to_string(i) + "-000000-000-1.h5"), std::string(100, 'x'));
    put(path / "20260100-000000-000-1.json", R"({"unsaved": true, "title": "t"})");
    EXPECT_EQ(SessionShelf(path, {5, 1 << 20}).tidy(), 2u);
    EXPECT_TRUE(fs::exists(path / "20260100-000000-000-1.h5"));
    EXPECT_FALSE(fs::exists(path / "20260101-000000-000-1.h5"));
    EXPECT_FALSE(fs::exists(path / "20260102-000000-000-1.h5"));
    EXPECT_EQ(SessionShelf(path, {5, 250}).tidy(), 3u);  // by size: two stay, and the unsaved one
    EXPECT_TRUE(fs::exists(path / "20260100-000000-000-1.h5"));
    EXPECT_TRUE(fs::exists(path / "20260106-000000-000-1.h5"));
    EXPECT_FALSE(fs::exists(path / "20260105-000000-000-1.h5"));
}

/// A fifth of a second over a block; in its middle the machine slept for half a second.
void recordWithAGap(const fs::path& file) {
    cases::Case block;
    block.name = "block";
    block.outer = test::boxMesh(core::Vec3(-2, -2, -2), core::Vec3(2, 2, 0));
    simulation::SimulationSettings settings;
    settings.field.voxelMm = 0.1;
    settings.bur = instrument::makeInstrument("round-4").bur;
    const simulation::SimulationSetup station = simulation::makeSimulation(block, settings, false);
    session::SessionInfo info;
    info.rateHz = settings.rateHz;
    info.settings = simulation::settingsJson(station.settings);
    info.tooth = cases::encodeCase(block);
    session::Recorder recorder(file, info);
    loop::HapticLoop loop(
        {},
        std::make_unique<device::SimulatedDevice>(device::SimulatedDeviceSettings{},
                                                  device::hold({core::Vec3(0, 0, 3), core::Quat::Identity()}, 1.0)),
        station.work(), station.settings.parameters, station.settings.drive);
    for (int i = 0; i < 200; ++i) {
        rt::Beat beat;
        beat.periods = i == 100 ? 500 : 1;
        loop.tick(beat);
        loop.fetch([&](const messages::HapticSample& sample) { recorder.pushWaiting(session::recordOf(sample)); }, {});
    }
}

TEST(ReplayDriver, PlaysOnWhereTheMachineLeftPeriodsOut) {
    const QTemporaryDir folder;
    const fs::path file = toPath(folder.filePath("session.h5"));
    recordWithAGap(file);
    ReplayDriver driver(std::make_unique<simulation::SessionPlayer>(file, false));
    EXPECT_GT(driver.durationS(), 0.6);
    driver.play(true);
    EXPECT_TRUE(waitFor([&] { return !driver.now().playing; }));
    EXPECT_EQ(driver.now().timeS, driver.durationS());
    EXPECT_FALSE(driver.takeProblem());
}

core::Error errorOf(const std::function<void()>& work) {
    try {
        work();
    } catch (const core::Error& error) {
        return error;
    }
    ADD_FAILURE() << "nothing was thrown";
    return core::Error("nothing");
}

TEST(Problems, OfTheLibraryAreKnownByTheirIds) {
    const QTemporaryDir folder;
    const auto at = [&](const char* name) { return toPath(folder.filePath(QLatin1String(name))); };
    const auto idOf = [](const std::function<void()>& work) { return problemOf(errorOf(work)).id; };
    EXPECT_EQ(idOf([&] { (void)core::readFile(at("none")); }), "file-not-found");
    EXPECT_EQ(idOf([&] { (void)core::readFile(toPath(folder.path())); }), "is-a-folder");
    EXPECT_EQ(idOf([&] { (void)core::readFile("/dev/null"); }), "not-a-file");
    EXPECT_EQ(idOf([&] { core::writeFile("/dev/null/none", "x"); }), "not-writable");
    EXPECT_EQ(core::writeErrorId(ENOSPC), "no-space");
    EXPECT_EQ(idOf([&] { (void)cases::readCase(toPath(folder.path())); }), "not-a-case");
    put(at("bad/case.toml"), "format = [");
    EXPECT_EQ(idOf([&] { (void)cases::readCase(at("bad")); }), "bad-text");
    put(at("no.stl"), "rubbish");
    EXPECT_EQ(idOf([&] { (void)cases::readCase(at("no.stl")); }), "bad-mesh");
    put(at("no.handpiece"), "rubbish");
    EXPECT_EQ(idOf([&] { (void)cases::readCase(at("no.handpiece")); }), "not-a-package");
    put(at("no.h5"), "rubbish");
    EXPECT_EQ(idOf([&] { (void)session::SessionReader(at("no.h5")); }), "not-a-session");
    put(at("no.wav"), "rubbish");
    EXPECT_EQ(idOf([&] { (void)sound::readWav(at("no.wav")); }), "not-a-wav");
    EXPECT_EQ(idOf([&] { (void)instrument::makeInstrument("no-such-bur"); }), "bur-unknown");
    geometry::TriangleMesh open;
    open.vertices = {{0, 0, 0}, {5, 0, 0}, {0, 5, 0}};
    open.triangles = {{0, 1, 2}};
    const Problem hole = problemOf(errorOf([&] { cases::requireSolid(open, "open.stl"); }));
    EXPECT_EQ(hole.id, "not-closed");
    EXPECT_EQ(hole.where, "open.stl");
    EXPECT_EQ(hole.arguments.value(0), "3");
    EXPECT_TRUE(hole.what.contains("3")) << qPrintable(hole.what);
    EXPECT_FALSE(hole.what.contains("%")) << qPrintable(hole.what);
    force::Parameters parameters;
    parameters.stiffnessMultiplier = -1.0;
    const Problem refused = problemOf(errorOf([&] { force::validate(parameters); }));
    EXPECT_EQ(refused.id, "parameter-refused");
    EXPECT_TRUE(refused.remedy.contains("100")) << qPrintable(refused.remedy);
}

TEST(Problems, WithoutAnIdAreMarkedAsTechnical) {
    const Problem full =
        problemOf(core::Error("cannot be written: 100 %1", "/a/b", "x").as("no-space", {"No space left %1"}));
    EXPECT_EQ(full.id, "no-space");
    EXPECT_EQ(full.where, "/a/b");
    EXPECT_TRUE(full.what.contains("No space left %1")) << qPrintable(full.what);
    EXPECT_FALSE(full.remedy.isEmpty());
    const Problem other = problemOf(core::Error("something new", "there", "do that"));
    EXPECT_TRUE(other.id.isEmpty());
    EXPECT_EQ(other.what, "Technical detail: something new");
    EXPECT_EQ(other.remedy, "Technical advice: do that");
    EXPECT_EQ(problemOf(core::Error("x").as("of-a-later-version")).what, "Technical detail: x");
    for (const QString& id : problemIds()) {
        const Problem own = problemById(id, {"1", "2", "3", "4"});
        EXPECT_FALSE(own.what.isEmpty()) << qPrintable(id);
        EXPECT_FALSE(own.remedy.isEmpty()) << qPrintable(id);
        EXPECT_FALSE(own.what.contains("%")) << qPrintable(id);
    }
}

/// Every id that a throw names is in the window's table, so none is told in English alone.
TEST(Problems, EveryIdOfTheSourcesHasItsWords) {
    const QRegularExpression as(QStringLiteral("\\.as\\(\\s*\"([a-z-]+)\""));
    // What a school's server is made of, and no window.
    const QRegularExpression ofServer(QStringLiteral(
        "app/proving/|school/(people|roster|keeping|exam)/|school/store/(?!store\\.|database\\.|database_sqlite)"));
    QSet<QString> used;
    for (const char* root : {HANDPIECE_SOURCES "/src", HANDPIECE_SOURCES "/apps/station"}) {
        QDirIterator files(QString::fromUtf8(root), {"*.cpp", "*.h"}, QDir::Files, QDirIterator::Subdirectories);
        while (files.hasNext()) {
            QFile file(files.next());
            ASSERT_TRUE(file.open(QIODevice::ReadOnly));
            if (file.fileName().endsWith("core/error.h") || ofServer.match(file.fileName()).hasMatch()) continue;
            auto found = as.globalMatch(QString::fromUtf8(file.readAll()));
            while (found.hasNext())
                used.insert(found.next().captured(1));
        }
    }
    // What a station's service for exams says is told in the window.
    const QRegularExpression ofExams(QStringLiteral("\\.as\\(\\s*\"(exam-[a-z-]+)\""));
    for (const char* root : {HANDPIECE_SOURCES "/src/handpiece/school/exam", HANDPIECE_SOURCES "/apps/school"}) {
        QDirIterator files(QString::fromUtf8(root),
                           {"exam_service.cpp", "exam_desk.cpp", "invigilation.cpp", "pack.cpp", "signing.cpp",
                            "lines.cpp", "chain.cpp"},
                           QDir::Files);
        while (files.hasNext()) {
            QFile file(files.next());
            ASSERT_TRUE(file.open(QIODevice::ReadOnly));
            auto found = ofExams.globalMatch(QString::fromUtf8(file.readAll()));
            while (found.hasNext())
                used.insert(found.next().captured(1));
        }
    }
    EXPECT_GT(used.size(), 40);
    for (const QString& id : used)
        EXPECT_TRUE(problemIds().contains(id)) << qPrintable(id);
}

TEST(ErrorDialogs, SayWhatWhereAndWhatToDo) {
    const ErrorDialog dialog(
        problemOf(core::Error("there is no such file", "/no/where.stl", "check the name").as("file-not-found")));
    EXPECT_EQ(dialog.text(),
              "There is no such file.\n/no/where.stl\nCheck the name, or choose the file again.\n[file-not-found]");
}

TEST(CommandLines, AreUnderstoodOrRefused) {
    const auto parsed = [](const QStringList& rest) { return parseCommandLine(QStringList{"program"} + rest); };
    const CommandLine line = parsed({"--layout", "paper", "tooth.stl", "--language=ja", "--no-sound", "--screenshot",
                                     "a.png", "--after", "1.5", "--timing", "--rate", "4000", "--no-realtime"});
    EXPECT_TRUE(line.wrong.isEmpty()) << qPrintable(line.wrong);
    EXPECT_EQ(line.file, "tooth.stl");
    EXPECT_EQ(line.layout, "paper");
    EXPECT_EQ(line.language, "ja");
    EXPECT_FALSE(line.sound);
    EXPECT_TRUE(line.timing);
    EXPECT_EQ(line.screenshot, "a.png");
    EXPECT_EQ(line.afterS, 1.5);
    EXPECT_EQ(line.rateHz, 4000.0);
    EXPECT_FALSE(line.realTime);
    for (const QStringList& wrong : {QStringList{"--layout", "x"},
                                     {"--layout"},
                                     {"--language", "xx"},
                                     {"--after", "nan"},
                                     {"--rate", "1"},
                                     {"--what"},
                                     {"a", "b"}})
        EXPECT_FALSE(parsed(wrong).wrong.isEmpty()) << qPrintable(wrong.join(' '));
}

TEST(Windows, FitTheScreenTheyStartOn) {
    EXPECT_EQ(MainWindow::firstSize({1920, 1053}), QSize(1440, 900));
    for (const QSize room : {QSize(1366, 768), QSize(1366, 728), QSize(1280, 720)}) {
        const QSize size = MainWindow::firstSize(room);
        EXPECT_LE(size.width(), room.width());
        EXPECT_LT(size.height(), room.height() - 20);  // its title
        EXPECT_GT(size.height(), room.height() - 60);
    }
}

TEST(CommandLines, WithoutADisplayASentenceAndNoCrash) {
    const QByteArray platform = qgetenv("QT_QPA_PLATFORM"), display = qgetenv("DISPLAY"),
                     wayland = qgetenv("WAYLAND_DISPLAY");
    qputenv("QT_QPA_PLATFORM", "offscreen");
    EXPECT_TRUE(missingDisplay().isEmpty());
    for (const char* name : {"QT_QPA_PLATFORM", "DISPLAY", "WAYLAND_DISPLAY"})
        qunsetenv(name);
    EXPECT_TRUE(missingDisplay().contains("DISPLAY"));
    qputenv("DISPLAY", ":1");
    EXPECT_TRUE(missingDisplay().isEmpty());
    qunsetenv("DISPLAY");
    if (!display.isEmpty()) qputenv("DISPLAY", display);
    if (!wayland.isEmpty()) qputenv("WAYLAND_DISPLAY", wayland);
    qputenv("QT_QPA_PLATFORM", platform);
}

}  // namespace
}  // namespace handpiece::desktop::shell_parts_test
