// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which key, button or wheel does what in the picture. A table that can be changed, kept and checked for conflicts.

#include <QCoreApplication>
#include <QKeyEvent>
#include <QString>
#include <QStringList>
#include <QVariantMap>
#include <array>
#include <optional>
#include <vector>

namespace handpiece::desktop {

enum class Action {
    cut,
    touch,
    orbit,
    pan,
    zoom,
    load,
    stop,
    pass,
    slow,  // buttons, wheel, modifier
    orbitHold,
    panHold,
    pivot,  // keys held while the pointer moves, or the arrows are pressed
    nearer,
    farther,
    rollLeft,
    rollRight,
    alignNormal,
    alignTooth,
    moveLeft,
    moveRight,
    moveUp,
    moveDown,
    advance,
    retreat,
    cutKey,
    touchKey,
    moreLoad,
    lessLoad,
    deeperStop,
    shallowerStop,
    deeperPass,
    shallowerPass,
    latchPedal,
    faster,
    slower,
    previousBur,
    nextBur,
    viewOcclusal,
    viewBuccal,
    viewLingual,
    viewMesial,
    viewDistal,
    viewOblique,
    fit,
    goToBur,
    measure,
    section,
    mirror,
    compare,
    escape,
    help,
};
inline constexpr std::size_t kActionCount = static_cast<std::size_t>(Action::help) + 1;

/// One key, mouse button or the wheel, with Shift, Ctrl or both. Alt belongs to the window manager.
struct Binding {
    enum class Kind { none, key, button, wheel };
    Kind kind = Kind::none;
    int code = 0;  ///< Qt::Key or Qt::MouseButton; 0 for the wheel
    Qt::KeyboardModifiers modifiers;

    [[nodiscard]] QString text() const;  ///< "Ctrl + left button", translated
    [[nodiscard]] QString id() const;    ///< "Ctrl+button:left", for settings
    /// Nothing for text that id() does not give.
    [[nodiscard]] static std::optional<Binding> fromId(const QString& id);
    friend bool operator==(const Binding&, const Binding&) = default;
};
/// What was pressed, without the keypad's mark, and without the Shift that a sign needed to be typed.
[[nodiscard]] Binding bindingOf(const QKeyEvent& event);

/// An action as the dialog and the card show it.
struct ActionInfo {
    Action action;
    const char* name;   ///< for settings: "cut"
    const char* title;  ///< untranslated, context "KeyBindings"
    enum class Group { cutting, hand, eye, tools } group;
    enum class Takes { keys, buttons, wheel, modifier } takes;
    bool fineWithSlow = false;  ///< the slow modifier beside it makes the step fine
    [[nodiscard]] QString titleText() const { return QCoreApplication::translate("KeyBindings", title); }
};
[[nodiscard]] const std::vector<ActionInfo>& actionInfos();
[[nodiscard]] const ActionInfo& infoOf(Action action);
[[nodiscard]] QString groupText(ActionInfo::Group group);

/// The table. Every action has up to two bindings.
class KeyBindings {
  public:
    enum class Set { rightHanded, leftHanded };
    /// The default, with the mouse in the right hand.
    KeyBindings();
    [[nodiscard]] static KeyBindings of(Set set);

    static constexpr std::size_t kMost = 2;
    [[nodiscard]] const std::array<Binding, kMost>& of(Action action) const;
    /// Refused (false, nothing changes) when the action cannot take that kind.
    bool set(Action action, std::size_t which, const Binding& binding);
    /// The other action that has it; none when it is free.
    [[nodiscard]] std::optional<Action> userOf(const Binding& binding, Action except) const;
    struct Conflict {
        Action first, second;
        Binding binding;
    };
    [[nodiscard]] std::vector<Conflict> conflicts() const;

    /// What an event means; none when nothing does. With the slow modifier beside it, a fine step or a slow cut.
    [[nodiscard]] std::optional<Action> actionFor(const Binding& binding) const;
    [[nodiscard]] bool isSlow(Qt::KeyboardModifiers modifiers) const;
    /// "Ctrl + left button" of the first binding, empty without one.
    [[nodiscard]] QString text(Action action) const;

    /// For settings: action name -> list of binding ids. What a map does not name stays as it was; entries that cannot
    /// be read, and maps that would leave two actions on one key, are refused: their names come back.
    [[nodiscard]] QVariantMap toMap() const;
    QStringList fromMap(const QVariantMap& map);
    /// Settings of an older program know nothing of newer actions: their keys give way to what a person has chosen.
    void giveWayTo(const QVariantMap& map);

    friend bool operator==(const KeyBindings&, const KeyBindings&) = default;

  private:
    struct Empty {};
    explicit KeyBindings(Empty) {}
    std::array<std::array<Binding, kMost>, kActionCount> table_{};
};

}  // namespace handpiece::desktop
