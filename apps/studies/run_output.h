// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a run leaves behind: trace.csv, curves, and the folder they lie in.

#include <fmt/format.h>
#include <filesystem>
#include <string>
#include <vector>

#include "handpiece/app/report/plot.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "studies/csv.h"

namespace handpiece::studies {

/// The files of one run: all of them, or none. Undoes what it wrote unless keep() was called.
class Outputs {
  public:
    explicit Outputs(const std::filesystem::path& folder);
    ~Outputs();
    Outputs(const Outputs&) = delete;
    Outputs& operator=(const Outputs&) = delete;

    [[nodiscard]] std::filesystem::path path(const char* name) const { return folder_ / name; }
    void wrote(const char* name) { written_.push_back(path(name)); }
    void write(const char* name, const std::string& text);
    void keep() { kept_ = true; }

  private:
    std::filesystem::path folder_;
    std::vector<std::filesystem::path> written_;
    bool existed_ = false, kept_ = false;
};

/// Curves of a run of any length in bounded memory: the least and the greatest of each of many equal times.
class Curve {
  public:
    explicit Curve(double durationS) : perBucketS_(durationS / kBuckets) {}
    void take(double t, double y) {
        const auto bucket = static_cast<std::int64_t>(perBucketS_ > 0.0 ? t / perBucketS_ : 0.0);
        if (bucket != bucket_) flush();
        bucket_ = bucket;
        if (count_++ == 0) low_ = high_ = {t, y};
        if (y < low_.y) low_ = {t, y};
        if (y > high_.y) high_ = {t, y};
    }
    [[nodiscard]] report::Series series(std::string name) {
        flush();
        report::Series s;
        s.name = std::move(name);
        s.x = x_;
        s.y = y_;
        return s;
    }

  private:
    struct Point {
        double t = 0.0, y = 0.0;
    };
    static constexpr double kBuckets = 4000.0;
    void add(const Point& p) {
        x_.push_back(p.t);
        y_.push_back(p.y);
    }
    void flush() {
        if (count_ == 0) return;
        const bool lowFirst = low_.t <= high_.t;
        add(lowFirst ? low_ : high_);
        if (low_.t != high_.t) add(lowFirst ? high_ : low_);
        count_ = 0;
    }
    double perBucketS_;
    std::int64_t bucket_ = 0;
    std::size_t count_ = 0;
    Point low_, high_;
    std::vector<double> x_, y_;
};

/// trace.csv and the curves of a run.
class RunTrace {
  public:
    RunTrace(const std::filesystem::path& file, double durationS);
    void take(const messages::HapticSample& sample);
    /// The trace takes its place, the plots are written beside it. `cut`: with rotor speed and removed volume.
    void finish(Outputs& outputs, double deviceLimitN, bool cut);

  private:
    TextWriter file_;
    fmt::memory_buffer buffer_;
    Curve depth_, force_, applied_, speed_[3], rotor_, feed_;
    std::vector<Curve> removed_;
};

}  // namespace handpiece::studies
