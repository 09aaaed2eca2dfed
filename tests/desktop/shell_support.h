// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The whole program under the offscreen platform, with folders of its own. The teeth that it finds in its cache are
/// put there by the test: an egg of enamel about dentine and pulp, beside a gum, each alone. Making real ones takes
/// seconds; one test does.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <QAbstractButton>
#include <QApplication>
#include <QDropEvent>
#include <QMimeData>
#include <QTemporaryDir>
#include <QTest>
#include <QUrl>
#include <cmath>
#include <csignal>
#include <functional>
#include <memory>

#include "desktop/features/files/starter_feature.h"
#include "desktop/framework/error_dialog.h"
#include "desktop/program/host.h"
#include "handpiece/app/course/kept_cases.h"
#include "support/closed_meshes.h"

namespace handpiece::desktop {

/// Waits, with the window's events, for what must come about; five minutes at most, for a machine that is busy.
inline bool waitFor(const std::function<bool()>& what) {
    return QTest::qWaitFor(what, 300000);
}

/// Coarse: most of what these tests cost is the making of fields and surfaces.
inline constexpr int kVoxelUm = 200;

/// One that is kept, or made, without a mouth around it.
inline Starter aloneTooth(int fdi) {
    return {fdi, {}, 4000, false};
}

inline cases::Case eggTooth(int fdi) {
    const auto egg = [](int level, double scale) {
        return test::icosphere(level, [scale](const core::Vec3& v) {
            return core::Vec3(scale * 4.5 * v.x(), scale * 4.0 * v.y(), scale * 6.0 * v.z());
        });
    };
    cases::Case made;
    made.kind = dentition::toothKindName(fdi);
    made.name = made.kind + " (egg)";
    made.fdiNumber = fdi;
    made.buccalSign = dentition::ToothForm(fdi, {}).buccalSign();
    made.outer = egg(4, 1.0);
    const auto part = [](const char* name, cases::Tissue tissue, int priority, geometry::TriangleMesh mesh) {
        return cases::Part{name, tissue, priority, std::move(mesh)};
    };
    made.parts = {part("enamel", cases::Tissue::enamel, 0, egg(4, 1.0)),
                  part("dentine", cases::Tissue::dentine, 1, egg(3, 0.8)),
                  part("pulp", cases::Tissue::pulp, 2, egg(2, 0.3))};
    made.scenery = {
        part("gum", cases::Tissue::gum, 0, test::boxMesh(core::Vec3(-9.0, -7.0, -9.0), core::Vec3(9.0, 7.0, -4.0)))};
    return made;
}

class ShellTest : public ::testing::Test {
  protected:
    /// Shared by all tests of a program, and by those that they start.
    static QTemporaryDir& shared() {
        static QTemporaryDir folder;
        static const bool made = [] {
            for (const int fdi : {46, 11})
                cases::writeCase(eggTooth(fdi),
                                 course::keptToothPlace(fdi, {}, 4000, toPath(folder.filePath("teeth"))));
            return true;
        }();
        static_cast<void>(made);
        return folder;
    }
    [[nodiscard]] std::filesystem::path at(const char* name) const {
        return toPath(own_.filePath(QLatin1String(name)));
    }

    [[nodiscard]] virtual Simulator::Options options() const {
        Simulator::Options options;
        options.folders = {at("config/handpiece.ini"), at("data/sessions"), toPath(shared().filePath("teeth"))};
        options.starter = aloneTooth(46);
        options.sound = false;
        options.realTime = false;
        options.voxelUm = kVoxelUm;
        return options;
    }
    void start(const CommandLine& line = {}) {
        host_.reset();
        host_ = std::make_unique<Host>(*qApp, line, options());
        window().questions.unsaved = [this] {
            ++asked_;
            return answer_;
        };
        window().questions.fileToOpen =
            window().questions.fileToSave = [this](const QString&, const QString&, const QString&) { return file_; };
        window().resize(1000, 700);
        host_->start();
    }
    void startWithTooth(const CommandLine& line = {}) {
        start(line);
        ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
        view()->showStandardView(view::StandardView::occlusal);
    }
    [[nodiscard]] MainWindow& window() { return host_->window(); }
    [[nodiscard]] Simulator& simulator() { return host_->simulator(); }
    void openTooth(int fdi) { window().findChild<StarterFeature*>()->open(aloneTooth(fdi)); }
    [[nodiscard]] ViewWidget* view() { return window().view(); }
    [[nodiscard]] QAction* action(const char* name) { return window().findChild<QAction*>(QLatin1String(name)); }
    [[nodiscard]] double removedMm3() {
        double sum = 0.0;
        for (const double v : simulator().sample().removedMm3)
            sum += v;
        return sum;
    }
    /// Presses in the middle of the picture until something is gone, as a newcomer would.
    [[nodiscard]] bool cut() {
        // The stroke ends with the pedal: undo knows it from then on, and no sample on its way has less removed.
        return pressUntilCut() && waitFor([this] {
                   return simulator().sample().pedal == 0.0 && !simulator().status().inStroke &&
                          simulator().status().undoSteps > 0;
               });
    }
    /// And lets go: the bur is still in the tooth.
    [[nodiscard]] bool pressUntilCut() {
        const QPoint middle = view()->rect().center();
        const double before = removedMm3();
        QMouseEvent move(QEvent::MouseMove, QPointF(middle), view()->mapToGlobal(QPointF(middle)), Qt::NoButton,
                         Qt::NoButton, Qt::NoModifier);
        QApplication::sendEvent(view(), &move);
        const std::uint64_t tick = simulator().sample().tick;
        if (!waitFor([&] { return simulator().sample().tick > tick + 300 && speedMmS() < 1.0; })) return false;
        QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, middle);
        const bool gone = waitFor([&] { return removedMm3() > before + 0.02; });
        QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, middle);
        return gone;
    }
    /// Of the bur.
    [[nodiscard]] double speedMmS() {
        const auto& v = simulator().sample().velocityMmS;
        return std::hypot(v[0], v[1], v[2]);
    }
    /// No undo or redo is being put in place.
    [[nodiscard]] bool settled() { return (simulator().sample().flags & messages::kRestoring) == 0; }
    /// One step after the other until there is none.
    [[nodiscard]] bool undoAll() {
        for (std::size_t left = simulator().status().undoSteps; left > 0; --left) {
            action("actionUndo")->trigger();
            if (!waitFor([&] { return simulator().status().undoSteps == left - 1 && !simulator().status().restoring; }))
                return false;
        }
        return true;
    }
    [[nodiscard]] bool idle() {
        return waitFor([this] { return !simulator().isBusy(); });
    }

    QTemporaryDir own_;
    std::unique_ptr<Host> host_;
    Questions::Unsaved answer_ = Questions::Unsaved::discard;
    /// Drops a file onto the window, as a file manager does.
    void drop(const QString& file) {
        QMimeData data;
        data.setUrls({QUrl::fromLocalFile(file)});
        QDragEnterEvent enter(QPoint(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(&window(), &enter);
        EXPECT_TRUE(enter.isAccepted());
        QDropEvent event(QPointF(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(&window(), &event);
    }

    QString file_;
    int asked_ = 0;
};

}  // namespace handpiece::desktop
