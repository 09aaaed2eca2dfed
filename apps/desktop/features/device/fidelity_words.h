// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the fidelity report says, in the person's language.

#include <QString>
#include <QStringList>
#include <string>

namespace handpiece::desktop {

/// A finding's name, remedy or value in the person's language; as it is when it is not known, as with figures.
[[nodiscard]] QString fidelityWords(const std::string& english);
/// The sentences that are known.
[[nodiscard]] QStringList fidelitySentences();

}  // namespace handpiece::desktop
