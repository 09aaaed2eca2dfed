// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/report_page.h"

#include <QDir>
#include <QFileInfo>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QPushButton>
#include <QRegularExpression>
#include <QScrollArea>
#include <QVBoxLayout>
#include <algorithm>

#include "desktop/features/scan/placing_page.h"
#include "desktop/features/scan/tissue_colours.h"
#include "desktop/picture/solid_view.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/notation.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {
namespace {

// The case that is tried: fine to look at, and drawn at 60 pictures a second without a graphics card.
constexpr std::size_t kPleasantFaces = 70000;

QString plain(const std::string& text) {
    return QString::fromStdString(text).toHtmlEscaped();
}

QString fileNameOf(const QString& name) {
    static const QRegularExpression odd(QStringLiteral("[^\\w-]+"), QRegularExpression::UseUnicodePropertiesOption);
    QString file = name.trimmed().toLower().replace(odd, QStringLiteral("-"));
    while (file.startsWith(QLatin1Char('-')))
        file.remove(0, 1);
    while (file.endsWith(QLatin1Char('-')))
        file.chop(1);
    return file.isEmpty() ? QStringLiteral("case") : file;
}

}  // namespace

ReportPage::ReportPage(ScanModel& model, ScanQuestions& questions, const QString& folder, QWidget* parent)
    : ScanPage(model, parent), questions_(questions), folder_(folder) {
    setObjectName(QStringLiteral("scanReport"));
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(10);
    auto* row = new QHBoxLayout;
    row->setSpacing(14);
    auto* scroll = new QScrollArea(this);
    scroll->setObjectName(QStringLiteral("scanReportScroll"));
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    text_ = new QLabel;
    text_->setObjectName(QStringLiteral("scanReportText"));
    text_->setAccessibleName(tr("Report of the case"));
    text_->setTextFormat(Qt::RichText);
    text_->setWordWrap(true);
    text_->setAlignment(Qt::AlignTop);
    text_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
    text_->setContentsMargins(2, 0, 10, 0);
    scroll->setWidget(text_);
    row->addWidget(scroll, 5);
    solid_ = new SolidView("scanReportSolid", this);
    row->addWidget(solid_, 4);
    column->addLayout(row, 1);

    auto* line = new QHBoxLayout;
    auto* label = new QLabel(tr("Save the case as"), this);
    line->addWidget(label);
    place_ = named(new QLineEdit(this), "scanPlace", tr("Save the case as"),
                   tr("A file that ends in .handpiece, or a folder"));
    label->setBuddy(place_);
    line->addWidget(place_, 1);
    auto* browse = named(new QPushButton(icon(QStringLiteral("open")), tr("Where..."), this), "scanWhere",
                         tr("Choose where the case is saved"));
    line->addWidget(browse);
    save_ = named(new QPushButton(icon(QStringLiteral("save")), tr("Save the case"), this), "scanSave",
                  tr("Save the case"));
    line->addWidget(save_);
    try_ = named(new QPushButton(icon(QStringLiteral("cut")), tr("Try it now"), this), "scanTry", tr("Try it now"),
                 tr("Save the case and open it in the simulator"));
    line->addWidget(try_);
    column->addLayout(line);
    auto* after = new QHBoxLayout;
    saved_ = note({}, this, "scanSaved");
    after->addWidget(saved_, 1);
    open_ = named(new QPushButton(tr("Open the report"), this), "scanOpenReport", tr("Open the report"),
                  tr("The page to print that was saved with the case, with its pictures"));
    open_->setEnabled(false);
    after->addWidget(open_, 0, Qt::AlignTop);
    column->addLayout(after);

    connect(place_, &QLineEdit::textEdited, this, [this] { placeChosen_ = true; });
    connect(browse, &QPushButton::clicked, this, [this] {
        const QString file =
            questions_.fileToSave(tr("Save the case as"), place(), tr("Cases (*.handpiece);;All files (*)"));
        if (!file.isEmpty()) setPlace(file);
    });
    connect(save_, &QPushButton::clicked, this, [this] { save(false); });
    connect(try_, &QPushButton::clicked, this, [this] { save(true); });
    connect(open_, &QPushButton::clicked, this, [this] {
        const QString page = QFileInfo(toQString(this->model().report())).absoluteFilePath();
        if (!questions_.showPage(page)) this->model().setProblem(problemById(QStringLiteral("no-browser"), {}, page));
    });
    connect(&model, &ScanModel::decided, this, &ReportPage::showJob);
    for (const auto signal : {&ScanModel::previewReady, &ScanModel::fullReady, &ScanModel::workChanged})
        connect(&model, signal, this, &ReportPage::showResult);
    connect(&model, &ScanModel::problemChanged, this, [this] {
        if (this->model().problem()) tryWhenSaved_ = false;
    });
    connect(&model, &ScanModel::casesWritten, this, [this] {
        QStringList names;
        for (const auto& place : this->model().written())
            names << QDir::toNativeSeparators(toQString(place));
        saved_->setText(tr("Saved: %1").arg(names.join(QStringLiteral(", "))));
        open_->setEnabled(!this->model().report().empty());
        if (!std::exchange(tryWhenSaved_, false) || this->model().written().empty()) return;
        // Of several the one that is pleasant to work with.
        std::size_t best = 0;
        double nearest = 1e300;
        const auto full = this->model().full();
        for (std::size_t i = 0; full && i < full->result.cases.size() && i < this->model().written().size(); ++i) {
            const auto faces = static_cast<double>(full->result.cases[i].surfaces->outer.mesh.triangles.size());
            const double away = std::abs(std::log(std::max(1.0, faces) / kPleasantFaces));
            if (away < nearest) {
                nearest = away;
                best = i;
            }
        }
        emit tryNow(toQString(this->model().written()[best]));
    });
    showJob();
    showResult();
}

QString ReportPage::place() const {
    return place_->text().trimmed();
}

void ReportPage::setPlace(const QString& place) {
    placeChosen_ = true;
    place_->setText(QDir::toNativeSeparators(place));
}

void ReportPage::save(bool thenTry) {
    if (place().isEmpty()) {
        place_->setFocus();
        return;
    }
    tryWhenSaved_ = thenTry;
    saved_->clear();
    open_->setEnabled(false);
    model().write(toPath(place()));
}

void ReportPage::showJob() {
    if (!placeChosen_)
        place_->setText(QDir::toNativeSeparators(folder_ + QLatin1Char('/') +
                                                 fileNameOf(QString::fromStdString(model().job().name)) +
                                                 QStringLiteral(".handpiece")));
    saved_->clear();
    open_->setEnabled(false);
    showResult();
}

void ReportPage::showResult() {
    const auto best = model().best();
    const bool fresh = model().isFullFresh();
    const int sign = buccalSignOf(model().job().placing.fdiNumber);
    solid_->setParts(best ? std::shared_ptr<const std::vector<cases::Part>>(best, &best->parts) : nullptr,
                     best ? best->bounds : core::Box());
    solid_->setAxesShown(true, sign);
    solid_->setCaption(fresh ? QString() : tr("Preview"), !fresh);
    text_->setText(fresh              ? reportHtml()
                   : model().isBusy() ? tr("The case is being made in full. The report comes with it.")
                                      : tr("The case is not made yet."));
    const bool named = !QString::fromStdString(model().job().name).trimmed().isEmpty();
    save_->setEnabled(best != nullptr && named);
    try_->setEnabled(best != nullptr && named);
}

QString ReportPage::reportHtml() const {
    const auto full = model().full();
    const scan_case::ScanResult& r = full->result;
    const ScanFigures& f = full->figures;
    const scan_case::ScanJob& job = model().job();
    const auto number = [](double value, int decimals) { return QLocale().toString(value, 'f', decimals); };
    const auto mm = [&](double value, int decimals = 2) { return quantity(value, decimals, tr("mm")); };
    QString html;
    const auto head = [&](const QString& text) {
        html += QStringLiteral("<h3 style='margin:10px 0 3px 0'>%1</h3>").arg(text);
    };
    const auto begin = [&] { html += QStringLiteral("<table cellspacing='0' cellpadding='2'>"); };
    const auto line = [&](const QString& what, const QString& value, const QString& more = {}) {
        html += QStringLiteral("<tr><td>%1&nbsp;&nbsp;</td><td align='right'>%2</td><td>&nbsp;&nbsp;%3</td></tr>")
                    .arg(what, value, more);
    };
    const auto end = [&] { html += QStringLiteral("</table>"); };

    html += QStringLiteral("<h2 style='margin:0'>%1</h2>").arg(plain(job.name));
    if (job.placing.fdiNumber > 0)
        html += QStringLiteral("<div>%1 · %2</div>").arg(job.placing.fdiNumber).arg(toothName(job.placing.fdiNumber));

    head(tr("Volumes"));
    begin();
    double sum = 0;
    for (const double volume : r.volumesMm3)
        sum += volume;
    for (const cases::Tissue tissue : {cases::Tissue::enamel, cases::Tissue::dentine, cases::Tissue::pulp,
                                       cases::Tissue::caries, cases::Tissue::restoration}) {
        const double volume = r.volumesMm3[static_cast<std::size_t>(tissue)];
        if (volume <= 0) continue;
        bool isAuthored = false;
        for (const segmentation::Solid& solid : r.region->solids)
            isAuthored = isAuthored || (solid.tissue == tissue && solid.isAuthored);
        line(swatchHtml(tissue) + tissueName(tissue), tr("%1 mm³").arg(number(volume, volume < 10 ? 2 : 1)),
             isAuthored ? tr("with an authored lesion") : tr("%1 %").arg(number(100 * volume / sum, 1)));
    }
    line(tr("Together"), tr("%1 mm³").arg(number(sum, 1)));
    end();

    head(tr("Sizes"));
    begin();
    line(tr("Mesiodistal × buccolingual × length"),
         tr("%1 × %2 × %3 mm").arg(number(f.sizeMm.x(), 1), number(f.sizeMm.y(), 1), number(f.sizeMm.z(), 1)));
    if (f.enamel.isKnown)
        line(tr("Enamel over dentine"), tr("%1 in the middle").arg(mm(f.enamel.medianMm)),
             tr("at most %1").arg(mm(f.enamel.mostMm)));
    if (f.overPulp.isKnown)
        line(tr("Dentine over the pulp, in the crown"), tr("at least %1").arg(mm(f.overPulp.leastMm)),
             tr("%1 in the middle").arg(mm(f.overPulp.medianMm)));
    end();

    head(tr("How good it is"));
    const volume::Grid& g = r.scan->volume.grid;
    begin();
    line(tr("Voxels of the scan"),
         tr("%1 × %2 × %3 mm").arg(number(g.spacingMm.x(), 3), number(g.spacingMm.y(), 3), number(g.spacingMm.z(), 3)),
         job.spacingMm ? tr("given by hand") : QString());
    if (!model().isLabels()) {
        line(tr("Blur of the scan"), mm(r.region->blurMm, 3), tr("standard deviation"));
        const auto& t = r.region->thresholds;
        if (r.region->noise > 0)
            line(tr("Enamel stands out of dentine by"),
                 tr("%1 × the noise").arg(number((t.enamel - t.dentine) / r.region->noise, 1)),
                 (t.enamel - t.dentine) < 3 * r.region->noise ? tr("little: look at their border in the slices")
                                                              : QString());
        line(tr("Thresholds"), job.segmentation.thresholds ? tr("set by hand") : tr("found by the program"));
    }
    if (r.registered)
        line(tr("Intraoral scan"), tr("rms %1").arg(mm(r.registered->rmsMm, 3)),
             tr("95 % within %1").arg(mm(r.registered->worstMm)));
    line(tr("Faces"), QLocale().toString(static_cast<qulonglong>(f.faces)),
         f.errorBoundMm > 0 ? tr("reduced by at most %1").arg(mm(f.errorBoundMm, 3)) : tr("as made from the scan"));
    std::size_t errors = 0;
    for (const cases::CaseFinding& finding : f.findings)
        errors += finding.isError ? 1 : 0;
    const Tones tones = tonesOf(palette());
    line(tr("Surfaces closed and nested"),
         errors == 0 ? QStringLiteral("<span style='color:%1'>%2</span>").arg(tones.good.name(), tr("yes"))
                     : QStringLiteral("<span style='color:%1'>%2</span>").arg(tones.bad.name(), tr("no")),
         errors == 0 ? tr("it can be cut") : tr("findings: %1").arg(errors));
    end();

    QStringList notes;
    for (const std::string& text : r.notes())
        notes << plain(text);
    for (const cases::CaseFinding& finding : f.findings)
        notes << plain((finding.part.empty() ? "" : finding.part + ": ") + finding.what);
    if (!notes.isEmpty()) {
        head(tr("To know"));
        html += QStringLiteral("<ul style='margin:0 0 0 -24px'><li>%1</li></ul>")
                    .arg(notes.join(QStringLiteral("</li><li>")));
    }
    head(tr("What the scan cannot show"));
    // Two voxels or twice the blur's width: what is thinner leaves no peak of its own.
    const double finest = std::max(2.0 * g.spacingMm.maxCoeff(), 2.0 * r.region->blurMm);
    QStringList limits{
        tr("Anything thinner than about %1: hairline cracks, narrow canals, the thin edge of the enamel.")
            .arg(mm(finest)),
        tr("Cementum: it is taken for dentine. Gingiva and periodontal ligament: X-rays pass them."),
        tr("Early caries: only what has lost enough mineral is darker. How soft it is, is not seen at all.")};
    for (const segmentation::Solid& solid : r.region->solids)
        if (solid.isAuthored) limits << tr("The authored lesion is the teacher's: no patient had it.");
    limits.removeDuplicates();
    html +=
        QStringLiteral("<ul style='margin:0 0 0 -24px'><li>%1</li></ul>").arg(limits.join(QStringLiteral("</li><li>")));
    return html;
}

}  // namespace handpiece::desktop
