// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A station of a school under the offscreen platform: the real server beside it, and a teacher's eyes on its pages.

#include <QProcess>

#include "practice_support.h"

namespace handpiece::desktop {

class SchoolStation : public PracticeTest {
  protected:
    void SetUp() override {
        program_ = toPath(QCoreApplication::applicationDirPath()) / "handpiece-school";
        if (!core::isThere(program_)) GTEST_SKIP() << "handpiece-school is not built";
    }
    void TearDown() override {
        host_.reset();
        stopServer();
    }
    /// What it prints; `input` is typed in.
    QString school(const QStringList& arguments, const QByteArray& input = {}) {
        QProcess process;
        process.start(toQString(program_), arguments);
        process.write(input);
        process.closeWriteChannel();
        EXPECT_TRUE(process.waitForFinished(120000));
        EXPECT_EQ(process.exitCode(), 0) << process.readAllStandardError().toStdString();
        return QString::fromUtf8(process.readAllStandardOutput()).trimmed();
    }
    void startServer(int workers = 0) {
        server_ = std::make_unique<QProcess>();
        server_->start(toQString(program_), {"serve", "--data", data(), "--listen", "127.0.0.1:" + port_, "--workers",
                                             QString::number(workers)});
        ASSERT_TRUE(server_->waitForReadyRead(120000)) << server_->readAllStandardError().toStdString();
        const QString line = QString::fromUtf8(server_->readLine());
        address_ = line.left(line.indexOf(' '));
        port_ = address_.mid(address_.lastIndexOf(':') + 1);
    }
    void stopServer() {
        if (!server_) return;
        server_->kill();
        server_->waitForFinished();
        server_.reset();
    }
    /// A class with one student and one teacher. Returns the hash of the exercise, which is the school's by now.
    QString makeClass(const std::filesystem::path& exercise) {
        const QString d = data();
        school({"person", "--data", d, "s017", "--name", "Ida Ito"});
        school({"person", "--data", d, "t01", "--name", "Dr. Sato", "--role", "teacher"});
        school({"password", "--data", d, "t01"}, "a long enough one\n");
        class_ = school({"class", "--data", d, "Operative 2"});
        school({"join", "--data", d, class_, "s017"});
        school({"join", "--data", d, class_, "t01", "--role", "teacher"});
        return school({"exercise", "--data", d, toQString(exercise)}).section("exercise ", 1, 1).section(',', 0, 0);
    }
    [[nodiscard]] QString data() const { return toQString(at("server")); }
    /// By a teacher's eyes, through a program of everybody's.
    QByteArray asTeacher(const QString& path) {
        const QString jar = own_.filePath("jar");
        QProcess curl;
        if (!QFile::exists(jar)) {
            curl.start("curl", {"-s", "-c", jar, "-d", "login=t01&password=a long enough one", address_ + "/login"});
            EXPECT_TRUE(curl.waitForFinished(60000));
        }
        curl.start("curl", {"-s", "-b", jar, address_ + path});
        EXPECT_TRUE(curl.waitForFinished(60000));
        return curl.readAllStandardOutput();
    }

    std::filesystem::path program_;
    std::unique_ptr<QProcess> server_;
    QString address_, port_ = QStringLiteral("0"), class_;
};

}  // namespace handpiece::desktop
