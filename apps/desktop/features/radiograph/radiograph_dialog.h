// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A radiograph of the tooth that is open, as it is cut: which view, the picture, where it is saved.

#include <QDialog>
#include <functional>
#include <memory>
#include <optional>

#include "desktop/framework/job.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/senses/radiograph/radiograph.h"

class QComboBox;
class QLabel;
class QProgressBar;
class QPushButton;

namespace handpiece::desktop {

/// [radiographDialog]. Pictures are taken on a thread of their own; another choice gives up the one under way.
class RadiographDialog : public QDialog {
    Q_OBJECT
  public:
    explicit RadiographDialog(QWidget* parent);

    /// Null: no tooth is open. Takes the picture while the dialog is shown. `live`: its teeth;
    /// `state`: how they are cut, asked for each picture.
    void setTooth(std::shared_ptr<const cases::Case> toothCase, std::shared_ptr<const simulation::LiveTooth> live,
                  std::function<tooth::StateDelta()> state);
    /// What is shown; none while it is being taken.
    [[nodiscard]] const std::optional<radiograph::Radiograph>& taken() const noexcept { return taken_; }

  signals:
    void saveRequested();

  protected:
    void showEvent(QShowEvent* event) override;
    void hideEvent(QHideEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;

  private:
    void take();
    void stop(const QString& note);
    void showPicture();

    std::shared_ptr<const cases::Case> toothCase_;
    std::shared_ptr<const simulation::LiveTooth> live_;
    std::function<tooth::StateDelta()> state_;
    std::optional<radiograph::Radiograph> taken_;
    Job* job_ = nullptr;  ///< under way
    QComboBox *view_, *tooth_;
    QLabel *picture_, *note_;
    QProgressBar* progress_;
    QPushButton *cancel_, *again_, *save_;
};

}  // namespace handpiece::desktop
