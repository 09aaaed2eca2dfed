// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/landmarks/landmarks_feature.h"

#include <QDockWidget>
#include <QMessageBox>
#include <algorithm>

#include "desktop/features/landmarks/landmark_words.h"
#include "desktop/features/landmarks/landmarks_panel.h"
#include "desktop/work/simulator.h"
#include "handpiece/model/case/edit_landmarks.h"

namespace handpiece::desktop {
namespace {

using exercise::Operation;

using Command = LandmarksFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::show, "actionLandmarks", QT_TRANSLATE_NOOP("Commands", "Landmarks"),
     QT_TRANSLATE_NOOP("Commands", "Cusp tips, fissures, ridges, contacts and the like over the tooth, and their list"),
     "check", "Ctrl+J", in(Shelf::tools, 17), kCheckable, Operation::guidance},
    {Command::move, "actionMoveLandmarks", QT_TRANSLATE_NOOP("Commands", "Move landmarks"),
     QT_TRANSLATE_NOOP("Commands", "For teachers: drag a landmark over the tooth"), "touch", "Ctrl+Shift+J",
     in(Shelf::tools, 18), kCheckable, Operation::guidance},
};

}  // namespace

LandmarksFeature::LandmarksFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands), panel_(new LandmarksPanel) {
    askUnsaved = [this] {
        QMessageBox box(QMessageBox::Question, tr("Save the landmarks?"),
                        tr("Landmarks were moved, and no case holds that yet."),
                        QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, &window_);
        box.setObjectName(QStringLiteral("landmarksUnsaved"));
        box.setDefaultButton(QMessageBox::Save);
        const int answer = box.exec();
        return answer == QMessageBox::Save      ? Questions::Unsaved::save
               : answer == QMessageBox::Discard ? Questions::Unsaved::discard
                                                : Questions::Unsaved::cancel;
    };
    QDockWidget* dock = window_.docks().add({"landmarksDock",
                                             tr("Landmarks"),
                                             65,
                                             {{Detail::practice, Qt::RightDockWidgetArea, 70, 260, "soundDock"},
                                              {Detail::laboratory, Qt::RightDockWidgetArea, 70, 260}},
                                             [this] { return commands_[Command::show]->isChecked(); }},
                                            panel_);
    const auto hasMarks = [this] { return simulator_.mode() != Simulator::Mode::empty && !marks_.empty(); };
    window_.commands().enableWhile(commands_[Command::show], hasMarks);
    window_.commands().enableWhile(commands_[Command::move], [this, hasMarks] { return hasMarks() && mayMove(); });
    on(commands_[Command::show], [this, dock](bool isOn) {
        if (!isOn && view_.tool() == Tool::landmarks) view_.setTool(Tool::drill);
        window_.docks().showWanted();
        if (isOn) {
            dock->raise();
            window_.resizeDocks({dock}, {260}, Qt::Vertical);
        }
        showMarks();
    });
    on(commands_[Command::move], [this](bool isOn) {
        if (isOn && !commands_[Command::show]->isChecked()) commands_[Command::show]->trigger();
        view_.setTool(isOn ? Tool::landmarks : Tool::drill);
    });
    connect(&view_, &ViewWidget::toolChanged, this,
            [this](Tool tool) { commands_[Command::move]->setChecked(tool == Tool::landmarks); });
    connect(&view_, &ViewWidget::landmarkGrabbed, this, [this](std::size_t at) {
        if (at < shown_.size()) panel_->select(static_cast<int>(shown_[at]));
        showMarks();
    });
    connect(&view_, &ViewWidget::landmarkDragged, this, &LandmarksFeature::drag);
    connect(&view_, &ViewWidget::landmarkDropped, this, [this] { dragging_ = false; });
    connect(panel_, &LandmarksPanel::shownChanged, this, &LandmarksFeature::showMarks);
    connect(panel_, &LandmarksPanel::selectionChanged, this, [this] { showMarks(); });
    connect(panel_, &LandmarksPanel::undoRequested, this, [this] {
        if (undone_.empty()) return;
        marks_ = std::move(undone_.back());
        undone_.pop_back();
        unsaved_ = true;
        showMarks();
    });
    connect(panel_, &LandmarksPanel::resetRequested, this, &LandmarksFeature::reset);
    connect(panel_, &LandmarksPanel::saveRequested, this, [this] { save(); });
    // What was moved is asked about before another tooth comes, as what was cut is.
    const auto mayLeave = window_.whenMayLeave;
    window_.whenMayLeave = [this, mayLeave](std::function<void()> then) {
        mayLeave([this, then = std::move(then)] {
            const Questions::Unsaved answer = unsaved_ ? askUnsaved() : Questions::Unsaved::discard;
            if (answer == Questions::Unsaved::cancel) return;
            if (answer == Questions::Unsaved::save) return save(then);
            unsaved_ = false;
            then();
        });
    };
}

/// While one works at a tooth that is no exercise: there they are given, and read only.
bool LandmarksFeature::mayMove() const {
    return simulator_.mode() == Simulator::Mode::liveSession && simulator_.exercise() == nullptr;
}

QString LandmarksFeature::noteNow() const {
    if (simulator_.exercise() != nullptr) return tr("In an exercise landmarks are read only.");
    if (simulator_.mode() != Simulator::Mode::liveSession) return tr("What is only watched is read only.");
    return unsaved_ ? tr("Moved, and not saved yet.") : QString();
}

void LandmarksFeature::refreshPanel() {
    panel_->setAbilities(mayMove(), !undone_.empty(), unsaved_ && !job_, noteNow());
}

void LandmarksFeature::showDocument() {
    if (simulator_.toothCase() == toothCase_) return;
    toothCase_ = simulator_.toothCase();
    surface_.reset();
    marks_ = toothCase_ ? toothCase_->landmarks : Marks{};
    undone_.clear();
    unsaved_ = false;
    panel_->setMarks(marks_);
    if (marks_.empty()) commands_[Command::show]->setChecked(false);
    window_.docks().showWanted();
    showMarks();
}

void LandmarksFeature::showTick() {
    if (commands_[Command::show]->isChecked() && !view_.permissions().allows(Operation::guidance)) {
        commands_[Command::show]->setChecked(false);
        window_.docks().showWanted();
        showMarks();
    }
}

/// To the picture and the list, as they are.
void LandmarksFeature::showMarks() {
    std::vector<ShownLandmark> shown;
    shown_.clear();
    std::optional<LandmarkPoint> chosen;
    const int selected = panel_->selected();
    panel_->updateMarks(marks_);
    for (std::size_t i = 0; commands_[Command::show]->isChecked() && i < marks_.size(); ++i) {
        const bool isChosen = static_cast<int>(i) == selected;
        if (!panel_->isChecked(i) && !isChosen) continue;
        const cases::Landmark& mark = marks_[i];
        if (isChosen) chosen = LandmarkPoint{shown.size(), mark.pointsMm.size() / 2};
        shown.push_back({mark.pointsMm,
                         landmarkText(mark),
                         cases::shapeOf(mark.kind).isRing,
                         !cases::liesOnSurface(mark.kind),
                         isChosen,
                         {}});
        shown_.push_back(i);
    }
    view_.setLandmarks(std::move(shown));
    // The arrow keys move the one chosen in the list, at its middle.
    if (!dragging_ && view_.grabbedLandmark().value_or(LandmarkPoint{shown_.size(), 0}).landmark !=
                          chosen.value_or(LandmarkPoint{shown_.size(), 0}).landmark)
        view_.grabLandmark(chosen);
    refreshPanel();
}

void LandmarksFeature::drag(const LandmarkPoint& at, const core::Vec3& toMm) {
    if (!mayMove() || at.landmark >= shown_.size() || !toothCase_) return;
    if (!surface_) surface_ = std::make_unique<geometry::TriangleTree>(toothCase_->surface());
    const std::size_t which = shown_[at.landmark];
    if (!std::exchange(dragging_, true)) undone_.push_back(before_ = marks_);
    // From where it was, so that a way there and back leaves a line as it was.
    marks_[which] = cases::moved(before_[which], at.point, toMm, *surface_);
    unsaved_ = true;
    showMarks();
}

void LandmarksFeature::reset() {
    const int selected = panel_->selected();
    Marks back = marks_;
    for (std::size_t i = 0; i < back.size(); ++i)
        if (selected < 0 || static_cast<int>(i) == selected) back[i] = toothCase_->landmarks[i];
    undone_.push_back(std::exchange(marks_, std::move(back)));
    unsaved_ = true;
    showMarks();
}

/// The file of which they are the own tooth's; empty: none that they could go into.
std::filesystem::path LandmarksFeature::ownPlace() const {
    const Document& document = simulator_.document();
    if (document.starter || document.workedOn != 0 || !document.attemptFile.empty()) return {};
    std::error_code error;
    const bool isCase =
        std::filesystem::is_directory(document.caseFile, error) || document.caseFile.extension() == ".handpiece";
    return isCase ? document.caseFile : std::filesystem::path();
}

void LandmarksFeature::save(std::function<void()> then) {
    if (job_ || !toothCase_) return;
    std::filesystem::path place = ownPlace();
    const bool isOwn = !place.empty();
    if (!isOwn) {
        const QString name = QString::fromStdString(simulator_.document().name) + QStringLiteral(".handpiece");
        const QString file = window_.questions.save(tr("Save as a case with these landmarks"), name,
                                                    tr("Case (*.handpiece)"), QStringLiteral(".handpiece"));
        if (file.isEmpty()) return;
        place = toPath(file);
    }
    job_ = std::make_unique<Job>(tr("Saving the landmarks"),
                                 [place, isOwn, toothCase = toothCase_, marks = marks_](const core::Progress&) {
                                     if (isOwn) return cases::writeLandmarks(place, marks);
                                     cases::Case changed = *toothCase;
                                     changed.landmarks = marks;
                                     cases::writeCase(changed, place);
                                 });
    const auto end = [this] {
        job_.release()->deleteLater();
        refreshPanel();
    };
    connect(job_.get(), &Job::failed, this, [this, end](const Problem& problem) {
        end();
        window_.showProblem(problem);
    });
    connect(job_.get(), &Job::done, this, [this, end, place, saved = marks_, then = std::move(then)] {
        if (std::equal(saved.begin(), saved.end(), marks_.begin(), marks_.end(),
                       [](const auto& a, const auto& b) { return a.pointsMm == b.pointsMm && a.source == b.source; }))
            unsaved_ = false;
        end();
        window_.tellSaved(toQString(place));
        if (then) then();
    });
    refreshPanel();
    job_->start();
}

}  // namespace handpiece::desktop
