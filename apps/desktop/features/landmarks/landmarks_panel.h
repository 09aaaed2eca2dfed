// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The landmarks of the tooth that is worked on, as a list.

#include <QWidget>
#include <vector>

#include "handpiece/model/case/landmark.h"

class QLabel;
class QPushButton;
class QTreeWidget;

namespace handpiece::desktop {

/// [landmarksPanel]. Plain data: what is moved where is the feature's.
class LandmarksPanel : public QWidget {
    Q_OBJECT
  public:
    explicit LandmarksPanel(QWidget* parent = nullptr);

    /// Another tooth's; all on the surface are shown, those inside are not.
    void setMarks(const std::vector<cases::Landmark>& marks);
    /// The same ones, moved: what is shown and chosen stays.
    void updateMarks(const std::vector<cases::Landmark>& marks);
    /// What may be done now; `note`: why not, or what is to be known.
    void setAbilities(bool mayMove, bool canUndo, bool canSave, const QString& note);
    void select(int index);
    [[nodiscard]] int selected() const;
    [[nodiscard]] bool isChecked(std::size_t index) const;

  signals:
    void shownChanged();
    void selectionChanged(int index);
    void undoRequested();
    void resetRequested();
    void saveRequested();

  private:
    QTreeWidget* list_;
    QPushButton* undo_;
    QPushButton* reset_;
    QPushButton* save_;
    QLabel* note_;
};

}  // namespace handpiece::desktop
