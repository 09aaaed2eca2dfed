// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The exercise in the window: its panel, the student's code, handing in, and looking at what was handed in.

#include <QString>
#include <functional>
#include <optional>

#include "desktop/framework/feature.h"
#include "desktop/work/live_zones.h"

class QDockWidget;
class QLabel;

namespace handpiece::desktop {

class ExercisePanel;

/// What it asks comes from the window, where tests put their own answers.
class ExerciseFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { code, handIn, exercise };
    enum class Choice { look, goOn, cancel };
    struct Questions {
        /// Of an attempt that was handed in.
        std::function<Choice(const QString& student)> lookOrGoOn;
        /// The student's code; none: cancelled. Empty: without one.
        std::function<std::optional<QString>(const QString& now)> student;
    };
    explicit ExerciseFeature(const FeatureContext& context);
    void showDocument() override;
    void showTick() override;

    Questions questions;

    /// Asks for the student's code where there is none yet; false: cancelled. Who gives none has none.
    [[nodiscard]] bool askCode();

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    void connectCommands();
    void showCode();
    void editCode();
    void takeCode(const QString& code);
    void handIn();
    /// An attempt that was handed in is asked about first: to look at it or to go on. False: it is no such.
    [[nodiscard]] bool open(const QString& path);

    CommandSet<Command> commands_;
    ExercisePanel* panel_;
    QDockWidget* dock_;
    QLabel* code_;
    bool isWanted_ = false;
    LiveZones live_{this};
    std::shared_ptr<const rubric::Rubric> rubric_;  ///< by which the live numbers are told; null: none are
};

}  // namespace handpiece::desktop
