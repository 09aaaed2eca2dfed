// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/marking/desk_dialog.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QDragEnterEvent>
#include <QFileInfo>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QMenu>
#include <QMimeData>
#include <QProgressBar>
#include <QPushButton>
#include <QTabWidget>
#include <QTableView>
#include <QUrl>
#include <QVBoxLayout>

#include "desktop/features/marking/agreement_page.h"
#include "desktop/framework/mnemonics.h"
#include "desktop/widgets/parts.h"
#include "handpiece/app/marking/desk.h"

namespace handpiece::desktop {

DeskDialog::DeskDialog(QWidget* parent) : QDialog(parent, Qt::Window) {
    setObjectName(QStringLiteral("markingDesk"));
    setWindowTitle(tr("Marking desk"));
    setAcceptDrops(true);
    tabs_ = named(new QTabWidget(this), "markingTabs", tr("Pages of the marking desk"), QStringLiteral(" "));
    tabs_->addTab(makeSetUp(), tr("What is marked"));
    tabs_->addTab(makeWorks(), tr("Works"));
    agreement_ = new AgreementPage(this);
    tabs_->addTab(agreement_, tr("Agreement"));
    progress_ = named(new QProgressBar(this), "markingProgress", tr("How far it is"));
    progress_->setRange(0, 1000);
    cancel_ = named(new QPushButton(tr("Cancel"), this), "markingCancel", tr("Cancel"),
                    tr("Stop; what has been scored so far stays"));
    note_ = note({}, this, "markingNote");
    note_->setTextFormat(Qt::PlainText);
    auto* below = new QHBoxLayout;
    below->addWidget(progress_, 1);
    below->addWidget(cancel_);
    auto* column = new QVBoxLayout(this);
    column->addWidget(tabs_, 1);
    column->addLayout(below);
    column->addWidget(note_);
    resize(1100, 640);
    connect(cancel_, &QPushButton::clicked, this, &DeskDialog::cancelRequested);
    connect(tabs_, &QTabWidget::currentChanged, this, [this] {
        if (isAgreementShown()) emit agreementRequested();
    });
    setDesk(nullptr);
    setWork({}, 0.0);
    showWhetherReady();
}

QWidget* DeskDialog::makeSetUp() {
    auto* page = new QWidget(this);
    auto* form = new QFormLayout(page);
    form->setContentsMargins(16, 16, 16, 16);
    form->setSpacing(10);
    const auto withButton = [page](QWidget* field, QPushButton* button) {
        auto* row = new QWidget(page);
        auto* line = new QHBoxLayout(row);
        line->setContentsMargins(0, 0, 0, 0);
        line->addWidget(field, 1);
        line->addWidget(button);
        return row;
    };
    folder_ = named(new QLineEdit(page), "markingFolder", tr("Folder of the returned work"),
                    tr("Sessions, attempts, hand-ins; a folder can be dropped here"));
    auto* chooseFolder = named(new QPushButton(tr("Choose..."), page), "markingFolderChoose", tr("Choose the folder"));
    form->addRow(tr("Returned work"), withButton(folder_, chooseFolder));
    exercise_ = named(new QLineEdit(page), "markingExercise", tr("Exercise"),
                      tr("The exercise that was worked on: its folder, or its .handpiece file"));
    auto* chooseExercise =
        named(new QPushButton(tr("Choose..."), page), "markingExerciseChoose", tr("Choose the exercise"));
    form->addRow(tr("Exercise"), withButton(exercise_, chooseExercise));
    rubric_ =
        named(new QComboBox(page), "markingRubric", tr("Rubric"), tr("How the machine scores, and what is marked"));
    rubric_->addItem(tr("The exercise's own"), QString());
    auto* chooseRubric = named(new QPushButton(tr("File..."), page), "markingRubricChoose", tr("A rubric of your own"));
    form->addRow(tr("Rubric"), withButton(rubric_, chooseRubric));
    marker_ = named(new QLineEdit(page), "markingMarker", tr("Marker"),
                    tr("Your name or code: each marker has a desk of their own in the folder"));
    marker_->setMaxLength(60);
    form->addRow(tr("Marker"), marker_);
    blind_ = named(new QCheckBox(tr("Mark blind"), page), "markingBlind", tr("Mark blind"),
                   tr("Works come under codes in random order, a tenth of them twice; the machine's score is hidden "
                      "until your own mark is in"));
    form->addRow({}, blind_);
    prove_ = named(new QCheckBox(tr("Cut recordings again to prove them"), page), "markingProve",
                   tr("Cut recordings again to prove them"), tr("Slower; without it every recording is unproven"));
    prove_->setChecked(true);
    form->addRow({}, prove_);
    begin_ = named(new QPushButton(tr("Begin, or go on"), page), "markingBegin", tr("Begin, or go on"),
                   tr("What this marker did in this folder before is taken up again"));
    form->addRow({}, begin_);
    connect(chooseFolder, &QPushButton::clicked, this, &DeskDialog::folderRequested);
    connect(chooseExercise, &QPushButton::clicked, this, &DeskDialog::exerciseRequested);
    connect(chooseRubric, &QPushButton::clicked, this, &DeskDialog::rubricRequested);
    connect(begin_, &QPushButton::clicked, this, &DeskDialog::beginRequested);
    for (QLineEdit* field : {folder_, exercise_, marker_})
        connect(field, &QLineEdit::textChanged, this, &DeskDialog::showWhetherReady);
    return page;
}

QWidget* DeskDialog::makeWorks() {
    auto* page = new QWidget(this);
    works_ = new WorkTable(this);
    filter_ = new WorkFilter(this);
    filter_->setSourceModel(works_);
    table_ = named(new QTableView(page), "markingTable", tr("Works"), tr("Double click or Enter opens a work"));
    table_->setModel(filter_);
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    table_->setSelectionMode(QAbstractItemView::SingleSelection);
    table_->setSortingEnabled(true);
    table_->setIconSize({96, 72});
    table_->verticalHeader()->hide();
    table_->horizontalHeader()->setStretchLastSection(false);
    table_->horizontalHeader()->setSectionResizeMode(WorkTable::kState, QHeaderView::Stretch);
    const std::pair<int, int> widths[] = {
        {WorkTable::kCode, 160},   {WorkTable::kFile, 150},  {WorkTable::kScore, 100},  {WorkTable::kMachine, 110},
        {WorkTable::kPassed, 105}, {WorkTable::kFlags, 130}, {WorkTable::kComments, 80}};
    for (const auto& [column, width] : widths)
        table_->setColumnWidth(column, width);
    // As they come until somebody sorts.
    table_->horizontalHeader()->setSortIndicator(-1, Qt::AscendingOrder);
    const auto box = [this, page](const char* name, const QString& text, const QString& tip) {
        auto* check = named(new QCheckBox(text, page), name, text, tip);
        connect(check, &QCheckBox::toggled, this, &DeskDialog::filter);
        return check;
    };
    critical_ = box("markingCritical", tr("Critical errors"), tr("Only works with a critical error"));
    borderline_ = box("markingBorderline", tr("Borderline"), tr("Only works where something lies within uncertainty"));
    unproven_ = box("markingUnproven", tr("Unproven"), tr("Only works that were not cut again to the same tooth"));
    problem_ = box("markingProblem", tr("Not scored"), tr("Only works that could not be scored"));
    count_ = named(new QLabel(page), "markingCount", tr("How many works"));
    open_ = named(new QPushButton(tr("Open"), page), "markingOpen", tr("Open"), tr("Open the work in the picture"));
    score_ = named(new QPushButton(tr("Score again"), page), "markingScore", tr("Score again"),
                   tr("Look for work that has come since, and score what has no score"));
    export_ = named(new QPushButton(tr("Export"), page), "markingExport", tr("Export"), tr("Write tables for others"));
    auto* menu = withMnemonics(new QMenu(export_));
    menu->setObjectName(QStringLiteral("markingExportMenu"));
    const std::pair<const char*, QString> ways[] = {{"codes", tr("Results, codes only (CSV)...")},
                                                    {"files", tr("Results with file names (CSV)...")},
                                                    {"returned", tr("Marks for each student (folder)...")},
                                                    {"class", tr("Page of the class, with file names...")},
                                                    {"marks", tr("Blind marks, for agreement (CSV)...")},
                                                    {"agreement", tr("Agreement with pictures (folder)...")}};
    for (const auto& [name, text] : ways) {
        QAction* way = menu->addAction(text);
        way->setObjectName(QStringLiteral("markingExport_") + QLatin1String(name));
        connect(way, &QAction::triggered, this, [this, name = name] { emit exportRequested(QLatin1String(name)); });
    }
    export_->setMenu(menu);
    auto* above = new QHBoxLayout;
    for (QCheckBox* check : {critical_, borderline_, unproven_, problem_})
        above->addWidget(check);
    above->addWidget(count_);
    above->addStretch(1);
    for (QPushButton* button : {open_, score_, export_})
        above->addWidget(button);
    auto* column = new QVBoxLayout(page);
    column->addLayout(above);
    column->addWidget(table_, 1);
    const auto openCurrent = [this] {
        const QModelIndex now = table_->currentIndex();
        if (now.isValid()) emit openRequested(now.data(WorkTable::kCodeRole).toString());
    };
    connect(table_, &QTableView::activated, this, openCurrent);
    connect(open_, &QPushButton::clicked, this, openCurrent);
    connect(score_, &QPushButton::clicked, this, &DeskDialog::scoreRequested);
    return page;
}

DeskWish DeskDialog::wish() const {
    return {folder_->text().trimmed(), exercise_->text().trimmed(), rubric_->currentData().toString(),
            marker_->text().trimmed(), blind_->isChecked(),         prove_->isChecked()};
}

void DeskDialog::setFolder(const QString& folder) {
    folder_->setText(QDir::toNativeSeparators(folder));
    tabs_->setCurrentIndex(0);
}

void DeskDialog::setExercise(const QString& path) {
    exercise_->setText(QDir::toNativeSeparators(path));
}

void DeskDialog::setMarker(const QString& marker) {
    marker_->setText(marker);
}

void DeskDialog::setBlind(bool isBlind) {
    blind_->setChecked(isBlind);
}

void DeskDialog::setRubricFile(const QString& file) {
    int at = rubric_->findData(file);
    if (at < 0) {
        rubric_->addItem(QFileInfo(file).fileName(), file);
        at = rubric_->count() - 1;
    }
    rubric_->setCurrentIndex(at);
}

void DeskDialog::setDesk(const marking::Desk* desk) {
    desk_ = desk;
    works_->setDesk(desk);
    agreement_->clear();
    tabs_->setTabEnabled(1, desk != nullptr);
    tabs_->setTabEnabled(2, desk != nullptr && desk->isBlind());
    tabs_->setCurrentIndex(desk != nullptr ? 1 : 0);
    if (desk != nullptr && filter_->rowCount() > 0) table_->setCurrentIndex(filter_->index(0, 0));
    refresh();
}

void DeskDialog::refresh() {
    // Without pictures many more rows are seen at once.
    constexpr int kLowRow = 36, kPictureRow = 76;
    table_->verticalHeader()->setDefaultSectionSize(
        desk_ != nullptr && desk_->isBlind() && !desk_->areAllIn() ? kLowRow : kPictureRow);
    works_->refresh();
    filter_->invalidate();
    QString count = tr("Works: %1 of %2").arg(filter_->rowCount()).arg(works_->rowCount());
    if (desk_ != nullptr && desk_->isBlind())
        count += QStringLiteral(". ") + tr("Marks in: %1 of %2").arg(desk_->countIn()).arg(works_->rowCount());
    count_->setText(count);
    open_->setEnabled(filter_->rowCount() > 0);
}

void DeskDialog::filter() {
    filter_->setWanted(
        (critical_->isChecked() ? WorkTable::kCritical : 0) | (borderline_->isChecked() ? WorkTable::kBorderline : 0) |
        (unproven_->isChecked() ? WorkTable::kUnproven : 0) | (problem_->isChecked() ? WorkTable::kProblem : 0));
    refresh();
}

void DeskDialog::setWork(const QString& title, double share) {
    isAtWork_ = !title.isEmpty();
    progress_->setVisible(isAtWork_);
    cancel_->setVisible(isAtWork_);
    progress_->setFormat(title + QStringLiteral("  %p %"));
    progress_->setValue(qRound(1000.0 * share));
    score_->setEnabled(!isAtWork_);
    showWhetherReady();
}

void DeskDialog::setNote(const QString& text) {
    note_->setText(text);
    note_->setVisible(!text.isEmpty());
}

bool DeskDialog::isAgreementShown() const {
    return tabs_->currentWidget() == agreement_;
}

QString DeskDialog::beside(const QString& code, int step) const {
    for (int row = 0; row < filter_->rowCount(); ++row)
        if (filter_->index(row, 0).data(WorkTable::kCodeRole).toString() == code) {
            const QModelIndex to = filter_->index(row + step, 0);
            return to.isValid() ? to.data(WorkTable::kCodeRole).toString() : QString();
        }
    return {};
}

void DeskDialog::select(const QString& code) {
    for (int row = 0; row < filter_->rowCount(); ++row)
        if (filter_->index(row, 0).data(WorkTable::kCodeRole).toString() == code)
            table_->setCurrentIndex(filter_->index(row, 0));
}

void DeskDialog::showWhetherReady() {
    const DeskWish now = wish();
    begin_->setEnabled(!isAtWork_ && !now.folder.isEmpty() && !now.exercise.isEmpty() && !now.marker.isEmpty());
}

void DeskDialog::showEvent(QShowEvent* event) {
    QDialog::showEvent(event);
    if (rubric_->count() > 1) return;
    // By their titles, once somebody asks.
    const std::string language = QLocale().bcp47Name().toStdString();
    for (const std::string& name : rubric::shippedRubrics()) {
        const rubric::Rubric shipped = rubric::shippedRubric(name);
        const std::string_view title = cases::inLanguage(shipped.title, language);
        rubric_->addItem(QString::fromUtf8(title.data(), static_cast<qsizetype>(title.size())),
                         QString::fromStdString(name));
    }
}

void DeskDialog::dragEnterEvent(QDragEnterEvent* event) {
    const QList<QUrl> urls = event->mimeData()->urls();
    if (urls.size() == 1 && QFileInfo(urls.front().toLocalFile()).isDir()) event->acceptProposedAction();
}

void DeskDialog::dropEvent(QDropEvent* event) {
    const QList<QUrl> urls = event->mimeData()->urls();
    if (urls.isEmpty()) return;
    event->acceptProposedAction();
    setFolder(urls.front().toLocalFile());
}

}  // namespace handpiece::desktop
