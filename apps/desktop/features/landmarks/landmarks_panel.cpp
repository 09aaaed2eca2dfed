// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/landmarks/landmarks_panel.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <QTreeWidget>
#include <QVBoxLayout>

#include "desktop/features/landmarks/landmark_words.h"
#include "desktop/widgets/parts.h"
#include "handpiece/model/case/edit_landmarks.h"

namespace handpiece::desktop {

LandmarksPanel::LandmarksPanel(QWidget* parent)
    : QWidget(parent),
      list_(named(new QTreeWidget, "landmarkList", tr("Landmarks"),
                  tr("What is ticked is shown over the tooth; the one chosen is moved by the arrow keys"))),
      undo_(named(new QPushButton(tr("Undo")), "landmarkUndo", tr("Undo"), tr("Take the last move back"))),
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
    auto* row = new QHBoxLayout;
    for (QPushButton* button : {undo_, reset_, save_})
        row->addWidget(button);
    row->addStretch();
    auto* column = new QVBoxLayout(this);
    column->addWidget(list_, 1);
    column->addLayout(row);
    column->addWidget(note_);
    connect(list_, &QTreeWidget::itemChanged, this, &LandmarksPanel::shownChanged);
    connect(list_, &QTreeWidget::currentItemChanged, this, [this] { emit selectionChanged(selected()); });
    connect(undo_, &QPushButton::clicked, this, &LandmarksPanel::undoRequested);
    connect(reset_, &QPushButton::clicked, this, &LandmarksPanel::resetRequested);
    connect(save_, &QPushButton::clicked, this, &LandmarksPanel::saveRequested);
}

void LandmarksPanel::setMarks(const std::vector<cases::Landmark>& marks) {
    {
        const QSignalBlocker quiet(list_);
        list_->clear();
        for (const cases::Landmark& mark : marks) {
            auto* item = new QTreeWidgetItem(list_);
            item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsUserCheckable);
            item->setCheckState(0, cases::liesOnSurface(mark.kind) ? Qt::Checked : Qt::Unchecked);
        }
    }
    updateMarks(marks);
}

void LandmarksPanel::updateMarks(const std::vector<cases::Landmark>& marks) {
    const QSignalBlocker quiet(list_);
    for (std::size_t i = 0; i < marks.size(); ++i) {
        QTreeWidgetItem* item = list_->topLevelItem(static_cast<int>(i));
        item->setText(0, landmarkText(marks[i]));
        item->setText(1, sourceText(marks[i].source));
        item->setToolTip(0, landmarkText(marks[i]));
    }
}

void LandmarksPanel::setAbilities(bool mayMove, bool canUndo, bool canSave, const QString& note) {
    undo_->setEnabled(mayMove && canUndo);
    reset_->setEnabled(mayMove && canUndo);
    save_->setEnabled(mayMove && canSave);
    note_->setText(note);
    note_->setVisible(!note.isEmpty());
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

}  // namespace handpiece::desktop
