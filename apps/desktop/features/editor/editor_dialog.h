// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The exercise editor: pages about one draft, what is wrong with it, steps back.

#include <QDialog>
#include <functional>
#include <vector>

#include "handpiece/assess/draft/draft.h"

class QLabel;
class QListWidget;
class QPushButton;
class QTabWidget;
class QTimer;
class QVBoxLayout;

namespace handpiece::desktop {

class EditorPage;
class PreparationPage;
class RubricPage;
class ToothPage;
class WorkPage;

/// [exerciseEditor]. Beside the window, which goes on.
class EditorDialog : public QDialog {
    Q_OBJECT
  public:
    explicit EditorDialog(QWidget* parent);
    /// Another exercise; what was there is given up.
    void begin(draft::Content content, const std::filesystem::path& file = {});
    [[nodiscard]] const draft::Draft& draft() const noexcept { return draft_; }
    /// One that another window of the program left, with its steps back.
    void takeOver(draft::Draft draft);
    void noteSaved(const std::filesystem::path& file);
    /// As a step.
    void change(const char* step, const std::function<void(draft::Content&)>& how);
    [[nodiscard]] ToothPage* toothPage() const noexcept { return tooth_; }
    [[nodiscard]] WorkPage* workPage() const noexcept { return work_; }
    [[nodiscard]] PreparationPage* preparationPage() const noexcept { return preparation_; }
    /// Of the preparation on the tooth, as it came out for what is there now.
    void setToothProblems(std::vector<draft::Problem> problems);
    /// The tooth is being looked at.
    void setChecking(bool checking);
    /// Changed a moment ago; settled() comes.
    [[nodiscard]] bool isSettling() const;
    [[nodiscard]] std::vector<draft::Problem> problems() const;

    /// Runs `then` once unsaved changes are out of the way.
    std::function<void(std::function<void()> then)> whenMayLeave = [](const std::function<void()>& then) { then(); };

  signals:
    void saveRequested();
    void saveAsRequested();
    void tryRequested();
    void viewRequested(bool ofPreparation);
    void viewShown();
    /// The draft has been as it is for a moment: its tooth may be looked at.
    void settled();

  protected:
    void closeEvent(QCloseEvent* event) override;
    void reject() override;

  private:
    void addButtons(QVBoxLayout* column);
    void refresh();
    void showProblems();

    draft::Draft draft_;
    QTabWidget* tabs_;
    ToothPage* tooth_;
    PreparationPage* preparation_;
    WorkPage* work_;
    RubricPage* rubric_;
    std::vector<EditorPage*> pages_;
    QListWidget* list_;
    QLabel* state_;
    QPushButton *undo_, *redo_, *try_, *save_, *saveAs_;
    QTimer* settle_;
    std::vector<draft::Problem> quick_, onTooth_;
    bool checking_ = false, refreshing_ = false;
};

}  // namespace handpiece::desktop
