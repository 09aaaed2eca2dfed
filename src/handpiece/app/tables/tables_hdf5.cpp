// SPDX-License-Identifier: Apache-2.0
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include "handpiece/app/tables/tables.h"
#include "handpiece/base/core/error.h"

namespace handpiece::tables {
namespace {

/// The library keeps its state in globals: Debian's is built without threads.
std::mutex& oneAtATime() {
    static std::mutex mutex;
    return mutex;
}

/// Closed by what it is.
class Held {
  public:
    Held(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
        if (id_ < 0) throw core::Error("it cannot be written", what, "look for room on the disk, and try again");
    }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;
    ~Held() { close_(id_); }
    operator hid_t() const { return id_; }

  private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

void require(herr_t done, const std::string& what) {
    if (done < 0) throw core::Error("it cannot be written", what, "look for room on the disk, and try again");
}

void setText(hid_t of, const char* name, const std::string& text) {
    const Held type(H5Tcopy(H5T_C_S1), H5Tclose, name);
    require(H5Tset_size(type, std::max<std::size_t>(text.size(), 1)), name);
    require(H5Tset_strpad(type, H5T_STR_NULLPAD), name);
    require(H5Tset_cset(type, H5T_CSET_UTF8), name);
    const Held space(H5Screate(H5S_SCALAR), H5Sclose, name);
    const Held attribute(H5Acreate2(of, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
    const std::string padded = text.empty() ? std::string(1, '\0') : text;
    require(H5Awrite(attribute, type, padded.data()), name);
}

/// Without times, so that the same tables give the same bytes.
void write(hid_t group, const Column& column, hid_t type, std::size_t rows, const void* values) {
    const hsize_t size = rows;
    const Held space(H5Screate_simple(1, &size, nullptr), H5Sclose, column.name);
    const Held creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, column.name);
    require(H5Pset_obj_track_times(creation, false), column.name);
    const Held dataset(H5Dcreate2(group, column.name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                       H5Dclose, column.name);
    if (rows > 0) require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), column.name);
    if (!column.unit.empty()) setText(dataset, "unit", column.unit);
}

void write(hid_t group, const Column& column, std::size_t rows) {
    const std::size_t has = std::visit([](const auto& values) { return values.size(); }, column.values);
    if (has != rows)
        throw core::Error("its columns are of unequal length", column.name, "give every row a value in each column");
    if (const auto* texts = std::get_if<Texts>(&column.values)) {
        std::size_t longest = 1;
        for (const std::string& text : *texts)
            longest = std::max(longest, text.size());
        std::string all(longest * rows, '\0');
        for (std::size_t i = 0; i < rows; ++i)
            std::copy((*texts)[i].begin(), (*texts)[i].end(), all.begin() + static_cast<std::ptrdiff_t>(i * longest));
        const Held type(H5Tcopy(H5T_C_S1), H5Tclose, column.name);
        require(H5Tset_size(type, longest), column.name);
        require(H5Tset_strpad(type, H5T_STR_NULLPAD), column.name);
        require(H5Tset_cset(type, H5T_CSET_UTF8), column.name);
        write(group, column, type, rows, all.data());
    } else if (const auto* whole = std::get_if<Whole>(&column.values)) {
        write(group, column, H5T_STD_I64LE, rows, whole->data());
    } else {
        std::vector<double> all;
        for (const std::optional<double>& value : std::get<Numbers>(column.values))
            all.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
        write(group, column, H5T_IEEE_F64LE, rows, all.data());
    }
}

}  // namespace

void writeHdf5(std::span<const Table> tables, const std::filesystem::path& path) {
    const std::lock_guard lock(oneAtATime());
    // What goes wrong is told once, by us.
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const Held file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose, path.string());
    for (const Table& table : tables) {
        const Held creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, table.name);
        require(H5Pset_obj_track_times(creation, false), table.name);
        const Held group(H5Gcreate2(file, table.name.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose,
                         table.name);
        setText(group, "rows", std::to_string(table.rows()));
        for (const Column& column : table.columns)
            write(group, column, table.rows());
    }
    require(H5Fflush(file, H5F_SCOPE_LOCAL), path.string());
}

}  // namespace handpiece::tables
