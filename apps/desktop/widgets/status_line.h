// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One line on how it goes: device, rate, late ticks, load, record.

#include <QString>
#include <QWidget>
#include <cstdint>

#include "desktop/widgets/detail.h"

class QLabel;
class QToolButton;

namespace handpiece::desktop {

class Lamp;

/// What the line shows.
struct StatusFigures {
    enum class Recording { off, on, stopped };
    QString device;
    double servoHz = 0.0;  ///< of the device's own loop, measured; 0: it has none
    QString deviceFault;   ///< a word or two; empty: it is well
    double rateHz = 0.0;   ///< measured
    std::uint64_t lateTicks = 0, missedPeriods = 0;
    double load = 0.0;  ///< 0..1
    Recording recording = Recording::off;
    QString recordingNote;  ///< why it stopped
    bool late = false;      ///< the last second had late ticks worth a word
    bool busy = false;      ///< undo or loading under way
    friend bool operator==(const StatusFigures&, const StatusFigures&) = default;
};

/// [statusLine]. In Practice one plain word, "Ready", "Recording", "Late", and the device.
class StatusLine : public QWidget {
    Q_OBJECT
  public:
    explicit StatusLine(QWidget* parent = nullptr);
    void setFigures(const StatusFigures& figures);
    void setDetail(Detail detail);
    [[nodiscard]] QString word() const;

  signals:
    /// The field of the device was pressed.
    void deviceClicked();

  private:
    void refresh();

    StatusFigures figures_;
    Detail detail_ = Detail::practice;
    Lamp* lamp_;
    QToolButton* device_;
    QLabel *word_, *rate_, *late_, *load_, *record_;
};

}  // namespace handpiece::desktop
