// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/marking/agreement_page.h"

#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QLocale>
#include <QPainter>
#include <QSplitter>
#include <QTreeWidget>
#include <QVBoxLayout>

#include "desktop/widgets/parts.h"
#include "handpiece/app/report/assessment_words.h"

namespace handpiece::desktop {
namespace {

QString numberText(double value) {
    return QLocale().toString(value, 'f', 3);
}

}  // namespace

SvgView::SvgView(QWidget* parent) : QWidget(parent) {
    setMinimumHeight(160);
}

void SvgView::setSvg(const std::string& svg) {
    QByteArray text = QByteArray::fromStdString(svg);
    // Qt knows no media rules, which come last in the style, and no sizes in per cent: the page is painted here.
    const auto remove = [&text](const char* first, const char* before) {
        const qsizetype from = text.indexOf(first), to = text.indexOf(before, from);
        if (from >= 0 && to > from) text.remove(from, to - from);
    };
    remove("@media", "</style>");
    remove("<rect class=\"hp-page\"", "\n");
    if (text.isEmpty())
        renderer_.load(QByteArrayLiteral("<svg xmlns=\"http://www.w3.org/2000/svg\"/>"));
    else
        renderer_.load(text);
    renderer_.setAspectRatioMode(Qt::KeepAspectRatio);
    update();
}

void SvgView::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.fillRect(rect(), Qt::white);
    if (renderer_.isValid()) renderer_.render(&painter, QRectF(rect()));
}

AgreementPage::AgreementPage(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("agreementPage"));
    table_ = named(new QTreeWidget(this), "agreementTable", tr("Agreement"),
                   tr("Weighted kappa (linear), ICC(2,1), Krippendorff's alpha, bias and limits of agreement, with "
                      "95 % intervals"));
    table_->setColumnCount(4);
    table_->setHeaderLabels({tr("Of"), tr("Works"), tr("Coefficient"), tr("Value (95 %)")});
    table_->header()->setSectionResizeMode(QHeaderView::ResizeToContents);
    which_ = named(new QComboBox(this), "agreementPicture", tr("Picture"));
    picture_ = named(new SvgView(this), "agreementPlot", tr("Plot of the agreement"));
    note_ = note({}, this, "agreementNote");
    note_->setTextFormat(Qt::PlainText);
    auto* below = new QWidget(this);
    auto* belowColumn = new QVBoxLayout(below);
    belowColumn->setContentsMargins(0, 0, 0, 0);
    belowColumn->addWidget(which_);
    belowColumn->addWidget(picture_, 1);
    auto* splitter = new QSplitter(Qt::Vertical, this);
    splitter->addWidget(table_);
    splitter->addWidget(below);
    auto* column = new QVBoxLayout(this);
    column->addWidget(splitter, 1);
    column->addWidget(note_);
    connect(which_, &QComboBox::currentIndexChanged, this, &AgreementPage::showPicture);
}

void AgreementPage::clear() {
    show({}, {});
}

void AgreementPage::setNote(const QString& text) {
    note_->setText(text);
    note_->setVisible(!text.isEmpty());
}

void AgreementPage::show(const marking::DeskAgreement& agreement, const QString& text) {
    agreement_ = agreement;
    const auto told = [](const agreement::Estimate& e, const std::optional<agreement::Interval>& interval) {
        if (!e.value) return tr("undefined: %1").arg(QString::fromStdString(report::said(e.reason)));
        if (!interval) return numberText(*e.value);
        return tr("%1 (%2 to %3)").arg(numberText(*e.value), numberText(interval->low), numberText(interval->high));
    };
    table_->clear();
    for (const assessment::CriterionAgreement& c : agreement.criteria) {
        auto* whole = new QTreeWidgetItem(
            table_, {QString::fromStdString(c.title.empty() ? c.criterion : c.title), QString::number(c.items)});
        const auto row = [&](const QString& of, std::size_t works, const QString& what, const QString& value) {
            new QTreeWidgetItem(whole, {of, QString::number(works), what, value});
        };
        for (const assessment::RaterPair& p : c.pairs) {
            const QString of = tr("%1 and %2")
                                   .arg(QString::fromStdString(marking::raterName(p.first)),
                                        QString::fromStdString(marking::raterName(p.second)));
            if (p.linear) row(of, p.items, tr("weighted kappa"), told(*p.linear, p.linear->interval));
            if (!p.blandAltman) continue;
            const agreement::BlandAltman& b = *p.blandAltman;
            row(of, p.items, tr("bias, limits of agreement"),
                b.bias ? tr("%1 (%2 to %3)").arg(numberText(*b.bias), numberText(*b.low), numberText(*b.high))
                       : tr("undefined: %1").arg(QString::fromStdString(report::said(b.reason))));
        }
        if (c.icc)
            row(tr("all raters"), c.wholeItems, QStringLiteral("ICC(2,1)"), told(c.icc->two1, c.icc->two1.interval));
        for (const assessment::Alpha& a : c.alphas)
            if (a.level == (c.areNumbers ? agreement::Level::interval : agreement::Level::ordinal))
                row(tr("all raters"), c.items, tr("Krippendorff's alpha"), told(a.estimate, a.bootstrap.interval));
        whole->setExpanded(true);
    }
    const QSignalBlocker quiet(which_);
    which_->clear();
    for (const marking::DeskAgreement::Picture& picture : agreement.pictures)
        which_->addItem(QString::fromStdString(picture.name));
    which_->setEnabled(which_->count() > 0);
    showPicture();
    setNote(text);
}

void AgreementPage::showPicture() {
    const auto at = static_cast<std::size_t>(std::max(0, which_->currentIndex()));
    picture_->setSvg(at < agreement_.pictures.size() ? agreement_.pictures[at].svg : std::string());
}

}  // namespace handpiece::desktop
