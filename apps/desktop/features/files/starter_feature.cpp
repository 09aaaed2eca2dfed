// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/files/starter_feature.h"

#include <QComboBox>
#include <QDialog>
#include <QDialogButtonBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QLocale>
#include <QMenu>
#include <QVBoxLayout>
#include <set>

#include "desktop/widgets/notation.h"
#include "desktop/widgets/tooth_chart.h"
#include "desktop/work/simulator.h"

namespace handpiece::desktop {
namespace {

using exercise::Operation;

using Command = StarterFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::choose, "actionChooseTooth", QT_TRANSLATE_NOOP("Commands", "Choose tooth..."),
     QT_TRANSLATE_NOOP("Commands", "Choose a tooth on the chart of the mouth"), "chart", "Ctrl+T", in(Shelf::file, 4),
     in(Shelf::fileBar, 2), brief(QT_TRANSLATE_NOOP("Commands", "Teeth")), Operation::chart},
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

void StarterFeature::fillMenu() {
    auto* menu = new QMenu(tr("Starter tooth"), window_.shelves().menu(Shelf::file));
    menu->setObjectName(QStringLiteral("menuStarter"));
    window_.commands().place(in(Shelf::file, 3), menu->menuAction());
    for (const starter::ToothKindInfo& info : starter::toothKinds()) {
        QMenu* kind = menu->addMenu(toothName(info.fdiNumber));
        kind->setObjectName(QStringLiteral("menuStarter_") +
                            QLatin1String(info.name.data(), qsizetype(info.name.size())));
        for (const Resolution& r : kResolutions) {
            QAction* entry =
                kind->addAction(tr("%1 % · %2 faces").arg(r.percent).arg(QLocale().toString(qulonglong{r.faces})));
            entry->setObjectName(QStringLiteral("actionStarter_%1_%2")
                                     .arg(QLatin1String(info.name.data(), qsizetype(info.name.size())))
                                     .arg(r.percent));
            entry->setToolTip(tr("Open this starter tooth"));
            connect(entry, &QAction::triggered, this, [this, kind = info.kind, faces = r.faces] {
                open({kind, faces});
            });
        }
    }
}

void StarterFeature::addResolutions() {
    resolution_ = new QComboBox;
    resolution_->setObjectName(QStringLiteral("resolutionBox"));
    resolution_->setAccessibleName(tr("Starter tooth's resolution"));
    resolution_->setToolTip(tr("The starter tooth at one of the five resolutions of the paper's Table II"));
    resolution_->addItem(tr("Starter tooth"));
    for (const Resolution& r : kResolutions)
        resolution_->addItem(tr("%1 % · %2 faces").arg(r.percent).arg(QLocale().toString(qulonglong{r.faces})),
                             qulonglong{r.faces});
    connect(resolution_, &QComboBox::activated, this, [this](int index) {
        const auto kind =
            simulator_.document().starter ? simulator_.document().starter->kind : starter::ToothKind::lowerFirstMolar;
        if (index > 0) open({kind, static_cast<std::size_t>(resolution_->itemData(index).toULongLong())});
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
    auto* dialog = new QDialog(&window_);
    dialog->setObjectName(QStringLiteral("toothDialog"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Choose a tooth"));
    auto* column = new QVBoxLayout(dialog);
    auto* row = new QHBoxLayout;
    auto* notation = new QComboBox;
    notation->setObjectName(QStringLiteral("notationBox"));
    notation->setAccessibleName(tr("Notation"));
    notation->setToolTip(tr("How teeth are numbered"));
    notation->addItems({tr("FDI (ISO 3950)"), tr("Universal"), tr("Palmer")});
    notation->setCurrentIndex(static_cast<int>(settings_.number(QStringLiteral("window/notation"), 0.0, 0.0, 2.0)));
    row->addWidget(new QLabel(tr("Notation")));
    row->addWidget(notation);
    row->addStretch();
    column->addLayout(row);
    auto* chart = new ToothChart;
    chart->setNotation(static_cast<Notation>(notation->currentIndex()));
    std::set<int> available;
    for (const starter::ToothKindInfo& info : starter::toothKinds())
        available.insert(info.fdiNumber);
    chart->setAvailable(available);
    if (simulator_.toothCase()) chart->setChosen(simulator_.toothCase()->fdiNumber);
    column->addWidget(chart, 1);
    auto* note = new QLabel(tr("The teeth in full colour come with the program. Others are opened as cases."));
    note->setWordWrap(true);
    column->addWidget(note);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    column->addWidget(buttons);
    connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    connect(notation, &QComboBox::activated, dialog, [this, chart](int index) {
        chart->setNotation(static_cast<Notation>(index));
        settings_.set(QStringLiteral("window/notation"), index);
    });
    connect(chart, &ToothChart::toothChosen, dialog, [this, dialog](int fdi) {
        for (const starter::ToothKindInfo& info : starter::toothKinds()) {
            if (info.fdiNumber != fdi) continue;
            dialog->accept();
            open({info.kind, simulator_.document().starter ? simulator_.document().starter->faces : Starter{}.faces});
        }
    });
    dialog->open();
    chart->setFocus();
}

}  // namespace handpiece::desktop
