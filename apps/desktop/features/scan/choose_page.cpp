// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/choose_page.h"

#include <QCheckBox>
#include <QDragEnterEvent>
#include <QFileInfo>
#include <QFormLayout>
#include <QFrame>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QMimeData>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QUrl>
#include <QVBoxLayout>

#include "desktop/features/scan/reading_fields.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {
namespace {

constexpr int kThumbnail = 72, kPicture = 260;
constexpr double kOddMm = 0.6;  // no scanner for teeth is so coarse

QImage pictureOf(const volume::Series& series) {
    if (series.thumbnail.empty() || series.thumbnailSize[0] <= 0) return {};
    return QImage(series.thumbnail.data(), series.thumbnailSize[0], series.thumbnailSize[1], series.thumbnailSize[0],
                  QImage::Format_Grayscale8)
        .copy();
}

QString spacingOf(const volume::Series& series) {
    if (!series.isSpacingKnown) return ChoosePage::tr("size of a voxel not told");
    const auto text = [](double mm) { return QLocale().toString(mm, 'g', 4); };
    const core::Vec3& s = series.spacingMm;
    return std::abs(s.x() - s.y()) < 1e-6 && std::abs(s.x() - s.z()) < 1e-6
               ? ChoosePage::tr("voxels of %1 mm").arg(text(s.x()))
               : ChoosePage::tr("voxels of %1 × %2 × %3 mm").arg(text(s.x()), text(s.y()), text(s.z()));
}

QString sizeOf(const volume::Series& series) {
    return QStringLiteral("%1 × %2 × %3").arg(series.size[0]).arg(series.size[1]).arg(series.size[2]);
}

}  // namespace

ChoosePage::ChoosePage(ScanModel& model, ScanQuestions& questions, QWidget* parent)
    : ScanPage(model, parent), questions_(questions) {
    setObjectName(QStringLiteral("scanChoose"));
    setAcceptDrops(true);
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(12);

    drop_ = new QFrame(this);
    drop_->setObjectName(QStringLiteral("scanDrop"));
    drop_->setFrameShape(QFrame::StyledPanel);
    auto* inDrop = new QHBoxLayout(drop_);
    inDrop->setContentsMargins(20, 18, 20, 18);
    inDrop->setSpacing(18);
    auto* symbol = new QLabel(drop_);
    symbol->setPixmap(icon(QStringLiteral("open")).pixmap(36, 36));
    inDrop->addWidget(symbol);
    auto* words = new QVBoxLayout;
    dropText_ = new QLabel(tr("Drop a folder of slices, a ZIP or a file here"), drop_);
    dropText_->setFont(scaledFont(font(), 1.25, true));
    words->addWidget(dropText_);
    source_ =
        note(tr("DICOM, slices as TIFF, PNG, JPEG or BMP, NRRD, NIfTI, MetaImage, raw with a description. Names of "
                "patients stay in the scan: nothing of them goes into the case."),
             drop_, "scanSource");
    words->addWidget(source_);
    inDrop->addLayout(words, 1);
    auto* buttons = new QVBoxLayout;
    auto* folder = named(new QPushButton(icon(QStringLiteral("open")), tr("Folder..."), drop_), "scanFolder",
                         tr("Choose a folder of slices"));
    auto* file = named(new QPushButton(icon(QStringLiteral("file")), tr("File..."), drop_), "scanFile",
                       tr("Choose a file or a ZIP"));
    buttons->addWidget(folder);
    buttons->addWidget(file);
    inDrop->addLayout(buttons);
    column->addWidget(drop_);

    found_ = new QWidget(this);
    auto* row = new QHBoxLayout(found_);
    row->setContentsMargins(0, 0, 0, 0);
    row->setSpacing(12);
    list_ = named(new QListWidget(this), "scanSeries", tr("What was found"), tr("Choose the scan of the tooth"));
    list_->setIconSize({kThumbnail, kThumbnail});
    list_->setSpacing(3);
    list_->setUniformItemSizes(true);
    list_->setWordWrap(true);
    row->addWidget(list_, 2);

    auto* scroll = new QScrollArea(this);
    scroll->setObjectName(QStringLiteral("scanDetailsScroll"));
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    details_ = new QFrame;
    details_->setObjectName(QStringLiteral("scanDetails"));
    auto* across = new QHBoxLayout(details_);
    across->setContentsMargins(0, 0, 4, 0);
    across->setSpacing(18);
    picture_ = new QLabel(details_);
    picture_->setObjectName(QStringLiteral("scanPicture"));
    picture_->setAccessibleName(tr("The middle slice"));
    across->addWidget(picture_, 0, Qt::AlignTop);
    auto* inDetails = new QVBoxLayout;
    inDetails->setSpacing(10);
    across->addLayout(inDetails, 1);
    what_ = new QLabel(details_);
    what_->setObjectName(QStringLiteral("scanWhat"));
    what_->setWordWrap(true);
    inDetails->addWidget(what_);
    notes_ = new QLabel(details_);
    notes_->setObjectName(QStringLiteral("scanNotes"));
    notes_->setWordWrap(true);
    notes_->setTextFormat(Qt::PlainText);
    inDetails->addWidget(notes_);

    reverse_ = named(new QCheckBox(tr("Read the slices from the other end"), details_), "scanReverse",
                     tr("The slices are numbered from the other end"),
                     tr("For a tooth that came out as its mirror image: where the files do not tell, nobody can see it "
                        "in the numbers"));
    inDetails->addWidget(reverse_);

    spacingBox_ = new QFrame(details_);
    spacingBox_->setObjectName(QStringLiteral("scanSpacing"));
    auto* inSpacing = new QVBoxLayout(spacingBox_);
    inSpacing->setContentsMargins(0, 0, 0, 0);
    inSpacing->addWidget(heading(tr("How large is a voxel?"), spacingBox_));
    spacingWhy_ = note({}, spacingBox_, "scanSpacingWhy");
    inSpacing->addWidget(spacingWhy_);
    auto* form = new QFormLayout;
    const auto spin = [this](const char* name, const QString& accessible) {
        auto* box = named(new DecimalField(spacingBox_), name, accessible);
        box->setDecimals(4);
        box->setRange(0.0, 5.0);
        box->setSingleStep(0.01);
        box->setSuffix(tr(" mm"));
        box->setSpecialValueText(tr("not said yet"));
        box->setMaximumWidth(160);
        connect(box, &DecimalField::valueChanged, this, [this] { takeSpacing(); });
        return box;
    };
    within_ = spin("scanSpacingWithin", tr("Between pixels of a slice"));
    between_ = spin("scanSpacingBetween", tr("Between slices"));
    form->addRow(tr("Between pixels of a slice"), within_);
    form->addRow(tr("Between slices"), between_);
    inSpacing->addLayout(form);
    estimate_ = named(new QPushButton(icon(QStringLiteral("measure")), tr("Estimate by a mean molar"), spacingBox_),
                      "scanEstimate", tr("The size at which the tooth is as long as a mean first molar, 21 mm"));
    inSpacing->addWidget(estimate_, 0, Qt::AlignLeft);
    molar_ = note({}, spacingBox_, "scanMolar");
    inSpacing->addWidget(molar_);
    inDetails->addWidget(spacingBox_);

    reading_ = new ReadingFields(model, questions, details_);
    inDetails->addWidget(reading_);
    inDetails->addStretch(1);
    scroll->setWidget(details_);
    row->addWidget(scroll, 5);
    column->addWidget(found_, 1);
    way_ =
        new QLabel(tr("<ol><li>Choose the scan.</li><li>See which tissues were found in it; correct by hand where the "
                      "program is wrong.</li><li>Say how fine the surfaces shall be.</li><li>Say which way is up, and "
                      "give the case a name.</li><li>Read how good it is, save it, try it.</li></ol>"),
                   this);
    way_->setTextFormat(Qt::RichText);
    way_->setObjectName(QStringLiteral("scanWay"));
    way_->setWordWrap(true);
    way_->setAlignment(Qt::AlignTop);
    way_->setFont(scaledFont(font(), 1.08));
    column->addWidget(way_, 1);

    connect(folder, &QPushButton::clicked, this, [this] { take(questions_.folder(tr("A folder of slices"))); });
    connect(file, &QPushButton::clicked, this, [this] {
        take(questions_.fileToOpen(tr("A scan"), tr("Scans (*.nrrd *.nhdr *.nii *.nii.gz *.mha *.mhd *.zip *.dcm *.tif "
                                                    "*.tiff *.toml DICOMDIR);;All files (*)")));
    });
    connect(list_, &QListWidget::currentRowChanged, this, [this](int at) {
        if (showing_ || at < 0 || static_cast<std::size_t>(at) >= this->model().series().size()) return;
        decide([&](scan_case::ScanJob& job) {
            job.series = this->model().series()[static_cast<std::size_t>(at)].id;
            job.spacingMm.reset();
            job.reverseSlices = false;
            job.regionMm.reset();
        });
    });
    connect(reverse_, &QCheckBox::toggled, this, [this](bool on) {
        if (!showing_) decide([on](scan_case::ScanJob& job) { job.reverseSlices = on; });
    });
    connect(estimate_, &QPushButton::clicked, this, [this] { this->model().estimateSpacing(); });
    connect(&model, &ScanModel::spacingEstimated, this, [this] {
        if (const auto mm = this->model().molarSpacingMm())
            decide([&](scan_case::ScanJob& job) { job.spacingMm = *mm; });
        showDetails();
    });
    connect(&model, &ScanModel::seriesFound, this, &ChoosePage::showSeries);
    connect(&model, &ScanModel::decided, this, &ChoosePage::showJob);
    connect(&model, &ScanModel::scanRead, this, &ChoosePage::showDetails);
    showSeries();
    showJob();
}

QString ChoosePage::missing() const {
    if (model().job().source.empty()) return tr("Choose a scan first");
    if (!model().isSeriesKnown()) return tr("Nothing was found yet");
    if (!model().chosenSeries()) return tr("Choose one of the scans");
    if (model().isSpacingAsked()) return tr("Say how large a voxel is");
    return {};
}

void ChoosePage::take(const QString& path) {
    if (path.isEmpty()) return;
    // A description stands for the scan that it describes.
    std::filesystem::path source = toPath(path);
    if (source.filename() == "scan.toml") source = source.parent_path();
    if (source == model().job().source) {
        model().tryAgain();
        return;
    }
    scan_case::ScanJob job;
    job.name.clear();
    job.source = source;
    model().decide(job);
}

void ChoosePage::dragEnterEvent(QDragEnterEvent* event) {
    const QList<QUrl> urls = event->mimeData()->urls();
    if (urls.size() != 1 || !urls.front().isLocalFile()) return;
    event->acceptProposedAction();
    drop_->setBackgroundRole(QPalette::Highlight);
    drop_->setAutoFillBackground(true);
}

void ChoosePage::dragLeaveEvent(QDragLeaveEvent* event) {
    drop_->setAutoFillBackground(false);
    ScanPage::dragLeaveEvent(event);
}

void ChoosePage::dropEvent(QDropEvent* event) {
    drop_->setAutoFillBackground(false);
    const QList<QUrl> urls = event->mimeData()->urls();
    if (urls.isEmpty()) return;
    event->acceptProposedAction();
    take(urls.front().toLocalFile());
}

void ChoosePage::showSeries() {
    showing_ = true;
    list_->clear();
    int chosen = -1;
    for (const volume::Series& series : model().series()) {
        const QString first =
            QString::fromStdString(series.format) +
            (series.modality.empty() ? QString() : QStringLiteral(", ") + QString::fromStdString(series.modality));
        auto* item = new QListWidgetItem(
            first + QLatin1Char('\n') + sizeOf(series) + QLatin1Char('\n') + spacingOf(series), list_);
        if (const QImage image = pictureOf(series); !image.isNull())
            item->setIcon(QPixmap::fromImage(
                image.scaled(kThumbnail, kThumbnail, Qt::KeepAspectRatio, Qt::SmoothTransformation)));
        if (&series == model().chosenSeries()) chosen = list_->count() - 1;
    }
    list_->setCurrentRow(chosen);
    showing_ = false;
    // Of several the largest is meant more often than not; it can be changed.
    if (chosen < 0 && model().series().size() > 1 && model().job().series.empty()) list_->setCurrentRow(0);
    showDetails();
}

void ChoosePage::showDetails() {
    reading_->showJob();  // whether they are labels is known once they are read
    showing_ = true;
    const volume::Series* series = model().chosenSeries();
    details_->setVisible(series != nullptr);
    list_->setVisible(model().series().size() > 1);
    found_->setVisible(!model().series().empty());
    way_->setVisible(model().series().empty());
    if (series) {
        const QImage image = pictureOf(*series);
        picture_->setVisible(!image.isNull());
        if (!image.isNull())
            picture_->setPixmap(
                QPixmap::fromImage(image.scaled(kPicture, kPicture, Qt::KeepAspectRatio, Qt::SmoothTransformation)));
        QStringList lines{tr("%1, %2 voxels, %3 bits each")
                              .arg(QString::fromStdString(series->format), sizeOf(*series))
                              .arg(series->bits),
                          spacingOf(*series)};
        if (model().job().spacingMm) lines.back() += tr("; another size was given by hand");
        if (const auto scan = model().scan()) {
            const volume::Grid& g = scan->scan->volume.grid;
            const auto mm = [&](int a) {
                return QLocale().toString(g.size[static_cast<std::size_t>(a)] * g.spacingMm[a], 'f', 1);
            };
            lines << tr("%1 × %2 × %3 mm, read").arg(mm(0), mm(1), mm(2));
        }
        what_->setText(lines.join(QLatin1Char('\n')));
        QStringList notes;
        // What was read says more than what was found: how, for instance, it was made to fit.
        for (const std::string& text : model().scan() ? model().scan()->scan->series.notes : series->notes)
            notes << QStringLiteral("•  ") + QString::fromStdString(text);
        if (model().scan() && model().scan()->labelKey)
            for (const std::string& text : model().scan()->labelKey->notes)
                notes << QStringLiteral("•  ") + QString::fromStdString(text);
        notes_->setText(notes.join(QLatin1Char('\n')));
        notes_->setVisible(!notes.isEmpty());
        reverse_->setVisible(series->slices > 1);
        // Many programs write 1 mm where they know nothing.
        const bool isOdd = series->isSpacingKnown && series->spacingMm.maxCoeff() >= kOddMm;
        spacingWhy_->setText(
            !series->isSpacingKnown ? tr("The scan does not tell it, and every millimetre depends on it. The scanner's "
                                         "record or report has it.")
            : isOdd
                ? tr("The scan says so, but it is too coarse for a tooth: some programs write 1 mm when they do not "
                     "know. The scanner's record or report has it.")
                : tr("The scan tells it. Change it only when you know better."));
        const core::Vec3 now =
            model().job().spacingMm.value_or(series->isSpacingKnown ? series->spacingMm : core::Vec3::Zero());
        within_->setValue(now.x());
        between_->setValue(now.z());
        estimate_->setVisible(!series->isSpacingKnown || isOdd);
        molar_->setVisible(!series->isSpacingKnown || isOdd);
        const auto mm = model().molarSpacingMm();
        molar_->setText(mm ? tr("With %1 mm the tooth is 21 mm long, as a mean first molar is. Teeth differ: every "
                                "millimetre of this case will be a guess.")
                                 .arg(QLocale().toString(mm->x(), 'f', 3))
                           : tr("If you do not know it and the tooth is a molar, a mean one can stand in for it."));
    }
    showing_ = false;
}

void ChoosePage::showJob() {
    showing_ = true;
    reverse_->setChecked(model().job().reverseSlices);
    const auto& source = model().job().source;
    dropText_->setText(source.empty()
                           ? tr("Drop a folder of slices, a ZIP or a file here")
                           : toQString(source.has_filename() ? source.filename() : source.parent_path().filename()));
    for (int row = 0; row < list_->count(); ++row)
        if (static_cast<std::size_t>(row) < model().series().size() &&
            &model().series()[static_cast<std::size_t>(row)] == model().chosenSeries())
            list_->setCurrentRow(row);
    showing_ = false;
    showDetails();
}

void ChoosePage::takeSpacing() {
    if (showing_) return;
    const double within = within_->value();
    // Most scans have cubes for voxels: the second follows the first until it is said.
    if (between_->value() <= 0) {
        const QSignalBlocker quiet(between_);
        between_->setValue(within);
    }
    const double between = between_->value();
    decide([&](scan_case::ScanJob& job) {
        if (within > 0 && between > 0)
            job.spacingMm = core::Vec3(within, within, between);
        else
            job.spacingMm.reset();
    });
}

}  // namespace handpiece::desktop
