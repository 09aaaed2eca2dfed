// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The commands of the window: a row each with its name for scripts, words, icon, key and places; a feature brings its
/// rows and says when a command can be given.

#include <QAction>
#include <QHash>
#include <QObject>
#include <QString>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "handpiece/app/exercise/permissions.h"

namespace handpiece::desktop {

/// The menus and bars that commands stand in.
enum class Shelf { none, file, edit, view, tools, sound, device, help, panels, theme, language, fileBar, toolBar };
/// A place in one: in the order of `at`; between two whose tens differ is a line.
struct Place {
    Shelf shelf = Shelf::none;
    int at = 0;
};

[[nodiscard]] constexpr Place in(Shelf shelf, int at) {
    return {shelf, at};
}
/// Under the icon in a bar, where the menu's text is too long.
struct Brief {
    const char* text;
};
[[nodiscard]] constexpr Brief brief(const char* text) {
    return {text};
}
struct Checkable {};
inline constexpr Checkable kCheckable;
/// Its place on the card of keys.
struct OnCard {
    int at;
};
[[nodiscard]] constexpr OnCard onCard(int at) {
    return {at};
}

/// All words are in the context "Commands".
struct CommandRow {
    const char *name, *text, *tip, *icon, *keys;
    std::array<Place, 2> places{};
    const char* briefText = nullptr;
    bool isCheckable = false;
    std::optional<exercise::Operation> operation{};  ///< that an exercise may lock
    int cardPlace = 0;                               ///< 0: it is not on the card

    constexpr void take(const Place& place) { places[places[0].shelf == Shelf::none ? 0 : 1] = place; }
    constexpr void take(const Brief& brief) { briefText = brief.text; }
    constexpr void take(const Checkable&) { isCheckable = true; }
    constexpr void take(exercise::Operation what) { operation = what; }
    constexpr void take(const OnCard& place) { cardPlace = place.at; }
};
/// A row with the id by which its feature knows it: name, text, tip, icon, key; then whatever else of the above it has.
template <class Id>
struct CommandOf {
    template <class... More>
    constexpr CommandOf(Id of, const char* name, const char* text, const char* tip, const char* icon, const char* keys,
                        const More&... more)
        : id(of), row{name, text, tip, icon, keys} {
        (row.take(more), ...);
    }
    Id id;
    CommandRow row;
};

/// The actions, made once for a window. Object names are "actionSave" and so on; docs/desktop-objects.md lists them.
class Commands : public QObject {
    Q_OBJECT
  public:
    explicit Commands(QWidget* window);
    QAction* add(const CommandRow& row);
    /// It can be given while `can`; always without such a line.
    void enableWhile(QAction* action, std::function<bool()> can);
    /// All of them by what they need and what the exercise allows; a locked one says so.
    void refresh(const exercise::Permissions& permissions);

    struct Placed {
        Place place;
        QAction* action;
    };
    /// An entry that is no command: a submenu ...
    void place(const Place& place, QAction* action) { placed_.push_back({place, action}); }
    /// ... or a widget on a bar.
    QAction* placeWidget(const Place& place, QWidget* widget);
    /// What stands there, in its order.
    [[nodiscard]] std::vector<Placed> on(Shelf shelf) const;
    /// Those of the card of keys, in its order.
    [[nodiscard]] std::vector<QAction*> onCard() const;
    [[nodiscard]] const QList<QAction*>& all() const noexcept { return ordered_; }

  private:
    struct Rule {
        std::function<bool()> can;
        std::optional<exercise::Operation> operation;
    };
    QWidget* window_;
    QList<QAction*> ordered_;
    QHash<QAction*, Rule> rules_;
    std::vector<Placed> placed_;
    std::vector<std::pair<int, QAction*>> card_;
};

/// A feature's own, by id.
template <class Id>
class CommandSet {
  public:
    CommandSet(Commands& commands, std::span<const CommandOf<Id>> rows) {
        for (const CommandOf<Id>& row : rows)
            actions_.insert(row.id, commands.add(row.row));
    }
    [[nodiscard]] QAction* operator[](Id id) const { return actions_[id]; }

  private:
    QHash<Id, QAction*> actions_;
};

}  // namespace handpiece::desktop
