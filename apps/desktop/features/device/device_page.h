// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The page about the device: how it does, its settings, how good this station feels.

#include <QDialog>
#include <QString>
#include <functional>
#include <memory>

#include "desktop/framework/settings.h"
#include "desktop/work/simulator.h"
#include "handpiece/devices/fidelity/fidelity.h"

class QLabel;
class QTabWidget;

namespace handpiece::desktop {

class FidelityBox;
class LiveBox;
class ProfileBox;

/// [devicePage].
class DevicePage : public QDialog {
    Q_OBJECT
  public:
    /// Whom to ask for a file name.
    using AskFile = std::function<QString(const QString& title, const QString& start, const QString& filter)>;
    DevicePage(Simulator& simulator, Settings& settings, AskFile ask, QWidget* parent = nullptr);
    ~DevicePage() override;

    /// As the check is done; a test may put its own there.
    std::function<fidelity::Report(std::unique_ptr<link::Driver>, const fidelity::CheckSettings&,
                                   const core::Progress&)>
        check = [](std::unique_ptr<link::Driver> driver, const fidelity::CheckSettings& settings,
                   const core::Progress& progress) { return fidelity::check(std::move(driver), settings, progress); };

  private:
    void showDevice();
    void showState();
    void takeProfile();
    void startCheck(fidelity::CheckSettings settings);
    void endCheck();
    void save();

    Simulator& simulator_;
    Settings& settings_;
    AskFile ask_;
    std::unique_ptr<Job> checking_;
    QString checked_;  ///< the device that the check has taken
    QTabWidget* tabs_;
    LiveBox* live_;
    ProfileBox* profile_;
    FidelityBox* fidelity_;
    QLabel* note_;
};

}  // namespace handpiece::desktop
