// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The pages of the exercise editor but for the rubric's.

#include <memory>
#include <vector>

#include "desktop/features/editor/editor_page.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QLineEdit;
class QListWidget;
class QPlainTextEdit;
class QPushButton;
class QSpinBox;

namespace handpiece::desktop {

class SolidView;

/// [editorTooth]
class ToothPage : public EditorPage {
    Q_OBJECT
  public:
    explicit ToothPage(Change change);
    void show(const draft::Content& content) override;
    /// What is being made; empty: nothing.
    void setWork(const QString& text);

  signals:
    void starterRequested(int fdi, int seed);
    void blockRequested(int layers);
    void caseRequested();

  private:
    QComboBox *fdi_, *layers_;
    QSpinBox* seed_;
    QLabel *now_, *work_;
    std::vector<QWidget*> buttons_;
};

/// [editorPreparation]. A field for each number of the template, with its unit and limits; the ideal beside them.
class PreparationPage : public EditorPage {
    Q_OBJECT
  public:
    explicit PreparationPage(Change change);
    void show(const draft::Content& content) override;
    /// The tooth as the preparation asks for it; null: it is being made.
    void setIdeal(std::shared_ptr<const std::vector<cases::Part>> parts, int buccalSign = 0);
    void clearIdeal();
    /// Whether it can be asked for.
    void setIdealPossible(bool possible) { idealButton_->setEnabled(possible); }

  signals:
    void idealRequested();

  private:
    void showNumbers(const preparation::Template* of);

    SolidView* ideal_;
    QPushButton* idealButton_;
    bool hasIdeal_ = false;
    QComboBox *template_, *side_;
    QLabel* sideLabel_;
    QWidget* numbers_ = nullptr;
    QFormLayout* form_;
    std::string shown_ = "?";  ///< the template whose numbers are there
    std::vector<std::pair<std::string, QDoubleSpinBox*>> fields_;
    QDoubleSpinBox *leewaySide_, *leewayFloor_, *pulp_;
};

/// [editorWork]
class WorkPage : public EditorPage {
    Q_OBJECT
  public:
    explicit WorkPage(Change change);
    void show(const draft::Content& content) override;

  signals:
    void viewRequested();

  private:
    QComboBox* bur_;
    QListWidget *burs_, *helps_;
    QCheckBox *timed_, *ownJudgement_;
    QSpinBox *minutes_, *voxel_;
    QLabel* view_;
};

/// [editorTexts]
class TextsPage : public EditorPage {
    Q_OBJECT
  public:
    explicit TextsPage(Change change);
    void show(const draft::Content& content) override;

  private:
    QLineEdit *id_, *titleEn_, *titleJa_;
    QPlainTextEdit *whatEn_, *whatJa_;
    QSpinBox* version_;
};

}  // namespace handpiece::desktop
