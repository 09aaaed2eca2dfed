// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/marking/sheet_panel.h"

#include <QCheckBox>
#include <QComboBox>
#include <QGridLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QLocale>
#include <QPushButton>
#include <QScrollBar>
#include <QSignalBlocker>
#include <QToolButton>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <set>

#include "desktop/features/marking/work_table.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"
#include "handpiece/app/report/assessment_report.h"
#include "handpiece/app/report/assessment_words.h"

namespace handpiece::desktop {
namespace {

enum Column { kName, kMark, kPoints, kBand, kMeasured };
constexpr int kMostNamePixels = 190;
constexpr int kIdRole = Qt::UserRole, kTimeRole = Qt::UserRole + 1, kPlaceRole = Qt::UserRole + 2;

QString inWords(const cases::Texts& texts, const std::string& otherwise) {
    const std::string_view text = cases::inLanguage(texts, QLocale().bcp47Name().toStdString());
    return text.empty() ? QString::fromStdString(otherwise)
                        : QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}
QString bandText(const rubric::Rubric& rubric, const std::string& id) {
    for (const rubric::BandName& band : rubric.bands)
        if (band.id == id) return inWords(band.title, id);
    return QString::fromStdString(id);
}
QString pointsText(double points) {
    return QLocale().toString(points, 'f', 1);
}
/// A tenth where it is large, a thousandth where it is small.
QString measuredText(double value) {
    return QLocale().toString(value, 'f', std::abs(value) < 10.0 ? 3 : 1);
}
QVariant placeOf(const std::optional<core::Vec3>& mm) {
    return mm ? QVariant(QVariantList{mm->x(), mm->y(), mm->z()}) : QVariant();
}
QVariant timeOf(const std::optional<double>& s) {
    return s ? QVariant(*s) : QVariant();
}
std::optional<core::Vec3> placeIn(const QVariant& data) {
    const QVariantList list = data.toList();
    if (list.size() != 3) return {};
    return core::Vec3(list[0].toDouble(), list[1].toDouble(), list[2].toDouble());
}
/// What the fields of a decision show.
std::pair<int, QString> decisionFields(const std::optional<marking::Decision>& said) {
    return said ? std::pair(said->passed ? 1 : 2, QString::fromStdString(said->reason)) : std::pair(0, QString());
}
std::optional<double> timeIn(const QVariant& data) {
    return data.isValid() ? std::optional(data.toDouble()) : std::nullopt;
}

}  // namespace

SheetPanel::SheetPanel(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("markingSheet"));
    setAccessibleName(tr("Work that is marked"));
    title_ = named(new QLabel(this), "sheetTitle", tr("Code of the work"));
    title_->setFont(scaledFont(font(), 1.15, true));
    previous_ = iconButton(QStringLiteral("step-back"), "sheetPrevious", tr("Previous work"), this);
    next_ = iconButton(QStringLiteral("step-forward"), "sheetNext", tr("Next work"), this);
    auto* table = iconButton(QStringLiteral("report"), "sheetTable", tr("Back to the table"), this);
    summary_ = named(new QLabel(this), "sheetSummary", tr("How the work stands"));
    summary_->setWordWrap(true);
    summary_->setTextFormat(Qt::PlainText);
    notShown_ = named(new QLabel(tr("The picture does not show this work."), this), "sheetNotShown",
                      tr("Whether the picture shows this work"));
    notShown_->setFont(scaledFont(font(), 1.0, true));
    criteria_ = named(new QTreeWidget(this), "sheetCriteria", tr("Criteria"),
                      tr("Choose one to judge it; a place below it turns the picture there"));
    criteria_->setHeaderLabels({tr("Criterion"), tr("Your mark"), tr("Points"), tr("Band"), tr("Measured")});
    criteria_->header()->setSectionResizeMode(QHeaderView::ResizeToContents);
    // Its places, which may be long, lie across all columns.
    criteria_->header()->setSectionResizeMode(kName, QHeaderView::Interactive);
    criteria_->setMinimumHeight(120);
    editing_ = named(new QLabel(this), "sheetEditing", tr("Criterion that is judged"));
    editing_->setTextFormat(Qt::PlainText);
    editing_->setWordWrap(true);
    editing_->setFont(scaledFont(font(), 1.0, true));
    band_ = named(new QComboBox(this), "sheetBand", tr("Band"));
    points_ = named(new DecimalField(this), "sheetPoints", tr("Points"));
    points_->setDecimals(1);
    points_->setSpecialValueText(QStringLiteral("–"));
    critical_ = named(new QComboBox(this), "sheetCritical", tr("Critical error"));
    cannotTell_ = named(new QCheckBox(tr("Cannot be told"), this), "sheetCannotTell", tr("Cannot be told"));
    reason_ = named(new QLineEdit(this), "sheetReason", tr("Reason"), tr("Why you judge otherwise: it is kept"));
    reason_->setPlaceholderText(tr("Reason, needed"));
    say_ = named(new QPushButton(this), "sheetSay", tr("Judge"));
    withdraw_ = named(new QPushButton(tr("Take back"), this), "sheetWithdraw", tr("Take back"),
                      tr("The machine's judgement stands again"));
    giveIn_ = named(new QPushButton(tr("My marks are in"), this), "sheetGiveIn", tr("My marks are in"),
                    tr("They are fixed then, and the machine's score is shown"));
    decision_ = named(new QComboBox(this), "sheetDecision", tr("Who passes"));
    decision_->addItems({tr("as scored"), tr("passed"), tr("not passed")});
    decisionReason_ = named(new QLineEdit(this), "sheetDecisionReason", tr("Reason of the decision"));
    decisionReason_->setPlaceholderText(tr("Reason, needed"));
    decide_ = named(new QPushButton(tr("Decide"), this), "sheetDecide", tr("Decide"), tr("Decide who passes"));
    comments_ = named(new QListWidget(this), "sheetComments", tr("Comments"),
                      tr("One that has a place turns the picture there"));
    comments_->setMaximumHeight(60);
    comment_ =
        named(new QLineEdit(this), "sheetComment", tr("New comment"), tr("Pinned to the criterion that is chosen"));
    comment_->setPlaceholderText(tr("Comment"));
    comment_->setMaxLength(1000);
    pick_ = named(new QPushButton(this), "sheetCommentPick", tr("Click the place"),
                  tr("The next click in the picture pins the comment there; in a replay also to that moment"));
    pick_->setCheckable(true);
    atPlace_ = named(new QCheckBox(tr("at the middle of the picture"), this), "sheetCommentPlace",
                     tr("Pin it to the place in the middle of the picture"));
    atTime_ = named(new QCheckBox(tr("at this moment"), this), "sheetCommentTime",
                    tr("Pin it to the moment that the replay shows"));
    addComment_ = named(new QPushButton(tr("Add"), this), "sheetCommentAdd", tr("Add the comment"));
    removeComment_ = named(new QPushButton(tr("Delete"), this), "sheetCommentRemove", tr("Delete the comment"));
    reason_->setMaxLength(1000);
    decisionReason_->setMaxLength(1000);

    auto* above = new QHBoxLayout;
    above->addWidget(title_, 1);
    above->addWidget(previous_);
    above->addWidget(next_);
    above->addWidget(table);
    auto* editor = new QGridLayout;
    editor->addWidget(editing_, 0, 0, 1, 3);
    editor->addWidget(band_, 1, 0);
    editor->addWidget(points_, 1, 1);
    editor->addWidget(critical_, 1, 2);
    editor->addWidget(cannotTell_, 1, 2);
    editor->addWidget(reason_, 2, 0, 1, 3);
    editor->addWidget(say_, 3, 0);
    editor->addWidget(withdraw_, 3, 1);
    editor->addWidget(giveIn_, 3, 1, 1, 2);
    decisionRow_ = new QWidget(this);
    // No wider than the other panels of its column: a hidden one too makes the window wider.
    auto* decision = new QGridLayout(decisionRow_);
    decision->setContentsMargins(0, 0, 0, 0);
    decision->addWidget(decision_, 0, 0);
    decision->addWidget(decisionReason_, 0, 1);
    decision->addWidget(decide_, 0, 2);
    for (QComboBox* box : {band_, critical_, decision_}) {
        box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        box->setMinimumContentsLength(6);
    }
    auto* pins = new QHBoxLayout;
    pins->addWidget(atTime_);
    pins->addWidget(pick_);
    pins->addStretch(1);
    auto* writing = new QHBoxLayout;
    writing->addWidget(comment_, 1);
    writing->addWidget(addComment_);
    writing->addWidget(removeComment_);
    auto* column = new QVBoxLayout(this);
    column->setSpacing(5);
    column->addLayout(above);
    column->addWidget(summary_);
    column->addWidget(notShown_);
    column->addWidget(criteria_, 1);
    column->addLayout(editor);
    column->addWidget(decisionRow_);
    column->addWidget(comments_);
    column->addLayout(writing);
    column->addWidget(atPlace_);
    column->addLayout(pins);
    return_ = named(new QPushButton(tr("Return to student..."), this), "sheetReturn", tr("Return to student..."),
                    tr("One file with your comments, what you judged otherwise and why, and the score"));
    column->addWidget(return_);
    connect(return_, &QPushButton::clicked, this, &SheetPanel::returnRequested);

    connect(previous_, &QToolButton::clicked, this, [this] { emit stepRequested(-1); });
    connect(next_, &QToolButton::clicked, this, [this] { emit stepRequested(1); });
    connect(table, &QToolButton::clicked, this, &SheetPanel::tableRequested);
    connect(criteria_, &QTreeWidget::currentItemChanged, this, &SheetPanel::showEditor);
    const auto go = [this](QTreeWidgetItem* item) {
        if (item->parent() != nullptr)
            emit placeRequested(placeIn(item->data(kName, kPlaceRole)), timeIn(item->data(kName, kTimeRole)));
    };
    connect(criteria_, &QTreeWidget::itemClicked, this, go);
    connect(criteria_, &QTreeWidget::itemActivated, this, go);
    const auto goTo = [this](QListWidgetItem* item) {
        emit placeRequested(placeIn(item->data(kPlaceRole)), timeIn(item->data(kTimeRole)));
    };
    connect(comments_, &QListWidget::itemClicked, this, goTo);
    connect(comments_, &QListWidget::itemActivated, this, goTo);
    for (QLineEdit* field : {reason_, decisionReason_, comment_})
        connect(field, &QLineEdit::textChanged, this, &SheetPanel::showWhetherReady);
    for (QComboBox* box : {band_, critical_, decision_})
        connect(box, &QComboBox::currentIndexChanged, this, &SheetPanel::showWhetherReady);
    connect(points_, &DecimalField::valueChanged, this, &SheetPanel::showWhetherReady);
    connect(cannotTell_, &QCheckBox::toggled, this, &SheetPanel::showWhetherReady);
    connect(comments_, &QListWidget::currentRowChanged, this, &SheetPanel::showWhetherReady);
    connect(say_, &QPushButton::clicked, this, &SheetPanel::say);
    connect(withdraw_, &QPushButton::clicked, this, [this] { emit withdrawRequested(criterion()); });
    connect(giveIn_, &QPushButton::clicked, this, &SheetPanel::giveInRequested);
    connect(decide_, &QPushButton::clicked, this, [this] {
        std::optional<marking::Decision> decided;
        if (decision_->currentIndex() > 0)
            decided = {decision_->currentIndex() == 1, decisionReason_->text().toStdString()};
        emit decisionRequested(decided);
    });
    connect(addComment_, &QPushButton::clicked, this, [this] {
        emit commentRequested(comment_->text(), atPlace_->isChecked(), atTime_->isChecked() && atTime_->isEnabled());
    });
    connect(pick_, &QPushButton::toggled, this, &SheetPanel::placeWanted);
    connect(removeComment_, &QPushButton::clicked, this, [this] {
        if (const QListWidgetItem* item = comments_->currentItem()) emit commentRemoved(item->data(kIdRole).toInt());
    });
    setHasTime(false);
    setPlace({});
    showWork(nullptr, {}, {}, false, false);
}

bool SheetPanel::isMarking() const {
    return desk_ != nullptr && desk_->isBlind() && !desk_->sheet(code_.toStdString()).isIn;
}

std::string SheetPanel::criterion() const {
    const QTreeWidgetItem* item = criteria_->currentItem();
    if (item == nullptr) return {};
    if (item->parent() != nullptr) item = item->parent();
    return item->data(kName, kIdRole).toString().toStdString();
}

void SheetPanel::setHasTime(bool hasTime) {
    atTime_->setEnabled(hasTime);
}

void SheetPanel::setPlace(const std::optional<core::Vec3>& placeMm) {
    pick_->setChecked(false);
    pick_->setText(placeMm ? tr("Place chosen: click anew") : tr("Click the place"));
    atPlace_->setEnabled(!placeMm && isShown_);
}

void SheetPanel::setIsShown(bool isShown) {
    isShown_ = isShown;
    notShown_->setVisible(!isShown && desk_ != nullptr);
    pick_->setEnabled(isShown);
    atPlace_->setEnabled(isShown);
}

void SheetPanel::clearComment() {
    comment_->clear();
}

void SheetPanel::showWork(const marking::Desk* desk, const QString& code, const QString& place, bool hasPrevious,
                          bool hasNext) {
    const std::string before = code == code_ ? criterion() : std::string();
    return_->setEnabled(desk != nullptr && !code.isEmpty() && desk->machine(code.toStdString()) != nullptr);
    std::set<QString> open;
    for (int row = 0; code == code_ && row < criteria_->topLevelItemCount(); ++row)
        if (criteria_->topLevelItem(row)->isExpanded())
            open.insert(criteria_->topLevelItem(row)->data(kName, kIdRole).toString());
    const int scrolled = code == code_ ? criteria_->verticalScrollBar()->value() : 0;
    const bool isOther = code != code_;
    if (isOther && !code_.isEmpty()) waiting(code_.toStdString()).comment = comment_->text();
    desk_ = code.isEmpty() ? nullptr : desk;
    code_ = desk_ != nullptr ? code : QString();
    if (desk_ != nullptr) deskName_ = desk_->folder().string() + '\n' + desk_->marker();
    if (isOther) comment_->setText(desk_ != nullptr ? waiting(code_.toStdString()).comment : QString());
    setEnabled(desk_ != nullptr);
    title_->setText(desk_ == nullptr ? QString() : tr("%1, %2").arg(code_, place));
    previous_->setEnabled(hasPrevious);
    next_->setEnabled(hasNext);
    fillCriteria();
    if (isOther) fitNames();
    fillComments();
    showSummary();
    {
        const QSignalBlocker quiet(criteria_);
        for (int row = 0; row < criteria_->topLevelItemCount(); ++row) {
            QTreeWidgetItem* item = criteria_->topLevelItem(row);
            const QString id = item->data(kName, kIdRole).toString();
            if (row == 0 || id.toStdString() == before) criteria_->setCurrentItem(item);
            item->setExpanded(open.contains(id));
        }
        criteria_->verticalScrollBar()->setValue(scrolled);
    }
    showEditor();
}

/// As wide as the names, and not so wide that no points are seen.
void SheetPanel::fitNames() {
    int width = 0;
    for (int row = 0; row < criteria_->topLevelItemCount(); ++row)
        width = std::max(width, criteria_->fontMetrics().horizontalAdvance(criteria_->topLevelItem(row)->text(kName)));
    criteria_->setColumnWidth(kName, std::min(width + criteria_->indentation() + 16, kMostNamePixels));
}

void SheetPanel::fillCriteria() {
    const QSignalBlocker quiet(criteria_);
    criteria_->clear();
    if (desk_ == nullptr) return;
    const std::string id = code_.toStdString();
    const marking::Sheet& sheet = desk_->sheet(id);
    const assessment::Result* machine = desk_->machine(id);
    const std::optional<score::Assessment> final = desk_->finalScore(id);
    criteria_->setColumnHidden(kMark, !desk_->isBlind());
    for (const int column : {kMeasured, kBand, kPoints})
        criteria_->setColumnHidden(column, machine == nullptr);
    const std::vector<std::string> asked = desk_->asked();
    std::vector<std::string> rows;
    for (const rubric::Criterion& c : desk_->rubric().criteria)
        if (machine != nullptr || std::find(asked.begin(), asked.end(), c.id) != asked.end()) rows.push_back(c.id);
    if (desk_->isBlind() && !asked.empty() && asked.back() == marking::kTotal) rows.emplace_back(marking::kTotal);
    for (const std::string& name : rows) {
        const rubric::Criterion* c = desk_->rubric().criterion(name);
        auto* item =
            new QTreeWidgetItem(criteria_, {c != nullptr ? inWords(c->title, c->id) : tr("All points together")});
        item->setData(kName, kIdRole, QString::fromStdString(name));
        item->setToolTip(kName, item->text(kName));
        if (const auto mark = sheet.marks.find(name); mark != sheet.marks.end())
            item->setText(kMark, mark->second.cannotTell ? tr("cannot be told")
                                 : mark->second.points   ? pointsText(*mark->second.points)
                                                         : bandText(desk_->rubric(), mark->second.band));
        if (machine == nullptr || !final) continue;
        if (c == nullptr) {
            item->setText(kPoints, tr("%1 of %2").arg(pointsText(final->score), pointsText(final->maxScore)));
            continue;
        }
        const auto place = static_cast<std::size_t>(c - desk_->rubric().criteria.data());
        const score::CriterionScore &now = final->criteria[place], &was = machine->assessment.criteria[place];
        const bool isSaid = sheet.overrides.contains(name);
        item->setText(kMeasured, was.value ? tr("%1 ± %2 %3")
                                                 .arg(measuredText(*was.value), measuredText(was.uncertainty),
                                                      QString::fromStdString(was.unit))
                                           : QString::fromStdString(report::said(was.reason)));
        QStringList band{now.band.empty() ? QString() : bandText(desk_->rubric(), now.band)};
        if (now.critical != score::Verdict::no)
            band << (now.critical == score::Verdict::yes ? tr("critical error") : tr("perhaps a critical error"));
        if (now.borderline) band << tr("borderline");
        if (isSaid && was.band != now.band) band << tr("machine: %1").arg(bandText(desk_->rubric(), was.band));
        band.removeAll(QString());
        item->setText(kBand, band.join(QStringLiteral(", ")));
        QString points =
            now.points ? tr("%1 of %2").arg(pointsText(*now.points), pointsText(now.maxPoints)) : QString();
        if (isSaid && was.points != now.points)
            points += tr(" (machine: %1)").arg(was.points ? pointsText(*was.points) : QStringLiteral("–"));
        item->setText(kPoints, points);
        if (isSaid) {
            QFont bold = item->font(kName);
            bold.setBold(true);
            item->setFont(kName, bold);
            item->setToolTip(kName, QString::fromStdString(sheet.overrides.at(name).reason));
        }
        addEvidence(item, was);
    }
}

void SheetPanel::addEvidence(QTreeWidgetItem* under, const score::CriterionScore& of) {
    for (const measures::Evidence& e : of.evidence) {
        QStringList words{QString::fromStdString(report::said(e.text))};
        if (e.timeS) words << tr("at %1 s").arg(QLocale().toString(*e.timeS, 'f', 1));
        if (e.forceN) words << tr("%1 N").arg(QLocale().toString(*e.forceN, 'f', 2));
        words.removeAll(QString());
        auto* item = new QTreeWidgetItem(under, {words.join(QStringLiteral(", "))});
        item->setFirstColumnSpanned(true);
        item->setToolTip(kName, item->text(kName));
        item->setData(kName, kTimeRole, timeOf(e.timeS));
        item->setData(kName, kPlaceRole, placeOf(e.placeMm));
    }
}

void SheetPanel::fillComments() {
    comments_->clear();
    comments_->hide();
    if (desk_ == nullptr) return;
    for (const marking::Comment& c : desk_->sheet(code_.toStdString()).comments) {
        QString text = QString::fromStdString(c.text);
        if (const rubric::Criterion* of = desk_->rubric().criterion(c.criterion))
            text = tr("%1: %2").arg(inWords(of->title, of->id), text);
        if (c.timeS) text = tr("%1 (at %2 s)").arg(text, QLocale().toString(*c.timeS, 'f', 1));
        auto* item = new QListWidgetItem(text, comments_);
        item->setData(kIdRole, c.number);
        item->setData(kTimeRole, timeOf(c.timeS));
        item->setData(kPlaceRole, placeOf(c.placeMm));
    }
    comments_->setVisible(comments_->count() > 0);  // the sheet has no room to spare on a small screen
}

void SheetPanel::showSummary() {
    if (desk_ == nullptr) return summary_->setText(tr("Open a work on the marking desk."));
    const std::string id = code_.toStdString();
    const assessment::Result* machine = desk_->machine(id);
    const std::optional<score::Assessment> final = desk_->finalScore(id);
    if (machine == nullptr || !final) {
        const QString problem = WorkTable::problemWords(*desk_, id);
        QString text = !problem.isEmpty()       ? problem
                       : isMarking()            ? tr("The machine's score is hidden until your marks are in.")
                       : !desk_->isRevealed(id) ? tr("The machine's score is shown when all works are marked.")
                                                : tr("It waits for its score.");
        if (!problem.isEmpty() && isMarking()) text += QLatin1Char(' ') + tr("It may go in without marks.");
        summary_->setText(text + stillToMark());
        return;
    }
    QString text =
        tr("%1 of %2 points (machine: %3): %4.")
            .arg(pointsText(final->score), pointsText(final->maxScore), pointsText(machine->assessment.score),
                 WorkTable::passedWord(static_cast<int>(*desk_->passed(id))));
    if (!final->why.empty() && !desk_->sheet(id).decision)
        text += QLatin1Char(' ') + tr("Why: %1.").arg(QString::fromStdString(report::whyOf(*final, desk_->rubric())));
    if (const std::string undone = report::undoneWords(*final); !undone.empty())
        text += QLatin1Char(' ') + QString::fromStdString(undone);
    text += QLatin1Char(' ') + (machine->identity.proven
                                    ? tr("Proven.")
                                    : tr("Unproven: %1.").arg(QString::fromStdString(report::said(machine->proof))));
    summary_->setText(text + stillToMark());
}

/// Once this one's are in.
QString SheetPanel::stillToMark() const {
    const std::size_t left = desk_->codes().size() - desk_->countIn();
    return desk_->isBlind() && !isMarking() && left > 0 ? QLatin1Char(' ') + tr("Still to be marked: %1.").arg(left)
                                                        : QString();
}

void SheetPanel::showEditor() {
    const std::string id = code_.toStdString(), name = criterion();
    const rubric::Criterion* c = desk_ != nullptr ? desk_->rubric().criterion(name) : nullptr;
    const bool isTotal = name == marking::kTotal, marks = isMarking();
    const bool canSay = desk_ != nullptr && (marks ? c != nullptr || isTotal : c != nullptr && desk_->machine(id));
    Edited now{id, name, marks, canSay, {}, {}, {}};
    if (desk_ != nullptr) {
        const marking::Sheet& sheet = desk_->sheet(id);
        if (const auto mark = sheet.marks.find(name); marks && mark != sheet.marks.end()) now.mark = mark->second;
        if (const auto said = sheet.overrides.find(name); !marks && said != sheet.overrides.end())
            now.said = said->second;
        now.decision = sheet.decision;
    }
    keepTyped(now);
    if (!edited_ || edited_->code != id || edited_->decision != now.decision) showDecision(id, now.decision);
    decisionRow_->setVisible(desk_ != nullptr && desk_->finalScore(id).has_value());
    // What is half typed outlives scores that come in, a comment, and a change that the desk refused.
    const bool isSame = edited_ && edited_->code == id && edited_->criterion == name && edited_->marks == marks &&
                        edited_->canSay == canSay && edited_->mark == now.mark && edited_->said == now.said;
    edited_ = std::move(now);
    if (isSame) return showWhetherReady();
    const QSignalBlocker quiet1(band_), quiet2(points_), quiet3(critical_), quiet4(cannotTell_);
    editing_->setText(c != nullptr ? inWords(c->title, c->id) : isTotal ? tr("All points together") : QString());
    band_->clear();
    band_->addItem(marks ? tr("choose") : tr("band as it is"), QString());
    std::vector<std::string> listed;
    if (c != nullptr)
        for (const rubric::BandName& band : desk_->rubric().bands)
            if (std::any_of(c->bands.begin(), c->bands.end(), [&](const auto& b) { return b.id == band.id; }))
                band_->addItem(inWords(band.title, band.id), QString::fromStdString(band.id));
    critical_->clear();
    critical_->addItems({tr("critical: as it is"), tr("critical error"), tr("no critical error")});
    double most = c != nullptr ? c->weight : 0.0;
    if (isTotal)
        for (const rubric::Criterion& one : desk_->rubric().criteria)
            most += one.weight;
    points_->setRange(-0.1, most);
    points_->setSingleStep(most > 20.0 ? 1.0 : 0.5);
    points_->setSuffix(most > 0.0 ? tr(" of %1").arg(QLocale().toString(most, 'f', 0)) : QString());
    points_->setValue(-0.1);
    cannotTell_->setChecked(false);
    reason_->clear();
    const bool hasBands = c != nullptr && !c->bands.empty();
    band_->setVisible(canSay && hasBands);
    points_->setVisible(canSay && most > 0.0 && !(marks && hasBands));
    critical_->setVisible(canSay && !marks && c != nullptr && c->critical.has_value());
    cannotTell_->setVisible(canSay && marks);
    reason_->setVisible(canSay && !marks);
    say_->setVisible(canSay);
    say_->setText(marks ? tr("Mark") : tr("Override"));
    giveIn_->setVisible(marks);
    if (edited_->mark) {
        band_->setCurrentIndex(std::max(0, band_->findData(QString::fromStdString(edited_->mark->band))));
        if (edited_->mark->points) points_->setValue(*edited_->mark->points);
        cannotTell_->setChecked(edited_->mark->cannotTell);
    }
    if (edited_->said) {
        band_->setCurrentIndex(std::max(0, band_->findData(QString::fromStdString(edited_->said->band))));
        if (edited_->said->points) points_->setValue(*edited_->said->points);
        if (edited_->said->critical) critical_->setCurrentIndex(*edited_->said->critical ? 1 : 2);
        reason_->setText(QString::fromStdString(edited_->said->reason));
    }
    withdraw_->setVisible(edited_->said.has_value());
    filled_ = typed();
    if (desk_ != nullptr)
        if (const auto& all = waiting(id).criteria; all.contains(name)) put(all.at(name));
    showWhetherReady();
}

SheetPanel::Typed SheetPanel::typed() const {
    return {band_->currentData().toString(), points_->value(), critical_->currentIndex(), cannotTell_->isChecked(),
            reason_->text()};
}

void SheetPanel::put(const Typed& typed) {
    band_->setCurrentIndex(std::max(0, band_->findData(typed.band)));
    points_->setValue(typed.points);
    critical_->setCurrentIndex(typed.critical);
    cannotTell_->setChecked(typed.cannotTell);
    reason_->setText(typed.reason);
}

SheetPanel::TypedOfWork& SheetPanel::waiting(const std::string& code) {
    return waiting_[deskName_ + '\n' + code];
}

/// What is half typed, before the fields are filled for `next`.
void SheetPanel::keepTyped(const Edited& next) {
    if (!edited_ || edited_->code.empty()) return;
    TypedOfWork& of = waiting(edited_->code);
    if (edited_->code == next.code && edited_->marks != next.marks) of.criteria.clear();  // marks that are in
    const bool isOver = edited_->code == next.code && edited_->criterion == next.criterion &&
                        (edited_->mark != next.mark || edited_->said != next.said || edited_->marks != next.marks);
    const bool isLeft = edited_->code != next.code || edited_->criterion != next.criterion;
    if (isOver || (isLeft && typed() == filled_))
        of.criteria.erase(edited_->criterion);  // it was said, or nothing is typed
    else if (isLeft)
        of.criteria[edited_->criterion] = typed();
    if (edited_->code == next.code && edited_->decision != next.decision) of.decision.reset();
    if (edited_->code == next.code) return;
    const std::pair was = decisionFields(edited_->decision), is(decision_->currentIndex(), decisionReason_->text());
    of.decision = is == was ? std::nullopt : std::optional(is);
}

void SheetPanel::showDecision(const std::string& code, const std::optional<marking::Decision>& said) {
    const auto typed = desk_ != nullptr ? waiting(code).decision : std::nullopt;
    const auto [index, reason] = typed ? *typed : decisionFields(said);
    const QSignalBlocker quiet(decision_);
    decision_->setCurrentIndex(index);
    decisionReason_->setText(reason);
}

void SheetPanel::showWhetherReady() {
    const bool marks = isMarking();
    const bool hasPoints = points_->value() >= 0.0;
    const bool said = band_->currentIndex() > 0 || hasPoints;
    if (marks)
        say_->setEnabled(cannotTell_->isChecked() || said);
    else
        say_->setEnabled((said || critical_->currentIndex() > 0) && !reason_->text().trimmed().isEmpty());
    giveIn_->setEnabled(marks && desk_->missing(code_.toStdString()).empty());
    const bool isDecided = desk_ != nullptr && desk_->sheet(code_.toStdString()).decision.has_value();
    decide_->setEnabled(decision_->currentIndex() == 0 ? isDecided : !decisionReason_->text().trimmed().isEmpty());
    addComment_->setEnabled(!comment_->text().trimmed().isEmpty());
    removeComment_->setEnabled(comments_->currentItem() != nullptr);
}

void SheetPanel::say() {
    const std::string band = band_->currentData().toString().toStdString();
    std::optional<double> points;
    if (points_->value() >= 0.0) points = points_->value();
    if (isMarking()) {
        const bool cannot = cannotTell_->isChecked();
        emit markRequested(criterion(), {cannot ? std::string() : band, cannot ? std::nullopt : points, cannot});
        return;
    }
    std::optional<bool> critical;
    if (critical_->currentIndex() > 0) critical = critical_->currentIndex() == 1;
    emit overrideRequested(criterion(), {band, points, critical, reason_->text().toStdString()});
}

}  // namespace handpiece::desktop
