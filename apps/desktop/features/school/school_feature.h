// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A station of a school: what was finished goes there by itself, and work that the school gave to do, or that its
/// student shares, can be watched. Says plainly who watches.

#include <QTimer>

#include "desktop/features/school/school_link.h"
#include "desktop/framework/feature.h"

class QLabel;

namespace handpiece::desktop {

class SchoolFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { sharePractice };
    explicit SchoolFeature(const FeatureContext& context);
    void showDocument() override;

    [[nodiscard]] SchoolLink& link() noexcept { return link_; }
    /// Between two pictures.
    static constexpr int kPeriodMs = 2000;

  private:
    void showLive();
    void showNote();
    [[nodiscard]] bool mayBeWatched() const;

    CommandSet<Command> commands_;
    SchoolLink link_;
    QLabel* note_;
    QTimer timer_;
    QString exerciseHash_;  ///< of the tooth that is open; empty: it is no exercise
    QStringList flags_;     ///< what has happened to it
};

}  // namespace handpiece::desktop
