// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The places and sizes of panels while the window has room for them.

#include <QByteArray>
#include <QMainWindow>

namespace handpiece::desktop {

/// A window that is made tiny squeezes its panels, and Qt leaves them so when it grows again, also after a restart.
/// Here they are kept as they were: that is what is remembered, and what comes back with the room.
class RoomyLayout : public QObject {
    Q_OBJECT
  public:
    RoomyLayout(QMainWindow* window, int version);
    /// What to remember.
    [[nodiscard]] QByteArray state() const;
    /// Out of what was remembered; empty: the window was arranged anew.
    void restore(const QByteArray& state);

  protected:
    bool eventFilter(QObject* of, QEvent* event) override;

  private:
    [[nodiscard]] bool hasRoom() const;
    void resized();

    QMainWindow* window_;
    int version_;
    bool hadRoom_ = true;
    QByteArray roomy_;
};

}  // namespace handpiece::desktop
