// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/exercises_dialog.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QVBoxLayout>
#include <algorithm>
#include <array>
#include <utility>

#include "desktop/features/exercise/assessment_words.h"
#include "desktop/framework/helps.h"
#include "desktop/picture/solid_view.h"
#include "desktop/picture/start_view.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/scrolled.h"
#include "desktop/widgets/theme.h"
#include "desktop/work/bur_words.h"
#include "handpiece/app/course/shipped_exercises.h"

namespace handpiece::desktop {

namespace fs = std::filesystem;

namespace {

/// In words; empty for what is no level.
QString levelWords(const std::string& level) {
    constexpr std::array<const char*, tasks::kLevels.size()> kWords = {
        QT_TRANSLATE_NOOP("handpiece::desktop::ExercisesDialog", "beginner"),
        QT_TRANSLATE_NOOP("handpiece::desktop::ExercisesDialog", "basic"),
        QT_TRANSLATE_NOOP("handpiece::desktop::ExercisesDialog", "intermediate"),
        QT_TRANSLATE_NOOP("handpiece::desktop::ExercisesDialog", "advanced")};
    const auto at = std::find(tasks::kLevels.begin(), tasks::kLevels.end(), level);
    return at == tasks::kLevels.end()
               ? QString()
               : ExercisesDialog::tr(kWords[static_cast<std::size_t>(at - tasks::kLevels.begin())]);
}

}  // namespace

ExercisesDialog::ExercisesDialog(fs::path madeIn, QWidget* parent)
    : QDialog(parent),
      madeIn_(std::move(madeIn)),
      list_(named(new QListWidget(this), "exercisesList", tr("Exercises"))),
      view_(new SolidView("exercisesIdeal", this)),
      progress_(named(new QProgressBar(this), "exercisesProgress", tr("Preparing what is shown"))),
      begin_(named(new QPushButton(tr("Begin"), this), "exercisesBegin", tr("Begin"),
                   tr("Open the tooth of this exercise and work on it"))),
      retest_(named(new QPushButton(tr("Without helps"), this), "exercisesRetest", tr("Without helps"),
                    tr("Show what was lost once more, by yourself: no depth, no section, no glass"))) {
    setObjectName(QStringLiteral("exercisesDialog"));
    setWindowTitle(tr("Exercises"));
    view_->setPlaceholder({});
    auto* left = new QVBoxLayout;
    left->addWidget(list_, 1);
    next_ = named(new QPushButton(this), "exercisesNextStep", tr("Next step"),
                  tr("The first in the list that is not passed yet"));
    next_->setFlat(true);
    next_->hide();
    left->addWidget(next_);
    connect(next_, &QPushButton::clicked, this, [this] { list_->setCurrentRow(nextRow_); });
    where_ = note({}, this, "exercisesWhere");
    left->addWidget(where_);
    auto* folder = named(new QPushButton(tr("Folder..."), this), "exercisesFolder", tr("Folder..."),
                         tr("Choose a folder with exercises of your school"));
    left->addWidget(folder);
    auto* about = new QVBoxLayout;
    const auto text = [&](const char* object, const QString& name) {
        auto* label = named(new QLabel(this), object, name);
        label->setTextFormat(Qt::PlainText);
        label->setWordWrap(true);
        label->setTextInteractionFlags(Qt::TextSelectableByMouse);
        about->addWidget(label);
        return label;
    };
    title_ = text("exercisesTitle", tr("Title of the exercise"));
    title_->setFont(scaledFont(font(), 1.3, true));
    words_ = text("exercisesWords", tr("What to do"));
    about_ = text("exercisesAbout", tr("Tooth, bur and helps"));
    best_ = text("exercisesBest", tr("Best so far"));
    best_->setFont(scaledFont(font(), 1.0, true));
    due_ = text("exercisesDue", tr("Due"));
    view_->setMinimumHeight(200);
    about->addWidget(view_, 1);
    asks_ = text("exercisesAsks", tr("What is judged"));
    about->removeWidget(asks_);
    auto* scroll = new QScrollArea(this);
    scroll->setWidget(asks_);
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setMaximumHeight(130);
    asks_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
    about->addWidget(scroll);
    note_ = text("exercisesNote", tr("What is wrong"));
    auto* right = new QVBoxLayout;
    right->addWidget(new Scrolled(about, this), 1);
    auto* below = new QHBoxLayout;
    progress_->setRange(0, 1000);
    progress_->setTextVisible(false);
    below->addWidget(progress_, 1);
    below->addStretch();
    begin_->setDefault(true);
    below->addWidget(retest_);
    below->addWidget(begin_);
    right->addLayout(below);
    auto* row = new QHBoxLayout(this);
    row->addLayout(left, 2);
    row->addLayout(right, 5);
    resize(980, 720);
    connect(list_, &QListWidget::currentRowChanged, this, &ExercisesDialog::choose);
    connect(folder, &QPushButton::clicked, this, &ExercisesDialog::folderRequested);
    connect(begin_, &QPushButton::clicked, this, [this] { emit beginRequested(path_, false); });
    connect(retest_, &QPushButton::clicked, this, [this] { emit beginRequested(path_, true); });
}

ExercisesDialog::~ExercisesDialog() = default;

void ExercisesDialog::setFolder(const fs::path& folder) {
    folder_ = folder;
    entries_.clear();
    if (isVisible()) list();
}

void ExercisesDialog::showEvent(QShowEvent* event) {
    QDialog::showEvent(event);
    if (entries_.empty())
        list();
    else
        showTask();  // what is best may be another by now
    showDue();
}

void ExercisesDialog::list() {
    giveUp();
    entries_.clear();
    for (const course::Shipped& shipped : course::shippedExercises())
        entries_.push_back({shipped.id, {}, shipped.exercise.title, {}, true});
    where_->setText(folder_.empty() ? tr("Those of the program.") : tr("And those in %1").arg(toQString(folder_)));
    const auto fill = [this] {
        const QSignalBlocker quiet(list_);
        list_->clear();
        for (const Entry& entry : entries_) {
            auto* item = new QListWidgetItem(inThisLanguage(entry.title), list_);
            if (item->text().isEmpty()) item->setText(toQString(entry.path.filename()));
            if (!entry.wrong.isEmpty()) item->setToolTip(entry.wrong);
        }
        list_->setCurrentRow(0);
        showDue();
    };
    fill();
    if (folder_.empty()) return choose(0);
    const auto found = std::make_shared<std::vector<course::Found>>();
    start(
        tr("Reading the folder"),
        [found, folder = folder_](const core::Progress& progress) { *found = course::exercisesIn(folder, progress); },
        [this, found, fill] {
            for (const course::Found& one : *found) {
                Entry entry{toQString(one.path.filename()).toStdString(), one.path, {}, {}, false};
                if (one.error) entry.wrong = problemOf(*one.error).what;
                if (one.task) entry.id = one.task->id;
                if (one.task && one.task->toothCase.exercise) entry.title = one.task->toothCase.exercise->title;
                entries_.push_back(std::move(entry));
            }
            fill();
            choose(0);
        });
}

/// In the list by a word behind the title: whoever looks for something to do finds it, and nobody is pressed.
void ExercisesDialog::showDue() {
    nextRow_ = -1;  // the first of the program's own, which come in their order, that is not passed yet
    for (int row = 0; row < list_->count(); ++row) {
        const Entry& entry = entries_[static_cast<std::size_t>(row)];
        QString title = inThisLanguage(entry.title);
        if (title.isEmpty()) title = toQString(entry.path.filename());
        QListWidgetItem* item = list_->item(row);
        const std::optional<Reached> reached = entry.id.empty() ? std::nullopt : reachedAt(entry.id);
        item->setText(entryWords(title, reached, !entry.id.empty() && !dueOf(entry.id).empty()));
        if (entry.isShipped && nextRow_ < 0 && !(reached && reached->isPassed)) {
            nextRow_ = row;
            next_->setText(tr("Next step: %1").arg(title));
        }
    }
    next_->setVisible(nextRow_ >= 0);
}

void ExercisesDialog::chooseAfter(const std::string& id) {
    if (entries_.empty()) list();
    const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.id == id; });
    const auto next = at == entries_.end() ? 0 : static_cast<std::size_t>(at - entries_.begin() + 1) % entries_.size();
    list_->setCurrentRow(static_cast<int>(next));
}

void ExercisesDialog::chooseExercise(const std::string& id) {
    if (entries_.empty()) list();
    const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.id == id; });
    if (at != entries_.end()) list_->setCurrentRow(static_cast<int>(at - entries_.begin()));
}

void ExercisesDialog::giveUp() {
    if (!job_) return;
    std::exchange(job_, nullptr)->abandon(this);
    progress_->hide();
}

void ExercisesDialog::start(const QString& what, Job::Work work, std::function<void()> done) {
    giveUp();
    job_ = new Job(what, std::move(work), this);
    progress_->setAccessibleName(what);
    progress_->setToolTip(what);
    progress_->setValue(0);
    progress_->show();
    view_->setPlaceholder(what);
    const auto end = [this] {
        job_->deleteLater();
        job_ = nullptr;
        progress_->hide();
        view_->setPlaceholder({});
    };
    connect(job_, &Job::progressed, this,
            [this](double fraction) { progress_->setValue(static_cast<int>(1000.0 * fraction)); });
    connect(job_, &Job::done, this, [end, done = std::move(done)] {
        end();
        done();
    });
    connect(job_, &Job::failed, this, [this, end](const Problem& problem) {
        end();
        note_->setText(QStringList{problem.what, problem.where, problem.remedy}.join(QLatin1Char('\n')).trimmed());
        note_->show();
    });
    job_->start();
}

void ExercisesDialog::choose(int row) {
    giveUp();
    task_.reset();
    ideal_.reset();
    path_.clear();
    showTask();
    if (row < 0 || row >= static_cast<int>(entries_.size())) return;
    const Entry& entry = entries_[static_cast<std::size_t>(row)];
    title_->setText(inThisLanguage(entry.title));
    if (!entry.wrong.isEmpty()) {
        note_->setText(entry.wrong);
        note_->show();
        return;
    }
    struct Read {
        fs::path path;
        std::shared_ptr<const tasks::Task> task;
    };
    const auto read = std::make_shared<Read>();
    start(
        tr("Opening the exercise"),
        [read, entry, madeIn = madeIn_](const core::Progress& progress) {
            course::Made made = entry.isShipped ? course::makeShipped(entry.id, madeIn, progress)
                                                : course::Made{entry.path, tasks::readTask(entry.path)};
            read->path = std::move(made.path);
            read->task = std::make_shared<const tasks::Task>(std::move(made.task));
        },
        [this, read] {
            task_ = read->task;
            path_ = read->path;
            showTask();
            makeIdeal();
        });
}

void ExercisesDialog::makeIdeal() {
    const auto ideal = std::make_shared<course::Parts>();
    start(
        tr("Cutting the ideal"),
        [ideal, task = task_](const core::Progress& progress) { *ideal = course::idealOf(*task, progress); },
        [this, ideal] {
            ideal_ = *ideal;
            if (!ideal_) return;
            core::Box box;
            for (const cases::Part& part : *ideal_)
                for (const core::Vec3& v : part.mesh.vertices)
                    box.extend(v);
            view_->setParts(ideal_, box);
            view_->setCaption(tr("The ideal: drag to turn it"), false);
            view_->lookFrom(view::StandardView::oblique,
                            view::standingOf(task_->toothCase.fdiNumber, task_->toothCase.buccalSign));
            // As one begins: a cavity on the far side would not be seen.
            if (const auto& exercise = task_->toothCase.exercise; exercise && exercise->view)
                view_->setCamera(lookingAs({}, *exercise->view));
        });
}

void ExercisesDialog::showTask() {
    begin_->setEnabled(task_ != nullptr);
    const std::vector<std::string> due = task_ ? dueOf(task_->id) : std::vector<std::string>();
    retest_->setVisible(!due.empty());
    note_->clear();
    note_->hide();
    const auto show = [](QLabel* label, const QString& words) {
        label->setText(words);
        label->setVisible(!words.isEmpty());
    };
    if (!task_) {
        for (QLabel* label : {words_, about_, best_, due_, asks_})
            show(label, {});
        view_->setParts(nullptr, {});
        view_->setCaption({}, false);
        return;
    }
    view_->setAxesShown(task_->toothCase.fdiNumber != 0, task_->toothCase.buccalSign);
    const cases::Exercise exercise = task_->toothCase.exercise.value_or(cases::Exercise{});
    title_->setText(exercise.title.empty() ? QString::fromStdString(task_->id) : inThisLanguage(exercise.title));
    show(words_, inThisLanguage(exercise.instructions));
    QStringList about;
    if (task_->toothCase.fdiNumber != 0) about << tr("Tooth %1").arg(task_->toothCase.fdiNumber);
    if (const QString level = levelWords(task_->level); !level.isEmpty()) about << level;
    if (task_->minutes) about << tr("%1 minutes").arg(*task_->minutes);
    QStringList burs;
    for (const std::string& bur : exercise.allowedBurs)
        burs << QString::fromStdString(bur);
    if (!burs.isEmpty())
        about << tr("Burs: %1").arg(burs.join(QStringLiteral(", ")));
    else if (!exercise.bur.empty())
        about << tr("Bur to begin with: %1").arg(QString::fromStdString(exercise.bur));
    if (!task_->drive.empty())
        about << tr("Drive to begin with: %1").arg(driveTitle(QString::fromStdString(task_->drive)));
    QStringList locked;
    for (const std::string& name : exercise.lockedHelps)
        if (const auto help = helpOf(name)) locked << helpWords(*help);
    if (!locked.isEmpty()) about << tr("Not in this exercise: %1").arg(locked.join(QStringLiteral(", ")));
    show(about_, about.join(QStringLiteral(" · ")));
    const std::optional<Reached> reached = reachedAt(task_->id);
    show(best_, reached ? bestWords(*reached) : tr("Not tried yet."));
    show(due_, {});
    try {
        const rubric::Rubric rubric = task_->rubric.empty() ? rubric::Rubric{} : course::rubricOf(*task_);
        show(asks_,
             task_->rubric.empty() ? tr("This exercise is not judged: it has no rubric.") : whatIsJudged(rubric));
        QStringList titles;
        for (const std::string& criterion : due)
            titles << titleOf(rubric, criterion);
        if (!due.empty()) show(due_, tr("Due once more, without helps: %1").arg(titles.join(QStringLiteral("; "))));
    } catch (const core::Error& error) {
        show(asks_, {});
        note_->setText(error.what());
        note_->show();
    }
}

}  // namespace handpiece::desktop
