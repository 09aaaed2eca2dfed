// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What every feature of the window is: made with a small context, it brings its docks, commands and words and connects
/// itself. It goes with the window.

#include <QObject>

#include "desktop/framework/main_window.h"

namespace handpiece::desktop {

class Simulator;

struct FeatureContext {
    MainWindow& window;
    Simulator& simulator;
    Settings& settings;
    bool realTime = true;  ///< threads of its own may ask for the tick's priority
};

class Feature : public QObject {
    Q_OBJECT
  public:
    explicit Feature(const FeatureContext& context)
        : QObject(&context.window),
          window_(context.window),
          view_(*context.window.view()),
          simulator_(context.simulator),
          settings_(context.settings) {}
    /// Another tooth, or none; once as well when all features are there and the layout is as it was.
    virtual void showDocument() {}
    /// About 30 times a second while a tooth is open.
    virtual void showTick() {}

  protected:
    template <class Does>
    void on(QAction* action, Does does) {
        connect(action, &QAction::triggered, this, does);
    }

    MainWindow& window_;
    ViewWidget& view_;
    Simulator& simulator_;
    Settings& settings_;
};

}  // namespace handpiece::desktop
