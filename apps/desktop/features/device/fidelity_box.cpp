// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/device/fidelity_box.h"

#include <QCheckBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"
#include "desktop/work/device_manager.h"

namespace handpiece::desktop {

FidelityBox::FidelityBox(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("fidelityBox"));
    setAccessibleName(tr("How good this station feels"));
    auto* column = new QVBoxLayout(this);
    column->addWidget(note(tr("Measures the device with this computer: how evenly its servo runs, how late a force "
                              "comes, its noise and limits. Nothing else has the device meanwhile."),
                           this, "fidelityNote"));
    auto* row = new QHBoxLayout;
    start_ = named(new QPushButton(tr("Check now"), this), "fidelityStart", tr("Check now"),
                   tr("Measures for as long as the field beside it says"));
    row->addWidget(start_);
    seconds_ = named(new WholeField(this), "fidelitySeconds", tr("Seconds"), tr("How long to measure"));
    seconds_->setRange(2, 600);
    seconds_->setValue(10);
    seconds_->setSuffix(tr(" s"));
    row->addWidget(seconds_);
    push_ = named(new QCheckBox(tr("Push lightly"), this), "fidelityPush", tr("Push lightly"),
                  tr("Pushes the stylus with a small known force to measure slope and delay: hold it loosely. Without "
                     "it these are not measured."));
    row->addWidget(push_);
    row->addStretch(1);
    column->addLayout(row);
    auto* work = new QHBoxLayout;
    progress_ = named(new QProgressBar(this), "fidelityProgress", tr("Progress of the check"));
    progress_->setRange(0, 1000);
    work->addWidget(progress_, 1);
    cancel_ = named(new QPushButton(tr("Cancel"), this), "fidelityCancel", tr("Cancel"), tr("Stops the check"));
    work->addWidget(cancel_);
    column->addLayout(work);
    verdict_ = named(new QLabel(this), "fidelityVerdict", tr("Result of the check"));
    verdict_->setWordWrap(true);
    column->addWidget(verdict_);
    list_ = named(new QTreeWidget(this), "fidelityList", tr("Findings"),
                  tr("Each finding with its figure; what to do stands below those that did not pass"));
    list_->setColumnCount(3);
    list_->setHeaderLabels({tr("Result"), tr("What"), tr("Figure")});
    list_->setRootIsDecorated(false);
    list_->setItemsExpandable(false);
    list_->setWordWrap(true);
    list_->header()->setStretchLastSection(true);
    column->addWidget(list_, 1);
    auto* below = new QHBoxLayout;
    below->addStretch(1);
    save_ = named(new QPushButton(tr("Save report..."), this), "fidelitySave", tr("Save report..."),
                  tr("As a page to print (HTML) or for machines (JSON)"));
    below->addWidget(save_);
    column->addLayout(below);
    connect(start_, &QPushButton::clicked, this, [this] {
        fidelity::CheckSettings settings;
        settings.durationS = seconds_->value();
        settings.push = push_->isChecked();
        emit startRequested(settings);
    });
    connect(cancel_, &QPushButton::clicked, this, &FidelityBox::cancelRequested);
    connect(save_, &QPushButton::clicked, this, &FidelityBox::saveRequested);
    showRunning(false);
}

QString FidelityBox::wordOf(fidelity::Verdict verdict) {
    switch (verdict) {
        case fidelity::Verdict::pass:
            return tr("Passed");
        case fidelity::Verdict::warn:
            return tr("Look at this");
        case fidelity::Verdict::fail:
            return tr("Failed");
        case fidelity::Verdict::notMeasured:
            break;
    }
    return tr("Not measured");
}

void FidelityBox::showRunning(bool running) {
    running_ = running;
    start_->setEnabled(available_ && !running);
    seconds_->setEnabled(!running);
    push_->setEnabled(!running);
    progress_->setVisible(running);
    cancel_->setVisible(running);
    save_->setEnabled(!running && report_.has_value());
}

void FidelityBox::setAvailable(bool available) {
    available_ = available;
    start_->setToolTip(available ? tr("Measures for as long as the field beside it says")
                                 : tr("Choose a device in the menu Device first"));
    showRunning(running_);
}

void FidelityBox::begin() {
    report_.reset();
    list_->clear();
    verdict_->setText(tr("Measuring..."));
    progress_->setValue(0);
    showRunning(true);
}

void FidelityBox::setFraction(double fraction) {
    progress_->setValue(static_cast<int>(1000.0 * std::clamp(fraction, 0.0, 1.0)));
}

void FidelityBox::say(const QString& sentence) {
    if (running_) verdict_->setText(sentence);
}

void FidelityBox::end(const QString& why) {
    verdict_->setText(why);
    showRunning(false);
}

void FidelityBox::setReport(const fidelity::Report& report) {
    report_ = report;
    list_->clear();
    const Tones tones = tonesOf(palette());
    int warnings = 0, failures = 0;
    for (const fidelity::Finding& finding : report.findings) {
        const auto said = [](const std::string& text) { return QString::fromStdString(text); };
        QString value = said(config::words()(finding.value)), remedy = said(config::words()(finding.remedy));
        if (finding.id == "troubles" && !report.troubles.empty()) {
            // As the message says it that came with each.
            QStringList sentences;
            for (const link::DeviceFault trouble : report.troubles)
                sentences << problemOf(trouble, report.vendorCode).what;
            value = sentences.join(QLatin1Char(' '));
            remedy = problemOf(report.troubles.front(), report.vendorCode).remedy;
        }
        auto* item =
            new QTreeWidgetItem(list_, {wordOf(finding.verdict), said(nameOf(finding, config::words())), value});
        item->setData(0, Qt::UserRole, QString::fromStdString(finding.id));
        const bool warn = finding.verdict == fidelity::Verdict::warn;
        const bool fail = finding.verdict == fidelity::Verdict::fail;
        warnings += warn ? 1 : 0;
        failures += fail ? 1 : 0;
        item->setForeground(0, fail                                                ? tones.bad
                               : warn                                              ? tones.caution
                               : finding.verdict == fidelity::Verdict::notMeasured ? tones.quiet
                                                                                   : tones.good);
        for (int column = 0; column < 3; ++column)
            item->setToolTip(column, value + QLatin1Char('\n') + said(config::words()(finding.against)));
        if ((warn || fail) && !remedy.isEmpty()) {
            auto* below = new QTreeWidgetItem(item, {QString(), QString(), remedy});
            below->setToolTip(2, remedy);
            item->setExpanded(true);
        }
    }
    for (const int column : {0, 1})
        list_->resizeColumnToContents(column);
    verdict_->setText(failures > 0   ? tr("Failed: %1. To look at: %2.").arg(failures).arg(warnings)
                      : warnings > 0 ? tr("Nothing failed. To look at: %1.").arg(warnings)
                                     : tr("All that could be measured has passed."));
    showRunning(false);
}

}  // namespace handpiece::desktop
