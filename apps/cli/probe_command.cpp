// SPDX-License-Identifier: Apache-2.0
// handpiece probe: depth, normal, area and tissue at given poses.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/attempt.h"
#include "studies/csv.h"
#include "studies/probe.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

struct ProbeOptions {
    ContactInputs inputs;
    std::string poses, out = "-";
};

/// On a tooth as it was cut, in an attempt or at a session's end, or on one that never was.
std::unique_ptr<contact::Method> methodOf(const ProbeOptions& o, const MethodRegistry& methods) {
    const ContactInputs& in = o.inputs;
    std::error_code error;
    const bool exists = std::filesystem::exists(in.tooth, error);
    const bool isSession = exists && std::filesystem::path(in.tooth).extension() == ".h5";
    if (!isSession && !(exists && cases::isAttempt(in.tooth)))
        return makeMethod(in.method, methods, loadTooth(in), loadBur(in.bur));
    if (in.method != "field")
        throw core::Error("a tooth that was cut is felt by the method 'field' alone", "--method " + in.method,
                          "leave --method out, or give the case");
    core::setThreadCount(in.threads);
    studies::ProgressBar preparing("preparing the tooth");
    const simulation::ToothOfFile found =
        simulation::toothOf(in.tooth, 1e-3 * in.voxelUm, !in.noCache, preparing.listener());
    preparing.finish();
    const auto cut = std::make_shared<tooth::ToothState>(found.base);
    (void)cut->restore(found.state, 0, found.state.bricks.size());
    return contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(cut), loadBur(in.bur));
}

void probe(const ProbeOptions& o, const MethodRegistry& methods) {
    const studies::CsvTable table = studies::readCsv(o.poses, {"x", "y", "z", "qw", "qx", "qy", "qz"});
    std::vector<core::Pose> poses;
    for (std::size_t i = 0; i < table.rows.size(); ++i)
        poses.push_back(studies::poseFrom(table.rows[i], 0, table, i));
    studies::TextWriter out(o.out);  // first: a place that cannot be written is told before the work
    const auto method = methodOf(o, methods);
    out.write("depth_mm,nx,ny,nz,area_mm2,tissue,time_ns\n");
    contact::PatchSet patches;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (studies::cancelled()) throw core::Error("cancelled");
        const core::Pose& pose = poses[i];
        if (i % studies::kProbeStretch == 0) method->reset();
        const auto start = std::chrono::steady_clock::now();
        const contact::Depth depth = method->depth(pose);
        method->patches(pose, patches);
        const auto ns =
            std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start).count();
        const core::Vec3& n = depth.normal;
        out.write(fmt::format("{:.9f},{:.9f},{:.9f},{:.9f},{:.6f},{},{}\n", depth.depthMm, n.x(), n.y(), n.z(),
                              patches.areaMm2, cases::properties(depth.tissue).name, ns));
    }
    out.commit();
}

}  // namespace

void addProbeCommand(Command& app, const MethodRegistry& methods) {
    Command command = app.subcommand("probe", "Signed distance or depth, normal, area and tissue at given poses");
    const auto options = std::make_shared<ProbeOptions>();
    addContactOptions(command, options->inputs, methods);
    command.option("--poses", options->poses, "CSV of x,y,z,qw,qx,qy,qz [mm], the bur's tip; - for standard input")
        .required()
        .typeName("FILE");
    command.option("--out", options->out, "CSV to write; - for standard output").showDefault().typeName("FILE");
    command.footer(
        "--tooth also takes an attempt or a session (.h5): the tooth as it was cut.\n"
        "Depth is positive inside, minus the distance outside; beyond 5 mm it is a bound and the normal is 0.\n"
        "Example:\n  handpiece probe --tooth molar --bur round-4 --poses poses.csv --method field --out out.csv");
    command.callback([options, &methods] { probe(*options, methods); });
}

}  // namespace handpiece::cli
