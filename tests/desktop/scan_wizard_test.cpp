// SPDX-License-Identifier: Apache-2.0
// The wizard from a scan to a case, worked as a person does: by mouse, keys and files, on a small tooth of known shape.
#include <gtest/gtest.h>

#include <QAbstractButton>
#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QDropEvent>
#include <QFile>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QMimeData>
#include <QPushButton>
#include <QTemporaryDir>
#include <QTest>
#include <QUrl>
#include <cmath>
#include <filesystem>
#include <memory>

#include "desktop/features/scan/histogram_view.h"
#include "desktop/features/scan/placing_page.h"
#include "desktop/features/scan/report_page.h"
#include "desktop/features/scan/scan_wizard.h"
#include "desktop/features/scan/slice_view.h"
#include "desktop/features/scan/tissue_page.h"
#include "desktop/picture/solid_view.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/case.h"
#include "handpiece/scan/volume/write_scan.h"
#include "shell_support.h"

namespace handpiece::desktop::scan_wizard_test {
namespace {

namespace fs = std::filesystem;
using cases::Tissue;
using core::Vec3;

std::string textOf(const fs::path& file) {
    const std::vector<std::byte> bytes = core::readFile(file);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Without its pictures, whose letters are anything by chance.
std::string wordsOf(const fs::path& file) {
    std::string words = textOf(file);
    const std::string picture = "data:image/png;base64,";
    for (std::size_t at = 0; (at = words.find(picture, at)) != std::string::npos; at += picture.size())
        words.erase(at + picture.size(), words.find('"', at) - at - picture.size());
    return words;
}

// Half axes of the whole tooth; the dentine is this share of it under the enamel, which ends at the neck, z = kNeckMm.
const Vec3 kOuterMm(4.0, 3.4, 6.5);
constexpr double kDentine = 0.78, kPulp = 0.24, kNeckMm = 0.5, kVoxelMm = 0.2;

/// About the distance to an ellipsoid's surface, positive inside.
double inside(const Vec3& p, const Vec3& half) {
    const double f = p.cwiseQuotient(half).norm();
    const double slope = p.cwiseQuotient(half.cwiseProduct(half)).norm() / std::max(f, 1e-9);
    return f < 1e-6 ? half.minCoeff() : (1.0 - f) / slope;
}

/// Grey values as of an extracted molar in air: 0, 800 (pulp: 150), 1600, blurred by about half a voxel.
volume::Volume toothVolume() {
    volume::Volume v;
    v.grid.spacingMm = Vec3::Constant(kVoxelMm);
    for (int a = 0; a < 3; ++a)
        v.grid.size[static_cast<std::size_t>(a)] = static_cast<int>(2.0 * (kOuterMm[a] + 1.2) / kVoxelMm) + 1;
    for (int a = 0; a < 3; ++a)
        v.grid.originMm[a] = -0.5 * kVoxelMm * (v.grid.size[static_cast<std::size_t>(a)] - 1);
    v.values.resize(v.grid.count());
    const auto step = [](double depth) { return 0.5 * (1.0 + std::erf(depth / (0.7 * kVoxelMm * std::sqrt(2.0)))); };
    for (int k = 0; k < v.grid.size[2]; ++k)
        for (int j = 0; j < v.grid.size[1]; ++j)
            for (int i = 0; i < v.grid.size[0]; ++i) {
                const Vec3 p = v.grid.toMm(Vec3(i, j, k));
                const double whole = step(inside(p, kOuterMm));
                const double enamel = step(-inside(p, kDentine * kOuterMm)) * step(p.z() - kNeckMm);
                const double pulp = step(inside(p, kPulp * kOuterMm));
                const double hard = 800.0 + 800.0 * enamel - 650.0 * pulp;
                // A speck of noise that is the same every time.
                const unsigned n = static_cast<unsigned>(i * 73856093) ^ static_cast<unsigned>(j * 19349663) ^
                                   static_cast<unsigned>(k * 83492791);
                v.values[v.grid.index(i, j, k)] = static_cast<float>(
                    100.0 + whole * hard + static_cast<double>((n * 2654435761u) >> 22) / 1024.0 * 60.0);
            }
    return v;
}

class ScanWizardTest : public ::testing::Test {
  protected:
    /// Written once for all tests.
    static const fs::path& scanFile() {
        static QTemporaryDir folder;
        static const fs::path file = [] {
            const fs::path place = toPath(folder.filePath(QStringLiteral("Doe^Jane")));
            volume::writeScan(toothVolume(), place, volume::ScanFormat::nrrd);
            return place / "scan.nrrd";
        }();
        return file;
    }
    void SetUp() override { open(); }
    void open() {
        wizard_.reset();
        wizard_ = std::make_unique<ScanWizard>(unfinished(), own_.path());
        wizard_->questions.folder = [this](const QString&) { return answer_; };
        wizard_->questions.fileToOpen = [this](const QString&, const QString&) { return answer_; };
        wizard_->questions.fileToSave = [this](const QString&, const QString&, const QString&) { return answer_; };
        wizard_->questions.showPage = [this](const QString& file) {
            shown_ = file;
            return true;
        };
        wizard_->resize(1180, 800);
        wizard_->show();
        QTest::qWait(20);
    }
    [[nodiscard]] fs::path unfinished() const { return toPath(own_.filePath(QStringLiteral("unfinished.toml"))); }
    [[nodiscard]] ScanModel& model() { return wizard_->model(); }
    [[nodiscard]] const scan_case::ScanJob& job() { return model().job(); }
    template <class W>
    [[nodiscard]] W* find(const char* name) {
        W* found = wizard_->findChild<W*>(QLatin1String(name));
        EXPECT_TRUE(found) << name;
        return found;
    }
    void click(const char* name) {
        auto* button = find<QAbstractButton>(name);
        ASSERT_TRUE(button && button->isEnabled()) << name;
        QTest::mouseClick(button, Qt::LeftButton);
    }
    [[nodiscard]] bool idle() {
        return waitFor([this] { return !model().isBusy(); });
    }
    [[nodiscard]] std::string said() { return model().problem() ? model().problem()->what.toStdString() : "nothing"; }
    /// To the tissues of the scan, with a preview of them.
    void openTissues() {
        wizard_->take(toQString(scanFile()));
        ASSERT_TRUE(waitFor([this] { return model().scan() != nullptr || model().problem(); })) << said();
        ASSERT_TRUE(wizard_->goTo(ScanWizard::tissues)) << said();
        ASSERT_TRUE(waitFor([this] { return model().isPreviewFresh() || model().problem(); }));
        ASSERT_TRUE(model().isPreviewFresh()) << said();
    }
    [[nodiscard]] double volumeOf(Tissue tissue) {
        return model().preview()->result.volumesMm3[static_cast<std::size_t>(tissue)];
    }
    [[nodiscard]] bool previewed() {
        return waitFor([this] { return model().isPreviewFresh() || model().problem(); }) && model().isPreviewFresh();
    }

    QTemporaryDir own_;
    std::unique_ptr<ScanWizard> wizard_;
    QString answer_, shown_;
};

TEST_F(ScanWizardTest, FromAFileToACaseThatCanBeRead) {
    EXPECT_FALSE(find<QPushButton>("scanNext")->isEnabled());
    openTissues();
    const QString said = find<QLabel>("scanWhat")->text();
    EXPECT_TRUE(said.contains(QLatin1String("NRRD"))) << said.toStdString();

    // The shape is known: volumes of ellipsoids, and of a cap of one.
    const double ball = 4.0 / 3.0 * 3.14159265358979 * kOuterMm.prod();
    const auto capShare = [](double from) { return (2.0 - 3.0 * from + from * from * from) / 4.0; };
    const double enamel = ball * capShare(kNeckMm / kOuterMm.z()) -
                          ball * std::pow(kDentine, 3) * capShare(kNeckMm / (kDentine * kOuterMm.z()));
    EXPECT_NEAR(volumeOf(Tissue::enamel), enamel, 0.1 * enamel);
    const double sum = volumeOf(Tissue::enamel) + volumeOf(Tissue::dentine) + volumeOf(Tissue::pulp);
    EXPECT_NEAR(sum, ball, 0.03 * ball);

    click("scanNext");
    EXPECT_EQ(wizard_->step(), ScanWizard::surfaces);
    ASSERT_TRUE(waitFor([this] { return model().isFullFresh() || model().problem(); }));
    ASSERT_TRUE(model().isFullFresh()) << this->said();
    click("scanNext");
    ASSERT_EQ(wizard_->step(), ScanWizard::placing);
    // Without a name there is no case, and none is taken from the scan.
    EXPECT_TRUE(find<QLineEdit>("scanName")->text().isEmpty());
    EXPECT_FALSE(find<QPushButton>("scanNext")->isEnabled());
    QTest::keyClicks(find<QLineEdit>("scanName"), QStringLiteral("Egg with a cap"));
    QTest::keyClicks(find<QLineEdit>("scanFdiNumber"), QStringLiteral("46"));
    EXPECT_EQ(job().placing.fdiNumber, 46);
    click("scanNext");
    ASSERT_EQ(wizard_->step(), ScanWizard::report);
    ASSERT_TRUE(waitFor([this] { return model().isFullFresh(); }));
    const QString report = find<QLabel>("scanReportText")->text();
    EXPECT_TRUE(report.contains(QLatin1String("Egg with a cap")));
    EXPECT_FALSE(report.contains(QLatin1String("Doe")));

    QString tried;
    QObject::connect(wizard_.get(), &ScanWizard::tryNow, wizard_.get(), [&](const QString& place) { tried = place; });
    wizard_->reportPage()->setPlace(own_.filePath(QStringLiteral("egg")));
    EXPECT_TRUE(fs::exists(unfinished()) || waitFor([this] { return fs::exists(unfinished()); }));
    click("scanTry");
    ASSERT_TRUE(waitFor([&] { return !tried.isEmpty() || model().problem(); })) << this->said();
    ASSERT_FALSE(tried.isEmpty()) << this->said();
    const cases::Case read = cases::readCase(toPath(tried));
    EXPECT_EQ(read.name, "Egg with a cap");
    EXPECT_EQ(read.fdiNumber, 46);
    EXPECT_EQ(read.buccalSign, -1);
    cases::requireSolid(read.outer, "outer");
    EXPECT_NEAR(geometry::enclosedVolumeMm3(read.outer), ball, 0.03 * ball);
    // The crown, where the enamel is, is up.
    for (const cases::Part& part : read.parts)
        if (part.tissue == Tissue::dentine) {
            EXPECT_GT(read.outer.bounds().max.z() - part.mesh.bounds().max.z(), 0.6);
            EXPECT_LT(part.mesh.bounds().min.z() - read.outer.bounds().min.z(), 0.3);
        }
    // What is written needs no second start, and holds nothing of where it came from.
    EXPECT_FALSE(fs::exists(unfinished()));
    for (const auto& entry : fs::directory_iterator(toPath(tried)))
        EXPECT_EQ(wordsOf(entry.path()).find("Doe"), std::string::npos) << entry.path();

    // The page of it lies there too.
    const fs::path place = toPath(tried) / "report.html";
    ASSERT_TRUE(fs::exists(place));
    const std::string page = wordsOf(place);
    EXPECT_GT(fs::file_size(place), 10 * page.size()) << "no pictures";
    EXPECT_EQ(page.rfind("<!DOCTYPE html>", 0), 0u);
    for (const char* part : {"Egg with a cap", "<h2>Volumes", "What this scan cannot show", "Try it now", "</html>"})
        EXPECT_NE(page.find(part), std::string::npos) << part;
    for (const std::string& secret : {scanFile().parent_path().string(), scanFile().filename().string(),
                                      std::string("Doe"), own_.path().toStdString()})
        EXPECT_EQ(page.find(secret), std::string::npos) << secret;
    click("scanOpenReport");
    EXPECT_EQ(toPath(shown_), place);
    // It is of the case that was saved, not of another decision.
    QTest::keyClicks(find<QLineEdit>("scanName"), QStringLiteral("2"));
    EXPECT_FALSE(find<QPushButton>("scanOpenReport")->isEnabled());

    // Without a report there is still the case.
    ASSERT_TRUE(fs::create_directory(toPath(own_.filePath(QStringLiteral("egg-report.html")))));
    wizard_->reportPage()->setPlace(own_.filePath(QStringLiteral("egg.handpiece")));
    ASSERT_TRUE(waitFor([this] { return model().isFullFresh() || model().problem(); })) << this->said();
    click("scanSave");
    ASSERT_TRUE(waitFor([this] { return model().problem().has_value(); }));
    EXPECT_EQ(model().problem()->id, QLatin1String("scan-report-missing")) << this->said();
    EXPECT_FALSE(find<QPushButton>("scanOpenReport")->isEnabled());
    EXPECT_EQ(cases::readCase(toPath(own_.filePath(QStringLiteral("egg.handpiece")))).name, "Egg with a cap2");
}

TEST_F(ScanWizardTest, AThresholdIsDraggedAndTakenBack) {
    openTissues();
    auto* histogram = find<HistogramView>("histogram");
    ASSERT_TRUE(histogram->thresholds());
    EXPECT_FALSE(job().segmentation.thresholds);
    const double enamelBefore = volumeOf(Tissue::enamel);
    const float from = histogram->valueOf(HistogramView::enamel);
    const int y = histogram->height() / 2;
    const int start = static_cast<int>(std::lround(histogram->pixelOf(from)));
    QTest::mousePress(histogram, Qt::LeftButton, Qt::NoModifier, {start, y});
    for (int step = 1; step <= 10; ++step)
        QTest::mouseMove(histogram, {start + 3 * step, y});
    QTest::mouseRelease(histogram, Qt::LeftButton, Qt::NoModifier, {start + 30, y});
    ASSERT_TRUE(job().segmentation.thresholds);
    EXPECT_GT(job().segmentation.thresholds->enamelFrom, from);
    ASSERT_TRUE(previewed()) << said();
    // Less is bright enough for enamel.
    EXPECT_LT(volumeOf(Tissue::enamel), enamelBefore);
    // One drag is one step.
    click("scanUndo");
    EXPECT_FALSE(job().segmentation.thresholds);
    ASSERT_TRUE(previewed()) << said();
    EXPECT_DOUBLE_EQ(volumeOf(Tissue::enamel), enamelBefore);
    click("scanRedo");
    EXPECT_TRUE(job().segmentation.thresholds);
    click("scanAutomatic");
    EXPECT_FALSE(job().segmentation.thresholds);
    // By keys too.
    histogram->setFocus();
    ASSERT_TRUE(previewed());
    QTest::keyClick(histogram, Qt::Key_Up);
    QTest::keyClick(histogram, Qt::Key_Down);
    QTest::keyClick(histogram, Qt::Key_Left);
    ASSERT_TRUE(job().segmentation.thresholds);
    EXPECT_LT(job().segmentation.thresholds->enamelFrom, from);
}

TEST_F(ScanWizardTest, EveryDecisionInASliceCanBeTakenBack) {
    openTissues();
    auto* slice = find<SliceView>("sliceCoronal");
    const auto at = [&](const Vec3& mm) { return slice->pixelOf(mm).toPoint(); };
    std::vector<std::string> states{scan_case::toToml(job())};
    const auto changed = [&] {
        states.push_back(scan_case::toToml(job()));
        EXPECT_NE(states.back(), states[states.size() - 2]);
    };

    click("scanToolPick");
    QTest::mouseClick(slice, Qt::LeftButton, Qt::NoModifier, at({1.0, 0.0, -3.0}));
    ASSERT_TRUE(job().segmentation.toothAtMm);
    EXPECT_NEAR((*job().segmentation.toothAtMm - Vec3(1.0, 0.0, -3.0)).norm(), 0.0, 0.2);
    changed();

    click("scanToolBrush");
    find<QComboBox>("scanBrushTissue")->setCurrentText(QStringLiteral("Pulp"));
    QTest::mousePress(slice, Qt::LeftButton, Qt::NoModifier, at({0, 0, -3}));
    for (int step = 1; step <= 8; ++step)
        QTest::mouseMove(slice, at({0, 0, -3.0 - 0.25 * step}));
    QTest::mouseRelease(slice, Qt::LeftButton, Qt::NoModifier, at({0, 0, -5}));
    ASSERT_GT(job().segmentation.marks.size(), 2u);
    EXPECT_EQ(job().segmentation.marks.front().tissue, Tissue::pulp);
    changed();

    click("scanToolLesion");
    QTest::mouseClick(slice, Qt::LeftButton, Qt::NoModifier, at({1.2, 0.0, 4.5}));
    ASSERT_EQ(job().segmentation.lesions.size(), 1u);
    changed();

    click("scanToolCut");
    QTest::mousePress(slice, Qt::LeftButton, Qt::NoModifier, at({-4, 0, -5.8}));
    QTest::mouseMove(slice, at({0, 0, -5.8}));
    QTest::mouseRelease(slice, Qt::LeftButton, Qt::NoModifier, at({4, 0, -5.8}));
    ASSERT_EQ(job().segmentation.cutPlanes.size(), 1u);
    // The tooth stays, its tip goes.
    EXPECT_LT(job().segmentation.cutPlanes.front().normal.z(), -0.95);
    changed();
    EXPECT_EQ(find<QListWidget>("scanDecisions")->count(), 4);

    ASSERT_TRUE(previewed()) << said();
    EXPECT_GT(volumeOf(Tissue::caries), 0.5);
    bool isAuthored = false;
    for (const segmentation::Solid& solid : model().preview()->result.region->solids)
        isAuthored = isAuthored || (solid.tissue == Tissue::caries && solid.isAuthored);
    EXPECT_TRUE(isAuthored);

    for (std::size_t i = states.size() - 1; i > 0; --i) {
        click("scanUndo");
        EXPECT_EQ(scan_case::toToml(job()), states[i - 1]);
    }
    for (std::size_t i = 1; i < states.size(); ++i) {
        click("scanRedo");
        EXPECT_EQ(scan_case::toToml(job()), states[i]);
    }
    // A stroke goes as a whole, out of the list.
    find<QListWidget>("scanDecisions")->setCurrentRow(1);
    click("scanRemove");
    EXPECT_TRUE(job().segmentation.marks.empty());
    EXPECT_EQ(job().segmentation.lesions.size(), 1u);
}

TEST_F(ScanWizardTest, APlaceWithoutAToothIsToldOfInWordsOfTheWindow) {
    openTissues();
    scan_case::ScanJob far = job();
    far.segmentation.toothAtMm = Vec3(-4.8, -4.2, -7.3);
    model().decide(far);
    ASSERT_TRUE(waitFor([this] { return model().problem().has_value() || model().isPreviewFresh(); }));
    ASSERT_TRUE(model().problem());
    EXPECT_EQ(model().problem()->id, QLatin1String("no-tooth-there")) << said();
    EXPECT_TRUE(find<QLabel>("scanProblemWhat")->isVisible());
    EXPECT_FALSE(find<QLabel>("scanProblemWhat")->text().contains(QLatin1String("detail")));
    click("scanUndo");
    EXPECT_TRUE(previewed()) << said();
}

TEST_F(ScanWizardTest, SlicesFollowWheelDragAndKeys) {
    openTissues();
    auto* slice = find<SliceView>("sliceAxial");
    for (const QPointF& pixel : {QPointF(60, 50), QPointF(120, 90)})
        EXPECT_NEAR((slice->pixelOf(slice->pointAt(slice->rect().center() + QPointF(12, 7) + pixel * 0.1)) -
                     (slice->rect().center() + QPointF(12, 7) + pixel * 0.1))
                        .manhattanLength(),
                    0.0, 1e-6);
    const int before = slice->slice();
    slice->setFocus();
    QTest::keyClick(slice, Qt::Key_PageUp);
    EXPECT_EQ(slice->slice(), before + 1);
    QWheelEvent wheel(QPointF(50, 50), slice->mapToGlobal(QPointF(50, 50)), {}, {0, -120}, Qt::NoButton, Qt::NoModifier,
                      Qt::NoScrollPhase, false);
    QApplication::sendEvent(slice, &wheel);
    EXPECT_EQ(slice->slice(), before);
    // A click moves the other two.
    auto* other = find<SliceView>("sliceSagittal");
    const int there = other->slice();
    QTest::mouseClick(slice, Qt::LeftButton, Qt::NoModifier, slice->pixelOf({2.0, 1.0, 0.0}).toPoint());
    EXPECT_NE(other->slice(), there);
    EXPECT_FALSE(model().canUndo() && job().segmentation.toothAtMm);
}

TEST_F(ScanWizardTest, StoppedInTheMiddleLeavesNothingAndGoesOn) {
    openTissues();
    model().decide([&] {
        scan_case::ScanJob next = job();
        next.name = "Egg";
        next.segmentation.spacingMm = 0.05;  // long enough to be stopped
        return next;
    }());
    const fs::path out = toPath(own_.filePath(QStringLiteral("egg.handpiece")));
    model().write(out);
    ASSERT_TRUE(waitFor([this] { return find<QAbstractButton>("scanStop")->isVisible(); }));
    QTest::qWait(150);
    click("scanStop");
    ASSERT_TRUE(idle());
    EXPECT_TRUE(model().isPaused());
    EXPECT_FALSE(model().problem()) << said();
    EXPECT_FALSE(fs::exists(out));
    for (const auto& entry : fs::directory_iterator(toPath(own_.path())))
        EXPECT_EQ(entry.path().filename(), unfinished().filename()) << entry.path();
    EXPECT_TRUE(find<QAbstractButton>("scanAgain")->isVisible());
    // Another decision, and it works again.
    model().undo();
    click("scanNext");
    ASSERT_TRUE(waitFor([this] { return model().isFullFresh() || model().problem(); }));
    EXPECT_TRUE(model().isFullFresh()) << said();
}

TEST_F(ScanWizardTest, AClosedWizardIsGoneOnWith) {
    openTissues();
    scan_case::ScanJob next = job();
    next.segmentation.lesions.push_back({Vec3(1, 0, 4), Vec3::Constant(0.8)});
    next.name = "Half an egg";
    model().decide(next);
    const std::string decided = scan_case::toToml(job());
    open();
    EXPECT_TRUE(find<QFrame>("scanUnfinished")->isVisible());
    EXPECT_TRUE(job().source.empty());
    click("scanGoOn");
    EXPECT_EQ(scan_case::toToml(job()), decided);
    ASSERT_TRUE(waitFor([this] { return model().scan() != nullptr; })) << said();
    ASSERT_TRUE(wizard_->goTo(ScanWizard::tissues));
    EXPECT_FALSE(find<QFrame>("scanUnfinished")->isVisible());
    open();
    click("scanAnew");
    open();
    EXPECT_FALSE(find<QFrame>("scanUnfinished")->isVisible());
}

TEST_F(ScanWizardTest, ABrokenFileIsToldOfOnce) {
    const std::string whole = textOf(scanFile());
    const fs::path broken = toPath(own_.filePath(QStringLiteral("broken.nrrd")));
    core::writeFile(broken, std::string_view(whole).substr(0, whole.size() / 2));
    wizard_->take(toQString(broken));
    ASSERT_TRUE(waitFor([this] { return model().problem().has_value(); }));
    ASSERT_TRUE(idle());
    EXPECT_TRUE(find<QFrame>("scanProblem")->isVisible());
    const QString what = find<QLabel>("scanProblemWhat")->text();
    EXPECT_TRUE(what.contains(QLatin1String("broken.nrrd"))) << what.toStdString();
    EXPECT_FALSE(find<QLabel>("scanProblemRemedy")->text().isEmpty());
    EXPECT_FALSE(wizard_->goTo(ScanWizard::placing));
    // The next file is another matter.
    wizard_->take(toQString(scanFile()));
    EXPECT_FALSE(find<QFrame>("scanProblem")->isVisible());
    ASSERT_TRUE(waitFor([this] { return model().scan() != nullptr; })) << said();
}

TEST_F(ScanWizardTest, WhatIsNoScanIsToldOfByADrop) {
    const fs::path text = toPath(own_.filePath(QStringLiteral("letter.txt")));
    core::writeFile(text, std::string_view("Dear colleague"));
    auto* page = find<ChoosePage>("scanChoose");
    QMimeData data;
    data.setUrls({QUrl::fromLocalFile(toQString(text))});
    QDragEnterEvent enter(QPoint(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(page, &enter);
    EXPECT_TRUE(enter.isAccepted());
    QDropEvent drop(QPointF(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(page, &drop);
    ASSERT_TRUE(waitFor([this] { return model().problem().has_value(); }));
    EXPECT_FALSE(model().problem()->remedy.isEmpty());
    EXPECT_FALSE(find<QPushButton>("scanNext")->isEnabled());
}

TEST_F(ScanWizardTest, SpacingIsAskedForWhereTheScanDoesNotTellIt) {
    const fs::path folder = toPath(own_.filePath(QStringLiteral("slices")));
    volume::writeScan(toothVolume(), folder, volume::ScanFormat::png);
    fs::remove(folder / "scan.toml");
    wizard_->take(toQString(folder));
    ASSERT_TRUE(waitFor([this] { return model().isSeriesKnown() || model().problem(); })) << said();
    ASSERT_TRUE(idle());
    EXPECT_TRUE(model().isSpacingAsked());
    EXPECT_FALSE(find<QPushButton>("scanNext")->isEnabled());
    click("scanEstimate");
    ASSERT_TRUE(waitFor([this] { return model().molarSpacingMm() || model().problem(); })) << said();
    // The tooth is 13 mm of 65 voxels; a mean molar would be 21.
    ASSERT_TRUE(model().molarSpacingMm());
    EXPECT_NEAR(model().molarSpacingMm()->x(), kVoxelMm * kMeanMolarMm / (2.0 * kOuterMm.z()), 0.02);
    ASSERT_TRUE(job().spacingMm);
    ASSERT_TRUE(waitFor([this] { return model().scan() != nullptr || model().problem(); })) << said();
    EXPECT_TRUE(find<QPushButton>("scanNext")->isEnabled());
    // Nor does it tell left from right.
    const auto isTold = [this](const char* text) {
        return find<QLabel>("scanNotes")->text().contains(QLatin1String(text));
    };
    EXPECT_TRUE(isTold("left and right may be swapped"));
    const float first = model().scan()->scan->volume.values.front();
    find<QCheckBox>("scanReverse")->setChecked(true);
    EXPECT_TRUE(job().reverseSlices);
    ASSERT_TRUE(waitFor([this] { return model().scan() != nullptr || model().problem(); })) << said();
    EXPECT_FALSE(isTold("left and right may be swapped"));
    EXPECT_TRUE(isTold("read from the other end"));
    const volume::Volume& turned = model().scan()->scan->volume;
    EXPECT_EQ(turned.values[turned.grid.index(0, 0, turned.grid.size[2] - 1)], first);
}

TEST_F(ScanWizardTest, LabelsAreTakenAsTheyAre) {
    const volume::Volume grey = toothVolume();
    volume::Labels labels;
    labels.grid = grey.grid;
    std::array<double, 8> count{};
    for (int k = 0; k < grey.grid.size[2]; ++k)
        for (int j = 0; j < grey.grid.size[1]; ++j)
            for (int i = 0; i < grey.grid.size[0]; ++i) {
                const Vec3 p = grey.grid.toMm(Vec3(i, j, k));
                const std::uint8_t label = inside(p, kOuterMm) <= 0                                ? 0
                                           : inside(p, kPulp * kOuterMm) > 0                       ? 4
                                           : inside(p, kDentine * kOuterMm) > 0 || p.z() < kNeckMm ? 3
                                                                                                   : 2;
                labels.values.push_back(label);
                ++count[label];
            }
    const fs::path file = toPath(own_.filePath(QStringLiteral("labels.nrrd")));
    volume::writeLabels(labels, file);
    wizard_->take(toQString(file));
    ASSERT_TRUE(waitFor([this] { return model().isSeriesKnown() || model().problem(); })) << said();
    find<QCheckBox>("scanIsLabels")->setChecked(true);
    ASSERT_TRUE(waitFor([this] { return (model().scan() && model().scan()->labels) || model().problem(); })) << said();
    auto* numbers = find<QComboBox>("scanNumbers");
    ASSERT_TRUE(numbers->isVisible());
    QTest::keyClick(numbers, Qt::Key_End);
    EXPECT_EQ(job().labelNumbers, segmentation::LabelNumbers::tissues);
    QTest::keyClick(numbers, Qt::Key_Home);
    EXPECT_FALSE(job().labelNumbers);
    ASSERT_TRUE(waitFor([this] { return (model().scan() && model().scan()->labels) || model().problem(); })) << said();
    ASSERT_TRUE(wizard_->goTo(ScanWizard::tissues));
    ASSERT_TRUE(previewed()) << said();
    EXPECT_FALSE(find<HistogramView>("histogram")->isVisible());
    for (const auto& [tissue, label] :
         {std::pair{Tissue::enamel, 2}, std::pair{Tissue::dentine, 3}, std::pair{Tissue::pulp, 4}}) {
        const double mm3 = count[static_cast<std::size_t>(label)] * labels.grid.voxelMm3();
        EXPECT_NEAR(volumeOf(tissue), mm3, 0.05 * mm3 + 0.3) << label;
    }
}

TEST_F(ScanWizardTest, OnlyAPartIsRead) {
    openTissues();
    ASSERT_TRUE(wizard_->goTo(ScanWizard::choose));
    const auto size = model().scan()->scan->volume.grid.size;
    find<QCheckBox>("scanPart")->setChecked(true);
    ASSERT_TRUE(waitFor([this] { return model().scan() != nullptr || model().problem(); })) << said();
    EXPECT_EQ(model().scan()->scan->volume.grid.size, size) << "at first the box holds all of it";
    const std::array<Vec3, 2> all = *job().regionMm;
    auto* upTo = find<QDoubleSpinBox>("scanPartToZ");
    upTo->setFocus();
    upTo->selectAll();
    QTest::keyClicks(upTo, QLocale().toString(0.5 * (all[0].z() + all[1].z()), 'f', 1));
    QTest::keyClick(upTo, Qt::Key_Return);
    ASSERT_TRUE(waitFor([&] {
        return (model().scan() && model().scan()->scan->volume.grid.size[2] < size[2]) || model().problem();
    })) << said();
    EXPECT_NEAR(model().scan()->scan->volume.grid.size[2], 0.5 * size[2], 1.5);
    EXPECT_EQ(model().scan()->scan->volume.grid.size[0], size[0]);
    find<QCheckBox>("scanPart")->setChecked(false);
    EXPECT_FALSE(job().regionMm);
}

TEST_F(ScanWizardTest, StepsAreSavedForTheCommandLine) {
    openTissues();
    scan_case::ScanJob next = job();
    next.segmentation.cutPlanes.push_back({Vec3(0, 0, -6), -Vec3::UnitZ()});
    next.percents = {25};
    next.name = "Egg";
    model().decide(next);
    answer_ = own_.filePath(QStringLiteral("steps"));
    click("scanSaveSteps");
    EXPECT_EQ(scan_case::toToml(scan_case::readScanJob(toPath(answer_ + QStringLiteral(".toml")))),
              scan_case::toToml(job()));
}

TEST_F(ScanWizardTest, TheToothIsTurnedByHand) {
    openTissues();
    ASSERT_TRUE(wizard_->goTo(ScanWizard::placing));
    const auto up = [this] {
        return Vec3(model().best()->result.placed.scanInTooth.orientation.conjugate() * Vec3::UnitZ());
    };
    const Vec3 before = up();
    EXPECT_GT(before.z(), 0.95) << "the enamel lies at high z";
    click("scanUpsideDown");
    ASSERT_TRUE(previewed()) << said();
    EXPECT_NEAR((up() + before).norm(), 0.0, 1e-6);
    click("scanUndo");
    ASSERT_TRUE(previewed()) << said();
    EXPECT_NEAR((up() - before).norm(), 0.0, 1e-6);
    const Vec3 mesial = model().best()->result.placed.scanInTooth.orientation.conjugate() * Vec3::UnitX();
    click("scanTurnLeft");
    ASSERT_TRUE(previewed()) << said();
    const Vec3 turned = model().best()->result.placed.scanInTooth.orientation.conjugate() * Vec3::UnitX();
    EXPECT_NEAR(turned.dot(mesial), 0.0, 1e-6);
    EXPECT_NEAR((up() - before).norm(), 0.0, 1e-6);
    // Quadrants: mesial and occlusal say where the cheek is.
    EXPECT_EQ(buccalSignOf(16), 1);
    EXPECT_EQ(buccalSignOf(26), -1);
    EXPECT_EQ(buccalSignOf(36), 1);
    EXPECT_EQ(buccalSignOf(46), -1);
    EXPECT_EQ(buccalSignOf(0), 0);
}

TEST_F(ScanWizardTest, EveryPartHasANameOfItsOwn) {
    QMap<QString, int> names;
    for (const QWidget* widget : wizard_->findChildren<QWidget*>()) {
        if (const QString name = widget->objectName(); !name.isEmpty() && !name.startsWith(QLatin1String("qt_")))
            ++names[name];
        if (widget->focusPolicy() == Qt::NoFocus || widget->objectName().isEmpty() ||
            widget->objectName().startsWith(QLatin1String("qt_")))
            continue;
        const auto* button = qobject_cast<const QAbstractButton*>(widget);
        EXPECT_TRUE(!widget->accessibleName().isEmpty() || (button && !button->text().isEmpty()) ||
                    widget->inherits("QScrollArea") || widget->inherits("QLabel"))
            << widget->objectName().toStdString() << " has no accessible name";
    }
    for (auto it = names.begin(); it != names.end(); ++it)
        EXPECT_EQ(it.value(), 1) << it.key().toStdString();
}

/// The window that the wizard is opened from.
class ScanInWindowTest : public ShellTest {};

TEST_F(ScanInWindowTest, AFolderOfSlicesDroppedOnTheWindowOpensTheWizard) {
    startWithTooth();
    const QString folder = own_.filePath(QStringLiteral("slices"));
    volume::writeScan(toothVolume(), toPath(folder), volume::ScanFormat::png);
    drop(folder);
    auto* wizard = window().findChild<ScanWizard*>();
    ASSERT_TRUE(wizard);
    EXPECT_TRUE(wizard->isVisible());
    ASSERT_TRUE(waitFor([&] { return wizard->model().scan() != nullptr || wizard->model().problem(); }));
    EXPECT_FALSE(wizard->model().problem());
    EXPECT_FALSE(window().errorDialog());
    // The menu brings the same one to the front.
    action("actionNewScan")->trigger();
    EXPECT_EQ(window().findChildren<ScanWizard*>().size(), 1);
    // "Try it now" is the window's matter.
    const fs::path place = toPath(own_.filePath(QStringLiteral("egg.handpiece")));
    cases::writeCase(eggTooth(46), place);
    emit wizard->tryNow(toQString(place));
    ASSERT_TRUE(waitFor([&] {
        return !simulator().isBusy() && simulator().mode() == Simulator::Mode::liveSession &&
               simulator().document().caseFile == place;
    }));
    EXPECT_TRUE(waitFor([this] { return window().findChild<ScanWizard*>() == nullptr; }));
}

TEST_F(ScanInWindowTest, CasesAndMeshesAreNoScans) {
    startWithTooth();
    const fs::path folder = toPath(own_.filePath(QStringLiteral("case")));
    cases::writeCase(eggTooth(46), folder);
    drop(toQString(folder));
    EXPECT_FALSE(window().findChild<ScanWizard*>());
    ASSERT_TRUE(waitFor([&] {
        return !simulator().isBusy() && simulator().mode() == Simulator::Mode::liveSession &&
               simulator().document().caseFile == folder;
    }));
}

}  // namespace
}  // namespace handpiece::desktop::scan_wizard_test
