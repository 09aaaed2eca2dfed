// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/result_dialog.h"

#include <QButtonGroup>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QRadioButton>
#include <QStackedWidget>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "desktop/features/exercise/assessment_words.h"
#include "desktop/features/exercise/result_rows.h"
#include "desktop/picture/solid_view.h"
#include "desktop/picture/start_view.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/scrolled.h"
#include "desktop/widgets/theme.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/app/report/assessment_report.h"
#include "handpiece/app/report/assessment_words.h"

namespace handpiece::desktop {
namespace {

enum Column { criterion, value, wished, points, because, columnCount };

/// The first that leads somewhere; null: none does.
template <class Judged>
const measures::Evidence* evidenceOf(const Judged& c) {
    for (const measures::Evidence& e : c.evidence)
        if (e.placeMm || e.timeS) return &e;
    return nullptr;
}

}  // namespace

ResultDialog::ResultDialog(QWidget* parent) : QDialog(parent), pages_(new QStackedWidget(this)) {
    setObjectName(QStringLiteral("resultDialog"));
    setWindowTitle(tr("Result"));
    pages_->addWidget(makeJudging());
    pages_->addWidget(makeResult());
    auto* column = new QVBoxLayout(this);
    column->addWidget(pages_);
    resize(1000, 760);
}

QWidget* ResultDialog::makeJudging() {
    auto* page = new QWidget;
    auto* sides = new QHBoxLayout(page);
    auto* column = new QVBoxLayout;
    sides->addLayout(column, 3);
    judged_ = new SolidView("judgeTooth", page);
    sides->addWidget(judged_, 2);
    auto* asked = new QLabel(tr("Before you see the result: what do you think of your own work?"), page);
    asked->setWordWrap(true);
    asked->setFont(scaledFont(font(), 1.3, true));
    column->addWidget(asked);
    auto* row = new QHBoxLayout;
    row->addWidget(new QLabel(tr("Of all points I expect"), page));
    percent_ = named(new WholeField(page), "judgePercent", tr("Of all points I expect"));
    percent_->setRange(0, 100);
    percent_->setSuffix(tr(" %"));
    row->addWidget(percent_);
    row->addStretch();
    column->addLayout(row);
    column->addWidget(new QLabel(tr("What went well, and what would you do otherwise?"), page));
    words_ = named(new QPlainTextEdit(page), "judgeWords", tr("What went well, and what would you do otherwise?"));
    column->addWidget(words_, 1);
    auto* show = named(new QPushButton(tr("Show the result"), page), "judgeShow", tr("Show the result"));
    column->addWidget(show, 0, Qt::AlignRight);
    connect(show, &QPushButton::clicked, this, &ResultDialog::judge);
    return page;
}

QWidget* ResultDialog::makeResult() {
    auto* page = new QWidget;
    auto* left = new QVBoxLayout;
    const auto text = [&](const char* object, const QString& name) {
        auto* label = named(new QLabel(page), object, name);
        label->setTextFormat(Qt::PlainText);
        label->setWordWrap(true);
        label->setTextInteractionFlags(Qt::TextSelectableByMouse);
        left->addWidget(label);
        return label;
    };
    title_ = text("resultTitle", tr("Exercise"));
    score_ = text("resultScore", tr("Score"));
    score_->setFont(scaledFont(font(), 1.5, true));
    teacher_ = text("resultTeacher", tr("What your teacher says"));
    why_ = text("resultWhy", tr("Why"));
    time_ = text("resultTime", tr("Time"));
    compared_ = text("resultOwnJudgement", tr("Your own judgement"));
    errors_ = new QVBoxLayout;
    left->addLayout(errors_);
    table_ = named(new QTableWidget(page), "resultTable", tr("All that was judged"),
                   tr("A click on a row with a place turns the eye there and plays the seconds in which it happened"));
    table_->setColumnCount(columnCount);
    table_->setHorizontalHeaderLabels(
        {tr("What was judged"), tr("Yours"), tr("Asked"), tr("Points"), tr("Why not all points")});
    table_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    for (const Column stretched : {criterion, because})
        table_->horizontalHeader()->setSectionResizeMode(stretched, QHeaderView::Stretch);
    table_->verticalHeader()->hide();
    table_->verticalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    table_->setWordWrap(true);
    left->addWidget(table_, 1);
    connect(table_, &QTableWidget::cellClicked, this, [this](int row, int) {
        const auto& all = done_->work.result.assessment.criteria;
        const ResultRow chosen = resultRow(done_->work, all[static_cast<std::size_t>(row)]);
        if (chosen.at != nullptr) lookAt(*chosen.at, placeWords(chosen));
    });
    comments_ = named(new QListWidget(page), "resultComments", tr("Your teacher's comments"),
                      tr("A click on a comment turns the eye to its place and plays its seconds"));
    comments_->setMaximumHeight(110);
    comments_->setWordWrap(true);
    left->addWidget(comments_);
    connect(comments_, &QListWidget::itemClicked, this, [this](const QListWidgetItem* item) {
        if (const auto& there = saidOf_[static_cast<std::size_t>(comments_->row(item))]) lookAt(*there, item->text());
    });
    proof_ = note({}, page, "resultProof");
    left->addWidget(proof_);

    auto* right = new QVBoxLayout;
    auto* choice = new QHBoxLayout;
    which_ = new QButtonGroup(this);
    const auto add = [&](const char* object, const QString& words, int id) {
        auto* button = named(new QRadioButton(words, page), object, words);
        which_->addButton(button, id);
        choice->addWidget(button);
    };
    add("resultOwn", tr("Your tooth"), 0);
    add("resultIdeal", tr("The ideal"), 1);
    which_->button(0)->setChecked(true);
    choice->addStretch();
    connect(which_, &QButtonGroup::idClicked, this, &ResultDialog::showTooth);
    right->addLayout(choice);
    tooth_ = new SolidView("resultTooth", page);
    tooth_->setPlaceholder({});
    right->addWidget(tooth_, 1);

    auto* below = new QHBoxLayout;
    const auto push = [&](const char* object, const QString& words, const QString& tip, auto wanted) {
        auto* button = named(new QPushButton(words, page), object, words, tip);
        below->addWidget(button);
        connect(button, &QPushButton::clicked, this, wanted);
        return button;
    };
    page_ = push("resultPage", tr("Save as a page..."), tr("One HTML page to keep or to print"),
                 &ResultDialog::pageRequested);
    handIn_ = push("resultHandIn", tr("Hand in..."),
                   tr("One file for your teacher: the tooth, all that was recorded, the result, and what you expected"),
                   &ResultDialog::handInRequested);
    teacherWork_ =
        push("resultTeacherWork", tr("Teacher's work"),
             tr("Play your teacher's own work on the same tooth: the seconds at the place that you looked at "
                "last, or from its beginning"),
             [this] { emit teacherWorkRequested(lookedAt_); });
    below->addStretch();
    push("resultAgain", tr("Again"), tr("Begin the same exercise anew"), &ResultDialog::againRequested);
    push("resultNext", tr("Next"), tr("Choose the next exercise"), &ResultDialog::nextRequested);
    auto* row = new QHBoxLayout;
    row->addLayout(left, 3);
    row->addLayout(right, 2);
    auto* column = new QVBoxLayout(page);
    table_->setMinimumHeight(150);
    tooth_->setMinimumHeight(200);
    column->addWidget(new Scrolled(row, page), 1);
    note_ = note({}, page, "resultNote");
    column->addWidget(note_);
    column->addLayout(below);
    return page;
}

void ResultDialog::setResult(std::shared_ptr<const Simulator::Finished> done, course::Parts ideal, bool asksFirst) {
    done_ = std::move(done);
    ideal_ = std::move(ideal);
    own_.reset();
    hasTooth_ = false;
    for (SolidView* view : {tooth_, judged_})
        view->forgetPicture();  // that of the result before would stand there until this one is drawn
    comments_->clear();
    saidOf_.clear();
    returned_.clear();
    isAsking_ = asksFirst;
    lookedAt_.reset();
    setHasTeacherWork(false);
    setNote({}, isWriting_);
    percent_->setValue(50);
    words_->clear();
    fill();
    pages_->setCurrentIndex(asksFirst ? 0 : 1);
}

void ResultDialog::setSaid(std::optional<OwnJudgement> own, const std::vector<school::Comment>& comments,
                           std::vector<marking::ReturnedMarks> returned) {
    own_ = std::move(own);
    returned_ = std::move(returned);
    comments_->clear();
    saidOf_.clear();
    const auto place = [this](const std::optional<core::Vec3>& placeMm, const std::optional<double>& timeS,
                              const std::optional<std::size_t>& session) {
        std::optional<measures::Evidence> there;
        if (!placeMm && !timeS) return there;
        there.emplace();
        there->placeMm = placeMm;
        there->timeS = timeS;
        // Where nobody says so a teacher has seen the last of a chain.
        const std::size_t last = std::max<std::size_t>(1, done_->work.work.recordings.size()) - 1;
        there->session = std::min(last, session.value_or(last));
        return there;
    };
    const rubric::Rubric& rubric = done_->work.rubric;
    for (const school::Comment& c : comments)
        say(QString::fromStdString(c.words), c.author, place(c.placeMm, c.timeS, {}));
    for (const marking::ReturnedMarks& marks : returned_) {
        for (const marking::ReturnedMarks::Change& c : marks.changes) {
            QStringList now;
            if (c.points) now << tr("%1 points").arg(pointsWords(*c.points, c.maxPoints));
            if (!c.band.empty()) now << bandTitle(rubric, c.band);
            if (c.isCritical) now << tr("critical error");
            const auto& all = done_->work.result.assessment.criteria;
            const auto of = std::find_if(all.begin(), all.end(),
                                         [&](const score::CriterionScore& one) { return one.id == c.criterion; });
            const measures::Evidence* there = of == all.end() ? nullptr : evidenceOf(*of);
            say(tr("%1: %2. %3")
                    .arg(titleOf(rubric, c.criterion), now.join(QStringLiteral(", ")),
                         QString::fromStdString(c.reason)),
                marks.marker, there ? std::optional(*there) : std::nullopt);
        }
        for (const marking::Comment& c : marks.comments) {
            const QString words = QString::fromStdString(c.text);
            say(c.criterion.empty() ? words : tr("%1: %2").arg(titleOf(rubric, c.criterion), words), marks.marker,
                place(c.placeMm, c.timeS, c.session));
        }
    }
    fill();
}

/// A row of the teachers' list.
void ResultDialog::say(QString words, const std::string& author, std::optional<measures::Evidence> there) {
    if (!author.empty()) words = QString::fromStdString(author) + QStringLiteral(": ") + words;
    if (there && there->timeS) words += QLatin1Char(' ') + tr("(%1 s)").arg(QLocale().toString(*there->timeS, 'f', 1));
    comments_->addItem(words);
    saidOf_.push_back(std::move(there));
}

/// The teachers' words over the machine's, which stand beside.
void ResultDialog::fillTeacher() {
    comments_->setVisible(comments_->count() > 0);
    QStringList lines;
    for (const marking::ReturnedMarks& marks : returned_) {
        QString line = tr("%1: %2 points: %3")
                           .arg(QString::fromStdString(marks.marker), pointsWords(marks.score, marks.maxScore),
                                passedWords(marks.passed));
        if (!marks.decision.empty()) line += QStringLiteral(". ") + QString::fromStdString(marks.decision);
        if (marks.rubricHash != rubric::hashText(done_->work.result.assessment.rubricHash))
            line += QLatin1Char(' ') + tr("(by another rubric, %1)").arg(QString::fromStdString(marks.rubric));
        lines << line;
    }
    teacher_->setText(lines.join(QLatin1Char('\n')));
    teacher_->setVisible(!lines.isEmpty());
}

void ResultDialog::setIdeal(course::Parts ideal, const QString& why) {
    ideal_ = std::move(ideal);
    noIdeal_ = ideal_ ? QString() : why;
    which_->button(1)->setEnabled(ideal_ != nullptr);
    which_->button(1)->setToolTip(noIdeal_.isEmpty() ? tr("The ideal") : noIdeal_);
    showTooth();
}

void ResultDialog::setHasTeacherWork(bool has) {
    teacherWork_->setVisible(has);
}

void ResultDialog::lookAt(const measures::Evidence& evidence, const QString& words) {
    lookedAt_ = evidence;
    emit evidenceChosen(evidence, words);
}

void ResultDialog::setNote(const QString& words, bool isBusy) {
    isWriting_ = isBusy;
    note_->setText(words);
    note_->setVisible(!words.isEmpty());
    if (done_) showWhatCanBeWritten();
}

void ResultDialog::showWhatCanBeWritten() {
    page_->setEnabled(!isWriting_ && !done_->work.rubric.criteria.empty());
    // Of one whose recordings are gone there is no tooth to give.
    handIn_->setEnabled(!isWriting_ && !done_->work.work.teeth.empty());
}

void ResultDialog::judge() {
    own_ = OwnJudgement{static_cast<double>(percent_->value()), words_->toPlainText().trimmed()};
    isAsking_ = false;
    emit judged(*own_);
    fill();
    pages_->setCurrentIndex(1);
}

/// Who closes it without a word has none; the result is kept all the same.
void ResultDialog::closeEvent(QCloseEvent* event) {
    isAsking_ = false;
    pages_->setCurrentIndex(1);
    QDialog::closeEvent(event);
}

void ResultDialog::showEvent(QShowEvent* event) {
    QDialog::showEvent(event);
    emit opened();
}

void ResultDialog::fill() {
    const score::Assessment& a = done_->work.result.assessment;
    const auto& exercise = done_->work.task->toothCase.exercise;
    title_->setText(exercise && !exercise->title.empty() ? inThisLanguage(exercise->title)
                                                         : QString::fromStdString(done_->work.task->id));
    const QLocale locale;
    score_->setText(tr("%1 points (%2 to %3): %4")
                        .arg(pointsWords(a.score, a.maxScore), locale.toString(a.leastScore, 'f', 1),
                             locale.toString(a.mostScore, 'f', 1), passedWords(a.passed)));
    QStringList why;
    for (const score::CriticalError& error : a.critical)
        why << (error.borderline ? tr("Perhaps a critical error: %1") : tr("Critical error: %1"))
                   .arg(criticalWords(done_->work, error));
    if (a.wholeScore > a.maxScore + 1e-9)
        why << tr("Criteria worth %1 of %2 points could not be measured.")
                   .arg(locale.toString(a.wholeScore - a.maxScore, 'f', 1), locale.toString(a.wholeScore, 'f', 1));
    if (a.completeness && !a.completeness->value) why << QString::fromStdString(report::undoneWords(a));
    why_->setText(why.join(QLatin1Char('\n')));
    why_->setToolTip(a.why.empty() ? QString() : QString::fromStdString(report::whyOf(a, done_->work.rubric)));
    why_->setVisible(!why.isEmpty());
    const auto& limit = done_->work.task->minutes;
    const auto minutes = [](double seconds) {
        const int whole = static_cast<int>(seconds);
        return QStringLiteral("%1:%2").arg(whole / 60).arg(whole % 60, 2, 10, QLatin1Char('0'));
    };
    if (limit && done_->workedS > 0.0)
        time_->setText(
            done_->workedS <= 60.0 * *limit
                ? tr("Time: %1 of %2").arg(minutes(done_->workedS), minutes(60.0 * *limit))
                : tr("Time: %1 of %2, over by %3")
                      .arg(minutes(done_->workedS), minutes(60.0 * *limit), minutes(done_->workedS - 60.0 * *limit)));
    time_->setVisible(limit && done_->workedS > 0.0);
    if (own_)
        compared_->setText(tr("You expected %1 %; it is %2 %.")
                               .arg(locale.toString(own_->percent, 'f', 0), locale.toString(a.percent(), 'f', 0)));
    compared_->setVisible(own_.has_value());
    proof_->setText(done_->work.result.identity.proven
                        ? tr("Proven: cut again from its recording it is the same tooth, bit for bit.")
                        : tr("Not proven: the recording does not lead to this very tooth. %1")
                              .arg(saidWords(done_->work.result.proof))
                              .trimmed());
    proof_->setToolTip(saidWords(done_->work.result.proof));
    const bool hasTooth = done_->work.own != nullptr;
    showWhatCanBeWritten();
    which_->button(0)->setEnabled(hasTooth);
    fillErrors();
    fillTable();
    fillTeacher();
    which_->button(0)->setChecked(true);
    setIdeal(ideal_, noIdeal_);
}

void ResultDialog::fillErrors() {
    for (QWidget* row : errorRows_)
        row->deleteLater();
    errorRows_.clear();
    const score::Assessment& a = done_->work.result.assessment;
    const std::vector<std::size_t> order = report::costliest(a);
    const bool isUndone = report::costsUndone(a);
    if (!order.empty() || isUndone) {
        errorRows_.push_back(heading(tr("What cost most"), this));
        errors_->addWidget(errorRows_.back());
    }
    const auto add = [this](const QString& words, const QString& name, const measures::Evidence* e, const QString& show,
                            const QString& there, const std::string& exercise) {
        auto* row = new QWidget(this);
        auto* line = new QHBoxLayout(row);
        line->setContentsMargins(0, 0, 0, 0);
        auto* label = new QLabel(words, row);
        label->setTextFormat(Qt::PlainText);
        label->setWordWrap(true);
        label->setObjectName(name);
        line->addWidget(label, 1);
        const auto push = [&](const QString& said, const QString& tip, const QString& object, auto wanted) {
            auto* button = named(new QPushButton(said, row), "", said, tip);
            button->setObjectName(object);
            line->addWidget(button);
            connect(button, &QPushButton::clicked, this, wanted);
        };
        if (!exercise.empty())
            push(tr("Practise"),
                 tr("Open the exercise that trains this: %1")
                     .arg(inThisLanguage(course::shippedExercise(exercise).exercise.title)),
                 name + QStringLiteral("_practise"),
                 [this, exercise] { emit practiseRequested(QString::fromStdString(exercise)); });
        if (e != nullptr)
            push(tr("Show"),
                 e->timeS ? tr("Turn the eye there and play the seconds in which it happened")
                          : tr("Turn the eye there"),
                 show, [this, at = *e, there] { lookAt(at, there); });
        errors_->addWidget(row);
        errorRows_.push_back(row);
    };
    if (isUndone) {
        const QString words = QString::fromStdString(report::undoneWords(a)) + QLatin1Char(' ') +
                              tr("%1 points lost").arg(QLocale().toString(a.lostUndone(), 'f', 1));
        add(words, QStringLiteral("resultUndone"), evidenceOf(*a.completeness), QStringLiteral("resultShowUndone"),
            words + QLatin1Char('\n') + tr("Most is still to be cut here."), {});
    }
    for (std::size_t i = 0; i < std::min(order.size(), report::kFirstErrors); ++i) {
        const score::CriterionScore& c = a.criteria[order[i]];
        const ResultRow row = resultRow(done_->work, c);
        QString words = row.name + QStringLiteral(": ") + row.value;
        if (!row.asked.isEmpty()) words += QStringLiteral(", ") + tr("asked: %1").arg(row.asked);
        if (c.points)
            words +=
                QStringLiteral(", ") + tr("%1 points lost").arg(QLocale().toString(c.maxPoints - c.ownPoints, 'f', 1));
        if (!row.advice.isEmpty()) words += QLatin1Char('\n') + row.advice;
        add(words, QStringLiteral("resultError_%1").arg(i + 1), row.at, QStringLiteral("resultShow_%1").arg(i + 1),
            placeWords(row), row.exercise);
    }
}

void ResultDialog::fillTable() {
    const auto& all = done_->work.result.assessment.criteria;
    table_->setRowCount(static_cast<int>(all.size()));
    for (std::size_t i = 0; i < all.size(); ++i) {
        const score::CriterionScore& c = all[i];
        const ResultRow row = resultRow(done_->work, c);
        const auto put = [&](Column column, const QString& words, const QString& tip = {}) {
            auto* item = new QTableWidgetItem(words);
            item->setToolTip(tip);
            if (column == value || column == points) item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
            table_->setItem(static_cast<int>(i), column, item);
            return item;
        };
        QTableWidgetItem* name = put(criterion, row.name, row.at ? tr("A click shows where") : QString());
        name->setData(Qt::UserRole, row.at != nullptr);
        if (row.at != nullptr) name->setForeground(palette().link());
        put(value, row.value, row.exact);
        put(wished, row.asked);
        QString given = row.points.isEmpty() ? tr("shown only") : row.points;
        for (const marking::ReturnedMarks& marks : returned_)
            for (const marking::ReturnedMarks::Change& change : marks.changes)
                if (change.criterion == c.id && change.points)
                    given += QLatin1Char('\n') + tr("%1: %2").arg(QString::fromStdString(marks.marker),
                                                                  pointsWords(*change.points, change.maxPoints));
        put(points, given);
        put(because, row.why, row.advice);
    }
}

/// As it was worked on: a cavity from palatal is not seen from labial.
void ResultDialog::showIn(SolidView* view, const course::Parts& parts, bool isFirst) {
    core::Box box;
    if (parts)
        for (const cases::Part& part : *parts)
            for (const core::Vec3& v : part.mesh.vertices)
                box.extend(v);
    view->setParts(parts, box);
    if (const auto& exercise = done_->work.task->toothCase.exercise; isFirst && exercise && exercise->view)
        view->setCamera(lookingAs({}, *exercise->view));
}

void ResultDialog::showTooth() {
    const bool isIdeal = which_->checkedId() == 1 && ideal_;
    const course::Parts& parts = isIdeal ? ideal_ : done_->work.own;
    const bool isFirst = !hasTooth_ && parts;
    hasTooth_ = hasTooth_ || parts;
    showIn(tooth_, parts, isFirst);
    if (isAsking_) showIn(judged_, done_->work.own, isFirst);
    const QString caption = !parts    ? tr("Its recording is no longer kept: the tooth cannot be shown")
                            : isIdeal ? tr("The ideal: drag to turn it")
                                      : tr("Your tooth: drag to turn it");
    tooth_->setCaption(noIdeal_.isEmpty() ? caption : caption + QLatin1Char('\n') + noIdeal_, false);
}

}  // namespace handpiece::desktop
