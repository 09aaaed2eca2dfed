// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/landmarks/landmarks_feature.h"

#include <QDockWidget>
#include <QEvent>
#include <QMessageBox>
#include <QMouseEvent>
#include <algorithm>

#include "desktop/features/landmarks/landmark_words.h"
#include "desktop/features/landmarks/landmarks_panel.h"
#include "desktop/work/simulator.h"
#include "handpiece/model/case/edit_landmarks.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/scan/landmarks/find_landmarks.h"
#include "handpiece/senses/view/camera.h"

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

bool isSame(const cases::Landmark& one, const cases::Landmark& other) {
    return one.kind == other.kind && one.name == other.name;
}
bool isAlike(const cases::Landmark& one, const cases::Landmark& other) {
    return isSame(one, other) && one.pointsMm == other.pointsMm && one.source == other.source;
}

}  // namespace

LandmarksFeature::LandmarksFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands), panel_(new LandmarksPanel) {
    askUnsaved = [this] {
        QMessageBox box(QMessageBox::Question, tr("Save the landmarks?"),
                        tr("Landmarks were changed, and no case holds that yet."),
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
    // Where there are none yet they can be found or set.
    window_.commands().enableWhile(commands_[Command::show], [this] {
        return simulator_.mode() != Simulator::Mode::empty && (!marks_.empty() || mayMove());
    });
    window_.commands().enableWhile(commands_[Command::move], [this] { return !marks_.empty() && mayMove(); });
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
    connect(&view_, &ViewWidget::toolChanged, this, [this](Tool tool) {
        commands_[Command::move]->setChecked(tool == Tool::landmarks);
        if (tool != Tool::landmarks) setPlacing(false);
    });
    connect(&view_, &ViewWidget::landmarkGrabbed, this, [this](std::size_t at) {
        if (at < shown_.size()) panel_->select(static_cast<int>(shown_[at]));
        showMarks();
    });
    connect(&view_, &ViewWidget::landmarkDragged, this, &LandmarksFeature::drag);
    connect(&view_, &ViewWidget::landmarkDropped, this, [this] { dragging_ = false; });
    connect(panel_, &LandmarksPanel::shownChanged, this, &LandmarksFeature::showMarks);
    connect(panel_, &LandmarksPanel::selectionChanged, this, [this] { showMarks(); });
    view_.installEventFilter(this);
    connect(panel_, &LandmarksPanel::findRequested, this, &LandmarksFeature::find);
    connect(panel_, &LandmarksPanel::cancelRequested, this, [this] {
        if (finding_) finding_->cancel();
    });
    connect(panel_, &LandmarksPanel::placingRequested, this, &LandmarksFeature::setPlacing);
    connect(panel_, &LandmarksPanel::deleteRequested, this, &LandmarksFeature::deleteChosen);
    connect(panel_, &LandmarksPanel::undoRequested, this, &LandmarksFeature::undo);
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
    if (finding_) return tr("Looking for landmarks...");
    if (placing_) return tr("Click the tooth where it is to be. Undo takes the last click back.");
    QStringList lines;
    if (!foundNote_.isEmpty()) lines << foundNote_;
    if (unsaved_) lines << tr("Changed, and not saved yet.");
    return lines.join(QLatin1Char('\n'));
}

void LandmarksFeature::refreshPanel() {
    LandmarksPanel::Abilities now;
    now.mayChange = mayMove();
    now.canUndo = placing_ ? !placing_->placesMm.empty() : !undone_.empty();
    now.canPutBack = toothCase_ && !isAsInCase();
    now.canSave = unsaved_ && !job_;
    now.isPlacing = placing_.has_value();
    if (finding_) now.finding = findingDone_;
    now.note = noteNow();
    panel_->setAbilities(now);
}

void LandmarksFeature::showDocument() {
    if (simulator_.toothCase() == toothCase_) return;
    toothCase_ = simulator_.toothCase();
    surface_.reset();
    if (finding_) finding_->cancel();
    placing_.reset();
    foundNote_.clear();
    expected_.clear();
    marks_ = toothCase_ ? toothCase_->landmarks : Marks{};
    undone_.clear();
    unsaved_ = false;
    panel_->setMarks(marks_);
    if (marks_.empty() && !mayMove()) commands_[Command::show]->setChecked(false);
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
    panel_->updateMarks(marks_);
    const int selected = panel_->selected();
    if (commands_[Command::show]->isChecked() && toothCase_) {
        if (expected_.empty()) expected_ = landmarks::expectedLandmarks(toothCase_->fdiNumber);
        panel_->setLacked(landmarks::lackedLandmarks(expected_, marks_));
    }
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
    const std::size_t which = shown_[at.landmark];
    if (!std::exchange(dragging_, true)) {
        before_ = marks_;
        remember();
    }
    // From where it was, so that a way there and back leaves a line as it was.
    marks_[which] = cases::moved(before_[which], at.point, toMm, surface());
    showMarks();
}

void LandmarksFeature::remember() {
    undone_.push_back(marks_);
    unsaved_ = true;
    foundNote_.clear();
}

const geometry::TriangleTree& LandmarksFeature::surface() {
    if (!surface_) surface_ = std::make_unique<geometry::TriangleTree>(toothCase_->surface());
    return *surface_;
}

bool LandmarksFeature::isAsInCase() const {
    return std::equal(marks_.begin(), marks_.end(), toothCase_->landmarks.begin(), toothCase_->landmarks.end(),
                      isAlike);
}

void LandmarksFeature::undo() {
    if (placing_) {
        if (placing_->placesMm.empty()) return;
        placing_->placesMm.pop_back();
        return drawPlaced();
    }
    if (undone_.empty()) return;
    marks_ = std::move(undone_.back());
    undone_.pop_back();
    unsaved_ = true;
    foundNote_.clear();
    showMarks();
}

/// The one chosen, or all.
void LandmarksFeature::reset() {
    const int selected = panel_->selected();
    const Marks& own = toothCase_->landmarks;
    if (selected < 0) {
        remember();
        marks_ = own;
    } else {
        cases::Landmark& mark = marks_[static_cast<std::size_t>(selected)];
        const auto there = std::find_if(own.begin(), own.end(), [&](const auto& o) { return isSame(o, mark); });
        if (there == own.end()) return;
        remember();
        mark = *there;
    }
    showMarks();
}

void LandmarksFeature::deleteChosen() {
    const int selected = panel_->selected();
    if (selected < 0 || !mayMove()) return;
    remember();
    marks_.erase(marks_.begin() + selected);
    showMarks();
}

/// Off this thread; what a person did meanwhile stays.
void LandmarksFeature::find() {
    if (finding_ || !toothCase_ || !mayMove()) return;
    setPlacing(false);
    findingDone_ = 0.0;
    const auto found = std::make_shared<Marks>();
    finding_ =
        std::make_unique<Job>(tr("Finding landmarks"), [toothCase = toothCase_, found](const core::Progress& progress) {
            *found = landmarks::findLandmarks(*toothCase, progress);
        });
    const auto end = [this] {
        finding_.release()->deleteLater();
        refreshPanel();
    };
    connect(finding_.get(), &Job::progressed, this, [this](double fraction) {
        findingDone_ = fraction;
        refreshPanel();
    });
    connect(finding_.get(), &Job::cancelled, this, end);
    connect(finding_.get(), &Job::failed, this, [this, end](const Problem& problem) {
        end();
        window_.showProblem(problem);
    });
    connect(finding_.get(), &Job::done, this, [this, end, found, asked = toothCase_] {
        end();
        if (asked == toothCase_ && mayMove()) takeFound(*found);
    });
    refreshPanel();
    finding_->start();
}

void LandmarksFeature::takeFound(const Marks& found) {
    setPlacing(false);
    remember();
    marks_ = landmarks::withFound(marks_, found);
    QStringList lacked;
    for (const cases::Landmark& mark : landmarks::lackedLandmarks(expected_, marks_))
        lacked << landmarkText(mark);
    foundNote_ = tr("Found by shape: %1.").arg(found.size());
    if (!lacked.empty()) foundNote_ += QLatin1Char(' ') + tr("Not found: %1.").arg(lacked.join(QStringLiteral("; ")));
    if (!cases::isPermanentTooth(toothCase_->fdiNumber))
        foundNote_ += QLatin1Char(' ') + tr("This tooth has no number of a permanent tooth: only what goes around it.");
    showMarks();
}

/// Begins to set the one chosen in the panel by clicks, or ends it: what has too few of them goes.
void LandmarksFeature::setPlacing(bool isPlacing) {
    if (isPlacing == placing_.has_value()) return refreshPanel();
    if (isPlacing) {
        if (!mayMove() || !toothCase_) return refreshPanel();
        placing_ = Placing{panel_->kindToSet(), panel_->nameToSet(), marks_, {}};
        view_.setTool(Tool::landmarks);
        if (view_.tool() != Tool::landmarks) placing_.reset();
    } else {
        const Placing done = std::move(*placing_);
        placing_.reset();
        if (done.placesMm.size() >= cases::shapeOf(done.kind).least) {
            undone_.push_back(done.before);
            unsaved_ = true;
            foundNote_.clear();
        } else {
            marks_ = done.before;
        }
    }
    if (placing_)
        view_.setCursor(Qt::CrossCursor);
    else if (view_.tool() == Tool::landmarks)
        view_.setCursor(Qt::OpenHandCursor);
    showMarks();
}

bool LandmarksFeature::eventFilter(QObject* watched, QEvent* event) {
    const bool isPress = event->type() == QEvent::MouseButtonPress || event->type() == QEvent::MouseButtonDblClick;
    if (watched == &view_ && placing_ && isPress) {
        const auto* press = static_cast<QMouseEvent*>(event);
        if (press->button() == Qt::LeftButton && press->modifiers() == Qt::NoModifier)
            return placeAt(press->position());
    }
    return Feature::eventFilter(watched, event);
}

/// On the uncut tooth, which they are of.
bool LandmarksFeature::placeAt(const QPointF& pixel) {
    constexpr double kFarMm = 400.0, kSamePlaceMm = 0.02;  // the second half of a double click
    const int half = view_.isComparing() ? view_.width() / 2 : view_.width();
    const double x = pixel.x() < half ? pixel.x() : pixel.x() - half;
    const view::Ray ray = view::rayThrough(view_.camera(), {half, view_.height()}, {x, pixel.y()});
    core::Vec3 from = ray.originMm;
    if (const auto section = view_.section()) {  // what was cut off is not in the way
        const view::Plane plane = planeOf(*section);
        const double beyond = plane.normal.dot(from) - plane.offsetMm, closing = plane.normal.dot(ray.direction);
        if (beyond > 0.0 && closing < -1e-9) from += ray.direction * (beyond / -closing);
    }
    // What is in the pulp where one would see it, were the rest of glass.
    core::Vec3 at = from;
    const auto meet = [&](const geometry::TriangleTree& tree) {
        const geometry::RayMeeting met = tree.firstMeeting(from, ray.direction, kFarMm);
        if (met.triangle == geometry::kNoTriangle) return false;
        at = from + met.distanceMm * ray.direction;
        return true;
    };
    bool isThere = false;
    if (placing_->kind == cases::LandmarkKind::pulpHorn || placing_->kind == cases::LandmarkKind::orifice)
        for (const cases::Part& part : toothCase_->parts)
            if (part.tissue == cases::Tissue::pulp) isThere = isThere || meet(geometry::TriangleTree(part.mesh));
    if (!isThere && !meet(surface())) return true;
    if (!placing_->placesMm.empty() && (placing_->placesMm.back() - at).norm() < kSamePlaceMm) return true;
    placing_->placesMm.push_back(at);
    drawPlaced();
    if (placing_->placesMm.size() >= cases::shapeOf(placing_->kind).most) setPlacing(false);
    return true;
}

/// In place of one that has its kind and name.
void LandmarksFeature::drawPlaced() {
    marks_ = placing_->before;
    if (!placing_->placesMm.empty()) {
        const cases::Landmark mark = cases::drawn(placing_->kind, placing_->name, placing_->placesMm, surface());
        auto at = std::find_if(marks_.begin(), marks_.end(), [&](const auto& m) { return isSame(m, mark); });
        at = at == marks_.end() ? marks_.insert(at, mark) : (*at = mark, at);
        panel_->updateMarks(marks_);
        panel_->select(static_cast<int>(at - marks_.begin()));
    }
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
    job_ = std::make_unique<Job>(tr("Saving the landmarks"), [place, isOwn, toothCase = toothCase_, marks = marks_,
                                                              outside = simulator_.outside()](const core::Progress&) {
        if (isOwn) {
            cases::writeLandmarks(place, marks);
        } else {
            cases::Case changed = *toothCase;
            changed.landmarks = marks;
            cases::writeCase(changed, place);
        }
        outside->made(place);
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
        if (std::equal(saved.begin(), saved.end(), marks_.begin(), marks_.end(), isAlike)) unsaved_ = false;
        end();
        window_.tellSaved(toQString(place));
        if (then) then();
    });
    refreshPanel();
    job_->start();
}

}  // namespace handpiece::desktop
