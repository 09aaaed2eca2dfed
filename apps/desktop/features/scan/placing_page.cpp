// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/placing_page.h"

#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QPushButton>
#include <QScrollArea>
#include <QVBoxLayout>
#include <cmath>

#include "desktop/features/scan/fdi_picker.h"
#include "desktop/picture/solid_view.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {
namespace {

constexpr double kQuarter = 1.5707963267948966, kDegree = kQuarter / 90.0;

}  // namespace

int buccalSignOf(int fdi) {
    switch (fdi / 10) {
        case 1:
        case 3:
        case 5:
        case 7:
            return 1;
        case 2:
        case 4:
        case 6:
        case 8:
            return -1;
        default:
            return 0;
    }
}

PlacingPage::PlacingPage(ScanModel& model, QWidget* parent) : ScanPage(model, parent) {
    setObjectName(QStringLiteral("scanPlacing"));
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(0, 0, 0, 0);
    row->setSpacing(14);
    auto* scroll = new QScrollArea(this);
    scroll->setObjectName(QStringLiteral("scanPlacingScroll"));
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    auto* left = new QWidget;
    auto* column = new QVBoxLayout(left);
    column->setContentsMargins(0, 0, 8, 0);
    column->setSpacing(8);

    column->addWidget(heading(tr("What is the case called?"), left));
    name_ = named(new QLineEdit(left), "scanName", tr("Name of the case"), tr("Students see it. No patient's name"));
    name_->setPlaceholderText(tr("for example: Molar with deep caries"));
    name_->setMaxLength(80);
    column->addWidget(name_);
    column->addWidget(note(tr("Students see it. It is never taken from the scan: no name of a patient here."), left));
    column->addSpacing(6);
    column->addWidget(heading(tr("Which tooth is it?"), left));
    tooth_ = new FdiPicker(QStringLiteral("scanFdi"), left);
    column->addWidget(tooth_);
    column->addSpacing(6);
    column->addWidget(heading(tr("Which way is up?"), left));
    advice_ = note({}, left, "scanPlacingAdvice");
    column->addWidget(advice_);
    confidence_ = new QLabel(left);
    confidence_->setObjectName(QStringLiteral("scanConfidence"));
    confidence_->setWordWrap(true);
    column->addWidget(confidence_);
    auto* grid = new QGridLayout;
    grid->setSpacing(5);
    const auto button = [&](int r, int c, int wide, const char* name, const char* symbol, const QString& text,
                            const QString& tip, const core::Vec3& axis, double rad) {
        auto* made = named(new QPushButton(text, left), name, text, tip);
        if (*symbol) made->setIcon(icon(QLatin1String(symbol)));
        grid->addWidget(made, r, c, 1, wide);
        connect(made, &QPushButton::clicked, this, [this, axis, rad] { turn(axis, rad); });
    };
    const core::Vec3 x = core::Vec3::UnitX(), y = core::Vec3::UnitY(), z = core::Vec3::UnitZ();
    button(0, 0, 2, "scanUpsideDown", "replay", tr("Upside down"), tr("The crown is where the roots are shown"), x,
           2 * kQuarter);
    button(1, 0, 2, "scanMesialOther", "compare", tr("Mesial is on the other side"),
           tr("Turn by half about the long axis"), z, 2 * kQuarter);
    button(2, 0, 1, "scanTurnLeft", "undo", tr("Turn 90° left"), tr("Seen from above"), z, kQuarter);
    button(2, 1, 1, "scanTurnRight", "redo", tr("Turn 90° right"), tr("Seen from above"), z, -kQuarter);
    button(3, 0, 1, "scanTurnLeftLittle", "", tr("5° left"), tr("Turn a little, seen from above"), z, 5 * kDegree);
    button(3, 1, 1, "scanTurnRightLittle", "", tr("5° right"), tr("Turn a little, seen from above"), z, -5 * kDegree);
    button(4, 0, 1, "scanTipMesial", "", tr("Tip 5° to mesial"), tr("The crown goes towards mesial"), y, 5 * kDegree);
    button(4, 1, 1, "scanTipDistal", "", tr("Tip 5° to distal"), tr("The crown goes towards distal"), y, -5 * kDegree);
    button(5, 0, 1, "scanTipSide", "", tr("Tip 5° to the side"), tr("The crown goes towards the green arrow"), x,
           -5 * kDegree);
    button(5, 1, 1, "scanTipBack", "", tr("Tip 5° back"), tr("The crown goes away from the green arrow"), x,
           5 * kDegree);
    column->addLayout(grid);
    again_ = named(new QPushButton(icon(QStringLiteral("reset")), tr("As the program found it"), left),
                   "scanPlaceAgain", tr("Forget all turning by hand"));
    column->addWidget(again_);
    column->addStretch(1);
    scroll->setWidget(left);
    scroll->setMinimumWidth(330);
    scroll->setMaximumWidth(400);
    row->addWidget(scroll);

    auto* right = new QVBoxLayout;
    solid_ = new SolidView("scanPlacingSolid", this);
    right->addWidget(solid_, 1);
    auto* eyes = new QHBoxLayout;
    const struct {
        const char *name, *icon;
        QString text;
        view::StandardView view;
    } kEyes[] = {{"scanEyeOcclusal", "view-occlusal", tr("From occlusal"), view::StandardView::occlusal},
                 {"scanEyeBuccal", "view-buccal", tr("From buccal"), view::StandardView::buccal},
                 {"scanEyeMesial", "view-mesial", tr("From mesial"), view::StandardView::mesial},
                 {"scanEyeOblique", "view-oblique", tr("Oblique"), view::StandardView::oblique}};
    for (const auto& eye : kEyes) {
        auto* made = named(new QPushButton(icon(QLatin1String(eye.icon)), eye.text, this), eye.name, eye.text);
        connect(made, &QPushButton::clicked, this, [this, from = eye.view] {
            const int fdi = this->model().job().placing.fdiNumber;
            solid_->lookFrom(from, view::standingOf(fdi, buccalSignOf(fdi)));
        });
        eyes->addWidget(made);
    }
    eyes->addStretch(1);
    right->addLayout(eyes);
    row->addLayout(right, 1);

    connect(name_, &QLineEdit::textEdited, this, [this](const QString& text) {
        decide([&](scan_case::ScanJob& job) { job.name = text.toStdString(); }, QStringLiteral("name"));
    });
    connect(tooth_, &FdiPicker::toothChosen, this,
            [this](int fdi) { decide([&](scan_case::ScanJob& job) { job.placing.fdiNumber = fdi; }); });
    connect(again_, &QPushButton::clicked, this, [this] {
        decide([](scan_case::ScanJob& job) {
            job.placing.occlusal.reset();
            job.placing.mesial.reset();
        });
    });
    connect(&model, &ScanModel::decided, this, &PlacingPage::showJob);
    for (const auto signal : {&ScanModel::previewReady, &ScanModel::fullReady, &ScanModel::workChanged})
        connect(&model, signal, this, &PlacingPage::showResult);
    showJob();
    showResult();
}

QString PlacingPage::missing() const {
    return QString::fromStdString(model().job().name).trimmed().isEmpty() ? tr("Give the case a name") : QString();
}

void PlacingPage::turn(const core::Vec3& axis, double rad) {
    const auto best = model().best();
    if (!best) return;
    // The axes that the tooth shall have, in the scanner's frame: those it has, turned the other way about.
    const core::Quat inScan = best->result.placed.scanInTooth.orientation.conjugate();
    const core::Mat3 back = Eigen::AngleAxisd(-rad, axis).toRotationMatrix();
    const core::Vec3 occlusal = inScan * (back * core::Vec3::UnitZ()), mesial = inScan * (back * core::Vec3::UnitX());
    decide([&](scan_case::ScanJob& job) {
        job.placing.occlusal = occlusal;
        job.placing.mesial = mesial;
    });
}

void PlacingPage::showJob() {
    const scan_case::ScanJob& job = model().job();
    const QString name = QString::fromStdString(job.name);
    if (name_->text() != name) name_->setText(name);
    tooth_->setTooth(job.placing.fdiNumber);
    again_->setEnabled(job.placing.occlusal || job.placing.mesial);
    showResult();
}

void PlacingPage::showResult() {
    const auto best = model().best();
    const int sign = buccalSignOf(model().job().placing.fdiNumber);
    solid_->setParts(best ? std::shared_ptr<const std::vector<cases::Part>>(best, &best->parts) : nullptr,
                     best ? best->bounds : core::Box());
    solid_->setAxesShown(true, sign);
    const bool fresh = model().isPreviewFresh() || model().isFullFresh();
    solid_->setCaption(fresh || !best ? QString() : tr("Being turned"), !fresh);
    advice_->setText(sign == 0 ? tr("The blue arrow goes out of the crown, the red one towards the midline of the "
                                    "mouth. Say which tooth it is, and the sides get their names.")
                               : tr("The blue arrow goes out of the crown, the red one towards the midline of the "
                                    "mouth. Are the sides wrong, then mesial is on the other side, or it is the other "
                                    "side's tooth."));
    if (!best) {
        confidence_->clear();
        return;
    }
    const registration::Placed& placed = best->result.placed;
    QStringList lines;
    if (model().job().placing.occlusal)
        lines << tr("Turned by hand.");
    else
        lines << (placed.confidence >= 0.75  ? tr("The program is sure which way is up.")
                  : placed.confidence >= 0.4 ? tr("The program is fairly sure which way is up: have a look.")
                                             : tr("The program guessed which way is up: have a look."));
    if (placed.isMesialGuessed && placed.notes.empty()) lines << tr("Which side is mesial is a guess.");
    for (const std::string& text : placed.notes)
        lines << QString::fromStdString(text);
    confidence_->setText(lines.join(QLatin1Char('\n')));
}

}  // namespace handpiece::desktop
