// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/device/profile_box.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QPushButton>
#include <QSignalBlocker>

#include "desktop/widgets/parts.h"

namespace handpiece::desktop {

ProfileBox::ProfileBox(Extent extent, QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("deviceProfile"));
    setAccessibleName(tr("Settings of the device"));
    auto* form = new QFormLayout(this);
    form->setContentsMargins(0, 0, 0, 0);
    const auto combo = [&](const char* object, const QString& text, const QString& tip) {
        auto* box = named(new QComboBox(this), object, text, tip);
        form->addRow(text, box);
        connect(box, &QComboBox::activated, this, &ProfileBox::take);
        return box;
    };
    hand_ = combo("profileHand", tr("Hand"),
                  tr("Which hand holds the stylus: for the left one the head of the handpiece is mirrored"));
    hand_->addItem(tr("Right"), false);
    hand_->addItem(tr("Left"), true);
    scale_ = combo("profileScale", tr("Scale"),
                   tr("How far the hand goes for a millimetre of the bur. A larger scale is for fine work: the hand is "
                      "steadier, the tooth feels softer."));
    for (const int scale : {1, 2, 3})
        scale_->addItem(tr("%1:1").arg(scale), static_cast<double>(scale));
    bur_ = combo("profileBur", tr("Bur"),
                 tr("The stylus is the handle: the bur sits in the head at an angle, or goes on along the stylus"));
    bur_->addItem(tr("In the head, at its angle"), false);
    bur_->addItem(tr("Along the stylus"), true);
    if (extent == Extent::brief) return;

    clutch_ = combo("profileClutch", tr("Clutch"),
                    tr("While this button is held the bur stays and the hand moves freely, to reach farther"));
    clutch_->addItem(tr("No clutch"), -1);
    for (const int bit : {1, 2, 3})
        clutch_->addItem(bit == 1 ? tr("Lower button") : tr("Button %1").arg(bit + 1), bit);
    auto* place = named(new QPushButton(tr("Place the tooth here"), this), "profilePlace", tr("Place the tooth here"),
                        tr("Where the hand is now, it has the bur over the tooth from now on"));
    form->addRow(tr("Placing"), place);
    connect(place, &QPushButton::clicked, this, &ProfileBox::placeHereRequested);
    force_ = named(new DecimalField(this), "profileForce", tr("Force"),
                   tr("All forces times this; the device's limits stay. Below 100 % everything feels softer and the "
                      "motors stay cooler."));
    force_->setRange(10.0, 200.0);
    force_->setSingleStep(10.0);
    force_->setDecimals(0);
    force_->setSuffix(tr(" %"));
    form->addRow(tr("Force"), force_);
    connect(force_, &DecimalField::valueChanged, this, &ProfileBox::take);
    passivity_ = tick(form, "profilePassivity", tr("Passivity controller"),
                      tr("Takes out energy that the tooth did not give, so that the stylus never buzzes or kicks"));
    friction_ = tick(form, "profileFriction", tr("Friction compensation"),
                     tr("Gives back part of what the arm's own joints rub away, so that light touches are felt"));
    thermal_ = tick(form, "profileThermal", tr("Thermal budget"),
                    tr("Lowers the force slowly when one presses hard for long, before the motors get too warm"));
    eventForce_ =
        named(new QCheckBox(tr("Crisp contact"), this), "deviceCrisp", tr("Crisp contact"),
              tr("A short knock at each touch, at the tissue's own pitch: makes a soft arm's enamel feel hard"));
    vibration_ = named(new QCheckBox(tr("Cutting vibration"), this), "deviceVibration", tr("Cutting vibration"),
                       tr("The hum of the bur in the hand while it cuts, 100 to 400 Hz"));
    for (QCheckBox* box : {eventForce_, vibration_}) {
        form->addRow(box);
        connect(box, &QCheckBox::clicked, this, &ProfileBox::crispChanged);
    }
}

QCheckBox* ProfileBox::tick(QFormLayout* form, const char* object, const QString& text, const QString& tip) {
    auto* box = named(new QCheckBox(text, this), object, text, tip);
    form->addRow(box);
    connect(box, &QCheckBox::clicked, this, &ProfileBox::take);
    return box;
}

void ProfileBox::setProfile(const workspace::Profile& profile) {
    profile_ = profile;
    const auto choose = [](QComboBox* box, const QVariant& value) {
        if (const int at = box->findData(value); at >= 0) box->setCurrentIndex(at);
    };
    choose(hand_, profile.placing.leftHanded);
    choose(scale_, profile.placing.scale);
    choose(bur_, profile.placing.burAlongStylus);
    if (!clutch_) return;
    choose(clutch_, profile.clutchButton);
    const QSignalBlocker quiet(force_);
    force_->setValue(100.0 * profile.shaping.forceScale);
    passivity_->setChecked(profile.shaping.passivityController);
    friction_->setChecked(profile.shaping.frictionCompensation);
    thermal_->setChecked(profile.shaping.thermalBudget);
}

void ProfileBox::take() {
    profile_.placing.leftHanded = hand_->currentData().toBool();
    profile_.placing.scale = scale_->currentData().toDouble();
    profile_.placing.burAlongStylus = bur_->currentData().toBool();
    if (clutch_) {
        profile_.clutchButton = clutch_->currentData().toInt();
        profile_.shaping.forceScale = force_->value() / 100.0;
        profile_.shaping.passivityController = passivity_->isChecked();
        profile_.shaping.frictionCompensation = friction_->isChecked();
        profile_.shaping.thermalBudget = thermal_->isChecked();
    }
    emit changed();
}

void ProfileBox::setEventBasedForce(bool contact, bool vibration) {
    if (!eventForce_) return;
    eventForce_->setChecked(contact);
    vibration_->setChecked(vibration);
}

bool ProfileBox::crispContact() const {
    return eventForce_ && eventForce_->isChecked();
}
bool ProfileBox::cuttingVibration() const {
    return vibration_ && vibration_->isChecked();
}

}  // namespace handpiece::desktop
