// SPDX-License-Identifier: Apache-2.0
#include "studies/run_output.h"

#include <cmath>

#include "handpiece/base/core/file.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/tick/contact/method.h"
#include "studies/run_job.h"

namespace handpiece::studies {
namespace {

namespace fs = std::filesystem;
using cases::Tissue;
using messages::HapticSample;

constexpr std::string_view kHeader =
    "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,vx_mm_s,vy_mm_s,vz_mm_s,fx_n,fy_n,fz_n,depth_mm,work_us,late_us,"
    "true_x_mm,true_y_mm,true_z_mm,proxy_x_mm,proxy_y_mm,proxy_z_mm,proxy_qw,proxy_qx,proxy_qy,proxy_qz,"
    "applied_fx_n,applied_fy_n,applied_fz_n,area_mm2,tissue,flags,"
    "rpm,removed_enamel_mm3,removed_dentine_mm3,removed_caries_mm3,removed_pulp_mm3\n";

constexpr Tissue kPlotted[] = {Tissue::enamel, Tissue::dentine, Tissue::caries, Tissue::pulp};

double removed(const HapticSample& s, Tissue tissue) {
    if (tissue != Tissue::caries) return s.removedMm3[static_cast<std::size_t>(tissue)];
    double carious = 0.0;  // of every level
    for (std::size_t t = 0; t < cases::kTissueCount; ++t)
        if (cases::isCarious(static_cast<Tissue>(t))) carious += s.removedMm3[t];
    return carious;
}

void writeLine(TextWriter& out, fmt::memory_buffer& buffer, const HapticSample& s) {
    buffer.clear();
    const auto to = std::back_inserter(buffer);
    const auto& p = s.positionMm;
    const auto& q = s.orientation;
    const auto& v = s.velocityMmS;
    const auto& f = s.forceN;
    fmt::format_to(to, "{:.7g},{:.7f},{:.7f},{:.7f},{:.9f},{:.9f},{:.9f},{:.9f},", s.timeS, p[0], p[1], p[2], q[0],
                   q[1], q[2], q[3]);
    fmt::format_to(to, "{:.6f},{:.6f},{:.6f},{:.7f},{:.7f},{:.7f},{:.9f},{:.3f},{:.3f},", v[0], v[1], v[2], f[0], f[1],
                   f[2], s.depthMm, s.workUs, s.lateUs);
    const auto& a = s.appliedForceN;
    const auto& r = s.proxyOrientation;
    fmt::format_to(to, "{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.9f},{:.9f},{:.9f},{:.9f},", s.truePositionMm[0],
                   s.truePositionMm[1], s.truePositionMm[2], s.proxyPositionMm[0], s.proxyPositionMm[1],
                   s.proxyPositionMm[2], r[0], r[1], r[2], r[3]);
    fmt::format_to(to, "{:.7f},{:.7f},{:.7f},{:.6f},{},{},", a[0], a[1], a[2], s.contactAreaMm2,
                   cases::properties(static_cast<Tissue>(s.tissue)).name, s.flags);
    fmt::format_to(to, "{:.1f},{:.9f},{:.9f},{:.9f},{:.9f}\n", s.speedRpm, removed(s, Tissue::enamel),
                   removed(s, Tissue::dentine), removed(s, Tissue::caries), removed(s, Tissue::pulp));
    out.write({buffer.data(), buffer.size()});
}

std::string plot(std::string title, std::string label, std::vector<report::Series> series,
                 std::vector<report::Limit> limits) {
    return report::toSvg({std::move(title), "time [s]", std::move(label), std::move(series), std::move(limits)}, true);
}

}  // namespace

Outputs::Outputs(const fs::path& folder) : folder_(folder) {
    std::error_code ec;
    existed_ = fs::exists(folder, ec);
    core::prepareOutputFolder(folder);
}

Outputs::~Outputs() {
    if (kept_) return;
    std::error_code ec;
    for (const fs::path& path : written_)
        fs::remove(path, ec);
    if (!existed_) fs::remove(folder_, ec);  // only when empty
}

void Outputs::write(const char* name, const std::string& text) {
    core::writeFile(path(name), text);
    wrote(name);
}

RunTrace::RunTrace(const fs::path& file, double durationS)
    : file_(file.string()),
      depth_(durationS),
      force_(durationS),
      applied_(durationS),
      speed_{Curve(durationS), Curve(durationS), Curve(durationS)},
      rotor_(durationS),
      feed_(durationS),
      removed_(std::size(kPlotted), Curve(durationS)) {
    file_.write(kHeader);
}

void RunTrace::take(const HapticSample& s) {
    writeLine(file_, buffer_, s);
    // A bound, not a distance, where nothing is within reach: a gap in the plot.
    if (s.contactStatus != static_cast<std::uint8_t>(contact::Status::beyondReach)) depth_.take(s.timeS, s.depthMm);
    force_.take(s.timeS, studies::forceOf(s));
    applied_.take(s.timeS, core::hypot(s.appliedForceN[0], s.appliedForceN[1], s.appliedForceN[2]));
    for (std::size_t axis = 0; axis < 3; ++axis)
        speed_[axis].take(s.timeS, s.velocityMmS[axis]);
    rotor_.take(s.timeS, 1e-3 * s.speedRpm);
    feed_.take(s.timeS, static_cast<double>(s.feedMmS));
    for (std::size_t i = 0; i < removed_.size(); ++i)
        removed_[i].take(s.timeS, removed(s, kPlotted[i]));
}

void RunTrace::finish(Outputs& outputs, double deviceLimitN, bool cut) {
    const std::string depthSvg =
        plot("Depth (above 0) and distance (below)", "depth [mm]", {depth_.series("")}, {{0.0, "touch"}});
    const std::string speedSvg = plot("Speed of the bur, filtered", "speed [mm/s]",
                                      {speed_[0].series("x"), speed_[1].series("y"), speed_[2].series("z")}, {});
    const std::string forceSvg =
        plot("Force on the hand", "force [N]", {applied_.series("applied"), force_.series("commanded")},
             {{deviceLimitN, fmt::format("the device's limit, {:.1f} N", deviceLimitN)}});
    file_.commit();
    outputs.wrote("trace.csv");
    outputs.write("depth.svg", depthSvg);
    outputs.write("speed.svg", speedSvg);
    outputs.write("force.svg", forceSvg);
    if (!cut) return;
    outputs.write("rotor.svg", plot("Speed of the rotor", "speed [1000 rpm]", {rotor_.series("")}, {}));
    outputs.write("feed.svg", plot("How fast the bur eats into the tooth", "feed [mm/s]", {feed_.series("")}, {}));
    std::vector<report::Series> volumes;
    for (std::size_t i = 0; i < removed_.size(); ++i)
        volumes.push_back(removed_[i].series(std::string(cases::properties(kPlotted[i]).name)));
    outputs.write("removed.svg", plot("Removed volume by tissue", "removed [mm3]", std::move(volumes), {}));
}

}  // namespace handpiece::studies
