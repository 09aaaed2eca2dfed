// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/error_dialog.h"

#include <QClipboard>
#include <QDialogButtonBox>
#include <QGridLayout>
#include <QGuiApplication>
#include <QLabel>
#include <QPushButton>
#include <QStyle>
#include <QVBoxLayout>

#include "desktop/widgets/scrolled.h"

namespace handpiece::desktop {
namespace {

/// "the surface is open" -> "The surface is open."
QString sentence(QString text) {
    if (text.isEmpty()) return text;
    text[0] = text[0].toUpper();
    const QChar last = text.back();
    return last.isLetterOrNumber() || last == QLatin1Char(')') ? text + QLatin1Char('.') : text;
}

}  // namespace

ErrorDialog::ErrorDialog(const Problem& problem, QWidget* parent) : QDialog(parent), problem_(problem) {
    setObjectName(QStringLiteral("errorDialog"));
    setWindowTitle(tr("That did not work"));
    setAttribute(Qt::WA_DeleteOnClose);
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(20, 18, 20, 14);
    auto* grid = new QGridLayout;
    grid->setHorizontalSpacing(16);
    grid->setVerticalSpacing(10);
    auto* symbol = new QLabel;
    symbol->setPixmap(style()->standardIcon(QStyle::SP_MessageBoxWarning).pixmap(32));
    grid->addWidget(symbol, 0, 0, 3, 1, Qt::AlignTop);
    int row = 0;
    const auto add = [&](const char* name, const QString& text, bool bold) {
        if (text.isEmpty()) return;
        auto* label = new QLabel(text);
        label->setObjectName(QLatin1String(name));
        label->setWordWrap(true);
        label->setMinimumWidth(380);
        label->setTextFormat(Qt::PlainText);
        label->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
        if (bold) {
            QFont font = label->font();
            font.setBold(true);
            label->setFont(font);
        }
        grid->addWidget(label, row++, 1);
    };
    add("errorWhat", sentence(problem.what), true);
    add("errorWhere", problem.where, false);
    add("errorRemedy", sentence(problem.remedy), false);
    buttons_ = new QDialogButtonBox(QDialogButtonBox::Close);
    buttons_->setObjectName(QStringLiteral("errorButtons"));
    auto* copy = buttons_->addButton(tr("Copy text"), QDialogButtonBox::ActionRole);
    copy->setObjectName(QStringLiteral("errorCopy"));
    copy->setToolTip(tr("Copy this message, to send it to somebody"));
    grid->setColumnStretch(1, 1);
    grid->setRowStretch(row, 1);
    column->addWidget(new Scrolled(grid, this), 1);
    column->addWidget(buttons_);
    connect(copy, &QPushButton::clicked, this, [this] { QGuiApplication::clipboard()->setText(text()); });
    connect(buttons_, &QDialogButtonBox::rejected, this, &QDialog::reject);
}

QPushButton* ErrorDialog::addRemedy(const char* objectName, const QString& text, const QString& tip) {
    QPushButton* button = buttons_->addButton(text, QDialogButtonBox::ActionRole);
    button->setObjectName(QLatin1String(objectName));
    button->setToolTip(tip);
    connect(button, &QPushButton::clicked, this, &QDialog::accept);
    return button;
}

QString ErrorDialog::text() const {
    QStringList lines{sentence(problem_.what)};
    if (!problem_.where.isEmpty()) lines << problem_.where;
    if (!problem_.remedy.isEmpty()) lines << sentence(problem_.remedy);
    if (!problem_.id.isEmpty()) lines << QStringLiteral("[%1]").arg(problem_.id);
    return lines.join(QLatin1Char('\n'));
}

}  // namespace handpiece::desktop
