// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The program around the window: settings, language, colours, the work; a window that can be made anew.

#include <QObject>
#include <memory>

#include "desktop/framework/language.h"
#include "desktop/framework/main_window.h"
#include "desktop/framework/settings.h"
#include "desktop/program/command_line.h"
#include "desktop/program/run_statistics.h"
#include "desktop/work/simulator.h"
#include "handpiece/app/exercise/school_defaults.h"

class QApplication;

namespace handpiece::desktop {

/// One for a program. The window speaks one language from its making to its end, so another language is another window
/// onto the same work.
class Host : public QObject {
    Q_OBJECT
  public:
    Host(QApplication& application, const CommandLine& line, const Simulator::Options& options);
    ~Host() override;

    /// Shows the window and begins to open what was asked for.
    void start();
    [[nodiscard]] MainWindow& window() const noexcept { return *window_; }
    [[nodiscard]] Simulator& simulator() noexcept { return simulator_; }
    [[nodiscard]] Settings& settings() noexcept { return settings_; }

  private:
    void makeWindow();
    void chooseLanguage(const QString& code);
    void chooseAppearance(Appearance appearance);
    /// By the command line, by the person's settings, by the school's; empty: the mouse.
    [[nodiscard]] QString firstDevice() const;
    void takeScreenshot();
    /// Nobody is there to answer a question.
    void endWithoutAsking(int code);
    void writeStats();

    QApplication& application_;
    CommandLine line_;
    bool realTime_;
    PictureStatistics picture_;
    double firstPictureMs_ = 0.0;
    exercise::SchoolDefaults school_;
    Settings settings_;
    Language language_;
    Simulator simulator_;
    std::unique_ptr<MainWindow> window_;
};

}  // namespace handpiece::desktop
