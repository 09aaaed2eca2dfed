// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/samples.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

namespace handpiece::volume {
namespace {

constexpr std::size_t kChunkBytes = 1 << 20;

template <class T>
T swapped(T value) {
    std::array<std::byte, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    std::reverse(bytes.begin(), bytes.end());
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
}

template <class T>
T at(const std::byte* from, std::size_t i, bool isBigEndian) {
    T value;
    std::memcpy(&value, from + i * sizeof(T), sizeof value);
    return isBigEndian && sizeof(T) > 1 ? swapped(value) : value;
}

template <class T>
void convertAll(bool isBigEndian, double slope, double intercept, const std::byte* from, std::size_t count, float* to) {
    if (slope == 1.0 && intercept == 0.0) {
        for (std::size_t i = 0; i < count; ++i)
            to[i] = static_cast<float>(at<T>(from, i, isBigEndian));
        return;
    }
    for (std::size_t i = 0; i < count; ++i)
        to[i] = static_cast<float>(slope * static_cast<double>(at<T>(from, i, isBigEndian)) + intercept);
}

/// Bytes of a block in order, plain or unpacked on the way.
class Stream {
  public:
    Stream(const Samples& samples, std::uint64_t skip)
        : input_(samples.files->open(samples.file)), at_(samples.offset), isPacked_(samples.isPacked) {
        if (!isPacked_) {
            at_ += skip;
            return;
        }
        packed_.resize(kChunkBytes);
        if (inflateInit2(&zlib_, 15 + 32) != Z_OK) throw core::Error("zlib does not start", input_.where());
        isOpen_ = true;
        std::vector<std::byte> waste(static_cast<std::size_t>(std::min<std::uint64_t>(skip, kChunkBytes)));
        while (skip > 0) {
            const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(skip, waste.size()));
            read(waste.data(), part);
            skip -= part;
        }
    }
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
    ~Stream() {
        if (isOpen_) inflateEnd(&zlib_);
    }

    /// All of it, or core::Error.
    void read(std::byte* to, std::size_t count) {
        if (!isPacked_) {
            if (input_.readAt(at_, to, count) != count) throw ends();
            at_ += count;
            return;
        }
        zlib_.next_out = reinterpret_cast<Bytef*>(to);
        zlib_.avail_out = static_cast<uInt>(count);
        while (zlib_.avail_out > 0) {
            if (zlib_.avail_in == 0) {
                const std::size_t got = input_.readAt(at_, packed_.data(), packed_.size());
                if (got == 0) throw ends();
                at_ += got;
                zlib_.next_in = reinterpret_cast<Bytef*>(packed_.data());
                zlib_.avail_in = static_cast<uInt>(got);
            }
            const int code = inflate(&zlib_, Z_NO_FLUSH);
            if (code == Z_STREAM_END) {
                // gzip allows one member after another.
                if (zlib_.avail_out > 0 && inflateReset(&zlib_) != Z_OK) throw ends();
            } else if (code != Z_OK) {
                throw core::Error("its packed values are damaged", input_.where(), "copy or save the file again");
            }
        }
    }

  private:
    [[nodiscard]] core::Error ends() const {
        return core::Error("the file ends before the last value", input_.where(), "copy or save the file again");
    }

    Input input_;
    std::uint64_t at_;
    bool isPacked_, isOpen_ = false;
    z_stream zlib_{};
    std::vector<std::byte> packed_;
};

/// Bytes that are one value over and over, looked at piece by piece as far as they are.
bool holdsOneValue(const Samples& samples, std::uint64_t bytes) {
    const std::size_t each = bytesOf(samples.type);  // of which a piece has a whole number
    Stream stream(samples, samples.skip);
    std::vector<std::byte> piece(kChunkBytes), first(each);
    for (std::uint64_t at = 0; at < bytes;) {
        const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(bytes - at, piece.size()));
        stream.read(piece.data(), part);
        if (at == 0) std::copy_n(piece.begin(), each, first.begin());
        if (std::memcmp(piece.data(), first.data(), each) != 0 ||
            std::memcmp(piece.data() + each, piece.data(), part - each) != 0)
            return false;
        at += part;
    }
    return true;
}

void readSlices(const Samples& samples, int first, int count, const SlicePlace& place, const core::Progress& progress) {
    const std::size_t each = bytesOf(samples.type), most = kChunkBytes / each;
    const std::uint64_t perSlice =
        static_cast<std::uint64_t>(samples.size[0]) * static_cast<std::uint64_t>(samples.size[1]);
    Stream stream(samples, samples.skip + static_cast<std::uint64_t>(first) * perSlice * each);
    std::vector<std::byte> chunk(std::min<std::uint64_t>(perSlice, most) * each);
    for (int k = 0; k < count; ++k) {
        float* const to = place(first + k);
        for (std::uint64_t done = 0; done < perSlice;) {
            const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(perSlice - done, most));
            stream.read(chunk.data(), part * each);
            convert(samples.type, samples.isBigEndian, samples.slope, samples.intercept, chunk.data(), part, to + done);
            done += part;
        }
        core::report(progress, static_cast<double>(k + 1) / count);
    }
}

}  // namespace

std::size_t bytesOf(SampleType type) {
    switch (type) {
        case SampleType::u8:
        case SampleType::i8:
            return 1;
        case SampleType::u16:
        case SampleType::i16:
            return 2;
        case SampleType::u32:
        case SampleType::i32:
        case SampleType::f32:
            return 4;
        case SampleType::u64:
        case SampleType::i64:
        case SampleType::f64:
            return 8;
    }
    return 1;
}

void convert(SampleType type, bool isBigEndian, double slope, double intercept, const std::byte* from,
             std::size_t count, float* to) {
    const auto all = [&]<class T>(T) { convertAll<T>(isBigEndian, slope, intercept, from, count, to); };
    switch (type) {
        case SampleType::u8:
            return all(std::uint8_t{});
        case SampleType::i8:
            return all(std::int8_t{});
        case SampleType::u16:
            return all(std::uint16_t{});
        case SampleType::i16:
            return all(std::int16_t{});
        case SampleType::u32:
            return all(std::uint32_t{});
        case SampleType::i32:
            return all(std::int32_t{});
        case SampleType::u64:
            return all(std::uint64_t{});
        case SampleType::i64:
            return all(std::int64_t{});
        case SampleType::f32:
            return all(float{});
        case SampleType::f64:
            return all(double{});
    }
}

bool looksSwapped(SampleType type, bool isBigEndian, const std::byte* from, std::size_t count) {
    if ((type != SampleType::u16 && type != SampleType::i16) || count < 256) return false;
    // Steps between neighbours, in units of the spread: small for a picture, about 1.4 for what is no picture.
    const auto roughness = [&](bool isBig) {
        std::vector<float> row(count);
        convert(type, isBig, 1.0, 0.0, from, count, row.data());
        double mean = 0.0, spread = 0.0, step = 0.0;
        for (const float v : row)
            mean += static_cast<double>(v) / static_cast<double>(count);
        for (std::size_t i = 0; i < count; ++i) {
            spread += std::abs(static_cast<double>(row[i]) - mean);
            if (i > 0) step += std::abs(static_cast<double>(row[i]) - static_cast<double>(row[i - 1]));
        }
        return spread > 0.0 ? step / spread : 0.0;
    };
    const double told = roughness(isBigEndian), other = roughness(!isBigEndian);
    return other > 0.0 && told > 3.0 * other && told > 0.5;
}

void checkSize(const std::array<std::int64_t, 3>& size, const std::string& where) {
    double product = 1.0;
    for (const std::int64_t n : size) {
        if (n < 1 || n > 1000000)
            throw core::Error(fmt::format("its size of {} x {} x {} voxels cannot be", size[0], size[1], size[2]),
                              where, "the header is damaged: copy or save the file again");
        product *= static_cast<double>(n);
    }
    if (product > 1e12)
        throw core::Error(
            fmt::format("its header claims {} x {} x {} voxels, which no memory holds", size[0], size[1], size[2]),
            where, "the header is damaged: copy or save the file again")
            .as("scan-too-large");
}

void setSamples(Candidate& candidate, Samples samples) {
    checkSize({samples.size[0], samples.size[1], samples.size[2]}, candidate.where);
    candidate.grid.size = samples.size;
    candidate.series.slices = samples.size[2];
    candidate.series.bits = static_cast<int>(8 * bytesOf(samples.type));
    const std::uint64_t each = bytesOf(samples.type), needed = candidate.grid.count() * each;
    const std::uint64_t size = samples.files->entries()[samples.file].bytes;
    const std::uint64_t have = size > samples.offset ? size - samples.offset : 0;
    const std::string where = samples.files->where(samples.file);
    if (!samples.isPacked && have < needed) {
        candidate.problem =
            core::Error(fmt::format("its pixel data is truncated: {} of {} bytes are there", have, needed), where,
                        "copy or save the file again");
        return;
    }
    if (samples.isPacked && (needed / 1100 > have || have == 0)) {
        candidate.problem =
            core::Error(fmt::format("its {} packed bytes cannot hold the {} that its header claims", have, needed),
                        where, "copy or save the file again");
        return;
    }
    // What packs as tightly as hardly anything does may hold nothing: that is told before room is made for it.
    constexpr std::uint64_t kTightly = 500, kLarge = 1 << 26;
    if (samples.isPacked && needed > kLarge && needed / kTightly > have) {
        try {
            if (holdsOneValue(samples, needed)) {
                const std::string why = "all its voxels have the same value";
                candidate.problem = core::Error(why, where, "choose the file that shows teeth").as("scan-empty", {why});
            }
        } catch (const core::Error& e) {
            candidate.problem = e;
        }
        if (candidate.problem) return;
    }
    const std::uint64_t perSlice =
        static_cast<std::uint64_t>(samples.size[0]) * static_cast<std::uint64_t>(samples.size[1]);
    if (!samples.orderRemedy.empty() && !samples.isPacked && each == 2) {
        // The middle row of slices all over, so that air at the border does not decide alone.
        std::vector<std::byte> rows;
        Input input = samples.files->open(samples.file);
        for (int part = 1; part <= 8; ++part) {
            const std::uint64_t k = static_cast<std::uint64_t>(samples.size[2]) * static_cast<std::uint64_t>(part) / 9;
            const std::uint64_t first = k * perSlice + perSlice / 2;
            const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(4096, perSlice - perSlice / 2));
            const std::size_t old = rows.size();
            rows.resize(old + count * 2);
            rows.resize(old + input.readAt(samples.offset + first * 2, rows.data() + old, count * 2));
        }
        if (looksSwapped(samples.type, samples.isBigEndian, rows.data(), rows.size() / 2))
            candidate.problem = core::Error(
                fmt::format("its 16-bit values are {}-endian, not {}-endian as stated: read as stated they are noise",
                            samples.isBigEndian ? "little" : "big", samples.isBigEndian ? "big" : "little"),
                where, samples.orderRemedy);
    }
    const auto shared = std::make_shared<const Samples>(std::move(samples));
    candidate.slice = [shared](int k, float* to) { readSlices(*shared, k, 1, [to](int) { return to; }, {}); };
    candidate.load = [shared](int first, int count, const SlicePlace& place, const core::Progress& progress) {
        readSlices(*shared, first, count, place, progress);
    };
}

}  // namespace handpiece::volume
