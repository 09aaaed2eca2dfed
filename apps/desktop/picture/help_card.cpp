// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/help_card.h"

#include <QApplication>
#include <QEvent>
#include <QKeyEvent>
#include <QPainter>
#include <QPainterPath>
#include <algorithm>
#include <functional>
#include <span>

namespace handpiece::desktop {

namespace {

/// Sizes of the card, from the font.
struct Measures {
    double row, cap, gap, mouse;
};

Measures measuresOf(const QFontMetricsF& metrics) {
    return {metrics.height() + 8, metrics.height() + 4, 5, metrics.height() * 0.95};
}

double capWidth(const QFontMetricsF& metrics, const QString& text) {
    return std::max(metrics.height() + 4, metrics.horizontalAdvance(text) + 12);
}

QColor mix(const QColor& a, const QColor& b, double share) {
    return QColor::fromRgbF(static_cast<float>(a.redF() * (1 - share) + b.redF() * share),
                            static_cast<float>(a.greenF() * (1 - share) + b.greenF() * share),
                            static_cast<float>(a.blueF() * (1 - share) + b.blueF() * share));
}

void keyCap(QPainter& p, const QRectF& box, const QString& text, const QPalette& palette) {
    const QColor ink = palette.color(QPalette::WindowText);
    p.setPen(QPen(mix(palette.color(QPalette::Window), ink, 0.45), 1));
    p.setBrush(palette.color(QPalette::Base));
    p.drawRoundedRect(box.adjusted(0.5, 0.5, -0.5, -0.5), 4, 4);
    p.setPen(QPen(mix(palette.color(QPalette::Window), ink, 0.3), 2));
    p.drawLine(box.bottomLeft() + QPointF(4, -1.5), box.bottomRight() + QPointF(-4, -1.5));
    p.setPen(palette.color(QPalette::Text));
    p.drawText(box.adjusted(0, -1, 0, -1), Qt::AlignCenter, text);
}

/// A mouse from above, what is meant in colour.
void mouse(QPainter& p, const QRectF& box, const Binding& binding, const QPalette& palette) {
    const QColor ink = palette.color(QPalette::WindowText), lit = palette.color(QPalette::Highlight);
    QPainterPath body;
    body.addRoundedRect(box, box.width() / 2, box.width() / 2);
    p.setBrush(palette.color(QPalette::Base));
    p.setPen(Qt::NoPen);
    p.drawPath(body);
    const double split = box.top() + box.height() * 0.45, middle = box.center().x();
    p.save();
    p.setClipPath(body);
    if (binding.kind == Binding::Kind::button && binding.code == static_cast<int>(Qt::LeftButton))
        p.fillRect(QRectF(box.topLeft(), QPointF(middle, split)), lit);
    if (binding.kind == Binding::Kind::button && binding.code == static_cast<int>(Qt::RightButton))
        p.fillRect(QRectF(QPointF(middle, box.top()), QPointF(box.right(), split)), lit);
    p.restore();
    p.setBrush(Qt::NoBrush);
    p.setPen(QPen(mix(palette.color(QPalette::Window), ink, 0.7), 1.3));
    p.drawPath(body);
    p.drawLine(QPointF(box.left(), split), QPointF(box.right(), split));
    const bool wheel = binding.kind == Binding::Kind::wheel ||
                       (binding.kind == Binding::Kind::button && binding.code == static_cast<int>(Qt::MiddleButton));
    const QRectF wheelBox(middle - 2.5, box.top() + box.height() * 0.16, 5, box.height() * 0.28);
    p.setBrush(wheel ? QBrush(lit) : QBrush(palette.color(QPalette::Base)));
    p.drawRoundedRect(wheelBox, 2.5, 2.5);
    if (binding.kind == Binding::Kind::wheel) {
        const double x = box.right() + 5;
        p.setPen(QPen(lit, 1.6, Qt::SolidLine, Qt::RoundCap));
        p.drawLine(QPointF(x, box.top() + 4), QPointF(x, box.bottom() - 4));
        for (const double side : {-1.0, 1.0}) {
            const QPointF tip(x, side < 0 ? box.top() + 4 : box.bottom() - 4);
            p.drawLine(tip, tip + QPointF(-3, -3 * side));
            p.drawLine(tip, tip + QPointF(3, -3 * side));
        }
    }
    p.setBrush(Qt::NoBrush);
}

/// Draws one binding from `x` on, or only measures it (painter null); returns where it ends.
double binding(QPainter* p, double x, double y, const Binding& what, const QFontMetricsF& metrics,
               const QPalette& palette) {
    const Measures m = measuresOf(metrics);
    const auto cap = [&](const QString& text) {
        const double width = capWidth(metrics, text);
        if (p) keyCap(*p, {x, y, width, m.cap}, text, palette);
        x += width + 3;
    };
    Binding bare = what;
    bare.modifiers = {};
    if (what.modifiers & Qt::ControlModifier) cap(QCoreApplication::translate("KeyBindings", "Ctrl"));
    if (what.modifiers & Qt::ShiftModifier) cap(QCoreApplication::translate("KeyBindings", "Shift"));
    const bool drawn = what.kind == Binding::Kind::wheel ||
                       (what.kind == Binding::Kind::button && what.code <= static_cast<int>(Qt::MiddleButton));
    if (drawn) {
        if (p) mouse(*p, {x + 1, y, m.mouse, m.cap}, bare, palette);
        x += m.mouse + (what.kind == Binding::Kind::wheel ? 14 : 6);
    } else {
        cap(bare.text());
    }
    return x;
}

double bindingsOf(QPainter* p, double x, double y, const KeyBindings& table, Action action,
                  const QFontMetricsF& metrics, const QPalette& palette) {
    bool first = true;
    for (const Binding& one : table.of(action)) {
        if (one.kind == Binding::Kind::none) continue;
        if (!first) {
            const QString between = QCoreApplication::translate("HelpCard", "or");
            const double width = metrics.horizontalAdvance(between);
            if (p) {
                p->setPen(mix(palette.color(QPalette::Window), palette.color(QPalette::WindowText), 0.6));
                p->drawText(QRectF(x + 2, y, width + 2, measuresOf(metrics).cap), Qt::AlignCenter, between);
            }
            x += width + 8;
        }
        x = binding(p, x, y, one, metrics, palette);
        first = false;
    }
    return x;
}

/// "Ctrl+Shift+Z" as three caps.
double shortcut(QPainter* p, double x, double y, const QString& keys, const QFontMetricsF& metrics,
                const QPalette& palette) {
    const Measures m = measuresOf(metrics);
    for (const QString& key : keys.split(QLatin1Char('+'), Qt::SkipEmptyParts)) {
        const double width = capWidth(metrics, key);
        if (p) keyCap(*p, {x, y, width, m.cap}, key, palette);
        x += width + 3;
    }
    return x;
}

/// Keys that do what a button or the wheel does stand in its line.
std::span<const Action> keysBeside(Action action) {
    static constexpr Action kTouch[] = {Action::touchKey}, kZoom[] = {Action::nearer, Action::farther},
                            kLoad[] = {Action::moreLoad, Action::lessLoad},
                            kStop[] = {Action::deeperStop, Action::shallowerStop},
                            kPass[] = {Action::deeperPass, Action::shallowerPass};
    switch (action) {
        case Action::touch:
            return kTouch;
        case Action::zoom:
            return kZoom;
        case Action::load:
            return kLoad;
        case Action::stop:
            return kStop;
        case Action::pass:
            return kPass;
        default:
            return {};
    }
}

bool isBeside(Action key) {
    for (const Action action : {Action::touch, Action::zoom, Action::load, Action::stop, Action::pass})
        for (const Action beside : keysBeside(action))
            if (beside == key) return true;
    return false;
}

constexpr double kPad = 20.0, kTextToKeys = 14.0, kHeadRows = 1.9, kGapRows = 0.6, kMinPt = 6.0;
constexpr std::size_t kMaxColumns = 4;

/// A heading and what belongs under it: what, and how (drawn, or only measured without a painter; gives its end).
struct Line {
    QString text;
    std::function<double(QPainter*, double x, double y, const QFontMetricsF&)> keys;
};
struct Block {
    QString title;
    std::vector<Line> lines;
    double text = 0.0, keys = 0.0;  // the widest

    void measure(const QFontMetricsF& metrics) {
        text = keys = 0.0;
        for (const Line& line : lines) {
            text = std::max(text, metrics.horizontalAdvance(line.text));
            keys = std::max(keys, line.keys(nullptr, 0, 0, metrics));
        }
    }
    [[nodiscard]] double rows() const { return static_cast<double>(lines.size()) + 1.0 + kGapRows; }
};

/// Blocks in columns, the order kept within each.
struct Columns {
    std::vector<std::vector<const Block*>> of;
    double width = 0.0, height = 0.0;
};

Columns arranged(const std::vector<Block>& blocks, std::size_t columns, std::size_t way, double row) {
    Columns c;
    c.of.resize(columns);
    for (const Block& block : blocks) {
        c.of[way % columns].push_back(&block);
        way /= columns;
    }
    double rows = 0.0;
    c.width = kPad;
    for (const auto& column : c.of) {
        double text = 0.0, keys = 0.0, high = 0.0;
        for (const Block* block : column) {
            text = std::max(text, block->text);
            keys = std::max(keys, block->keys);
            high += block->rows();
        }
        c.width += text + kTextToKeys + keys + kPad;
        rows = std::max(rows, high);
    }
    c.height = row * (rows - kGapRows + kHeadRows) + kPad;
    return c;
}

}  // namespace

/// What lies where, for the room there is.
struct HelpCard::Plan {
    std::vector<Block> blocks;
    QFont font;
    Columns columns;
    QRectF card;
    double scale = 1.0;  // only where even the smallest letters need more room
};

HelpCard::HelpCard(QWidget* parent, QWidget* after) : QWidget(parent), after_(after) {
    setObjectName("helpCard");
    setAccessibleName(tr("Keys and mouse"));
    setAttribute(Qt::WA_DeleteOnClose);
    setFocusPolicy(Qt::StrongFocus);
    setCursor(Qt::ArrowCursor);
    if (parent) {
        setGeometry(parent->rect());
        parent->installEventFilter(this);
    }
}

QString HelpCard::description() const {
    QStringList lines;
    for (const ActionInfo& info : actionInfos())
        lines << tr("%1: %2").arg(info.titleText(), bindings_.text(info.action));
    for (const auto& [text, keys] : commands_)
        lines << tr("%1: %2").arg(text, keys);
    return lines.join("; ");
}

void HelpCard::setBindings(const KeyBindings& bindings) {
    bindings_ = bindings;
    setAccessibleDescription(description());
    update();
}

void HelpCard::setCommands(const Commands& commands) {
    commands_ = commands;
    setAccessibleDescription(description());
    update();
}

HelpCard::Plan HelpCard::plan() const {
    using Group = ActionInfo::Group;
    Plan plan;
    for (const Group group : {Group::cutting, Group::hand, Group::eye, Group::tools}) {
        Block block;
        block.title = groupText(group);
        for (const ActionInfo& info : actionInfos()) {
            if (info.group != group || isBeside(info.action)) continue;
            block.lines.push_back({info.titleText(), [this, action = info.action](QPainter* p, double x, double y,
                                                                                  const QFontMetricsF& metrics) {
                                       x = bindingsOf(p, x, y, bindings_, action, metrics, palette());
                                       for (const Action key : keysBeside(action))
                                           x = binding(p, x + 4, y, bindings_.of(key)[0], metrics, palette());
                                       return x;
                                   }});
        }
        plan.blocks.push_back(std::move(block));
    }
    if (!commands_.empty()) {
        Block block;
        block.title = tr("The window");
        for (const auto& [text, keys] : commands_)
            block.lines.push_back(
                {text, [this, keys = keys](QPainter* p, double x, double y, const QFontMetricsF& metrics) {
                     return shortcut(p, x, y, keys, metrics, palette());
                 }});
        plan.blocks.push_back(std::move(block));
    }
    // The largest letters that fit in any columns; of these the fewest columns, of these the lowest.
    const double roomX = width() - 16.0, roomY = height() - 16.0;
    plan.font = font();
    bool fits = false;
    while (true) {
        const QFontMetricsF metrics(plan.font);
        for (Block& block : plan.blocks)
            block.measure(metrics);
        const bool last = plan.font.pointSizeF() - 0.5 < kMinPt;
        double best = 0.0;
        for (std::size_t columns = 1; columns <= kMaxColumns && !fits; ++columns) {
            std::size_t ways = 1;
            for (std::size_t i = 0; i < plan.blocks.size(); ++i)
                ways *= columns;
            for (std::size_t way = 0; way < ways; ++way) {
                Columns one = arranged(plan.blocks, columns, way, measuresOf(metrics).row);
                const bool inside = one.width <= roomX && one.height <= roomY;
                const double share = std::min({1.0, roomX / one.width, roomY / one.height});
                if (inside ? (!fits || one.height < plan.columns.height) : (last && !fits && share > best)) {
                    best = share;
                    plan.columns = std::move(one);
                    plan.scale = share;
                }
                fits = fits || inside;
            }
        }
        if (fits || last) break;
        plan.font.setPointSizeF(plan.font.pointSizeF() - 0.5);
    }
    const QSizeF size(plan.columns.width * plan.scale, plan.columns.height * plan.scale);
    plan.card = QRectF({(width() - size.width()) / 2, (height() - size.height()) / 2}, size);
    return plan;
}

QRectF HelpCard::cardArea() const {
    return plan().card;
}

double HelpCard::letterPt() const {
    const Plan now = plan();
    return now.font.pointSizeF() * now.scale;
}

void HelpCard::paintEvent(QPaintEvent*) {
    const Plan plan = this->plan();
    QPainter p(this);
    p.setRenderHint(QPainter::Antialiasing, true);
    p.fillRect(rect(), QColor(0, 0, 0, 130));
    p.translate(plan.card.topLeft());
    p.scale(plan.scale, plan.scale);

    const QFontMetricsF metrics(plan.font);
    const Measures m = measuresOf(metrics);
    const QRectF card(0, 0, plan.columns.width, plan.columns.height);
    const QColor ink = palette().color(QPalette::WindowText), ground = palette().color(QPalette::Window);
    p.setPen(QPen(mix(ground, ink, 0.25), 1));
    p.setBrush(ground);
    p.drawRoundedRect(card, 10, 10);

    QFont title = plan.font;
    title.setBold(true);
    title.setPointSizeF(plan.font.pointSizeF() + 3);
    p.setFont(title);
    p.setPen(ink);
    p.drawText(QRectF(kPad, 8, card.width(), m.row * 1.5), Qt::AlignVCenter, tr("Keys and mouse"));
    p.setFont(plan.font);
    p.setPen(mix(ground, ink, 0.6));
    p.drawText(QRectF(0, 8, card.width() - kPad, m.row * 1.5), Qt::AlignVCenter | Qt::AlignRight,
               tr("Click or press a key to close"));

    QFont head = plan.font;
    head.setBold(true);
    double left = kPad;
    for (const auto& column : plan.columns.of) {
        double text = 0.0, keys = 0.0, y = m.row * 1.7;
        for (const Block* block : column) {
            text = std::max(text, block->text);
            keys = std::max(keys, block->keys);
        }
        for (const Block* block : column) {
            p.setFont(head);
            p.setPen(ink);
            p.drawText(QRectF(left, y, keys + text, m.row), Qt::AlignVCenter, block->title);
            y += m.row;
            p.setPen(QPen(mix(ground, ink, 0.2), 1));
            p.drawLine(QPointF(left, y), QPointF(left + keys + text + kTextToKeys, y));
            y += 3;
            p.setFont(plan.font);
            for (const Line& line : block->lines) {
                p.setPen(ink);
                p.drawText(QRectF(left, y, text + 4, m.row), Qt::AlignVCenter, line.text);
                line.keys(&p, left + text + kTextToKeys, y + (m.row - m.cap) / 2, metrics);
                y += m.row;
            }
            y += m.row * kGapRows - 3;
        }
        left += text + kTextToKeys + keys + kPad;
    }
}

void HelpCard::mousePressEvent(QMouseEvent*) {
    close();
}

void HelpCard::keyPressEvent(QKeyEvent* event) {
    const bool modifier = event->key() == Qt::Key_Shift || event->key() == Qt::Key_Control ||
                          event->key() == Qt::Key_Alt || event->key() == Qt::Key_Meta;
    if (!modifier) close();
}

bool HelpCard::event(QEvent* event) {
    if (event->type() == QEvent::ShortcutOverride) {  // any key closes the card, and does nothing else
        event->accept();
        return true;
    }
    if (event->type() == QEvent::Close) {
        if (QWidget* next = after_ ? after_.data() : parentWidget()) next->setFocus();
    }
    return QWidget::event(event);
}

bool HelpCard::eventFilter(QObject* watched, QEvent* event) {
    if (watched == parent() && event->type() == QEvent::Resize) setGeometry(parentWidget()->rect());
    return QWidget::eventFilter(watched, event);
}

}  // namespace handpiece::desktop
