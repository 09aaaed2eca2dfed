// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/files/recovery_feature.h"

#include <QDialog>
#include <QDialogButtonBox>
#include <QFileInfo>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QPushButton>
#include <QVBoxLayout>

#include "desktop/widgets/notation.h"
#include "desktop/work/simulator.h"
#include "desktop/work/this_language.h"
#include "handpiece/base/core/error.h"

namespace handpiece::desktop {
namespace {

using Command = RecoveryFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::recover, "actionRecover", QT_TRANSLATE_NOOP("Commands", "Recover..."),
     QT_TRANSLATE_NOOP("Commands", "Bring back, or give up, work that ended without saving"), "recent", "Ctrl+Shift+R",
     in(Shelf::file, 7), exercise::Operation::elsewhere},
};

/// Empty: it is no exercise, or one that cannot be read, which is told when the work is brought back.
QString exerciseTitle(const SessionNote& note) {
    if (note.exercise.isEmpty()) return {};
    try {
        return inThisLanguage(cases::parseExercise(note.exercise.toStdString(), note.title.toStdString()).title);
    } catch (const core::Error&) {
        return {};
    }
}

QString titleOf(const SessionNote& note) {
    if (!note.attemptFile.isEmpty()) return note.title;
    if (const QString exercise = exerciseTitle(note); !exercise.isEmpty()) return exercise;
    return note.starter ? toothName(note.starter->fdi) : note.title;
}

}  // namespace

RecoveryFeature::RecoveryFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands) {
    on(commands_[Command::recover], [this] { choose(); });
    window_.commands().enableWhile(commands_[Command::recover], [this] { return !simulator_.isBusy(); });
    connect(&window_, &MainWindow::greet, this, &RecoveryFeature::greet);
    connect(&window_.notices(), &Notices::remedyChosen, this, [this](Notice notice) {
        const bool isOffered = notice == Notice::crashed || notice == Notice::crashedNoRoom;
        if (isOffered && !crashed_.empty()) recover(crashed_.front());
    });
}

void RecoveryFeature::greet() {
    Notices& notices = window_.notices();
    if (!settings_.setAside().isEmpty()) notices.tell(Notice::settingsBroken, {settings_.setAside()});
    crashed_ = simulator_.crashed();
    if (crashed_.empty() || !hasRoomFor(crashed_.front())) return;
    notices.tell(Notice::crashed, {titleOf(crashed_.front().note)});
}

/// Brought back, work goes on in its recording: without room for that it would be lost with the next crash.
bool RecoveryFeature::hasRoomFor(const Crashed& crashed) {
    const SessionShelf& shelf = simulator_.shelf();
    window_.notices().remove(Notice::crashedNoRoom);
    if (shelf.hasRoom()) return true;
    const auto megabytes = [](std::uint64_t bytes) { return QLocale().toString(qulonglong{bytes >> 20}); };
    window_.notices().tell(Notice::crashedNoRoom, {titleOf(crashed.note), megabytes(shelf.roomBytes()),
                                                   toQString(shelf.folder()), megabytes(shelf.freeBytes())});
    return false;
}

void RecoveryFeature::recover(const Crashed& crashed) {
    if (!hasRoomFor(crashed)) return;
    window_.whenMayLeave([this, crashed] { simulator_.recover(crashed); });
}

void RecoveryFeature::choose() {
    crashed_ = simulator_.crashed();
    auto* dialog = new QDialog(&window_);
    dialog->setObjectName(QStringLiteral("recoverDialog"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Work that ended without saving"));
    auto* column = new QVBoxLayout(dialog);
    auto* text = new QLabel(crashed_.empty() ? tr("There is none: everything was saved or given up.")
                                             : tr("Choose what to bring back:"));
    column->addWidget(text);
    auto* list = new QListWidget;
    list->setObjectName(QStringLiteral("recoverList"));
    list->setAccessibleName(tr("Work that ended without saving"));
    list->setToolTip(tr("The newest first"));
    for (const Crashed& crashed : crashed_)
        list->addItem(tr("%1, %2").arg(
            titleOf(crashed.note),
            QLocale().toString(QFileInfo(toQString(crashed.session)).lastModified(), QLocale::ShortFormat)));
    list->setCurrentRow(0);
    list->setVisible(!crashed_.empty());
    column->addWidget(list);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    auto* back = buttons->addButton(tr("Bring it back"), QDialogButtonBox::AcceptRole);
    back->setObjectName(QStringLiteral("recoverBack"));
    back->setToolTip(tr("Open the tooth as it was when the program ended"));
    auto* forget = buttons->addButton(tr("Give it up"), QDialogButtonBox::DestructiveRole);
    forget->setObjectName(QStringLiteral("recoverForget"));
    forget->setToolTip(tr("It is not offered again; its recording stays for a while"));
    for (QPushButton* button : {back, forget})
        button->setEnabled(!crashed_.empty());
    column->addWidget(buttons);
    const auto chosen = [this, list]() -> std::optional<Crashed> {
        const auto row = static_cast<std::size_t>(list->currentRow());
        return row < crashed_.size() ? std::optional(crashed_[row]) : std::nullopt;
    };
    connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    connect(buttons, &QDialogButtonBox::accepted, dialog, [this, dialog, chosen] {
        const std::optional<Crashed> one = chosen();
        dialog->accept();
        window_.notices().takeBack(End::crashSettled);
        if (one) recover(*one);
    });
    connect(forget, &QPushButton::clicked, dialog, [this, list, chosen, back, forget] {
        const std::optional<Crashed> one = chosen();
        if (!one) return;
        simulator_.forget(*one);
        crashed_.erase(crashed_.begin() + list->currentRow());
        delete list->takeItem(list->currentRow());
        window_.notices().takeBack(End::crashSettled);
        for (QPushButton* button : {back, forget})
            button->setEnabled(!crashed_.empty());
    });
    dialog->open();
}

}  // namespace handpiece::desktop
