// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The dialog in which keys, buttons and wheel are given their meaning.

#include <QDialog>

#include "desktop/picture/key_bindings.h"

class QLabel;
class QPushButton;
class QTreeWidget;
class QTreeWidgetItem;

namespace handpiece::desktop {

/// Shows every action with its bindings. Choose a cell, press "Change", then the key or mouse button itself. A key that
/// another action has is taken from it only after being asked. Nothing changes elsewhere before OK.
class KeyBindingsDialog : public QDialog {
    Q_OBJECT
  public:
    explicit KeyBindingsDialog(const KeyBindings& bindings, QWidget* parent = nullptr);
    [[nodiscard]] const KeyBindings& bindings() const { return bindings_; }

    /// Gives an action a binding, as if it had just been pressed. False when the action cannot take it, or another has
    /// it: then a message says who, and taking it over is offered.
    bool assign(Action action, std::size_t which, const Binding& binding);
    /// Takes the binding over that assign() refused.
    void takeOver();

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    void fill();
    void listen();
    void stopListening(const QString& message);
    [[nodiscard]] QTreeWidgetItem* itemOf(Action action) const;

    KeyBindings bindings_;
    QTreeWidget* table_ = nullptr;
    QLabel* message_ = nullptr;
    QPushButton *change_ = nullptr, *clear_ = nullptr, *takeOver_ = nullptr;
    bool listening_ = false;
    struct Wanted {
        Action action = Action::cut;
        std::size_t which = 0;
        Binding binding;
    };
    std::optional<Wanted> refused_;
};

}  // namespace handpiece::desktop
