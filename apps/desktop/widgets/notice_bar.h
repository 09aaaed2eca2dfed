// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A message that blocks nothing.

#include <QFrame>
#include <QString>
#include <deque>

class QLabel;
class QPushButton;
class QToolButton;

namespace handpiece::desktop {

/// A strip with a text, a remedy and a cross [noticeBar]. One at a time; more wait, the gravest first.
class NoticeBar : public QFrame {
    Q_OBJECT
  public:
    enum class Kind { hint, warning, error };
    struct Notice {
        QString id;  ///< of the notice: the same one is not queued twice
        Kind kind = Kind::hint;
        QString text;
        QString remedy;      ///< the button's text; empty: no button
        QString later = {};  ///< of a second button that puts it away, as the cross does; empty: none
    };

    explicit NoticeBar(QWidget* parent = nullptr);
    void add(const Notice& notice);
    /// Takes it away, shown or waiting.
    void remove(const QString& id);
    void clear();
    /// Of the one shown; empty when there is none.
    [[nodiscard]] QString current() const;

  signals:
    void remedyChosen(const QString& id);
    void dismissed(const QString& id);

  protected:
    void paintEvent(QPaintEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void changeEvent(QEvent* event) override;

  private:
    void showFirst();
    void showSymbol();
    void dismiss();

    std::deque<Notice> waiting_;
    QLabel *symbol_, *text_, *more_;
    QPushButton *remedy_, *later_;
    QToolButton* close_;
};

}  // namespace handpiece::desktop
