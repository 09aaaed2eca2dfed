// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/rubric_page.h"

#include <QCheckBox>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QLocale>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "desktop/widgets/parts.h"
#include "handpiece/assess/draft/cells.h"
#include "handpiece/base/core/error.h"

namespace handpiece::desktop {
namespace {

using draft::Content;

QString words(std::string_view text) {
    return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}
QString inOf(const cases::Texts& texts, const char* language) {
    const auto at = texts.find(language);
    return at == texts.end() ? QString() : QString::fromStdString(at->second);
}
void put(cases::Texts& texts, const char* language, const QString& text) {
    if (text.isEmpty())
        texts.erase(language);
    else
        texts[language] = text.toStdString();
}
rubric::Rubric empty() {
    rubric::Rubric made;
    made.id = "own";
    made.version = "1";
    made.title = {{"en", "Own rubric"}};
    for (const char* id : {"ideal", "acceptable", "modify", "unacceptable"})
        made.bands.push_back({id, {{"en", id}}});
    return made;
}

}  // namespace

RubricPage::RubricPage(Change change) : EditorPage(std::move(change)) {
    setObjectName(QStringLiteral("editorJudgement"));
    auto* column = new QVBoxLayout(this);
    auto* above = new QHBoxLayout;
    shipped_ = named(new QComboBox(this), "editorShipped", tr("A rubric that comes along"));
    const std::string language = QLocale().bcp47Name().toStdString();
    for (const std::string& name : rubric::shippedRubrics()) {
        const rubric::Rubric one = rubric::shippedRubric(name);
        shipped_->addItem(QString::fromStdString(std::string(cases::inLanguage(one.title, language))),
                          QString::fromStdString(name));
    }
    auto* take = named(new QPushButton(tr("Take this rubric"), this), "editorTakeRubric", tr("Take this rubric"),
                       tr("In the place of the one that is there; Undo brings that back"));
    none_ = named(new QPushButton(tr("Not judged"), this), "editorNoRubric", tr("Not judged"));
    above->addWidget(new QLabel(tr("A rubric that comes along"), this));
    above->addWidget(shipped_);
    above->addWidget(take);
    above->addWidget(none_);
    above->addStretch(1);
    column->addLayout(above);
    addTable();
    column->addWidget(table_, 1);
    auto* below = new QHBoxLayout;
    const auto button = [&](const QString& text, const char* name, auto asked) {
        auto* made = named(new QPushButton(text, this), name, text);
        connect(made, &QPushButton::clicked, this, asked);
        below->addWidget(made);
        return made;
    };
    add_ = button(tr("Add criterion"), "editorAddCriterion", [this] {
        change_("", [](Content& c) {
            if (!c.rubric) c.rubric = empty();
            rubric::Criterion made;
            int number = static_cast<int>(c.rubric->criteria.size()) + 1;
            while (c.rubric->criterion("criterion-" + std::to_string(number)) != nullptr)
                ++number;
            made.id = "criterion-" + std::to_string(number);
            made.measure = "floor-depth";
            made.unit = "mm";
            c.rubric->criteria.push_back(std::move(made));
        });
        table_->setCurrentCell(table_->rowCount() - 1, kId);
    });
    remove_ = button(tr("Remove"), "editorRemoveCriterion", [this] {
        const int row = table_->currentRow();
        if (row < 0) return;
        unread_.clear();
        change_("", [row](Content& c) { draft::removeCriterion(*c.rubric, static_cast<std::size_t>(row)); });
    });
    up_ = button(tr("Up"), "editorCriterionUp", [this] { move(-1); });
    down_ = button(tr("Down"), "editorCriterionDown", [this] { move(1); });
    below->addStretch(1);
    sum_ = note({}, this, "editorWeights");
    sum_->setWordWrap(false);
    below->addWidget(sum_);
    hasMark_ = named(new QCheckBox(tr("Pass from"), this), "editorHasPassMark", tr("There is a pass mark"));
    mark_ = named(new QSpinBox(this), "editorPassMark", tr("Pass mark"), tr("Of the greatest score"));
    mark_->setRange(1, 100);
    mark_->setValue(60);
    mark_->setSuffix(QStringLiteral(" %"));
    below->addWidget(hasMark_);
    below->addWidget(mark_);
    column->addLayout(below);
    whole_ = note({}, this, "editorRubricNote");
    whole_->setTextFormat(Qt::PlainText);
    column->addWidget(whole_);

    connect(take, &QPushButton::clicked, this, [this] {
        const std::string name = shipped_->currentData().toString().toStdString();
        unread_.clear();
        change_("", [&](Content& c) {
            c.rubricText = rubric::shippedRubricText(name);
            c.rubric = rubric::parseRubric(c.rubricText, "the rubric");
        });
    });
    connect(none_, &QPushButton::clicked, this, [this] {
        unread_.clear();
        change_("", [](Content& c) { c.rubric.reset(); });
    });
    const auto setMark = [this] {
        if (showing_) return;
        change_("pass mark", [this](Content& c) {
            if (c.rubric)
                c.rubric->passMark = hasMark_->isChecked() ? std::optional<double>(mark_->value()) : std::nullopt;
        });
    };
    connect(hasMark_, &QCheckBox::toggled, this, setMark);
    connect(mark_, &QSpinBox::valueChanged, this, setMark);
}

void RubricPage::addTable() {
    table_ =
        named(new QTableWidget(0, kColumns, this), "editorCriteria", tr("Criteria"),
              tr("Points: value: points, from 0 to 100, straight between. Bands: name from..to; ... Critical: < or >"));
    table_->setHorizontalHeaderLabels({tr("Criterion"), tr("Measure"), tr("Of"), tr("Unit"),
                                       tr("Points (value: points)"), tr("Bands"), tr("Weight"), tr("Critical"),
                                       tr("English"), tr("Japanese"), tr("To mend")});
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    table_->verticalHeader()->setDefaultSectionSize(30);
    const int widths[kColumns] = {110, 170, 150, 46, 220, 230, 56, 90, 150, 150, 320};
    for (int i = 0; i < kColumns; ++i)
        table_->setColumnWidth(i, widths[i]);
    connect(table_, &QTableWidget::cellChanged, this, &RubricPage::takeCell);
}

void RubricPage::setCell(int row, Column column, const QString& text, bool isFixed) {
    QTableWidgetItem* item = table_->item(row, column);
    if (item == nullptr) {
        item = new QTableWidgetItem;
        if (isFixed) item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable);
        table_->setItem(row, column, item);
    }
    const auto wrong = unread_.find({row, column});
    item->setText(wrong == unread_.end() ? text : wrong->second.text);
    item->setToolTip(wrong == unread_.end() ? text : wrong->second.why);
    item->setBackground(wrong == unread_.end() ? QBrush() : QBrush(QColor(220, 60, 60, 70)));
}

void RubricPage::showRow(int row, const rubric::Criterion& c) {
    setCell(row, kId, QString::fromStdString(c.id));
    auto* measure = qobject_cast<QComboBox*>(table_->cellWidget(row, kMeasure));
    if (measure == nullptr) {
        measure = new QComboBox(table_);
        measure->setObjectName(QStringLiteral("editorMeasure_%1").arg(row + 1));
        measure->setAccessibleName(tr("Measure"));
        for (const measures::MeasureKind& kind : measures::measureKinds()) {
            measure->addItem(words(kind.id));
            measure->setItemData(measure->count() - 1, words(kind.says), Qt::ToolTipRole);
        }
        table_->setCellWidget(row, kMeasure, measure);
        connect(measure, &QComboBox::activated, this, [this, row, measure] {
            const measures::MeasureKind* kind = measures::findMeasureKind(measure->currentText().toStdString());
            if (kind == nullptr) return;
            change_("", [&](Content& content) {
                rubric::Criterion& criterion = content.rubric->criteria.at(static_cast<std::size_t>(row));
                criterion.measure = kind->id;
                criterion.unit = kind->unit;
            });
        });
    }
    const QString id = QString::fromStdString(c.measure);
    if (measure->findText(id) < 0) measure->addItem(id);  // of a file: the linter tells
    measure->setCurrentIndex(measure->findText(id));
    const measures::MeasureKind* kind = measures::findMeasureKind(c.measure);
    measure->setToolTip(kind ? words(kind->says) : QString());
    setCell(row, kOf, QString::fromStdString(draft::selectionCell(c)));
    setCell(row, kUnit, QString::fromStdString(c.unit), true);
    setCell(row, kKnots, QString::fromStdString(draft::knotsCell(c)));
    setCell(row, kBands, QString::fromStdString(draft::bandsCell(c)));
    setCell(row, kWeight, c.isGraded() ? QString::number(c.weight) : QString());
    setCell(row, kCritical, QString::fromStdString(draft::criticalCell(c)));
    setCell(row, kTitleEn, inOf(c.title, "en"));
    setCell(row, kTitleJa, inOf(c.title, "ja"));
    setCell(row, kFinding, {}, true);
}

void RubricPage::show(const Content& content) {
    showing_ = true;
    const QSignalBlocker blocker(table_);
    const std::size_t count = content.rubric ? content.rubric->criteria.size() : 0;
    if (static_cast<int>(count) != table_->rowCount()) {
        unread_.clear();
        table_->setRowCount(static_cast<int>(count));
    }
    ids_.clear();
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const rubric::Criterion& c = content.rubric->criteria[i];
        ids_.push_back(c.id);
        sum += c.weight;
        showRow(static_cast<int>(i), c);
    }
    sum_->setText(content.rubric ? tr("Weights: %1").arg(sum) : QString());
    none_->setEnabled(content.rubric.has_value());
    hasMark_->setEnabled(content.rubric.has_value());
    const std::optional<double> passMark = content.rubric ? content.rubric->passMark : std::nullopt;
    hasMark_->setChecked(passMark.has_value());
    mark_->setEnabled(passMark.has_value());
    if (passMark) mark_->setValue(static_cast<int>(std::lround(*passMark)));
    showing_ = false;
    showFindings();
}

void RubricPage::read(rubric::Criterion& c, Column column, const QString& text) const {
    const std::string typed = text.trimmed().toStdString();
    switch (column) {
        case kOf:
            draft::readSelection(c, typed);
            break;
        case kKnots:
            draft::readKnots(c, typed);
            break;
        case kBands:
            draft::readBands(c, typed);
            break;
        case kWeight: {
            bool isNumber = false;
            const double weight = text.trimmed().isEmpty() ? 0.0 : text.toDouble(&isNumber);
            if (!text.trimmed().isEmpty() && !(isNumber && weight > 0.0 && weight <= 1e12))
                throw core::Error("a weight is a number above 0", {}, "none: shown, not graded");
            c.weight = weight;
            break;
        }
        case kCritical:
            draft::readCritical(c, typed);
            break;
        case kTitleEn:
            put(c.title, "en", text);
            break;
        case kTitleJa:
            put(c.title, "ja", text);
            break;
        default:
            break;
    }
}

void RubricPage::takeCell(int row, int column) {
    const QString text = table_->item(row, column)->text();
    try {
        change_("", [&](Content& c) {
            const auto which = static_cast<std::size_t>(row);
            if (column == kId)
                draft::renameCriterion(*c.rubric, which, text.trimmed().toStdString());
            else
                read(c.rubric->criteria.at(which), static_cast<Column>(column), text);
            if (column == kWeight) draft::restateTotal(*c.rubric);
            unread_.erase({row, column});
        });
    } catch (const core::Error& error) {
        unread_[{row, column}] = {text, QString::fromStdString(error.problem() + "; " + error.remedy())};
        const QSignalBlocker blocker(table_);
        setCell(row, static_cast<Column>(column), text);
        showFindings();
    }
}

void RubricPage::move(int by) {
    const int row = table_->currentRow(), other = row + by;
    if (row < 0 || other < 0 || other >= table_->rowCount()) return;
    unread_.clear();
    change_("", [&](Content& c) {
        std::swap(c.rubric->criteria[static_cast<std::size_t>(row)],
                  c.rubric->criteria[static_cast<std::size_t>(other)]);
    });
    table_->setCurrentCell(other, kId);
}

void RubricPage::setProblems(const std::vector<draft::Problem>& problems) {
    problems_ = problems;
    showFindings();
}

void RubricPage::showFindings() {
    const QSignalBlocker blocker(table_);
    QStringList whole;
    std::vector<QStringList> rows(ids_.size());
    std::vector<bool> wrong(ids_.size());
    for (const auto& [where, unread] : unread_)
        if (static_cast<std::size_t>(where.first) < rows.size()) {
            rows[static_cast<std::size_t>(where.first)] << unread.why;
            wrong[static_cast<std::size_t>(where.first)] = true;
        }
    for (const draft::Problem& p : problems_) {
        if (p.part != draft::Part::judgement) continue;
        QString said = QString::fromStdString(p.what);
        if (!p.remedy.empty()) said += QStringLiteral(" (") + QString::fromStdString(p.remedy) + QLatin1Char(')');
        if (p.criterion.empty()) {
            // Without criteria there is only this to be remarked.
            const bool isUnjudged = ids_.empty() && p.severity == rubric::Severity::remark;
            whole << (isUnjudged ? tr("It is not judged: take a rubric that comes along.") : said);
            continue;
        }
        for (std::size_t i = 0; i < ids_.size(); ++i)
            if (ids_[i] == p.criterion) {
                rows[i] << said.mid(static_cast<qsizetype>(p.criterion.size()) + 2);
                wrong[i] = wrong[i] || p.severity == rubric::Severity::error;
            }
    }
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (const Column column : {kId, kFinding}) {
            QTableWidgetItem* item = table_->item(static_cast<int>(i), column);
            if (item == nullptr) continue;
            // The column of findings may be out of sight.
            if (column == kFinding) item->setText(rows[i].join(QStringLiteral("; ")));
            item->setToolTip(rows[i].join(QLatin1Char('\n')));
            item->setBackground(wrong[i] ? QBrush(QColor(220, 60, 60, 70)) : QBrush());
        }
    whole_->setText(whole.join(QLatin1Char('\n')));
}

}  // namespace handpiece::desktop
