// SPDX-License-Identifier: Apache-2.0
// Every route as every person about an attempt in every state: docs/school-visibility.md has the table.
#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include "handpiece/model/case/package.h"
#include "handpiece/school/store/visible.h"
#include "school/server/exam_stage.h"
#include "school/server/small_picture.h"
#include "school/server/teaching_fixture.h"
#include "school/sheet.h"

namespace handpiece::school_server::visibility_test {
namespace {

using school::Role;
using school::Standing;
using school::Visible;

constexpr const char* kDocs = HANDPIECE_SOURCE_DIR "/docs/school-visibility.md";
constexpr const char *kBegin = "<!-- visibility -->\n", *kEnd = "<!-- /visibility -->\n";

/// An attempt with its student, its marker, and what is found of it nowhere else.
struct State {
    const char* name;
    Standing standing;
    std::string assignment;  ///< empty: practice
    bool isShared = false, isMarked = false, isErased = false;
    std::size_t number = 0;
    std::string attempt{};
    [[nodiscard]] std::string with(const char* what) const { return fmt::format("{}{}", what, number); }
    [[nodiscard]] std::string student() const { return with("v"); }
    [[nodiscard]] std::string marker() const { return with("mk"); }
    /// Far from what the work of others is worth, which is cut in real time and comes out a little different each time.
    [[nodiscard]] double score() const { return std::stod(fmt::format("{}.3", 81 + number)); }
    [[nodiscard]] double mark() const { return std::stod(fmt::format("{}.7", 41 + number)); }
};

/// The letters of the table.
using Seen = std::set<char>;

/// Somebody who asks.
struct Asker {
    const char* column;
    std::string code;  ///< empty: nobody, or a station
    std::optional<Role> role, inClass;
    bool marksBlind = false, isStation = false;
};

bool hasNumber(const std::string& text, double number) {
    const std::string digits = fmt::format("{:.1f}", number);
    const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
    for (std::size_t at = text.find(digits); at != text.npos; at = text.find(digits, at + 1)) {
        const std::size_t end = at + digits.size();
        if ((at == 0 || !isDigit(text[at - 1])) && (end == text.size() || !isDigit(text[end]))) return true;
    }
    return false;
}

class VisibilityTest : public TeachingTest {
  protected:
    void SetUp() override {
        TeachingTest::SetUp();
        Books open = books();
        states_ = {{"practice", {}, ""},
                   {"practice, shared", {}, "", true},
                   {"not marked", {}, "as-2"},
                   {"marked", {}, "as-3", false, true},
                   {"marks released", {false, false, true}, "as-4", false, true},
                   {"marks taken back", {}, "as-5", false, true},
                   {"exam, not decided", {true, false, true}, "ex1", false, true},
                   {"exam, decided", {true, true, true}, "ex1", false, true},
                   {"exam, appealed", {true, true, false}, "ex1", false, true},
                   {"marks released, person erased", {false, false, true}, "as-9", false, true, true}};
        for (std::size_t i = 0; i < states_.size(); ++i)
            states_[i].number = i;
        furnish(open);
        handIn(open);
        scoreAll(open);
        mark(open);
        for (const State& s : states_)
            if (s.isErased) open.erase(s.student(), act_);
    }
    void furnish(Books& open) {
        std::vector<school::Person> people{{"t3", "Dr. Third", "t3", "", "", {"teacher"}, 1, 0}};
        std::vector<school::Enrolment> enrolments{{"c1", "t3", "teacher"}};
        for (const State& s : states_) {
            people.push_back({s.student(), s.with("Nameof-"), s.student(), "", "", {"student"}, 1, 0});
            people.push_back({s.marker(), "Marker", s.marker(), "", "", {"examiner"}, 1, 0});
            enrolments.push_back({"c1", s.student(), "student"});
            enrolments.push_back({"c1", s.marker(), "examiner"});
        }
        open.add(people, act_);
        open.enrol(enrolments, act_);
    }
    void handIn(Books& open) {
        std::vector<std::pair<std::string, fs::path>> sat;
        for (State& s : states_) {
            if (s.standing.isExam) {
                sat.emplace_back(s.student(), session());
                continue;
            }
            if (!s.assignment.empty())
                open.add(school::Assignment{s.assignment, "c1", exercise_, marked_, "Work", "practice", "", 1,
                                            4'000'000'000'000},
                         act_);
            school::PushedAttempt p;
            school::Attempt& a = p.attempt;
            a.id = s.attempt = school::newId();
            a.exercise = "block", a.exerciseHash = exercise_, a.rubricHash = marked_;
            a.began = 1000, a.finished = 5000, a.device = "simulated";
            a.score = a.maxScore = a.wholeScore = 10, a.passed = "yes", a.result = "{}";
            p.station = station_, p.person = s.student(), p.assignment = s.assignment, p.received = 10;
            EXPECT_TRUE(open.push(p));
            if (s.isShared) open.share(s.attempt, true, {s.student(), 20});
        }
        const std::vector<std::string> sittings = holdExam(open, data(), sat);
        std::size_t next = 0;
        for (State& s : states_)
            if (s.standing.isExam) s.attempt = sittings.at(next++);
    }
    /// As if a worker had: each has a score of its own, and a reason.
    void scoreAll(Books& open) {
        while (const auto job = open.takeJob("w", 20, 1000)) {
            const auto s = std::find_if(states_.begin(), states_.end(),
                                        [&](const State& one) { return one.attempt == job->attempt; });
            ASSERT_NE(s, states_.end());
            school::Score score = real_;
            score.attempt = job->attempt, score.made = 21, score.passed = "no", score.reason = s->with("because-");
            score.score = s->score(), score.maxScore = score.wholeScore = 100.0;
            score::Result result = assessment::parseResult(real_.result, "a test");
            result.assessment.score = score.score, result.assessment.maxScore = 100.0;
            score.result = assessment::resultJson(result.assessment, result.identity);
            EXPECT_TRUE(open.finish(*job, score));
        }
        for (const State& s : states_)
            EXPECT_EQ(open.scoresOf(s.attempt).size(), 1u) << s.name;
    }
    void mark(Books& open) {
        school::Teaching teaching(open);
        for (const State& s : states_) {
            if (!s.assignment.empty()) (void)teaching.takeWorks(s.assignment, "t3", 9, {"t3", 30});
            if (s.isMarked) {
                const Act act{s.marker(), 31};
                (void)teaching.takeWorks(s.assignment, s.marker(), 7, act);
                open.note(act, "work seen blind", s.attempt, s.assignment);
                Sheet sheet;
                sheet.verdict = "no";
                school::Mark mark = markOf(sheet, rubric::parseRubric(kMarkedRubric, ""), marked_,
                                           *open.attempt(s.attempt), {}, school::newId(), s.marker(), "blind", 31);
                mark.points = s.mark(), mark.maxPoints = 100.0;
                mark.marks = std::regex_replace(mark.marks, std::regex("\"score\": [0-9.]+"),
                                                fmt::format("\"score\": {:.1f}", s.mark()));
                mark.marks =
                    std::regex_replace(mark.marks, std::regex("\"max_score\": [0-9.]+"), "\"max_score\": 100.0");
                EXPECT_TRUE(teaching.save({s.assignment, s.marker(), "abcd", s.attempt, "{}", true}, mark, act));
            }
            const std::vector<std::string> one{s.attempt};
            if (s.standing.isReleased || s.name == std::string("marks taken back")) teaching.release(one, true, act_);
            if (!s.standing.isReleased) teaching.release(one, false, act_);
            if (!s.standing.isExam) continue;
            school::ExamBooks(open).setDoubts(s.attempt, {s.with("doubted-")}, 32);
            if (!s.standing.isDecided) continue;
            decideExam(open, s.attempt, "confirm", "t1", "fail", s.with("decided-").c_str());
            if (s.name == std::string("exam, appealed"))
                decideExam(open, s.attempt, "appeal", s.student().c_str(), "", "It is within the range");
        }
        for (const State& s : states_) {
            const Standing found = school::standingOf(open, s.attempt);
            EXPECT_EQ(found.isExam, s.standing.isExam) << s.name;
            EXPECT_EQ(found.isDecided, s.standing.isDecided) << s.name;
            EXPECT_EQ(found.isReleased, s.standing.isReleased) << s.name;
        }
    }
    static std::vector<Asker> askersOf(const State& s) {
        return {{"its student", s.isErased ? "" : s.student(), Role::student, Role::student},
                {"another student", "w0", Role::student, Role::student},
                {"teacher", "t1", Role::teacher, Role::teacher},
                {"teacher still marking", "t3", Role::teacher, Role::teacher, !s.assignment.empty()},
                {"examiner", "e1", Role::examiner, Role::examiner},
                {"its marker", s.marker(), Role::examiner, Role::examiner},
                {"another class's teacher", "t2", Role::teacher, {}},
                {"administrator", "a1", Role::administrator, {}},
                {"exam station", "", {}, {}, false, true},
                {"nobody", "", {}, {}}};
    }

    /// What the rule lets them see of it at this address.
    static Seen allowed(const State& s, const Asker& asker, const std::string& path) {
        school::Eyes eyes;
        if (asker.role && !asker.code.empty()) eyes.roles = {*asker.role};
        eyes.relation = {asker.code == s.student(), s.assignment.empty() && !s.isShared, asker.inClass};
        eyes.marksBlind = asker.marksBlind;
        Visible v = school::visibleOf(eyes, s.standing);
        bool isMarker = asker.code == s.marker();
        const bool isAdministrator = asker.role == Role::administrator;
        if (isAdministrator && path.ends_with("/export")) {
            isMarker = path.find("/" + s.marker() + "/") != path.npos;
            if (path.find("/" + s.student() + "/") != path.npos) v = school::visibleToItsStudent(s.standing);
        }
        Seen all;
        const auto add = [&all](bool isSeen, char letter) {
            if (isSeen) all.insert(letter);
        };
        add(v.worth, 'S'), add(v.reason, 'R'), add(v.marks || isMarker, 'M');
        add(v.markers || (v.behindCode && (isMarker || isAdministrator)), 'K');
        add(v.whose || (asker.role == Role::teacher && asker.inClass == Role::teacher), 'N');
        add(v.doubts, 'D'), add(v.decisions, 'C'), add(v.worth && v.recording, 'V');
        return all;
    }
    /// Whether it says who marked it.
    static bool tellsMarker(const State& s, const Asker& asker, const std::string& path, const std::string& text) {
        const std::string marker = s.marker();
        if (text.find(marker) == text.npos) return false;
        // In the text of a mark, also as a cell of a table.
        if (std::regex_search(text, std::regex("marker\"{1,2}: \"{1,2}" + marker + "\""))) return true;
        // A line about it, whose doing is marking.
        static const std::regex marking("\\b(mark|blind|give in marks)\\b");
        std::istringstream lines(std::regex_replace(text, std::regex("<tr"), "\n<tr"));
        for (std::string line; std::getline(lines, line);)
            if (line.find(marker) != line.npos && line.find(s.attempt) != line.npos && std::regex_search(line, marking))
                return true;
        // A page of work, where none but a marker of it is named.
        const auto isAt = [&](const char* start) { return path.starts_with(start); };
        return asker.code != marker && (isAt("/attempts/") || isAt("/assignments/") || isAt("/sittings/"));
    }
    static Seen found(const State& s, const Asker& asker, const std::string& path, int status,
                      const std::string& text) {
        Seen all;
        // It is made meanwhile, or cannot be: that it is theirs is what is looked at.
        if (path.ends_with("/review")) {
            if (status == 200 || status == 500) all.insert('V');
            return all;
        }
        const auto add = [&all](bool isSeen, char letter) {
            if (isSeen) all.insert(letter);
        };
        const auto says = [&](const char* what) { return text.find(s.with(what)) != text.npos; };
        add(hasNumber(text, s.score()), 'S'), add(says("because-"), 'R'), add(hasNumber(text, s.mark()), 'M');
        add(tellsMarker(s, asker, path, text), 'K'), add(says("Nameof-"), 'N');
        add(says("doubted-"), 'D'), add(says("decided-"), 'C');
        return all;
    }

    struct Answer {
        int status = 0;
        std::string text;
    };
    /// Letters that are a picture's may be any, and so may numbers that are places in a drawing; its words stay.
    static std::string withoutPictures(std::string text) {
        for (std::size_t at = text.find("data:image/"); at != text.npos; at = text.find("data:image/", at))
            text.erase(at, text.find('"', at) - at);
        for (std::size_t at = text.find("<svg"); at != text.npos; at = text.find("<svg", at)) {
            std::string words;
            const std::size_t end = std::min(text.find("</svg>", at), text.size());
            for (std::size_t i = at, depth = 0; i < end; ++i) {
                if (text[i] == '<') ++depth;
                if (depth == 0) words += text[i];
                if (text[i] == '>' && depth > 0) --depth, words += ' ';
            }
            text.replace(at, std::min(end + 6, text.size()) - at, words);
        }
        return text;
    }
    /// Once each.
    const Answer& ask(const Asker& asker, const std::string& path) {
        const auto [place, isNew] = answers_.try_emplace({asker.isStation ? "station" : asker.code, path}, Answer{});
        if (!isNew) return place->second;
        httplib::Headers headers{{"Handpiece-Protocol", "1"}};
        if (asker.isStation) headers.emplace("Authorization", "Bearer " + std::string(64, 'f'));
        if (!asker.code.empty()) {
            std::string& token = tokens_[asker.code];
            if (token.empty()) {
                token = school::newSecret();
                books().addLogin(token, asker.code, systemClock()() + 10'000'000, act_);
            }
            headers.emplace("Cookie", "handpiece=" + token);
        }
        httplib::Client http(school_->address());
        http.set_read_timeout(120);
        if (path.starts_with("/live/") || path.find("/live") != path.npos) work(http);
        const auto result = http.Get(path, headers);
        EXPECT_TRUE(result) << path;
        if (!result) return place->second;
        EXPECT_TRUE(result->status < 500 || path.ends_with("/review")) << path << " " << asker.column << "\n"
                                                                       << result->body.substr(0, 300);
        place->second = {result->status, withoutPictures(result->body)};
        // What is packed is unpacked; recordings are bytes.
        if (result->body.starts_with("PK")) {
            std::string& text = place->second.text;
            text.clear();
            for (const auto& [name, bytes] : cases::readPackage(std::as_bytes(std::span(result->body)), "export.zip"))
                if (name.ends_with(".csv"))
                    text += std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        }
        return place->second;
    }
    /// Someone is at work while it is looked at.
    void work(httplib::Client& http) const {
        const State& s = states_.at(2);
        school_wire::Live live;
        live.person = s.student(), live.assignment = s.assignment, live.exerciseHash = exercise_;
        live.picture = picture();
        const auto result =
            http.Put("/api/v1/live", {{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + std::string(64, 'd')}},
                     school_wire::toBytes(live), "application/octet-stream");
        EXPECT_TRUE(result && result->status == 200);
    }

    /// Addresses of a route about this attempt; none: nobody has said what stands for one of its groups.
    std::vector<std::string> pathsOf(const std::string& pattern, const State& s, const Asker& asker) {
        std::vector<std::string> paths{""};
        std::size_t at = 0;
        while (at < pattern.size()) {
            const std::size_t open = std::min(pattern.find('(', at), pattern.size());
            const std::string before = plain(pattern.substr(at, open - at));
            for (std::string& path : paths)
                path += before;
            if (open == pattern.size()) break;
            const std::size_t close = pattern.find(')', open);
            const std::string inside = pattern.substr(open + 1, close - open - 1);
            const std::size_t slash = before.rfind('/', before.size() - 2);
            std::vector<std::string> values;
            if (inside.find('|') != inside.npos) {
                std::istringstream words(plain(inside));
                for (std::string word; std::getline(words, word, '|');)
                    values.push_back(word);
            } else if (slash != before.npos) {
                values = valuesOf(before.substr(slash + 1, before.size() - slash - 2), s, asker);
            }
            std::vector<std::string> more;
            for (const std::string& path : paths)
                for (const std::string& value : values)
                    more.push_back(path + value);
            paths = std::move(more);
            at = close + 1;
        }
        for (std::string& path : paths)
            if (path.ends_with("statements.json")) path += "?home=https%3A%2F%2Fschool.example";
        if (pattern == "/office/audit")
            for (const std::string& about : {s.attempt, s.marker(), s.student()})
                paths.push_back("/office/audit?about=" + about);
        if (pattern.ends_with("/standard")) paths.push_back(paths.front() + "?all=1");
        return paths;
    }
    std::vector<std::string> valuesOf(const std::string& what, const State& s, const Asker& asker) {
        if (what == "people" || what == "tasks") return {s.student(), s.marker()};
        if (what == "classes") return {"c1"};
        if (what == "attempts" || what == "sittings") return {s.attempt};
        if (what == "assignments") return {s.assignment.empty() ? "as1" : s.assignment};
        if (what == "marking") return codesFor(s, asker);
        if (what == "exemplars") return {"1"};
        if (what == "exams") return {"ex1"};
        if (what == "exercises") return {exercise_};
        if (what == "rubrics") return {marked_};
        if (what == "live") return {station_};
        // Of none that a worker has in hand: a person's log-in and a station's key open none.
        if (what == "works" || what.empty()) return {"1"};
        if (what == "files") return {school::sha256Of(session())};
        return {};
    }
    /// Codes of works on their desk, or on the marker's.
    std::vector<std::string> codesFor(const State& s, const Asker& asker) {
        std::vector<std::string> codes;
        const Asker marker{"", s.marker(), Role::examiner, Role::examiner};
        for (const Asker* one : {&asker, &marker}) {
            if (s.assignment.empty() || !codes.empty()) break;
            const std::string page = ask(*one, "/assignments/" + s.assignment + "/marking").text;
            const std::regex link("/marking/([0-9a-z]{4})\"");
            for (auto it = std::sregex_iterator(page.begin(), page.end(), link); it != std::sregex_iterator(); ++it)
                codes.push_back((*it)[1]);
        }
        if (codes.empty()) codes.emplace_back("2222");
        return codes;
    }

    const Act act_{"t1", 25};
    std::vector<State> states_;
    std::unique_ptr<School> school_;
    std::map<std::string, std::string> tokens_;
    std::map<std::pair<std::string, std::string>, Answer> answers_;
};

TEST_F(VisibilityTest, NoRouteShowsMoreOfAnAttemptThanTheRuleSays) {
    school_ = std::make_unique<School>(data());
    std::string table = "| route | state |", line = "|---|---|", nothing;
    for (const Asker& asker : askersOf(states_.front()))
        table += fmt::format(" {} |", asker.column), line += "---|";
    table += "\n" + line + "\n";
    Seen anywhere;
    for (const Route& route : Server::routes()) {
        if (route.method != "GET") continue;
        std::string shown = std::regex_replace(route.pattern, std::regex("\\(\\[[^)]*\\)"), "ID");
        shown = fmt::format("`GET {}`", std::regex_replace(shown, std::regex("\\|"), "\\|"));
        bool isAny = false;
        for (const State& s : states_) {
            std::string row;
            bool isHere = false;
            for (const Asker& asker : askersOf(s)) {
                const std::vector<std::string> paths = pathsOf(route.pattern, s, asker);
                ASSERT_FALSE(paths.empty()) << route.pattern << ": say in valuesOf() what stands in it";
                Seen seen;
                for (const std::string& path : paths) {
                    const Answer& answer = ask(asker, path);
                    const Seen may = allowed(s, asker, path);
                    for (const char letter : found(s, asker, path, answer.status, answer.text)) {
                        EXPECT_TRUE(may.contains(letter))
                            << letter << " of \"" << s.name << "\" is shown to " << asker.column << " at " << path;
                        seen.insert(letter);
                    }
                }
                row += fmt::format(" {} |", std::string(seen.begin(), seen.end()));
                isHere = isHere || !seen.empty();
                anywhere.insert(seen.begin(), seen.end());
            }
            if (isHere) table += fmt::format("| {} | {} |{}\n", shown, s.name, row);
            isAny = isAny || isHere;
        }
        if (!isAny) nothing += (nothing.empty() ? "" : ", ") + shown;
    }
    EXPECT_EQ(std::string(anywhere.begin(), anywhere.end()), "CDKMNRSV") << "what is found nowhere was not looked for";
    table += "\nNothing of it: " + nothing + ".\n";
    std::ifstream in(kDocs);
    std::stringstream docs;
    docs << in.rdbuf();
    std::string text = docs.str();
    const std::size_t from = text.find(kBegin), to = text.find(kEnd);
    ASSERT_NE(from, text.npos) << kDocs;
    ASSERT_NE(to, text.npos) << kDocs;
    const std::size_t start = from + std::string(kBegin).size();
    const std::string there = text.substr(start, to - start);
    if (std::getenv("HANDPIECE_WRITE_ROUTES")) {
        text.replace(start, there.size(), table);
        std::ofstream(kDocs) << text;
        return;
    }
    EXPECT_EQ(there, table) << "look at each line that differs; HANDPIECE_WRITE_ROUTES=1 writes what is";
}

}  // namespace
}  // namespace handpiece::school_server::visibility_test
