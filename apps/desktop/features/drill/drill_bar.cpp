// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/drill/drill_bar.h"

#include <QButtonGroup>
#include <QComboBox>
#include <QHBoxLayout>
#include <QLineEdit>
#include <QListView>
#include <QPainter>
#include <QPushButton>
#include <QRadioButton>
#include <QScrollBar>
#include <QSignalBlocker>
#include <QSlider>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "desktop/features/drill/bur_list.h"
#include "desktop/features/drill/speed_dial.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"
#include "desktop/work/bur_words.h"

namespace handpiece::desktop {

namespace {

/// The bur in hand, lying as if it were in front of one.
class BurCard : public QWidget {
  public:
    using QWidget::QWidget;
    void setFace(const BurFace& face) {
        face_ = face;
        update();
    }
    [[nodiscard]] QSize sizeHint() const override { return {48, 92}; }

  protected:
    void paintEvent(QPaintEvent*) override {
        QPainter painter(this);
        paintBur(painter, QRectF(rect()).adjusted(4, 3, -4, -3), face_, palette());
    }

  private:
    BurFace face_;
};

double speedStep(double freeRpm) {
    return freeRpm >= 100000 ? 1000 : 100;
}

}  // namespace

DrillBar::DrillBar(QWidget* parent) : QWidget(parent) {
    setObjectName("drillBar");
    setAccessibleName(tr("Handpiece"));
    auto* column = new QVBoxLayout(this);
    column->setSpacing(6);

    auto* inHand = new QHBoxLayout;
    card_ = new BurCard(this);
    card_->setObjectName("burInHandPicture");
    card_->setFixedSize(48, 92);
    inHand->addWidget(card_);
    auto* words = new QVBoxLayout;
    words->addStretch(1);
    words->addWidget(note(tr("Bur in hand"), this));
    burName_ = named(new QLabel(this), "burInHand", tr("Bur in hand"));
    burName_->setFont(scaledFont(font(), 1.5, true));
    words->addWidget(burName_);
    burText_ = note({}, this, "burInHandText");
    words->addWidget(burText_);
    words->addStretch(1);
    inHand->addLayout(words, 1);
    column->addLayout(inHand);

    auto* find = new QHBoxLayout;
    search_ = named(new QLineEdit(this), "burSearch", tr("Find a bur"),
                    tr("Find a bur by name, US or ISO number, diameter or shape"));
    search_->setPlaceholderText(tr("Find a bur"));
    search_->setClearButtonEnabled(true);
    search_->addAction(icon("search"), QLineEdit::LeadingPosition);
    kind_ = named(new QComboBox(this), "burShape", tr("Shape of the burs shown"));
    kind_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    kind_->setMinimumContentsLength(8);
    find->addWidget(search_, 1);
    find->addWidget(kind_);
    column->addLayout(find);

    model_ = new BurModel(this);
    filter_ = new BurFilter(this);
    filter_->setSourceModel(model_);
    list_ = named(new QListView(this), "burList", tr("Burs"), tr("Choose a bur: click, or arrow keys and Enter"));
    list_->setToolTip({});  // the burs have their own
    list_->setModel(filter_);
    list_->setItemDelegate(new BurDelegate(list_));
    list_->setViewMode(QListView::IconMode);
    list_->setMovement(QListView::Static);
    list_->setResizeMode(QListView::Adjust);
    list_->setUniformItemSizes(true);
    list_->setSpacing(0);
    list_->setSelectionMode(QAbstractItemView::NoSelection);
    list_->setMouseTracking(true);
    list_->setMinimumHeight(150);
    column->addWidget(list_, 1);
    listNote_ = note({}, this, "burListNote");
    listNote_->hide();
    column->addWidget(listNote_);
    own_ = named(new QPushButton(icon("open"), tr("Own bur from a file…"), this), "burFromFile", tr("Open an own bur"),
                 tr("Use a bur of your own from an STL file"));
    column->addWidget(own_);

    auto* handpieceTitle = heading(tr("Drive"), this);
    column->addWidget(handpieceTitle);
    driveRows_ = new QVBoxLayout;
    driveRows_->setSpacing(2);
    column->addLayout(driveRows_);
    driveButtons_ = new QButtonGroup(this);

    dial_ = new SpeedDial(this);
    column->addWidget(dial_);
    stall_ = named(new QLabel(this), "stallNote", tr("The bur has stopped"));
    stall_->setAlignment(Qt::AlignCenter);
    stall_->setWordWrap(true);
    auto keep = stall_->sizePolicy();
    keep.setRetainSizeWhenHidden(true);  // the panel does not jump
    stall_->setSizePolicy(keep);
    stall_->hide();
    column->addWidget(stall_);
    auto* speedRow = new QHBoxLayout;
    speedCaption_ = new QLabel(tr("Speed"), this);
    slider_ = named(new QSlider(Qt::Horizontal, this), "speedSlider", tr("Set speed"),
                    tr("Set speed, with the pedal down and the bur in the air (+ and -)"));
    spin_ = named(new WholeField(this), "speedSpin", tr("Set speed in rpm"));
    spin_->setGroupSeparatorShown(true);
    spin_->setSuffix(tr(" rpm"));
    speedCaption_->setBuddy(slider_);
    speedRow->addWidget(speedCaption_);
    speedRow->addWidget(slider_, 1);
    speedRow->addWidget(spin_);
    column->addLayout(speedRow);

    // Who types 330 means the bur of that name, not the first whose ISO number holds these figures.
    const auto best = [this] {
        const QString wanted = search_->text().trimmed();
        QModelIndex first;
        for (int row = 0; row < filter_->rowCount(); ++row) {
            const QModelIndex index = filter_->index(row, 0);
            if (!index.data(BurModel::allowedRole).toBool()) continue;
            for (const auto role : {BurModel::nameRole, BurModel::titleRole})
                if (index.data(role).toString().compare(wanted, Qt::CaseInsensitive) == 0) return index;
            if (!first.isValid()) first = index;
        }
        return first;
    };
    connect(search_, &QLineEdit::textChanged, this, [this, best](const QString& text) {
        filter_->setWords(text);
        if (const QModelIndex index = best(); index.isValid())
            list_->scrollTo(index,
                            text.isEmpty() ? QAbstractItemView::EnsureVisible : QAbstractItemView::PositionAtTop);
    });
    // In a list of another height, as panels come and go, the bur in hand stays in sight.
    connect(list_->verticalScrollBar(), &QScrollBar::rangeChanged, this, [this] {
        if (search_->text().isEmpty() && list_->currentIndex().isValid()) list_->scrollTo(list_->currentIndex());
    });
    connect(search_, &QLineEdit::returnPressed, this, [this, best] {
        if (const QModelIndex index = best(); index.isValid()) choose(index.data(BurModel::nameRole).toString());
    });
    connect(kind_, &QComboBox::currentIndexChanged, this,
            [this] { filter_->setShape(kind_->currentData().isValid() ? kind_->currentData().toInt() : -1); });
    const auto take = [this](const QModelIndex& index) {
        if (index.data(BurModel::allowedRole).toBool()) choose(index.data(BurModel::nameRole).toString());
    };
    connect(list_, &QListView::clicked, this, take);
    connect(list_, &QListView::activated, this, take);
    connect(own_, &QPushButton::clicked, this, &DrillBar::burFileRequested);
    connect(driveButtons_, &QButtonGroup::idClicked, this, [this](int id) {
        const auto& drive = drives_[static_cast<std::size_t>(id)];
        const QString name = QString::fromStdString(drive.name);
        if (name == drive_) return;
        setDrive(name);
        emit driveChosen(name);
        takeSpeed(drive.freeSpeedRpm, true);
    });
    connect(slider_, &QSlider::valueChanged, this, [this](int value) { takeSpeed(value, true); });
    connect(spin_, &WholeField::valueChanged, this, [this](int value) { takeSpeed(value, true); });

    setBurs(instrument::catalogue());
    setDrives(instrument::drives());
    setDetail(detail_);
}

void DrillBar::setBurs(const std::vector<instrument::CatalogueEntry>& burs) {
    model_->setBurs(burs);
    const QSignalBlocker quiet(kind_);
    kind_->clear();
    kind_->addItem(tr("All shapes"));
    for (const auto& info : instrument::shapes())
        if (std::any_of(burs.begin(), burs.end(),
                        [&info](const auto& bur) { return bur.stl.empty() && bur.shape == info.shape; }))
            kind_->addItem(shapeName(info.shape), static_cast<int>(info.shape));
    filter_->setShape(-1);
    showBur();
}

void DrillBar::setShown(const Shown& shown) {
    kind_->setCurrentIndex(std::max(0, kind_->findData(shown.shape)));
    search_->setText(shown.words);
}

DrillBar::Shown DrillBar::shown() const {
    return {search_->text(), kind_->currentData().isValid() ? kind_->currentData().toInt() : -1};
}

void DrillBar::setAllowedBurs(const QStringList& names) {
    allowed_ = names;
    model_->setAllowed(names);
    own_->setEnabled(names.isEmpty());
    own_->setToolTip(names.isEmpty() ? tr("Use a bur of your own from an STL file")
                                     : tr("This exercise allows only the burs that are not grey."));
    listNote_->setText(tr("This exercise allows only the burs that are not grey."));
    listNote_->setVisible(!names.isEmpty());
}

void DrillBar::setBur(const QString& name) {
    bur_ = name;
    showBur();
}

void DrillBar::addOwnBur(const instrument::CatalogueEntry& entry, const instrument::Profile& profile) {
    model_->addOwn(entry, burFace(profile, entry.cuttingParameters));
    showBur();
}

void DrillBar::addOwnBur(const QString& name, const instrument::Bur& bur, const std::string& cuttingParameters) {
    if (name.isEmpty() || model_->rowOf(name) >= 0) return;
    instrument::CatalogueEntry entry;
    entry.name = name.toStdString();
    entry.cuttingParameters = cuttingParameters;
    addOwnBur(entry, bur.profile());
}

void DrillBar::showBur() {
    const int row = model_->rowOf(bur_);
    static_cast<BurDelegate*>(list_->itemDelegate())->setInHand(bur_);
    burName_->setText(bur_.isEmpty() ? tr("None") : burTitle(bur_));
    if (row >= 0) {
        const auto& entry = model_->entry(row);
        const auto& face = model_->face(row);
        static_cast<BurCard*>(card_)->setFace(face);
        QStringList lines{
            QStringLiteral("%1 · %2").arg(model_->shapeOf(row) < 0 ? tr("Own bur") : shapeName(entry.shape),
                                          quantity(face.diameterMm, 2, tr("mm"))),
            abilityName(entry.cuttingParameters)};
        QStringList numbers;
        if (!entry.usName.empty() && entry.usName != entry.name)
            numbers << tr("US %1").arg(QString::fromStdString(entry.usName));
        if (!entry.isoNumber.empty() && detail_ != Detail::practice)
            numbers << tr("ISO %1").arg(groupedIso(entry.isoNumber));
        if (!numbers.isEmpty()) lines << numbers.join(QStringLiteral(" · "));
        burText_->setText(lines.join(QLatin1Char('\n')));
        const QModelIndex index = filter_->mapFromSource(model_->index(row));
        if (index.isValid()) {
            list_->setCurrentIndex(index);
            list_->scrollTo(index);
        }
    } else {
        static_cast<BurCard*>(card_)->setFace({});
        burText_->setText(bur_.isEmpty() ? QString() : tr("Own bur"));
    }
    list_->viewport()->update();
}

void DrillBar::choose(const QString& name) {
    if (name == bur_) return;
    setBur(name);
    emit burChosen(name);
}

void DrillBar::chooseNext(int step) {
    const int count = model_->rowCount(), at = model_->rowOf(bur_);
    if (count == 0 || step == 0) return;
    const int sign = step > 0 ? 1 : -1;
    for (int i = 1; i <= count; ++i) {
        const int start = at < 0 ? (sign > 0 ? -1 : count) : at;
        const int row = ((start + sign * i) % count + count) % count;
        if (model_->allowed(row)) return choose(QString::fromStdString(model_->entry(row).name));
    }
}

void DrillBar::setDrives(const std::vector<instrument::Drive>& drives) {
    drives_ = drives;
    for (QAbstractButton* button : driveButtons_->buttons())
        delete button;
    for (std::size_t i = 0; i < drives_.size(); ++i) {
        const auto& drive = drives_[i];
        const QString name = QString::fromStdString(drive.name);
        auto* button = new QRadioButton(driveTitle(name), this);
        button->setObjectName("drive_" + name);
        button->setAccessibleName(driveTitle(name));
        button->setToolTip(tr("Up to %1 rpm").arg(rpmText(drive.freeSpeedRpm)));
        driveButtons_->addButton(button, static_cast<int>(i));
        driveRows_->addWidget(button);
    }
    if (!drives_.empty()) {
        setDrive(QString::fromStdString(drives_.front().name));
        takeSpeed(drives_.front().freeSpeedRpm, false);
    }
}

const instrument::Drive* DrillBar::current() const {
    for (const auto& drive : drives_)
        if (QString::fromStdString(drive.name) == drive_) return &drive;
    return nullptr;
}

void DrillBar::setDrive(const QString& name) {
    drive_ = name;
    const auto* drive = current();
    if (!drive) return;
    driveButtons_->button(static_cast<int>(drive - drives_.data()))->setChecked(true);
    const int free = static_cast<int>(drive->freeSpeedRpm), step = static_cast<int>(speedStep(free));
    const QSignalBlocker quietSlider(slider_), quietSpin(spin_);
    slider_->setRange(0, free);
    slider_->setSingleStep(free / 20);
    slider_->setPageStep(free / 10);
    spin_->setRange(0, free);
    spin_->setSingleStep(step * 10);
    dial_->setFreeSpeed(free);
    takeSpeed(std::min(speedRpm_, drive->freeSpeedRpm), false);
}

void DrillBar::setSpeed(double rpm) {
    takeSpeed(rpm, false);
}

void DrillBar::takeSpeed(double rpm, bool tell) {
    const auto* drive = current();
    const double free = drive ? drive->freeSpeedRpm : rpm;
    const double step = speedStep(free);
    const double held = std::clamp(rpm >= free ? free : std::round(rpm / step) * step, 0.0, free);
    const bool changed = held != speedRpm_;
    speedRpm_ = held;
    showSpeed();
    if (tell && changed) emit speedSet(speedRpm_);
}

void DrillBar::stepSpeed(int steps) {
    if (const auto* drive = current()) takeSpeed(speedRpm_ + steps * drive->freeSpeedRpm / 20, true);
}

void DrillBar::showSpeed() {
    const QSignalBlocker quietSlider(slider_), quietSpin(spin_);
    slider_->setValue(static_cast<int>(speedRpm_));
    spin_->setValue(static_cast<int>(speedRpm_));
    dial_->setSetSpeed(speedRpm_);
}

void DrillBar::setActualSpeed(double rpm, bool stalled) {
    dial_->setSpeed(rpm, stalled);
    if (stall_->isHidden() == !stalled) return;
    QPalette colours = palette();
    colours.setColor(QPalette::WindowText, tonesOf(palette()).bad);
    stall_->setPalette(colours);
    stall_->setText(detail_ == Detail::practice ? tr("The bur has stopped: press less hard.")
                                                : tr("Stalled: the load is more than the drive can turn."));
    stall_->setVisible(stalled);
}

void DrillBar::setDetail(Detail detail) {
    detail_ = detail;
    spin_->setVisible(detail != Detail::practice);
    // In Practice the two handpieces a student knows; the others are for measuring.
    for (std::size_t i = 0; i < drives_.size(); ++i)
        driveButtons_->button(static_cast<int>(i))
            ->setVisible(detail != Detail::practice || drives_[i].name != "weak-turbine");
    showBur();
}

}  // namespace handpiece::desktop
