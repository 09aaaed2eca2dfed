// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/editor_pages.h"

#include <QCheckBox>
#include <QComboBox>
#include <QCoreApplication>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QLocale>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <utility>

#include "desktop/features/editor/editor_words.h"
#include "desktop/features/editor/own_target.h"
#include "desktop/framework/helps.h"
#include "desktop/picture/solid_view.h"
#include "desktop/widgets/parts.h"
#include "desktop/work/bur_words.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/rotor.h"
#include "handpiece/model/starter/block.h"

namespace handpiece::desktop {
namespace {

using draft::Content;

constexpr int kNumbersPixels = 330;

/// Where students read the level's words, which are its name.
constexpr const char* kChoice = "handpiece::desktop::ExercisesDialog";

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
void setValue(DecimalField* field, double value) {
    if (std::abs(field->value() - value) > 0.5 * std::pow(10.0, -field->decimals())) field->setValue(value);
}
DecimalField* millimetres(QWidget* parent, const char* name, const QString& words) {
    auto* field = named(new DecimalField(parent), name, words);
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
    seed_ = named(new WholeField(this), "editorSeed", tr("Patient"),
                  tr("Another number is another patient; 0 the average"));
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
    // An onlay has more numbers than a small screen has room for: they scroll, the picture stays.
    auto* scroll = new QScrollArea(this);
    auto* column = new QWidget;
    form_ = new QFormLayout(column);
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    scroll->setWidget(column);
    scroll->setMinimumWidth(kNumbersPixels);
    columns->addWidget(scroll, 2);
    auto* beside = new QVBoxLayout;
    columns->addLayout(beside, 3);
    picture_ = new SolidView("editorPicture", this);
    picture_->setPlaceholder({});
    picture_->setAccessibleName(tr("The tooth with its preparation"));
    picture_->setToolTip(
        tr("Drag a handle: its number follows; Escape gives it up. Drag elsewhere: turn. Right button: shift. Wheel: "
           "nearer."));
    idealButton_ = named(new QPushButton(tr("Cut it out"), this), "editorShowIdeal", tr("Cut it out"),
                         tr("Cuts the tooth as the preparation asks for it; takes seconds"));
    beside->addWidget(picture_, 1);
    beside->addWidget(idealButton_);
    connect(idealButton_, &QPushButton::clicked, this, [this] {
        if (shows_ == Shown::ideal)
            showTask();
        else
            emit idealRequested();
    });
    connectPicture();
    template_ = named(new QComboBox(this), "editorTemplate", tr("Preparation"));
    template_->addItem(tr("Nothing is asked"), QString());
    for (const preparation::Template& t : preparation::templates())
        template_->addItem(templateWords(t.id), plain(t.id));
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
    own_ = new OwnTarget(*picture_, *form_, change_, this);
    connect(own_, &OwnTarget::workRequested, this, &PreparationPage::workRequested);
    connect(own_, &OwnTarget::strokeGrew, this, &PreparationPage::showStroke);
    numbers_ = new QWidget(this);
    new QFormLayout(numbers_);
    form_->addRow(numbers_);
    form_->addRow(heading(tr("What may go beside it"), this));
    const auto row = [&](DecimalField*& field, const char* name, const QString& words, const QString& tip, auto set) {
        field = millimetres(this, name, words);
        field->setToolTip(tip);
        form_->addRow(words, field);
        connect(field, &DecimalField::valueChanged, this, [this, name, set](double value) {
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

/// The brush as far as it has come, over the glass that is there.
void PreparationPage::showStroke() {
    std::vector<view::GlassSurface> all =
        recipe_->strokes.empty() ? std::vector<view::GlassSurface>{} : glass_.surfaces();
    all.push_back(own_->strokeGlass());
    picture_->setGlass(std::move(all));
}

void PreparationPage::showNumbers(const preparation::Template* of) {
    auto* rows = static_cast<QFormLayout*>(numbers_->layout());
    while (rows->rowCount() > 0)
        rows->removeRow(0);
    fields_.clear();
    if (of == nullptr) return;
    for (const preparation::Parameter& p : of->parameters) {
        const std::string name(p.name);
        auto* field = new DecimalField(numbers_);
        field->setObjectName(QStringLiteral("editorNumber_") + plain(p.name));
        field->setAccessibleName(parameterWords(p.name));
        field->setToolTip(tr("%1 to %2, usually %3").arg(p.least).arg(p.most).arg(p.usual));
        field->setRange(p.least, p.most);
        field->setDecimals(2);
        field->setSingleStep(name.ends_with("_deg") ? 1.0 : 0.1);
        field->setSuffix(QLatin1Char(' ') + parameterUnit(p.name));
        rows->addRow(parameterWords(p.name), field);
        connect(field, &DecimalField::valueChanged, this, [this, name](double value) {
            if (showing_) return;
            change_(name.c_str(), [&](Content& c) { c = draft::withNumber(std::move(c), name, value); });
        });
        fields_.emplace_back(name, field);
    }
}

void PreparationPage::connectPicture() {
    connect(&glass_, &ZoneGlass::changed, this, &PreparationPage::takeGlass);
    connect(&glass_, &ZoneGlass::refused, this, [this](const Problem& problem) {
        if (shows_ != Shown::task) return;
        picture_->setCaption(problem.what, true);
        if (picture_->isDragging()) return;  // back to where it lies
        handles_.clear();
        picture_->setHandles({});
    });
    connect(picture_, &SolidView::handleDragged, this,
            [this](int handle, double movedMm) { drag(handle, movedMm, false); });
    connect(picture_, &SolidView::handleDropped, this,
            [this](int handle, double movedMm) { drag(handle, movedMm, true); });
    connect(picture_, &SolidView::handleGivenUp, this, [this] {
        glass_.setCoarse(false);
        if (!dragged_ || !recipe_) return;
        const std::string name(dragged_->number);
        dragged_.reset();
        showField(name, recipe_->number(name));
        glass_.show(tooth_, *recipe_);
    });
}

QString PreparationPage::handleText(std::string_view name, double value) {
    return tr("%1: %2 %3").arg(parameterWords(name), QLocale().toString(value, 'f', 2), parameterUnit(name));
}

void PreparationPage::showField(std::string_view name, double value) {
    const bool was = std::exchange(showing_, true);
    for (const auto& [of, field] : fields_)
        if (of == name) setValue(field, value);
    showing_ = was;
}

/// While it is dragged only picture and field know; let go, it is one step of the draft.
void PreparationPage::drag(int handle, double movedMm, bool isOver) {
    if (!recipe_ || static_cast<std::size_t>(handle) >= handles_.size()) return;
    if (!dragged_) dragged_ = handles_[static_cast<std::size_t>(handle)];
    const std::string name(dragged_->number);
    const double value = draft::valueOf(*dragged_, *recipe_, movedMm);
    picture_->setHandleText(handle, handleText(name, value));
    if (!isOver) {
        showField(name, value);
        preparation::Recipe next = *recipe_;
        next.numbers[name] = value;
        glass_.setCoarse(true);
        glass_.show(tooth_, next);
        return;
    }
    dragged_.reset();
    glass_.setCoarse(false);
    showField(name, recipe_->number(name));
    if (value == recipe_->number(name)) {
        glass_.show(tooth_, *recipe_);
        return;
    }
    change_("", [&](Content& c) { c = draft::withNumber(std::move(c), name, value); });
}

void PreparationPage::takeGlass() {
    if (shows_ != Shown::task) return;
    picture_->setGlass(glass_.surfaces());
    if (!glass_.laid() || !tooth_) return;
    handles_ = draft::handlesOf(*tooth_, glass_.recipe(), *glass_.laid());
    std::vector<SolidHandle> shown;
    for (const draft::Handle& h : handles_)
        shown.push_back({h.placeMm, h.way, handleText(h.number, glass_.recipe().number(h.number))});
    picture_->setHandles(std::move(shown));
    picture_->setCaption(
        OwnTarget::isPainted(recipe_) ? tr("Green is to go, orange must stay: paint on with the left button")
        : handles_.empty()            ? tr("Green is to go, orange must stay")
                                      : tr("Green is to go, orange must stay: drag a white handle to change a number"),
        false);
    if (own_->isPainting()) showStroke();
    if (!picture_->isDragging()) look(false);
}

/// Near to the preparation, from where it is seen; a new template's only, then the eye is the teacher's.
void PreparationPage::look(bool anew) {
    if (!glass_.laid() || (!anew && lookedAt_ == glass_.recipe().preparation)) return;
    lookedAt_ = glass_.recipe().preparation;
    if (lookedAt_ == preparation::kPaintedTemplate) return;  // the eye is where one paints
    const view::StandardView from = lookedAt_ == "class-five"    ? view::StandardView::buccal
                                    : lookedAt_ == "class-three" ? view::StandardView::lingual
                                                                 : view::StandardView::oblique;
    core::Box box = glass_.laid()->zones->box();
    const core::Box& whole = glass_.laid()->whole->bounds();
    box = box.grown(2.0);
    box.min = box.min.cwiseMax(whole.min), box.max = box.max.cwiseMin(whole.max);
    const view::Viewport port{std::max(1, picture_->width()), std::max(1, picture_->height())};
    picture_->setCamera(view::standardView(from, box, view::standingOf(tooth_->fdiNumber, tooth_->buccalSign), port));
}

void PreparationPage::showTask() {
    shows_ = tooth_ ? Shown::task : Shown::nothing;
    own_->setPaintable(shows_ == Shown::task);
    idealButton_->setText(tr("Cut it out"));
    if (!tooth_) {
        picture_->setParts(nullptr, {});
        picture_->setGlass({});
        picture_->setHandles({});
        return picture_->setCaption(tr("Choose a tooth first"), false);
    }
    std::shared_ptr<const std::vector<cases::Part>> parts(tooth_, &tooth_->parts);
    if (tooth_->parts.empty())  // its surface is all that it has
        parts = std::make_shared<const std::vector<cases::Part>>(
            std::vector<cases::Part>{{"outer", cases::Tissue::enamel, 0, tooth_->surface()}});
    core::Box box;
    for (const cases::Part& part : *parts)
        for (const core::Vec3& v : part.mesh.vertices)
            box.extend(v);
    picture_->setParts(parts, box);
    picture_->setCaption(recipe_ ? tr("Laying the preparation on the tooth...") : tr("Choose a preparation"), false);
    if (OwnTarget::isBlank(recipe_))
        picture_->setCaption(OwnTarget::isPainted(recipe_) ? tr("Paint on the tooth with the left button")
                                                           : tr("Take the work whose cut is the target"),
                             false);
    if (!recipe_ || OwnTarget::isBlank(recipe_)) {
        glass_.hide();
        handles_.clear();
        picture_->setGlass({});
        picture_->setHandles({});
    } else if (glassOf_ == recipe_ && pictured_ == tooth_ && glass_.laid()) {
        takeGlass();
    } else {
        glass_.show(tooth_, *recipe_);
    }
    glassOf_ = recipe_;
    pictured_ = tooth_;
}

void PreparationPage::refreshPicture() {
    if (!isVisible()) return;
    if (shows_ != Shown::nothing && pictured_ == tooth_ && glassOf_ == recipe_) return;
    // What was held belongs to what was there.
    if (picture_->isDragging()) picture_->setHandles({});
    if (pictured_ != tooth_) lookedAt_.clear();
    if (shows_ == Shown::task && pictured_ == tooth_ && tooth_ && recipe_ && !OwnTarget::isBlank(recipe_)) {
        if (!glassOf_ || glassOf_->preparation != recipe_->preparation) {
            // What stood there was of another one.
            handles_.clear();
            picture_->setHandles({});
            picture_->setGlass({});
            picture_->setCaption(tr("Laying the preparation on the tooth..."), false);
        }
        glassOf_ = recipe_;
        return glass_.show(tooth_, *recipe_);
    }
    showTask();
}

void PreparationPage::showEvent(QShowEvent* event) {
    EditorPage::showEvent(event);
    refreshPicture();
}

std::optional<view::Camera> PreparationPage::camera() const {
    return shows_ == Shown::nothing ? std::nullopt : std::optional(picture_->camera());
}

void PreparationPage::setIdeal(std::shared_ptr<const std::vector<cases::Part>> parts) {
    if (!parts) return picture_->setCaption(tr("Cutting the ideal..."), true);
    core::Box box;
    for (const cases::Part& part : *parts)
        for (const core::Vec3& v : part.mesh.vertices)
            box.extend(v);
    shows_ = Shown::ideal;
    own_->setPaintable(false);
    picture_->setGlass({});
    picture_->setHandles({});
    picture_->setParts(parts, box);
    picture_->setCaption(tr("As it is asked for: drag to turn it"), false);
    idealButton_->setText(tr("Back to its numbers"));
}

void PreparationPage::clearIdeal() {
    showTask();
}

void PreparationPage::show(const Content& content) {
    showing_ = true;
    const preparation::Recipe* recipe = content.preparation ? &*content.preparation : nullptr;
    const std::string id = recipe ? recipe->preparation : std::string();
    const preparation::Template* of = preparation::findTemplate(id);
    template_->setCurrentIndex(std::max(0, template_->findData(QString::fromStdString(id))));
    const preparation::Template* kind = recipe ? preparation::findTemplate(recipe->kind()) : nullptr;
    const bool hasSide = kind != nullptr && kind->hasSide;
    own_->show(content);
    side_->setVisible(hasSide);
    sideLabel_->setVisible(hasSide);
    if (recipe) side_->setCurrentIndex(std::max(0, side_->findData(QString::fromStdString(recipe->side))));
    if (shown_ != id) showNumbers(of);
    shown_ = id;
    if (recipe)
        for (const auto& [name, field] : fields_)
            setValue(field, recipe->number(name));
    tooth_ = content.tooth;
    recipe_ = content.preparation;
    for (DecimalField* field : {leewaySide_, leewayFloor_, pulp_})
        field->setEnabled(recipe != nullptr);
    const preparation::Recipe plainOne;
    const preparation::Recipe& r = recipe ? *recipe : plainOne;
    setValue(leewaySide_, r.leeway.sideMm);
    setValue(leewayFloor_, r.leeway.floorMm);
    setValue(pulp_, r.pulpMm);
    showing_ = false;
    refreshPicture();
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
    drive_ = named(new QComboBox(this), "editorDrive", tr("First drive"));
    drive_->addItem(tr("The student's choice"), QString());
    for (const instrument::Drive& drive : instrument::drives())
        drive_->addItem(driveTitle(QString::fromStdString(drive.name)), QString::fromStdString(drive.name));
    speed_ = named(new DecimalField(this), "editorSpeed", tr("Its speed"), tr("That it is set to at the beginning"));
    speed_->setDecimals(0);
    speed_->setSuffix(tr(" rpm"));
    helps_ = named(new QListWidget(this), "editorHelps", tr("Helps that are locked"));
    for (const std::string_view help : cases::kHelps) {
        auto* item = new QListWidgetItem(helpWords(*helpOf(help)), helps_);
        item->setData(Qt::UserRole, plain(help));
        item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsUserCheckable);
        item->setCheckState(Qt::Unchecked);
    }
    timed_ = named(new QCheckBox(tr("At most"), this), "editorTimed", tr("A time limit"));
    minutes_ = named(new DecimalField(this), "editorMinutes", tr("Minutes"));
    minutes_->setRange(0.1, 24 * 60);
    minutes_->setDecimals(1);
    minutes_->setValue(30);
    minutes_->setSuffix(tr(" min"));
    hard_ = named(new QCheckBox(tr("Work ends when it is up"), this), "editorHardLimit", tr("Work ends when it is up"),
                  tr("The pedal is dead then; else students are told once, and go on"));
    level_ = named(new QComboBox(this), "editorLevel", tr("Level"));
    level_->addItem(tr("Not said"), QString());
    for (const std::string_view level : tasks::kLevels)
        level_->addItem(QCoreApplication::translate(kChoice, plain(level).toUtf8()), plain(level));
    liveBar_ =
        named(new QCheckBox(tr("Show during the work what is gone of the target"), this), "editorLiveBar",
              tr("Show during the work what is gone of the target"), tr("A bar for target, leeway and what must stay"));
    voxel_ = named(new DecimalField(this), "editorVoxel", tr("Voxel of the tooth"),
                   tr("The same for every student: a score never hangs on their settings"));
    voxel_->setRange(20, 400);
    voxel_->setDecimals(1);
    voxel_->setSingleStep(10);
    voxel_->setSuffix(QStringLiteral(" µm"));
    ownJudgement_ = named(new QCheckBox(tr("Students judge their own work first"), this), "editorOwnJudgement",
                          tr("Students judge their own work first"), tr("Before they see the result"));
    view_ = note({}, this, "editorView");
    auto* take = named(new QPushButton(tr("Take the window's view"), this), "editorTakeView",
                       tr("Take the window's view"), tr("Turn the tooth in the window, then take its view"));
    auto* ofPicture = named(new QPushButton(tr("Take the preparation's view"), this), "editorTakePictureView",
                            tr("Take the preparation's view"), tr("As the picture on the page Preparation shows it"));
    showView_ = named(new QPushButton(tr("Show it in the window"), this), "editorShowView", tr("Show it in the window"),
                      tr("Turns the tooth in the window to the start view"));
    auto* drop = named(new QPushButton(tr("The usual view"), this), "editorDropView", tr("The usual view"));
    auto* eye = new QGridLayout;
    const QString what[] = {tr("Eye"), tr("Looks at"), tr("Up")};
    const char* names[] = {"editorEye", "editorTarget", "editorUp"};
    for (int row = 0; row < 3; ++row) {
        eye->addWidget(new QLabel(what[row], this), row, 0);
        for (int k = 0; k < 3; ++k) {
            const char axis[] = {"XYZ"[k], '\0'};
            auto* field = named(new DecimalField(this), "", what[row] + QLatin1Char(' ') + QLatin1String(axis));
            field->setObjectName(QLatin1String(names[row]) + QLatin1String(axis));
            field->setRange(row == 2 ? -1.0 : -500.0, row == 2 ? 1.0 : 500.0);
            field->setDecimals(row == 2 ? 3 : 2);
            field->setSingleStep(row == 2 ? 0.05 : 1.0);
            field->setButtonSymbols(QAbstractSpinBox::NoButtons);
            eye->addWidget(field, row, 1 + k);
            eye_.push_back(field);
            connect(field, &DecimalField::valueChanged, this, [this, row, k](double value) {
                if (showing_) return;
                change_("view", [&](Content& c) {
                    if (!c.exercise.view) return;
                    cases::View& v = *c.exercise.view;
                    (row == 0 ? v.eyeMm : row == 1 ? v.targetMm : v.up)[k] = value;
                });
            });
        }
    }
    form->addRow(tr("First bur"), bur_);
    form->addRow(tr("First drive"), drive_);
    form->addRow(tr("Its speed"), speed_);
    auto* limit = new QHBoxLayout;
    limit->addWidget(timed_);
    limit->addWidget(minutes_, 1);
    form->addRow(tr("Time"), limit);
    form->addRow(hard_);
    form->addRow(tr("Level"), level_);
    form->addRow(tr("Voxel"), voxel_);
    form->addRow(ownJudgement_);
    form->addRow(liveBar_);
    teacherWork_ = named(new QLabel(this), "editorTeacherWork", tr("Your own work"));
    takeTeacherWork_ = named(new QPushButton(tr("Choose..."), this), "editorTeacherWorkTake", tr("Your own work"),
                             tr("Your recording of this exercise (session.h5), one sitting from the whole tooth to its "
                                "end, in its voxel: students play it beside their result. It is cut again to prove it; "
                                "another tooth takes it away."));
    dropTeacherWork_ = named(new QPushButton(tr("Remove"), this), "editorTeacherWorkDrop", tr("Remove your own work"));
    auto* own = new QHBoxLayout;
    own->addWidget(teacherWork_, 1);
    own->addWidget(takeTeacherWork_);
    own->addWidget(dropTeacherWork_);
    form->addRow(tr("Your own work"), own);
    connect(takeTeacherWork_, &QPushButton::clicked, this, &WorkPage::teacherWorkRequested);
    connect(dropTeacherWork_, &QPushButton::clicked, this,
            [this] { change_("", [](Content& c) { c.teacherWork.reset(); }); });
    form->addRow(heading(tr("Start view [mm]"), this));
    form->addRow(view_);
    form->addRow(eye);
    auto* views = new QGridLayout;
    views->addWidget(take, 0, 0);
    views->addWidget(ofPicture, 0, 1);
    views->addWidget(showView_, 1, 0);
    views->addWidget(drop, 1, 1);
    form->addRow(views);
    auto* lists = new QVBoxLayout;
    lists->addWidget(heading(tr("Burs allowed (none ticked: all)"), this));
    lists->addWidget(burs_, 1);
    lists->addWidget(heading(tr("Helps that are locked"), this));
    lists->addWidget(helps_, 1);
    columns->addLayout(lists, 1);

    connect(bur_, &QComboBox::activated, this, [this] {
        change_("bur", [&](Content& c) { c.exercise.bur = bur_->currentData().toString().toStdString(); });
    });
    connect(drive_, &QComboBox::activated, this, [this] {
        change_("drive", [&](Content& c) {
            c.drive = drive_->currentData().toString().toStdString();
            c.speedRpm.reset();
        });
    });
    connect(speed_, &DecimalField::valueChanged, this, [this](double rpm) {
        if (showing_) return;
        change_("speed", [&](Content& c) {
            c.speedRpm = rpm;
            if (rpm == speed_->maximum()) c.speedRpm.reset();  // its own
        });
    });
    const auto ticks = [this](QListWidget* list, const char* step, std::vector<std::string> cases::Exercise::*where) {
        connect(list, &QListWidget::itemChanged, this, [this, list, step, where] {
            if (showing_) return;
            std::vector<std::string> ticked;
            for (int i = 0; i < list->count(); ++i)
                if (list->item(i)->checkState() == Qt::Checked)
                    ticked.push_back(list->item(i)->data(Qt::UserRole).toString().toStdString());
            change_(step, [&](Content& c) { c.exercise.*where = ticked; });
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
    connect(minutes_, &DecimalField::valueChanged, this, setTime);
    connect(voxel_, &DecimalField::valueChanged, this, [this](double um) {
        if (!showing_) change_("voxel", [&](Content& c) { c.voxelMm = 1e-3 * um; });
    });
    const auto tickOf = [this](QCheckBox* box, bool Content::*flag) {
        connect(box, &QCheckBox::toggled, this, [this, flag](bool on) {
            if (!showing_) change_("", [&](Content& c) { c.*flag = on; });
        });
    };
    tickOf(ownJudgement_, &Content::ownJudgement);
    tickOf(hard_, &Content::isTimeHard);
    tickOf(liveBar_, &Content::hasLiveBar);
    connect(level_, &QComboBox::activated, this, [this] {
        change_("level", [&](Content& c) { c.level = level_->currentData().toString().toStdString(); });
    });
    connect(take, &QPushButton::clicked, this, [this] { emit viewRequested(false); });
    connect(ofPicture, &QPushButton::clicked, this, [this] { emit viewRequested(true); });
    connect(showView_, &QPushButton::clicked, this, &WorkPage::viewShown);
    connect(drop, &QPushButton::clicked, this, [this] { change_("", [&](Content& c) { c.exercise.view.reset(); }); });
}

void WorkPage::setTeacherWorkNote(const QString& words) {
    isTakingWork_ = !words.isEmpty();
    teacherWork_->setText(words);
    showTeacherWork();
}

void WorkPage::setTeacherWorkPoints(std::shared_ptr<const std::vector<std::byte>> of, const QString& words) {
    pointsOf_ = std::move(of);
    points_ = words;
    showTeacherWork();
}

void WorkPage::showTeacherWork() {
    takeTeacherWork_->setEnabled(!isTakingWork_);
    dropTeacherWork_->setEnabled(!isTakingWork_ && work_);
    if (!isTakingWork_)
        teacherWork_->setText(!work_               ? tr("none")
                              : work_ == pointsOf_ ? tr("comes along: %1").arg(points_)
                                                   : tr("comes along"));
}

void WorkPage::show(const Content& content) {
    showing_ = true;
    work_ = content.teacherWork;
    showTeacherWork();
    const cases::Exercise& e = content.exercise;
    const QString bur = QString::fromStdString(e.bur);
    if (bur_->findData(bur) < 0) bur_->addItem(burTitle(bur), bur);  // of a file: told as a problem
    bur_->setCurrentIndex(bur_->findData(bur));
    drive_->setCurrentIndex(std::max(0, drive_->findData(QString::fromStdString(content.drive))));
    speed_->setEnabled(!content.drive.empty());
    if (!content.drive.empty()) {
        const double own = instrument::driveByName(content.drive).freeSpeedRpm;
        speed_->setRange(tasks::kLeastSpeedShare * own, own);
        speed_->setSingleStep(0.01 * own);
        setValue(speed_, content.speedRpm.value_or(own));
    }
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
    if (content.minutes) setValue(minutes_, *content.minutes);
    hard_->setEnabled(content.minutes.has_value());
    hard_->setChecked(content.isTimeHard);
    level_->setCurrentIndex(std::max(0, level_->findData(QString::fromStdString(content.level))));
    liveBar_->setChecked(content.hasLiveBar);
    setValue(voxel_, 1e3 * content.voxelMm);
    ownJudgement_->setChecked(content.ownJudgement);
    view_->setText(e.view ? tr("Starts with a view of its own.") : tr("Starts with the usual view."));
    showView_->setEnabled(e.view.has_value());
    for (std::size_t i = 0; i < eye_.size(); ++i) {
        eye_[i]->setEnabled(e.view.has_value());
        const cases::View v = e.view.value_or(cases::View{});
        const core::Vec3& row = i < 3 ? v.eyeMm : i < 6 ? v.targetMm : v.up;
        setValue(eye_[i], e.view ? row[static_cast<int>(i % 3)] : 0.0);
    }
    showing_ = false;
}

TextsPage::TextsPage(Change change) : EditorPage(std::move(change)) {
    setObjectName(QStringLiteral("editorTexts"));
    auto* form = new QFormLayout(this);
    id_ = named(new QLineEdit(this), "editorId", tr("Short name"), tr("Small letters, digits, '-'"));
    version_ =
        named(new WholeField(this), "editorVersion", tr("Version"), tr("Raise it with each change to be told apart"));
    version_->setRange(1, 99999);
    titleEn_ = named(new QLineEdit(this), "editorTitleEn", tr("Title, English"));
    titleJa_ = named(new QLineEdit(this), "editorTitleJa", tr("Title, Japanese"));
    whatEn_ = named(new QPlainTextEdit(this), "editorInstructionsEn", tr("What to do, English"));
    whatJa_ = named(new QPlainTextEdit(this), "editorInstructionsJa", tr("What to do, Japanese"));
    other_ = named(new QComboBox(this), "editorOtherLanguage", tr("Another language"),
                   tr("Its tag: de, fr, pt-BR, ...; what is written below is in it"));
    other_->setEditable(true);
    other_->setInsertPolicy(QComboBox::NoInsert);
    titleOther_ = named(new QLineEdit(this), "editorTitleOther", tr("Title, in it"));
    whatOther_ = named(new QPlainTextEdit(this), "editorInstructionsOther", tr("What to do, in it"));
    form->addRow(tr("Short name"), id_);
    form->addRow(tr("Version"), version_);
    form->addRow(tr("Title, English"), titleEn_);
    form->addRow(tr("Title, Japanese"), titleJa_);
    form->addRow(tr("What to do, English"), whatEn_);
    form->addRow(tr("What to do, Japanese"), whatJa_);
    form->addRow(tr("Another language"), other_);
    form->addRow(tr("Title, in it"), titleOther_);
    form->addRow(tr("What to do, in it"), whatOther_);
    connect(id_, &QLineEdit::textEdited, this,
            [this](const QString& text) { change_("id", [&](Content& c) { c.id = text.toStdString(); }); });
    connect(version_, &WholeField::valueChanged, this, [this](int version) {
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
    connect(other_, &QComboBox::currentTextChanged, this, [this] { showOther(); });
    connect(titleOther_, &QLineEdit::textEdited, this, [this, put](const QString& text) {
        const std::string tag = other_->currentText().trimmed().toStdString();
        change_("title other", [&](Content& c) { put(c.exercise.title, tag.c_str(), text); });
    });
    connect(whatOther_, &QPlainTextEdit::textChanged, this, [this, put] {
        const std::string tag = other_->currentText().trimmed().toStdString();
        if (showing_ || tag.empty()) return;
        change_("what other",
                [&](Content& c) { put(c.exercise.instructions, tag.c_str(), whatOther_->toPlainText()); });
    });
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
    title_ = content.exercise.title;
    what_ = content.exercise.instructions;
    const QString chosen = other_->currentText();
    QStringList tags;
    for (const cases::Texts* texts : {&title_, &what_})
        for (const auto& [tag, words] : *texts)
            if (const QString name = QString::fromStdString(tag); tag != "en" && tag != "ja" && !tags.contains(name))
                tags << name;
    const QSignalBlocker quiet(other_);
    other_->clear();
    other_->addItems(tags);
    other_->setCurrentText(!chosen.isEmpty() ? chosen : tags.value(0));
    showing_ = false;
    showOther();
}

void TextsPage::showOther() {
    const bool was = std::exchange(showing_, true);
    const std::string tag = other_->currentText().trimmed().toStdString();
    const auto text = [&](const cases::Texts& texts) {
        const auto at = texts.find(tag);
        return at == texts.end() ? QString() : QString::fromStdString(at->second);
    };
    setText(titleOther_, text(title_));
    setText(whatOther_, text(what_));
    // English and Japanese have their fields above.
    const bool isOther = !tag.empty() && tag != "en" && tag != "ja";
    titleOther_->setEnabled(isOther);
    whatOther_->setEnabled(isOther);
    showing_ = was;
}

}  // namespace handpiece::desktop
