// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Progress of long work, over the picture, with a button that ends it. Blocks nothing.

#include <QFrame>
#include <QTimer>

class QLabel;
class QProgressBar;
class QToolButton;

namespace handpiece::desktop {

/// [jobStrip]. Work shorter than kPatienceMs does not show.
class JobStrip : public QFrame {
    Q_OBJECT
  public:
    static constexpr int kPatienceMs = 400;
    explicit JobStrip(QWidget* parent = nullptr);
    void begin(const QString& title);
    /// What of it is being done.
    void setStep(const QString& step);
    void setFraction(double fraction);
    void end();

  signals:
    void cancelRequested();

  private:
    void showText();

    QLabel* title_;
    QString job_, step_;
    QProgressBar* bar_;
    QToolButton* cancel_;
    QTimer patience_;
};

}  // namespace handpiece::desktop
