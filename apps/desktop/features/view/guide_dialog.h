// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The user's guide, which is built in: it is there without a network and without another package.

#include <QDialog>
#include <vector>

class QLabel;
class QListWidget;
class QTextBrowser;
class QUrl;

namespace handpiece::desktop {

/// [guideDialog]: its chapters, its text, and a search. Work goes on beside it.
class GuideDialog : public QDialog {
    Q_OBJECT
  public:
    /// `language`: of the window, "en" or "ja".
    explicit GuideDialog(const QString& language, QWidget* parent = nullptr);

  private:
    void fill(const QString& markdown);
    void go(const QUrl& link);
    void search(const QString& words);

    QListWidget* chapters_;
    QTextBrowser* text_;
    QLabel* said_;
    std::vector<int> places_;  ///< of the chapters: positions in the text
};

}  // namespace handpiece::desktop
