// SPDX-License-Identifier: Apache-2.0
// Radiographs in the window: taken of the tooth that is open, by clicks, cancelled, saved.
#include <QComboBox>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>

#include "desktop/features/radiograph/radiograph_dialog.h"
#include "handpiece/base/core/file.h"
#include "shell_support.h"

namespace handpiece::desktop::radiograph_window_test {
namespace {

namespace fs = std::filesystem;

class RadiographTest : public ShellTest {
  protected:
    template <class W>
    [[nodiscard]] W* part(const char* name) {
        return window().findChild<W*>(QLatin1String(name));
    }
    [[nodiscard]] RadiographDialog& dialog() { return *part<RadiographDialog>("radiographDialog"); }
    void openDialog() {
        startWithTooth();
        ASSERT_TRUE(action("actionRadiograph")->isEnabled());
        action("actionRadiograph")->trigger();
        ASSERT_TRUE(dialog().isVisible());
        ASSERT_TRUE(waitFor([this] { return dialog().taken().has_value(); }));
    }
    void choose(const char* name, int row) {
        auto* box = part<QComboBox>(name);
        box->setFocus();
        QTest::keyClick(box, row > box->currentIndex() ? Qt::Key_Down : Qt::Key_Up);
        ASSERT_EQ(box->currentIndex(), row);
    }
};

TEST_F(RadiographTest, IsTakenAndShownAsWhatTheLibraryComputes) {
    openDialog();
    radiograph::Settings settings;
    settings.fdiNumber = simulator().toothCase()->fdiNumber;
    EXPECT_EQ(dialog().taken()->picture.grey, radiograph::take(*simulator().toothCase(), settings).picture.grey);
    const QPixmap shown = part<QLabel>("radiographPicture")->pixmap();
    ASSERT_FALSE(shown.isNull());
    EXPECT_FALSE(part<QProgressBar>("radiographProgress")->isVisible());
    EXPECT_FALSE(part<QLabel>("radiographNote")->text().isEmpty());
    // The other view.
    const auto bitewing = dialog().taken()->picture.grey;
    choose("radiographView", 1);
    ASSERT_TRUE(waitFor([this] { return dialog().taken().has_value(); }));
    EXPECT_EQ(dialog().taken()->settings.view, radiograph::View::periapical);
    EXPECT_NE(dialog().taken()->picture.grey, bitewing);
}

TEST_F(RadiographTest, CanBeCancelledAndTakenAgain) {
    openDialog();
    choose("radiographView", 1);
    auto* cancel = part<QPushButton>("radiographCancel");
    ASSERT_TRUE(cancel->isVisible());
    QTest::mouseClick(cancel, Qt::LeftButton);
    EXPECT_FALSE(dialog().taken().has_value());
    EXPECT_FALSE(cancel->isVisible());
    EXPECT_FALSE(part<QPushButton>("radiographSave")->isEnabled());
    choose("radiographView", 0);
    ASSERT_TRUE(waitFor([this] { return dialog().taken().has_value(); }));
}

TEST_F(RadiographTest, IsSavedAsPngAndDicomMarkedAsSimulated) {
    openDialog();
    auto* save = part<QPushButton>("radiographSave");
    ASSERT_TRUE(save->isEnabled());
    for (const char* name : {"r.png", "r.dcm"}) {
        file_ = own_.filePath(QLatin1String(name));
        QTest::mouseClick(save, Qt::LeftButton);
        const auto bytes = core::readFile(toPath(file_));
        const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        if (file_.endsWith(".dcm"))
            EXPECT_NE(text.find("SIMULATED bitewing"), std::string::npos);
        else
            EXPECT_EQ(text.substr(1, 3), "PNG");
    }
    // A place that cannot be written is told of, and nothing is lost.
    file_ = own_.filePath("no/such/folder/r.png");
    QTest::mouseClick(save, Qt::LeftButton);
    EXPECT_TRUE(dialog().taken().has_value());
}

TEST_F(RadiographTest, ShowsTheToothAsItIsCut) {
    openDialog();
    const auto uncut = dialog().taken()->picture.grey;
    ASSERT_TRUE(cut());
    QTest::mouseClick(part<QPushButton>("radiographAgain"), Qt::LeftButton);
    ASSERT_TRUE(waitFor([this] { return dialog().taken().has_value(); }));
    EXPECT_NE(dialog().taken()->picture.grey, uncut);
}

TEST_F(RadiographTest, FollowsTheToothThatIsOpen) {
    openDialog();
    EXPECT_EQ(dialog().taken()->fdiNumber, 46);
    openTooth(11);
    ASSERT_TRUE(waitFor([this] { return dialog().taken().has_value() && dialog().taken()->fdiNumber == 11; }));
}

}  // namespace
}  // namespace handpiece::desktop::radiograph_window_test
