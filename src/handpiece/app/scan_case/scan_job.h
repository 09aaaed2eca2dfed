// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From a scan to cases: a person's decisions as plain data, and the work they ask for. The command line and the
/// window's wizard do the same with it.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/model/case/case.h"
#include "handpiece/model/dentition/arch.h"
#include "handpiece/scan/registration/make_case.h"
#include "handpiece/scan/registration/registration.h"
#include "handpiece/scan/segmentation/label_key.h"
#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/surfacing/surfaces.h"
#include "handpiece/scan/volume/read_scan.h"

namespace handpiece::scan_case {

/// Everything a person decides between a scan and a case. Same job, same scan: the same bytes of case. `source`,
/// `intraoral` and `tissuesFile` stay in the job's own file: no case, report or message of success holds them.
struct ScanJob {
    // What is read.
    std::filesystem::path source;                       ///< file, folder, ZIP or DICOMDIR
    std::string series;                                 ///< as volume::Series::id; empty: the only one
    std::optional<core::Vec3> spacingMm;                ///< wins over the file's
    bool reverseSlices = false;                         ///< as volume::ReadSettings
    std::optional<std::array<core::Vec3, 2>> regionMm;  ///< as volume::ReadSettings
    bool isLabels = false;                 ///< its values are labels; told from the file where they are teeth's
    std::vector<std::uint8_t> labelOrder;  ///< what the file's numbers 0, 1, 2, ... mean, as volume::Labels' numbers;
                                           ///< empty: they are those, or teeth
    std::optional<segmentation::LabelNumbers> labelNumbers;  ///< wins over what the file's names and numbers tell
    std::filesystem::path
        grey;  ///< the scan that labels of a mouth are of: tells the tissues in each tooth; empty: none
    // Which tooth, of what.
    segmentation::Settings segmentation;
    std::optional<double> toothFrom, enamelFrom;  ///< grey values that win over those found, where
                                                  ///< segmentation.thresholds has none
    bool smooth = true;
    // An intraoral scan as the outer surface.
    std::filesystem::path intraoral;                        ///< mesh; empty: none
    std::string intraoralUnit = "mm";                       ///< of that mesh: mm, cm, m, inch or um
    std::optional<core::Pose> intraoralInScan;              ///< roughly, by hand; none: found by features
    double intraoralReachMm = 0.5, intraoralOverlap = 0.5;  ///< as registration::withOuterSurface, RegisterSettings
    // The tooth's own frame and the case's words.
    registration::Hints placing;  ///< with the FDI number; in labels of a mouth it chooses the tooth
    std::string name = "scanned tooth";
    std::string kind;
    std::filesystem::path tissuesFile;  ///< table of tissues of one's own; empty: as shipped
    double openingMm =
        dentition::kOpeningMm;  ///< of a mouth: its jaws are opened so far between the incisal edges; 0: as scanned
    bool scenery = false;       ///< what stands around the tooth in the scan, as far as kSceneryReachMm
    // How fine.
    std::vector<double> percents;  ///< a case each; empty: one case, with as many faces as the standard field can use
    std::size_t faces = 0;         ///< of all surfaces together, instead of percents; 0: by percents
};
inline constexpr double kSceneryReachMm = 8.0;
/// How its scan is read.
[[nodiscard]] volume::ReadSettings readSettings(const ScanJob& job);

/// As TOML, every decision with its unit in its name; what is as by default is left out. Bytes of a name that are no
/// UTF-8 are written out in it: such a text only tells jobs apart.
[[nodiscard]] std::string toToml(const ScanJob& job);
/// Throws core::Error naming `where`, line and key for what is unknown or out of range. Relative paths are kept as they
/// stand.
[[nodiscard]] ScanJob scanJobFromToml(std::string_view text, const std::string& where);
[[nodiscard]] ScanJob readScanJob(const std::filesystem::path& file);
/// Throws core::Error, also for a name that is no UTF-8.
void writeScanJob(const ScanJob& job, const std::filesystem::path& file);

enum class ScanStage { read, segment, surface, place, decimate, check };
inline constexpr std::array<ScanStage, 6> kScanStages{ScanStage::read,  ScanStage::segment,  ScanStage::surface,
                                                      ScanStage::place, ScanStage::decimate, ScanStage::check};
/// "reading", "segmenting", "making surfaces", "placing", "reducing", "checking".
[[nodiscard]] std::string_view nameOf(ScanStage stage);

/// Called with the stage at work and the fraction of it that is done (0..1); returns false to cancel: then
/// core::Error("cancelled"). May be empty. May be called from any thread.
using ScanProgress = std::function<bool(ScanStage, double)>;

/// What one stage took. Zero where its result came from the run before.
struct ScanTimings {
    std::array<double, kScanStages.size()> seconds{};
    [[nodiscard]] double of(ScanStage stage) const { return seconds[static_cast<std::size_t>(stage)]; }
    [[nodiscard]] double total() const;
};

/// A case at one resolution.
struct ScannedCase {
    double percent = 100.0;  ///< of the full surfaces' faces
    std::shared_ptr<const surfacing::Surfaces> surfaces;
    cases::Case toothCase;  ///< `source` is empty
};

/// Another tooth of a mouth.
struct OtherTooth {
    int fdi = 0;
    std::shared_ptr<const surfacing::Surfaces> full;  ///< scanner's frame
    registration::Placed placed;
};

/// All that came out, stage by stage; a stage that was not reached is null or empty. Cheap to copy.
struct ScanResult {
    ScanJob job;
    // read
    std::shared_ptr<const volume::Scan> scan;
    std::shared_ptr<const volume::Labels> labels;  ///< where the scan is labels
    std::shared_ptr<const segmentation::LabelKey> labelKey;
    std::shared_ptr<const volume::Scan> grey;  ///< as the job has it
    // segment
    std::shared_ptr<const segmentation::Region> region;
    std::array<double, cases::kTissueCount> volumesMm3{};  ///< sub-voxel, of the region
    int fdiNumber = 0;                                     ///< of a mouth's tooth that is worked on
    std::vector<segmentation::LabelledTooth> teeth;        ///< of a mouth: all of them
    segmentation::Thresholds greyLevels{};                 ///< of the scan that its labels are of
    std::vector<std::string> toothNotes;
    // surface
    std::shared_ptr<const surfacing::Surfaces> full;
    std::optional<registration::Registered> registered;  ///< of the intraoral scan
    std::vector<OtherTooth> others;                      ///< of a mouth, by FDI number
    std::vector<std::string> mouthNotes;
    // place
    registration::Placed placed;
    bool isPlaced = false;
    std::vector<cases::Part> scenery;   ///< scanner's frame
    std::vector<std::string> ownNotes;  ///< of the work here; notes() has all
    // decimate
    std::vector<ScannedCase> cases;
    std::vector<std::string> caseNotes;  ///< how many faces were chosen; with check: what to know of each case

    ScanTimings timings;
    /// What a person should know, of all stages: plain sentences without names or paths.
    [[nodiscard]] std::vector<std::string> notes() const;
    [[nodiscard]] bool isMouth() const { return labelKey && labelKey->isMouth; }
};

struct ReadLabels {
    std::shared_ptr<const volume::Labels> labels;  ///< of one tooth: by volume::Labels' numbers
    std::shared_ptr<const segmentation::LabelKey> key;
};
/// A scan's values as the labels that the job says they are, or that they plainly are; none where they are grey values.
/// Throws core::Error for labels that are none, and where it is not told what they mean.
[[nodiscard]] std::optional<ReadLabels> readLabels(const volume::Scan& scan, const ScanJob& job);

/// Does the job up to and with stage `last`. Results of `before` are taken over where no decision that they depend on
/// has changed, so a wizard passes its last result and waits for what it changed only. A scan read elsewhere is handed
/// in as before->scan with before->job holding the same decisions of what is read. Throws core::Error, also where a
/// case would not pass cases::checkCase().
[[nodiscard]] ScanResult runScanJob(const ScanJob& job, const ScanProgress& progress = {},
                                    const ScanResult* before = nullptr, ScanStage last = ScanStage::check);

/// The places that writeScanCases() writes to: `out` for one case; for several CASE-6, CASE-12, ... (mine.handpiece:
/// mine-6.handpiece, ...).
[[nodiscard]] std::vector<std::filesystem::path> casePlaces(const ScanJob& job, const std::filesystem::path& out);
/// Every case of a finished result, folder or .handpiece file by its name; returns the places. An error leaves none.
std::vector<std::filesystem::path> writeScanCases(const ScanResult& result, const std::filesystem::path& out);

}  // namespace handpiece::scan_case
