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
    /// In a line: what was reached so far at the exercise of this id; empty: nothing yet.
    std::function<QString(const std::string& id)> bestOf = [](const std::string&) { return QString(); };
    /// Shows the one after this in the list; the first after the last, and of one that is not in it.
    void chooseAfter(const std::string& id);
    /// All of the chosen one is there.
    [[nodiscard]] bool isReady() const noexcept { return !job_ && task_ != nullptr; }
    /// Of the chosen one, for the result; null while it is not there.
    [[nodiscard]] const course::Parts& ideal() const noexcept { return ideal_; }

  signals:
    void beginRequested(const std::filesystem::path& path);
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
    void makeIdeal();
    void start(const QString& what, Job::Work work, std::function<void()> done);
    void giveUp();

    std::filesystem::path madeIn_, folder_, path_;
    std::vector<Entry> entries_;
    std::shared_ptr<const tasks::Task> task_;
    course::Parts ideal_;
    Job* job_ = nullptr;  ///< under way
    QListWidget* list_;
    QLabel *where_, *title_, *about_, *best_, *words_, *asks_, *note_;
    SolidView* view_;
    QProgressBar* progress_;
    QPushButton* begin_;
};

}  // namespace handpiece::desktop
