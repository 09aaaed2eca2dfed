// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <QApplication>
#include <QSignalSpy>
#include <QTest>

#include "desktop/picture/view_widget.h"
#include "view_ball.h"

namespace handpiece::desktop::view_no_opengl_test {
namespace {

TEST(ViewWithoutOpenGl, SaysSoAndGoesOn) {
    // The loader of OpenGL drivers reads this when the first display is opened: hence a program of its own.
    qputenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent/vendor.json");
    ViewWidget view;
    QSignalSpy missing(&view, &ViewWidget::openGlMissing);
    view.resize(500, 400);
    view.show();
    ASSERT_TRUE(missing.count() || missing.wait(60000));
    EXPECT_FALSE(missing[0][0].toString().isEmpty());
    EXPECT_FALSE(missing[0][1].toString().isEmpty());
    view.setTooth(std::make_shared<simulation::LiveTooth>(cuttableBall(), tooth::StateDelta{}),
                  std::make_shared<const cases::Case>(ballCase()), nullptr);
    auto mailbox = std::make_shared<device::PointerMailbox>();
    view.setPointer(mailbox, {});
    QTest::mousePress(&view, Qt::LeftButton, Qt::NoModifier, {250, 200});
    EXPECT_EQ(mailbox->read().pedal, 1.0);
    EXPECT_FALSE(view.snapshot().isNull());
    EXPECT_TRUE(view.rendererDescription().isEmpty());
}

}  // namespace
}  // namespace handpiece::desktop::view_no_opengl_test
