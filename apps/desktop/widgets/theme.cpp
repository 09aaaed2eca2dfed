// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/theme.h"

#include <QApplication>
#include <QFontInfo>
#include <QLabel>
#include <QPainter>
#include <QProxyStyle>
#include <QStyleOption>

namespace handpiece::desktop {

namespace {

/// One in every appearance: on light and dark windows three to one at least, white text on it four and a half.
constexpr QRgb kAccent = 0x117f95;

QPalette makePalette(bool dark) {
    // Window, text, field, button, highlight: the rest of the palette is mixed from these.
    const QColor window(dark ? 0x1f2328 : 0xf1f3f5), text(dark ? 0xe8eaed : 0x1b1f24);
    const QColor base(dark ? 0x2b3138 : 0xffffff), button(dark ? 0x3a414a : 0xfbfcfd);
    const QColor highlight(kAccent), link(dark ? 0x62c4d6 : kAccent);
    QPalette palette(button, window);
    const auto set = [&palette](QPalette::ColorRole role, const QColor& colour) { palette.setColor(role, colour); };
    set(QPalette::Window, window);
    set(QPalette::WindowText, text);
    set(QPalette::Base, base);
    set(QPalette::AlternateBase, mixed(base, text, dark ? 0.05 : 0.035));
    set(QPalette::Text, text);
    set(QPalette::Button, button);
    set(QPalette::ButtonText, text);
    set(QPalette::BrightText, QColor(0xffffff));
    set(QPalette::ToolTipBase, mixed(window, text, 0.08));
    set(QPalette::ToolTipText, text);
    set(QPalette::PlaceholderText, mixed(base, text, 0.55));
    set(QPalette::Highlight, highlight);
    set(QPalette::HighlightedText, QColor(0xffffff));
    set(QPalette::Link, link);
    set(QPalette::LinkVisited, link);
    set(QPalette::Light, mixed(button, QColor(0xffffff), dark ? 0.08 : 0.6));
    set(QPalette::Midlight, mixed(button, text, 0.06));
    set(QPalette::Mid, mixed(window, text, 0.25));
    set(QPalette::Dark, mixed(window, text, dark ? 0.32 : 0.38));
    set(QPalette::Shadow, QColor(dark ? 0x0d0f12 : 0x8b929a));
    const QColor disabled = mixed(window, text, 0.42);
    for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
        palette.setColor(QPalette::Disabled, role, disabled);
    palette.setColor(QPalette::Disabled, QPalette::Highlight, mixed(window, text, 0.25));
    return palette;
}

/// Fusion draws the edges of boxes darker than the window: on a dark one they cannot be seen. And texts are plain but
/// where it was said that they are not: names out of files are shown as they are, tags and all, in tips as well.
class EdgedFusion : public QProxyStyle {
  public:
    EdgedFusion() : QProxyStyle(QStringLiteral("Fusion")) {}
    void polish(QWidget* widget) override {
        QProxyStyle::polish(widget);
        auto* label = qobject_cast<QLabel*>(widget);
        if (label && label->textFormat() == Qt::AutoText) label->setTextFormat(Qt::PlainText);
    }
    using QProxyStyle::polish;
    void drawPrimitive(PrimitiveElement element, const QStyleOption* option, QPainter* painter,
                       const QWidget* widget) const override {
        QProxyStyle::drawPrimitive(element, option, painter, widget);
        const bool round = element == PE_IndicatorRadioButton;
        if ((!round && element != PE_IndicatorCheckBox && element != PE_FrameLineEdit) || !isDark(option->palette))
            return;
        const QPalette& palette = option->palette;
        const bool on = option->state.testFlag(State_Enabled);
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        painter->setPen(
            QPen(mixed(palette.color(QPalette::Window), palette.color(QPalette::WindowText), on ? 0.5 : 0.25), 1));
        painter->setBrush(Qt::NoBrush);
        const QRectF edge = QRectF(option->rect).adjusted(0.5, 0.5, -0.5, -0.5);
        if (round)
            painter->drawEllipse(edge);
        else
            painter->drawRoundedRect(edge, 2, 2);
        painter->restore();
    }
};

}  // namespace

void applyTheme(QApplication& application, Appearance appearance) {
    // As the desktop gave them, before anything was changed.
    static const QPalette systemPalette = QApplication::palette();
    static const QFont systemFont = QApplication::font();
    QApplication::setStyle(new EdgedFusion);
    QFont font = systemFont;
    // "Sans Serif" is an alias that Qt would pass over for the first family of the list that exists: the one it stands
    // for.
    QStringList families{QFontInfo(systemFont).family()};
    families << font.families() << font.family();
    families << "Noto Sans CJK JP"
             << "IPAexGothic"
             << "IPAPGothic"
             << "IPAGothic";
    families.removeDuplicates();
    font.setFamilies(families);
    QApplication::setFont(font);
    QPalette palette = appearance == Appearance::system ? systemPalette : themePalette(appearance == Appearance::dark);
    for (const auto group : {QPalette::Active, QPalette::Inactive}) {
        palette.setColor(group, QPalette::Highlight, QColor(kAccent));
        palette.setColor(group, QPalette::HighlightedText, QColor(0xffffff));
    }
    application.setPalette(palette);
}

QPalette themePalette(bool dark) {
    return makePalette(dark);
}

bool isDark(const QPalette& palette) {
    return palette.color(QPalette::WindowText).lightnessF() > palette.color(QPalette::Window).lightnessF();
}

Tones tonesOf(const QPalette& palette) {
    const bool dark = isDark(palette);
    const QColor window = palette.color(QPalette::Window), text = palette.color(QPalette::WindowText);
    Tones tones;
    tones.good = QColor(dark ? 0x4cc38a : 0x18794e);
    tones.caution = QColor(dark ? 0xf5b83d : 0xa65f00);
    tones.bad = QColor(dark ? 0xff7b72 : 0xc62a2f);
    // Told apart with any colour vision (Okabe & Ito 2008), lightened or darkened for the background.
    tones.force = QColor(dark ? 0xff9b4a : 0xc44d00);
    tones.depth = QColor(dark ? 0x5db8f5 : 0x0067a8);
    tones.speed = QColor(dark ? 0x3fd1a4 : 0x00795a);
    tones.quiet = mixed(window, text, 0.66);
    tones.line = mixed(window, text, dark ? 0.18 : 0.15);
    tones.raised = dark ? mixed(window, text, 0.06) : palette.color(QPalette::Base);
    return tones;
}

QColor mixed(const QColor& a, const QColor& b, double share) {
    const double keep = 1.0 - share;
    return QColor::fromRgbF(static_cast<float>(a.redF() * keep + b.redF() * share),
                            static_cast<float>(a.greenF() * keep + b.greenF() * share),
                            static_cast<float>(a.blueF() * keep + b.blueF() * share));
}

QFont scaledFont(const QFont& font, double scale, bool bold) {
    QFont scaled = font;
    if (font.pixelSize() > 0)
        scaled.setPixelSize(std::max(6, qRound(font.pixelSize() * scale)));
    else
        scaled.setPointSizeF(std::max(5.0, font.pointSizeF() * scale));
    if (bold) scaled.setWeight(QFont::DemiBold);
    return scaled;
}

}  // namespace handpiece::desktop
