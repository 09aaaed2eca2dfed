// SPDX-License-Identifier: Apache-2.0
#include "python/samples.h"

#include <cmath>
#include <limits>

namespace handpiece::python {
namespace {

/// Puts views of members into a dictionary.
template <class Row>
class Columns {
  public:
    explicit Columns(std::shared_ptr<const std::vector<Row>> rows) : rows_(*rows), owner_(keeperOf(std::move(rows))) {}

    template <class T>
    void add(const char* name, const T Row::*member) {
        all_[name] = columnOf(rows_, &(first().*member), 1, owner_);
    }
    template <class T, std::size_t N>
    void add(const char* name, const std::array<T, N> Row::*member) {
        all_[name] = columnOf(rows_, (first().*member).data(), N, owner_);
    }
    [[nodiscard]] py::dict& all() { return all_; }

  private:
    [[nodiscard]] const Row& first() const {
        static const Row none{};
        return rows_.empty() ? none : rows_.front();
    }
    const std::vector<Row>& rows_;
    py::object owner_;
    py::dict all_;
};

}  // namespace

py::dict samplesOf(std::shared_ptr<const std::vector<messages::HapticSample>> samples) {
    using S = messages::HapticSample;
    Columns<S> columns(std::move(samples));
    columns.add("tick", &S::tick);
    columns.add("time_s", &S::timeS);
    columns.add("position_mm", &S::positionMm);
    columns.add("orientation", &S::orientation);
    columns.add("velocity_mm_s", &S::velocityMmS);
    columns.add("force_n", &S::forceN);
    columns.add("torque_nmm", &S::torqueNmm);
    columns.add("depth_mm", &S::depthMm);
    columns.add("true_position_mm", &S::truePositionMm);
    columns.add("proxy_position_mm", &S::proxyPositionMm);
    columns.add("proxy_orientation", &S::proxyOrientation);
    columns.add("applied_force_n", &S::appliedForceN);
    columns.add("contact_area_mm2", &S::contactAreaMm2);
    columns.add("contact_point_mm", &S::contactPointMm);
    columns.add("contact_normal", &S::contactNormal);
    columns.add("tissue", &S::tissue);
    columns.add("flags", &S::flags);
    columns.add("pedal", &S::pedal);
    columns.add("speed_rpm", &S::speedRpm);
    columns.add("load_torque_nmm", &S::loadTorqueNmm);
    columns.add("feed_mm_s", &S::feedMmS);
    columns.add("removed_mm3", &S::removedMm3);
    columns.add("work_us", &S::workUs);
    return columns.all();
}

py::dict samplesOf(std::shared_ptr<const std::vector<session::Record>> records, double rateHz) {
    using R = session::Record;
    std::vector<double> time, position, orientation, pedal;
    for (const R& record : *records) {
        const session::Inputs in = session::inputsOf(record);
        time.push_back(static_cast<double>(record.tick) * (1.0 / rateHz));  // as the loop does
        position.insert(position.end(), in.positionMm.begin(), in.positionMm.end());
        orientation.insert(orientation.end(), in.orientation.begin(), in.orientation.end());
        pedal.push_back(in.pedal);
    }
    const auto n = static_cast<py::ssize_t>(records->size());
    Columns<R> columns(std::move(records));
    columns.add("tick", &R::tick);
    columns.all()["time_s"] = arrayOf(std::move(time), {n});
    columns.all()["position_mm"] = arrayOf(std::move(position), {n, 3});
    columns.all()["orientation"] = arrayOf(std::move(orientation), {n, 4});
    columns.add("velocity_mm_s", &R::velocityMmS);
    columns.add("force_n", &R::forceN);
    columns.add("torque_nmm", &R::torqueNmm);
    columns.add("depth_mm", &R::depthMm);
    columns.add("tissue", &R::tissue);
    columns.add("tooth", &R::tooth);
    columns.add("flags", &R::flags);
    columns.all()["pedal"] = arrayOf(std::move(pedal), {n});
    columns.add("buttons", &R::buttons);
    columns.add("speed_rpm", &R::speedRpm);
    columns.add("load_torque_nmm", &R::loadTorqueNmm);
    columns.add("feed_mm_s", &R::feedMmS);
    columns.add("removed_mm3", &R::removedMm3);
    columns.add("removed_others_mm3", &R::removedOthersMm3);
    return columns.all();
}

}  // namespace handpiece::python
