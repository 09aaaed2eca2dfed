// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/editor_pages.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "desktop/features/editor/editor_words.h"
#include "desktop/framework/helps.h"
#include "desktop/picture/solid_view.h"
#include "desktop/widgets/parts.h"
#include "desktop/work/bur_words.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/starter/block.h"

namespace handpiece::desktop {
namespace {

using draft::Content;

QString plain(std::string_view text) {
    return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}
/// The caret stays where one types.
void setText(QLineEdit* field, const QString& text) {
    if (field->text() != text) field->setText(text);
}
void setText(QPlainTextEdit* field, const QString& text) {
    if (field->toPlainText() != text) field->setPlainText(text);
}
/// A value that is typed keeps its text.
void setValue(QDoubleSpinBox* field, double value) {
    if (std::abs(field->value() - value) > 1e-9) field->setValue(value);
}
QDoubleSpinBox* millimetres(QWidget* parent, const char* name, const QString& words) {
    auto* field = named(new QDoubleSpinBox(parent), name, words);
    field->setRange(0.0, 3.0);
    field->setDecimals(2);
    field->setSingleStep(0.05);
    field->setSuffix(QStringLiteral(" mm"));
    return field;
}

}  // namespace

ToothPage::ToothPage(Change change) : EditorPage(std::move(change)) {
    setObjectName(QStringLiteral("editorTooth"));
    auto* form = new QFormLayout(this);
    now_ = note({}, this, "editorToothNow");
    now_->setTextFormat(Qt::PlainText);
    form->addRow(now_);
    form->addRow(heading(tr("A tooth of the program"), this));
    fdi_ = named(new QComboBox(this), "editorFdi", tr("Tooth"), tr("FDI number"));
    for (const int quadrant : {1, 2, 3, 4})
        for (int tooth = 1; tooth <= 8; ++tooth)
            fdi_->addItem(QString::number(10 * quadrant + tooth), 10 * quadrant + tooth);
    fdi_->setCurrentIndex(fdi_->findData(46));
    form->addRow(tr("Tooth (FDI)"), fdi_);
    seed_ =
        named(new QSpinBox(this), "editorSeed", tr("Patient"), tr("Another number is another patient; 0 the average"));
    seed_->setRange(0, 99999);
    seed_->setValue(1);
    form->addRow(tr("Patient"), seed_);
    const auto button = [&](const QString& text, const char* name, const QString& tip, auto asked) {
        auto* made = named(new QPushButton(text, this), name, text, tip);
        connect(made, &QPushButton::clicked, this, asked);
        buttons_.push_back(made);
        form->addRow(made);
    };
    button(tr("Take this tooth"), "editorTakeStarter", tr("With all its tissues, landmarks and the mouth around it"),
           [this] { emit starterRequested(fdi_->currentData().toInt(), seed_->value()); });
    form->addRow(heading(tr("A block, for the hand alone"), this));
    layers_ = named(new QComboBox(this), "editorLayers", tr("Layers"));
    layers_->addItems({tr("As hard as enamel"), tr("Enamel on dentine"), tr("With carious dentine")});
    form->addRow(tr("Layers"), layers_);
    button(tr("Take this block"), "editorTakeBlock", tr("16 x 12 x 8 mm, with a flat top"),
           [this] { emit blockRequested(layers_->currentIndex()); });
    form->addRow(heading(tr("A case of your own"), this));
    button(tr("Case file..."), "editorTakeCase", tr("A case with landmarks: folder or .handpiece file"),
           [this] { emit caseRequested(); });
    work_ = note({}, this, "editorToothWork");
    form->addRow(work_);
}

void ToothPage::show(const Content& content) {
    now_->setText(content.tooth ? tr("Now: %1, %2 landmarks")
                                      .arg(QString::fromStdString(content.tooth->name))
                                      .arg(content.tooth->landmarks.size())
                                : tr("Now: none"));
}

void ToothPage::setWork(const QString& text) {
    work_->setText(text);
    for (QWidget* button : buttons_)
        button->setEnabled(text.isEmpty());
}

PreparationPage::PreparationPage(Change change) : EditorPage(std::move(change)) {
    setObjectName(QStringLiteral("editorPreparation"));
    auto* columns = new QHBoxLayout(this);
    form_ = new QFormLayout;
    columns->addLayout(form_, 1);
    auto* beside = new QVBoxLayout;
    columns->addLayout(beside, 1);
    ideal_ = new SolidView("editorIdeal", this);
    ideal_->setAccessibleName(tr("The tooth as it is asked for"));
    idealButton_ =
        named(new QPushButton(tr("Show it on the tooth"), this), "editorShowIdeal", tr("Show it on the tooth"),
              tr("Cuts the tooth as the preparation asks for it; takes seconds"));
    beside->addWidget(ideal_, 1);
    beside->addWidget(idealButton_);
    connect(idealButton_, &QPushButton::clicked, this, &PreparationPage::idealRequested);
    template_ = named(new QComboBox(this), "editorTemplate", tr("Preparation"));
    template_->addItem(tr("Nothing is asked"), QString());
    for (const preparation::Template& t : preparation::templates())
        if (!t.isOwn) template_->addItem(templateWords(t.id), plain(t.id));
    form_->addRow(tr("Preparation"), template_);
    connect(template_, &QComboBox::activated, this, [this] {
        const std::string id = template_->currentData().toString().toStdString();
        change_("template", [&](Content& c) { c = draft::withTemplate(std::move(c), id); });
    });
    side_ = named(new QComboBox(this), "editorSide", tr("Side"));
    side_->addItem(tr("mesial"), QStringLiteral("mesial"));
    side_->addItem(tr("distal"), QStringLiteral("distal"));
    sideLabel_ = new QLabel(tr("Side"), this);
    form_->addRow(sideLabel_, side_);
    connect(side_, &QComboBox::activated, this, [this] {
        const std::string side = side_->currentData().toString().toStdString();
        change_("side", [&](Content& c) { c = draft::withSide(std::move(c), side); });
    });
    numbers_ = new QWidget(this);
    new QFormLayout(numbers_);
    form_->addRow(numbers_);
    form_->addRow(heading(tr("What may go beside it"), this));
    const auto row = [&](QDoubleSpinBox*& field, const char* name, const QString& words, const QString& tip, auto set) {
        field = millimetres(this, name, words);
        field->setToolTip(tip);
        form_->addRow(words, field);
        connect(field, &QDoubleSpinBox::valueChanged, this, [this, name, set](double value) {
            if (showing_) return;
            change_(name, [&](Content& c) {
                if (c.preparation) set(*c.preparation, value);
            });
        });
    };
    row(leewaySide_, "editorLeewaySide", tr("At the sides"), tr("Past the walls of the target"),
        [](preparation::Recipe& r, double v) { r.leeway.sideMm = v; });
    row(leewayFloor_, "editorLeewayFloor", tr("Under the floor"), tr("Deeper than the target"),
        [](preparation::Recipe& r, double v) { r.leeway.floorMm = v; });
    row(pulp_, "editorPulp", tr("Kept over the pulp"), tr("All within this of the pulp must stay; 0: the pulp alone"),
        [](preparation::Recipe& r, double v) { r.pulpMm = v; });
}

void PreparationPage::showNumbers(const preparation::Template* of) {
    auto* rows = static_cast<QFormLayout*>(numbers_->layout());
    while (rows->rowCount() > 0)
        rows->removeRow(0);
    fields_.clear();
    if (of == nullptr) return;
    for (const preparation::Parameter& p : of->parameters) {
        const std::string name(p.name);
        auto* field = new QDoubleSpinBox(numbers_);
        field->setObjectName(QStringLiteral("editorNumber_") + plain(p.name));
        field->setAccessibleName(parameterWords(p.name));
        field->setToolTip(tr("%1 to %2, usually %3").arg(p.least).arg(p.most).arg(p.usual));
        field->setRange(p.least, p.most);
        field->setDecimals(2);
        field->setSingleStep(name.ends_with("_deg") ? 1.0 : 0.1);
        field->setSuffix(QLatin1Char(' ') + parameterUnit(p.name));
        rows->addRow(parameterWords(p.name), field);
        connect(field, &QDoubleSpinBox::valueChanged, this, [this, name](double value) {
            if (showing_) return;
            change_(name.c_str(), [&](Content& c) {
                if (c.preparation) c.preparation->numbers[name] = value;
            });
        });
        fields_.emplace_back(name, field);
    }
}

void PreparationPage::setIdeal(std::shared_ptr<const std::vector<cases::Part>> parts, int buccalSign) {
    hasIdeal_ = parts != nullptr;
    if (!parts) return ideal_->setCaption(tr("Cutting the ideal..."), true);
    core::Box box;
    for (const cases::Part& part : *parts)
        for (const core::Vec3& v : part.mesh.vertices)
            box.extend(v);
    ideal_->setParts(parts, box);
    ideal_->setCaption(tr("As it is asked for: drag to turn it"), false);
    ideal_->lookFrom(view::StandardView::oblique, buccalSign);
}

void PreparationPage::clearIdeal() {
    hasIdeal_ = false;
    ideal_->setParts(nullptr, {});
    ideal_->setCaption({}, false);
}

void PreparationPage::show(const Content& content) {
    showing_ = true;
    const preparation::Recipe* recipe = content.preparation ? &*content.preparation : nullptr;
    const std::string id = recipe ? recipe->preparation : std::string();
    const preparation::Template* of = preparation::findTemplate(id);
    // Work and paint are no numbers: only an exercise that has them can keep them.
    if (of != nullptr && of->isOwn && template_->findData(QString::fromStdString(id)) < 0)
        template_->addItem(templateWords(of->id), plain(of->id));
    template_->setCurrentIndex(std::max(0, template_->findData(QString::fromStdString(id))));
    const bool hasSide = of != nullptr && of->hasSide;
    side_->setVisible(hasSide);
    sideLabel_->setVisible(hasSide);
    if (recipe) side_->setCurrentIndex(std::max(0, side_->findData(QString::fromStdString(recipe->side))));
    if (shown_ != id) showNumbers(of);
    shown_ = id;
    if (recipe)
        for (const auto& [name, field] : fields_)
            setValue(field, recipe->number(name));
    if (hasIdeal_) ideal_->setCaption(tr("Of before: show it again"), true);
    for (QDoubleSpinBox* field : {leewaySide_, leewayFloor_, pulp_})
        field->setEnabled(recipe != nullptr);
    const preparation::Recipe plainOne;
    const preparation::Recipe& r = recipe ? *recipe : plainOne;
    setValue(leewaySide_, r.leeway.sideMm);
    setValue(leewayFloor_, r.leeway.floorMm);
    setValue(pulp_, r.pulpMm);
    showing_ = false;
}

WorkPage::WorkPage(Change change) : EditorPage(std::move(change)) {
    setObjectName(QStringLiteral("editorWork"));
    auto* columns = new QHBoxLayout(this);
    auto* form = new QFormLayout;
    columns->addLayout(form, 1);
    bur_ = named(new QComboBox(this), "editorBur", tr("First bur"));
    bur_->addItem(tr("The student's choice"), QString());
    burs_ = named(new QListWidget(this), "editorBurs", tr("Burs allowed"), tr("None ticked: all of them"));
    for (const instrument::CatalogueEntry& bur : instrument::catalogue()) {
        const QString name = QString::fromStdString(bur.name);
        bur_->addItem(burTitle(name), name);
        auto* item = new QListWidgetItem(QStringLiteral("%1  ⌀ %2 mm").arg(burTitle(name)).arg(bur.diameterMm), burs_);
        item->setData(Qt::UserRole, name);
        item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsUserCheckable);
        item->setCheckState(Qt::Unchecked);
    }
    helps_ = named(new QListWidget(this), "editorHelps", tr("Helps that are locked"));
    for (const std::string_view help : cases::kHelps) {
        auto* item = new QListWidgetItem(helpWords(*helpOf(help)), helps_);
        item->setData(Qt::UserRole, plain(help));
        item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsUserCheckable);
        item->setCheckState(Qt::Unchecked);
    }
    timed_ = named(new QCheckBox(tr("At most"), this), "editorTimed", tr("A time limit"));
    minutes_ = named(new QSpinBox(this), "editorMinutes", tr("Minutes"));
    minutes_->setRange(1, 24 * 60);
    minutes_->setValue(30);
    minutes_->setSuffix(tr(" min"));
    voxel_ = named(new QSpinBox(this), "editorVoxel", tr("Voxel of the tooth"),
                   tr("The same for every student: a score never hangs on their settings"));
    voxel_->setRange(20, 400);
    voxel_->setSingleStep(10);
    voxel_->setSuffix(QStringLiteral(" µm"));
    ownJudgement_ = named(new QCheckBox(tr("Students judge their own work first"), this), "editorOwnJudgement",
                          tr("Students judge their own work first"), tr("Before they see the result"));
    view_ = note({}, this, "editorView");
    auto* take = named(new QPushButton(tr("Start with the view that is open"), this), "editorTakeView",
                       tr("Start with the view that is open"), tr("Turn the tooth in the window, then take its view"));
    auto* drop = named(new QPushButton(tr("The usual view"), this), "editorDropView", tr("The usual view"));
    form->addRow(tr("First bur"), bur_);
    auto* limit = new QHBoxLayout;
    limit->addWidget(timed_);
    limit->addWidget(minutes_, 1);
    form->addRow(tr("Time"), limit);
    form->addRow(tr("Voxel"), voxel_);
    form->addRow(ownJudgement_);
    form->addRow(view_);
    form->addRow(take);
    form->addRow(drop);
    auto* lists = new QVBoxLayout;
    lists->addWidget(heading(tr("Burs allowed (none ticked: all)"), this));
    lists->addWidget(burs_, 1);
    lists->addWidget(heading(tr("Helps that are locked"), this));
    lists->addWidget(helps_, 1);
    columns->addLayout(lists, 1);

    connect(bur_, &QComboBox::activated, this, [this] {
        change_("bur", [&](Content& c) { c.exercise.bur = bur_->currentData().toString().toStdString(); });
    });
    const auto ticks = [this](QListWidget* list, const char* step, std::vector<std::string> cases::Exercise::*where) {
        connect(list, &QListWidget::itemChanged, this, [this, list, step, where] {
            if (showing_) return;
            std::vector<std::string> names;
            for (int i = 0; i < list->count(); ++i)
                if (list->item(i)->checkState() == Qt::Checked)
                    names.push_back(list->item(i)->data(Qt::UserRole).toString().toStdString());
            change_(step, [&](Content& c) { c.exercise.*where = names; });
        });
    };
    ticks(burs_, "", &cases::Exercise::allowedBurs);
    ticks(helps_, "", &cases::Exercise::lockedHelps);
    const auto setTime = [this] {
        if (showing_) return;
        change_("minutes", [&](Content& c) {
            c.minutes = timed_->isChecked() ? std::optional<double>(minutes_->value()) : std::nullopt;
        });
    };
    connect(timed_, &QCheckBox::toggled, this, setTime);
    connect(minutes_, &QSpinBox::valueChanged, this, setTime);
    connect(voxel_, &QSpinBox::valueChanged, this, [this](int um) {
        if (!showing_) change_("voxel", [&](Content& c) { c.voxelMm = 1e-3 * um; });
    });
    connect(ownJudgement_, &QCheckBox::toggled, this, [this](bool own) {
        if (!showing_) change_("", [&](Content& c) { c.ownJudgement = own; });
    });
    connect(take, &QPushButton::clicked, this, &WorkPage::viewRequested);
    connect(drop, &QPushButton::clicked, this, [this] { change_("", [&](Content& c) { c.exercise.view.reset(); }); });
}

void WorkPage::show(const Content& content) {
    showing_ = true;
    const cases::Exercise& e = content.exercise;
    const QString bur = QString::fromStdString(e.bur);
    if (bur_->findData(bur) < 0) bur_->addItem(burTitle(bur), bur);  // of a file: told as a problem
    bur_->setCurrentIndex(bur_->findData(bur));
    const auto tick = [](QListWidget* list, const std::vector<std::string>& names) {
        for (int i = 0; i < list->count(); ++i) {
            const std::string name = list->item(i)->data(Qt::UserRole).toString().toStdString();
            const bool on = std::find(names.begin(), names.end(), name) != names.end();
            list->item(i)->setCheckState(on ? Qt::Checked : Qt::Unchecked);
        }
    };
    tick(burs_, e.allowedBurs);
    tick(helps_, e.lockedHelps);
    timed_->setChecked(content.minutes.has_value());
    minutes_->setEnabled(content.minutes.has_value());
    if (content.minutes) minutes_->setValue(static_cast<int>(std::lround(*content.minutes)));
    voxel_->setValue(static_cast<int>(std::lround(1e3 * content.voxelMm)));
    ownJudgement_->setChecked(content.ownJudgement);
    view_->setText(e.view ? tr("Starts with a view of its own.") : tr("Starts with the usual view."));
    showing_ = false;
}

TextsPage::TextsPage(Change change) : EditorPage(std::move(change)) {
    setObjectName(QStringLiteral("editorTexts"));
    auto* form = new QFormLayout(this);
    id_ = named(new QLineEdit(this), "editorId", tr("Short name"), tr("Small letters, digits, '-'"));
    version_ =
        named(new QSpinBox(this), "editorVersion", tr("Version"), tr("Raise it with each change to be told apart"));
    version_->setRange(1, 99999);
    titleEn_ = named(new QLineEdit(this), "editorTitleEn", tr("Title, English"));
    titleJa_ = named(new QLineEdit(this), "editorTitleJa", tr("Title, Japanese"));
    whatEn_ = named(new QPlainTextEdit(this), "editorInstructionsEn", tr("What to do, English"));
    whatJa_ = named(new QPlainTextEdit(this), "editorInstructionsJa", tr("What to do, Japanese"));
    form->addRow(tr("Short name"), id_);
    form->addRow(tr("Version"), version_);
    form->addRow(tr("Title, English"), titleEn_);
    form->addRow(tr("Title, Japanese"), titleJa_);
    form->addRow(tr("What to do, English"), whatEn_);
    form->addRow(tr("What to do, Japanese"), whatJa_);
    connect(id_, &QLineEdit::textEdited, this,
            [this](const QString& text) { change_("id", [&](Content& c) { c.id = text.toStdString(); }); });
    connect(version_, &QSpinBox::valueChanged, this, [this](int version) {
        if (!showing_) change_("version", [&](Content& c) { c.version = version; });
    });
    const auto put = [](cases::Texts& texts, const char* language, const QString& text) {
        if (text.isEmpty())
            texts.erase(language);
        else
            texts[language] = text.toStdString();
    };
    const auto title = [&](QLineEdit* field, const char* language, const char* step) {
        connect(field, &QLineEdit::textEdited, this, [this, put, language, step](const QString& text) {
            change_(step, [&](Content& c) { put(c.exercise.title, language, text); });
        });
    };
    title(titleEn_, "en", "title en");
    title(titleJa_, "ja", "title ja");
    const auto what = [&](QPlainTextEdit* field, const char* language, const char* step) {
        connect(field, &QPlainTextEdit::textChanged, this, [this, field, put, language, step] {
            if (!showing_)
                change_(step, [&](Content& c) { put(c.exercise.instructions, language, field->toPlainText()); });
        });
    };
    what(whatEn_, "en", "what en");
    what(whatJa_, "ja", "what ja");
}

void TextsPage::show(const Content& content) {
    showing_ = true;
    const auto text = [](const cases::Texts& texts, const char* language) {
        const auto at = texts.find(language);
        return at == texts.end() ? QString() : QString::fromStdString(at->second);
    };
    setText(id_, QString::fromStdString(content.id));
    version_->setValue(static_cast<int>(std::min<std::int64_t>(content.version, 99999)));
    setText(titleEn_, text(content.exercise.title, "en"));
    setText(titleJa_, text(content.exercise.title, "ja"));
    setText(whatEn_, text(content.exercise.instructions, "en"));
    setText(whatJa_, text(content.exercise.instructions, "ja"));
    showing_ = false;
}

}  // namespace handpiece::desktop
