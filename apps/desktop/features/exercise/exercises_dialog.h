// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The exercises to choose from: what each asks, the ideal to turn around, the best so far.

#include <QDialog>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "desktop/features/exercise/exercise_steps.h"
#include "desktop/framework/job.h"
#include "handpiece/app/course/finished_work.h"

class QLabel;
class QListWidget;
class QProgressBar;
class QPushButton;

namespace handpiece::desktop {

class SolidView;

/// [exercisesDialog]. Reading, making and cutting the ideal happen beside the window; another choice gives up the one
/// under way.
class ExercisesDialog : public QDialog {
    Q_OBJECT
  public:
    /// `madeIn`: where the program puts the exercises that it makes.
    ExercisesDialog(std::filesystem::path madeIn, QWidget* parent);
    ~ExercisesDialog() override;

    /// Of a school or one's own; empty: only those of the program.
    void setFolder(const std::filesystem::path& folder);
    /// What was reached so far at the exercise of this id; none: nothing yet.
    std::function<std::optional<Reached>(const std::string& id)> reachedAt = [](const std::string&) {
        return std::optional<Reached>();
    };
    /// Criteria that are to be shown once more at it, by their ids; empty: nothing is due.
    std::function<std::vector<std::string>(const std::string& id)> dueOf = [](const std::string&) {
        return std::vector<std::string>();
    };
    /// Shows the one after this in the list; the first after the last, and of one that is not in it.
    void chooseAfter(const std::string& id);
    /// Shows that one, where it is in the list.
    void chooseExercise(const std::string& id);
    /// All of the chosen one is there.
    [[nodiscard]] bool isReady() const noexcept { return !job_ && task_ != nullptr; }
    /// Of the chosen one, for the result; null while it is not there.
    [[nodiscard]] const course::Parts& ideal() const noexcept { return ideal_; }

  signals:
    void beginRequested(const std::filesystem::path& path, bool unaided);
    void folderRequested();

  protected:
    void showEvent(QShowEvent* event) override;

  private:
    struct Entry {
        std::string id;  ///< as far as known
        std::filesystem::path path;
        cases::Texts title;
        QString wrong;
        bool isShipped = false;
    };
    void list();
    void choose(int row);
    void showTask();
    void showDue();
    void makeIdeal();
    void start(const QString& what, Job::Work work, std::function<void()> done);
    void giveUp();

    std::filesystem::path madeIn_, folder_, path_;
    std::vector<Entry> entries_;
    std::shared_ptr<const tasks::Task> task_;
    course::Parts ideal_;
    Job* job_ = nullptr;  ///< under way
    QListWidget* list_;
    QLabel *where_, *title_, *about_, *best_, *due_, *words_, *asks_, *note_;
    SolidView* view_;
    QProgressBar* progress_;
    QPushButton *begin_, *retest_, *next_;
    int nextRow_ = -1;
};

}  // namespace handpiece::desktop
