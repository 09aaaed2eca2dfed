// SPDX-License-Identifier: Apache-2.0
// Draws the program's icon from its SVG in the sizes desktops ask for: icon_maker ICON.svg FOLDER
#include <QDir>
#include <QFile>
#include <QImage>
#include <QPainter>
#include <QSvgRenderer>
#include <cstdio>

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: icon_maker ICON.svg FOLDER\n");
        return 2;
    }
    const QString source = QString::fromLocal8Bit(argv[1]), folder = QString::fromLocal8Bit(argv[2]);
    QSvgRenderer drawing(source);
    if (!drawing.isValid()) {
        std::fprintf(stderr, "icon_maker: %s is no drawing\n", argv[1]);
        return 1;
    }
    for (const int size : {48, 128, 256}) {
        QImage image(size, size, QImage::Format_ARGB32);
        image.fill(Qt::transparent);
        {
            QPainter painter(&image);
            drawing.render(&painter);
        }
        const QString place = QStringLiteral("%1/%2x%2/apps").arg(folder).arg(size);
        if (!QDir().mkpath(place) || !image.save(place + QStringLiteral("/handpiece.png"))) {
            std::fprintf(stderr, "icon_maker: cannot write below %s\n", argv[2]);
            return 1;
        }
    }
    const QString scalable = folder + QStringLiteral("/scalable/apps");
    QFile::remove(scalable + QStringLiteral("/handpiece.svg"));
    if (!QDir().mkpath(scalable) || !QFile::copy(source, scalable + QStringLiteral("/handpiece.svg"))) return 1;
    return 0;
}
