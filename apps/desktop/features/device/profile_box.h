// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a person may set about a device.

#include <QWidget>

#include "desktop/widgets/number_field.h"
#include "handpiece/devices/workspace/profile.h"

class QCheckBox;
class QComboBox;
class QFormLayout;
class QPushButton;

namespace handpiece::desktop {

/// [deviceProfile]. Plain data in, signals out. `brief`: which hand, scale and where the bur sits, for the first steps.
class ProfileBox : public QWidget {
    Q_OBJECT
  public:
    enum class Extent { all, brief };
    explicit ProfileBox(Extent extent, QWidget* parent = nullptr);

    void setProfile(const workspace::Profile& profile);
    [[nodiscard]] const workspace::Profile& profile() const noexcept { return profile_; }
    void setEventBasedForce(bool contact, bool vibration);
    [[nodiscard]] bool crispContact() const;
    [[nodiscard]] bool cuttingVibration() const;

  signals:
    /// By the person.
    void changed();
    void crispChanged();
    void placeHereRequested();

  private:
    void take();
    QCheckBox* tick(QFormLayout* form, const char* object, const QString& text, const QString& tip);

    workspace::Profile profile_;
    QComboBox *hand_, *scale_, *bur_, *clutch_ = nullptr;
    DecimalField* force_ = nullptr;
    QCheckBox *passivity_ = nullptr, *friction_ = nullptr, *thermal_ = nullptr, *eventForce_ = nullptr,
              *vibration_ = nullptr;
};

}  // namespace handpiece::desktop
