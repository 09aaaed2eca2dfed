// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/key_bindings.h"

#include <QKeySequence>
#include <QStringList>
#include <algorithm>

namespace handpiece::desktop {

namespace {

using Group = ActionInfo::Group;
using Takes = ActionInfo::Takes;
constexpr Qt::KeyboardModifiers kUsed = Qt::ShiftModifier | Qt::ControlModifier;

struct Texts {
    Q_DECLARE_TR_FUNCTIONS(KeyBindings)
};

Binding key(int code, Qt::KeyboardModifiers modifiers = {}) {
    return {Binding::Kind::key, code, modifiers};
}
Binding button(Qt::MouseButton code, Qt::KeyboardModifiers modifiers = {}) {
    return {Binding::Kind::button, static_cast<int>(code), modifiers};
}
Binding wheel(Qt::KeyboardModifiers modifiers = {}) {
    return {Binding::Kind::wheel, 0, modifiers};
}

struct ButtonName {
    Qt::MouseButton button;
    const char* id;
    const char* text;
};
constexpr std::array<ButtonName, 5> kButtons = {{
    {Qt::LeftButton, "left", QT_TRANSLATE_NOOP("KeyBindings", "left button")},
    {Qt::RightButton, "right", QT_TRANSLATE_NOOP("KeyBindings", "right button")},
    {Qt::MiddleButton, "middle", QT_TRANSLATE_NOOP("KeyBindings", "middle button")},
    {Qt::BackButton, "back", QT_TRANSLATE_NOOP("KeyBindings", "back button")},
    {Qt::ForwardButton, "forward", QT_TRANSLATE_NOOP("KeyBindings", "forward button")},
}};

bool isModifierKey(int code) {
    return code == Qt::Key_Shift || code == Qt::Key_Control;
}

bool takes(const ActionInfo& info, const Binding& binding) {
    if (binding.kind == Binding::Kind::none) return true;
    if (binding.modifiers & ~kUsed) return false;
    switch (info.takes) {
        case Takes::keys:
            return binding.kind == Binding::Kind::key && binding.code != 0 && !isModifierKey(binding.code) &&
                   binding.code != Qt::Key_Alt && binding.code != Qt::Key_AltGr && binding.code != Qt::Key_Meta;
        case Takes::buttons:
            return binding.kind == Binding::Kind::button && binding.code != 0;
        case Takes::wheel:
            return binding.kind == Binding::Kind::wheel;
        case Takes::modifier:
            return binding.kind == Binding::Kind::key && isModifierKey(binding.code) && !binding.modifiers;
    }
    return false;
}

}  // namespace

const std::vector<ActionInfo>& actionInfos() {
    static const std::vector<ActionInfo> infos = {
        {Action::cut, "cut", QT_TRANSLATE_NOOP("KeyBindings", "Cut: pedal down, press and drag"), Group::cutting,
         Takes::buttons},
        {Action::touch, "touch", QT_TRANSLATE_NOOP("KeyBindings", "Touch with the bur still"), Group::cutting,
         Takes::buttons},
        {Action::orbit, "orbit", QT_TRANSLATE_NOOP("KeyBindings", "Turn the view"), Group::eye, Takes::buttons},
        {Action::pan, "pan", QT_TRANSLATE_NOOP("KeyBindings", "Shift the view"), Group::eye, Takes::buttons},
        {Action::zoom, "zoom", QT_TRANSLATE_NOOP("KeyBindings", "Nearer, farther"), Group::eye, Takes::wheel},
        {Action::load, "load", QT_TRANSLATE_NOOP("KeyBindings", "Load on the bur"), Group::cutting, Takes::wheel},
        {Action::stop, "stop", QT_TRANSLATE_NOOP("KeyBindings", "Depth stop"), Group::cutting, Takes::wheel},
        {Action::pass, "pass", QT_TRANSLATE_NOOP("KeyBindings", "Depth of one pass"), Group::cutting, Takes::wheel},
        {Action::slow, "slow", QT_TRANSLATE_NOOP("KeyBindings", "Five times slower, finer steps"), Group::hand,
         Takes::modifier},
        {Action::orbitHold, "orbit-hold", QT_TRANSLATE_NOOP("KeyBindings", "Hold, move or arrows: turn the view"),
         Group::eye, Takes::keys},
        {Action::panHold, "pan-hold", QT_TRANSLATE_NOOP("KeyBindings", "Hold, move or arrows: shift the view"),
         Group::eye, Takes::keys},
        {Action::pivot, "pivot", QT_TRANSLATE_NOOP("KeyBindings", "Hold, move or arrows: tilt about the tip"),
         Group::hand, Takes::keys},
        {Action::nearer, "nearer", QT_TRANSLATE_NOOP("KeyBindings", "Nearer"), Group::eye, Takes::keys, true},
        {Action::farther, "farther", QT_TRANSLATE_NOOP("KeyBindings", "Farther"), Group::eye, Takes::keys, true},
        {Action::rollLeft, "roll-left", QT_TRANSLATE_NOOP("KeyBindings", "Roll to the left"), Group::hand, Takes::keys,
         true},
        {Action::rollRight, "roll-right", QT_TRANSLATE_NOOP("KeyBindings", "Roll to the right"), Group::hand,
         Takes::keys, true},
        {Action::alignNormal, "align-normal", QT_TRANSLATE_NOOP("KeyBindings", "Bur square to the surface"),
         Group::hand, Takes::keys},
        {Action::alignTooth, "align-tooth", QT_TRANSLATE_NOOP("KeyBindings", "Bur along the tooth's long axis"),
         Group::hand, Takes::keys},
        {Action::moveLeft, "move-left", QT_TRANSLATE_NOOP("KeyBindings", "Bur to the left"), Group::hand, Takes::keys,
         true},
        {Action::moveRight, "move-right", QT_TRANSLATE_NOOP("KeyBindings", "Bur to the right"), Group::hand,
         Takes::keys, true},
        {Action::moveUp, "move-up", QT_TRANSLATE_NOOP("KeyBindings", "Bur up"), Group::hand, Takes::keys, true},
        {Action::moveDown, "move-down", QT_TRANSLATE_NOOP("KeyBindings", "Bur down"), Group::hand, Takes::keys, true},
        {Action::advance, "advance", QT_TRANSLATE_NOOP("KeyBindings", "Bur in along its axis"), Group::hand,
         Takes::keys, true},
        {Action::retreat, "retreat", QT_TRANSLATE_NOOP("KeyBindings", "Bur out along its axis"), Group::hand,
         Takes::keys, true},
        {Action::cutKey, "cut-key", QT_TRANSLATE_NOOP("KeyBindings", "Hold: cut where the bur is; or pick"),
         Group::cutting, Takes::keys},
        {Action::touchKey, "touch-key", QT_TRANSLATE_NOOP("KeyBindings", "Hold: touch where the bur is"),
         Group::cutting, Takes::keys},
        {Action::moreLoad, "more-load", QT_TRANSLATE_NOOP("KeyBindings", "More load"), Group::cutting, Takes::keys},
        {Action::lessLoad, "less-load", QT_TRANSLATE_NOOP("KeyBindings", "Less load"), Group::cutting, Takes::keys},
        {Action::deeperStop, "deeper-stop", QT_TRANSLATE_NOOP("KeyBindings", "Depth stop on, deeper"), Group::cutting,
         Takes::keys},
        {Action::shallowerStop, "shallower-stop", QT_TRANSLATE_NOOP("KeyBindings", "Depth stop shallower, off"),
         Group::cutting, Takes::keys},
        {Action::deeperPass, "deeper-pass", QT_TRANSLATE_NOOP("KeyBindings", "One pass deeper, off"), Group::cutting,
         Takes::keys},
        {Action::shallowerPass, "shallower-pass", QT_TRANSLATE_NOOP("KeyBindings", "One pass on, shallower"),
         Group::cutting, Takes::keys},
        {Action::latchPedal, "latch-pedal", QT_TRANSLATE_NOOP("KeyBindings", "Pedal stays down"), Group::cutting,
         Takes::keys},
        {Action::faster, "faster", QT_TRANSLATE_NOOP("KeyBindings", "More speed"), Group::cutting, Takes::keys},
        {Action::slower, "slower", QT_TRANSLATE_NOOP("KeyBindings", "Less speed"), Group::cutting, Takes::keys},
        {Action::previousBur, "previous-bur", QT_TRANSLATE_NOOP("KeyBindings", "Previous bur"), Group::cutting,
         Takes::keys},
        {Action::nextBur, "next-bur", QT_TRANSLATE_NOOP("KeyBindings", "Next bur"), Group::cutting, Takes::keys},
        {Action::viewOcclusal, "view-occlusal", QT_TRANSLATE_NOOP("KeyBindings", "Occlusal"), Group::eye, Takes::keys},
        {Action::viewBuccal, "view-buccal", QT_TRANSLATE_NOOP("KeyBindings", "Buccal"), Group::eye, Takes::keys},
        {Action::viewLingual, "view-lingual", QT_TRANSLATE_NOOP("KeyBindings", "Lingual"), Group::eye, Takes::keys},
        {Action::viewMesial, "view-mesial", QT_TRANSLATE_NOOP("KeyBindings", "Mesial"), Group::eye, Takes::keys},
        {Action::viewDistal, "view-distal", QT_TRANSLATE_NOOP("KeyBindings", "Distal"), Group::eye, Takes::keys},
        {Action::viewOblique, "view-oblique", QT_TRANSLATE_NOOP("KeyBindings", "Oblique"), Group::eye, Takes::keys},
        {Action::fit, "fit", QT_TRANSLATE_NOOP("KeyBindings", "Whole tooth"), Group::eye, Takes::keys},
        {Action::goToBur, "go-to-bur", QT_TRANSLATE_NOOP("KeyBindings", "Go to the bur"), Group::eye, Takes::keys},
        {Action::measure, "measure", QT_TRANSLATE_NOOP("KeyBindings", "Distance, depth, pulp in turn"), Group::tools,
         Takes::keys},
        {Action::section, "section", QT_TRANSLATE_NOOP("KeyBindings", "Section"), Group::tools, Takes::keys},
        {Action::mirror, "mirror", QT_TRANSLATE_NOOP("KeyBindings", "Mouth mirror"), Group::tools, Takes::keys},
        {Action::compare, "compare", QT_TRANSLATE_NOOP("KeyBindings", "Before and after"), Group::tools, Takes::keys},
        {Action::escape, "escape", QT_TRANSLATE_NOOP("KeyBindings", "Stop: pedal up, bur lifts"), Group::cutting,
         Takes::keys},
        {Action::help, "help", QT_TRANSLATE_NOOP("KeyBindings", "This card"), Group::tools, Takes::keys},
    };
    return infos;
}

const ActionInfo& infoOf(Action action) {
    return actionInfos()[static_cast<std::size_t>(action)];
}

QString groupText(ActionInfo::Group group) {
    switch (group) {
        case Group::cutting:
            return Texts::tr("Cutting");
        case Group::hand:
            return Texts::tr("The hand");
        case Group::eye:
            return Texts::tr("The view");
        case Group::tools:
            return Texts::tr("Tools");
    }
    return {};
}

QString Binding::text() const {
    if (kind == Kind::none) return {};
    QStringList parts;
    if (modifiers & Qt::ControlModifier) parts << Texts::tr("Ctrl");
    if (modifiers & Qt::ShiftModifier) parts << Texts::tr("Shift");
    if (kind == Kind::wheel) parts << Texts::tr("wheel");
    if (kind == Kind::button)
        for (const ButtonName& name : kButtons)
            if (static_cast<int>(name.button) == code) parts << Texts::tr(name.text);
    if (kind == Kind::key) {
        if (code == Qt::Key_Shift)
            parts << Texts::tr("Shift");
        else if (code == Qt::Key_Control)
            parts << Texts::tr("Ctrl");
        else
            parts << QKeySequence(code).toString(QKeySequence::NativeText);
    }
    return parts.join(" + ");
}

QString Binding::id() const {
    QString text;
    if (modifiers & Qt::ControlModifier) text += "Ctrl+";
    if (modifiers & Qt::ShiftModifier) text += "Shift+";
    switch (kind) {
        case Kind::none:
            return "none";
        case Kind::wheel:
            return text + "wheel";
        case Kind::key:
            if (code == Qt::Key_Shift) return "key:Shift";
            if (code == Qt::Key_Control) return "key:Control";
            return text + "key:" + QKeySequence(code).toString(QKeySequence::PortableText);
        case Kind::button:
            for (const ButtonName& name : kButtons)
                if (static_cast<int>(name.button) == code) return text + "button:" + name.id;
            break;
    }
    return "none";
}

std::optional<Binding> Binding::fromId(const QString& id) {
    if (id == "none") return Binding{};
    Binding binding;
    QString rest = id;
    if (rest.startsWith("Ctrl+")) {
        binding.modifiers |= Qt::ControlModifier;
        rest = rest.mid(5);
    }
    if (rest.startsWith("Shift+")) {
        binding.modifiers |= Qt::ShiftModifier;
        rest = rest.mid(6);
    }
    if (rest == "wheel") {
        binding.kind = Kind::wheel;
        return binding;
    }
    if (rest.startsWith("button:")) {
        for (const ButtonName& name : kButtons)
            if (rest.mid(7) == name.id) {
                binding.kind = Kind::button;
                binding.code = static_cast<int>(name.button);
                return binding;
            }
        return std::nullopt;
    }
    if (!rest.startsWith("key:")) return std::nullopt;
    binding.kind = Kind::key;
    const QString name = rest.mid(4);
    if (name == "Shift" || name == "Control") {
        if (binding.modifiers) return std::nullopt;
        binding.code = name == "Shift" ? Qt::Key_Shift : Qt::Key_Control;
        return binding;
    }
    const QKeySequence sequence = QKeySequence::fromString(name, QKeySequence::PortableText);
    if (sequence.count() != 1 || sequence[0].keyboardModifiers() || sequence[0].key() == Qt::Key_unknown)
        return std::nullopt;
    binding.code = sequence[0].key();
    return binding;
}

Binding bindingOf(const QKeyEvent& event) {
    Binding binding = key(event.key(), event.modifiers() & kUsed);
    if (isModifierKey(binding.code)) binding.modifiers = {};
    const bool letter = binding.code >= Qt::Key_A && binding.code <= Qt::Key_Z;
    const bool digit = binding.code >= Qt::Key_0 && binding.code <= Qt::Key_9;
    // Shift types signs on some keyboards and not on others: it is no part of them.
    if (binding.code > Qt::Key_Space && binding.code < Qt::Key_Escape && !letter && !digit)
        binding.modifiers &= ~Qt::KeyboardModifiers(Qt::ShiftModifier);
    return binding;
}

KeyBindings::KeyBindings() {
    *this = of(Set::rightHanded);
}

KeyBindings KeyBindings::of(Set set) {
    const bool left = set == Set::leftHanded;
    const Qt::MouseButton mine = left ? Qt::RightButton : Qt::LeftButton;
    const Qt::MouseButton other = left ? Qt::LeftButton : Qt::RightButton;
    // The free hand rests on the other half of the keyboard.
    const auto pick = [left](Qt::Key rightHanded, Qt::Key leftHanded) { return key(left ? leftHanded : rightHanded); };
    using A = Action;
    const std::vector<std::pair<Action, std::array<Binding, kMost>>> rows = {
        {A::cut, {button(mine)}},
        {A::touch, {button(mine, Qt::ControlModifier)}},
        {A::orbit, {button(other)}},
        {A::pan, {button(Qt::MiddleButton), button(other, Qt::ShiftModifier)}},
        {A::zoom, {wheel()}},
        {A::load, {wheel(Qt::ShiftModifier)}},
        {A::stop, {wheel(Qt::ControlModifier)}},
        {A::pass, {wheel(Qt::ControlModifier | Qt::ShiftModifier)}},
        {A::slow, {key(Qt::Key_Shift)}},
        {A::orbitHold, {key(Qt::Key_Space)}},
        {A::panHold, {key(Qt::Key_Space, Qt::ShiftModifier)}},
        {A::pivot, {pick(Qt::Key_T, Qt::Key_Y)}},
        {A::nearer, {key(Qt::Key_Plus, Qt::ControlModifier), key(Qt::Key_Equal, Qt::ControlModifier)}},
        {A::farther, {key(Qt::Key_Minus, Qt::ControlModifier)}},
        {A::rollLeft, {pick(Qt::Key_Q, Qt::Key_I)}},
        {A::rollRight, {pick(Qt::Key_E, Qt::Key_O)}},
        {A::alignNormal, {pick(Qt::Key_N, Qt::Key_J)}},
        {A::alignTooth, {pick(Qt::Key_R, Qt::Key_U)}},
        {A::moveLeft, {key(Qt::Key_Left)}},
        {A::moveRight, {key(Qt::Key_Right)}},
        {A::moveUp, {key(Qt::Key_Up)}},
        {A::moveDown, {key(Qt::Key_Down)}},
        {A::advance, {key(Qt::Key_PageDown)}},
        {A::retreat, {key(Qt::Key_PageUp)}},
        {A::cutKey, {key(Qt::Key_Return), key(Qt::Key_Enter)}},
        {A::touchKey, {key(Qt::Key_Return, Qt::ControlModifier), key(Qt::Key_Enter, Qt::ControlModifier)}},
        {A::moreLoad, {key(Qt::Key_W)}},
        {A::lessLoad, {key(Qt::Key_S)}},
        {A::deeperStop, {key(Qt::Key_V)}},
        {A::shallowerStop, {key(Qt::Key_G)}},
        {A::deeperPass, {key(Qt::Key_BracketRight)}},
        {A::shallowerPass, {key(Qt::Key_BracketLeft)}},
        {A::latchPedal, {key(Qt::Key_P)}},
        {A::faster, {key(Qt::Key_Plus), key(Qt::Key_Equal)}},
        {A::slower, {key(Qt::Key_Minus)}},
        {A::previousBur, {key(Qt::Key_Comma)}},
        {A::nextBur, {key(Qt::Key_Period)}},
        {A::viewOcclusal, {key(Qt::Key_1)}},
        {A::viewBuccal, {key(Qt::Key_2)}},
        {A::viewLingual, {key(Qt::Key_3)}},
        {A::viewMesial, {key(Qt::Key_4)}},
        {A::viewDistal, {key(Qt::Key_5)}},
        {A::viewOblique, {key(Qt::Key_6)}},
        {A::fit, {key(Qt::Key_Home)}},
        {A::goToBur, {pick(Qt::Key_F, Qt::Key_H)}},
        {A::measure, {pick(Qt::Key_D, Qt::Key_K)}},
        {A::section, {pick(Qt::Key_X, Qt::Key_L)}},
        {A::mirror, {key(Qt::Key_M)}},
        {A::compare, {pick(Qt::Key_C, Qt::Key_B)}},
        {A::escape, {key(Qt::Key_Escape)}},
        {A::help, {key(Qt::Key_F1)}},
    };
    KeyBindings bindings{Empty{}};
    for (const auto& [action, row] : rows)
        bindings.table_[static_cast<std::size_t>(action)] = row;
    return bindings;
}

const std::array<Binding, KeyBindings::kMost>& KeyBindings::of(Action action) const {
    return table_[static_cast<std::size_t>(action)];
}

bool KeyBindings::set(Action action, std::size_t which, const Binding& binding) {
    if (which >= kMost || !takes(infoOf(action), binding)) return false;
    table_[static_cast<std::size_t>(action)][which] = binding;
    return true;
}

std::optional<Action> KeyBindings::userOf(const Binding& binding, Action except) const {
    if (binding.kind == Binding::Kind::none) return std::nullopt;
    for (const ActionInfo& info : actionInfos()) {
        if (info.action == except) continue;
        const auto& row = of(info.action);
        if (std::find(row.begin(), row.end(), binding) != row.end()) return info.action;
    }
    return std::nullopt;
}

std::vector<KeyBindings::Conflict> KeyBindings::conflicts() const {
    std::vector<Conflict> found;
    for (const ActionInfo& info : actionInfos())
        for (const Binding& binding : of(info.action)) {
            const auto user = userOf(binding, info.action);
            if (user && *user > info.action) found.push_back({info.action, *user, binding});
        }
    return found;
}

std::optional<Action> KeyBindings::actionFor(const Binding& binding) const {
    if (binding.kind == Binding::Kind::none) return std::nullopt;
    Binding plain = binding;
    const Binding& slow = of(Action::slow)[0];
    if (slow.kind == Binding::Kind::key)
        plain.modifiers &= ~Qt::KeyboardModifiers(slow.code == Qt::Key_Shift ? Qt::ShiftModifier : Qt::ControlModifier);
    std::optional<Action> fine;
    for (const ActionInfo& info : actionInfos()) {
        if (info.takes == Takes::modifier) continue;
        for (const Binding& mine : of(info.action)) {
            if (mine == binding) return info.action;
            if (mine == plain && (info.fineWithSlow || info.action == Action::cut)) fine = info.action;
        }
    }
    return fine;
}

bool KeyBindings::isSlow(Qt::KeyboardModifiers modifiers) const {
    for (const Binding& binding : of(Action::slow)) {
        if (binding.kind != Binding::Kind::key) continue;
        if (modifiers & (binding.code == Qt::Key_Shift ? Qt::ShiftModifier : Qt::ControlModifier)) return true;
    }
    return false;
}

QString KeyBindings::text(Action action) const {
    return of(action)[0].text();
}

QVariantMap KeyBindings::toMap() const {
    QVariantMap map;
    for (const ActionInfo& info : actionInfos()) {
        QStringList ids;
        for (const Binding& binding : of(info.action))
            if (binding.kind != Binding::Kind::none) ids << binding.id();
        map.insert(info.name, ids);
    }
    return map;
}

void KeyBindings::giveWayTo(const QVariantMap& map) {
    QStringList chosen;
    for (const QVariant& ids : map)
        chosen << ids.toStringList();
    for (const ActionInfo& info : actionInfos()) {
        if (map.contains(info.name)) continue;
        for (Binding& binding : table_[static_cast<std::size_t>(info.action)])
            if (chosen.contains(binding.id())) binding = {};
    }
}

QStringList KeyBindings::fromMap(const QVariantMap& map) {
    QStringList refused;
    KeyBindings next = *this;
    for (auto entry = map.cbegin(); entry != map.cend(); ++entry) {
        const auto info = std::find_if(actionInfos().begin(), actionInfos().end(),
                                       [&](const ActionInfo& one) { return entry.key() == one.name; });
        const QStringList ids = entry.value().toStringList();
        bool good = info != actionInfos().end() && ids.size() <= static_cast<int>(kMost);
        std::array<Binding, kMost> row{};
        for (int i = 0; good && i < ids.size(); ++i) {
            const auto binding = Binding::fromId(ids[i]);
            good = binding && takes(*info, *binding);
            if (good) row[static_cast<std::size_t>(i)] = *binding;
        }
        if (good)
            next.table_[static_cast<std::size_t>(info->action)] = row;
        else
            refused << entry.key();
    }
    for (const Conflict& conflict : next.conflicts()) {
        refused << infoOf(conflict.first).name << infoOf(conflict.second).name;
    }
    if (next.conflicts().empty()) *this = next;
    return refused;
}

}  // namespace handpiece::desktop
