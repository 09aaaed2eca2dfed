// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::instrument::catalogue_test {
namespace {

using test::errorOf;
using testing::AllOf;
using testing::HasSubstr;

TEST(Catalogue, HasEachBurOnceUnderEachOfItsNames) {
    std::set<std::string> names, isoNumbers;
    std::set<Shape> shapesSeen;
    for (const CatalogueEntry& e : catalogue()) {
        EXPECT_TRUE(names.insert(e.name).second) << e.name;
        EXPECT_EQ(e.isoNumber.size(), 15u) << e.name;
        EXPECT_EQ(findBur(e.name), &e);
        EXPECT_EQ(findBur(e.isoNumber)->isoNumber, e.isoNumber);
        EXPECT_EQ(findBur(e.usName)->usName, e.usName) << e.usName;
        const Bur bur = makeBur(e.name);
        EXPECT_NEAR(2.0 * bur.maxRadiusMm(), e.diameterMm, 1e-9) << e.name;
        EXPECT_NEAR(bur.lengthMm(), e.lengthMm, 1e-9) << e.name;
        EXPECT_EQ(std::stod(e.isoNumber.substr(12)), std::round(10.0 * e.diameterMm)) << e.name;
        EXPECT_EQ(abilityByName(e.cuttingParameters).name, e.cuttingParameters);
        EXPECT_FALSE(e.description.empty()) << e.name;
        shapesSeen.insert(e.shape);
        isoNumbers.insert(e.isoNumber);
    }
    EXPECT_GE(names.size(), 24u);
    EXPECT_EQ(shapesSeen.size(), shapes().size()) << "every shape is there";
    for (const char* name :
         {"round-1/4", "round-1/2", "round-1", "round-2", "round-3", "round-4", "round-5", "round-6", "round-7",
          "round-8",   "245",       "330",     "331L",    "556",     "557",     "558",     "169",     "169L",
          "170",       "33.5",      "34",      "35",      "878-012", "862-012", "909-040", "856-016"})
        EXPECT_EQ(names.count(name), 1u) << name;
}

TEST(Catalogue, BuildsTheIsoNumberFromItsGroups) {
    EXPECT_EQ(findBur("round-4")->isoNumber, "500314001001014");
    EXPECT_EQ(findBur("8856-016")->isoNumber, "806314198514016");
    EXPECT_EQ(findBur("500 314 001 001 014")->name, "round-4");
    EXPECT_EQ(findBur("33 1/2")->name, "33.5");
    EXPECT_EQ(findBur(""), nullptr);
    EXPECT_EQ(makeBur("500314001001014").name(), "round-4");
}

TEST(Catalogue, CoarserGritCutsFaster) {
    const auto cutting = [](const char* name) { return makeInstrument(name).cuttingParameters.cutting; };
    EXPECT_LT(cutting("8856-016"), cutting("856-016"));
    EXPECT_LT(cutting("856-016"), cutting("6856-016"));
    EXPECT_EQ(cutting("paper"), 1.0);
    EXPECT_EQ(makeInstrument("round:1.0x1.0").cuttingParameters.name, "diamond-medium");
    EXPECT_EQ(makeInstrument("330").cuttingParameters.name, "carbide");
    EXPECT_EQ(makeInstrument("330", {}, "steel").cuttingParameters.name, "steel");
    EXPECT_EQ(makeInstrument("557").cuttingParameters.name, "carbide-cross-cut");
    EXPECT_EQ(abilityByName("diamond-medium").loadCapN, 1.5);
    EXPECT_EQ(abilityByName("diamond-coarse").loadCapN, 3.0);
    for (const BurFile::NamedCuttingParameters& a : builtInBurs().abilities) {
        validate(a.cuttingParameters);
        EXPECT_FALSE(a.source.empty()) << a.cuttingParameters.name;
    }
}

class OwnBurs : public testing::Test {
  protected:
    [[nodiscard]] std::filesystem::path file(const std::string& text) const {
        core::writeFile(folder_.path() / "mine.toml", "format = 1\n" + text);
        return folder_.path() / "mine.toml";
    }
    [[nodiscard]] std::filesystem::path folder() const { return folder_.path(); }

  private:
    test::TemporaryFolder folder_;
};

TEST_F(OwnBurs, AbilitiesShapesAndMeshesOfOnesOwn) {
    geometry::writeStl(folder() / "scanned.stl", makeBur("round-4").mesh());
    const auto mine = file(R"(
[ability.blunt]
cutting = 0.1
edges = 8
[ability.carbide]
cutting = 2.0
[[bur]]
name = "my-cone"
shape = "taper-flat"
diameter_mm = 1.2
length_mm = 5
ability = "blunt"
[[bur]]
name = "scan"
stl = "scanned.stl"
ability = "steel"
[[bur]]
name = "330"
shape = "round"
diameter_mm = 3
length_mm = 3
)");
    const Instrument cone = makeInstrument("my-cone", mine);
    EXPECT_EQ(cone.cuttingParameters.name, "blunt");
    EXPECT_EQ(cone.cuttingParameters.cutting, 0.1);
    EXPECT_EQ(cone.cuttingParameters.edges, 8);
    EXPECT_EQ(cone.cuttingParameters.loadCapN, 1.5) << "what is left out is as the reference";
    EXPECT_NEAR(cone.bur->maxRadiusMm(), 0.6, 1e-12);
    const Instrument scan = makeInstrument("scan", mine);
    EXPECT_EQ(scan.cuttingParameters.name, "steel");
    EXPECT_NEAR(scan.bur->maxRadiusMm(), 0.7, 0.02);
    EXPECT_NEAR(makeInstrument("330", mine).bur->maxRadiusMm(), 1.5, 1e-12) << "one's own goes first";
    EXPECT_EQ(makeInstrument("round-4", mine).cuttingParameters.cutting, 2.0) << "abilities too";
    EXPECT_EQ(makeInstrument((folder() / "scanned.stl").string(), mine, "blunt").cuttingParameters.name, "blunt");
    EXPECT_EQ(makeInstrument((folder() / "scanned.stl").string()).cuttingParameters.name, "diamond-medium");
}

TEST_F(OwnBurs, AWrongFileIsToldWithItsLine) {
    const struct {
        const char *text, *one, *two;
    } cases[] = {
        {"[ability.a]\ncutting = -1", "cutting of \"a\" is -1", "line 2"},
        {"[ability.a]\ncutting = 0", "cutting of \"a\" is 0", "line 2"},
        {"[ability.a]\nload_cap_n = inf", "inf", "line 3"},
        {"[ability.a]\nedges = 0", "edges of \"a\" are 0", "line 2"},
        {"[ability.a]\nedges = 2.5", "wrong type", "line 3"},
        {"[ability.a]\nsharpness = 2", "\"sharpness\"", "load_cap_n"},
        {"[[bur]]\nshape = \"round\"", "without a name", "line 2"},
        {"[[bur]]\nname = \"x\"", "lacks its shape", "line 2"},
        {"[[bur]]\nname = \"x\"\nshape = \"banana\"\ndiameter_mm = 1\nlength_mm = 1", "banana", "cylinder-round"},
        {"[[bur]]\nname = \"x\"\nshape = \"round\"\ndiameter_mm = 1\nlength_mm = 0", "0 mm", "line 2"},
        {"[[bur]]\nname = \"x\"\nshape = \"round\"\ndiameter_mm = -1\nlength_mm = 1", "diameter", "line 2"},
        {"[[bur]]\nname = \"x\"\nstl = \"a.stl\"\nshape = \"round\"", "both", "line 4"},
        {"[[bur]]\nname = \"x\"\nstl = \"a.stl\"\nability = \"magic\"", "\"magic\"", "diamond-medium"},
        {"[[bur]]\nname = \"x\"\nstl = \"a.stl\"\n[[bur]]\nname = \"x\"\nstl = \"a.stl\"", "two burs", "line 5"},
        {"[[bur]]\nname = \"x\"\nshape = \"round\"\ndiameter_mm = 1\nlength_mm = 1\nshank = \"31\"", "\"31\"",
         "three digits"},
        {"bur = 3", "list of tables", "line 2"},
        {"burs = []", "\"burs\"", "line 2"},
    };
    for (const auto& c : cases) {
        const std::string what = errorOf([&] { (void)readAbilities(file(c.text)); });
        EXPECT_THAT(what, AllOf(HasSubstr(c.one), HasSubstr(c.two), HasSubstr("mine.toml"))) << c.text;
    }
    EXPECT_THAT(errorOf([] { (void)parseAbilities("", "x"); }), HasSubstr("format = 1"));
    EXPECT_THAT(errorOf([] { (void)parseAbilities("format = 9", "x"); }), HasSubstr("newer"));
    EXPECT_THAT(errorOf([] { (void)readAbilities("/nowhere/a.toml"); }), HasSubstr("no such file"));
    EXPECT_THAT(errorOf([&] { (void)makeInstrument("x", file("[[bur]]\nname = \"x\"\nstl = \"gone.stl\"")); }),
                HasSubstr("gone.stl"));
}

TEST_F(OwnBurs, WhatThereIsNotIsToldInOneLine) {
    EXPECT_THAT(errorOf([] { (void)makeInstrument("unobtainium"); }),
                AllOf(HasSubstr("unobtainium"), HasSubstr("330")));
    EXPECT_THAT(errorOf([] { (void)makeInstrument("330", {}, "magic"); }),
                AllOf(HasSubstr("magic"), HasSubstr("carbide")));
    EXPECT_THAT(errorOf([] { (void)makeInstrument("round:1x0"); }), HasSubstr("0 mm"));
    EXPECT_THAT(errorOf([] { (void)makeInstrument("cylinder-flat:1.0x0.0"); }), HasSubstr("0 mm"));
    CuttingParameters a;
    a.chipMm = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(errorOf([&] { validate(a); }), HasSubstr("chip_mm"));
}

}  // namespace
}  // namespace handpiece::instrument::catalogue_test
