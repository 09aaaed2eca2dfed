// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A session as one page to print: what was cut, how long it took, what the hand did.

#include <string>

#include "handpiece/app/report/report_html.h"
#include "handpiece/app/report/review.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::report {

struct ReportSettings {
    bool pictures = true;  ///< false, or without OpenGL: the page says so in their place
    int pictureWidth = 640, pictureHeight = 480;
    ReviewedAgainst against{};  ///< the work's exercise and score: shown in the viewer
};

/// In the program's language.
[[nodiscard]] std::string nameOf(cases::Tissue tissue);
/// The legend of pictures in textbook colours.
[[nodiscard]] std::vector<HtmlReport::Chip> chipsOf(const std::vector<cases::Tissue>& tissues);

/// One HTML page, A4, nothing loaded from elsewhere. Cuts the session again from its beginning: its verdict is on the
/// page, and the player stands at the end afterwards. Needs a player with a tooth() when there are to be pictures.
/// Throws core::Error as SessionPlayer::compareAll.
[[nodiscard]] std::string sessionReport(simulation::SessionPlayer& player, const ReportSettings& settings = {},
                                        const core::Progress& progress = {});

}  // namespace handpiece::report
