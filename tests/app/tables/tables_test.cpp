// SPDX-License-Identifier: Apache-2.0
// Tables as other programs read them: HDF5 by its own library, CSV by its bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>

#include "handpiece/app/tables/tables.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/package.h"
#include "support/error_of.h"

namespace handpiece::tables::tables_test {
namespace {

using testing::HasSubstr;

std::vector<Table> sample() {
    return {{"attempts",
             {{"person", "", Texts{"s1", "=cmd()", "\xe6\x84\x9b, \"q\""}},
              {"finished_ms", "ms since 1970", Whole{1, -2, 4'000'000'000'000}},
              {"score", "points", Numbers{0.1 + 0.2, std::nullopt, -1.0}}}},
            {"none", {{"person", "", Texts{}}}}};
}

TEST(TablesTest, CsvIsOfRfc4180AndNoFormula) {
    EXPECT_EQ(toCsv(sample()[0]),
              "person,finished_ms,score\r\ns1,1,0.30000000000000004\r\n'=cmd(),-2,\r\n\"\xe6\x84\x9b, "
              "\"\"q\"\"\",4000000000000,-1\r\n");
    EXPECT_EQ(toCsv(sample()[1]), "person\r\n");
}

TEST(TablesTest, Hdf5IsReadBackByItsLibraryAndTheSameBytesComeTwice) {
    const core::PrivateFolder folder;
    const std::filesystem::path file = folder.path() / "results.h5";
    writeHdf5(sample(), file);
    const hid_t open = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    ASSERT_GE(open, 0);
    const auto dataset = [&](const char* name) { return H5Dopen2(open, name, H5P_DEFAULT); };
    const hid_t scores = dataset("/attempts/score"), when = dataset("/attempts/finished_ms"),
                people = dataset("/attempts/person"), none = dataset("/none/person");
    double score[3] = {};
    ASSERT_GE(H5Dread(scores, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, score), 0);
    EXPECT_EQ(score[0], 0.1 + 0.2);
    EXPECT_TRUE(std::isnan(score[1]));
    std::int64_t moments[3] = {};
    ASSERT_GE(H5Dread(when, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, moments), 0);
    EXPECT_EQ(moments[2], 4'000'000'000'000);
    const hid_t type = H5Dget_type(people);
    const std::size_t size = H5Tget_size(type);
    std::string names(3 * size, 'x');
    ASSERT_GE(H5Dread(people, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, names.data()), 0);
    EXPECT_STREQ(names.substr(2 * size).c_str(), "\xe6\x84\x9b, \"q\"");
    EXPECT_EQ(H5Aexists(scores, "unit"), 1);
    EXPECT_EQ(H5Aexists(people, "unit"), 0);
    const hid_t space = H5Dget_space(none);
    EXPECT_EQ(H5Sget_simple_extent_npoints(space), 0);
    H5Sclose(space), H5Tclose(type);
    for (const hid_t one : {scores, when, people, none})
        H5Dclose(one);
    H5Fclose(open);
    writeHdf5(sample(), folder.path() / "again.h5");
    EXPECT_EQ(core::readFile(file), core::readFile(folder.path() / "again.h5"));
    std::vector<Table> uneven = sample();
    std::get<Whole>(uneven[0].columns[1].values).pop_back();
    EXPECT_THAT(test::errorFrom([&] { writeHdf5(uneven, folder.path() / "no.h5"); })->problem(),
                HasSubstr("unequal length"));
    EXPECT_TRUE(test::errorFrom([&] { writeHdf5(sample(), folder.path() / "nowhere" / "no.h5"); }));
}

TEST(TablesTest, ZipHasAllOfThem) {
    const std::string zip = toZip(sample());
    const cases::PackageFiles files = cases::readPackage(std::as_bytes(std::span(zip)), "zip");
    ASSERT_EQ(files.size(), 3u);
    const std::vector<std::byte>& csv = files.at("attempts.csv");
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(csv.data()), csv.size()), toCsv(sample()[0]));
    EXPECT_GT(files.at("results.h5").size(), 1000u);
}

}  // namespace
}  // namespace handpiece::tables::tables_test
