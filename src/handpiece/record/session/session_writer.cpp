// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/session_writer.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/record/session/hdf5_object.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/record/session/survivable_file.h"

namespace handpiece::session {
namespace {

constexpr unsigned kDeflateLevel = 5;
constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20;

/// Throws on what cannot happen but by a lack of memory or an error of ours: the driver keeps the disk's errors away.
hid_t made(hid_t id, std::string_view what) {
    if (id < 0) throw core::Error(fmt::format("HDF5 cannot make {}", what), "session");
    return id;
}

void writeAttribute(hid_t object, const char* name, hid_t type, const void* value) {
    const Hdf5Object space(H5Screate(H5S_SCALAR));
    const Hdf5Object attribute(made(H5Acreate2(object, name, type, space.id(), H5P_DEFAULT, H5P_DEFAULT), name));
    if (H5Awrite(attribute.id(), type, value) < 0) made(-1, name);
}

void writeAttribute(hid_t object, const char* name, std::string_view value) {
    writeAttribute(object, name, textType(value.size()).id(), value.empty() ? "" : std::string(value).c_str());
}

Hdf5Object group(hid_t file, const char* name) {
    const Hdf5Object creation(H5Pcreate(H5P_GROUP_CREATE));
    H5Pset_obj_track_times(creation.id(), false);
    return Hdf5Object(made(H5Gcreate2(file, name, H5P_DEFAULT, creation.id(), H5P_DEFAULT), name));
}

void writeText(hid_t file, const char* name, std::string_view text) {
    const Hdf5Object type = textType(text.size()), space(H5Screate(H5S_SCALAR)),
                     creation(H5Pcreate(H5P_DATASET_CREATE));
    H5Pset_obj_track_times(creation.id(), false);
    H5Pset_alloc_time(creation.id(), H5D_ALLOC_TIME_EARLY);
    const Hdf5Object dataset(
        made(H5Dcreate2(file, name, type.id(), space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), name));
    const std::string copy(text.empty() ? std::string_view("\0", 1) : text);
    if (H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, copy.data()) < 0) made(-1, name);
}

void writeBytes(hid_t file, const char* name, const std::vector<std::byte>& bytes, bool packed) {
    const hsize_t size = bytes.size(), chunk = kBytesChunk;
    const Hdf5Object creation(H5Pcreate(H5P_DATASET_CREATE));
    H5Pset_obj_track_times(creation.id(), false);
    H5Pset_chunk(creation.id(), 1, &chunk);
    if (packed) H5Pset_deflate(creation.id(), kDeflateLevel);
    const hsize_t limit = std::max(size, chunk);  // a chunk may not exceed what a dataset of fixed size can hold
    const Hdf5Object room(H5Screate_simple(1, &size, size < chunk ? &limit : &size));
    const Hdf5Object dataset(
        made(H5Dcreate2(file, name, H5T_STD_U8LE, room.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), name));
    if (size > 0 && H5Dwrite(dataset.id(), H5T_STD_U8LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0)
        made(-1, name);
}

/// 0 until the recorder has closed the file.
Hdf5Object makeClosedFlag(hid_t file) {
    const Hdf5Object space(H5Screate(H5S_SCALAR)), creation(H5Pcreate(H5P_DATASET_CREATE));
    H5Pset_obj_track_times(creation.id(), false);
    H5Pset_alloc_time(creation.id(), H5D_ALLOC_TIME_EARLY);
    return Hdf5Object(
        made(H5Dcreate2(file, "closed", H5T_STD_U8LE, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), "closed"));
}

/// A dataset that grows by rows.
class Growing {
  public:
    Growing() = default;
    Growing(hid_t group, const char* name, hid_t type, std::size_t width, std::size_t rows, bool packed)
        : width_(width) {
        const hsize_t none[2] = {0, width}, most[2] = {H5S_UNLIMITED, width}, chunk[2] = {rows, width};
        const int rank = width > 1 ? 2 : 1;
        const Hdf5Object space(H5Screate_simple(rank, none, most)), creation(H5Pcreate(H5P_DATASET_CREATE)),
            access(H5Pcreate(H5P_DATASET_ACCESS));
        H5Pset_chunk(creation.id(), rank, chunk);
        H5Pset_obj_track_times(creation.id(), false);
        if (packed) {
            H5Pset_shuffle(creation.id());
            H5Pset_deflate(creation.id(), kDeflateLevel);
        }
        // One chunk at a time, never read again.
        H5Pset_chunk_cache(access.id(), 1, rows * width * H5Tget_size(type), 1.0);
        dataset_ =
            Hdf5Object(made(H5Dcreate2(group, name, type, space.id(), H5P_DEFAULT, creation.id(), access.id()), name));
    }
    /// One that is there: rows from `rows` on are written anew.
    static Growing there(hid_t group, const char* name, std::size_t width, std::uint64_t rows) {
        Growing g;
        g.width_ = width;
        g.rows_ = rows;
        g.dataset_ = Hdf5Object(made(H5Dopen2(group, name, H5P_DEFAULT), name));
        return g;
    }
    void append(hid_t type, const void* data, std::size_t count) {
        if (!dataset_) return;  // a file of an older format is without it
        const hsize_t start[2] = {rows_, 0}, extent[2] = {count, width_}, size[2] = {rows_ + count, width_};
        const int rank = width_ > 1 ? 2 : 1;
        if (H5Dset_extent(dataset_.id(), size) < 0) made(-1, "room for more rows");
        const Hdf5Object memory(H5Screate_simple(rank, extent, nullptr)), file(H5Dget_space(dataset_.id()));
        H5Sselect_hyperslab(file.id(), H5S_SELECT_SET, start, nullptr, extent, nullptr);
        if (H5Dwrite(dataset_.id(), type, memory.id(), file.id(), H5P_DEFAULT, data) < 0) made(-1, "a chunk");
        if (H5Dflush(dataset_.id()) < 0) made(-1, "a flush");
        rows_ += count;
    }
    [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }
    [[nodiscard]] hid_t id() const noexcept { return dataset_.id(); }

  private:
    Hdf5Object dataset_;
    std::size_t width_ = 1;
    std::uint64_t rows_ = 0;
};

void check(const SessionInfo& info) {
    if (!(info.rateHz >= 100 && info.rateHz <= 10000))
        throw core::Error(fmt::format("a rate of {} Hz cannot be recorded", info.rateHz), "session");
    const bool plain = std::all_of(info.code.begin(), info.code.end(), [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
    });
    if (!plain || info.code.size() > 32)
        throw core::Error("this cannot be a session's code", "code", "use up to 32 letters a to z, digits, - and _");
    if (info.settings.size() > kMaxTextBytes) throw core::Error("the settings are too long", "session");
    if (info.history.size() > kMaxHistoryBytes) throw core::Error("the history is too long", "session");
    if (info.scenery.size() > kMaxToothBytes) throw core::Error("the scenery is too large", "session");
    if (info.tooth.size() > kMaxToothBytes) throw core::Error("the tooth is too large", "session");
}

/// Where to cut a text that is longer than `room`: not inside a character.
std::size_t cutAt(std::string_view text, std::size_t room) {
    if (text.size() <= room) return text.size();
    std::size_t at = room;
    while (at > room - 3 && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80)
        --at;
    return at;
}

}  // namespace

struct SessionWriter::State {
    FileState fileState;  // outlives the file
    Hdf5Object file, closedFlag;
    std::vector<Growing> columns;
    Growing events, keyFrameIndex, keyFrameData;
    Hdf5Object eventType, keyFrameType;
    std::size_t rowsPerChunk = 0, pending = 0, room = 0;  ///< rows until the chunk is full
    std::vector<std::vector<std::byte>> buffers;          // by column: the rows of the chunk that fills up
    std::uint64_t written = 0, lastTick = 0, firstTick = 0;
    bool any = false;
    double rateHz = 0.0;

    void writeChunk() {
        if (pending == 0) return;
        const auto all = session::columns();
        for (std::size_t i = 0; i < all.size(); ++i)
            columns[i].append(memoryType(all[i].type), buffers[i].data(), pending);
        if (fileState.failure.empty()) written += pending;
        pending = 0;
        room = rowsPerChunk;
    }
    void makeBuffers(double rate) {
        rateHz = rate;
        rowsPerChunk = room = chunkRows(rate);
        for (const Column& column : session::columns())
            buffers.emplace_back(rowsPerChunk * column.width * session::bytesOf(column.type));
        eventType = eventRowType();
        keyFrameType = keyFrameRowType();
    }
    void startSwmr(const std::filesystem::path& path) {
        const bool started = H5Fstart_swmr_write(file.id()) >= 0;
        if (!fileState.failure.empty())
            throw core::Error(fileState.failure, path.string(), "make room or choose another place")
                .as(core::writeErrorId(fileState.errorNumber), {std::strerror(fileState.errorNumber)});
        if (!started) made(-1, "a file that survives");
    }
};

SessionWriter::SessionWriter(const std::filesystem::path& path, const SessionInfo& info, Observer observer)
    : state_(std::make_unique<State>()) {
    check(info);
    silenceHdf5();
    State& s = *state_;
    s.fileState.observer = std::move(observer);
    s.file = Hdf5Object(createSurvivableFile(path, s.fileState));
    const hid_t file = s.file.id();

    unsigned major = 0, minor = 0, release = 0;
    H5get_libversion(&major, &minor, &release);
    writeAttribute(file, "format", kFormatName);
    writeAttribute(file, "format_version", H5T_STD_I32LE, &kFormatVersion);
    writeAttribute(file, "handpiece_version", info.version);
    writeAttribute(file, "engine_revision", H5T_STD_I32LE, &info.engineRevision);
    writeAttribute(file, "hdf5_version", fmt::format("{}.{}.{}", major, minor, release));
    writeAttribute(file, "rate_hz", H5T_IEEE_F64LE, &info.rateHz);
    writeAttribute(file, "code", info.code);
    writeText(file, "README", readme());
    writeText(file, "settings", info.settings);

    writeBytes(file, "tooth", info.tooth, true);
    if (!info.scenery.empty()) writeBytes(file, "scenery", info.scenery, false);  // quickly: somebody waits
    if (!info.history.empty()) writeBytes(file, "history", info.history, false);  // it is packed already
    s.closedFlag = makeClosedFlag(file);

    s.makeBuffers(info.rateHz);
    const Hdf5Object samples = group(file, "samples"), keyFrames = group(file, "key_frames");
    for (const Column& column : columns()) {
        Growing dataset(samples.id(), column.name, fileType(column.type), column.width, s.rowsPerChunk, true);
        writeAttribute(dataset.id(), "unit", std::string_view(column.unit));
        writeAttribute(dataset.id(), "description", std::string_view(column.description));
        s.columns.push_back(std::move(dataset));
    }
    // Not packed: rows are added to a chunk in place.
    s.events = Growing(file, "events", s.eventType.id(), 1, kEventChunk, false);
    s.keyFrameIndex = Growing(keyFrames.id(), "index", s.keyFrameType.id(), 1, kKeyFrameIndexChunk, false);
    s.keyFrameData = Growing(keyFrames.id(), "data", H5T_STD_U8LE, 1, kKeyFrameDataChunk, false);
    s.startSwmr(path);
    putInPlace(s.fileState);
}

SessionWriter::SessionWriter(const std::filesystem::path& path, Observer observer) : state_(std::make_unique<State>()) {
    State& s = *state_;
    double rateHz = 0.0;
    std::uint64_t rows = 0;
    std::int32_t version = 0;
    {
        // It looks at all that the file says about itself, and is closed before the file is opened to write.
        const SessionReader reader(path);
        version = reader.formatVersion();
        if (version == 1)
            throw core::Error("this session is of format 1, in which no newer program can go on", path.string(),
                              "begin a new session");
        rateHz = reader.info().rateHz;
        rows = reader.size();
        s.firstTick = reader.endTick();
    }
    s.any = s.firstTick > 0;
    s.lastTick = s.any ? s.firstTick - 1 : 0;
    s.fileState.observer = std::move(observer);
    s.file = Hdf5Object(reopenSurvivableFile(path, s.fileState));
    const hid_t file = s.file.id();
    s.makeBuffers(rateHz);
    // Chunks stay as they are laid out: the first rows to come fill up the last one.
    s.room = s.rowsPerChunk - static_cast<std::size_t>(rows % s.rowsPerChunk);
    const auto group = [&](const char* name) { return Hdf5Object(made(H5Gopen2(file, name, H5P_DEFAULT), name)); };
    const Hdf5Object samples = group("samples"), keyFrames = group("key_frames");
    const auto rowsOf = [](hid_t where, const char* name) {
        const Hdf5Object set(made(H5Dopen2(where, name, H5P_DEFAULT), name)), space(H5Dget_space(set.id()));
        return static_cast<std::uint64_t>(H5Sget_simple_extent_npoints(space.id()));
    };
    for (const Column& column : columns())
        s.columns.push_back(version < column.since ? Growing()
                                                   : Growing::there(samples.id(), column.name, column.width, rows));
    s.events = Growing::there(file, "events", 1, rowsOf(file, "events"));
    s.keyFrameIndex = Growing::there(keyFrames.id(), "index", 1, rowsOf(keyFrames.id(), "index"));
    s.keyFrameData = Growing::there(keyFrames.id(), "data", 1, rowsOf(keyFrames.id(), "data"));
    s.closedFlag = Hdf5Object(made(H5Dopen2(file, "closed", H5P_DEFAULT), "closed"));
    s.startSwmr(path);
    const std::uint8_t no = 0;
    if (H5Dwrite(s.closedFlag.id(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, &no) < 0) made(-1, "the mark");
    if (H5Dflush(s.closedFlag.id()) < 0) made(-1, "a flush");
}

SessionWriter::~SessionWriter() {
    try {
        close();
    } catch (const core::Error&) {
        // Only memory can be short here, and what is in the file is sound; close() itself tells.
    }
}

void SessionWriter::append(const Record& record) {
    State& s = *state_;
    if (s.any && record.tick <= s.lastTick)
        throw core::Error(fmt::format("tick {} comes after tick {}", record.tick, s.lastTick), "session");
    s.any = true;
    s.lastTick = record.tick;
    const auto* source = reinterpret_cast<const std::byte*>(&record);
    const auto all = columns();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const std::size_t bytes = bytesOf(all[i].type) * all[i].width;
        std::memcpy(&s.buffers[i][s.pending * bytes], source + all[i].offset, bytes);
    }
    if (++s.pending == s.room) s.writeChunk();
}

void SessionWriter::append(const Event& event) {
    State& s = *state_;
    if (event.name.empty() || event.name.size() >= sizeof(EventRow::name) || event.text.size() > kMaxTextBytes)
        throw core::Error("the event's name or text is too long", event.name);
    std::vector<EventRow> rows;
    std::string_view rest = event.text;
    do {
        EventRow row;
        row.tick = event.tick;
        row.part = static_cast<std::uint32_t>(rows.size());
        std::memcpy(row.name, event.name.data(), event.name.size());
        const std::size_t bytes = cutAt(rest, sizeof(EventRow::text) - 1);
        std::memcpy(row.text, rest.data(), bytes);
        rest.remove_prefix(bytes);
        rows.push_back(row);
    } while (!rest.empty());
    s.events.append(s.eventType.id(), rows.data(), rows.size());
}

void SessionWriter::append(const KeyFrame& keyFrame) {
    State& s = *state_;
    const KeyFrameRow row{keyFrame.tick, s.keyFrameData.rows(), keyFrame.state.size(), hashOf(keyFrame.state)};
    if (!keyFrame.state.empty()) s.keyFrameData.append(H5T_STD_U8LE, keyFrame.state.data(), keyFrame.state.size());
    s.keyFrameIndex.append(s.keyFrameType.id(), &row, 1);
}

void SessionWriter::close() {
    State& s = *state_;
    if (!s.file) return;
    s.writeChunk();
    const std::uint8_t yes = 1;
    if (H5Dwrite(s.closedFlag.id(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, &yes) < 0) made(-1, "the end");
    s.closedFlag.close();
    s.columns.clear();
    s.events = Growing();
    s.keyFrameIndex = Growing();
    s.keyFrameData = Growing();
    s.file.close();
}

std::uint64_t SessionWriter::firstTick() const noexcept {
    return state_->firstTick;
}

double SessionWriter::rateHz() const noexcept {
    return state_->rateHz;
}

const std::string& SessionWriter::failure() const noexcept {
    return state_->fileState.failure;
}

int SessionWriter::errorNumber() const noexcept {
    return state_->fileState.errorNumber;
}

std::uint64_t SessionWriter::writtenRecords() const noexcept {
    return state_->written;
}

std::uint64_t SessionWriter::sizeBytes() const noexcept {
    return state_->fileState.sizeBytes;
}

}  // namespace handpiece::session
