// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Strips with messages over a picture: they come and go, and what they lie on stays where it is.

#include <QList>
#include <QObject>
#include <QRectF>
#include <vector>

class QWidget;

namespace handpiece::desktop {

/// Keeps widgets one below the other over a picture, in its middle, as wide as they need. A picture that gave way to
/// them would move the tooth under the hand.
class StripStack : public QObject {
    Q_OBJECT
  public:
    /// Below is for what stays: the crown that is worked on lies in the upper part of the picture. The corner is the
    /// upper right one: one at a time, as wide as it asks.
    enum class Where { above, below, corner };
    explicit StripStack(QWidget* picture);
    /// Becomes a child of the picture, under those that are there; while it is hidden the next one takes its place.
    void add(QWidget* strip, Where where = Where::above);
    /// Pixels that stay free above them.
    void setTop(int pixels);
    /// Where in the picture those that are shown lie.
    [[nodiscard]] std::vector<QRectF> covered() const;

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    void place();
    void placeBelow();
    void placeInCorner();

    QWidget* picture_;
    QList<QWidget*> strips_, below_, corner_;
    int top_ = 0;
};

}  // namespace handpiece::desktop
