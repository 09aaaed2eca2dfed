// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/landmarks/landmarks_panel.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QSignalBlocker>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "desktop/features/landmarks/landmark_words.h"
#include "desktop/widgets/parts.h"
#include "handpiece/model/case/edit_landmarks.h"

namespace handpiece::desktop {
namespace {

bool isSame(const cases::Landmark& one, const cases::Landmark& other) {
    return one.kind == other.kind && one.name == other.name;
}

}  // namespace

LandmarksPanel::LandmarksPanel(QWidget* parent)
    : QWidget(parent),
      list_(named(new QTreeWidget, "landmarkList", tr("Landmarks"),
                  tr("What is ticked is shown over the tooth; the one chosen is moved by the arrow keys"))),
      find_(named(new QPushButton(tr("Find")), "landmarkFind", tr("Find landmarks"),
                  tr("Look for landmarks by the tooth's shape; what was set by hand stays"))),
      progress_(named(new QProgressBar, "landmarkProgress", tr("Finding landmarks"))),
      kind_(named(new QComboBox, "landmarkKind", tr("Kind of the landmark to set"))),
      name_(named(new QComboBox, "landmarkName", tr("Name of the landmark to set"),
                  tr("One that this tooth lacks, or another name"))),
      set_(named(new QPushButton(tr("Set")), "landmarkSet", tr("Set by hand"),
                 tr("Click the tooth where it is to be: a line or ring point by point, then press again"))),
      delete_(named(new QPushButton(tr("Delete")), "landmarkDelete", tr("Delete"), tr("Remove the one chosen"))),
      undo_(named(new QPushButton(tr("Undo")), "landmarkUndo", tr("Undo"), tr("Take the last change back"))),
      reset_(named(new QPushButton(tr("Put back")), "landmarkReset", tr("Put back"),
                   tr("The one chosen, or all when none is, back to where the case had it"))),
      save_(named(new QPushButton(tr("Save...")), "landmarkSave", tr("Save the landmarks"),
                  tr("Keep the landmarks in the case; a tooth of the program becomes a case of your own"))),
      note_(note(QString(), this, "landmarkNote")) {
    setObjectName(QStringLiteral("landmarksPanel"));
    list_->setColumnCount(2);
    list_->setHeaderLabels({tr("Landmark"), tr("Source")});
    list_->setRootIsDecorated(false);
    list_->setUniformRowHeights(true);
    list_->header()->setSectionResizeMode(0, QHeaderView::Stretch);
    list_->header()->setSectionResizeMode(1, QHeaderView::ResizeToContents);
    list_->header()->setStretchLastSection(false);
    progress_->setVisible(false);
    set_->setCheckable(true);
    for (std::size_t k = 0; k < cases::kLandmarkKindCount; ++k)
        kind_->addItem(kindText(static_cast<cases::LandmarkKind>(k)));
    name_->setEditable(true);
    for (QComboBox* box : {kind_, name_}) {
        box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        box->setMinimumContentsLength(7);
    }
    offerNames();
    const auto inRow = [](std::initializer_list<QWidget*> widgets) {
        auto* row = new QHBoxLayout;
        for (QWidget* widget : widgets)
            row->addWidget(widget);
        return row;
    };
    auto* column = new QVBoxLayout(this);
    column->addWidget(list_, 1);
    // No row wider than three buttons: the column on the right is as wide as its widest panel must be.
    column->addLayout(inRow({kind_, name_}));
    for (QHBoxLayout* row : {inRow({set_, find_, delete_}), inRow({undo_, reset_, save_})}) {
        row->addStretch();
        column->addLayout(row);
    }
    column->addWidget(progress_);
    column->addWidget(note_);
    connect(list_, &QTreeWidget::itemChanged, this, &LandmarksPanel::shownChanged);
    connect(list_, &QTreeWidget::currentItemChanged, this, [this] { emit selectionChanged(selected()); });
    connect(kind_, &QComboBox::currentIndexChanged, this, &LandmarksPanel::offerNames);
    connect(find_, &QPushButton::clicked, this, [this] { isFinding_ ? emit cancelRequested() : emit findRequested(); });
    connect(set_, &QPushButton::clicked, this, &LandmarksPanel::placingRequested);
    connect(delete_, &QPushButton::clicked, this, &LandmarksPanel::deleteRequested);
    connect(undo_, &QPushButton::clicked, this, &LandmarksPanel::undoRequested);
    connect(reset_, &QPushButton::clicked, this, &LandmarksPanel::resetRequested);
    connect(save_, &QPushButton::clicked, this, &LandmarksPanel::saveRequested);
}

void LandmarksPanel::setMarks(const std::vector<cases::Landmark>& marks) {
    {
        const QSignalBlocker quiet(list_);
        list_->clear();
    }
    listed_.clear();
    updateMarks(marks);
}

void LandmarksPanel::updateMarks(const std::vector<cases::Landmark>& marks) {
    const QSignalBlocker quiet(list_);
    if (!std::equal(marks.begin(), marks.end(), listed_.begin(), listed_.end(), isSame)) {
        const auto before = std::exchange(listed_, marks);
        std::vector<Qt::CheckState> ticks;
        for (const cases::Landmark& mark : marks) {
            const auto old = std::find_if(before.begin(), before.end(), [&](const auto& b) { return isSame(b, mark); });
            ticks.push_back(old != before.end()
                                ? list_->topLevelItem(static_cast<int>(old - before.begin()))->checkState(0)
                            : cases::liesOnSurface(mark.kind) ? Qt::Checked
                                                              : Qt::Unchecked);
        }
        const int chosen = selected();
        int chosenNow = -1;
        for (std::size_t i = 0; chosen >= 0 && i < marks.size(); ++i)
            if (isSame(marks[i], before[static_cast<std::size_t>(chosen)])) chosenNow = static_cast<int>(i);
        list_->clear();
        for (const Qt::CheckState tick : ticks) {
            auto* item = new QTreeWidgetItem(list_);
            item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsUserCheckable);
            item->setCheckState(0, tick);
        }
        list_->setCurrentItem(list_->topLevelItem(chosenNow));
    }
    for (std::size_t i = 0; i < marks.size(); ++i) {
        QTreeWidgetItem* item = list_->topLevelItem(static_cast<int>(i));
        item->setText(0, landmarkText(marks[i]));
        item->setText(1, sourceText(marks[i].source));
        item->setToolTip(0, landmarkText(marks[i]));
    }
}

void LandmarksPanel::setLacked(const std::vector<cases::Landmark>& lacked) {
    if (std::equal(lacked.begin(), lacked.end(), lacked_.begin(), lacked_.end(), isSame)) return;
    lacked_ = lacked;
    offerNames();
}

/// Of the kind chosen those that are lacked, else the sides of a tooth.
void LandmarksPanel::offerNames() {
    std::vector<std::string> names;
    for (const cases::Landmark& mark : lacked_)
        if (mark.kind == kindToSet()) names.push_back(mark.name);
    if (names.empty()) names = {"", "mesial", "distal", "buccal", "lingual", "central"};
    name_->clear();
    for (const std::string& name : names)
        name_->addItem(nameText(name), QString::fromStdString(name));
    name_->setCurrentIndex(0);
}

void LandmarksPanel::setAbilities(const Abilities& now) {
    isFinding_ = now.finding.has_value();
    find_->setText(isFinding_ ? tr("Cancel") : tr("Find"));
    find_->setEnabled(now.mayChange || isFinding_);
    progress_->setVisible(isFinding_);
    if (now.finding) progress_->setValue(static_cast<int>(100.0 * *now.finding));
    for (QWidget* widget : std::initializer_list<QWidget*>{kind_, name_})
        widget->setEnabled(now.mayChange && !now.isPlacing);
    set_->setEnabled(now.mayChange);
    set_->setChecked(now.isPlacing);
    set_->setText(now.isPlacing ? tr("Done") : tr("Set"));
    delete_->setEnabled(now.mayChange && !now.isPlacing && selected() >= 0);
    undo_->setEnabled(now.mayChange && now.canUndo);
    reset_->setEnabled(now.mayChange && !now.isPlacing && now.canPutBack);
    save_->setEnabled(now.mayChange && !now.isPlacing && now.canSave);
    note_->setText(now.note);
    note_->setVisible(!now.note.isEmpty());
}

void LandmarksPanel::select(int index) {
    const QSignalBlocker quiet(list_);
    list_->setCurrentItem(list_->topLevelItem(index));
}

int LandmarksPanel::selected() const {
    return list_->indexOfTopLevelItem(list_->currentItem());
}

bool LandmarksPanel::isChecked(std::size_t index) const {
    const QTreeWidgetItem* item = list_->topLevelItem(static_cast<int>(index));
    return item != nullptr && item->checkState(0) == Qt::Checked;
}

cases::LandmarkKind LandmarksPanel::kindToSet() const {
    return static_cast<cases::LandmarkKind>(std::max(0, kind_->currentIndex()));
}

std::string LandmarksPanel::nameToSet() const {
    const int at = name_->findText(name_->currentText());
    return (at >= 0 ? name_->itemData(at).toString() : name_->currentText().trimmed()).toStdString();
}

}  // namespace handpiece::desktop
