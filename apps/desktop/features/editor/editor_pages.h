// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The pages of the exercise editor but for the rubric's.

#include <memory>
#include <vector>

#include "desktop/features/editor/editor_page.h"
#include "desktop/widgets/number_field.h"
#include "desktop/work/zone_glass.h"
#include "handpiece/assess/draft/handles.h"
#include "handpiece/senses/view/camera.h"

class QCheckBox;
class QComboBox;
class QFormLayout;
class QLabel;
class QLineEdit;
class QListWidget;
class QPlainTextEdit;
class QPushButton;

namespace handpiece::desktop {

class OwnTarget;
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
    WholeField* seed_;
    QLabel *now_, *work_;
    std::vector<QWidget*> buttons_;
};

/// [editorPreparation]. A field for each number of the template, with its unit and limits; beside them the tooth with
/// the preparation as glass, whose numbers are dragged by handles; or the tooth as it is asked for.
class PreparationPage : public EditorPage {
    Q_OBJECT
  public:
    explicit PreparationPage(Change change);
    void show(const draft::Content& content) override;
    /// The tooth as the preparation asks for it; null: it is being made.
    void setIdeal(std::shared_ptr<const std::vector<cases::Part>> parts);
    void clearIdeal();
    /// Whether it can be asked for.
    void setIdealPossible(bool possible) { idealButton_->setEnabled(possible); }
    /// Of the picture; none while there is no tooth in it.
    [[nodiscard]] std::optional<view::Camera> camera() const;
    /// Glass and handles are being made.
    [[nodiscard]] bool isBusy() const noexcept { return glass_.isBusy(); }
    /// In the order of the handles in the picture.
    [[nodiscard]] const std::vector<draft::Handle>& handles() const noexcept { return handles_; }
    [[nodiscard]] const ZoneGlass& glass() const noexcept { return glass_; }

  signals:
    void idealRequested();
    /// Work shall become what is asked for.
    void workRequested();

  protected:
    void showEvent(QShowEvent* event) override;

  private:
    enum class Shown { nothing, task, ideal };
    void connectPicture();
    void showStroke();
    void showNumbers(const preparation::Template* of);
    void showField(std::string_view name, double value);
    /// Tooth and glass, where the page is seen and they are others than before.
    void refreshPicture();
    void showTask();
    void takeGlass();
    void look(bool anew);
    void drag(int handle, double movedMm, bool isOver);
    [[nodiscard]] static QString handleText(std::string_view name, double value);

    SolidView* picture_;
    QPushButton* idealButton_;
    Shown shows_ = Shown::nothing;
    std::shared_ptr<const cases::Case> tooth_, pictured_;
    std::optional<preparation::Recipe> recipe_, glassOf_;
    std::string lookedAt_;  ///< the template for which the eye was placed
    ZoneGlass glass_;
    std::vector<draft::Handle> handles_;
    std::optional<draft::Handle> dragged_;  ///< as it was when it was taken
    OwnTarget* own_;
    QComboBox *template_, *side_;
    QLabel* sideLabel_;
    QWidget* numbers_ = nullptr;
    QFormLayout* form_;
    std::string shown_ = "?";  ///< the template whose numbers are there
    std::vector<std::pair<std::string, DecimalField*>> fields_;
    DecimalField *leewaySide_, *leewayFloor_, *pulp_;
};

/// [editorWork]
class WorkPage : public EditorPage {
    Q_OBJECT
  public:
    explicit WorkPage(Change change);
    void show(const draft::Content& content) override;

  signals:
    /// The window's, or that of the preparation's picture.
    void viewRequested(bool ofPreparation);
    void viewShown();
    void teacherWorkRequested();

  public:
    /// What is being done with the teacher's own work; empty: nothing.
    void setTeacherWorkNote(const QString& words);
    /// What it got when it was taken, told for as long as it is this work.
    void setTeacherWorkPoints(std::shared_ptr<const std::vector<std::byte>> of, const QString& words);

  private:
    QLabel* teacherWork_;
    QPushButton *takeTeacherWork_, *dropTeacherWork_;
    bool isTakingWork_ = false;
    std::shared_ptr<const std::vector<std::byte>> work_, pointsOf_;
    QString points_;
    void showTeacherWork();
    QComboBox *bur_, *drive_, *level_;
    QListWidget *burs_, *helps_;
    QCheckBox *timed_, *hard_, *ownJudgement_, *liveBar_;
    DecimalField *minutes_, *voxel_, *speed_;
    QLabel* view_;
    QPushButton* showView_;
    std::vector<DecimalField*> eye_;  ///< of the start view: eye, target, up
};

/// [editorTexts]
class TextsPage : public EditorPage {
    Q_OBJECT
  public:
    explicit TextsPage(Change change);
    void show(const draft::Content& content) override;

  private:
    QLineEdit *id_, *titleEn_, *titleJa_, *titleOther_;
    QPlainTextEdit *whatEn_, *whatJa_, *whatOther_;
    void showOther();

    QComboBox* other_;  ///< a third language, by its tag
    cases::Texts title_, what_;
    WholeField* version_;
};

}  // namespace handpiece::desktop
