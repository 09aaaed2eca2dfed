// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Hints for the first minute.

#include <QWidget>
#include <set>

class QLabel;
class QToolButton;

namespace handpiece::desktop {

/// Shows what to do next until it was done once [welcomeStrip], while it can be done. The window tells what was done
/// and keeps it.
class WelcomeStrip : public QWidget {
    Q_OBJECT
  public:
    enum class Step { hover, cut, orbit, zoom, undo };
    Q_ENUM(Step)

    explicit WelcomeStrip(QWidget* parent = nullptr);
    /// Steps done before, from the settings. Hides itself when all are.
    void setDone(const std::set<Step>& done);
    [[nodiscard]] const std::set<Step>& done() const { return done_; }
    /// Just done: goes on to the next hint.
    void markDone(Step step);
    /// With a device instead of the mouse the hints differ.
    void setPointerIsMouse(bool mouse);
    /// Nothing can be done before a tooth is there to be cut, and an exercise may want no hints: none until this says
    /// so.
    void setAllowed(bool allowed);
    /// All steps anew, from the first.
    void beginAgain();
    [[nodiscard]] QString text() const;

  signals:
    void doneChanged();
    void closed();

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    void showNext();

    std::set<Step> done_;
    bool mouse_ = true, allowed_ = false;
    QLabel *text_, *count_;
    QToolButton* close_;
};

}  // namespace handpiece::desktop
