// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/view/view_bar.h"

#include <QCheckBox>
#include <QComboBox>
#include <QGridLayout>
#include <QSignalBlocker>
#include <QToolButton>
#include <QVBoxLayout>

#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/notation.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {

namespace {

struct ViewButton {
    view::StandardView view;
    const char *icon, *object, *text, *tip;
};
const ViewButton kViews[] = {
    {view::StandardView::occlusal, "view-occlusal", "viewOcclusal",
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Occlusal"),
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Occlusal view (1)")},
    {view::StandardView::buccal, "view-buccal", "viewBuccal",
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Buccal"),
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Buccal view (2)")},
    {view::StandardView::lingual, "view-lingual", "viewLingual",
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Lingual"),
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Lingual view (3)")},
    {view::StandardView::mesial, "view-mesial", "viewMesial",
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Mesial"),
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Mesial view (4)")},
    {view::StandardView::distal, "view-distal", "viewDistal",
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Distal"),
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Distal view (5)")},
    {view::StandardView::oblique, "view-oblique", "viewOblique",
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Oblique"),
     QT_TRANSLATE_NOOP("handpiece::desktop::ViewBar", "Oblique view, occlusal and buccal (6)")}};

}  // namespace

ViewBar::ViewBar(QWidget* parent) : QWidget(parent) {
    setObjectName("viewBar");
    setAccessibleName(tr("Views and look"));
    auto* column = new QVBoxLayout(this);
    column->setSpacing(6);
    column->addWidget(heading(tr("Look from"), this));
    auto* grid = new QGridLayout;
    grid->setSpacing(4);
    for (int i = 0; i < 6; ++i) {
        const ViewButton& v = kViews[i];
        auto* button = named(new QToolButton(this), v.object, tr(v.tip), tr(v.tip));
        button->setIcon(icon(v.icon));
        button->setIconSize({34, 34});
        button->setText(tr(v.text));
        button->setToolButtonStyle(Qt::ToolButtonTextUnderIcon);
        button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
        button->setFocusPolicy(Qt::StrongFocus);
        grid->addWidget(button, i / 3, i % 3);
        views_[static_cast<std::size_t>(i)] = button;
        connect(button, &QToolButton::clicked, this, [this, view = v.view] { emit viewChosen(view); });
    }
    column->addLayout(grid);
    fit_ = named(new QToolButton(this), "viewFit", tr("Whole tooth"), tr("Show the whole tooth (Home)"));
    fit_->setIcon(icon("fit"));
    fit_->setText(tr("Whole tooth"));
    fit_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    fit_->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    fit_->setFocusPolicy(Qt::StrongFocus);
    column->addWidget(fit_);
    connect(fit_, &QToolButton::clicked, this, &ViewBar::fitRequested);

    column->addWidget(heading(tr("What to see"), this));
    auto* form = new QGridLayout;
    form->setColumnStretch(1, 1);
    int row = 0;
    const auto choice = [&](const QString& text, const char* object, const QString& tip, const QStringList& entries,
                            QComboBox*& box) {
        auto* label = new QLabel(text, this);
        box = named(new QComboBox(this), object, text, tip);
        box->addItems(entries);
        label->setBuddy(box);
        form->addWidget(label, row, 0);
        form->addWidget(box, row++, 1);
        return label;
    };
    choice(tr("Colours"), "paletteChoice", tr("Colours of the tissues"),
           {tr("As in the mouth"), tr("As in a textbook"), tr("For any colour vision")}, palette_);
    choice(tr("Tooth"), "toothChoice", tr("The tooth now, before, or both"),
           {tr("As it is now"), tr("Before cutting"), tr("Removed part as glass")}, shown_);
    qualityName_ = choice(tr("Quality"), "qualityChoice", tr("Finer pictures need a faster computer"),
                          {tr("Fast"), tr("Fine"), tr("Rich (needs a graphics card)")}, quality_);
    stereoName_ = choice(tr("In depth"), "stereoChoice", tr("Pictures for two eyes"),
                         {tr("Off"), tr("Side by side"), tr("Red and cyan glasses")}, stereo_);
    column->addLayout(form);

    auto* boxes = new QGridLayout;
    int cell = 0;
    const auto box = [&](const QString& text, const char* object, const QString& tip, auto apply) {
        auto* check = named(new QCheckBox(text, this), object, text, tip);
        boxes->addWidget(check, cell / 2, cell % 2);
        ++cell;
        connect(check, &QCheckBox::toggled, this, [this, apply](bool on) {
            apply(look_, on);
            tell();
        });
        return check;
    };
    removed_ = box(tr("Removed depth"), "showRemovedDepth", tr("Colour by how much was cut away"),
                   [](view::Look& l, bool on) { l.removedDepthColours = on; });
    scaleBar_ = box(tr("Scale bar"), "showScaleBar", tr("A scale in millimetres in the picture"),
                    [](view::Look& l, bool on) { l.scaleBar = on; });
    wet_ = box(tr("Wet tooth"), "showWet", tr("Shine of wet enamel"), [](view::Look& l, bool on) { l.wet = on; });
    scanColours_ = box(tr("Colours of the scan"), "showScanColours", scanColoursTip(),
                       [](view::Look& l, bool on) { l.scanColours = on; });
    spray_ = box(tr("Water spray"), "showSpray", tr("Water from the handpiece"),
                 [](view::Look& l, bool on) { l.spray = on; });
    debris_ = box(tr("Debris"), "showDebris", tr("What flies off while cutting"),
                  [](view::Look& l, bool on) { l.debris = on; });
    shadows_ = box(tr("Shadows"), "showShadows", tr("Shade in fissures and cavities"),
                   [](view::Look& l, bool on) { l.shadows = on; });
    turbine_ = box(tr("Handpiece"), "showTurbine", tr("The handpiece that holds the bur"),
                   [](view::Look& l, bool on) { l.turbine = on; });
    cheeks_ = box(tr("Lips and cheeks"), "showCheeks", tr("Those of the case; else they are held aside"),
                  [](view::Look& l, bool on) { l.cheeks = on; });
    contact_ = box(tr("Contact arrow"), "showContact", tr("Where the bur touches"),
                   [](view::Look& l, bool on) { l.contactArrow = on; });
    force_ = box(tr("Force arrow"), "showForce", tr("The force on the hand"),
                 [](view::Look& l, bool on) { l.forceArrow = on; });
    column->addLayout(boxes);
    tissuesName_ = heading(tr("Tissues shown"), this);
    column->addWidget(tissuesName_);
    tissueGrid_ = new QGridLayout;
    column->addLayout(tissueGrid_);
    column->addStretch(1);

    connect(palette_, &QComboBox::activated, this, [this](int i) {
        look_.palette = static_cast<view::Palette>(i);
        tell();
    });
    connect(quality_, &QComboBox::activated, this, [this](int i) {
        look_.quality = static_cast<view::Quality>(i);
        tell();
    });
    connect(shown_, &QComboBox::activated, this, [this](int i) {
        look_.tooth = static_cast<view::ToothShown>(i);
        tell();
    });
    connect(stereo_, &QComboBox::activated, this, [this](int i) {
        look_.stereo = static_cast<view::Stereo>(i);
        tell();
    });
    using cases::Tissue;
    setPresent({Tissue::enamel, Tissue::dentine, Tissue::pulp});
    showLook();
    setDetail(Detail::practice);
}

QString ViewBar::scanColoursTip() {
    return tr("As an intraoral scanner saw the uncut surface; with colours as in the mouth");
}

void ViewBar::tell() {
    emit lookChanged(look_);
}

void ViewBar::setLook(const view::Look& look) {
    look_ = look;
    showLook();
}

void ViewBar::showLook() {
    const auto pick = [](QComboBox* box, int index) {
        const QSignalBlocker quiet(box);
        box->setCurrentIndex(index);
    };
    const auto check = [](QCheckBox* box, bool on) {
        const QSignalBlocker quiet(box);
        box->setChecked(on);
    };
    pick(palette_, static_cast<int>(look_.palette));
    pick(quality_, static_cast<int>(look_.quality));
    pick(shown_, static_cast<int>(look_.tooth));
    pick(stereo_, static_cast<int>(look_.stereo));
    check(removed_, look_.removedDepthColours);
    check(scaleBar_, look_.scaleBar);
    check(wet_, look_.wet);
    check(scanColours_, look_.scanColours);
    check(spray_, look_.spray);
    check(debris_, look_.debris);
    check(shadows_, look_.shadows);
    check(turbine_, look_.turbine);
    check(cheeks_, look_.cheeks);
    check(contact_, look_.contactArrow);
    check(force_, look_.forceArrow);
    for (const auto& [tissue, box] : tissueBoxes_)
        check(box, look_.visible[static_cast<std::size_t>(tissue)]);
}

void ViewBar::setPresent(const std::vector<cases::Tissue>& tissues) {
    present_ = tissues;
    makeTissueBoxes();
}

void ViewBar::setCheeksThere(bool there) {
    cheeks_->setEnabled(there);
    cheeks_->setToolTip(there ? tr("Those of the case; else they are held aside") : tr("This case has none"));
}

void ViewBar::setScanColoursThere(bool there) {
    scanColours_->setEnabled(there);
    scanColours_->setToolTip(there ? scanColoursTip() : tr("No surface of this case was scanned in colour"));
}

void ViewBar::makeTissueBoxes() {
    for (const auto& entry : tissueBoxes_)
        delete entry.second;
    tissueBoxes_.clear();
    int cell = 0;
    for (const cases::Tissue tissue : present_) {
        auto* box = named(new QCheckBox(tissueName(tissue), this), "showTissue", tissueName(tissue),
                          tr("Show or hide: %1").arg(tissueName(tissue)));
        box->setObjectName(QStringLiteral("showTissue_%1")
                               .arg(QString::fromUtf8(cases::properties(tissue).name.data(),
                                                      static_cast<qsizetype>(cases::properties(tissue).name.size()))));
        box->setChecked(look_.visible[static_cast<std::size_t>(tissue)]);
        tissueGrid_->addWidget(box, cell / 2, cell % 2);
        ++cell;
        connect(box, &QCheckBox::toggled, this, [this, tissue](bool on) {
            look_.visible[static_cast<std::size_t>(tissue)] = on;
            tell();
        });
        tissueBoxes_.emplace_back(tissue, box);
    }
    setPermissions(permissions_);
}

void ViewBar::setPermissions(const exercise::Permissions& permissions) {
    using exercise::Operation;
    permissions_ = permissions;
    const auto take = [&permissions](QWidget* w, Operation operation, const QString& tip) {
        w->setEnabled(!permissions.locks(operation));
        w->setToolTip(permissions.locks(operation) ? tr("Locked by this exercise.") : tip);
    };
    take(palette_, Operation::tissueColours, tr("Colours of the tissues"));
    take(shown_, Operation::transparency, tr("The tooth now, before, or both"));
    take(removed_, Operation::removedDepth, tr("Colour by how much was cut away"));
    take(scaleBar_, Operation::scaleBar, tr("A scale in millimetres in the picture"));
    for (const auto& [tissue, box] : tissueBoxes_)
        take(box, Operation::transparency, tr("Show or hide: %1").arg(tissueName(tissue)));
}

void ViewBar::setDetail(Detail detail) {
    detail_ = detail;
    const bool more = detail == Detail::laboratory;
    for (QWidget* w : std::initializer_list<QWidget*>{contact_, force_, qualityName_, quality_, stereoName_, stereo_,
                                                      shadows_, turbine_, cheeks_})
        w->setVisible(more || (detail == Detail::practice && (w == qualityName_ || w == quality_)));
}

}  // namespace handpiece::desktop
