// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The landmarks of the tooth that is worked on, as a list.

#include <QWidget>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/model/case/landmark.h"

class QComboBox;
class QLabel;
class QProgressBar;
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
    /// The same tooth's, moved, come or gone: of those that stay what is shown and chosen stays.
    void updateMarks(const std::vector<cases::Landmark>& marks);
    /// Those that such a tooth has and this one lacks: what is offered to be set.
    void setLacked(const std::vector<cases::Landmark>& lacked);

    /// What may be done now.
    struct Abilities {
        bool mayChange = false, canUndo = false, canPutBack = false, canSave = false;
        bool isPlacing = false;
        std::optional<double> finding{};  ///< how far a search is
        QString note{};                   ///< why not, or what is to be known
    };
    void setAbilities(const Abilities& now);
    void select(int index);
    [[nodiscard]] int selected() const;
    [[nodiscard]] bool isChecked(std::size_t index) const;
    /// What is chosen to be set.
    [[nodiscard]] cases::LandmarkKind kindToSet() const;
    [[nodiscard]] std::string nameToSet() const;

  signals:
    void shownChanged();
    void selectionChanged(int index);
    void findRequested();
    void cancelRequested();
    void placingRequested(bool isPlacing);
    void deleteRequested();
    void undoRequested();
    void resetRequested();
    void saveRequested();

  private:
    void offerNames();

    std::vector<cases::Landmark> listed_, lacked_;  ///< kinds and names
    bool isFinding_ = false;
    QTreeWidget* list_;
    QPushButton* find_;
    QProgressBar* progress_;
    QComboBox* kind_;
    QComboBox* name_;
    QPushButton* set_;
    QPushButton* delete_;
    QPushButton* undo_;
    QPushButton* reset_;
    QPushButton* save_;
    QLabel* note_;
};

}  // namespace handpiece::desktop
