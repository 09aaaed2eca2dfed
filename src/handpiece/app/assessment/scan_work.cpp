// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/scan_work.h"

#include <fmt/format.h>

#include <utility>

namespace handpiece::assessment {

Work readScan(const scan_work::Files& files, const tasks::Task& task, const core::Progress& progress) {
    return workOfScan(scan_work::readScan(files, task, progress));
}

Work workOfScan(scan_work::ScannedTeeth scanned) {
    Work work;
    work.noHand = "a scan says nothing of the hand";
    work.noBeside = std::move(scanned.notBeside);
    const score::ScanFit& fit = scanned.fit;
    work.proof = fmt::format(
        "a scan, registered on {:.0f} mm2 of {}, rms {:.3f} mm: it says what the tooth is like, not how it came to be "
        "so",
        fit.uncutMm2, scan_work::wordsOf(fit.registeredOn), fit.rmsMm);
    if (!(fit.cutMm2 > 0.0)) work.proof += "; nothing of the tooth is gone";
    work.context.device = "scan";
    work.scan = fit;
    work.teeth = std::move(scanned.teeth);
    work.state = std::move(scanned.state);
    return work;
}

}  // namespace handpiece::assessment
