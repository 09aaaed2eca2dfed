// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The exercise in the window: its panel, handing in, and looking at what was handed in.

#include <QObject>
#include <functional>
#include <optional>

#include "shell/settings.h"
#include "shell/simulator.h"

class QDockWidget;
class QWidget;

namespace handpiece::desktop {

class Actions;
class ExercisePanel;

/// Wires a panel in its dock to the simulator; the commands are actionExercise and actionHandIn. What it asks comes
/// from the window, where tests put their own answers.
class ExerciseFeature : public QObject {
    Q_OBJECT
  public:
    enum class Choice { look, goOn, cancel };
    struct Questions {
        /// Of an attempt that was handed in.
        std::function<Choice(const QString& student)> lookOrGoOn;
        /// The student's code; none: cancelled. Empty: without one.
        std::function<std::optional<QString>(const QString& now)> student;
        std::function<QString(const QString& suggested)> fileToHandIn;
    };
    ExerciseFeature(Simulator& simulator, Settings& settings, const Actions& actions, ExercisePanel* panel,
                    QDockWidget* dock, QWidget* window);

    Questions questions;

    /// Opens a file: of an attempt that was handed in it is asked first whether to look at it or to go on.
    void open(const std::filesystem::path& path);
    /// The panel where the layout has put it: shown while there is something to read, until a person closes it.
    void placeDock();
    void showAllowed();

  signals:
    /// Another code was given.
    void codeChanged();

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    void showDocument();
    void handIn();

    Simulator& simulator_;
    Settings& settings_;
    const Actions& actions_;
    ExercisePanel* panel_;
    QDockWidget* dock_;
    bool isWanted_ = false;
};

}  // namespace handpiece::desktop
