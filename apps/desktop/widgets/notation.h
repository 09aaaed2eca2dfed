// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Names of teeth: FDI (ISO 3950), Universal, Palmer.

#include <QString>
#include <optional>
#include <vector>

#include "handpiece/model/case/tissue.h"

namespace handpiece::desktop {

enum class Notation { fdi, universal, palmer };

/// Of a tooth by its FDI number: "46", "30", or its place with a corner of the mouth's cross (Palmer). Permanent teeth
/// 11 to 48, primary 51 to 85; empty for other numbers.
[[nodiscard]] QString toothLabel(int fdi, Notation notation);
/// The FDI number of a label as typed. Palmer also as "LR6", "6 LR" or "LR E"; Universal "30", "T". Nothing for what is
/// no tooth.
[[nodiscard]] std::optional<int> toothOf(const QString& label, Notation notation);
/// "Lower right first molar", translated; empty for no tooth.
[[nodiscard]] QString toothName(int fdi);
/// FDI numbers in the order of the arch, patient's right to left: 18..11 21..28, 48..41 31..38; primary 55..51 61..65.
[[nodiscard]] std::vector<int> upperArch(bool primary);
[[nodiscard]] std::vector<int> lowerArch(bool primary);

/// "Enamel", translated.
[[nodiscard]] QString tissueName(cases::Tissue tissue);

}  // namespace handpiece::desktop
