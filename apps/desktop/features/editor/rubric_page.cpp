// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/rubric_page.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSplitter>
#include <QTabWidget>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <utility>

#include "desktop/features/editor/curve_view.h"
#include "desktop/features/editor/editor_words.h"
#include "desktop/features/editor/list_table.h"
#include "desktop/framework/language.h"
#include "desktop/framework/problem.h"
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
    shipped_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    shipped_->setMinimumContentsLength(20);
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
    tabs_ = named(new QTabWidget(this), "editorRubricTabs", tr("Parts of the rubric"));
    tabs_->addTab(criteriaTab(), tr("Criteria"));
    tabs_->addTab(wholeTab(), tr("Bands, steps, rules"));
    tabs_->addTab(textsTab(), tr("Words"));
    column->addWidget(tabs_, 1);
    whole_ = note({}, this, "editorRubricNote");
    whole_->setTextFormat(Qt::PlainText);
    whole_->setMaximumHeight(32);  // the list under the pages has all of it
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
    connect(mark_, &DecimalField::valueChanged, this, setMark);
}

QWidget* RubricPage::criteriaTab() {
    auto* page = new QWidget(this);
    auto* column = new QVBoxLayout(page);
    addTable();
    auto* split = new QSplitter(Qt::Vertical, page);
    split->setChildrenCollapsible(false);
    split->addWidget(table_);
    split->addWidget(details());
    split->setStretchFactor(0, 3);
    split->setStretchFactor(1, 1);
    column->addWidget(split, 1);
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
    mark_ = named(new DecimalField(this), "editorPassMark", tr("Pass mark"), tr("Of the greatest score"));
    mark_->setRange(0.1, 100);
    mark_->setDecimals(1);
    mark_->setValue(60);
    mark_->setSuffix(QStringLiteral(" %"));
    below->addWidget(hasMark_);
    below->addWidget(mark_);
    column->addLayout(below);
    return page;
}

QWidget* RubricPage::details() {
    auto* box = new QWidget(this);
    auto* columns = new QHBoxLayout(box);
    columns->setContentsMargins(0, 4, 0, 0);
    auto* form = new QFormLayout;
    of_ = heading({}, box);
    of_->setObjectName(QStringLiteral("editorDetailsOf"));
    form->addRow(of_);
    const auto line = [&](const char* name, const QString& words, const QString& tip, auto read) {
        auto* field = named(new QLineEdit(box), name, words, tip);
        form->addRow(words, field);
        connect(field, &QLineEdit::editingFinished, this, [this, field, name, read] {
            if (showing_ || !field->isModified()) return;
            field->setModified(false);
            const std::string text = field->text().trimmed().toStdString();
            changeCriterion(name, [&](rubric::Criterion& c) { read(c, text); });
        });
        return field;
    };
    devices_ = line("editorDevices", tr("Only for"),
                    tr("Devices that it is valid for: <code>pointer, falcon</code>; none: all"),
                    [](rubric::Criterion& c, const std::string& text) { c.devices = draft::readNames(text); });
    excludes_ = line("editorExcludes", tr("Makes void"), tr("Criteria that do not count where this one fails"),
                     [](rubric::Criterion& c, const std::string& text) { c.excludes = draft::readNames(text); });
    status_ = named(new QComboBox(box), "editorStatus", tr("Its figures are"));
    status_->addItem(tr("as the rubric's"));
    for (const rubric::Status one : {rubric::Status::published, rubric::Status::adapted, rubric::Status::proposal})
        status_->addItem(statusWords(one));
    form->addRow(tr("Its figures are"), status_);
    connect(status_, &QComboBox::activated, this, [this](int index) {
        changeCriterion("", [&](rubric::Criterion& c) {
            c.status = index == 0 ? std::nullopt : std::optional(static_cast<rubric::Status>(index - 1));
        });
    });
    source_ = line("editorSource", tr("Source"), tr("Where the figures are from"),
                   [](rubric::Criterion& c, const std::string& text) { c.source = text; });
    columns->addLayout(form, 1);
    curve_ = new CurveView(box);
    columns->addWidget(curve_, 1);
    connect(curve_, &CurveView::knotsChanged, this, [this](const std::vector<rubric::Knot>& knots) {
        unread_.erase({table_->currentRow(), kKnots});
        changeCriterion("", [&](rubric::Criterion& c) { c.knots = knots; });
    });
    connect(table_, &QTableWidget::currentCellChanged, this, [this] { showDetails(); });
    return box;
}

QWidget* RubricPage::wholeTab() {
    auto* page = new QWidget(this);
    auto* column = new QVBoxLayout(page);
    auto* form = new QFormLayout;
    const auto line = [&](const char* name, const QString& words, const QString& tip, auto read) {
        auto* field = named(new QLineEdit(page), name, words, tip);
        form->addRow(words, field);
        connect(field, &QLineEdit::editingFinished, this, [this, field, read] {
            if (showing_ || !field->isModified()) return;
            field->setModified(false);
            const std::string text = field->text().trimmed().toStdString();
            try {
                rubric::Rubric tried = *now_;
                read(tried, text);
                changeRubric([&](rubric::Rubric& r) { r = tried; });
                field->setStyleSheet({});
            } catch (const core::Error& error) {
                field->setStyleSheet(QStringLiteral("background: rgba(220, 60, 60, 70)"));
                field->setToolTip(problemOf(error).what);
            }
        });
        return field;
    };
    id_ = line("editorRubricId", tr("Short name"), tr("Small letters, digits, '-', '.'"),
               [](rubric::Rubric& r, const std::string& text) { r.id = text; });
    version_ = line("editorRubricVersion", tr("Version"), tr("Another one with each change to be told apart"),
                    [](rubric::Rubric& r, const std::string& text) { r.version = text; });
    wholeStatus_ = named(new QComboBox(page), "editorRubricStatus", tr("Its figures are"));
    for (const rubric::Status one : {rubric::Status::published, rubric::Status::adapted, rubric::Status::proposal})
        wholeStatus_->addItem(statusWords(one));
    form->addRow(tr("Its figures are"), wholeStatus_);
    connect(wholeStatus_, &QComboBox::activated, this, [this](int index) {
        changeRubric([&](rubric::Rubric& r) { r.status = static_cast<rubric::Status>(index); });
    });
    wholeSource_ = line("editorRubricSource", tr("Source"), tr("Where the figures are from"),
                        [](rubric::Rubric& r, const std::string& text) { r.source = text; });
    total_ = line("editorRubricTotal", tr("Weights sum to"), tr("A check against slips; empty: none"),
                  [](rubric::Rubric& r, const std::string& text) { r.totalWeight = draft::readNumber(text); });
    done_ = line("editorRubricDone", tr("How far it is done"),
                 tr("Target removed in % and the factor of all points, as in 0: 0, 50: 0.5, 70: 1; empty: all points "
                    "count however little is done"),
                 [](rubric::Rubric& r, const std::string& text) {
                     rubric::Criterion knots;
                     draft::readKnots(knots, text);
                     if (knots.knots.empty()) return r.completeness.reset();
                     if (!r.completeness)
                         r.completeness = {"removed-share", "%", {"target", {}, {}, {}, {}}, {}, {}, {}, {}, 0};
                     r.completeness->knots = knots.knots;
                 });
    column->addLayout(form);
    const ListTable::Change how = [this](const auto& what) { changeRubric(what); };
    const auto named_ = [](auto list, const char* stem) {
        for (std::size_t number = list.size() + 1;; ++number) {
            std::string id = stem + std::to_string(number);
            if (std::none_of(list.begin(), list.end(), [&](const auto& one) { return one.id == id; })) return id;
        }
    };
    bands_ = new ListTable(
        "editorBandNames", tr("Bands, from best to worst"),
        {[](const rubric::Rubric& r) { return r.bands.size(); },
         [](const rubric::Rubric& r, std::size_t row, int) { return QString::fromStdString(r.bands[row].id); },
         [](rubric::Rubric& r, std::size_t row, int, const std::string& text) { draft::renameBand(r, row, text); },
         [named_](rubric::Rubric& r) {
             r.bands.push_back({named_(r.bands, "band-"), {}});
         },
         [](rubric::Rubric& r, std::size_t row) { draft::removeBand(r, row); },
         [](rubric::Rubric& r, std::size_t a, std::size_t b) { std::swap(r.bands[a], r.bands[b]); }},
        how, page);
    bands_->setColumns({tr("Name")}, {200});
    steps_ = new ListTable(
        "editorSteps", tr("Steps, in the order of the work"),
        {[](const rubric::Rubric& r) { return r.steps.size(); },
         [](const rubric::Rubric& r, std::size_t row, int column_) {
             const rubric::Step& step = r.steps[row];
             return QString::fromStdString(column_ == 0 ? step.id : draft::namesCell(step.criteria));
         },
         [](rubric::Rubric& r, std::size_t row, int column_, const std::string& text) {
             if (column_ == 0)
                 r.steps[row].id = text;
             else
                 r.steps[row].criteria = draft::readNames(text);
         },
         [named_](rubric::Rubric& r) {
             r.steps.push_back({named_(r.steps, "step-"), {}, {}, 0});
         },
         [](rubric::Rubric& r, std::size_t row) { r.steps.erase(r.steps.begin() + static_cast<long>(row)); },
         [](rubric::Rubric& r, std::size_t a, std::size_t b) { std::swap(r.steps[a], r.steps[b]); }},
        how, page);
    steps_->setColumns({tr("Name"), tr("Criteria")}, {120, 420});
    rules_ = new ListTable(
        "editorRules", tr("Rules"),
        {[](const rubric::Rubric& r) { return r.rules.size(); },
         [](const rubric::Rubric& r, std::size_t row, int column_) {
             const rubric::Rule& rule = r.rules[row];
             switch (column_) {
                 case 0:
                     return QString::fromStdString(rule.id);
                 case 1:
                     return QString::fromStdString(draft::needsCell(rule));
                 case 2:
                     return rule.required ? tr("yes") : tr("no");
                 case 3:
                     return rule.elseAtMost ? QString::number(*rule.elseAtMost, 'g', 12) : QString();
                 default:
                     return QString::fromStdString(rule.source);
             }
         },
         [](rubric::Rubric& r, std::size_t row, int column_, const std::string& text) {
             rubric::Rule& rule = r.rules[row];
             if (column_ == 0) draft::renameRule(r, row, text);
             if (column_ == 1) draft::readNeeds(rule, text);
             if (column_ == 2) {
                 const QString said = QString::fromStdString(text);
                 if (said != tr("yes") && said != tr("no"))
                     throw core::Error(fmt::format("\"{}\" cannot be read", text), {}, "write yes or no")
                         .as("cell-unreadable", {text, tr("yes").toStdString() + ", " + tr("no").toStdString()});
                 rule.required = said == tr("yes");
             }
             if (column_ == 3) rule.elseAtMost = draft::readNumber(text);
             if (column_ == 4) rule.source = text;
         },
         [named_](rubric::Rubric& r) {
             rubric::Rule made;
             made.id = named_(r.rules, "rule-");
             rubric::Condition need;
             if (!r.bands.empty()) need.bands = {r.bands.back().id};
             need.most = 0;
             made.needs = {need};
             made.required = true;
             r.rules.push_back(std::move(made));
         },
         [](rubric::Rubric& r, std::size_t row) { draft::removeRule(r, row); },
         [](rubric::Rubric& r, std::size_t a, std::size_t b) { std::swap(r.rules[a], r.rules[b]); }},
        how, page);
    rules_->setColumns({tr("Name"), tr("Needs"), tr("To pass"), tr("Else at most [%]"), tr("Source")},
                       {120, 330, 60, 110, 160});
    rules_->table()->setToolTip(
        tr("Needs: bands, then of which criteria, then how many: <code>unacceptable most 0; modify of depth, outline "
           "most 2; rule other</code>"));
    auto* lists = new QHBoxLayout;
    lists->addWidget(bands_, 1);
    lists->addWidget(steps_, 2);
    column->addLayout(lists, 1);
    column->addWidget(rules_, 1);
    return page;
}

QWidget* RubricPage::textsTab() {
    auto* page = new QWidget(this);
    auto* column = new QVBoxLayout(page);
    texts_ = new ListTable(
        "editorRubricTexts", tr("Words by language"),
        {[](const rubric::Rubric& r) {
             rubric::Rubric copy = r;
             return draft::textsOf(copy).size();
         },
         [this](const rubric::Rubric& r, std::size_t row, int column_) {
             rubric::Rubric copy = r;
             const draft::TextPlace place = draft::textsOf(copy)[row];
             if (column_ == 0) return textPlaceWords(place);
             return inOf(*place.texts, languages().value(column_ - 1).toStdString().c_str());
         },
         [this](rubric::Rubric& r, std::size_t row, int column_, const std::string& text) {
             put(*draft::textsOf(r)[row].texts, languages().value(column_ - 1).toStdString().c_str(),
                 QString::fromStdString(text));
         },
         {},
         {},
         {},
         1},
        [this](const auto& what) { changeRubric(what); }, page);
    column->addWidget(texts_, 1);
    auto* row = new QHBoxLayout;
    language_ =
        named(new QLineEdit(page), "editorRubricLanguage", tr("Another language"), tr("Its tag: de, fr, pt-BR, ..."));
    language_->setPlaceholderText(tr("Its tag: de, fr, pt-BR, ..."));
    auto* add = named(new QPushButton(tr("Add language"), page), "editorRubricAddLanguage", tr("Add language"));
    add->setAutoDefault(false);
    connect(add, &QPushButton::clicked, this, [this] {
        const QString tag = language_->text().trimmed();
        if (tag.isEmpty() || languages().contains(tag)) return;
        added_ << tag;
        language_->clear();
        showWhole();
    });
    row->addWidget(language_);
    row->addWidget(add);
    row->addStretch(1);
    column->addLayout(row);
    return page;
}

QStringList RubricPage::languages() const {
    QStringList tags{QStringLiteral("en"), QStringLiteral("ja")};
    if (now_) {
        rubric::Rubric copy = *now_;
        for (const draft::TextPlace& place : draft::textsOf(copy))
            for (const auto& [tag, text] : *place.texts)
                if (!tags.contains(QString::fromStdString(tag))) tags << QString::fromStdString(tag);
    }
    for (const QString& tag : added_)
        if (!tags.contains(tag)) tags << tag;
    return tags;
}

void RubricPage::changeCriterion(const char* step, const std::function<void(rubric::Criterion&)>& how) {
    const int row = table_->currentRow();
    if (showing_ || row < 0 || !now_ || static_cast<std::size_t>(row) >= now_->criteria.size()) return;
    change_(step, [&](Content& c) { how(c.rubric->criteria[static_cast<std::size_t>(row)]); });
}

void RubricPage::changeRubric(const std::function<void(rubric::Rubric&)>& how) {
    if (showing_) return;
    unread_.clear();
    change_("", [&](Content& c) {
        if (!c.rubric) c.rubric = empty();
        how(*c.rubric);
    });
}

void RubricPage::showDetails() {
    const bool was = std::exchange(showing_, true);
    const int row = table_->currentRow();
    const rubric::Criterion* c = now_ && row >= 0 && static_cast<std::size_t>(row) < now_->criteria.size()
                                     ? &now_->criteria[static_cast<std::size_t>(row)]
                                     : nullptr;
    for (QWidget* field : std::initializer_list<QWidget*>{devices_, excludes_, source_, status_, curve_})
        field->setEnabled(c != nullptr);
    of_->setText(c ? tr("Of \"%1\"").arg(QString::fromStdString(c->id)) : tr("Choose a criterion"));
    const rubric::Criterion none;
    const rubric::Criterion& of = c ? *c : none;
    const auto set = [](QLineEdit* field, const std::string& text) {
        if (!field->hasFocus() || !field->isModified()) field->setText(QString::fromStdString(text));
    };
    set(devices_, draft::namesCell(of.devices));
    set(excludes_, draft::namesCell(of.excludes));
    set(source_, of.source);
    status_->setCurrentIndex(of.status ? 1 + static_cast<int>(*of.status) : 0);
    const measures::MeasureKind* kind = measures::findMeasureKind(of.measure);
    curve_->setCurve(of.knots, QString::fromStdString(of.unit), kind ? kind->least : 0.0, kind ? kind->most : 1e12);
    showing_ = was;
}

void RubricPage::showWhole() {
    const bool was = std::exchange(showing_, true);
    const rubric::Rubric* r = now_ ? &*now_ : nullptr;
    const rubric::Rubric none;
    const rubric::Rubric& of = r ? *r : none;
    const auto set = [r](QLineEdit* field, const std::string& text) {
        field->setEnabled(r != nullptr);
        if (!field->hasFocus() || !field->isModified()) field->setText(QString::fromStdString(text));
    };
    set(id_, of.id);
    set(version_, of.version);
    set(wholeSource_, of.source);
    rubric::Criterion knots;
    if (of.completeness) knots.knots = of.completeness->knots;
    set(done_, draft::knotsCell(knots));
    set(total_, of.totalWeight ? fmt::format("{}", *of.totalWeight) : std::string());
    wholeStatus_->setEnabled(r != nullptr);
    wholeStatus_->setCurrentIndex(static_cast<int>(of.status));
    const QStringList tags = languages();
    std::vector<int> widths{230};
    QStringList titles{tr("What")};
    for (const QString& tag : tags) {
        const QString name = tag == QLatin1String("en") || tag == QLatin1String("ja") ? Language::nameOf(tag)
                             : QLocale(tag).language() == QLocale::C                  ? tag
                                                                     : QLocale(tag).nativeLanguageName();
        titles << (name.isEmpty() || name == tag ? tag : QStringLiteral("%1 (%2)").arg(name, tag));
        widths.push_back(270);
    }
    if (texts_->table()->columnCount() != titles.size()) texts_->setColumns(titles, widths);
    for (ListTable* list : {bands_, steps_, rules_, texts_})
        list->show(r);
    showing_ = was;
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
            measure->addItem(measureWords(kind.id), words(kind.id));
            measure->setItemData(measure->count() - 1, words(kind.says), Qt::ToolTipRole);
        }
        table_->setCellWidget(row, kMeasure, measure);
        connect(measure, &QComboBox::activated, this, [this, row, measure] {
            const measures::MeasureKind* kind =
                measures::findMeasureKind(measure->currentData().toString().toStdString());
            if (kind == nullptr) return;
            change_("", [&](Content& content) {
                rubric::Criterion& criterion = content.rubric->criteria.at(static_cast<std::size_t>(row));
                criterion.measure = kind->id;
                criterion.unit = kind->unit;
            });
        });
    }
    const QString id = QString::fromStdString(c.measure);
    if (measure->findData(id) < 0) measure->addItem(id, id);  // of a file: the linter tells
    measure->setCurrentIndex(measure->findData(id));
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
    // The one that is here is the one that is named, until a person looks for another.
    if (content.rubric && (!now_ || now_->id != content.rubric->id))
        if (const int at = shipped_->findData(QString::fromStdString(content.rubric->id)); at >= 0)
            shipped_->setCurrentIndex(at);
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
    now_ = content.rubric;
    hasMark_->setEnabled(content.rubric.has_value());
    const bool hasMark = content.rubric && content.rubric->passMark;
    hasMark_->setChecked(hasMark);
    mark_->setEnabled(hasMark);
    const double mark = hasMark ? *content.rubric->passMark : mark_->value();
    if (std::abs(mark_->value() - mark) > 0.05) mark_->setValue(mark);
    showing_ = false;
    if (count > 0 && table_->currentRow() < 0) table_->setCurrentCell(0, kId);
    showDetails();
    showWhole();
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
                throw core::Error("a weight is a number above 0", {}, "none: shown, not graded").as("cell-weight");
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
        const Problem problem = problemOf(error);
        unread_[{row, column}] = {text, problem.what + QLatin1Char(' ') + problem.remedy};
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
        const QString said = problemWords(p);
        if (p.criterion.empty()) {
            // Without criteria there is only this to be remarked.
            const bool isUnjudged = ids_.empty() && p.severity == rubric::Severity::remark;
            whole << (isUnjudged ? tr("It is not judged: take a rubric that comes along.") : said);
            continue;
        }
        for (std::size_t i = 0; i < ids_.size(); ++i)
            if (ids_[i] == p.criterion) {
                rows[i] << problemWords(p, false);
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
