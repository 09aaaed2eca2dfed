// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/icon_factory.h"

#include <QApplication>
#include <QDir>
#include <QFile>
#include <QIconEngine>
#include <QPainter>
#include <QPalette>
#include <QPixmapCache>
#include <QSvgRenderer>

// A static library's resources are linked only where they are asked for; the macro cannot stand in a namespace.
static void loadIconResource() {
    Q_INIT_RESOURCE(icons);
}

namespace handpiece::desktop {

namespace {

const QString kFolder = QStringLiteral(":/handpiece/icons/");

QByteArray readIcon(const QString& name) {
    static const bool loaded = (loadIconResource(), true);
    Q_UNUSED(loaded);
    QFile file(kFolder + name + ".svg");
    return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
}

/// Draws the drawing anew in the palette's colour for every size it is asked for.
class TintedEngine : public QIconEngine {
  public:
    TintedEngine(QString name, QByteArray drawing) : name_(std::move(name)), drawing_(std::move(drawing)) {}

    void paint(QPainter* painter, const QRect& rect, QIcon::Mode mode, QIcon::State state) override {
        Q_UNUSED(state);
        QByteArray tinted = drawing_;
        tinted.replace("currentColor", colour(mode).name(QColor::HexRgb).toLatin1());
        QSvgRenderer renderer(tinted);
        const int side = std::min(rect.width(), rect.height());
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        renderer.render(painter, QRectF(rect.x() + (rect.width() - side) / 2.0, rect.y() + (rect.height() - side) / 2.0,
                                        side, side));
        painter->restore();
    }
    QPixmap pixmap(const QSize& size, QIcon::Mode mode, QIcon::State state) override {
        const QString key = QStringLiteral("handpiece/%1/%2x%3/%4")
                                .arg(name_)
                                .arg(size.width())
                                .arg(size.height())
                                .arg(colour(mode).rgba());
        QPixmap pixmap;
        if (QPixmapCache::find(key, &pixmap)) return pixmap;
        pixmap = QPixmap(size);
        pixmap.fill(Qt::transparent);
        QPainter painter(&pixmap);
        paint(&painter, QRect(QPoint(), size), mode, state);
        painter.end();
        QPixmapCache::insert(key, pixmap);
        return pixmap;
    }
    [[nodiscard]] QIconEngine* clone() const override { return new TintedEngine(name_, drawing_); }

  private:
    static QColor colour(QIcon::Mode mode) {
        const QPalette palette = QApplication::palette();
        if (mode == QIcon::Disabled) return palette.color(QPalette::Disabled, QPalette::ButtonText);
        if (mode == QIcon::Selected) return palette.color(QPalette::HighlightedText);
        return palette.color(QPalette::ButtonText);
    }

    QString name_;
    QByteArray drawing_;
};

}  // namespace

QIcon icon(const QString& name) {
    const QByteArray drawing = readIcon(name);
    return drawing.isEmpty() ? QIcon() : QIcon(new TintedEngine(name, drawing));
}

QStringList iconNames() {
    readIcon("tooth");  // the resource is there from now on
    QStringList names;
    for (const QString& file : QDir(kFolder).entryList({"*.svg"}, QDir::Files, QDir::Name))
        if (file != "app.svg") names << file.chopped(4);
    return names;
}

QIcon applicationIcon() {
    QIcon icon;
    const QByteArray drawing = readIcon("app");
    QSvgRenderer renderer(drawing);
    for (const int side : {16, 24, 32, 48, 64, 128, 256}) {
        QPixmap pixmap(side, side);
        pixmap.fill(Qt::transparent);
        QPainter painter(&pixmap);
        renderer.render(&painter);
        painter.end();
        icon.addPixmap(pixmap);
    }
    return icon;
}

}  // namespace handpiece::desktop
