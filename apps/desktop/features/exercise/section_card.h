// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Beside a place that is shown: a section through it, one's own work over the ideal, and by how much they differ.

#include <QWidget>
#include <optional>

#include "handpiece/app/report/place_section.h"

class QLabel;

namespace handpiece::desktop {

/// [sectionCard] over the picture, in its corner. Lines are told apart by their dashes too.
class SectionCard : public QWidget {
    Q_OBJECT
  public:
    explicit SectionCard(QWidget* parent = nullptr);
    /// Turned as the eye sees it, whose right (tooth frame) that is.
    void setSection(report::PlaceSection section, const report::Bearings& bearings, const core::Vec3& eyesRight);
    /// Its figures: "Depth: 1.2 mm, ideal: 1.5 mm."
    [[nodiscard]] static QString figuresOf(const report::PlaceSection& section);
    [[nodiscard]] QSize sizeHint() const override;

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    [[nodiscard]] QRect drawing() const;

    std::optional<report::PlaceSection> section_;
    QString left_, right_;
    bool isMirrored_ = false;
    QLabel* figures_;
};

}  // namespace handpiece::desktop
