// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The teacher's exercise editor in the window: commands, teeth that are made for it, saving, trying out.

#include <QString>
#include <QTemporaryDir>
#include <functional>
#include <memory>

#include "desktop/framework/feature.h"
#include "desktop/framework/job.h"
#include "desktop/framework/questions.h"
#include "handpiece/assess/draft/draft.h"

namespace handpiece::desktop {

class EditorDialog;

class EditorFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { anew, edit };
    explicit EditorFeature(const FeatureContext& context);
    /// Where the window goes for another language its draft waits for the next one.
    ~EditorFeature() override;
    [[nodiscard]] EditorDialog* dialog() const noexcept { return dialog_; }
    /// Teeth are being made, or the draft's is being looked at or will be.
    [[nodiscard]] bool isBusy() const;

    /// About a draft that no file holds; tests put their own answer here.
    std::function<Questions::Unsaved()> askUnsaved;

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    void connectDialog();
    [[nodiscard]] bool mayLeave();
    void show();
    void open();
    void edit(const std::filesystem::path& exercise);
    void write(const std::filesystem::path& file);
    void make(const QString& title, std::function<cases::Case(const core::Progress&)> how);
    /// Runs in the background; one that fails says so. `end`: however it ended, and before `done`.
    void start(std::unique_ptr<Job>& job, const QString& title, std::function<void(const core::Progress&)> how,
               std::function<void()> end, std::function<void()> done);
    void takeStarter(int fdi, int seed);
    void takeCase();
    void takeTeacherWork();
    void takeWork();
    void check();
    void cutIdeal();
    /// To where it is; elsewhere is asked. False: it was not saved.
    bool save(bool elsewhere);
    void tryOut();

    CommandSet<Command> commands_;
    EditorDialog* dialog_;
    std::unique_ptr<Job> making_, checking_, cutting_, proving_;
    bool again_ = false, comesBack_ = false;
    QTemporaryDir tried_;
    int tries_ = 0;
};

}  // namespace handpiece::desktop
