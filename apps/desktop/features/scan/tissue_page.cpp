// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/tissue_page.h"

#include <QButtonGroup>
#include <QCheckBox>
#include <QComboBox>
#include <QCoreApplication>
#include <QFormLayout>
#include <QGridLayout>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QPushButton>
#include <QScrollArea>
#include <QSplitter>
#include <QStackedWidget>
#include <QToolButton>
#include <QVBoxLayout>

#include "desktop/features/scan/fdi_picker.h"
#include "desktop/features/scan/histogram_view.h"
#include "desktop/features/scan/tissue_colours.h"
#include "desktop/picture/solid_view.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/notation.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

using segmentation::Settings;

namespace {

struct Tool {
    SliceTool tool;
    const char *name, *icon, *text, *tip;
};
const Tool kTools[] = {
    {SliceTool::look, "scanToolLook", "eye", QT_TRANSLATE_NOOP("TissuePage", "Look"),
     QT_TRANSLATE_NOOP("TissuePage", "Click or drag in a slice: the other two follow")},
    {SliceTool::pick, "scanToolPick", "tooth", QT_TRANSLATE_NOOP("TissuePage", "This tooth"),
     QT_TRANSLATE_NOOP("TissuePage", "Click in the crown or a root of the tooth that is wanted; the rest is left out")},
    {SliceTool::brush, "scanToolBrush", "touch", QT_TRANSLATE_NOOP("TissuePage", "Brush"),
     QT_TRANSLATE_NOOP("TissuePage", "Drag over what the program took for something else")},
    {SliceTool::cut, "scanToolCut", "section", QT_TRANSLATE_NOOP("TissuePage", "Cut off"),
     QT_TRANSLATE_NOOP("TissuePage",
                       "Draw a line between the tooth and what it touches: a plane through it parts the two")},
    {SliceTool::lesion, "scanToolLesion", "bur", QT_TRANSLATE_NOOP("TissuePage", "Lesion"),
     QT_TRANSLATE_NOOP(
         "TissuePage",
         "Click where caries shall be that the patient does not have. The case says that it was authored")},
};

QString translated(const char* text) {
    return QCoreApplication::translate("TissuePage", text);
}

QString mm(double value, int decimals = 1) {
    return quantity(value, decimals, TissuePage::tr("mm"));
}

QIcon swatch(cases::Tissue tissue) {
    QPixmap pixmap(14, 14);
    pixmap.fill(tissueColour(tissue));
    return pixmap;
}

}  // namespace

std::vector<DecisionRow> decisionRows(const Settings& settings) {
    std::vector<DecisionRow> rows;
    if (settings.toothAtMm) rows.push_back({DecisionRow::Kind::tooth, 0, 1, TissuePage::tr("This tooth, by a click")});
    const auto& marks = settings.marks;
    for (std::size_t first = 0; first < marks.size();) {
        // A row of balls that lie close is one stroke.
        std::size_t end = first + 1;
        while (end < marks.size() && marks[end].tissue == marks[first].tissue &&
               marks[end].radiusMm == marks[first].radiusMm &&
               (marks[end].centreMm - marks[end - 1].centreMm).norm() < 1.1 * marks[first].radiusMm)
            ++end;
        const QString what = marks[first].tissue == cases::Tissue::none ? TissuePage::tr("Nothing here")
                                                                        : tissueName(marks[first].tissue);
        rows.push_back({DecisionRow::Kind::marks, first, end - first,
                        TissuePage::tr("Brush: %1, %2").arg(what, mm(marks[first].radiusMm))});
        first = end;
    }
    for (std::size_t i = 0; i < settings.cutPlanes.size(); ++i)
        rows.push_back({DecisionRow::Kind::cut, i, 1, TissuePage::tr("Cut off, plane %1").arg(i + 1)});
    for (std::size_t i = 0; i < settings.lesions.size(); ++i)
        rows.push_back({DecisionRow::Kind::lesion, i, 1,
                        TissuePage::tr("Lesion, authored, %1").arg(mm(settings.lesions[i].halfAxesMm.maxCoeff()))});
    return rows;
}

TissuePage::TissuePage(ScanModel& model, QWidget* parent) : ScanPage(model, parent) {
    setObjectName(QStringLiteral("scanTissues"));
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(0, 0, 0, 0);
    auto* halves = new QSplitter(Qt::Horizontal, this);
    halves->setObjectName(QStringLiteral("scanTissueHalves"));
    halves->setChildrenCollapsible(false);
    auto* left = new QWidget;
    auto* column = new QVBoxLayout(left);
    column->setContentsMargins(0, 0, 6, 0);
    column->setSpacing(8);
    auto* grid = new QGridLayout;
    grid->setSpacing(4);
    axial_ = new SliceView(SliceView::Direction::axial, this);
    coronal_ = new SliceView(SliceView::Direction::coronal, this);
    sagittal_ = new SliceView(SliceView::Direction::sagittal, this);
    solid_ = new SolidView("scanSolid", this);
    grid->addWidget(axial_, 0, 0);
    grid->addWidget(coronal_, 0, 1);
    grid->addWidget(sagittal_, 1, 0);
    grid->addWidget(solid_, 1, 1);
    for (int i = 0; i < 2; ++i) {
        grid->setColumnStretch(i, 1);
        grid->setRowStretch(i, 1);
    }
    column->addLayout(grid, 1);
    histogram_ = new HistogramView(this);
    column->addWidget(histogram_);
    halves->addWidget(left);
    halves->addWidget(makeTools());
    halves->setStretchFactor(0, 1);
    halves->setStretchFactor(1, 0);
    row->addWidget(halves);

    for (SliceView* view : {axial_, coronal_, sagittal_}) {
        connect(view, &SliceView::crossMoved, this, &TissuePage::setCross);
        connect(view, &SliceView::windowDragged, this, [this](float black, float white) {
            black_ = black;
            white_ = white;
            for (SliceView* each : {axial_, coronal_, sagittal_})
                each->setWindow(black_, white_);
        });
        connect(view, &SliceView::picked, this, [this](const core::Vec3& at) {
            decide([&](scan_case::ScanJob& job) { job.segmentation.toothAtMm = at; });
        });
        connect(view, &SliceView::painted, this, [this](const std::vector<core::Vec3>& points) {
            decide(
                [&](scan_case::ScanJob& job) {
                    for (const core::Vec3& at : points)
                        job.segmentation.marks.push_back(
                            {at, brushRadius_->value(),
                             static_cast<cases::Tissue>(brushTissue_->currentData().toInt())});
                },
                QStringLiteral("stroke"));
        });
        connect(view, &SliceView::strokeEnded, this, [this] { this->model().endMerge(); });
        connect(view, &SliceView::cutDrawn, this, &TissuePage::addCut);
        connect(view, &SliceView::lesionPlaced, this, [this](const core::Vec3& at) {
            decide([&](scan_case::ScanJob& job) {
                job.segmentation.lesions.push_back({at, core::Vec3::Constant(lesionRadius_->value())});
            });
        });
    }
    connect(histogram_, &HistogramView::thresholdsMoved, this, [this](const segmentation::Thresholds& thresholds) {
        decide([&](scan_case::ScanJob& job) { job.segmentation.thresholds = thresholds; },
               QStringLiteral("thresholds"));
    });
    connect(histogram_, &HistogramView::dragEnded, this, [this] {
        this->model().endMerge();
        showJob();
    });
    connect(&model, &ScanModel::scanRead, this, &TissuePage::showScan);
    connect(&model, &ScanModel::decided, this, &TissuePage::showJob);
    connect(&model, &ScanModel::previewReady, this, &TissuePage::showPreview);
    connect(&model, &ScanModel::workChanged, this, [this] {
        solid_->setCaption(
            this->model().isPreviewFresh() || !this->model().preview() ? tr("Preview") : tr("Preview, being renewed"),
            !this->model().isPreviewFresh());
    });
    setTool(SliceTool::look);
    showScan();
    showJob();
    showPreview();
}

QWidget* TissuePage::makeTools() {
    auto* scroll = new QScrollArea(this);
    scroll->setObjectName(QStringLiteral("scanToolsScroll"));
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    auto* tools = new QWidget;
    auto* column = new QVBoxLayout(tools);
    column->setContentsMargins(6, 0, 6, 0);
    column->setSpacing(6);

    column->addWidget(heading(tr("What was found"), tools));
    volumes_ = new QLabel(tools);
    volumes_->setObjectName(QStringLiteral("scanVolumes"));
    volumes_->setTextFormat(Qt::RichText);
    column->addWidget(volumes_);
    notes_ = note({}, tools, "scanTissueNotes");
    column->addWidget(notes_);

    column->addSpacing(4);
    column->addWidget(heading(tr("The mouse in a slice"), tools));
    auto* buttons = new QGridLayout;
    buttons->setSpacing(4);
    tools_ = new QButtonGroup(this);
    int n = 0;
    for (const Tool& t : kTools) {
        auto* button = named(new QToolButton(tools), t.name, translated(t.text), translated(t.tip));
        button->setIcon(icon(QLatin1String(t.icon)));
        button->setText(translated(t.text));
        button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
        button->setCheckable(true);
        button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
        button->setFocusPolicy(Qt::StrongFocus);
        tools_->addButton(button, static_cast<int>(t.tool));
        buttons->addWidget(button, n / 2, n % 2);
        ++n;
    }
    column->addLayout(buttons);

    options_ = new QStackedWidget(tools);
    options_->setObjectName(QStringLiteral("scanToolOptions"));
    for (const Tool& t : kTools) {
        auto* page = new QWidget;
        auto* form = new QFormLayout(page);
        form->setContentsMargins(0, 0, 0, 0);
        form->addRow(note(translated(t.tip), page));
        if (t.tool == SliceTool::brush) {
            brushTissue_ = named(new QComboBox(page), "scanBrushTissue", tr("This is"));
            for (const cases::Tissue tissue : {cases::Tissue::none, cases::Tissue::enamel, cases::Tissue::dentine,
                                               cases::Tissue::pulp, cases::Tissue::caries, cases::Tissue::restoration})
                brushTissue_->addItem(swatch(tissue),
                                      tissue == cases::Tissue::none ? tr("Nothing here") : tissueName(tissue),
                                      static_cast<int>(tissue));
            form->addRow(tr("This is"), brushTissue_);
            brushRadius_ = named(new DecimalField(page), "scanBrushRadius", tr("Radius of the brush"));
            form->addRow(tr("Radius"), brushRadius_);
            connect(brushTissue_, &QComboBox::currentIndexChanged, this, [this] { takeTool(); });
        }
        if (t.tool == SliceTool::lesion) {
            lesionRadius_ = named(new DecimalField(page), "scanLesionRadius", tr("Radius of the lesion"));
            form->addRow(tr("Radius"), lesionRadius_);
        }
        options_->addWidget(page);
    }
    for (DecimalField* box : {brushRadius_, lesionRadius_}) {
        box->setRange(0.05, 5.0);
        box->setDecimals(2);
        box->setSingleStep(0.1);
        box->setSuffix(tr(" mm"));
        box->setValue(box == brushRadius_ ? 0.4 : 1.0);
        connect(box, &DecimalField::valueChanged, this, [this] { takeTool(); });
    }
    options_->setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Fixed);
    column->addWidget(options_);
    connect(tools_, &QButtonGroup::idClicked, this, [this](int id) { setTool(static_cast<SliceTool>(id)); });

    column->addSpacing(4);
    column->addWidget(heading(tr("Decided by hand"), tools));
    decisions_ =
        named(new QListWidget(tools), "scanDecisions", tr("Decided by hand"), tr("What you said; the last one wins"));
    decisions_->setMinimumHeight(70);
    column->addWidget(decisions_, 1);
    auto* below = new QHBoxLayout;
    remove_ = named(new QPushButton(icon(QStringLiteral("close")), tr("Take back"), tools), "scanRemove",
                    tr("Take the chosen decision back"));
    flip_ = named(new QPushButton(tr("Other side"), tools), "scanFlipCut",
                  tr("Keep what lies on the other side of the chosen plane"));
    below->addWidget(remove_);
    below->addWidget(flip_);
    column->addLayout(below);
    connect(decisions_, &QListWidget::currentRowChanged, this, [this](int at) {
        const auto rows = decisionRows(model().job().segmentation);
        const bool is = at >= 0 && static_cast<std::size_t>(at) < rows.size();
        remove_->setEnabled(is);
        flip_->setEnabled(is && rows[static_cast<std::size_t>(at)].kind == DecisionRow::Kind::cut);
    });
    connect(remove_, &QPushButton::clicked, this, &TissuePage::removeChosen);
    connect(flip_, &QPushButton::clicked, this, &TissuePage::flipChosen);

    column->addSpacing(4);
    automatic_ = named(new QPushButton(icon(QStringLiteral("reset")), tr("Thresholds found by the program"), tools),
                       "scanAutomatic", tr("Forget the thresholds that were dragged"));
    column->addWidget(automatic_);
    connect(automatic_, &QPushButton::clicked, this,
            [this] { decide([](scan_case::ScanJob& job) { job.segmentation.thresholds.reset(); }); });
    const auto check = [&](const char* name, const QString& text, const QString& tip, auto set) {
        auto* box = named(new QCheckBox(text, tools), name, text, tip);
        connect(box, &QCheckBox::toggled, this, [this, set](bool on) {
            if (!showing_) decide([&](scan_case::ScanJob& job) { set(job, on); });
        });
        column->addWidget(box);
        return box;
    };
    damp_ = check("scanDamp", tr("Damp noise and streaks"), tr("Edges are kept"),
                  [](scan_case::ScanJob& job, bool on) { job.segmentation.damp = on; });
    caries_ = check("scanCaries", tr("Look for caries"), tr("Dark places in enamel and dentine"),
                    [](scan_case::ScanJob& job, bool on) { job.segmentation.findCaries = on; });
    fill_ = named(new QCheckBox(tr("Colour the tissues in the slices"), tools), "scanFill",
                  tr("Colour the tissues in the slices"), tr("Off: their outlines only"));
    fill_->setChecked(true);
    column->addWidget(fill_);
    connect(fill_, &QCheckBox::toggled, this, [this](bool on) {
        for (SliceView* view : {axial_, coronal_, sagittal_})
            view->setFillShown(on);
    });
    column->addSpacing(4);
    column->addWidget(heading(tr("Which tooth is it?"), tools));
    tooth_ = new FdiPicker(QStringLiteral("scanTissueFdi"), tools);
    column->addWidget(tooth_);
    connect(tooth_, &FdiPicker::toothChosen, this,
            [this](int fdi) { decide([&](scan_case::ScanJob& job) { job.placing.fdiNumber = fdi; }); });
    scroll->setWidget(tools);
    scroll->setMinimumWidth(tools->minimumSizeHint().width() + 18);
    scroll->setMaximumWidth(380);
    return scroll;
}

QString TissuePage::missing() const {
    if (!model().scan()) return tr("The scan is not read yet");
    if (!model().preview()) return tr("No tooth was found yet");
    return {};
}

void TissuePage::setTool(SliceTool tool) {
    tools_->button(static_cast<int>(tool))->setChecked(true);
    options_->setCurrentIndex(static_cast<int>(tool));
    takeTool();
}

void TissuePage::takeTool() {
    const auto tool = static_cast<SliceTool>(std::max(0, tools_->checkedId()));
    for (SliceView* view : {axial_, coronal_, sagittal_})
        view->setTool(tool, tool == SliceTool::lesion ? lesionRadius_->value() : brushRadius_->value(),
                      static_cast<cases::Tissue>(brushTissue_->currentData().toInt()));
}

void TissuePage::setCross(const core::Vec3& mm) {
    crossMm_ = mm;
    for (SliceView* view : {axial_, coronal_, sagittal_})
        view->setCross(mm);
}

void TissuePage::showScan() {
    const auto scan = model().scan();
    const auto volume = scan ? std::shared_ptr<const volume::Volume>(scan->scan, &scan->scan->volume) : nullptr;
    for (SliceView* view : {axial_, coronal_, sagittal_})
        view->setScan(volume);
    if (!scan) return;
    black_ = scan->histogram.low;
    white_ = scan->histogram.high;
    for (SliceView* view : {axial_, coronal_, sagittal_})
        view->setWindow(black_, white_);
    histogram_->setHistogram(scan->histogram);
    const auto& size = volume->grid.size;
    setCross(volume->grid.toMm(core::Vec3(size[0] / 2, size[1] / 2, size[2] / 2)));
}

void TissuePage::showJob() {
    showing_ = true;
    const Settings& settings = model().job().segmentation;
    for (SliceView* view : {axial_, coronal_, sagittal_})
        view->setDecisions(settings);
    damp_->setChecked(settings.damp);
    caries_->setChecked(settings.findCaries);
    const bool labels = model().isLabels();
    for (QWidget* widget :
         {static_cast<QWidget*>(damp_), static_cast<QWidget*>(caries_), static_cast<QWidget*>(histogram_)})
        widget->setVisible(!labels);
    automatic_->setVisible(!labels);
    automatic_->setEnabled(settings.thresholds.has_value());
    tooth_->setTooth(model().job().placing.fdiNumber);
    const auto rows = decisionRows(settings);
    const int at = decisions_->currentRow();
    decisions_->clear();
    for (const DecisionRow& row : rows)
        decisions_->addItem(row.text);
    decisions_->setCurrentRow(std::min(at < 0 ? decisions_->count() - 1 : at, decisions_->count() - 1));
    if (rows.empty()) {
        remove_->setEnabled(false);
        flip_->setEnabled(false);
    }
    const auto preview = model().preview();
    if (settings.thresholds)
        histogram_->setThresholds(settings.thresholds, true);
    else if (preview && preview->result.region)
        histogram_->setThresholds(preview->result.region->thresholds, false);
    showing_ = false;
}

void TissuePage::showPreview() {
    const auto preview = model().preview();
    const auto region = preview ? preview->result.region : nullptr;
    for (SliceView* view : {axial_, coronal_, sagittal_})
        view->setRegion(region);
    solid_->setParts(preview ? std::shared_ptr<const std::vector<cases::Part>>(preview, &preview->parts) : nullptr,
                     preview ? preview->bounds : core::Box());
    showJob();
    if (!region) {
        volumes_->setText(tr("Nothing yet"));
        notes_->clear();
        return;
    }
    QString table = QStringLiteral("<table cellspacing='2'>");
    double sum = 0.0;
    for (const cases::Tissue tissue : {cases::Tissue::enamel, cases::Tissue::dentine, cases::Tissue::pulp,
                                       cases::Tissue::caries, cases::Tissue::restoration}) {
        const double volume = preview->result.volumesMm3[static_cast<std::size_t>(tissue)];
        sum += volume;
        if (volume <= 0) continue;
        table += QStringLiteral("<tr><td>%1%2</td><td align='right'>&nbsp;%3</td></tr>")
                     .arg(swatchHtml(tissue), tissueName(tissue), quantity(volume, 1, tr("mm³")));
    }
    table += QStringLiteral("<tr><td>%1</td><td align='right'>&nbsp;%2</td></tr></table>")
                 .arg(tr("Together"), quantity(sum, 1, tr("mm³")));
    volumes_->setText(table);
    QStringList notes;
    for (const std::string& text : preview->result.toothNotes)
        notes << QString::fromStdString(text);
    for (const std::string& text : region->notes)
        notes << QString::fromStdString(text);
    notes_->setText(notes.join(QLatin1Char('\n')));
    notes_->setVisible(!notes.isEmpty());
}

void TissuePage::addCut(const core::Vec3& from, const core::Vec3& to, const core::Vec3& sliceNormal) {
    core::Vec3 normal = (to - from).cross(sliceNormal).normalized();
    // What is wanted lies where the tooth was picked, or where most of what was found lies.
    core::Vec3 kept = crossMm_;
    if (model().job().segmentation.toothAtMm)
        kept = *model().job().segmentation.toothAtMm;
    else if (const auto preview = model().preview(); preview && !preview->bounds.isEmpty())
        kept = preview->result.placed.scanInTooth.applyInverse(preview->bounds.centre());
    if ((kept - from).dot(normal) > 0) normal = -normal;
    decide([&](scan_case::ScanJob& job) { job.segmentation.cutPlanes.push_back({0.5 * (from + to), normal}); });
}

void TissuePage::removeChosen() {
    const auto rows = decisionRows(model().job().segmentation);
    const int at = decisions_->currentRow();
    if (at < 0 || static_cast<std::size_t>(at) >= rows.size()) return;
    const DecisionRow& row = rows[static_cast<std::size_t>(at)];
    decide([&](scan_case::ScanJob& job) {
        Settings& s = job.segmentation;
        const auto first = static_cast<std::ptrdiff_t>(row.first), count = static_cast<std::ptrdiff_t>(row.count);
        switch (row.kind) {
            case DecisionRow::Kind::tooth:
                s.toothAtMm.reset();
                break;
            case DecisionRow::Kind::marks:
                s.marks.erase(s.marks.begin() + first, s.marks.begin() + first + count);
                break;
            case DecisionRow::Kind::cut:
                s.cutPlanes.erase(s.cutPlanes.begin() + first);
                break;
            case DecisionRow::Kind::lesion:
                s.lesions.erase(s.lesions.begin() + first);
                break;
        }
    });
}

void TissuePage::flipChosen() {
    const auto rows = decisionRows(model().job().segmentation);
    const int at = decisions_->currentRow();
    if (at < 0 || static_cast<std::size_t>(at) >= rows.size()) return;
    const DecisionRow& row = rows[static_cast<std::size_t>(at)];
    if (row.kind != DecisionRow::Kind::cut) return;
    decide([&](scan_case::ScanJob& job) {
        core::Vec3& normal = job.segmentation.cutPlanes[row.first].normal;
        normal = -normal;
    });
}

}  // namespace handpiece::desktop
