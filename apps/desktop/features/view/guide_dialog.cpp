// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/view/guide_dialog.h"

#include <QDesktopServices>
#include <QDialogButtonBox>
#include <QFile>
#include <QFileInfo>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QRegularExpression>
#include <QScrollBar>
#include <QSplitter>
#include <QTextBlock>
#include <QTextBrowser>
#include <QUrl>
#include <QVBoxLayout>

namespace handpiece::desktop {
namespace {

/// Where packages put the other pages.
const QString kPages = QStringLiteral("/usr/share/doc/handpiece-doc/");

QString guideIn(const QString& language) {
    QFile file(language == QLatin1String("ja") ? QStringLiteral(":/guide/user-guide.ja.md")
                                               : QStringLiteral(":/guide/user-guide.md"));
    if (!file.open(QIODevice::ReadOnly)) return {};
    QString text = QString::fromUtf8(file.readAll());
    // The pictures show the window that one has before one.
    static const QRegularExpression picture(QStringLiteral(R"(^!\[.*\]\(.*\)\s*$)"),
                                            QRegularExpression::MultilineOption);
    return text.remove(picture);
}

}  // namespace

GuideDialog::GuideDialog(const QString& language, QWidget* parent)
    : QDialog(parent), chapters_(new QListWidget), text_(new QTextBrowser), said_(new QLabel) {
    setObjectName(QStringLiteral("guideDialog"));
    setWindowTitle(tr("User guide"));
    resize(900, 620);
    auto* words = new QLineEdit;
    words->setObjectName(QStringLiteral("guideSearch"));
    words->setPlaceholderText(tr("Find in the guide"));
    words->setAccessibleName(tr("Find in the guide"));
    words->setToolTip(tr("Type a word; Enter finds the next place"));
    words->setClearButtonEnabled(true);
    chapters_->setObjectName(QStringLiteral("guideChapters"));
    chapters_->setAccessibleName(tr("Chapters"));
    chapters_->setToolTip(tr("Go to this chapter"));
    text_->setObjectName(QStringLiteral("guideText"));
    text_->setAccessibleName(tr("User guide"));
    text_->setOpenLinks(false);
    said_->setObjectName(QStringLiteral("guideSaid"));
    said_->setWordWrap(true);
    auto* halves = new QSplitter;
    halves->addWidget(chapters_);
    halves->addWidget(text_);
    halves->setStretchFactor(1, 1);
    halves->setSizes({240, 660});
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    buttons->button(QDialogButtonBox::Close)->setAutoDefault(false);
    auto* column = new QVBoxLayout(this);
    column->addWidget(words);
    column->addWidget(halves, 1);
    column->addWidget(said_);
    column->addWidget(buttons);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(words, &QLineEdit::returnPressed, this, [this, words] { search(words->text()); });
    connect(text_, &QTextBrowser::anchorClicked, this, &GuideDialog::go);
    fill(guideIn(language));
    connect(chapters_, &QListWidget::currentRowChanged, this, [this](int row) {
        if (row < 0) return;
        QTextCursor cursor(text_->document());
        cursor.setPosition(places_[static_cast<std::size_t>(row)]);
        text_->verticalScrollBar()->setValue(text_->verticalScrollBar()->maximum());  // so that it comes to lie on top
        text_->setTextCursor(cursor);
        text_->ensureCursorVisible();
    });
}

void GuideDialog::fill(const QString& markdown) {
    text_->setMarkdown(markdown);
    constexpr int kChapter = 2;
    for (QTextBlock block = text_->document()->begin(); block.isValid(); block = block.next()) {
        if (block.blockFormat().headingLevel() != kChapter) continue;
        chapters_->addItem(block.text());
        places_.push_back(block.position());
    }
}

void GuideDialog::go(const QUrl& link) {
    said_->clear();
    if (link.isRelative() && link.path().isEmpty()) {  // a chapter of this page, by its heading
        const auto plain = [](QString text) {
            static const QRegularExpression other(QStringLiteral("[^\\w]+"),
                                                  QRegularExpression::UseUnicodePropertiesOption);
            return text.toLower().remove(other);
        };
        for (QTextBlock block = text_->document()->begin(); block.isValid(); block = block.next())
            if (block.blockFormat().headingLevel() > 0 && plain(block.text()) == plain(link.fragment())) {
                text_->setTextCursor(QTextCursor(block));
                text_->ensureCursorVisible();
                return;
            }
        return;
    }
    const QUrl to = link.isRelative() ? QUrl::fromLocalFile(kPages + link.path()) : link;
    if (to.isLocalFile() && !QFileInfo::exists(to.toLocalFile()))
        said_->setText(tr("That page is in the package handpiece-doc: %1").arg(link.path()));
    else if (!QDesktopServices::openUrl(to))
        said_->setText(tr("No program here opens %1").arg(to.toDisplayString()));
}

void GuideDialog::search(const QString& words) {
    said_->clear();
    if (words.isEmpty() || text_->find(words)) return;
    text_->moveCursor(QTextCursor::Start);  // from the top again
    if (!text_->find(words)) said_->setText(tr("Not found: %1").arg(words));
}

}  // namespace handpiece::desktop
