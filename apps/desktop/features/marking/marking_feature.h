// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The teacher's marking desk in the window: returned work scored in the background, opened in the picture, judged.

#include <QPointer>
#include <QTemporaryDir>
#include <functional>
#include <memory>

#include "desktop/features/marking/desk_dialog.h"
#include "desktop/framework/feature.h"
#include "desktop/framework/job.h"
#include "handpiece/app/marking/desk.h"

namespace handpiece::desktop {

class SheetPanel;

class MarkingFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { desk };
    explicit MarkingFeature(const FeatureContext& context);
    ~MarkingFeature() override;
    void showDocument() override;

    /// Null: none is open.
    [[nodiscard]] const marking::Desk* desk() const noexcept { return desk_.get(); }
    [[nodiscard]] bool isAtWork() const noexcept { return job_ != nullptr; }
    /// Whom to ask for a folder; tests put their own answer here.
    std::function<QString(const QString& title)> askFolder;

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    void open(const QString& folder = {});
    void begin();
    void takeDesk(const DeskWish& wish, std::vector<marking::ReturnedWork> works, tasks::Task task,
                  rubric::Rubric rubric);
    void score();
    void startJob(const QString& title, Job::Work work, std::function<void()> done);
    void endJob();
    void openWork(const QString& code);
    void look(const std::filesystem::path& path, bool isSession);
    void showSheet();
    /// Runs a change of the desk; what is refused is told. Whether it was kept.
    bool tryTo(const std::function<void(marking::Desk& desk)>& change);
    /// The tooth under a point of the picture.
    [[nodiscard]] std::optional<core::Vec3> placeUnder(const QPointF& point) const;
    void forgetPlace();
    void comment(const QString& text, bool atPlace, bool atTime);
    void goTo(const std::optional<core::Vec3>& placeMm, const std::optional<double>& timeS);
    void computeAgreement();
    void write(const QString& what);
    [[nodiscard]] QString returnedName(const std::string& code) const;
    void returnWork();
    void returnAll(const QString& folder);

    CommandSet<Command> commands_;
    DeskDialog* dialog_;
    SheetPanel* sheet_;
    QDockWidget* dock_;
    std::shared_ptr<marking::Desk> desk_;
    DeskWish wish_;
    std::shared_ptr<const tasks::Task> task_;
    QString code_;                        ///< of the work that is open; empty: none
    QString opening_, inPicture_;         ///< what the picture is about to show, and what it shows of this desk
    bool isPlaceWanted_ = false;          ///< the next click in the picture is one
    std::optional<core::Vec3> pickedMm_;  ///< for the next comment
    std::optional<double> pickedS_;
    bool goesToEnd_ = false, isWanted_ = false;
    QTemporaryDir shown_;  ///< works under their codes, for who marks blind
    QPointer<Job> job_, agreementJob_, copyJob_;
};

}  // namespace handpiece::desktop
