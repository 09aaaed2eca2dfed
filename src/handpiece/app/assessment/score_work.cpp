// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/score_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "handpiece/app/assessment/measure_store.h"
#include "handpiece/app/scan_work/scan_work.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/assess/measures/preparation.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/record/session/session_reader.h"

namespace handpiece::assessment {
namespace {

namespace fs = std::filesystem;

void requireSame(const fs::path& path, std::uint64_t caseKey, double voxelMm, const tasks::Task& task) {
    if (caseKey != cases::caseKey(task.toothCase))
        throw core::Error("this is work on another tooth than the exercise's", path.string(),
                          fmt::format("exercise {} is of {}", task.id, task.toothCase.name))
            .as("other-tooth");
    if (std::abs(voxelMm - task.voxelMm) > 1e-9)
        throw core::Error(
            fmt::format("this was cut in a voxel of {:g} um", 1e3 * voxelMm), path.string(),
            fmt::format("exercise {} asks for {:g}: work on it as the exercise has it", task.id, 1e3 * task.voxelMm))
            .as("other-voxel", {fmt::format("{:g}", 1e3 * voxelMm), fmt::format("{:g}", 1e3 * task.voxelMm)});
}

std::string hashOf(std::span<const std::byte> bytes) {
    core::Hasher hasher;
    hasher.add(bytes);
    return rubric::hashText(hasher.value());
}

Recording recordingAt(const fs::path& path) {
    return {path, path.string(), hashOf(core::readFile(path)), {}};
}

/// Those that came along with attempts are put where they can be read.
class Unpacked {
  public:
    /// `there`: where somebody put them already; empty: nobody did.
    explicit Unpacked(fs::path there = {}) : there_(std::move(there)) {}
    Recording at(const ChainLink& link) {
        if (!link.isPacked) return recordingAt(link.in);
        const std::string name = fmt::format("{} of {}", link.name, link.in.string());
        if (const fs::path place = there_ / link.name; !there_.empty())
            return {place, name, hashOf(core::readFile(place)), {}};
        if (!folder_) folder_ = std::make_shared<const core::PrivateFolder>();
        const std::vector<std::byte> bytes = cases::readRecording(link.in, link.name);
        const fs::path place = folder_->path() / link.name;
        core::writeFile(place, bytes, {true, false});
        return {place, name, hashOf(bytes), folder_};
    }

  private:
    fs::path there_;
    std::shared_ptr<const core::PrivateFolder> folder_;
};

/// A session by itself: from which tooth to which.
struct Done {
    Recording recording;
    std::uint64_t startHash = 0, endHash = 0;
    tooth::Teeth teeth;
    tooth::StateDelta state;
    std::string device, proof;
    bool isProven = false;
};

constexpr const char* kProof = "cut again from its beginning, and the same tooth, bit for bit";

Done doAgain(const Recording& recording, const tasks::Task& task, bool prove, const core::Progress& progress) {
    Done done;
    done.recording = recording;
    const fs::path& path = recording.path;
    simulation::SessionPlayer player(path, {true, false, {}}, core::part(progress, 0.0, 0.2));
    requireSame(recording.name, cases::caseKey(player.toothCase()), player.station().settings.field.voxelMm, task);
    done.device = player.station().settings.capability.name;
    done.startHash = player.startHash();
    if (prove) {
        const simulation::Verdict verdict = player.compareAll(core::part(progress, 0.2, 1.0));
        done.isProven =
            verdict.matches && !verdict.isOtherEngine() && verdict.differingTicks == 0 && verdict.brokenSeams == 0;
        done.proof = done.isProven ? kProof
                     : verdict.isOtherEngine()
                         ? fmt::format("recorded by engine {}, and this is {}: put right at each key frame",
                                       verdict.engineRevision, core::kEngineRevision)
                     : verdict.recorded.empty() ? "it was cut off before it told a state"
                     : verdict.brokenSeams != 0
                         ? "where it goes on after a pause the tooth is not the one that was left"
                         : "cut again it leaves another tooth than it says";
    } else {
        done.proof = "not cut again";
        player.seek(player.durationS(), core::part(progress, 0.2, 1.0));
    }
    const auto take = [&done](const simulation::SessionPlayer& from) {
        done.teeth = from.station().teeth();
        done.state = from.state();
        done.endHash = tooth::stateHash(done.state);
    };
    if (prove && !done.isProven) {
        // What the record itself says it came to, not what cutting it again did.
        simulation::SessionPlayer last(path, {true, false, {}});
        last.seek(last.durationS());
        take(last);
    } else {
        take(player);
    }
    return done;
}

std::vector<Done> doAllAgain(std::span<const Recording> recordings, const tasks::Task& task, bool prove,
                             const core::Progress& progress) {
    std::vector<Done> all;
    const auto share = [&](std::size_t i) { return static_cast<double>(i) / static_cast<double>(recordings.size()); };
    for (std::size_t i = 0; i < recordings.size(); ++i)
        all.push_back(doAgain(recordings[i], task, prove, core::part(progress, share(i), share(i + 1))));
    return all;
}

/// A chain, in its order.
Work workOf(std::vector<Done> chain) {
    Work work;
    work.context.device = chain.back().device;
    work.isProven = true;
    for (Done& one : chain) {
        work.sessionHashes.push_back(one.recording.hash);
        work.recordings.push_back(one.recording);
        if (one.device != work.context.device)
            work.noHand = fmt::format("its sessions were done with different devices: {} and {}", one.device,
                                      work.context.device);
        if (!one.isProven && work.isProven)
            work.proof =
                chain.size() > 1 ? fmt::format("{}: {}", one.recording.path.filename().string(), one.proof) : one.proof;
        work.isProven = work.isProven && one.isProven;
    }
    if (work.isProven)
        work.proof = chain.size() > 1 ? fmt::format(
                                            "{} sessions, each going on from the tooth that the one before it "
                                            "left, each {}",
                                            chain.size(), kProof)
                                      : kProof;
    work.teeth = std::move(chain.back().teeth);
    work.state = std::move(chain.back().state);
    return work;
}

Work workOfSession(const fs::path& path, const tasks::Task& task, bool prove, const core::Progress& progress) {
    const Recording recording = recordingAt(path);
    std::vector<Done> done = doAllAgain(std::span(&recording, 1), task, prove, progress);
    const bool isWhole = done.front().startHash == tooth::stateHash({});
    Work work = workOf(std::move(done));
    if (!isWhole) {
        work.isProven = false;
        work.proof = "it goes on from a tooth that was cut before: give the folder with all sessions of this work";
        work.noHand = work.proof;
        work.recordings.clear();
    }
    return work;
}

/// The last tick of a session at which the tooth was as a later one found it: it was saved there, and what followed was
/// given up. None: it never was so. Found among the key frames (there is one after each stroke), and cut again to
/// there.
std::optional<std::uint64_t> leftOnTheWay(const Done& session, std::uint64_t startHash, bool prove) {
    simulation::SessionPlayer player(session.recording.path, {true, false, {}});
    const session::SessionReader& reader = player.reader();
    for (std::size_t i = reader.keyFrameTicks().size(); i-- > 0;) {
        const session::KeyFrame frame = reader.keyFrame(i);
        const tooth::StateDelta then =
            tooth::decodeState(frame.state, player.station().teeth(), session.recording.name);
        if (tooth::stateHash(then) != startHash) continue;
        if (prove) {
            player.advance((static_cast<double>(frame.tick) + 0.5) / reader.info().rateHz);
            if (tooth::stateHash(player.state()) != startHash) return {};
        }
        return frame.tick;
    }
    return {};
}

constexpr const char* kNotFromThere = "its session {} goes on from another tooth than was left before it";

/// In the order that is told, each held against the one before it. `broken`: what is wrong with it already.
Work workInOrder(std::vector<Done> chain, std::string broken, bool prove, const char* notFromThere = kNotFromThere) {
    std::uint64_t left = tooth::stateHash({});
    std::string givenUp;
    for (std::size_t i = 0; i < chain.size(); ++i) {
        if (chain[i].startHash != left && broken.empty()) {
            std::optional<std::uint64_t> until;
            if (i > 0) until = leftOnTheWay(chain[i - 1], chain[i].startHash, prove);
            if (until) {
                Recording& before = chain[i - 1].recording;
                before.untilTick = until;
                givenUp += fmt::format("; what followed in {} after it was saved was given up, and does not count",
                                       before.path.filename().string());
            } else {
                broken = fmt::format(fmt::runtime(notFromThere), chain[i].recording.path.filename().string());
            }
        }
        left = chain[i].endHash;
    }
    Work work = workOf(std::move(chain));
    if (broken.empty()) {
        work.proof += givenUp;
        return work;
    }
    work.isProven = false;
    work.proof = work.noHand = std::move(broken);
    work.recordings.clear();
    return work;
}

/// The order is told by the teeth alone: names may have been changed.
Work workOfFolder(const fs::path& folder, const tasks::Task& task, bool prove, const core::Progress& progress) {
    std::vector<Recording> recordings;
    for (const fs::path& path : sessionsIn(folder))
        recordings.push_back(recordingAt(path));
    std::vector<Done> waiting = doAllAgain(recordings, task, prove, progress), chain;
    const std::uint64_t whole = tooth::stateHash({});
    std::uint64_t left = whole;
    const auto nameOf = [](const Done& done) { return done.recording.path.filename().string(); };
    while (!waiting.empty()) {
        auto next = std::find_if(waiting.begin(), waiting.end(), [&](const Done& d) { return d.startHash == left; });
        if (next == waiting.end()) {
            const auto other =
                std::find_if(waiting.begin(), waiting.end(), [&](const Done& d) { return d.startHash == whole; });
            if (other != waiting.end())
                throw core::Error(fmt::format("{} and {} both begin with the whole tooth: these are several works",
                                              nameOf(chain.front()), nameOf(*other)),
                                  folder.string(), "put the sessions of one work into a folder, and no others");
            // One is missing, or was given up in part. On with the first of those that none of the others leads to.
            next = std::find_if(waiting.begin(), waiting.end(), [&](const Done& d) {
                return std::none_of(waiting.begin(), waiting.end(),
                                    [&](const Done& o) { return &o != &d && o.endHash == d.startHash; });
            });
            if (next == waiting.end()) next = waiting.begin();
        }
        left = next->endHash;
        chain.push_back(std::move(*next));
        waiting.erase(next);
    }
    return workInOrder(std::move(chain), {}, prove,
                       "{} goes on from a tooth that no other session here leaves: one is missing before it");
}

Work workOfAttempt(const fs::path& path, const tasks::Task& task, bool prove, const fs::path& unpackedIn,
                   const core::Progress& progress) {
    const cases::OpenAttempt open = cases::openAttempt(path);
    requireSame(path, cases::caseKey(open.toothCase), open.attempt.voxelMm, task);
    std::optional<simulation::CutTeeth> cut = simulation::readCutTeeth(path, {}, true, core::part(progress, 0.0, 0.1));
    Work work;
    const std::vector<cases::Attempt::Recording>& named = open.attempt.recordings;
    const auto missing = std::find_if(named.begin(), named.end(), [](const auto& r) { return !r.packed; });
    if (named.empty()) {
        work.proof = "an attempt says what the tooth is like, not how it came to be so";
        work.noHand = "an attempt alone keeps no samples of the hand";
    } else if (missing != named.end()) {
        work.proof = fmt::format("its session {} did not come along", missing->name);
        work.noHand = work.proof;
    } else {
        Unpacked unpacked(unpackedIn);
        std::vector<Recording> recordings;
        for (const cases::Attempt::Recording& one : named)
            recordings.push_back(unpacked.at({one.name, path, true}));
        std::vector<Done> chain = doAllAgain(recordings, task, prove, core::part(progress, 0.1, 1.0));
        const bool isThis = chain.back().endHash == tooth::stateHash(cut->state);
        // What breaks the chain itself says more than that its end is another tooth.
        work = workInOrder(std::move(chain), {}, prove);
        if (!isThis && work.noHand.empty()) {
            work.isProven = false;
            work.proof = work.noHand = "it is another tooth than its sessions leave";
            work.recordings.clear();
        }
    }
    work.teeth = std::move(cut->teeth);
    work.state = std::move(cut->state);
    return work;
}

void requireThere(const fs::path& work) {
    if (!core::isThere(work))
        throw core::Error("there is no such work", work.string(), "name a session (.h5) or an attempt");
}

}  // namespace

std::vector<fs::path> sessionsIn(const fs::path& folder) {
    std::vector<fs::path> sessions;
    std::error_code ec;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ec))
        if (entry.path().extension() == ".h5" && !fs::is_directory(entry.path(), ec)) sessions.push_back(entry.path());
    std::sort(sessions.begin(), sessions.end());
    return sessions;
}

std::string workHash(const fs::path& work) {
    requireThere(work);
    std::vector<fs::path> files;
    std::error_code ec;
    if (!fs::is_directory(work, ec)) {
        files = {work};
    } else if (fs::exists(work / cases::kAttemptFile, ec)) {
        for (fs::recursive_directory_iterator entry(work, ec), end; !ec && entry != end; entry.increment(ec))
            if (entry->is_regular_file(ec)) files.push_back(entry->path());
    } else {
        files = sessionsIn(work);
    }
    std::sort(files.begin(), files.end());
    core::Hasher hasher;
    for (const fs::path& file : files) {
        // Of a chain their order counts, of a single file its name does not.
        if (files.size() > 1) hasher.add(file.lexically_relative(work).generic_string());
        hasher.add(std::span<const std::byte>(core::readFile(file)));
    }
    return rubric::hashText(hasher.value());
}

Work readWork(const fs::path& path, const tasks::Task& task, bool prove, const core::Progress& progress,
              const fs::path& unpacked) {
    requireThere(path);
    std::error_code ec;
    const bool isFolder = fs::is_directory(path, ec);
    if (path.extension() == ".h5" && !isFolder) return workOfSession(path, task, prove, progress);
    if (cases::isAttempt(path)) return workOfAttempt(path, task, prove, unpacked, progress);
    if (isFolder && !sessionsIn(path).empty()) return workOfFolder(path, task, prove, progress);
    throw core::Error("this is neither a session nor an attempt", path.string(),
                      "name session.h5, a folder of sessions, an attempt's folder or a .handpiece file");
}

ProvenWork provenWork(const fs::path& session, const tasks::Task& task, const core::Progress& progress) {
    std::error_code ec;
    if (session.extension() != ".h5" || fs::is_directory(session, ec))
        throw core::Error("this is no session", session.string(),
                          "name a session.h5: one recording, from its beginning")
            .as("work-no-session");
    Work work = readWork(session, task, true, progress);
    if (!work.isProven)
        throw core::Error("this work is not proven: " + work.proof, session.string(),
                          "record one from the whole tooth to its end, with this program")
            .as("work-not-proven");
    return {std::make_shared<const std::vector<std::byte>>(core::readFile(session, tasks::kMaxTeacherWorkBytes)),
            std::move(work)};
}

Work readProvenOnce(const fs::path& path, const tasks::Task& task, const StoreKey& key, const MeasureStore& store,
                    const core::Progress& progress) {
    const std::optional<MeasuredWork> kept = store.find(key);
    if (!kept || !kept->identity.proven) return readWork(path, task, true, progress);
    Work work = readWork(path, task, false, core::part(progress, 0.0, 0.3));
    if (rubric::hashText(tooth::stateHash(work.state)) != kept->identity.stateHash ||
        work.sessionHashes != kept->identity.sessionHashes)
        return readWork(path, task, true, core::part(progress, 0.3, 1.0));
    work.isProven = true;
    work.proof = kept->proof;
    return work;
}

Work readChain(std::span<const ChainLink> chain, const tasks::Task& task, bool prove, const core::Progress& progress) {
    if (chain.empty()) throw core::Error("there is no session of this work", task.id, "record what you do");
    Unpacked unpacked;
    std::vector<Recording> recordings;
    std::string missing;
    for (const ChainLink& link : chain) {
        const bool isLast = &link == &chain.back();
        if (isLast || core::isThere(link.in))
            recordings.push_back(unpacked.at(link));
        else if (missing.empty())
            missing = fmt::format("its session {} is no longer there", link.name);
    }
    return workInOrder(doAllAgain(recordings, task, prove, progress), std::move(missing), prove);
}

std::vector<measures::Request> requestsOf(const rubric::Rubric& rubric) {
    std::vector<measures::Request> requests;
    const auto ask = [&](const auto& asks) {
        const auto isThis = [&](const measures::Request& r) { return r.kind == asks.measure && r.of == asks.of; };
        if (std::none_of(requests.begin(), requests.end(), isThis)) requests.push_back({asks.measure, asks.of});
    };
    for (const rubric::Criterion& criterion : rubric.criteria)
        ask(criterion);
    if (rubric.completeness) ask(*rubric.completeness);
    return requests;
}

MeasuredWork measureWork(const Work& work, const tasks::Task& task, std::span<const measures::Request> requests,
                         const core::Progress& progress) {
    const cases::Case& toothCase = task.toothCase;
    std::vector<std::unique_ptr<tooth::ToothMirror>> mirrors;
    for (std::size_t number = 0; number < work.teeth.size(); ++number) {
        if (work.teeth[number])
            mirrors.push_back(
                std::make_unique<tooth::ToothMirror>(work.teeth[number], static_cast<std::uint16_t>(number)));
        else
            mirrors.push_back(nullptr);
        if (mirrors.back()) mirrors.back()->apply(work.state);
    }
    measures::Preparation preparation;
    preparation.whole = work.teeth.front();
    preparation.cut = mirrors.front().get();
    preparation.landmarks = toothCase.landmarks;
    if (work.scan) preparation.noiseMm = work.scan->noiseMm;
    preparation.axes = measures::axesOf(toothCase.landmarks, toothCase.buccalSign);
    std::vector<measures::Preparation::Other> others;
    for (std::size_t number = 1; number < work.teeth.size() && number <= toothCase.others.size(); ++number)
        if (mirrors[number]) {
            const cases::PlacedTooth& other = toothCase.others[number - 1];
            others.push_back({work.teeth[number], mirrors[number].get(), other.inCase, other.fdiNumber});
        }
    preparation.others = others;
    // Of both jaws: which of them surrounds the tooth, the measure finds.
    geometry::TriangleMesh gums;
    for (const cases::Part& part : toothCase.scenery) {
        if (part.tissue != cases::Tissue::gum) continue;
        const auto first = static_cast<std::uint32_t>(gums.vertices.size());
        gums.vertices.insert(gums.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
        for (const geometry::Triangle& t : part.mesh.triangles)
            gums.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    std::optional<geometry::TriangleTree> gingiva;
    if (!gums.triangles.empty()) preparation.gingiva = &gingiva.emplace(gums);
    std::optional<preparation::Laid> laid;
    if (task.preparation) {
        laid = preparation::layOn(toothCase, *task.preparation);
        preparation.axes.draw = laid->draw;
        if (task.preparation->kind() == "crown") preparation.form = measures::Form::crown;
        // What is capped faces away from what is hollowed.
        if (task.preparation->kind() == "onlay") preparation.form = measures::Form::cavity, preparation.isCapped = true;
        preparation.zones = laid->zones.get();
    }

    std::vector<measures::Request> ofTooth, ofHand;
    for (const measures::Request& request : requests)
        (measures::requireKind(request).subject == measures::Subject::tooth ? ofTooth : ofHand).push_back(request);
    MeasuredWork result;
    result.measured = measures::measure(preparation, ofTooth);
    if (work.scan) {
        const std::array<measures::Request, 1> overPulp{{{"remaining-dentine", {}}}};
        const std::optional<double> overPulpMm = measures::measure(preparation, overPulp).front().value;
        for (measures::Measured& one : result.measured)
            if (one.value) one.uncertainty = scan_work::widened(one, *work.scan, overPulpMm);
    }
    if (!work.noBeside.empty())
        for (measures::Measured& one : result.measured)
            if (one.kind == "adjacent-depth" || one.kind == "adjacent-removed")
                one = {one.kind, one.of, {}, 0.0, work.noBeside, {}};
    core::report(progress, 0.4);
    const hand::Against against{preparation.axes.longAxis, preparation.zones};
    std::vector<measures::Measured> hand = readRecord(
        work.recordings, result.measured, task.voxelMm,
        work.noHand.empty() ? std::span<const measures::Request>(ofHand) : std::span<const measures::Request>(),
        against, core::part(progress, 0.4, 1.0));
    if (!work.noHand.empty())
        for (const measures::Request& request : ofHand)
            hand.push_back({request.kind, request.of, {}, 0.0, work.noHand, {}});
    for (measures::Measured& one : hand)
        result.measured.push_back(std::move(one));
    result.draw = preparation.axes.draw;
    result.context = work.context;
    result.identity.exercise = task.id;
    result.identity.exerciseHash = rubric::hashText(tasks::contentHash(task));
    result.identity.caseKey = rubric::hashText(cases::caseKey(toothCase));
    result.identity.stateHash = rubric::hashText(tooth::stateHash(work.state));
    result.identity.sessionHashes = work.sessionHashes;
    result.identity.proven = work.isProven;
    result.identity.engineRevision = core::kEngineRevision;
    result.identity.scan = work.scan;
    result.proof = work.proof;
    return result;
}

Result judge(const MeasuredWork& work, const rubric::Rubric& rubric) {
    return {score::evaluate(rubric, work.measured, work.context), work.identity, work.proof};
}

Result scoreWork(const Work& work, const tasks::Task& task, const rubric::Rubric& rubric,
                 const core::Progress& progress) {
    return judge(measureWork(work, task, requestsOf(rubric), progress), rubric);
}

}  // namespace handpiece::assessment
