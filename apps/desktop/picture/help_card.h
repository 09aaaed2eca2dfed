// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The card that shows which key, button and wheel does what, as they are bound.

#include <QPointer>
#include <QWidget>
#include <utility>
#include <vector>

#include "desktop/picture/key_bindings.h"

namespace handpiece::desktop {

/// Lies over its parent, dims it, and goes away at a click or a key. Reads from left to right: what, then how.
class HelpCard : public QWidget {
    Q_OBJECT
  public:
    /// `after`: who has the keys when it goes.
    explicit HelpCard(QWidget* parent, QWidget* after = nullptr);
    void setBindings(const KeyBindings& bindings);
    [[nodiscard]] const KeyBindings& bindings() const { return bindings_; }
    /// Commands of the window that belong on the card, each with its shortcut ("Undo", "Ctrl+Z").
    using Commands = std::vector<std::pair<QString, QString>>;
    void setCommands(const Commands& commands);
    /// Where the card lies, and how large its letters are [pt]: it takes the columns in which they are largest.
    [[nodiscard]] QRectF cardArea() const;
    [[nodiscard]] double letterPt() const;

  protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;
    bool event(QEvent* event) override;

  private:
    struct Plan;
    [[nodiscard]] Plan plan() const;
    [[nodiscard]] QString description() const;

    KeyBindings bindings_;
    Commands commands_;
    QPointer<QWidget> after_;
};

}  // namespace handpiece::desktop
