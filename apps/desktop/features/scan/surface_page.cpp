// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/surface_page.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QLabel>
#include <QLocale>
#include <QPushButton>
#include <QScrollArea>
#include <QVBoxLayout>

#include "desktop/features/scan/tissue_colours.h"
#include "desktop/picture/solid_view.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/notation.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {
namespace {

// In the box of resolutions, in its order.
enum Choice { useful, hundred, fifty, quarter, twelve, six, allFive, byFaces };
constexpr double kPercents[] = {100, 50, 25, 12, 6};  ///< from `hundred` on

}  // namespace

SurfacePage::SurfacePage(ScanModel& model, ScanQuestions& questions, QWidget* parent)
    : ScanPage(model, parent), questions_(questions) {
    setObjectName(QStringLiteral("scanSurfaces"));
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(0, 0, 0, 0);
    row->setSpacing(14);
    auto* scroll = new QScrollArea(this);
    scroll->setObjectName(QStringLiteral("scanSurfacesScroll"));
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    auto* left = new QWidget;
    auto* column = new QVBoxLayout(left);
    column->setContentsMargins(0, 0, 8, 0);
    column->setSpacing(8);

    column->addWidget(heading(tr("How fine?"), left));
    column->addWidget(note(tr("More faces show more and draw slower. What is cut is as fine either way: the simulator "
                              "cuts voxels of its own."),
                           left));
    auto* form = new QFormLayout;
    form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    resolution_ =
        named(new QComboBox(left), "scanResolution", tr("Faces"), tr("A share of the faces of the scan itself"));
    resolution_->addItem(tr("As many as can be felt"));
    resolution_->addItem(tr("All of the scan's (100 %)"));
    for (const int percent : {50, 25, 12, 6})
        resolution_->addItem(tr("%1 % of them").arg(percent));
    resolution_->addItem(tr("Five cases: 6, 12, 25, 50, 100 %"));
    resolution_->addItem(tr("A number of faces"));
    form->addRow(tr("Faces"), resolution_);
    faces_ = named(new WholeField(left), "scanFaces", tr("Number of faces"), tr("Of all surfaces together"));
    faces_->setRange(1000, 5'000'000);
    faces_->setSingleStep(10000);
    faces_->setGroupSeparatorShown(true);
    faces_->setValue(68151);
    form->addRow(tr("Number of faces"), faces_);
    spacing_ =
        named(new DecimalField(left), "scanGrid", tr("Grid of the tissues"),
              tr("How close the points lie at which the tissues are told; finer than the scan shows nothing more"));
    spacing_->setDecimals(3);
    spacing_->setRange(0.0, 0.5);
    spacing_->setSingleStep(0.01);
    spacing_->setSuffix(tr(" mm"));
    spacing_->setSpecialValueText(tr("as the scan"));
    form->addRow(tr("Grid of the tissues"), spacing_);
    column->addLayout(form);
    smooth_ = named(new QCheckBox(tr("Smooth (volumes are kept)"), left), "scanSmooth", tr("Smooth"),
                    tr("Takes away the steps of voxels without shrinking the tooth"));
    column->addWidget(smooth_);
    scenery_ = named(new QCheckBox(tr("Adjacent teeth and bone around it, to look at"), left), "scanScenery",
                     tr("Adjacent teeth and bone around it"), tr("What stands around the tooth in the scan"));
    column->addWidget(scenery_);

    column->addSpacing(10);
    column->addWidget(heading(tr("A scan from the mouth"), left));
    column->addWidget(note(tr("An intraoral scan (STL, PLY, OBJ) is finer than a CT. It is laid onto the tooth and "
                              "becomes its outside where the two agree."),
                           left));
    auto* buttons = new QHBoxLayout;
    auto* browse = named(new QPushButton(icon(QStringLiteral("open")), tr("Choose..."), left), "scanMouth",
                         tr("Choose an intraoral scan"));
    mouthRemove_ = named(new QPushButton(icon(QStringLiteral("close")), tr("Without"), left), "scanMouthRemove",
                         tr("Without an intraoral scan"));
    buttons->addWidget(browse);
    buttons->addWidget(mouthRemove_);
    buttons->addStretch(1);
    column->addLayout(buttons);
    mouth_ = new QLabel(left);
    mouth_->setObjectName(QStringLiteral("scanMouthFile"));
    mouth_->setWordWrap(true);
    column->addWidget(mouth_);
    auto* mouthForm = new QFormLayout;
    reach_ = named(new DecimalField(left), "scanReach", tr("Taken where they agree within"));
    reach_->setDecimals(2);
    reach_->setRange(0.05, 2.0);
    reach_->setSingleStep(0.05);
    reach_->setSuffix(tr(" mm"));
    mouthForm->addRow(tr("Taken where they agree within"), reach_);
    column->addLayout(mouthForm);
    registered_ = note({}, left, "scanRegistered");
    column->addWidget(registered_);
    column->addStretch(1);
    scroll->setWidget(left);
    scroll->setMinimumWidth(330);
    scroll->setMaximumWidth(400);
    row->addWidget(scroll, 0);

    auto* right = new QVBoxLayout;
    solid_ = new SolidView("scanSurfaceSolid", this);
    right->addWidget(solid_, 1);
    figures_ = new QLabel(this);
    figures_->setObjectName(QStringLiteral("scanSurfaceFigures"));
    figures_->setTextFormat(Qt::RichText);
    figures_->setWordWrap(true);
    right->addWidget(figures_);
    row->addLayout(right, 1);

    connect(resolution_, &QComboBox::activated, this, [this](int at) {
        decide([&](scan_case::ScanJob& job) {
            job.faces = at == byFaces ? static_cast<std::size_t>(faces_->value()) : 0;
            if (at == allFive)
                job.percents.assign(surfacing::kTableTwoPercents.begin(), surfacing::kTableTwoPercents.end());
            else if (at == useful)
                job.percents.clear();
            else
                job.percents = {at < allFive ? kPercents[at - hundred] : 100.0};
        });
    });
    connect(faces_, &WholeField::valueChanged, this, [this](int faces) {
        if (!showing_)
            decide([&](scan_case::ScanJob& job) { job.faces = static_cast<std::size_t>(faces); },
                   QStringLiteral("faces"));
    });
    connect(smooth_, &QCheckBox::toggled, this, [this](bool on) {
        if (!showing_) decide([on](scan_case::ScanJob& job) { job.smooth = on; });
    });
    connect(scenery_, &QCheckBox::toggled, this, [this](bool on) {
        if (!showing_) decide([on](scan_case::ScanJob& job) { job.scenery = on; });
    });
    connect(spacing_, &DecimalField::valueChanged, this, [this](double mm) {
        if (!showing_)
            decide([mm](scan_case::ScanJob& job) { job.segmentation.spacingMm = mm; }, QStringLiteral("grid"));
    });
    connect(reach_, &DecimalField::valueChanged, this, [this](double mm) {
        if (!showing_) decide([mm](scan_case::ScanJob& job) { job.intraoralReachMm = mm; }, QStringLiteral("reach"));
    });
    connect(browse, &QPushButton::clicked, this, [this] {
        const QString file =
            questions_.fileToOpen(tr("An intraoral scan"), tr("Surfaces (*.stl *.ply *.obj);;All files (*)"));
        if (!file.isEmpty()) decide([&](scan_case::ScanJob& job) { job.intraoral = toPath(file); });
    });
    connect(mouthRemove_, &QPushButton::clicked, this,
            [this] { decide([](scan_case::ScanJob& job) { job.intraoral.clear(); }); });
    connect(&model, &ScanModel::decided, this, &SurfacePage::showJob);
    for (const auto signal : {&ScanModel::previewReady, &ScanModel::fullReady, &ScanModel::workChanged})
        connect(&model, signal, this, &SurfacePage::showResult);
    showJob();
    showResult();
}

QString SurfacePage::missing() const {
    return model().best() ? QString() : tr("No tooth was found yet");
}

void SurfacePage::showJob() {
    showing_ = true;
    const scan_case::ScanJob& job = model().job();
    int at = job.percents.empty() ? useful : hundred;
    if (job.faces > 0)
        at = byFaces;
    else if (job.percents.size() > 1)
        at = allFive;
    else
        for (int i = 0; i < 5; ++i)
            if (!job.percents.empty() && job.percents.front() == kPercents[i]) at = hundred + i;
    resolution_->setCurrentIndex(at);
    faces_->setEnabled(at == byFaces);
    if (job.faces > 0) faces_->setValue(static_cast<int>(job.faces));
    smooth_->setChecked(job.smooth);
    scenery_->setChecked(job.scenery);
    scenery_->setEnabled(!model().isLabels());
    spacing_->setValue(job.segmentation.spacingMm);
    reach_->setValue(job.intraoralReachMm);
    const bool has = !job.intraoral.empty();
    mouth_->setText(has ? toQString(job.intraoral.filename()) : tr("None"));
    reach_->setEnabled(has);
    mouthRemove_->setEnabled(has);
    showing_ = false;
    showResult();
}

void SurfacePage::showResult() {
    const auto best = model().best();
    const bool fresh = model().isFullFresh();
    solid_->setParts(best ? std::shared_ptr<const std::vector<cases::Part>>(best, &best->parts) : nullptr,
                     best ? best->bounds : core::Box());
    solid_->setCaption(fresh ? tr("As it will be") : tr("Preview; the fine surfaces are being made"), !fresh);
    if (model().isPaused() && !fresh) solid_->setCaption(tr("Preview; the fine surfaces were not made"), true);
    registered_->clear();
    if (!best) {
        figures_->clear();
        return;
    }
    if (fresh && best->result.registered) {
        const registration::Registered& r = *best->result.registered;
        registered_->setText(tr("It lies on the tooth to %1 mm (rms; 95 % within %2 mm), %3 % of it has a counterpart.")
                                 .arg(QLocale().toString(r.rmsMm, 'f', 3), QLocale().toString(r.worstMm, 'f', 2),
                                      QLocale().toString(100.0 * r.overlap, 'f', 0)));
    }
    const auto number = [](std::size_t n) { return QLocale().toString(static_cast<qulonglong>(n)); };
    QString table = QStringLiteral("<table cellspacing='0' cellpadding='3'>");
    const auto line = [&](const QString& what, const QStringList& cells) {
        table += QStringLiteral("<tr><td>%1</td>").arg(what);
        for (const QString& cell : cells)
            table += QStringLiteral("<td align='right'>&nbsp;&nbsp;%1</td>").arg(cell);
        table += QStringLiteral("</tr>");
    };
    if (fresh && best->result.cases.size() > 1) {
        for (const scan_case::ScannedCase& made : best->result.cases) {
            std::size_t faces = made.surfaces->outer.mesh.triangles.size();
            double bound = made.surfaces->outer.errorBoundMm;
            for (const auto& t : made.surfaces->tissues) {
                faces += t.mesh.triangles.size();
                bound = std::max(bound, t.errorBoundMm);
            }
            line(tr("%1 %").arg(QLocale().toString(made.percent, 'g', 3)),
                 {tr("%1 faces").arg(number(faces)),
                  tr("reduced by at most %1 mm").arg(QLocale().toString(bound, 'f', 3))});
        }
    } else {
        const surfacing::Surfaces* s =
            fresh && !best->result.cases.empty() ? best->result.cases.back().surfaces.get() : best->result.full.get();
        if (s) {
            const auto surface = [&](const QString& name, const surfacing::Surface& of) {
                line(name, {tr("%1 faces").arg(number(of.mesh.triangles.size())),
                            tr("encloses %1 mm³").arg(QLocale().toString(geometry::enclosedVolumeMm3(of.mesh), 'f', 1)),
                            of.errorBoundMm > 0
                                ? tr("reduced by at most %1 mm").arg(QLocale().toString(of.errorBoundMm, 'f', 3))
                                : QString()});
            };
            surface(tr("Whole tooth"), s->outer);
            for (const auto& t : s->tissues)
                surface(swatchHtml(t.tissue) +
                            (t.isAuthored ? tr("%1, authored").arg(tissueName(t.tissue)) : tissueName(t.tissue)),
                        t);
        }
    }
    table += QStringLiteral("</table>");
    // More than the finest of our own teeth has.
    constexpr std::size_t kManyFaces = 400'000;
    if (fresh && best->result.cases.size() == 1 && best->figures.faces > kManyFaces)
        table +=
            QStringLiteral("<p>%1</p>")
                .arg(tr("These are many faces: it will be slow to open and to draw. Take a smaller share of them."));
    figures_->setText(table);
}

}  // namespace handpiece::desktop
