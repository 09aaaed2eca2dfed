// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A school's books: what its server knows. People, classes, assignments, exercise packs, rubrics, stations, attempts,
/// scores, marks, work to be done, and who did what. docs/school-books.md.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/school/store/content_files.h"
#include "handpiece/school/store/store.h"

namespace handpiece::school {

/// Whose doing a change is, and when: the books have no clock. A person's code, or "station ID", "server".
struct Act {
    std::string who{};
    Milliseconds at = 0;
};

/// One table has the name; everything else has the code.
struct Person {
    std::string code{};  ///< newId() or the school's own pseudonym; stays when the name goes
    std::string name{}, login{};
    std::string external{};            ///< the id of another system's list (OneRoster); empty: none
    std::string password{};            ///< a hash, opaque here; empty: cannot log in by password
    std::vector<std::string> roles{};  ///< of "student", "teacher", "examiner", "administrator"
    Milliseconds made = 0;
    Milliseconds erased = 0;  ///< 0: not; else name, login, external and password are gone
};

struct SchoolClass {
    std::string id{}, name{}, external{};
    std::int64_t retentionDays = 0;  ///< after it was closed its students' attempts go; 0: they stay
    Milliseconds made = 0, closed = 0;
};

struct Enrolment {
    std::string schoolClass{}, person{};
    std::string role{};  ///< "student", "teacher", "examiner"
};

struct RubricVersion {
    std::string hash{};  ///< 16 hexadecimal digits, as results name it
    std::string id{}, text{};
    std::int64_t version = 1;
    Milliseconds made = 0;
};

/// An exercise as it is given out; its file lies among the content files.
struct Pack {
    std::string hash{};  ///< the exercise's, 16 hexadecimal digits
    std::string file{};  ///< SHA-256
    std::string exercise{}, title{}, rubric{};
    Milliseconds made = 0;
};

struct Assignment {
    std::string id{}, schoolClass{}, pack{}, rubric{}, title{};
    std::string kind{};   ///< "practice", "exam"
    std::string helps{};  ///< those that are allowed, separated by a space
    Milliseconds opens = 0, closes = 0;
};

struct Station {
    std::string id{}, name{};
    Milliseconds enrolled = 0, revoked = 0;
    std::string kind = "practice";  ///< "exam", "worker": enrolled by a code of that kind
    Milliseconds released = 0;      ///< for exams, by an administrator
    std::string person{};           ///< who showed that it is theirs, and whose work alone it sends; empty: anybody's
    Milliseconds ends = 0;          ///< of such a one: until when, unless they show it again; 0: it does not
    [[nodiscard]] bool mayHoldExams() const { return kind == "exam" && released > 0 && revoked == 0; }
};

/// An attempt as a station pushes it. Its score is what the station says: provisional.
struct PushedAttempt {
    Attempt attempt{};  ///< `proven` and `recordings` are the station's affair and do not come along
    std::string station{}, person{};
    std::string assignment{};          ///< empty: practice of one's own
    std::vector<std::string> files{};  ///< SHA-256 of the session files, in the order of attempt.sessionHashes
    Milliseconds received = 0;         ///< by the server's clock; attempt.began and .finished are by the station's
};

/// What the server made of an attempt.
struct Score {
    std::string attempt{}, campaign{}, rubric{};
    std::int64_t engine = 0;  ///< revision
    std::string state{};      ///< "proven", "refused"
    std::string reason{};     ///< of "refused"
    std::string stateHash{};
    double score = 0.0, maxScore = 0.0, wholeScore = 0.0;
    std::string passed{};  ///< "yes", "no", "teacher"
    bool borderline = false;
    std::string result{};  ///< JSON
    std::string worker{};
    Milliseconds made = 0;
};

/// What a teacher or an examiner says of an attempt; a later one of the same marker counts in its place.
struct Mark {
    std::string id{};  ///< newId()
    std::string attempt{}, marker{};
    std::string kind{};  ///< "teacher", "examiner", "blind", "adjudication"
    std::string verdict{};
    double points = 0.0, maxPoints = 0.0;
    std::string marks{};  ///< JSON, docs/formats/returned.md
    Milliseconds made = 0;
};

/// An attempt to be scored, lent to a worker. `turn` tells this lending from one before and after.
struct Job {
    std::int64_t number = 0, turn = 0;
    std::string campaign{}, attempt{}, rubric{};
    Milliseconds leaseUntil = 0;
};
struct Progress {
    std::int64_t waiting = 0, taken = 0, done = 0, failed = 0;
};

struct AuditLine {
    std::int64_t number = 0;  ///< without gaps
    Milliseconds at = 0;
    std::string who{}, what{}, about{}, detail{};  ///< never with a name in it
};

/// A student's work on an assignment, for the page of a class.
struct ClassCell {
    std::string person{}, assignment{};
    std::int64_t attempts = 0;
    std::string last{};  ///< the attempt that was finished last
    Milliseconds finished = 0;
    std::string state{};  ///< "provisional", "proven", "refused"
    double score = 0.0, maxScore = 0.0;
    std::string passed{}, reason{};
    std::int64_t marks = 0;
};
struct ClassPage {
    SchoolClass schoolClass{};
    std::vector<Assignment> assignments{};
    std::vector<Person> students{};  ///< by their codes, without passwords
    std::vector<ClassCell> cells{};  ///< by assignment and person, where there is an attempt
};

/// Rows as text, for export and comparison. Numbers as they are read back to the same bits; nothing as an empty text.
struct BookTable {
    std::string name;
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
};
/// One line a row, tabs between, tab, line's end and backslash escaped as `\t` `\n` `\r` `\\`.
[[nodiscard]] std::string asText(const std::vector<BookTable>& tables);

/// SQLite in `data`, or PostgreSQL; the same answers from both. One thread each; any number of them, in any number of
/// programs, on the same books. Whatever changes something is one transaction, with its line in the audit where a
/// person did it.
///
/// All members throw core::Error: "store-newer", "store-locked", "store-damaged", "no-space", "not-writable" as
/// Store's; of PostgreSQL "store-gone", "store-refused", "store-full"; "books-unknown" (what, which), "books-duplicate"
/// (what, which), "books-changed" (which: the id is there with another content), "books-invalid" (field).
class Books {
  public:
    static constexpr int kVersion = 7;
    /// A job that so many workers took and none gave back is given up.
    static constexpr int kMostTurns = 5;

    /// In the server's folder `data`, made where it is not there: books.db, files, uploads. `address` empty: SQLite in
    /// it; else postgresql://... `patience`: how long one waits for another who writes.
    explicit Books(const std::filesystem::path& data, const std::string& address = {},
                   std::chrono::milliseconds patience = std::chrono::seconds(10));
    ~Books();
    Books(const Books&) = delete;
    Books& operator=(const Books&) = delete;

    // People. All of a list or none.
    void add(std::span<const Person> people, const Act& act);
    void rename(const std::string& code, const std::string& name, const std::string& login, const Act& act);
    void setPassword(const std::string& code, const std::string& hash, const Act& act);
    void setRoles(const std::string& code, const std::vector<std::string>& roles, const Act& act);
    [[nodiscard]] std::optional<Person> person(const std::string& code) const;
    [[nodiscard]] std::optional<Person> personByLogin(const std::string& login) const;
    [[nodiscard]] std::vector<Person> people() const;
    /// All that is held of a person, and who looked at it. Passwords are not told.
    [[nodiscard]] std::vector<BookTable> about(const std::string& code, const Act& act);
    /// The name goes, and what leads to it; the code and what it did stay. Cannot be taken back.
    void erase(const std::string& code, const Act& act);

    // Log-ins, by their tokens, which are kept as hashes. A new password, other roles and erasing end all of a person.
    void addLogin(const std::string& token, const std::string& person, Milliseconds expires, const Act& act);
    /// Whose it is; none for one that is unknown, ended or too old.
    [[nodiscard]] std::optional<Person> personByToken(const std::string& token, Milliseconds now) const;
    void endLogin(const std::string& token);

    // Classes.
    void add(const SchoolClass& schoolClass, const Act& act);
    void close(const std::string& schoolClass, const Act& act);
    /// Again: with the role of now.
    void enrol(std::span<const Enrolment> enrolments, const Act& act);
    void leave(const std::string& schoolClass, const std::string& person, const Act& act);
    [[nodiscard]] std::vector<SchoolClass> classes() const;
    [[nodiscard]] std::vector<Enrolment> enrolments(const std::string& schoolClass) const;
    [[nodiscard]] ClassPage classPage(const std::string& schoolClass) const;
    // Exercises. The same again is no error.
    void add(const RubricVersion& rubric, const Act& act);
    void add(const Pack& pack, const Act& act);
    void add(const Assignment& assignment, const Act& act);
    [[nodiscard]] std::optional<RubricVersion> rubric(const std::string& hash) const;
    [[nodiscard]] std::optional<Pack> pack(const std::string& hash) const;
    [[nodiscard]] std::vector<Assignment> assignments(const std::string& schoolClass) const;
    [[nodiscard]] std::optional<Assignment> assignment(const std::string& id) const;

    // Stations. Codes and keys are kept as hashes.
    /// `kind`: of the station that it makes; `person`: whose it will be, for kTerm.
    void offerCode(const std::string& code, const std::string& name, Milliseconds expires, const Act& act,
                   const std::string& kind = "practice", const std::string& person = {});
    static constexpr Milliseconds kTerm = 200 * std::int64_t{86'400'000};
    /// What a code makes, without using it; none for one that is unknown, used or too old.
    struct Offered {
        std::string name{}, kind{}, person{};
    };
    [[nodiscard]] std::optional<Offered> offered(const std::string& code, Milliseconds now) const;
    /// Once a code; none as above.
    std::optional<Station> enrolStation(const std::string& code, const std::string& id, const std::string& key,
                                        Milliseconds now);
    void revoke(const std::string& station, const Act& act);
    /// From now on it may hold exams. One of that kind only; again is no error.
    void releaseForExams(const std::string& station, const Act& act);
    /// None where it is unknown, revoked or over.
    [[nodiscard]] std::optional<Station> stationByKey(const std::string& key, Milliseconds now = 0) const;
    /// Revoked ones too.
    [[nodiscard]] std::optional<Station> station(const std::string& id) const;
    [[nodiscard]] std::vector<Station> stationsOf(const std::string& person) const;

    // What stations push. True: new; false: it was there already, the same.
    bool push(const PushedAttempt& attempt);
    bool push(const Judgement& judgement);
    bool push(const Comment& comment);
    /// Of files that came whole and proven the books know. As ContentFiles::received() and append().
    [[nodiscard]] std::uint64_t received(const Upload& upload, Milliseconds now);
    bool append(const Upload& upload, std::uint64_t offset, std::span<const std::byte> piece, Milliseconds now);
    [[nodiscard]] const ContentFiles& files() const;
    /// Whether this station has sent all of its bytes: naming a hash delivers nothing.
    [[nodiscard]] bool hasDelivered(const Upload& upload) const;
    /// Whether all files of an attempt came from its own station.
    [[nodiscard]] bool isWhole(const std::string& attempt) const;
    /// Files of a station's attempts that have not come from it yet.
    [[nodiscard]] std::vector<std::string> missingFiles(const std::string& station) const;
    /// Throws away what a killed server left of files and uploads, older than a day.
    void sweep(Milliseconds now);

    [[nodiscard]] std::optional<PushedAttempt> attempt(const std::string& id) const;
    /// By when they were finished; empty `assignment`: all of the person's.
    [[nodiscard]] std::vector<PushedAttempt> attemptsOf(const std::string& person,
                                                        const std::string& assignment = {}) const;
    /// What a file holds, whatever its bytes: the hash of its inputs.
    void keepContent(const std::string& file, const std::string& inputs);
    /// And of its motion the least hashes of its stretches, so that one is found that is nearly the same.
    void keepSketch(const std::string& file, const std::vector<std::string>& hashes);
    /// Works of other persons of which this attempt's recordings have at least a quarter of these, most first, five at
    /// most: what a teacher should look at. It is no proof, and says nothing of who was first.
    struct Alike {
        std::string attempt{}, person{};
        std::int64_t percent = 0;  ///< of the smaller one's
    };
    [[nodiscard]] std::vector<Alike> alike(const std::string& attempt) const;
    /// Another person whose attempt has one of this one's sessions, and whose station delivered its bytes before this
    /// one's did: a session is one person's, and to know a file's hash is not to have it. None: nobody.
    [[nodiscard]] std::optional<std::string> otherPersonWith(const std::string& attempt) const;
    /// In their order, the one that counts last (Teaching::setCounting; without a choice the last one).
    [[nodiscard]] std::vector<Score> scoresOf(const std::string& attempt) const;
    bool push(const Mark& mark, const Act& act);
    [[nodiscard]] std::vector<Mark> marksOf(const std::string& attempt) const;
    [[nodiscard]] std::vector<Comment> commentsOn(const std::string& attempt) const;
    /// Practice is its student's own unless they share it.
    void share(const std::string& attempt, bool shared, const Act& act);
    [[nodiscard]] bool isShared(const std::string& attempt) const;

    // Work. An attempt waits to be scored from when it and all its files are there (campaign "arrival").
    /// All attempts of an assignment once more, by another rubric; the same campaign again adds those that came since.
    /// Returns how many were added.
    std::int64_t rescore(const std::string& campaign, const std::string& assignment, const std::string& rubric,
                         const Act& act);
    /// By the clock that all workers share: PostgreSQL's; of SQLite, which is on one machine, `own`.
    [[nodiscard]] Milliseconds sharedTime(Milliseconds own) const;
    /// The one that waits longest, or whose worker did not come back in time.
    std::optional<Job> takeJob(const std::string& worker, Milliseconds now, Milliseconds lease);
    /// What this worker has in hand; nothing where that turn is over. Its lease may have run out (`leaseUntil`) without
    /// another having taken it.
    [[nodiscard]] std::optional<Job> lent(const std::string& worker, std::int64_t number, std::int64_t turn) const;
    /// How many that are.
    [[nodiscard]] std::int64_t countLent(const std::string& worker) const;
    /// False: it is another's by now, or done; drop it.
    bool renew(Job& job, Milliseconds now, Milliseconds lease);
    /// Score and end of the job, once: false: another was quicker, and nothing was stored.
    bool finish(const Job& job, const Score& score);
    /// Back to the others: this worker cannot do it. Nobody takes it before `notBefore`; it does not count as one of
    /// its turns where that was no affair of the work's.
    bool giveBack(const Job& job, Milliseconds notBefore = 0, bool counts = true);
    /// What was given up an hour ago or longer waits for one more turn. Returns how much that is.
    std::int64_t retry(Milliseconds now);
    [[nodiscard]] Progress progress(const std::string& campaign) const;

    /// A look at something, or what else leaves no other trace.
    void note(const Act& act, const std::string& what, const std::string& about, const std::string& detail = {});
    /// What follows `number`, in its order, `most` at once; empty `about`: all.
    [[nodiscard]] std::vector<AuditLine> audit(std::int64_t number, std::size_t most = 100,
                                               const std::string& about = {}) const;

    /// All of it but passwords, keys and codes, in one state.
    [[nodiscard]] std::vector<BookTable> everything() const;

  private:
    friend class BooksRoom;
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::school
