// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/editor_dialog.h"

#include <QCloseEvent>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QScreen>
#include <QScrollArea>
#include <QShortcut>
#include <QTabWidget>
#include <QTimer>
#include <QVBoxLayout>
#include <algorithm>

#include "desktop/features/editor/editor_pages.h"
#include "desktop/features/editor/editor_words.h"
#include "desktop/features/editor/rubric_page.h"
#include "desktop/framework/problem.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {
namespace {

/// After the last change; laying a preparation on a tooth takes a second.
constexpr int kSettleMs = 400;

QString severityWords(rubric::Severity severity) {
    return severity == rubric::Severity::error     ? EditorDialog::tr("Error")
           : severity == rubric::Severity::warning ? EditorDialog::tr("Warning")
                                                   : EditorDialog::tr("Remark");
}

}  // namespace

EditorDialog::EditorDialog(QWidget* parent) : QDialog(parent), settle_(new QTimer(this)) {
    setObjectName(QStringLiteral("exerciseEditor"));
    auto* column = new QVBoxLayout(this);
    tabs_ = named(new QTabWidget(this), "editorTabs", tr("Parts of the exercise"));
    const EditorPage::Change how = [this](const char* step, const auto& what) { change(step, what); };
    tooth_ = new ToothPage(how);
    work_ = new WorkPage(how);
    rubric_ = new RubricPage(how);
    preparation_ = new PreparationPage(how);
    auto* texts = new TextsPage(how);
    // In the order of draft::Part.
    pages_ = {tooth_, preparation_, work_, rubric_, texts};
    const QString titles[] = {tr("Tooth"), tr("Preparation"), tr("Work"), tr("Judgement"), tr("Texts")};
    for (std::size_t i = 0; i < pages_.size(); ++i) {
        auto* scroll = new QScrollArea(tabs_);
        scroll->setWidgetResizable(true);
        scroll->setFrameShape(QFrame::NoFrame);
        scroll->setWidget(pages_[i]);
        tabs_->addTab(scroll, titles[i]);
    }
    column->addWidget(tabs_, 1);
    list_ = named(new QListWidget(this), "editorProblems", tr("What is wrong"), tr("A click goes to its page"));
    list_->setMaximumHeight(96);
    list_->setWordWrap(true);
    column->addWidget(list_);
    addButtons(column);
    connect(list_, &QListWidget::itemClicked, this,
            [this](const QListWidgetItem* item) { tabs_->setCurrentIndex(item->data(Qt::UserRole).toInt()); });
    connect(work_, &WorkPage::viewRequested, this, &EditorDialog::viewRequested);
    connect(work_, &WorkPage::viewShown, this, &EditorDialog::viewShown);
    settle_->setSingleShot(true);
    settle_->setInterval(kSettleMs);
    connect(settle_, &QTimer::timeout, this, &EditorDialog::settled);
    // As wide as its tables like, within the small screens of schools.
    resize(std::min(1240, screen()->availableSize().width()), std::min(700, screen()->availableSize().height()));
    refresh();
}

void EditorDialog::addButtons(QVBoxLayout* column) {
    auto* row = new QHBoxLayout;
    const auto button = [&](const QString& text, const char* name, const QString& tip, auto asked) {
        auto* made = named(new QPushButton(text, this), name, text, tip);
        made->setAutoDefault(false);
        connect(made, &QPushButton::clicked, this, asked);
        row->addWidget(made);
        return made;
    };
    undo_ = button(tr("Undo"), "editorUndo", tr("Take the last change back"), [this] {
        draft_.undo();
        refresh();
    });
    undo_->setShortcut(QKeySequence::Undo);
    redo_ = button(tr("Redo"), "editorRedo", tr("Make it again"), [this] {
        draft_.redo();
        refresh();
    });
    redo_->setShortcut(QKeySequence::Redo);
    state_ = note({}, this, "editorState");
    row->addWidget(state_, 1);
    try_ = button(tr("Try it"), "editorTry", tr("Open it in the window as a student would have it"),
                  [this] { emit tryRequested(); });
    save_ = button(tr("Save"), "editorSave", tr("Save the exercise where it is"), [this] { emit saveRequested(); });
    save_->setShortcut(QKeySequence::Save);
    saveAs_ = button(tr("Save as .handpiece..."), "editorSaveAs", tr("One file to give to students"),
                     [this] { emit saveAsRequested(); });
    column->addLayout(row);
}

void EditorDialog::begin(draft::Content content, const std::filesystem::path& file) {
    draft_.begin(std::move(content), file);
    onTooth_.clear();
    tabs_->setCurrentIndex(0);
    refresh();
}

void EditorDialog::takeOver(draft::Draft draft) {
    draft_ = std::move(draft);
    refresh();
}

void EditorDialog::noteSaved(const std::filesystem::path& file) {
    draft_.noteSaved(file);
    refresh();
}

void EditorDialog::change(const char* step, const std::function<void(draft::Content&)>& how) {
    if (refreshing_) return;
    draft::Content next = draft_.now();
    how(next);
    draft_.change(std::move(next), step);
    refresh();
}

void EditorDialog::refresh() {
    refreshing_ = true;
    const draft::Content& now = draft_.now();
    for (EditorPage* page : pages_)
        page->show(now);
    refreshing_ = false;
    undo_->setEnabled(draft_.canUndo());
    redo_->setEnabled(draft_.canRedo());
    save_->setEnabled(now.tooth != nullptr && draft_.isUnsaved());
    saveAs_->setEnabled(now.tooth != nullptr);
    const QString name = draft_.file().empty() ? QString::fromStdString(now.id) : toQString(draft_.file().filename());
    setWindowTitle(tr("Exercise editor: %1").arg(name) + (draft_.isUnsaved() ? QStringLiteral(" *") : QString()));
    settle_->start();
    quick_ = draft::problems(now);
    rubric_->setProblems(quick_);
    showProblems();
}

bool EditorDialog::isSettling() const {
    return settle_->isActive();
}

std::vector<draft::Problem> EditorDialog::problems() const {
    std::vector<draft::Problem> all = quick_;
    all.insert(all.end(), onTooth_.begin(), onTooth_.end());
    return all;
}

void EditorDialog::setToothProblems(std::vector<draft::Problem> problems) {
    onTooth_ = std::move(problems);
    showProblems();
}

void EditorDialog::setChecking(bool checking) {
    checking_ = checking;
    showProblems();
}

void EditorDialog::showProblems() {
    list_->clear();
    std::vector<draft::Problem> all = problems();
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.severity < b.severity; });
    for (const draft::Problem& p : all) {
        const QString said =
            QStringLiteral("%1, %2: %3")
                .arg(severityWords(p.severity), tabs_->tabText(static_cast<int>(p.part)), problemWords(p));
        auto* item = new QListWidgetItem(said, list_);
        item->setData(Qt::UserRole, static_cast<int>(p.part));
    }
    const bool wrong = draft::hasErrors(all);
    state_->setText(checking_ ? tr("Laying the preparation on the tooth...")
                    : wrong   ? tr("Students cannot have it like this yet.")
                              : tr("Nothing stands in the way."));
    try_->setEnabled(draft_.now().tooth != nullptr && !wrong && !checking_ && !isSettling());
    preparation_->setIdealPossible(draft_.now().tooth != nullptr && draft_.now().preparation && !wrong);
}

void EditorDialog::closeEvent(QCloseEvent* event) {
    event->ignore();
    reject();
}

void EditorDialog::reject() {
    whenMayLeave([this] { QDialog::reject(); });
}

}  // namespace handpiece::desktop
