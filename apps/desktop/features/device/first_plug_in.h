// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A device's first three steps: connect, calibrate, feel a block. The work in the window goes on with the mouse
/// meanwhile, and whoever closes this works with what fits the model.

#include <QDialog>
#include <memory>

#include "desktop/features/device/feel_block.h"
#include "desktop/work/simulator.h"

class QLabel;
class QPushButton;
class QStackedWidget;

namespace handpiece::desktop {

class BlockView;
class ForceGauge;
class LiveBox;
class ProfileBox;

/// [firstPlugIn]. For the device that is open.
class FirstPlugIn : public QDialog {
    Q_OBJECT
  public:
    explicit FirstPlugIn(Simulator& simulator, bool realTime, QWidget* parent = nullptr);
    ~FirstPlugIn() override;

    enum class Step { connect, calibrate, feel };
    [[nodiscard]] Step step() const noexcept { return step_; }
    [[nodiscard]] const FeelBlock& block() const noexcept { return block_; }
    void done(int result) override;

  private:
    QWidget* connectPage();
    QWidget* calibratePage();
    QWidget* feelPage();
    void go(Step step);
    void showState();
    void tryCalibration();
    void takeProfile();
    void startBlock();

    Simulator& simulator_;
    Step step_ = Step::connect;
    FeelBlock block_;
    std::unique_ptr<Job> calibrating_;
    workspace::Profile profile_;
    bool reopening_ = false;
    std::int64_t askedNs_ = 0;
    QStackedWidget* pages_;
    QLabel *heading_, *connected_, *calibrationText_, *calibrationState_, *feelText_;
    LiveBox *live_, *reach_;
    QPushButton *calibrate_, *back_, *next_, *later_;
    ProfileBox* choices_;
    BlockView* picture_;
    ForceGauge* gauge_;
};

}  // namespace handpiece::desktop
