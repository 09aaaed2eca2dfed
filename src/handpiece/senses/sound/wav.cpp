// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <sndfile.h>

#include <cmath>
#include <cstring>
#include <memory>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/senses/sound/player.h"

namespace handpiece::sound {
namespace {

constexpr std::uint64_t kLargestBytes = 256ull << 20;
constexpr double kLongestS = 3600.0;

/// A file in memory, as libsndfile wants it.
struct Memory {
    std::vector<std::byte> bytes;
    sf_count_t place = 0;

    static Memory& of(void* self) { return *static_cast<Memory*>(self); }
    static sf_count_t length(void* self) { return static_cast<sf_count_t>(of(self).bytes.size()); }
    static sf_count_t tell(void* self) { return of(self).place; }
    static sf_count_t seek(sf_count_t offset, int from, void* self) {
        const sf_count_t base = from == SEEK_SET ? 0 : from == SEEK_CUR ? of(self).place : length(self);
        if (base + offset < 0) return -1;
        return of(self).place = base + offset;
    }
    static sf_count_t read(void* to, sf_count_t count, void* self) {
        Memory& m = of(self);
        const sf_count_t n = std::max<sf_count_t>(0, std::min(count, length(self) - m.place));
        if (n > 0) std::memcpy(to, m.bytes.data() + m.place, static_cast<std::size_t>(n));
        m.place += n;
        return n;
    }
    static sf_count_t write(const void* from, sf_count_t count, void* self) {
        Memory& m = of(self);
        const auto end = static_cast<std::size_t>(m.place + count);
        if (end > m.bytes.size()) m.bytes.resize(end);
        std::memcpy(m.bytes.data() + m.place, from, static_cast<std::size_t>(count));
        m.place += count;
        return count;
    }
};

SF_VIRTUAL_IO memoryAccess() {
    return {&Memory::length, &Memory::seek, &Memory::read, &Memory::write, &Memory::tell};
}

struct Close {
    void operator()(SNDFILE* file) const { sf_close(file); }
};
using File = std::unique_ptr<SNDFILE, Close>;

}  // namespace

void writeWav(const Wav& wav, const std::filesystem::path& path) {
    if ((wav.channels != 1 && wav.channels != 2) || wav.rateHz < 1 ||
        wav.samples.size() % static_cast<std::size_t>(std::max(1, wav.channels)) != 0)
        throw core::Error(fmt::format("{} samples in {} channels at {} Hz are no sound", wav.samples.size(),
                                      wav.channels, wav.rateHz),
                          path.string(), "give one or two channels of equal length");
    Memory memory;
    SF_VIRTUAL_IO access = memoryAccess();
    SF_INFO info{};
    info.samplerate = wav.rateHz;
    info.channels = wav.channels;
    info.format = SF_FORMAT_WAV | SF_FORMAT_PCM_16;
    File file(sf_open_virtual(&access, SFM_WRITE, &info, &memory));
    if (!file)
        throw core::Error(fmt::format("the sound cannot be written: {}", sf_strerror(nullptr)), path.string())
            .as("not-writable", {sf_strerror(nullptr)});
    sf_command(file.get(), SFC_SET_CLIPPING, nullptr, SF_TRUE);
    const auto count = static_cast<sf_count_t>(wav.samples.size());
    if (sf_write_float(file.get(), wav.samples.data(), count) != count)
        throw core::Error(fmt::format("the sound cannot be written: {}", sf_strerror(file.get())), path.string());
    file.reset();  // completes the header
    core::writeFile(path, memory.bytes);
}

Wav readWav(const std::filesystem::path& path) {
    Memory memory;
    memory.bytes = core::readFile(path, kLargestBytes);
    if (memory.bytes.empty()) throw core::Error("the file is empty", path.string(), "give a WAV file").as("not-a-wav");
    // libsndfile takes what there is of a file that was cut short. 0 and all ones: written without knowing the length.
    if (memory.bytes.size() >= 8 && std::memcmp(memory.bytes.data(), "RIFF", 4) == 0) {
        std::uint32_t promised = 0;
        for (std::size_t i = 0; i < 4; ++i)
            promised |= static_cast<std::uint32_t>(memory.bytes[4 + i]) << (8 * i);
        if (promised != 0xFFFFFFFFu && promised + 8ull > memory.bytes.size() + 1)
            throw core::Error(fmt::format("the file ends after {} of {} bytes", memory.bytes.size(), promised + 8ull),
                              path.string(), "record or copy it again")
                .as("not-a-wav");
    }
    SF_VIRTUAL_IO access = memoryAccess();
    SF_INFO info{};
    const File file(sf_open_virtual(&access, SFM_READ, &info, &memory));
    const int kind = info.format & SF_FORMAT_TYPEMASK;
    if (!file || (kind != SF_FORMAT_WAV && kind != SF_FORMAT_WAVEX && kind != SF_FORMAT_RF64))
        throw core::Error(file ? std::string("it holds sound, but is no WAV file")
                               : fmt::format("it is no WAV file that can be read: {}", sf_strerror(nullptr)),
                          path.string(), "save it as WAV, PCM of 16 or 24 bits")
            .as("not-a-wav");
    if (info.channels < 1 || info.channels > 2)
        throw core::Error(fmt::format("the sound has {} channels", info.channels), path.string(),
                          "save it with one or two")
            .as("not-a-wav");
    if (info.samplerate < 1 || info.frames < 0 ||
        static_cast<double>(info.frames) > kLongestS * std::max(1, info.samplerate))
        throw core::Error(fmt::format("{} samples at {} Hz are no sound", info.frames, info.samplerate), path.string(),
                          "give at most an hour");
    if (info.frames == 0)
        throw core::Error("the sound is empty", path.string(), "give a WAV file with samples in it").as("not-a-wav");
    Wav wav;
    wav.rateHz = info.samplerate;
    wav.channels = info.channels;
    // What the header promises is asked for piece by piece: the file may end before it.
    std::vector<float> piece(static_cast<std::size_t>(info.channels) * 65536);
    for (;;) {
        const sf_count_t got = sf_read_float(file.get(), piece.data(), static_cast<sf_count_t>(piece.size()));
        if (got <= 0) break;
        wav.samples.insert(wav.samples.end(), piece.begin(), piece.begin() + got);
        if (wav.samples.size() > static_cast<std::size_t>(info.frames) * static_cast<std::size_t>(info.channels)) break;
    }
    if (wav.samples.size() != static_cast<std::size_t>(info.frames) * static_cast<std::size_t>(info.channels))
        throw core::Error(fmt::format("the file ends after {} of {} samples",
                                      wav.samples.size() / static_cast<std::size_t>(wav.channels), info.frames),
                          path.string(), "record or copy it again")
            .as("not-a-wav");
    for (const float v : wav.samples)
        if (!std::isfinite(v))
            throw core::Error("the sound holds values that are no numbers", path.string(), "save it as PCM");
    return wav;
}

}  // namespace handpiece::sound
