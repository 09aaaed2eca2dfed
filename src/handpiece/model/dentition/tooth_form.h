// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Permanent teeth made from rules: what of docs/anatomy.md can be said in functions of space.

#include <cstdint>
#include <memory>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/case.h"

namespace handpiece::dentition {

/// Who the teeth are of: the seed makes sizes and shapes within published spreads (0: the average of all), the age
/// moves pulp and wear.
struct Patient {
    std::uint64_t seed = 1;
    double ageYears = 25.0;
    friend bool operator==(const Patient&, const Patient&) = default;
};

/// Raised when the same request gives another tooth or mouth: those that are kept are made anew, and exercises in which
/// they stand get another version.
inline constexpr int kTeethRevision = 5;

class Anatomy;

/// The surfaces of one tooth as functions, negative inside, about distances [mm] near their zero, at most kLipschitz
/// steep. In the tooth's own frame: +z occlusal, +x mesial, +y completes the right hand; z = 0 is the mean level of the
/// cemento-enamel junction. Teeth of the left are those of the right mirrored in y. Cheap to copy.
class ToothForm {
  public:
    /// Throws core::Error for a number that is no permanent tooth (11..18, 21..28, 31..38, 41..48) and for an age that
    /// is not of such teeth (6..110).
    ToothForm(int fdi, const Patient& patient);

    static constexpr double kLipschitz = 4.0;

    [[nodiscard]] double outer(const core::Vec3& p) const;
    [[nodiscard]] double enamel(const core::Vec3& p) const;
    [[nodiscard]] double dentine(const core::Vec3& p) const;  ///< with the pulp in it
    [[nodiscard]] double pulp(const core::Vec3& p) const;
    [[nodiscard]] double cementum(const core::Vec3& p) const;
    /// Height over the cemento-enamel junction [mm], of a point near it.
    [[nodiscard]] double aboveCervix(const core::Vec3& p) const;
    /// Where the tooth lies, with a margin.
    [[nodiscard]] core::Box bounds() const;

    [[nodiscard]] int fdi() const { return fdi_; }
    /// +1: buccal (labial) is +y, -1: -y.
    [[nodiscard]] int buccalSign() const { return buccalSign_; }
    /// Of this patient's tooth, measured on its surface as dentists do: the crown from the buccal cervix to the highest
    /// cusp, the longest root from there to its apex, the widest of the crown across.
    [[nodiscard]] double crownHeightMm() const;
    [[nodiscard]] double rootLengthMm() const;
    [[nodiscard]] double mesiodistalMm() const;
    [[nodiscard]] double buccolingualMm() const;
    [[nodiscard]] core::Vec3 mesialContactMm() const;
    [[nodiscard]] core::Vec3 distalContactMm() const;
    /// What dentists name, on the surfaces: source generated.
    [[nodiscard]] std::vector<cases::Landmark> landmarks() const;

  private:
    int fdi_, buccalSign_;
    std::shared_ptr<const Anatomy> anatomy_;
};

struct ToothOptions {
    std::size_t faces = 68151;  ///< of the outer surface; an odd count becomes the even one above
    std::size_t partFaces = 0;  ///< of each tissue's surface; 0: half as fine as the outer surface, at most 120,000
};

inline constexpr std::size_t kMinFaces = 2000, kMaxFaces = 2000000;

/// Outer surface, enamel, dentine, pulp and landmarks of a tooth in its own frame. In parallel; the same bytes for the
/// same request at any thread count. Throws core::Error for face counts outside kMinFaces..kMaxFaces and as ToothForm
/// does.
[[nodiscard]] cases::Tooth makeTooth(int fdi, const Patient& patient, const ToothOptions& options = {},
                                     const core::Progress& progress = {});

/// Its enamel and dentine roughly, to be looked at while the tooth itself is made: a fraction of a second. Throws as
/// ToothForm does.
[[nodiscard]] cases::Tooth makeSketch(int fdi, const Patient& patient);

/// "upper right first molar"
[[nodiscard]] std::string toothName(int fdi);
/// "upper-first-molar"
[[nodiscard]] std::string toothKindName(int fdi);

}  // namespace handpiece::dentition
