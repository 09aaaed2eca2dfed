// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/marking/desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <set>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"

namespace handpiece::marking {
namespace {

namespace fs = std::filesystem;

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers on every machine.
class Draws {
  public:
    explicit Draws(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next() {
        std::uint64_t z = state_ += 0x9E3779B97F4A7C15ull;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
        return z ^ (z >> 31);
    }
    /// 0 to bound - 1, each as likely.
    std::size_t below(std::size_t bound) {
        const std::uint64_t limit = UINT64_MAX - UINT64_MAX % bound;
        std::uint64_t drawn = next();
        while (drawn >= limit)
            drawn = next();
        return static_cast<std::size_t>(drawn % bound);
    }
    template <class T>
    void shuffle(std::vector<T>& list) {
        for (std::size_t i = list.size(); i > 1; --i)
            std::swap(list[i - 1], list[below(i)]);
    }

  private:
    std::uint64_t state_;
};

std::uint64_t seedOf(std::uint64_t seed, std::string_view what, std::size_t batch) {
    core::Hasher hasher;
    hasher.add(seed);
    hasher.add(what);
    hasher.add(static_cast<std::uint64_t>(batch));
    return hasher.value();
}

/// Letters and digits that nobody takes for another.
std::string newCode(Draws& draws, std::set<std::string>& taken) {
    static constexpr std::string_view kSigns = "abcdefghkmnpqrstuvwxyz23456789";
    for (;;) {
        std::string code;
        for (int i = 0; i < 4; ++i)
            code += kSigns[draws.below(kSigns.size())];
        if (taken.insert(code).second) return code;
    }
}

/// Of a batch: ids that come a second time.
std::vector<std::string> repeatsOf(const DeskState& state, std::size_t batch) {
    std::vector<std::string> ids = state.batches[batch];
    Draws draws(seedOf(state.seed, "repeats", batch));
    draws.shuffle(ids);
    const std::size_t tenth = (ids.size() + 5) / 10;
    ids.resize(std::min(ids.size(), batch == 0 ? std::max<std::size_t>(1, tenth) : tenth));
    return ids;
}

bool isBlank(const std::string& text) {
    return text.find_first_not_of(" \t\r\n") == std::string::npos;
}

}  // namespace

std::vector<DeskItem> itemsOf(const DeskState& state) {
    std::vector<DeskItem> items;
    std::set<std::string> codes, seen;
    Draws codeDraws(seedOf(state.seed, "codes", 0));
    for (std::size_t batch = 0; batch < state.batches.size(); ++batch) {
        std::vector<std::string> ids = state.batches[batch];
        if (state.isBlind) {
            const std::vector<std::string> again = repeatsOf(state, batch);
            ids.insert(ids.end(), again.begin(), again.end());
            Draws(seedOf(state.seed, "order", batch)).shuffle(ids);
        }
        for (const std::string& id : ids)
            items.push_back({newCode(codeDraws, codes), id, !seen.insert(id).second});
    }
    return items;
}

std::vector<std::string> heldBack(const DeskState& state) {
    if (!state.isBlind) return {};
    std::vector<std::string> held;
    for (std::size_t batch = 0; batch < state.batches.size(); ++batch) {
        const std::vector<std::string> twice = repeatsOf(state, batch);
        std::vector<std::string> once;
        for (const std::string& id : state.batches[batch])
            if (std::find(twice.begin(), twice.end(), id) == twice.end()) once.push_back(id);
        Draws(seedOf(state.seed, "held", batch)).shuffle(once);
        once.resize(std::min(once.size(), twice.size()));
        held.insert(held.end(), twice.begin(), twice.end());
        held.insert(held.end(), once.begin(), once.end());
    }
    return held;
}

Desk::Desk(DeskSetup setup, std::vector<ReturnedWork> works) : setup_(std::move(setup)), works_(std::move(works)) {
    rubric::requireSound(setup_.rubric);
    if (setup_.rubric.criterion(kTotal) != nullptr)
        throw core::Error(fmt::format("a criterion is called \"{}\", as all points together are here", kTotal),
                          setup_.rubric.where, "give it another id");
    file_ = deskFile(setup_.folder, setup_.marker);
    const std::string rubricHash = rubric::hashText(rubric::hashOf(setup_.rubric));
    if (core::isThere(file_)) {
        const std::vector<std::byte> bytes = core::readFile(file_, 64u << 20);
        const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        state_ = parseDesk(text, file_.string());
        core::Hasher hasher;
        hasher.add(text);
        written_ = hasher.value();
        if (state_.marker != setup_.marker)
            throw core::Error(fmt::format("this is the desk of \"{}\"", state_.marker), file_.string(),
                              "mark under another name")
                .as("desk-of-another", {state_.marker});
        if (state_.exerciseHash != setup_.exerciseHash)
            throw core::Error(fmt::format("this desk was begun for another exercise, {}", state_.exercise),
                              file_.string(), "choose that one, or mark under another name")
                .as("desk-other-exercise", {state_.exercise});
        if (state_.rubricHash != rubricHash && state_.isBlind)
            throw core::Error(fmt::format("this desk marks blind by another rubric, {}", state_.rubric), file_.string(),
                              "choose that one, or mark under another name")
                .as("desk-other-rubric", {state_.rubric});
        if (state_.isBlind != setup_.isBlind)
            throw core::Error(state_.isBlind ? "this desk marks blind" : "this desk shows the machine's score",
                              file_.string(), "go on with it so, or mark under another name")
                .as(state_.isBlind ? "desk-blind" : "desk-seen");
    } else {
        state_.marker = setup_.marker;
        state_.isBlind = setup_.isBlind;
        std::random_device chance;
        state_.seed = setup_.seed.value_or((std::uint64_t{chance()} << 32) | chance());
        state_.exercise = setup_.exercise;
        state_.exerciseHash = setup_.exerciseHash;
        state_.rubric = setup_.rubric.id;
        state_.rubricHash = rubricHash;
    }
    for (std::size_t i = 0; i < works_.size(); ++i)
        places_.emplace(works_[i].id, i);
    std::vector<std::string> come;
    for (const ReturnedWork& work : works_)
        if (!state_.names.contains(work.id)) come.push_back(work.id);
    // What is on the desk and no longer in the folder keeps its row and its marks.
    for (const auto& [id, name] : state_.names)
        if (!places_.contains(id)) {
            places_.emplace(id, works_.size());
            const fs::path path = setup_.folder / name;
            works_.push_back({name, id, path, false,
                              core::Error("it is no longer in the folder, or was changed", path.string(),
                                          "put it back, or score again")
                                  .as("work-gone")});
        }
    scored_.resize(works_.size());
    if (!come.empty() || written_ == 0 || state_.rubricHash != rubricHash)
        change([&](DeskState& state) {
            if (!come.empty()) state.batches.push_back(come);
            for (const std::string& id : come)
                state.names[id] = works_[places_.at(id)].name;
            state.rubric = setup_.rubric.id;
            state.rubricHash = rubricHash;
        });
    arrange();
}

void Desk::arrange() {
    codes_.clear();
    items_.clear();
    for (const DeskItem& item : itemsOf(state_)) {
        codes_.push_back(item.code);
        items_.emplace(item.code, item);
    }
    held_ = heldBack(state_);
}

/// Into the file first: where that cannot be, nothing has changed.
template <class Change>
void Desk::change(Change&& what) {
    DeskState next = state_;
    what(next);
    const std::string text = deskJson(next);
    if (core::isThere(file_)) {
        const std::vector<std::byte> bytes = core::readFile(file_, 64u << 20);
        core::Hasher hasher;
        hasher.add(std::span<const std::byte>(bytes));
        if (hasher.value() != written_)
            throw core::Error("somebody else marks at this desk", file_.string(),
                              "open it again: what stands there now is kept, this change is not")
                .as("desk-elsewhere");
    }
    core::writeFile(file_, text);
    core::Hasher hasher;
    hasher.add(std::string_view(text));
    written_ = hasher.value();
    state_ = std::move(next);
}

std::size_t Desk::placeOf(const std::string& code) const {
    const auto item = items_.find(code);
    if (item == items_.end()) throw core::Error(fmt::format("there is no work {}", code), file_.string());
    return places_.at(item->second.workId);
}

const ReturnedWork& Desk::work(const std::string& code) const {
    return works_[placeOf(code)];
}

const Sheet& Desk::sheet(const std::string& code) const {
    static const Sheet kNone;
    const auto at = state_.sheets.find(code);
    return at == state_.sheets.end() ? kNone : at->second;
}

void Desk::take(std::size_t which, Scored scored) {
    scored_.at(which) = std::move(scored);
}

bool Desk::isScored(const std::string& code) const {
    const std::optional<Scored>& scored = scored_[placeOf(code)];
    return scored && scored->result_.has_value();
}

std::string Desk::problem(const std::string& code) const {
    const std::size_t at = placeOf(code);
    // Whose the other is stays hidden from who marks blind.
    if (const std::string& twin = works_[at].twin; !twin.empty() && isRevealed(code))
        return works_[at].error->problem() + ": " + twin;
    if (const std::optional<core::Error> known = error(code)) return known->problem();
    std::string why;
    static_cast<void>(judge(code, why));
    return why;
}

std::optional<core::Error> Desk::error(const std::string& code) const {
    const std::size_t at = placeOf(code);
    const std::optional<core::Error> known =
        scored_[at] && scored_[at]->error() ? scored_[at]->error() : works_[at].error;
    if (known && !isRevealed(code))
        return core::Error("it cannot be scored; why is told once its marks are in", code, "it may go in without marks")
            .as("hidden-problem");
    return known;
}

const view::Image& Desk::picture(const std::string& code) const {
    static const view::Image kNone;
    const std::optional<Scored>& scored = scored_[placeOf(code)];
    return scored ? scored->picture() : kNone;
}

std::size_t Desk::countIn() const {
    return static_cast<std::size_t>(
        std::count_if(codes_.begin(), codes_.end(), [this](const std::string& code) { return sheet(code).isIn; }));
}

bool Desk::areAllIn() const {
    return countIn() == codes_.size();
}

bool Desk::isRevealed(const std::string& code) const {
    if (!state_.isBlind) return true;
    if (!sheet(code).isIn) return false;
    const std::string& id = items_.at(code).workId;
    return std::find(held_.begin(), held_.end(), id) == held_.end() || areAllIn();
}

bool Desk::isRepeat(const std::string& code) const {
    return areAllIn() && items_.at(code).isRepeat;
}

const assessment::Result* Desk::machine(const std::string& code) const {
    const std::optional<Scored>& scored = scored_[placeOf(code)];
    return isRevealed(code) && scored && scored->result_ ? &*scored->result_ : nullptr;
}

std::optional<score::Assessment> Desk::judge(const std::string& code, std::string& why) const {
    const assessment::Result* machine = this->machine(code);
    if (machine == nullptr) return {};
    Sheet fitting = sheet(code);
    // Of a rubric before: what it overrode is no longer there.
    std::erase_if(fitting.overrides, [this](const auto& one) { return setup_.rubric.criterion(one.first) == nullptr; });
    try {
        return withOverrides(setup_.rubric, machine->assessment, fitting);
    } catch (const core::Error& error) {
        // It fitted the rubric that it was made under.
        why = fmt::format("an override no longer fits the rubric: {}: {}", error.where(), error.problem());
        return {};
    }
}

std::optional<score::Assessment> Desk::finalScore(const std::string& code) const {
    std::string why;
    return judge(code, why);
}

std::optional<score::Passed> Desk::passed(const std::string& code) const {
    const std::optional<score::Assessment> final = finalScore(code);
    if (!final) return {};
    if (const auto& decision = sheet(code).decision) return decision->passed ? score::Passed::yes : score::Passed::no;
    return final->passed;
}

const rubric::Criterion& Desk::criterion(const std::string& id) const {
    const rubric::Criterion* found = setup_.rubric.criterion(id);
    if (found == nullptr)
        throw core::Error(fmt::format("the rubric has no criterion \"{}\"", id), file_.string(),
                          "choose one of its own");
    return *found;
}

std::vector<std::string> askedOf(const rubric::Rubric& rubric) {
    std::vector<std::string> ids;
    bool isGraded = false;
    for (const rubric::Criterion& c : rubric.criteria) {
        if (c.isGraded() || !c.bands.empty()) ids.push_back(c.id);
        isGraded = isGraded || c.isGraded();
    }
    if (isGraded) ids.emplace_back(kTotal);
    return ids;
}

std::vector<std::string> Desk::asked() const {
    return askedOf(setup_.rubric);
}

double mostOf(const rubric::Rubric& rubric, const std::string& id) {
    double most = 0.0;
    for (const rubric::Criterion& c : rubric.criteria)
        if (id == kTotal || c.id == id) most += c.weight;
    return most;
}

void requireMark(const rubric::Rubric& rubric, const std::string& id, const Mark& mark, const std::string& where) {
    const auto refuse = [&](const std::string& problem, const std::string& remedy) {
        throw core::Error(problem, where, remedy);
    };
    bool takesBand = false;
    if (id != kTotal) {
        const rubric::Criterion* c = rubric.criterion(id);
        if (c == nullptr) return refuse(fmt::format("the rubric has no criterion \"{}\"", id), "choose one of its own");
        takesBand = !c->bands.empty();
        if (!takesBand && !c->isGraded()) refuse("it is shown, not judged", "leave it");
        if (takesBand && !mark.cannotTell &&
            std::none_of(c->bands.begin(), c->bands.end(), [&](const rubric::Band& b) { return b.id == mark.band; }))
            refuse(fmt::format("it has no band \"{}\"", mark.band), "choose one of its own");
    }
    if (mark.cannotTell ? !mark.band.empty() || mark.points.has_value() : takesBand == mark.points.has_value())
        refuse("one mark is asked for", takesBand ? "choose a band" : "give points");
    if (!takesBand && !mark.band.empty()) refuse("it has no bands", "give points");
    if (const double most = mostOf(rubric, id); mark.points && !(*mark.points >= 0.0 && *mark.points <= most))
        refuse(fmt::format("{} points", *mark.points), fmt::format("give 0 to {:g}", most));
}

void Desk::setMark(const std::string& code, const std::string& id, const Mark& mark) {
    placeOf(code);
    const std::string where = fmt::format("{}, {}", code, id);
    if (!state_.isBlind) throw core::Error("this desk shows the machine's score", where, "override it, with a reason");
    if (sheet(code).isIn) throw core::Error("the mark is in", where, "override the machine's score, with a reason");
    if (id != kTotal) static_cast<void>(criterion(id));
    requireMark(setup_.rubric, id, mark, where);
    change([&](DeskState& state) { state.sheets[code].marks[id] = mark; });
}

std::vector<std::string> Desk::missing(const std::string& code) const {
    if (error(code)) return {};  // nobody can be held to mark what may not even open
    std::vector<std::string> ids = asked();
    std::erase_if(ids, [&](const std::string& id) { return sheet(code).marks.contains(id); });
    return ids;
}

void Desk::giveIn(const std::string& code) {
    placeOf(code);
    if (!state_.isBlind) throw core::Error("this desk does not mark blind", code);
    if (const std::vector<std::string> open = missing(code); !open.empty())
        throw core::Error(fmt::format("not marked yet: {}", fmt::join(open, ", ")), code,
                          "mark them, or say that they cannot be told");
    change([&](DeskState& state) { state.sheets[code].isIn = true; });
}

void Desk::override(const std::string& code, const std::string& id, const Override& said) {
    const rubric::Criterion& c = criterion(id);
    const auto refuse = [&](const std::string& problem, const std::string& remedy) {
        throw core::Error(problem, fmt::format("{}, {}", code, id), remedy);
    };
    const assessment::Result* machine = this->machine(code);
    if (machine == nullptr) {
        placeOf(code);
        if (!isRevealed(code)) refuse("the machine's score is hidden yet", "mark first");
        refuse("the machine has no score", "write a comment, or decide who passes");
    }
    if (isBlank(said.reason)) refuse("an override needs a reason", "write why, in a sentence");
    if (said.band.empty() && !said.points && !said.critical)
        refuse("nothing is said", "give points, a band, or whether it is a critical error");
    if (said.critical && !c.critical) refuse("it has no critical error", "give points or a band");
    Sheet sheet = this->sheet(code);
    sheet.overrides[id] = said;
    const score::Assessment judged = withOverrides(setup_.rubric, machine->assessment, sheet);
    for (const score::CriterionScore& s : judged.criteria)
        if (s.id == id && s.standing == score::Standing::voided)
            refuse("it does not count: " + s.reason, "override the one that failed");
    change([&](DeskState& state) { state.sheets[code].overrides[id] = said; });
}

void Desk::withdraw(const std::string& code, const std::string& id) {
    placeOf(code);
    change([&](DeskState& state) { state.sheets[code].overrides.erase(id); });
}

int Desk::comment(const std::string& code, Comment said) {
    placeOf(code);
    if (isBlank(said.text)) throw core::Error("the comment is empty", code, "write something");
    if (!said.criterion.empty()) criterion(said.criterion);
    said.number = state_.nextComment;
    change([&](DeskState& state) {
        state.sheets[code].comments.push_back(said);
        ++state.nextComment;
    });
    return said.number;
}

void Desk::removeComment(const std::string& code, int number) {
    placeOf(code);
    change([&](DeskState& state) {
        std::erase_if(state.sheets[code].comments, [number](const Comment& c) { return c.number == number; });
    });
}

void Desk::decide(const std::string& code, std::optional<Decision> decision) {
    placeOf(code);
    if (!isRevealed(code)) throw core::Error("the machine's score is hidden yet", code, "mark first");
    if (decision && isBlank(decision->reason))
        throw core::Error("a decision needs a reason", code, "write why, in a sentence");
    change([&](DeskState& state) { state.sheets[code].decision = decision; });
}

Desk::Others Desk::othersOfFolder() const {
    Others others;
    others.desks.push_back(state_);
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::directory_iterator at(setup_.folder, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string();
        if (name.starts_with("marking-") && name.ends_with(".json") && at->path() != file_) files.push_back(at->path());
    }
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
        try {
            const std::vector<std::byte> bytes = core::readFile(file, 64u << 20);
            DeskState desk = parseDesk({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
            if (desk.exerciseHash == state_.exerciseHash && desk.rubricHash == state_.rubricHash && desk.isBlind)
                others.desks.push_back(std::move(desk));
        } catch (const core::Error& problem) {
            others.problems.emplace_back(problem.what());
        }
    }
    return others;
}

}  // namespace handpiece::marking
