// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The foot pedal's part of the menu Device, and what is told of it.

#include <QMenu>
#include <QObject>

#include "desktop/framework/notices.h"
#include "desktop/framework/settings.h"
#include "desktop/work/foot.h"

namespace handpiece::desktop {

class PedalMenu : public QObject {
    Q_OBJECT
  public:
    PedalMenu(Foot& foot, Settings& settings, Notices& notices, QWidget* window);
    [[nodiscard]] QMenu* menu() const noexcept { return menu_; }

  signals:
    void failed(const handpiece::desktop::Problem& problem);

  private:
    void list();
    void choose(const QString& name);

    Foot& foot_;
    Settings& settings_;
    Notices& notices_;
    QMenu* menu_;
    bool isAsked_ = false;  ///< a person is waiting: what goes wrong is worth a dialog
};

}  // namespace handpiece::desktop
