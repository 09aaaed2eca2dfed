// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The foot pedal beside whatever holds the handpiece: which there are, the one that was chosen, whether it is there.

#include <QObject>
#include <QString>
#include <QTimer>
#include <functional>
#include <memory>
#include <vector>

#include "desktop/framework/job.h"
#include "desktop/framework/problem.h"
#include "handpiece/devices/drivers/pedal.h"

namespace handpiece::desktop {

/// How pedals are found and opened. A test may put its own there.
struct PedalDesk {
    struct Open {
        std::string name;
        std::function<bool()> attached;
        std::shared_ptr<void> held;  ///< writes until it goes
    };
    std::function<std::vector<drivers::PedalFound>()> look = drivers::pedals;
    /// By a part of its name, writing into `value`.
    std::function<Open(const std::string& name, std::shared_ptr<link::PedalValue> value)> open =
        [](const std::string& name, std::shared_ptr<link::PedalValue> value) {
            const auto pedal = std::make_shared<drivers::FootPedal>(drivers::PedalSettings{name}, std::move(value));
            return Open{pedal->name(), [pedal] { return pedal->attached(); }, pedal};
        };
};

/// Lives on the window's thread; looking and opening are done beside it. The value is one for good: devices are opened
/// with it once, whatever pedal writes it, and without one it is zero.
class Foot : public QObject {
    Q_OBJECT
  public:
    explicit Foot(PedalDesk desk, QObject* parent = nullptr);
    ~Foot() override;

    [[nodiscard]] std::shared_ptr<const link::PedalValue> value() const noexcept { return value_; }
    void look();
    [[nodiscard]] const QStringList& found() const noexcept { return found_; }
    /// By name; empty: none. opened() or refused() tells.
    void choose(const QString& name);
    /// The one that was asked for last; empty: none.
    [[nodiscard]] const QString& wanted() const noexcept { return wanted_; }
    [[nodiscard]] bool isThere() const noexcept { return there_; }

  signals:
    void changed();
    void refused(const QString& name, const handpiece::desktop::Problem& problem);
    void unplugged(const QString& name);
    void back(const QString& name);

  private:
    void open(const QString& name);
    void poll();

    PedalDesk desk_;
    std::shared_ptr<link::PedalValue> value_ = std::make_shared<link::PedalValue>();
    QStringList found_;
    QString wanted_;
    PedalDesk::Open pedal_;
    bool there_ = false;
    std::unique_ptr<Job> looking_, opening_;
    QTimer timer_;
};

}  // namespace handpiece::desktop
