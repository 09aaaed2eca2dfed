// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/school/exam_dialog.h"

#include <QDateTime>
#include <QFontDatabase>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QStackedWidget>
#include <QVBoxLayout>

#include "desktop/framework/helps.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

QString durationWords(qint64 ms) {
    const qint64 seconds = ms / 1000;
    const QString minutes = ExamDialog::tr("%1 min").arg(QLocale().toString(seconds / 60));
    return seconds % 60 == 0 ? minutes : ExamDialog::tr("%1 %2 s").arg(minutes, QLocale().toString(seconds % 60));
}

QString allowanceWords(int extraPercent, int pauseMinutes) {
    const QString extra = ExamDialog::tr("%1 % more time").arg(QLocale().toString(extraPercent)),
                  pause = ExamDialog::tr("%1 min for pauses").arg(QLocale().toString(pauseMinutes));
    return extraPercent > 0 && pauseMinutes > 0 ? ExamDialog::tr("%1 and %2 are in it.").arg(extra, pause)
           : extraPercent > 0                   ? ExamDialog::tr("%1 is in it.").arg(extra)
           : pauseMinutes > 0                   ? ExamDialog::tr("%1 are in it.").arg(pause)
                                                : QString();
}

ExamDialog::ExamDialog(QWidget* parent) : QDialog(parent) {
    setObjectName(QStringLiteral("examDialog"));
    setWindowTitle(tr("Begin an exam"));
    setMinimumWidth(560);
    const auto words = [this](const char* object, const QString& name) {
        auto* label = named(new QLabel, object, name);
        label->setTextFormat(Qt::PlainText);
        label->setWordWrap(true);
        label->setToolTip({});
        return label;
    };
    const auto field = [](const char* object, const QString& name) {
        auto* line = named(new QLineEdit, object, name);
        line->setMaxLength(100);
        return line;
    };
    auto* column = new QVBoxLayout(this);
    pages_ = new QStackedWidget;
    column->addWidget(pages_, 1);

    auto* first = new QWidget;
    auto* firstColumn = new QVBoxLayout(first);
    firstColumn->addWidget(
        note(tr("An invigilator is beside you. Type the code on your slip; nothing begins before the invigilator has "
                "confirmed who you are."),
             first, "examFirstNote"));
    candidate_ = field("examCandidate", tr("Candidate's code"));
    candidate_->setPlaceholderText(QStringLiteral("123-4H6-7K9-AB2"));
    candidate_->setFont(scaledFont(font(), 1.3));
    auto* firstForm = new QFormLayout;
    firstForm->addRow(tr("Candidate's code"), candidate_);
    firstColumn->addLayout(firstForm);
    // Only where an exam turns out to be sealed still: with the network it opens by itself.
    openingRow_ = new QWidget;
    auto* openingForm = new QFormLayout(openingRow_);
    openingForm->setContentsMargins(0, 0, 0, 0);
    opening_ = field("examOpening", tr("Opening code"));
    opening_->setEchoMode(QLineEdit::Password);
    openingForm->addRow(tr("Opening code"), opening_);
    firstColumn->addWidget(openingRow_);
    firstColumn->addStretch();
    pages_->addWidget(first);

    auto* second = new QWidget;
    auto* secondColumn = new QVBoxLayout(second);
    title_ = words("examOfferTitle", tr("Title of the exam"));
    title_->setFont(scaledFont(font(), 1.3, true));
    secondColumn->addWidget(title_);
    what_ = words("examOfferWhat", tr("What is asked"));
    what_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
    what_->setMargin(8);
    auto* scroll = new QScrollArea;
    scroll->setWidget(what_);
    scroll->setWidgetResizable(true);
    scroll->setMinimumHeight(90);
    scroll->setObjectName(QStringLiteral("examOfferScroll"));
    secondColumn->addWidget(scroll, 1);
    time_ = words("examOfferTime", tr("How long it takes"));
    secondColumn->addWidget(time_);
    locked_ = words("examOfferLocked", tr("What is locked"));
    secondColumn->addWidget(locked_);
    again_ = words("examOfferAgain", tr("Begun before"));
    secondColumn->addWidget(again_);
    secondColumn->addWidget(heading(tr("For the invigilator"), second));
    secondColumn->addWidget(
        note(tr("Check who sits here: the slip with this code must be theirs. With your own code and the next code "
                "beside this candidate on your sheet you confirm it, and the time begins to run."),
             second, "examSecondNote"));
    auto* form = new QFormLayout;
    invigilator_ = field("examInvigilator", tr("Invigilator's code"));
    form->addRow(tr("Invigilator's code"), invigilator_);
    pin_ = field("examPin", tr("Confirmation code"));
    pin_->setEchoMode(QLineEdit::Password);
    form->addRow(tr("Confirmation code"), pin_);
    secondColumn->addLayout(form);
    pages_->addWidget(second);

    problem_ = words("examProblem", tr("What is wrong"));
    problem_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    column->addWidget(problem_);
    auto* buttons = new QHBoxLayout;
    back_ = named(new QPushButton(tr("Back")), "examBack", tr("Back to the candidate's code"));
    next_ = named(new QPushButton, "examNext", tr("Go on"));
    auto* cancel = named(new QPushButton(tr("Cancel")), "examCancel", tr("No exam is begun"));
    for (QPushButton* button : {back_, next_, cancel})
        button->setAutoDefault(false);
    buttons->addWidget(back_);
    buttons->addStretch();
    buttons->addWidget(next_);
    buttons->addWidget(cancel);
    column->addLayout(buttons);
    next_->setDefault(true);
    connect(next_, &QPushButton::clicked, this, &ExamDialog::goOn);
    connect(back_, &QPushButton::clicked, this, &ExamDialog::goBack);
    connect(cancel, &QPushButton::clicked, this, &QDialog::reject);
    for (QLineEdit* line : {candidate_, opening_, invigilator_, pin_})
        connect(line, &QLineEdit::textChanged, this, [this] { setBusy(false); });
    restart();
}

void ExamDialog::restart() {
    for (QLineEdit* line : {candidate_, opening_, invigilator_, pin_})
        line->clear();
    openingRow_->hide();
    goBack();
}

void ExamDialog::goBack() {
    pages_->setCurrentIndex(0);
    problem_->clear();
    pin_->clear();
    candidate_->setFocus();
    setBusy(false);
}

void ExamDialog::setBusy(bool isBusy) {
    const bool isFirst = pages_->currentIndex() == 0;
    next_->setText(isFirst ? tr("Go on") : tr("Begin the exam"));
    next_->setToolTip(isFirst ? tr("Shows which exam it is") : tr("The time begins to run"));
    back_->setVisible(!isFirst);
    const bool isFilled = isFirst ? !candidate_->text().trimmed().isEmpty()
                                  : !invigilator_->text().trimmed().isEmpty() && !pin_->text().isEmpty();
    next_->setEnabled(!isBusy && isFilled);
    back_->setEnabled(!isBusy);
}

void ExamDialog::goOn() {
    problem_->clear();
    setBusy(true);
    const QString candidate = candidate_->text().trimmed();
    if (pages_->currentIndex() == 0)
        emit lookRequested(candidate, opening_->text().trimmed());
    else
        emit beginRequested(candidate, invigilator_->text().trimmed(), pin_->text().trimmed());
}

void ExamDialog::showOffer(const ExamOffer& offer) {
    title_->setText(offer.title);
    QStringList what{offer.exercise, offer.instructions};
    what.removeAll(QString());
    what_->setText(what.join(QStringLiteral("\n\n")));
    QString time = tr("Time: %1.").arg(durationWords(offer.timeMs));
    if (const QString allowance = allowanceWords(offer.extraPercent, offer.pauseMinutes); !allowance.isEmpty())
        time += QLatin1Char(' ') + allowance;
    time_->setText(time);
    QStringList locked;
    for (const QString& name : offer.locked)
        if (const auto help = helpOf(name.toStdString())) locked << helpWords(*help);
    locked_->setText(locked.isEmpty() ? tr("No help is locked.")
                                      : tr("Locked: %1").arg(locked.join(QStringLiteral("; "))));
    again_->setText(tr("With this code an exam was begun here before: %1 times. This shows.").arg(offer.again));
    again_->setVisible(offer.again > 0);
    opening_->clear();
    openingRow_->hide();
    pages_->setCurrentIndex(1);
    invigilator_->setFocus();
    setBusy(false);
}

void ExamDialog::showProblem(const Problem& problem) {
    QPalette tinted = palette();
    tinted.setColor(QPalette::WindowText, tonesOf(tinted).bad);
    problem_->setPalette(tinted);
    QStringList words{problem.what, problem.remedy};
    words.removeAll(QString());
    problem_->setText(words.join(QLatin1Char(' ')));
    pin_->clear();
    if (problem.id == QLatin1String("exam-sealed")) openingRow_->show();
    setBusy(false);
    (pages_->currentIndex() != 0 ? pin_ : openingRow_->isHidden() ? candidate_ : opening_)->setFocus();
}

ReceiptDialog::ReceiptDialog(QWidget* parent) : QDialog(parent) {
    setObjectName(QStringLiteral("examReceiptDialog"));
    setWindowTitle(tr("Receipt"));
    resize(680, 460);
    auto* column = new QVBoxLayout(this);
    heading_ = named(new QLabel, "examReceiptTitle", tr("What became of the exam"));
    heading_->setFont(scaledFont(font(), 1.3, true));
    heading_->setTextFormat(Qt::PlainText);
    heading_->setWordWrap(true);
    column->addWidget(heading_);
    words_ = named(new QLabel, "examReceiptWords", tr("What happens next"));
    words_->setTextFormat(Qt::PlainText);
    words_->setWordWrap(true);
    column->addWidget(words_);
    text_ = named(new QPlainTextEdit, "examReceiptText", tr("The receipt, as it is signed"));
    text_->setReadOnly(true);
    text_->setLineWrapMode(QPlainTextEdit::NoWrap);
    text_->setFont(QFontDatabase::systemFont(QFontDatabase::FixedFont));
    column->addWidget(text_, 1);
    auto* buttons = new QHBoxLayout;
    buttons->addStretch();
    save_ = named(new QPushButton(tr("Save the receipt...")), "examReceiptSave", tr("Save the receipt"),
                  tr("Keep it: with it you can show what you handed over and when"));
    auto* close = named(new QPushButton(tr("Close")), "examReceiptClose", tr("Close"));
    buttons->addWidget(save_);
    buttons->addWidget(close);
    column->addLayout(buttons);
    connect(save_, &QPushButton::clicked, this, &ReceiptDialog::saveRequested);
    connect(close, &QPushButton::clicked, this, &QDialog::accept);
}

const QString& ReceiptDialog::text() const {
    return ending_.receipt.isEmpty() ? ending_.entry : ending_.receipt;
}

void ReceiptDialog::show(const QString& title, const ExamEnding& ending) {
    ending_ = ending;
    const QString at = QLocale().toString(QDateTime::fromMSecsSinceEpoch(ending.atMs), QLocale::ShortFormat);
    const QString what = ending.isGivenUp ? tr("The exam was given up: %1") : tr("Your work has been handed over: %1");
    heading_->setText(what.arg(title.isEmpty() ? ending.sitting.left(8) : title));
    words_->setText(
        ending.isGivenUp ? tr("At %1 an invigilator ended it without work.").arg(at)
        : ending.receipt.isEmpty()
            ? tr("At %1. The school's receipt is not here yet: below stands what this station signed. Your work goes "
                 "to the school by itself.")
                  .arg(at)
            : tr("At %1. The school has your work; below stands its receipt. A teacher decides about the result.")
                  .arg(at));
    if (text_->toPlainText() != text()) text_->setPlainText(text());
    if (!isVisible()) QDialog::show();
}

}  // namespace handpiece::desktop
