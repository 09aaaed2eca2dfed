// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/radiograph/radiograph_dialog.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QImage>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "desktop/widgets/parts.h"
#include "handpiece/app/simulation/tissue_export.h"

namespace handpiece::desktop {

using radiograph::View;

RadiographDialog::RadiographDialog(QWidget* parent)
    : QDialog(parent),
      view_(named(new QComboBox(this), "radiographView", tr("View"))),
      tooth_(named(new QComboBox(this), "radiographTooth", tr("Tooth"), tr("FDI number of the tooth in the middle"))),
      picture_(named(new QLabel(this), "radiographPicture", tr("Radiograph"))),
      note_(named(new QLabel(this), "radiographNote", tr("About the radiograph"))),
      progress_(named(new QProgressBar(this), "radiographProgress", tr("Taking the radiograph"))),
      cancel_(named(new QPushButton(tr("Cancel"), this), "radiographCancel", tr("Cancel"))),
      again_(named(new QPushButton(tr("Take again"), this), "radiographAgain", tr("Take again"),
                   tr("Of the teeth as they are cut now"))),
      save_(named(new QPushButton(tr("Save..."), this), "radiographSave", tr("Save..."),
                  tr("Write the radiograph as PNG or DICOM, marked as simulated"))) {
    setObjectName(QStringLiteral("radiographDialog"));
    setWindowTitle(tr("Radiograph (simulated)"));
    view_->addItem(tr("Bitewing"), static_cast<int>(View::bitewing));
    view_->addItem(tr("Periapical"), static_cast<int>(View::periapical));
    picture_->setAlignment(Qt::AlignCenter);
    picture_->setMinimumSize(320, 240);
    picture_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Ignored);
    note_->setWordWrap(true);
    progress_->setRange(0, 1000);
    progress_->setTextVisible(false);

    auto* above = new QHBoxLayout;
    above->addWidget(view_);
    above->addWidget(tooth_);
    above->addStretch();
    above->addWidget(again_);
    above->addWidget(save_);
    auto* below = new QHBoxLayout;
    below->addWidget(progress_);
    below->addWidget(cancel_);
    auto* column = new QVBoxLayout(this);
    column->addLayout(above);
    column->addWidget(picture_, 1);
    column->addLayout(below);
    column->addWidget(note_);
    resize(760, 660);

    connect(view_, &QComboBox::activated, this, &RadiographDialog::take);
    connect(tooth_, &QComboBox::activated, this, &RadiographDialog::take);
    connect(again_, &QPushButton::clicked, this, &RadiographDialog::take);
    connect(cancel_, &QPushButton::clicked, this, [this] { stop(tr("Cancelled. Choose a view to take it again.")); });
    connect(save_, &QPushButton::clicked, this, &RadiographDialog::saveRequested);
    stop({});
}

void RadiographDialog::setTooth(std::shared_ptr<const cases::Case> toothCase,
                                std::shared_ptr<const simulation::LiveTooth> live,
                                std::function<tooth::StateDelta()> state) {
    if (toothCase == toothCase_ && live == live_) return;
    stop({});
    toothCase_ = std::move(toothCase);
    live_ = std::move(live);
    state_ = std::move(state);
    tooth_->clear();
    if (toothCase_ != nullptr) {
        const auto add = [this](int fdi) {
            if (fdi != 0 && tooth_->findData(fdi) < 0) tooth_->addItem(QString::number(fdi), fdi);
        };
        add(toothCase_->fdiNumber);
        for (const cases::PlacedTooth& other : toothCase_->others)
            add(other.fdiNumber);
    }
    tooth_->setVisible(tooth_->count() > 1);
    if (isVisible()) take();
}

void RadiographDialog::take() {
    stop({});
    if (toothCase_ == nullptr) return;
    radiograph::Settings settings;
    settings.view = static_cast<View>(view_->currentData().toInt());
    settings.fdiNumber = tooth_->currentData().toInt();
    const auto made = std::make_shared<std::optional<radiograph::Radiograph>>();
    job_ = new Job(
        tr("Taking the radiograph"),
        [of = toothCase_, live = live_, state = live_ ? state_() : tooth::StateDelta{}, settings,
         made](const core::Progress& p) {
            const core::Progress whole = core::part(p, 0.3, 1.0);
            *made = live == nullptr
                        ? radiograph::take(*of, settings, whole)
                        : radiograph::take(simulation::asCut(*of, live->teeth(), state, core::part(p, 0.0, 0.3)),
                                           settings, whole);
        },
        this);
    connect(job_, &Job::progressed, this, [this](double share) { progress_->setValue(qRound(1000.0 * share)); });
    connect(job_, &Job::done, this, [this, made] {
        stop(tr("Computed from the teeth as they are cut now: for learning, not for diagnosis."));
        taken_ = std::move(*made);
        save_->setEnabled(true);
        showPicture();
    });
    connect(job_, &Job::failed, this, [this](const Problem& problem) {
        stop(problem.remedy.isEmpty() ? problem.what : problem.what + QStringLiteral(" ") + problem.remedy);
    });
    progress_->setVisible(true);
    cancel_->setVisible(true);
    job_->start();
}

/// No picture, and none under way.
void RadiographDialog::stop(const QString& note) {
    // It may be what is telling us.
    if (job_ != nullptr) std::exchange(job_, nullptr)->abandon(this);
    taken_.reset();
    picture_->clear();
    save_->setEnabled(false);
    progress_->setValue(0);
    progress_->setVisible(false);
    cancel_->setVisible(false);
    note_->setText(note);
}

void RadiographDialog::showPicture() {
    if (!taken_) return;
    const radiograph::Picture& p = taken_->picture;
    const QImage image(reinterpret_cast<const uchar*>(p.grey.data()), p.width, p.height,
                       p.width * static_cast<qsizetype>(sizeof(std::uint16_t)), QImage::Format_Grayscale16);
    const double scale = picture_->devicePixelRatioF();
    QPixmap shown =
        QPixmap::fromImage(image.convertToFormat(QImage::Format_Grayscale8)
                               .scaled(picture_->size() * scale, Qt::KeepAspectRatio, Qt::SmoothTransformation));
    shown.setDevicePixelRatio(scale);
    picture_->setPixmap(shown);
}

void RadiographDialog::showEvent(QShowEvent* event) {
    QDialog::showEvent(event);
    take();  // the teeth may have been cut since
}

void RadiographDialog::hideEvent(QHideEvent* event) {
    QDialog::hideEvent(event);
    if (job_ != nullptr) stop({});
}

void RadiographDialog::resizeEvent(QResizeEvent* event) {
    QDialog::resizeEvent(event);
    showPicture();
}

}  // namespace handpiece::desktop
