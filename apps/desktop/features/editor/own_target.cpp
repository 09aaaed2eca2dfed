// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/own_target.h"

#include <QComboBox>
#include <QFormLayout>
#include <QLabel>
#include <QMouseEvent>
#include <QPushButton>
#include <algorithm>
#include <utility>

#include "desktop/features/editor/editor_words.h"
#include "desktop/picture/solid_view.h"
#include "desktop/widgets/parts.h"
#include "handpiece/senses/view/camera.h"

namespace handpiece::desktop {
namespace {

using draft::Content;

enum Brush { kPaints, kErases, kTurns };

}  // namespace

OwnTarget::OwnTarget(SolidView& picture, QFormLayout& form, EditorPage::Change change, QWidget* page)
    : QObject(page), picture_(picture), change_(std::move(change)) {
    work_ = named(new QPushButton(tr("Take work..."), page), "editorTakeWork", tr("Take work"),
                  tr("A session or an attempt: what was cut in it is the target, in the voxel it was cut in"));
    form.addRow(work_);
    connect(work_, &QPushButton::clicked, this, &OwnTarget::workRequested);
    like_ = named(new QComboBox(page), "editorLike", tr("Judged as"),
                  tr("Says how it is measured, and which rubric comes along"));
    like_->addItem(tr("nothing of these"), QString());
    for (const preparation::Template& t : preparation::templates())
        if (!t.isOwn && !t.isBlock)
            like_->addItem(templateWords(t.id), QString::fromUtf8(t.id.data(), static_cast<qsizetype>(t.id.size())));
    likeLabel_ = new QLabel(tr("Judged as"), page);
    form.addRow(likeLabel_, like_);
    connect(like_, &QComboBox::activated, this, [this] {
        const std::string id = like_->currentData().toString().toStdString();
        change_("like", [&](Content& c) { c = draft::withLike(std::move(c), id); });
    });
    brush_ = named(new QComboBox(page), "editorBrush", tr("Left button"), tr("On the tooth; beside it: turn"));
    brush_->addItems({tr("paints"), tr("erases"), tr("turns the tooth")});
    brushLabel_ = new QLabel(tr("Left button"), page);
    form.addRow(brushLabel_, brush_);
    radius_ = named(new DecimalField(page), "editorBrushRadius", tr("Radius of the brush"));
    radius_->setRange(preparation::kLeastBrushMm, preparation::kMostBrushMm);
    radius_->setDecimals(2);
    radius_->setSingleStep(0.05);
    radius_->setSuffix(QStringLiteral(" mm"));
    radius_->setValue(0.6);
    radiusLabel_ = new QLabel(tr("Radius of the brush"), page);
    form.addRow(radiusLabel_, radius_);
    picture_.installEventFilter(this);
}

void OwnTarget::show(const Content& content) {
    const std::optional<preparation::Recipe>& recipe = content.preparation;
    const preparation::Template* of = recipe ? preparation::findTemplate(recipe->preparation) : nullptr;
    const bool isOwn = of != nullptr && of->isOwn;
    tooth_ = content.tooth;
    isPainted_ = isPainted(recipe);
    if (!isPainted_) stroke_.reset();
    work_->setVisible(isOwn && !isPainted_);
    like_->setVisible(isOwn), likeLabel_->setVisible(isOwn);
    for (QWidget* one : std::initializer_list<QWidget*>{brush_, brushLabel_, radius_, radiusLabel_})
        one->setVisible(isPainted_);
    if (recipe) like_->setCurrentIndex(std::max(0, like_->findData(QString::fromStdString(recipe->like))));
}

bool OwnTarget::isPainted(const std::optional<preparation::Recipe>& recipe) {
    return recipe && recipe->preparation == preparation::kPaintedTemplate;
}

bool OwnTarget::isBlank(const std::optional<preparation::Recipe>& recipe) {
    return recipe && ((isPainted(recipe) && recipe->strokes.empty()) ||
                      (recipe->preparation == preparation::kRecordedTemplate && !recipe->recorded));
}

std::optional<core::Vec3> OwnTarget::under(const QPointF& pointer) {
    if (!tooth_) return std::nullopt;
    if (brushed_ != tooth_) {
        canvas_ = std::make_shared<const geometry::TriangleTree>(tooth_->surface());
        brushed_ = tooth_;
    }
    const view::Ray ray = view::rayThrough(
        picture_.camera(), {std::max(1, picture_.width()), std::max(1, picture_.height())}, {pointer.x(), pointer.y()});
    const geometry::RayMeeting met = canvas_->firstMeeting(ray.originMm, ray.direction);
    if (met.triangle == geometry::kNoTriangle) return std::nullopt;
    return ray.originMm + met.distanceMm * ray.direction;
}

bool OwnTarget::eventFilter(QObject* watched, QEvent* event) {
    if (watched != &picture_) return QObject::eventFilter(watched, event);
    const auto mouse = [event] { return static_cast<const QMouseEvent*>(event); };
    switch (event->type()) {
        case QEvent::MouseButtonPress: {
            if (mouse()->button() != Qt::LeftButton || !isPainted_ || !isPaintable_ || brush_->currentIndex() == kTurns)
                break;
            const std::optional<core::Vec3> at = under(mouse()->position());
            if (!at) break;
            stroke_ = preparation::BrushStroke{{*at}, radius_->value(), brush_->currentIndex() == kErases};
            emit strokeGrew();
            return true;
        }
        case QEvent::MouseMove:
            if (!stroke_) break;
            if (const std::optional<core::Vec3> at = under(mouse()->position());
                at && (*at - stroke_->pointsMm.back()).norm() >= 0.25 * stroke_->radiusMm) {
                stroke_->pointsMm.push_back(*at);
                emit strokeGrew();
            }
            return true;
        case QEvent::MouseButtonRelease: {
            if (!stroke_ || mouse()->button() != Qt::LeftButton) break;
            const preparation::BrushStroke stroke = *std::exchange(stroke_, std::nullopt);
            // A stroke is a step back.
            change_("", [&](Content& c) {
                c = draft::beginStroke(std::move(c), stroke.pointsMm.front(), stroke.radiusMm, stroke.erases);
                for (const core::Vec3& p : stroke.pointsMm)
                    c = draft::extendStroke(std::move(c), p);
            });
            return true;
        }
        default:
            break;
    }
    return QObject::eventFilter(watched, event);
}

view::GlassSurface OwnTarget::strokeGlass() const {
    // An eight-sided stone of the brush's size where it has been.
    auto mesh = std::make_shared<geometry::TriangleMesh>();
    for (const core::Vec3& p : stroke_->pointsMm) {
        const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
        for (int k = 0; k < 3; ++k)
            for (const double sign : {1.0, -1.0})
                mesh->vertices.push_back(p + sign * stroke_->radiusMm * core::Vec3::Unit(k));
        for (std::uint32_t i = 0; i < 8; ++i) {
            const std::uint32_t x = first + (i & 1), y = first + 2 + (i >> 1 & 1), z = first + 4 + (i >> 2 & 1);
            const bool isEven = ((i & 1) + (i >> 1 & 1) + (i >> 2 & 1)) % 2 == 0;
            mesh->triangles.push_back(isEven ? geometry::Triangle{x, y, z} : geometry::Triangle{x, z, y});
        }
    }
    view::GlassSurface brush;
    brush.mesh = std::move(mesh);
    if (stroke_->erases)
        brush.colour = {0.9f, 0.9f, 0.9f};
    else
        brush.colour = {0.3f, 0.6f, 1.0f};
    brush.alpha = 0.4f;
    return brush;
}

}  // namespace handpiece::desktop
