// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Small scans, and DICOM files made byte by byte by somebody who knows nothing of the reader.

#include <zlib.h>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "handpiece/scan/volume/read_scan.h"
#include "handpiece/scan/volume/write_scan.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::test {

/// Something smooth with a little noise, not the same in any two directions; whole numbers from `low` on.
inline volume::Volume sampleVolume(std::array<int, 3> size = {23, 17, 9}, double low = 0, double span = 4000) {
    volume::Volume v;
    v.grid.size = size;
    v.grid.spacingMm = {0.25, 0.2, 0.4};
    v.grid.originMm = {-12.5, 31.0, 7.25};
    v.values.resize(v.grid.count());
    std::mt19937_64 generator(7);
    for (int k = 0; k < size[2]; ++k)
        for (int j = 0; j < size[1]; ++j)
            for (int i = 0; i < size[0]; ++i) {
                const double wave =
                    0.5 + 0.2 * std::sin(0.3 * i) + 0.15 * std::cos(0.4 * j + 0.2 * k) + 0.1 * k / size[2];
                v.values[v.grid.index(i, j, k)] =
                    static_cast<float>(std::round(low + span * (wave + 0.02 * uniform(generator, -1, 1))));
            }
    return v;
}

/// Blobs where the axes begin and on each of them; right-handed in columns, rows, slices.
inline constexpr std::array<float, 4> kLevels{60, 120, 180, 240};

inline volume::Volume chiralPhantom() {
    volume::Volume v;
    v.grid.size = {24, 18, 10};
    v.grid.spacingMm = core::Vec3::Constant(0.2);
    v.values.assign(v.grid.count(), 0.0f);
    const std::array<std::array<int, 3>, 4> begins{{{4, 4, 1}, {16, 4, 1}, {4, 12, 1}, {4, 4, 7}}};
    for (std::size_t blob = 0; blob < 4; ++blob)
        for (int k = 0; k < 2; ++k)
            for (int j = 0; j < 4; ++j)
                for (int i = 0; i < 4; ++i)
                    v.values[v.grid.index(begins[blob][0] + i, begins[blob][1] + j, begins[blob][2] + k)] =
                        kLevels[blob];
    return v;
}

/// +1: as it was made; -1: its mirror image; 0: blobs are missing.
inline int sideOf(const volume::Volume& v) {
    std::array<core::Vec3, 4> sum;
    std::array<int, 4> count{};
    sum.fill(core::Vec3::Zero());
    for (int k = 0; k < v.grid.size[2]; ++k)
        for (int j = 0; j < v.grid.size[1]; ++j)
            for (int i = 0; i < v.grid.size[0]; ++i)
                for (std::size_t blob = 0; blob < 4; ++blob)
                    if (std::abs(v.values[v.grid.index(i, j, k)] - kLevels[blob]) < 20.0f) {
                        sum[blob] += v.grid.toMm(core::Vec3(i, j, k));
                        ++count[blob];
                    }
    for (std::size_t blob = 0; blob < 4; ++blob) {
        if (count[blob] == 0) return 0;
        sum[blob] /= count[blob];
    }
    core::Mat3 axes;
    axes << sum[1] - sum[0], sum[2] - sum[0], sum[3] - sum[0];
    return axes.determinant() > 0.0 ? 1 : -1;
}

/// Of an oblique scanner: rows and columns along no axis.
inline core::Mat3 obliqueAxes() {
    return core::Quat(Eigen::AngleAxisd(0.4, core::Vec3(1, 2, -0.5).normalized())).toRotationMatrix();
}

inline void writeBytes(const std::filesystem::path& file, const std::string& bytes) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
}
inline std::string readBytes(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
inline void cutFile(const std::filesystem::path& file, double share) {
    const auto size = static_cast<double>(std::filesystem::file_size(file));
    std::filesystem::resize_file(file, static_cast<std::uintmax_t>(size * share));
}

template <class T>
std::string numbers(const std::vector<T>& values, bool isBigEndian = false) {
    std::string out;
    for (const T v : values) {
        char raw[sizeof(T)];
        std::memcpy(raw, &v, sizeof v);
        for (std::size_t i = 0; i < sizeof(T); ++i)
            out += raw[isBigEndian ? sizeof(T) - 1 - i : i];
    }
    return out;
}

inline std::string zipped(const std::string& bytes, bool isGzip) {
    std::string out(bytes.size() + 1000, '\0');
    z_stream z{};
    deflateInit2(&z, 6, Z_DEFLATED, isGzip ? 31 : 15, 8, Z_DEFAULT_STRATEGY);
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    z.avail_in = static_cast<uInt>(bytes.size());
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    deflate(&z, Z_FINISH);
    out.resize(z.total_out);
    deflateEnd(&z);
    return out;
}

/// Largest difference of values; infinite where the sizes differ.
inline double difference(const volume::Volume& a, const volume::Volume& b) {
    if (a.values.size() != b.values.size()) return INFINITY;
    double most = 0.0;
    for (std::size_t i = 0; i < a.values.size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(a.values[i]) - static_cast<double>(b.values[i])));
    return most;
}

/// One DICOM slice, written after the standard (PS3.5), element by element.
struct DicomMaker {
    int rows = 6, columns = 5, frames = 1;
    std::string series = "1.2.3", modality = "CT", sopClass = "1.2.840.10008.5.1.4.1.1.2", photometric = "MONOCHROME2";
    std::string position = "0\\0\\0", orientation = "1\\0\\0\\0\\1\\0", spacing = "0.5\\0.25";
    std::string slope = "1", intercept = "0", instance = "1", burnedIn, between;
    std::string syntax = "1.2.840.10008.1.2.1";
    int bits = 16, stored = 16, isSigned = 1, samples = 1;
    std::vector<std::int16_t> pixels;
    bool hasPreamble = true;
    std::string enhanced;  ///< sequences of an enhanced file, ready-made

    [[nodiscard]] std::string number(std::uint32_t v, int bytes, bool isBig) const {
        std::string out;
        for (int i = 0; i < bytes; ++i)
            out += static_cast<char>(v >> 8 * (isBig ? bytes - 1 - i : i) & 0xff);
        return out;
    }
    [[nodiscard]] std::string element(std::uint32_t group, std::uint32_t number_, const std::string& vr,
                                      std::string value, bool isMeta = false) const {
        const bool isBig = !isMeta && syntax == "1.2.840.10008.1.2.2";
        const bool isImplicit = !isMeta && syntax == "1.2.840.10008.1.2";
        if (value.size() % 2 != 0) value += vr == "UI" || vr == "OB" ? '\0' : ' ';
        std::string out = number(group, 2, isBig) + number(number_, 2, isBig);
        const auto length = static_cast<std::uint32_t>(value.size());
        if (isImplicit)
            out += number(length, 4, isBig);
        else if (vr == "OW" || vr == "OB" || vr == "SQ" || vr == "UN")
            out += vr + std::string(2, '\0') + number(length, 4, isBig);
        else
            out += vr + number(length, 2, isBig);
        return out + value;
    }
    [[nodiscard]] std::string us(std::uint32_t element_, int value) const {
        return element(0x28, element_, "US",
                       number(static_cast<std::uint32_t>(value), 2, syntax == "1.2.840.10008.1.2.2"));
    }
    [[nodiscard]] std::string bytes() const {
        std::string out = hasPreamble ? std::string(128, '\0') + "DICM" : "";
        if (hasPreamble) out += element(2, 0x10, "UI", syntax, true);
        const auto text = [&](std::uint32_t g, std::uint32_t e, const char* vr, const std::string& value) {
            if (!value.empty()) out += element(g, e, vr, value);
        };
        text(8, 0x16, "UI", sopClass);
        text(8, 0x60, "CS", modality);
        text(0x10, 0x10, "PN", "Doe^Jane");
        text(0x10, 0x20, "LO", "SECRET-4711");
        text(0x18, 0x88, "DS", between);
        text(0x20, 0xe, "UI", series);
        text(0x20, 0x13, "IS", instance);
        text(0x20, 0x32, "DS", position);
        text(0x20, 0x37, "DS", orientation);
        out += us(2, samples);
        text(0x28, 4, "CS", photometric);
        if (frames > 1) text(0x28, 8, "IS", std::to_string(frames));
        out += us(0x10, rows) + us(0x11, columns);
        text(0x28, 0x30, "DS", spacing);
        out += us(0x100, bits) + us(0x101, stored) + us(0x102, stored - 1) + us(0x103, isSigned);
        text(0x28, 0x301, "CS", burnedIn);
        text(0x28, 0x1052, "DS", intercept);
        text(0x28, 0x1053, "DS", slope);
        out += enhanced;
        return out + element(0x7fe0, 0x10, "OW", numbers(pixels, syntax == "1.2.840.10008.1.2.2"));
    }
};

/// `count` slices of 5 x 6, 0.25 x 0.5 mm, 1 mm apart; the value of voxel (i, j, k) is 100 k + 10 j + i.
inline std::vector<DicomMaker> dicomSeries(int count) {
    std::vector<DicomMaker> out;
    for (int k = 0; k < count; ++k) {
        DicomMaker d;
        d.position = "-3\\4\\" + std::to_string(10 + k);
        d.instance = std::to_string(k + 1);
        for (int j = 0; j < d.rows; ++j)
            for (int i = 0; i < d.columns; ++i)
                d.pixels.push_back(static_cast<std::int16_t>(100 * k + 10 * j + i));
        out.push_back(d);
    }
    return out;
}
inline void writeSeries(const std::vector<DicomMaker>& series, const std::filesystem::path& folder) {
    for (std::size_t k = 0; k < series.size(); ++k)
        writeBytes(folder / ("IM" + std::to_string(k + 1)), series[k].bytes());
}

/// What the process' memory grows by at most while `work` runs [bytes].
template <class Work>
std::uint64_t peakGrowth(const Work& work) {
    const auto field = [](const std::string& name) {
        std::ifstream status("/proc/self/status");
        for (std::string line; std::getline(status, line);)
            if (line.rfind(name, 0) == 0) return 1024 * std::stoull(line.substr(name.size()));
        return 0ull;
    };
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak begins anew
    const std::uint64_t before = field("VmRSS:");
    work();
    const std::uint64_t most = field("VmHWM:");
    return most > before ? most - before : 0;
}

}  // namespace handpiece::test
