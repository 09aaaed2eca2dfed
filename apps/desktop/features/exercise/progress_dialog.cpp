// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/progress_dialog.h"

#include <QComboBox>
#include <QDateTime>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLocale>
#include <QPainter>
#include <QPushButton>
#include <QSet>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "desktop/features/exercise/assessment_words.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {

bool areComparable(const school::Attempt& a, const school::Attempt& b) {
    return a.exercise == b.exercise && a.exerciseHash == b.exerciseHash && a.rubricHash == b.rubricHash &&
           a.device == b.device && a.motionScale == b.motionScale;
}

ProgressCurve::ProgressCurve(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("progressCurve"));
    setAccessibleName(tr("Share of all points over the attempts"));
}

void ProgressCurve::setAttempts(const std::vector<school::Attempt>& attempts) {
    lines_.clear();
    std::vector<const school::Attempt*> firsts;
    for (std::size_t i = 0; i < attempts.size(); ++i) {
        const auto like = std::find_if(firsts.begin(), firsts.end(), [&](const school::Attempt* first) {
            return areComparable(*first, attempts[i]);
        });
        const auto line = static_cast<std::size_t>(like - firsts.begin());
        if (like == firsts.end()) {
            firsts.push_back(&attempts[i]);
            lines_.emplace_back();
        }
        lines_[line].points.emplace_back(static_cast<int>(i) + 1, attempts[i].percent());
        lines_[line].isWhole.push_back(attempts[i].isWhole());
    }
    count_ = static_cast<int>(attempts.size());
    QStringList said;
    for (const school::Attempt& attempt : attempts)
        said << QLocale().toString(attempt.percent(), 'f', 0);
    setAccessibleDescription(said.join(QStringLiteral("; ")));
    update();
}

void ProgressCurve::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QFontMetrics metrics(font());
    const QRectF area = QRectF(rect()).adjusted(metrics.horizontalAdvance(QStringLiteral("100 %")) + 10, 10, -12,
                                                -metrics.height() - 8);
    const auto at = [&](int attempt, double percent) {
        const double x = count_ > 1 ? (attempt - 1.0) / (count_ - 1.0) : 0.5;
        return QPointF(area.left() + x * area.width(), area.bottom() - 0.01 * percent * area.height());
    };
    const QPalette& colours = palette();
    for (const int percent : {0, 25, 50, 75, 100}) {
        const double y = at(1, percent).y();
        painter.setPen(colours.color(QPalette::Mid));
        painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y));
        painter.setPen(colours.color(QPalette::WindowText));
        painter.drawText(QRectF(0, y - metrics.height() / 2.0, area.left() - 6, metrics.height()),
                         Qt::AlignRight | Qt::AlignVCenter, QStringLiteral("%1 %").arg(QLocale().toString(percent)));
    }
    const int step = std::max(1, static_cast<int>(niceStep(count_, 10)));
    for (int attempt = 1; attempt <= count_; attempt += step)
        painter.drawText(QRectF(at(attempt, 0).x() - 30, area.bottom() + 4, 60, metrics.height()), Qt::AlignHCenter,
                         QLocale().toString(attempt));
    // In the theme's own tones, and of another dash each, for who sees no colours.
    constexpr Qt::PenStyle kStyles[] = {Qt::SolidLine, Qt::DashLine, Qt::DotLine, Qt::DashDotLine};
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        QPen pen(colours.color(i == 0 ? QPalette::Highlight : QPalette::WindowText), 2.0, kStyles[i % 4]);
        painter.setPen(pen);
        painter.setBrush(pen.color());
        QPolygonF line;
        for (const auto& [attempt, percent] : lines_[i].points)
            line << at(attempt, percent);
        painter.drawPolyline(line);
        painter.setPen(QPen(pen.color(), 2.0));
        for (qsizetype j = 0; j < line.size(); ++j) {
            painter.setBrush(lines_[i].isWhole[static_cast<std::size_t>(j)] ? pen.color()
                                                                            : colours.color(QPalette::Window));
            painter.drawEllipse(line[j], 4.0, 4.0);
        }
    }
}

ProgressDialog::ProgressDialog(QWidget* parent)
    : QDialog(parent),
      exercise_(named(new QComboBox(this), "progressExercise", tr("Exercise"))),
      curve_(new ProgressCurve(this)),
      table_(named(new QTableWidget(this), "progressTable", tr("Attempts"))) {
    setObjectName(QStringLiteral("progressDialog"));
    setWindowTitle(tr("Progress"));
    table_->setColumnCount(6);
    table_->setHorizontalHeaderLabels({tr("When"), tr("Score"), tr("Passed"), tr("Time"), tr("Device"), tr("Proven")});
    table_->setSelectionMode(QAbstractItemView::SingleSelection);
    table_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    table_->horizontalHeader()->setStretchLastSection(true);
    table_->verticalHeader()->hide();
    table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    note_ = note({}, this, "progressNote");
    auto* column = new QVBoxLayout(this);
    column->addWidget(exercise_);
    column->addWidget(curve_, 2);
    column->addWidget(note_);
    column->addWidget(table_, 2);
    open_ = named(new QPushButton(tr("Open the result"), this), "progressOpen", tr("Open the result"),
                  tr("See it again: why, the page, and the seconds where its recording is kept"));
    handIn_ = named(new QPushButton(tr("Hand in..."), this), "progressHandIn", tr("Hand in..."),
                    tr("One file for your teacher, as long as its recordings are kept"));
    auto* below = new QHBoxLayout;
    auto* returned =
        named(new QPushButton(tr("Marks from your teacher..."), this), "progressReturned",
              tr("Marks from your teacher..."), tr("Open the file that your teacher gave back: comments and points"));
    connect(returned, &QPushButton::clicked, this, &ProgressDialog::returnedRequested);
    below->addWidget(returned);
    below->addStretch();
    below->addWidget(handIn_);
    below->addWidget(open_);
    column->addLayout(below);
    connect(handIn_, &QPushButton::clicked, this, [this] {
        if (const QString id = chosen(); !id.isEmpty()) emit handInRequested(id);
    });
    connect(open_, &QPushButton::clicked, this, &ProgressDialog::openChosen);
    connect(table_, &QTableWidget::cellDoubleClicked, this, &ProgressDialog::openChosen);
    connect(table_, &QTableWidget::itemSelectionChanged, this, [this] {
        for (QPushButton* button : {open_, handIn_})
            button->setEnabled(table_->currentRow() >= 0);
    });
    resize(700, 640);
    connect(exercise_, &QComboBox::currentIndexChanged, this, &ProgressDialog::showExercise);
}

void ProgressDialog::setResults(std::vector<school::Exercise> exercises, std::vector<school::Attempt> attempts,
                                const std::string& chosen) {
    attempts_ = std::move(attempts);
    // Of several versions of an exercise the one that was seen last gives the name.
    std::stable_sort(exercises.begin(), exercises.end(),
                     [](const school::Exercise& a, const school::Exercise& b) { return a.lastSeen > b.lastSeen; });
    exercise_->clear();
    for (const school::Exercise& exercise : exercises) {
        const QString id = QString::fromStdString(exercise.id);
        const bool isTried = std::any_of(attempts_.begin(), attempts_.end(),
                                         [&](const school::Attempt& a) { return a.exercise == exercise.id; });
        if (isTried && exercise_->findData(id) < 0)
            exercise_->addItem(exercise.title.empty() ? id : QString::fromStdString(exercise.title), id);
    }
    const int row = exercise_->findData(QString::fromStdString(chosen));
    if (row >= 0) exercise_->setCurrentIndex(row);
    showExercise(exercise_->currentIndex());
}

QString ProgressDialog::chosen() const {
    const QTableWidgetItem* item = table_->item(table_->currentRow(), 0);
    return item ? item->data(Qt::UserRole).toString() : QString();
}

void ProgressDialog::openChosen() {
    if (const QString id = chosen(); !id.isEmpty()) emit resultRequested(id);
}

void ProgressDialog::showExercise(int row) {
    std::vector<school::Attempt> of;
    const std::string id = row < 0 ? std::string() : exercise_->itemData(row).toString().toStdString();
    for (const school::Attempt& attempt : attempts_)
        if (row >= 0 && attempt.exercise == id) of.push_back(attempt);
    curve_->setAttempts(of);
    QStringList notes;
    if (of.empty()) notes << tr("No exercise is finished yet.");
    if (curve_->lines().size() > 1)
        notes << tr(
            "Attempts with another device, motion scale or version of the exercise are not compared: "
            "each has a line of its own.");
    if (std::any_of(of.begin(), of.end(), [](const school::Attempt& a) { return !a.isWhole(); }))
        notes << tr("Hollow: not all of it could be measured; its share says nothing about the rest.");
    note_->setText(notes.join(QLatin1Char('\n')));
    note_->setVisible(!note_->text().isEmpty());
    table_->clearSelection();
    table_->setCurrentItem(nullptr);
    for (QPushButton* button : {open_, handIn_})
        button->setEnabled(false);
    table_->setRowCount(static_cast<int>(of.size()));
    const QLocale locale;
    for (std::size_t i = 0; i < of.size(); ++i) {
        const school::Attempt& a = of[of.size() - 1 - i];  // the latest first
        const auto put = [&](int column, const QString& words) {
            table_->setItem(static_cast<int>(i), column, new QTableWidgetItem(words));
        };
        put(0, locale.toString(QDateTime::fromMSecsSinceEpoch(a.finished), QLocale::ShortFormat));
        put(1, (a.isWhole() ? tr("%1 (%2 %)") : tr("%1 (%2 %), in part"))
                   .arg(pointsWords(a.score, a.maxScore), locale.toString(a.percent(), 'f', 0)));
        put(2, passedWords(a.passed == "yes"  ? score::Passed::yes
                           : a.passed == "no" ? score::Passed::no
                                              : score::Passed::teacher));
        table_->item(static_cast<int>(i), 0)->setData(Qt::UserRole, QString::fromStdString(a.id));
        const auto minutes = [](double seconds) {
            const int whole = static_cast<int>(seconds);
            return QStringLiteral("%1:%2").arg(whole / 60).arg(whole % 60, 2, 10, QLatin1Char('0'));
        };
        put(3, a.workedS <= 0.0  ? QString()
               : a.lateS() > 0.0 ? tr("%1, over by %2").arg(minutes(a.workedS), minutes(a.lateS()))
                                 : minutes(a.workedS));
        put(4, QString::fromStdString(a.device));
        put(5, a.proven ? tr("yes") : tr("no"));
    }
}

}  // namespace handpiece::desktop
