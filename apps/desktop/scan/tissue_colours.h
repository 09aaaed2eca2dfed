// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The colours of tissues over slices: the textbook's, and caries lighter: slices are dark.

#include <QColor>

#include "handpiece/senses/view/look.h"

namespace handpiece::desktop {

[[nodiscard]] inline QColor tissueColour(tooth::Tissue tissue) {
    if (tissue == tooth::Tissue::none) return {0xc0, 0xc6, 0xce};
    const auto colour = view::colourOf(tissue, view::Palette::textbook);
    const QColor plain(colour[0], colour[1], colour[2]);
    return tissue == tooth::Tissue::caries ? plain.lighter(220) : plain;
}

}  // namespace handpiece::desktop
