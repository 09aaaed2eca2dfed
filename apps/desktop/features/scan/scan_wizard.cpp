// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/scan_wizard.h"

#include <QDesktopServices>
#include <QFileDialog>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QListWidget>
#include <QProgressBar>
#include <QPushButton>
#include <QScreen>
#include <QShortcut>
#include <QStackedWidget>
#include <QStyle>
#include <QToolButton>
#include <QUrl>
#include <QVBoxLayout>

#include "desktop/features/scan/placing_page.h"
#include "desktop/features/scan/report_page.h"
#include "desktop/features/scan/surface_page.h"
#include "desktop/features/scan/tissue_page.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/scrolled.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {
namespace {

QFrame* strip(const char* name, QWidget* parent) {
    auto* frame = new QFrame(parent);
    frame->setObjectName(QLatin1String(name));
    frame->setFrameShape(QFrame::StyledPanel);
    frame->setAutoFillBackground(true);
    return frame;
}

QString sentence(QString text) {
    if (text.isEmpty()) return text;
    text[0] = text[0].toUpper();
    const QChar last = text.back();
    return last.isLetterOrNumber() || last == QLatin1Char(')') ? text + QLatin1Char('.') : text;
}

}  // namespace

ScanWizard::ScanWizard(std::filesystem::path unfinished, const QString& folder, QWidget* parent)
    : QDialog(parent), model_(std::move(unfinished)) {
    setObjectName(QStringLiteral("scanWizard"));
    setWindowTitle(tr("New case from scan"));
    setWindowFlag(Qt::WindowMaximizeButtonHint);
    setSizeGripEnabled(true);
    questions.folder = [this](const QString& title) { return QFileDialog::getExistingDirectory(this, title); };
    questions.fileToOpen = [this](const QString& title, const QString& filter) {
        return QFileDialog::getOpenFileName(this, title, {}, filter);
    };
    questions.fileToSave = [this](const QString& title, const QString& name, const QString& filter) {
        return QFileDialog::getSaveFileName(this, title, name, filter);
    };
    questions.showPage = [](const QString& file) { return QDesktopServices::openUrl(QUrl::fromLocalFile(file)); };

    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(14, 14, 14, 12);
    column->setSpacing(10);
    auto* middle = new QHBoxLayout;
    middle->setSpacing(14);

    steps_ = named(new QListWidget(this), "scanSteps", tr("Steps"), tr("The five steps; those that can be gone to"));
    steps_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    steps_->setSpacing(3);
    middle->addWidget(steps_);

    auto* right = new QVBoxLayout;
    right->setSpacing(10);

    // The one place for what went wrong.
    problem_ = strip("scanProblem", this);
    auto* inProblem = new QHBoxLayout(problem_);
    inProblem->setContentsMargins(12, 8, 12, 8);
    inProblem->setSpacing(12);
    problemSymbol_ = new QLabel(problem_);
    problemSymbol_->setPixmap(style()->standardIcon(QStyle::SP_MessageBoxWarning).pixmap(24));
    inProblem->addWidget(problemSymbol_, 0, Qt::AlignTop);
    auto* words = new QVBoxLayout;
    words->setSpacing(2);
    const auto told = [&](const char* name, bool bold) {
        auto* label = new QLabel(problem_);
        label->setObjectName(QLatin1String(name));
        label->setWordWrap(true);
        label->setTextFormat(Qt::PlainText);
        label->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
        if (bold) label->setFont(scaledFont(font(), 1.0, true));
        words->addWidget(label);
        return label;
    };
    problemWhat_ = told("scanProblemWhat", true);
    problemRemedy_ = told("scanProblemRemedy", false);
    inProblem->addLayout(words, 1);
    right->addWidget(problem_);

    unfinished_ = strip("scanUnfinished", this);
    auto* inUnfinished = new QHBoxLayout(unfinished_);
    inUnfinished->setContentsMargins(12, 8, 12, 8);
    inUnfinished->addWidget(new QLabel(tr("Go on with the unfinished scan?"), unfinished_), 1);
    auto* goOn = named(new QPushButton(icon(QStringLiteral("recent")), tr("Go on"), unfinished_), "scanGoOn",
                       tr("Go on with the unfinished scan"), tr("With all that was decided when it was closed"));
    auto* anew = named(new QPushButton(tr("Start anew"), unfinished_), "scanAnew", tr("Start anew"),
                       tr("Forget what was decided"));
    inUnfinished->addWidget(goOn);
    inUnfinished->addWidget(anew);
    right->addWidget(unfinished_);

    pages_ = new QStackedWidget(this);
    pages_->setObjectName(QStringLiteral("scanPages"));
    choose_ = new ChoosePage(model_, questions);
    tissues_ = new TissuePage(model_);
    surfaces_ = new SurfacePage(model_, questions);
    placing_ = new PlacingPage(model_);
    report_ = new ReportPage(model_, questions, folder);
    for (ScanPage* each :
         {static_cast<ScanPage*>(choose_), static_cast<ScanPage*>(tissues_), static_cast<ScanPage*>(surfaces_),
          static_cast<ScanPage*>(placing_), static_cast<ScanPage*>(report_)}) {
        pages_->addWidget(each);
        steps_->addItem(QStringLiteral("%1  %2").arg(steps_->count() + 1).arg(each->title()));
        steps_->item(steps_->count() - 1)->setSizeHint({0, fontMetrics().height() + 18});
    }
    int widest = 0;
    for (int i = 0; i < steps_->count(); ++i)
        widest = std::max(widest, fontMetrics().horizontalAdvance(steps_->item(i)->text()));
    steps_->setFixedWidth(widest + 30);
    auto* inPages = new QVBoxLayout;
    inPages->addWidget(pages_);
    right->addWidget(new Scrolled(inPages, this), 1);
    middle->addLayout(right, 1);
    column->addLayout(middle, 1);

    work_ = new QFrame(this);
    work_->setObjectName(QStringLiteral("scanWork"));
    auto* inWork = new QHBoxLayout(work_);
    inWork->setContentsMargins(0, 0, 0, 0);
    inWork->setSpacing(10);
    doing_ = new QLabel(work_);
    doing_->setObjectName(QStringLiteral("scanDoing"));
    progress_ = named(new QProgressBar(work_), "scanProgress", tr("Progress"), tr("How far it is"));
    progress_->setTextVisible(false);
    progress_->setFixedHeight(8);
    progress_->setRange(0, 1000);
    cancel_ = named(new QPushButton(tr("Stop"), work_), "scanStop", tr("Stop"),
                    tr("Stop this work; nothing decided is lost"));
    again_ = named(new QPushButton(tr("Go on"), work_), "scanAgain", tr("Go on"),
                   tr("Begin the work again that was stopped"));
    inWork->addWidget(doing_);
    inWork->addWidget(progress_, 1);
    inWork->addWidget(cancel_);
    inWork->addWidget(again_);

    auto* bottom = new QHBoxLayout;
    bottom->setSpacing(8);
    undo_ =
        iconButton(QStringLiteral("undo"), "scanUndo", tr("Undo"), this, tr("Take the last decision back (Ctrl+Z)"));
    redo_ = iconButton(QStringLiteral("redo"), "scanRedo", tr("Redo"), this, tr("Decide it again (Ctrl+Shift+Z)"));
    saveSteps_ = named(new QPushButton(icon(QStringLiteral("save-as")), tr("Save the steps..."), this), "scanSaveSteps",
                       tr("Save the steps"),
                       tr("All decisions as a file; \"handpiece scan case --job FILE\" makes the same case of it"));
    missing_ = new QLabel(this);
    missing_->setObjectName(QStringLiteral("scanMissing"));
    missing_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    back_ = named(new QPushButton(tr("Back"), this), "scanBack", tr("Back"), tr("To the step before"));
    next_ = named(new QPushButton(tr("Next"), this), "scanNext", tr("Next"), tr("To the next step"));
    next_->setDefault(true);
    close_ = named(new QPushButton(tr("Close"), this), "scanClose", tr("Close"),
                   tr("What was decided is kept; the next time you can go on with it"));
    bottom->addWidget(undo_);
    bottom->addWidget(redo_);
    bottom->addWidget(saveSteps_);
    bottom->addWidget(work_, 3);
    bottom->addWidget(missing_, 2);
    bottom->addWidget(back_);
    bottom->addWidget(next_);
    bottom->addWidget(close_);
    column->addLayout(bottom);
    for (QPushButton* button : findChildren<QPushButton*>())
        button->setAutoDefault(false);

    connect(undo_, &QToolButton::clicked, this, [this] { model_.undo(); });
    connect(redo_, &QToolButton::clicked, this, [this] { model_.redo(); });
    connect(new QShortcut(QKeySequence(QKeySequence::Undo), this), &QShortcut::activated, this,
            [this] { model_.undo(); });
    connect(new QShortcut(QKeySequence(Qt::CTRL | Qt::SHIFT | Qt::Key_Z), this), &QShortcut::activated, this,
            [this] { model_.redo(); });
    connect(saveSteps_, &QPushButton::clicked, this, &ScanWizard::saveSteps);
    connect(back_, &QPushButton::clicked, this, [this] { goTo(static_cast<Step>(std::max(0, step() - 1))); });
    connect(next_, &QPushButton::clicked, this, [this] {
        if (step() == report)
            close();
        else
            goTo(static_cast<Step>(step() + 1));
    });
    connect(close_, &QPushButton::clicked, this, &QDialog::close);
    connect(cancel_, &QPushButton::clicked, this, [this] { model_.cancel(); });
    connect(again_, &QPushButton::clicked, this, [this] { model_.tryAgain(); });
    connect(goOn, &QPushButton::clicked, this, [this] {
        unfinished_->hide();
        model_.goOn();
    });
    connect(anew, &QPushButton::clicked, this, [this] {
        unfinished_->hide();
        model_.giveUp();
    });
    connect(steps_, &QListWidget::currentRowChanged, this, [this](int row) {
        if (row >= 0 && row != step() && !goTo(static_cast<Step>(row))) showSteps();
    });
    connect(report_, &ReportPage::tryNow, this, &ScanWizard::tryNow);
    connect(&model_, &ScanModel::decided, this, [this] {
        unfinished_->hide();
        showSteps();
    });
    for (const auto signal :
         {&ScanModel::seriesFound, &ScanModel::scanRead, &ScanModel::previewReady, &ScanModel::fullReady})
        connect(&model_, signal, this, &ScanWizard::showSteps);
    connect(&model_, &ScanModel::workChanged, this, &ScanWizard::showWork);
    connect(&model_, &ScanModel::progressed, this, [this](double fraction) {
        progress_->setRange(0, 1000);
        progress_->setValue(static_cast<int>(1000 * fraction));
        doing_->setText(model_.doing());
    });
    connect(&model_, &ScanModel::problemChanged, this, &ScanWizard::showProblem);
    connect(&model_, &ScanModel::casesWritten, this, &ScanWizard::showSteps);

    resize(QSize(1180, 800).boundedTo(screen()->availableGeometry().size() - QSize(20, 50)));
    unfinished_->setVisible(model_.hasUnfinished());
    showProblem();
    showWork();
    goTo(choose);
}

ScanWizard::~ScanWizard() {
    // Pages tell nobody of their end.
    model_.disconnect(this);
}

ScanPage* ScanWizard::page(int step) const {
    return static_cast<ScanPage*>(pages_->widget(step));
}

ScanWizard::Step ScanWizard::step() const {
    return static_cast<Step>(pages_->currentIndex());
}

void ScanWizard::take(const QString& path) {
    goTo(choose);
    choose_->take(path);
}

bool ScanWizard::goTo(Step step) {
    for (int before = 0; before < step; ++before)
        if (!page(before)->missing().isEmpty()) return false;
    pages_->setCurrentIndex(step);
    model_.want(page(step)->depth());
    showSteps();
    return true;
}

void ScanWizard::showSteps() {
    bool reachable = true;
    {
        const QSignalBlocker quiet(steps_);
        for (int i = 0; i < stepCount; ++i) {
            QListWidgetItem* item = steps_->item(i);
            item->setFlags(reachable ? Qt::ItemIsEnabled | Qt::ItemIsSelectable : Qt::NoItemFlags);
            if (!page(i)->missing().isEmpty()) reachable = false;
        }
        steps_->setCurrentRow(step());
    }
    const QString missing = page(step())->missing();
    missing_->setText(step() == report ? QString() : missing);
    back_->setEnabled(step() > choose);
    next_->setText(step() == report ? tr("Finish") : tr("Next"));
    // A button that cannot be pressed gives its focus to the next one: that would be Close.
    if (next_->hasFocus() && !missing.isEmpty()) steps_->setFocus();
    next_->setEnabled(step() == report ? !model_.written().empty() : missing.isEmpty());
    undo_->setEnabled(model_.canUndo());
    redo_->setEnabled(model_.canRedo());
    saveSteps_->setEnabled(!model_.job().source.empty());
}

void ScanWizard::showWork() {
    const bool busy = model_.isBusy(), paused = model_.isPaused();
    doing_->setText(busy ? model_.doing() : paused ? tr("Stopped") : QString());
    progress_->setVisible(busy);
    if (!busy) progress_->setRange(0, 0);
    cancel_->setVisible(busy);
    again_->setVisible(paused && !busy);
    work_->setVisible(busy || paused);
    missing_->setVisible(!busy && !paused);
    showSteps();
}

void ScanWizard::showProblem() {
    const auto& problem = model_.problem();
    problem_->setVisible(problem.has_value());
    if (!problem) return;
    // In the language of the libraries the words speak for themselves.
    const auto own = [](QString text) {
        for (const char* prefix : {"Technical detail: ", "Technical advice: "})
            if (text.startsWith(QLatin1String(prefix))) text.remove(0, qstrlen(prefix));
        return sentence(text);
    };
    QString what = own(problem->what);
    if (!problem->where.isEmpty() && problem->where != QLatin1String("scan"))
        what += QStringLiteral(" (%1)").arg(problem->where);
    problemWhat_->setText(what);
    problemRemedy_->setText(own(problem->remedy));
    problemRemedy_->setVisible(!problem->remedy.isEmpty());
    problem_->setAccessibleName(what);
    problem_->setAccessibleDescription(problem->remedy);
}

void ScanWizard::saveSteps() {
    QString file = questions.fileToSave(tr("Save the steps"), QStringLiteral("scan-steps.toml"), tr("Steps (*.toml)"));
    if (file.isEmpty()) return;
    if (QFileInfo(file).suffix().isEmpty()) file += QStringLiteral(".toml");
    try {
        scan_case::writeScanJob(model_.job(), toPath(file));
    } catch (const core::Error& error) {
        model_.setProblem(problemOf(error));
    }
}

void ScanWizard::keyPressEvent(QKeyEvent* event) {
    // Return in a field is no wish for the next step, and Escape none to close an hour's work.
    if (event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter || event->key() == Qt::Key_Escape) return;
    QDialog::keyPressEvent(event);
}

void ScanWizard::changeEvent(QEvent* event) {
    if (event->type() == QEvent::PaletteChange) showProblem();
    QDialog::changeEvent(event);
}

}  // namespace handpiece::desktop
