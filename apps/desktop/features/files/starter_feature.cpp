// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/files/starter_feature.h"

#include <QComboBox>
#include <QLocale>
#include <QMenu>

#include "desktop/features/files/chart_dialog.h"
#include "desktop/framework/mnemonics.h"
#include "desktop/work/simulator.h"

namespace handpiece::desktop {
namespace {

using exercise::Operation;

using Command = StarterFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::choose, "actionChooseTooth", QT_TRANSLATE_NOOP("Commands", "Choose tooth..."),
     QT_TRANSLATE_NOOP("Commands", "Choose a tooth, and whose, on the chart of the mouth"), "chart", "Ctrl+T",
     in(Shelf::file, 4), in(Shelf::fileBar, 2), brief(QT_TRANSLATE_NOOP("Commands", "Teeth")), Operation::chart},
};

}  // namespace

StarterFeature::StarterFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands) {
    fillMenu();
    addResolutions();
    on(commands_[Command::choose], [this] { choose(); });
    window_.commands().enableWhile(commands_[Command::choose], [this] { return !simulator_.isBusy(); });
}

void StarterFeature::open(const Starter& starter) {
    window_.whenMayLeave([this, starter] { simulator_.openStarter(starter); });
}

/// That is open, or that an empty start opens.
Starter StarterFeature::now() const {
    return simulator_.document().starter.value_or(simulator_.firstStarter());
}

QString StarterFeature::resolutionText(const Resolution& resolution) {
    return tr("%1 % · %2 faces").arg(resolution.percent).arg(QLocale().toString(qulonglong{resolution.faces}));
}

void StarterFeature::openAt(std::size_t faces) {
    Starter starter = now();
    starter.faces = faces;
    open(starter);
}

void StarterFeature::fillMenu() {
    auto* menu = withMnemonics(new QMenu(tr("Resolution of the tooth"), window_.shelves().menu(Shelf::file)));
    menu->setObjectName(QStringLiteral("menuResolution"));
    window_.commands().place(in(Shelf::file, 3), menu->menuAction());
    for (const Resolution& r : kResolutions) {
        QAction* entry = menu->addAction(resolutionText(r));
        entry->setObjectName(QStringLiteral("actionResolution_%1").arg(r.percent));
        entry->setToolTip(tr("Make the tooth that is open anew with so many faces"));
        connect(entry, &QAction::triggered, this, [this, faces = r.faces] { openAt(faces); });
    }
}

void StarterFeature::addResolutions() {
    resolution_ = new QComboBox;
    resolution_->setObjectName(QStringLiteral("resolutionBox"));
    resolution_->setAccessibleName(tr("Resolution of the tooth"));
    resolution_->setToolTip(tr("A tooth of the program at one of the five resolutions of the paper's Table II"));
    resolution_->addItem(tr("Resolution"));
    for (const Resolution& r : kResolutions)
        resolution_->addItem(resolutionText(r), qulonglong{r.faces});
    connect(resolution_, &QComboBox::activated, this, [this](int index) {
        if (index > 0) openAt(static_cast<std::size_t>(resolution_->itemData(index).toULongLong()));
    });

    QAction* action = window_.commands().placeWidget(in(Shelf::fileBar, 1), resolution_);
    action->setObjectName(QStringLiteral("resolutionAction"));
    connect(&window_.docks(), &Docks::detailChanged, action,
            [action](Detail detail) { action->setVisible(detail != Detail::practice); });
    const auto enable = [this] { resolution_->setEnabled(!simulator_.isBusy()); };
    connect(&simulator_, &Simulator::jobStarted, this, enable);
    connect(&simulator_, &Simulator::jobEnded, this, enable);
    connect(&simulator_, &Simulator::documentChanged, this, enable);
    enable();
}

void StarterFeature::choose() {
    ChartDialog::Setting setting;
    setting.starter = now();
    setting.isStarterOpen = simulator_.document().starter.has_value();
    setting.openCase = simulator_.toothCase();
    if (setting.openCase) setting.openTooth = setting.openCase->fdiNumber;
    setting.places.push_back(simulator_.casesFolder());
    setting.places.push_back(toPath(settings_.value(QStringLiteral("files/folder")).toString()));
    for (const QString& file : settings_.recentFiles())
        setting.places.push_back(toPath(file));
    setting.notation = static_cast<Notation>(settings_.number(QStringLiteral("window/notation"), 0.0, 0.0, 2.0));
    auto* dialog = new ChartDialog(std::move(setting), &window_);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    connect(dialog, &ChartDialog::notationChosen, this,
            [this](int notation) { settings_.set(QStringLiteral("window/notation"), notation); });
    connect(dialog, &ChartDialog::starterChosen, this, &StarterFeature::open);
    connect(dialog, &ChartDialog::caseChosen, this, [this](const QString& path, int fdi) {
        window_.whenMayLeave([this, path, fdi] { simulator_.open(toPath(path), fdi); });
    });
    dialog->open();
}

}  // namespace handpiece::desktop
