// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/session_reader.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/taken_from.h"
#include "handpiece/record/session/hdf5_object.h"

namespace handpiece::session {
namespace {

constexpr hsize_t kMaxRows = hsize_t{1} << 31, kMaxEvents = hsize_t{1} << 20, kMaxKeyFrames = hsize_t{1} << 20,
                  kMaxChunkBytes = hsize_t{1} << 24, kMaxKeyFrameBytes = hsize_t{1} << 30;
constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20;
constexpr const char* kRemedy = "the file is damaged or was not written by Handpiece";

class Source {
  public:
    explicit Source(std::filesystem::path path) : path_(std::move(path)) {}
    [[nodiscard]] std::string name() const { return path_.string(); }
    [[noreturn]] void damaged(std::string what) const {
        throw core::Error(what, path_.string(), kRemedy).as("session-damaged", {what});
    }
    void require(bool good, std::string_view name, std::string_view what) const {
        if (!good) damaged(fmt::format("{}: {}", name, what));
    }

    /// Opens what a hard link names: a soft or external one could lead into other files.
    [[nodiscard]] Hdf5Object open(hid_t where, const char* name, H5I_type_t kind) const {
        H5L_info_t link{};
        if (H5Lexists(where, name, H5P_DEFAULT) <= 0) damaged(fmt::format("there is no {}", name));
        require(H5Lget_info(where, name, &link, H5P_DEFAULT) >= 0 && link.type == H5L_TYPE_HARD, name,
                "is no plain link");
        Hdf5Object object(H5Oopen(where, name, H5P_DEFAULT));
        require(object && H5Iget_type(object.id()) == kind, name, "cannot be opened");
        return object;
    }

    [[nodiscard]] Hdf5Object attribute(hid_t object, const char* name, H5T_class_t type, std::size_t most) const {
        if (H5Aexists(object, name) <= 0) damaged(fmt::format("there is no attribute {}", name));
        Hdf5Object found(H5Aopen(object, name, H5P_DEFAULT));
        require(static_cast<bool>(found), name, "cannot be opened");
        const Hdf5Object stored(H5Aget_type(found.id())), space(H5Aget_space(found.id()));
        require(stored && H5Tget_class(stored.id()) == type && H5Tget_size(stored.id()) <= most &&
                    (type != H5T_STRING || H5Tis_variable_str(stored.id()) == 0) && space &&
                    H5Sget_simple_extent_type(space.id()) == H5S_SCALAR,
                name, "is of another kind");
        return found;
    }
    [[nodiscard]] std::string text(hid_t object, const char* name) const {
        const Hdf5Object found = attribute(object, name, H5T_STRING, 4096);
        const Hdf5Object stored(H5Aget_type(found.id()));
        std::string value(H5Tget_size(stored.id()), '\0');
        require(H5Aread(found.id(), stored.id(), value.data()) >= 0, name, "cannot be read");
        value.resize(std::min(value.size(), value.find('\0')));
        return value;
    }
    template <class T>
    [[nodiscard]] T number(hid_t object, const char* name, H5T_class_t kind, hid_t type) const {
        const Hdf5Object found = attribute(object, name, kind, 8);
        T value{};
        require(H5Aread(found.id(), type, &value) >= 0, name, "cannot be read");
        return value;
    }

  private:
    std::filesystem::path path_;
};

/// One dataset, checked.
class Rows {
  public:
    Rows() = default;
    Rows(const Source& source, hid_t where, const char* name, hid_t type, std::size_t width, hsize_t most)
        : source_(&source), name_(name), width_(width), set_(source.open(where, name, H5I_DATASET)) {
        const Hdf5Object stored(H5Dget_type(set_.id())), space(H5Dget_space(set_.id())),
            creation(H5Dget_create_plist(set_.id()));
        source.require(stored && H5Tequal(stored.id(), type) > 0, name, "holds numbers of another type");
        const int rank = width > 1 ? 2 : 1;
        source.require(space && H5Sget_simple_extent_ndims(space.id()) == rank, name, "has another shape");
        hsize_t size[2] = {0, 1}, chunk[2] = {0, 1};
        H5Sget_simple_extent_dims(space.id(), size, nullptr);
        source.require(size[1] == width && size[0] <= most, name, "has another size");
        source.require(creation && H5Pget_external_count(creation.id()) == 0 &&
                           H5Pget_layout(creation.id()) == H5D_CHUNKED &&
                           H5Pget_chunk(creation.id(), rank, chunk) == rank,
                       name, "is stored in another way");
        source.require(chunk[0] > 0 && chunk[1] == width && chunk[0] <= kMaxChunkBytes / (width * H5Tget_size(type)),
                       name, "has chunks of another size");
        int deflated = 0;
        for (int i = 0; i < H5Pget_nfilters(creation.id()); ++i) {
            unsigned flags = 0, values[8];
            std::size_t count = 8;
            const H5Z_filter_t filter =
                H5Pget_filter2(creation.id(), static_cast<unsigned>(i), &flags, &count, values, 0, nullptr, nullptr);
            deflated += filter == H5Z_FILTER_DEFLATE ? 1 : 0;
            source.require((filter == H5Z_FILTER_SHUFFLE || filter == H5Z_FILTER_DEFLATE) && deflated <= 1, name,
                           "is packed in another way");
        }
        count_ = size[0];
    }
    /// Before memory is taken for so many of its bytes: a size is believed as far as what is stored can hold it.
    /// Deflate packs 1,032 bytes into one at most.
    void requireStored(std::uint64_t bytes) const {
        source_->require(bytes / 1032 <= H5Dget_storage_size(set_.id()), name_, "is larger than what is stored of it");
    }
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    [[nodiscard]] std::size_t width() const noexcept { return width_; }
    void read(std::uint64_t first, std::size_t rows, hid_t type, void* out) const {
        if (rows == 0) return;
        source_->require(first <= count_ && rows <= count_ - first, name_, "ends too early");
        const hsize_t start[2] = {first, 0}, extent[2] = {rows, width_};
        const Hdf5Object memory(H5Screate_simple(width_ > 1 ? 2 : 1, extent, nullptr)), file(H5Dget_space(set_.id()));
        source_->require(H5Sselect_hyperslab(file.id(), H5S_SELECT_SET, start, nullptr, extent, nullptr) >= 0 &&
                             H5Dread(set_.id(), type, memory.id(), file.id(), H5P_DEFAULT, out) >= 0,
                         name_, fmt::format("cannot be read at row {}", first));
    }

  private:
    const Source* source_ = nullptr;
    std::string name_;
    std::size_t width_ = 1;
    Hdf5Object set_;
    std::uint64_t count_ = 0;
};

template <std::size_t N>
std::string textOf(const char (&field)[N]) {
    return {field, std::find(field, field + N, '\0')};
}

}  // namespace

struct SessionReader::State {
    Source source;
    Hdf5Object file;
    SessionInfo info;
    std::int32_t version = 0;  ///< of the format
    bool complete = false;
    std::vector<Rows> columns;
    std::uint64_t size = 0;
    Rows events, keyFrameIndex, keyFrameData;
    Hdf5Object eventType = eventRowType(), keyFrameType = keyFrameRowType();
    std::vector<KeyFrameRow> keyFrames;
    std::vector<std::uint64_t> keyFrameTicks;
    std::vector<Event> told;
    std::uint64_t endTick = 0;

    explicit State(const std::filesystem::path& path) : source(path) {}

    [[nodiscard]] std::uint64_t tickAt(std::uint64_t index) const {
        std::uint64_t tick = 0;
        columns.back().read(index, 1, H5T_NATIVE_UINT64, &tick);
        return tick;
    }
    /// The first record at or after a tick.
    [[nodiscard]] std::uint64_t indexOf(std::uint64_t tick) const {
        std::uint64_t low = 0, high = size;
        while (low < high) {
            const std::uint64_t middle = low + (high - low) / 2;
            if (tickAt(middle) < tick) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        return low;
    }
    [[nodiscard]] Hdf5Object plainDataset(const char* name, std::size_t mostBytes) const {
        Hdf5Object set = source.open(file.id(), name, H5I_DATASET);
        const Hdf5Object creation(H5Dget_create_plist(set.id())), space(H5Dget_space(set.id())),
            type(H5Dget_type(set.id()));
        source.require(creation && H5Pget_layout(creation.id()) != H5D_VIRTUAL &&
                           H5Pget_external_count(creation.id()) == 0 && H5Pget_nfilters(creation.id()) == 0 && space &&
                           H5Sget_simple_extent_type(space.id()) == H5S_SCALAR && type &&
                           H5Tget_size(type.id()) <= mostBytes,
                       name, "is of another kind");
        return set;
    }
    [[nodiscard]] std::vector<std::byte> bytesOf(const char* name, std::size_t most) const {
        const Rows rows(source, file.id(), name, H5T_STD_U8LE, 1, most);
        rows.requireStored(rows.count());
        std::vector<std::byte> bytes(static_cast<std::size_t>(rows.count()));
        rows.read(0, bytes.size(), H5T_NATIVE_UINT8, bytes.data());
        return bytes;
    }
    void readHead();
    void openTables();
    void readEvents();
    void leaveOutWhatWasNotDone();
};

void SessionReader::State::readHead() {
    const hid_t f = file.id();
    if (H5Aexists(f, "format") <= 0 || source.text(f, "format") != kFormatName)
        source.damaged("this HDF5 file is no session of Handpiece");
    version = source.number<std::int32_t>(f, "format_version", H5T_INTEGER, H5T_NATIVE_INT32);
    if (version > kFormatVersion) {
        throw core::Error(
            fmt::format("the session has format {}; this program reads up to {}", version, kFormatVersion),
            source.name(), "read it with a newer Handpiece")
            .as("session-newer");
    }
    source.require(version >= 1, "format_version", "is no version");
    info.version = source.text(f, "handpiece_version");
    info.engineRevision = H5Aexists(f, "engine_revision") > 0
                              ? source.number<std::int32_t>(f, "engine_revision", H5T_INTEGER, H5T_NATIVE_INT32)
                              : 1;
    info.code = source.text(f, "code");
    info.rateHz = source.number<double>(f, "rate_hz", H5T_FLOAT, H5T_NATIVE_DOUBLE);
    source.require(info.rateHz >= 100 && info.rateHz <= 10000, "rate_hz", "is out of range");

    const Hdf5Object set = plainDataset("settings", kMaxTextBytes), type(H5Dget_type(set.id()));
    source.require(H5Tget_class(type.id()) == H5T_STRING && H5Tis_variable_str(type.id()) == 0, "settings",
                   "is no text");
    info.settings.resize(H5Tget_size(type.id()));
    source.require(H5Dread(set.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, info.settings.data()) >= 0, "settings",
                   "cannot be read");
    info.settings.resize(std::min(info.settings.size(), info.settings.find('\0')));

    const Hdf5Object closed = plainDataset("closed", 1);
    std::uint8_t flag = 0;
    source.require(H5Dread(closed.id(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, &flag) >= 0, "closed",
                   "cannot be read");
    complete = flag != 0;
}

void SessionReader::State::openTables() {
    const Hdf5Object samples = source.open(file.id(), "samples", H5I_GROUP),
                     frames = source.open(file.id(), "key_frames", H5I_GROUP);
    size = kMaxRows;
    for (const Column& column : session::columns()) {
        if (version < column.since) {
            columns.emplace_back();  // zeros
            continue;
        }
        const bool isShort = version == 1 && column.width == cases::kTissueCount;
        columns.emplace_back(source, samples.id(), column.name, fileType(column.type),
                             isShort ? cases::kFirstTissueCount : column.width, kMaxRows);
        size = std::min(size, columns.back().count());
    }
    info.tooth = bytesOf("tooth", kMaxToothBytes);
    const auto has = [&](const char* name) { return H5Lexists(file.id(), name, H5P_DEFAULT) > 0; };
    if (has("scenery")) info.scenery = bytesOf("scenery", kMaxToothBytes);
    if (has("history")) info.history = bytesOf("history", kMaxHistoryBytes);
    events = Rows(source, file.id(), "events", eventType.id(), 1, kMaxEvents);
    keyFrameIndex = Rows(source, frames.id(), "index", keyFrameType.id(), 1, kMaxKeyFrames);
    keyFrameData = Rows(source, frames.id(), "data", H5T_STD_U8LE, 1, hsize_t{1} << 40);
    keyFrames.resize(keyFrameIndex.count());
    keyFrameIndex.read(0, keyFrames.size(), keyFrameType.id(), keyFrames.data());
    for (const KeyFrameRow& row : keyFrames) {
        source.require(row.bytes <= kMaxKeyFrameBytes && row.offset <= keyFrameData.count() &&
                           row.bytes <= keyFrameData.count() - row.offset &&
                           (keyFrameTicks.empty() || keyFrameTicks.back() <= row.tick),
                       "key_frames/index", "points outside the data");
        keyFrameTicks.push_back(row.tick);
    }
    readEvents();
    endTick = size > 0 ? tickAt(size - 1) + 1 : 0;
    for (const Event& event : told)
        endTick = std::max(endTick, event.tick + 1);
    if (!keyFrameTicks.empty()) endTick = std::max(endTick, keyFrameTicks.back() + 1);
    leaveOutWhatWasNotDone();
}

void SessionReader::State::readEvents() {
    std::vector<EventRow> rows;
    for (std::uint64_t first = 0; first < events.count(); first += rows.size()) {
        rows.resize(static_cast<std::size_t>(std::min<std::uint64_t>(1024, events.count() - first)));
        events.read(first, rows.size(), eventType.id(), rows.data());
        for (const EventRow& row : rows) {
            if (row.part == 0) {
                told.push_back({row.tick, textOf(row.name), textOf(row.text)});
            } else {
                source.require(!told.empty() && told.back().tick == row.tick, "events", "begins within an event");
                told.back().text += textOf(row.text);
            }
        }
    }
}

/// Events and key frames reach the file before their samples. Where a killed program's session goes on, those behind
/// its last sample tell of what the tooth does not have.
void SessionReader::State::leaveOutWhatWasNotDone() {
    for (std::size_t i = 0; i < told.size(); ++i) {
        if (told[i].name != nameOf(EventName::resume)) continue;
        const std::uint64_t on = told[i].tick, index = indexOf(on), done = index > 0 ? tickAt(index - 1) + 1 : 0;
        const auto undone = [&](std::uint64_t tick) { return tick >= done && tick < on; };
        const auto here = told.begin() + static_cast<std::ptrdiff_t>(i);
        const auto kept = std::remove_if(told.begin(), here, [&](const Event& e) { return undone(e.tick); });
        i -= static_cast<std::size_t>(here - kept);
        told.erase(kept, here);
        std::erase_if(keyFrames, [&](const KeyFrameRow& row) { return undone(row.tick); });
    }
    keyFrameTicks.clear();
    for (const KeyFrameRow& row : keyFrames)
        keyFrameTicks.push_back(row.tick);
}

bool readSideBySide() {
    hbool_t is = false;
    return H5is_library_threadsafe(&is) >= 0 && is;
}

SessionReader::SessionReader(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {
    silenceHdf5();
    State& s = *state_;
    (void)core::openFile(path);  // HDF5 would wait for what a pipe says, and tells less of what it cannot open
    const std::string name = core::takenFrom(path).string();
    if (H5Fis_hdf5(name.c_str()) <= 0)
        throw core::Error("this is no session: it is not an HDF5 file", path.string()).as("not-a-session");
    const Hdf5Object access(H5Pcreate(H5P_FILE_ACCESS));
    H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
    // As a recording that may be under way: what is read later may lie behind where the file ended when it was opened.
    H5Pset_metadata_read_attempts(access.id(), 10);
    s.file = Hdf5Object(H5Fopen(name.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access.id()));
    if (!s.file) s.file = Hdf5Object(H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.id()));
    if (!s.file) s.source.damaged("the session cannot be opened: its end or its beginning is missing");
    s.readHead();
    s.openTables();
}

SessionReader::~SessionReader() = default;

const SessionInfo& SessionReader::info() const noexcept {
    return state_->info;
}
bool SessionReader::isComplete() const noexcept {
    return state_->complete;
}
std::int32_t SessionReader::formatVersion() const noexcept {
    return state_->version;
}
std::uint64_t SessionReader::size() const noexcept {
    return state_->size;
}

std::vector<Record> SessionReader::records(std::uint64_t first, std::size_t count) const {
    const State& s = *state_;
    if (first >= s.size) return {};
    const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>(count, s.size - first));
    std::vector<Record> result(rows);
    std::vector<std::byte> buffer;
    const auto all = columns();
    for (std::size_t c = 0; c < all.size(); ++c) {
        if (s.version < all[c].since) continue;
        const std::size_t bytes = s.columns[c].width() * bytesOf(all[c].type);
        buffer.resize(rows * bytes);
        s.columns[c].read(first, rows, memoryType(all[c].type), buffer.data());
        for (std::size_t i = 0; i < rows; ++i)
            std::memcpy(reinterpret_cast<std::byte*>(&result[i]) + all[c].offset, &buffer[i * bytes], bytes);
    }
    for (std::size_t i = 1; i < rows; ++i)
        s.source.require(result[i - 1].tick < result[i].tick, "samples/tick", "does not rise");
    return result;
}

std::uint64_t SessionReader::indexOfTick(std::uint64_t tick) const {
    return state_->indexOf(tick);
}

std::uint64_t SessionReader::endTick() const noexcept {
    return state_->endTick;
}

std::vector<Event> SessionReader::events() const {
    return state_->told;
}

const std::vector<std::uint64_t>& SessionReader::keyFrameTicks() const noexcept {
    return state_->keyFrameTicks;
}

KeyFrame SessionReader::keyFrame(std::size_t index) const {
    const State& s = *state_;
    if (index >= s.keyFrames.size()) throw core::Error(fmt::format("there is no key frame {}", index), "session");
    const KeyFrameRow& row = s.keyFrames[index];
    s.keyFrameData.requireStored(row.bytes);
    KeyFrame frame{row.tick, std::vector<std::byte>(static_cast<std::size_t>(row.bytes))};
    s.keyFrameData.read(row.offset, frame.state.size(), H5T_NATIVE_UINT8, frame.state.data());
    s.source.require(hashOf(frame.state) == row.hash, "key_frames/data", "is not what was written");
    return frame;
}

std::optional<KeyFrame> SessionReader::keyFrameBefore(std::uint64_t tick) const {
    const auto& ticks = state_->keyFrameTicks;
    const auto after = std::upper_bound(ticks.begin(), ticks.end(), tick);
    if (after == ticks.begin()) return std::nullopt;
    return keyFrame(static_cast<std::size_t>(after - ticks.begin()) - 1);
}

}  // namespace handpiece::session
