// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/key_bindings_dialog.h"

#include <QApplication>
#include <QDialogButtonBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QMouseEvent>
#include <QPushButton>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <QWheelEvent>
#include <algorithm>

namespace handpiece::desktop {

namespace {

constexpr int kActionRole = Qt::UserRole;

QPushButton* push(const QString& text, const char* name, const QString& tip) {
    auto* button = new QPushButton(text);
    button->setObjectName(name);
    button->setAccessibleName(text);
    button->setToolTip(tip);
    button->setAutoDefault(false);
    return button;
}

}  // namespace

KeyBindingsDialog::KeyBindingsDialog(const KeyBindings& bindings, QWidget* parent)
    : QDialog(parent), bindings_(bindings) {
    setObjectName("keyBindingsDialog");
    setWindowTitle(tr("Keys and mouse"));
    auto* column = new QVBoxLayout(this);
    table_ = new QTreeWidget;
    table_->setObjectName("keyBindingsTable");
    table_->setAccessibleName(tr("Actions and their keys"));
    table_->setToolTip(tr("Choose a key, then press Change"));
    table_->setColumnCount(3);
    table_->setHeaderLabels({tr("Action"), tr("Key or button"), tr("Or")});
    table_->setAllColumnsShowFocus(false);
    table_->setSelectionBehavior(QAbstractItemView::SelectItems);
    table_->header()->setStretchLastSection(false);
    table_->header()->setSectionResizeMode(0, QHeaderView::Stretch);
    table_->header()->setSectionResizeMode(1, QHeaderView::ResizeToContents);
    table_->header()->setSectionResizeMode(2, QHeaderView::ResizeToContents);
    column->addWidget(table_);
    message_ = new QLabel;
    message_->setObjectName("keyBindingsMessage");
    message_->setWordWrap(true);
    message_->setMinimumHeight(2 * message_->fontMetrics().height());
    column->addWidget(message_);
    auto* row = new QHBoxLayout;
    change_ = push(tr("Change"), "keyBindingsChange", tr("Then press the new key or mouse button"));
    clear_ = push(tr("Clear"), "keyBindingsClear", tr("Leave this place without a key"));
    takeOver_ = push(tr("Take it over"), "keyBindingsTakeOver", tr("The other action loses this key"));
    takeOver_->hide();
    auto* right =
        push(tr("Right-handed"), "keyBindingsRightHanded", tr("As delivered, with the mouse in the right hand"));
    auto* left = push(tr("Left-handed"), "keyBindingsLeftHanded", tr("With the mouse in the left hand"));
    row->addWidget(change_);
    row->addWidget(clear_);
    row->addWidget(takeOver_);
    row->addStretch();
    row->addWidget(right);
    row->addWidget(left);
    column->addLayout(row);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
    buttons->setObjectName("keyBindingsButtons");
    column->addWidget(buttons);

    connect(change_, &QPushButton::clicked, this, &KeyBindingsDialog::listen);
    connect(table_, &QTreeWidget::itemDoubleClicked, this, &KeyBindingsDialog::listen);
    connect(clear_, &QPushButton::clicked, this, [this] {
        const QTreeWidgetItem* item = table_->currentItem();
        if (item && item->data(0, kActionRole).isValid())
            assign(static_cast<Action>(item->data(0, kActionRole).toInt()),
                   static_cast<std::size_t>(std::max(0, table_->currentColumn() - 1)), {});
    });
    connect(takeOver_, &QPushButton::clicked, this, &KeyBindingsDialog::takeOver);
    const auto choose = [this](KeyBindings::Set set) {
        bindings_ = KeyBindings::of(set);
        stopListening({});
        fill();
    };
    connect(right, &QPushButton::clicked, this, [choose] { choose(KeyBindings::Set::rightHanded); });
    connect(left, &QPushButton::clicked, this, [choose] { choose(KeyBindings::Set::leftHanded); });
    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    fill();
    resize(680, 600);
}

QTreeWidgetItem* KeyBindingsDialog::itemOf(Action action) const {
    for (int g = 0; g < table_->topLevelItemCount(); ++g)
        for (int i = 0; i < table_->topLevelItem(g)->childCount(); ++i)
            if (table_->topLevelItem(g)->child(i)->data(0, kActionRole).toInt() == static_cast<int>(action))
                return table_->topLevelItem(g)->child(i);
    return nullptr;
}

void KeyBindingsDialog::fill() {
    if (table_->topLevelItemCount() == 0) {
        using Group = ActionInfo::Group;
        for (const Group group : {Group::cutting, Group::hand, Group::eye, Group::tools}) {
            auto* head = new QTreeWidgetItem(table_, {groupText(group)});
            head->setFlags(Qt::ItemIsEnabled);
            head->setFirstColumnSpanned(true);
            QFont bold = font();
            bold.setBold(true);
            head->setFont(0, bold);
            for (const ActionInfo& info : actionInfos()) {
                if (info.group != group) continue;
                auto* item = new QTreeWidgetItem(head, {info.titleText()});
                item->setData(0, kActionRole, static_cast<int>(info.action));
            }
        }
        table_->expandAll();
    }
    for (const ActionInfo& info : actionInfos())
        for (std::size_t which = 0; which < KeyBindings::kMost; ++which)
            itemOf(info.action)->setText(static_cast<int>(which) + 1, bindings_.of(info.action)[which].text());
}

bool KeyBindingsDialog::assign(Action action, std::size_t which, const Binding& binding) {
    refused_.reset();
    takeOver_->hide();
    if (const auto user = bindings_.userOf(binding, action)) {
        refused_ = Wanted{action, which, binding};
        takeOver_->show();
        message_->setText(tr("%1 is already used for \"%2\".").arg(binding.text(), infoOf(*user).titleText()));
        return false;
    }
    if (!bindings_.set(action, which, binding)) {
        message_->setText(tr("\"%1\" cannot be done with %2.").arg(infoOf(action).titleText(), binding.text()));
        return false;
    }
    message_->clear();
    fill();
    return true;
}

void KeyBindingsDialog::takeOver() {
    if (!refused_) return;
    const Wanted wanted = *refused_;
    if (!bindings_.set(wanted.action, wanted.which, wanted.binding)) {
        refused_.reset();
        takeOver_->hide();
        message_->setText(
            tr("\"%1\" cannot be done with %2.").arg(infoOf(wanted.action).titleText(), wanted.binding.text()));
        return;
    }
    while (const auto user = bindings_.userOf(wanted.binding, wanted.action))
        for (std::size_t i = 0; i < KeyBindings::kMost; ++i)
            if (bindings_.of(*user)[i] == wanted.binding) bindings_.set(*user, i, {});
    assign(wanted.action, wanted.which, wanted.binding);
}

void KeyBindingsDialog::listen() {
    const QTreeWidgetItem* item = table_->currentItem();
    if (!item || !item->data(0, kActionRole).isValid() || listening_) return;
    listening_ = true;
    refused_.reset();
    takeOver_->hide();
    message_->setText(tr("Press the new key, mouse button or turn the wheel; %1 leaves it as it is.")
                          .arg(QKeySequence(Qt::Key_Escape).toString(QKeySequence::NativeText)));
    qApp->installEventFilter(this);
}

void KeyBindingsDialog::stopListening(const QString& message) {
    if (listening_) qApp->removeEventFilter(this);
    listening_ = false;
    message_->setText(message);
}

bool KeyBindingsDialog::eventFilter(QObject*, QEvent* event) {
    if (!listening_) return false;
    Binding binding;
    switch (event->type()) {
        case QEvent::ShortcutOverride:
            event->accept();
            return true;
        case QEvent::KeyRelease:
        case QEvent::MouseButtonRelease:
        case QEvent::MouseButtonDblClick:
            return true;
        case QEvent::KeyPress: {
            const auto* key = static_cast<QKeyEvent*>(event);
            const QTreeWidgetItem* item = table_->currentItem();
            const bool wantsModifier = item && infoOf(static_cast<Action>(item->data(0, kActionRole).toInt())).takes ==
                                                   ActionInfo::Takes::modifier;
            const bool modifier = key->key() == Qt::Key_Shift || key->key() == Qt::Key_Control;
            if ((modifier && !wantsModifier) || key->key() == Qt::Key_Alt || key->key() == Qt::Key_Meta) return true;
            if (key->key() == Qt::Key_Escape && key->modifiers() == Qt::NoModifier) {
                stopListening({});
                return true;
            }
            binding = bindingOf(*key);
            break;
        }
        case QEvent::MouseButtonPress: {
            const auto* mouse = static_cast<QMouseEvent*>(event);
            binding = {Binding::Kind::button, static_cast<int>(mouse->button()),
                       mouse->modifiers() & (Qt::ShiftModifier | Qt::ControlModifier)};
            break;
        }
        case QEvent::Wheel: {
            const auto* wheel = static_cast<QWheelEvent*>(event);
            binding = {Binding::Kind::wheel, 0, wheel->modifiers() & (Qt::ShiftModifier | Qt::ControlModifier)};
            break;
        }
        default:
            return false;
    }
    stopListening({});
    if (const QTreeWidgetItem* item = table_->currentItem())
        assign(static_cast<Action>(item->data(0, kActionRole).toInt()),
               static_cast<std::size_t>(std::max(0, table_->currentColumn() - 1)), binding);
    return true;
}

}  // namespace handpiece::desktop
