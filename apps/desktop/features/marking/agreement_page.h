// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How far markers agree, as a table and pictures.

#include <QSvgRenderer>
#include <QWidget>
#include <memory>

#include "handpiece/app/marking/desk_agreement.h"

class QComboBox;
class QLabel;
class QTreeWidget;

namespace handpiece::desktop {

/// A picture of the report room, as large as it may be.
class SvgView : public QWidget {
    Q_OBJECT
  public:
    explicit SvgView(QWidget* parent = nullptr);
    /// Empty: nothing.
    void setSvg(const std::string& svg);
    [[nodiscard]] bool hasPicture() const { return renderer_.isValid(); }
    [[nodiscard]] QSize sizeHint() const override { return {420, 260}; }

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    QSvgRenderer renderer_;
};

/// [agreementPage].
class AgreementPage : public QWidget {
    Q_OBJECT
  public:
    explicit AgreementPage(QWidget* parent = nullptr);
    void clear();
    void show(const marking::DeskAgreement& agreement, const QString& note);
    void setNote(const QString& note);

  private:
    void showPicture();

    marking::DeskAgreement agreement_;
    QTreeWidget* table_;
    QComboBox* which_;
    SvgView* picture_;
    QLabel* note_;
};

}  // namespace handpiece::desktop
