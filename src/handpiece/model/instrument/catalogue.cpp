// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"

namespace handpiece::instrument {

extern const char* const kBursToml;  // data/burs.toml

namespace {

namespace fs = std::filesystem;
using config::Table;

constexpr std::int64_t kFormatVersion = 1;
constexpr const char* kRemedy = "see docs/burs.md";
constexpr std::string_view kDefaultCuttingParameters = "diamond-medium";

struct Range {
    std::string_view key;
    double CuttingParameters::*value;
    double above, most;  ///< the value is greater than `above` and at most `most`
};
// More than these is a slip of the unit, not a bur.
constexpr Range kRanges[] = {
    {"cutting", &CuttingParameters::cutting, 0.0, 100.0},
    {"load_cap_n", &CuttingParameters::loadCapN, 0.0, 100.0},
    {"friction", &CuttingParameters::frictionCutting, 0.0, 5.0},
    {"chip_mm", &CuttingParameters::chipMm, 0.0, 0.1},
    {"centre_radius", &CuttingParameters::centreRadius, 0.0, 1.0},
};
constexpr int kMaxEdges = 200;

std::string withoutSpaces(std::string_view text) {
    std::string out(text);
    out.erase(std::remove(out.begin(), out.end(), ' '), out.end());
    return out;
}

std::string problemOf(const CuttingParameters& a) {
    for (const Range& r : kRanges)
        if (const double v = a.*r.value; !(v > r.above && v <= r.most))
            return fmt::format("{} of \"{}\" is {}: it must be above {} and at most {}", r.key, a.name, v, r.above,
                               r.most);
    if (a.edges < 1 || a.edges > kMaxEdges)
        return fmt::format("edges of \"{}\" are {}: they must be 1 to {}", a.name, a.edges, kMaxEdges);
    return {};
}

BurFile::NamedCuttingParameters readCuttingParameters(const std::string& name, const Table& row) {
    row.allowOnly({"description", "source", "cutting", "load_cap_n", "friction", "chip_mm", "edges", "centre_radius"});
    BurFile::NamedCuttingParameters made;
    made.cuttingParameters.name = name;
    made.description = row.text("description").value_or("");
    made.source = row.text("source").value_or("");
    for (const Range& r : kRanges)
        if (const auto v = row.number(r.key)) made.cuttingParameters.*r.value = *v;
    if (const auto edges = row.integer("edges"))
        made.cuttingParameters.edges = static_cast<int>(std::clamp<std::int64_t>(*edges, 0, kMaxEdges + 1));
    if (const std::string problem = problemOf(made.cuttingParameters); !problem.empty()) row.fail(problem, kRemedy);
    return made;
}

/// A group of digits of the ISO number.
std::string group(const Table& row, std::string_view key) {
    const std::string digits = row.text(key).value_or("");
    const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
    if (!digits.empty() && (digits.size() != 3 || !std::all_of(digits.begin(), digits.end(), isDigit)))
        row.fail(fmt::format("{} is \"{}\"", key, digits), "give three digits", key);
    return digits;
}

std::string isoNumberOf(const Table& row, double diameterMm) {
    const std::string groups[] = {group(row, "material"), group(row, "shank"), group(row, "iso_shape"),
                                  group(row, "toothing")};
    std::string number;
    for (const std::string& g : groups) {
        if (g.empty()) return {};
        number += g;
    }
    const double tenths = std::round(10.0 * diameterMm);
    return tenths >= 1.0 && tenths <= 999.0 ? fmt::format("{}{:03.0f}", number, tenths) : std::string();
}

CatalogueEntry readBur(const Table& row, const fs::path& folder) {
    row.allowOnly({"name", "us", "shape", "diameter_mm", "length_mm", "stl", "ability", "material", "shank",
                   "iso_shape", "toothing", "description", "unchecked"});
    CatalogueEntry e;
    e.name = row.text("name").value_or("");
    if (e.name.empty()) row.fail("a bur without a name", kRemedy);
    e.usName = row.text("us").value_or("");
    e.cuttingParameters = row.text("ability").value_or(std::string(kDefaultCuttingParameters));
    e.description = row.text("description").value_or("");
    e.unchecked = row.text("unchecked").value_or("");
    if (const auto stl = row.text("stl")) {
        if (row.has("shape") || row.has("diameter_mm") || row.has("length_mm"))
            row.fail(fmt::format("\"{}\" has both a mesh and a shape", e.name), "give one of them", "stl");
        if (stl->empty() || stl->find('\0') != std::string::npos)
            row.fail(fmt::format("\"{}\" names no mesh", e.name), kRemedy, "stl");
        e.stl = folder / *stl;
        return e;
    }
    const auto shape = row.text("shape");
    const auto diameter = row.number("diameter_mm"), length = row.number("length_mm");
    if (!shape || !diameter || !length)
        row.fail(fmt::format("\"{}\" lacks its shape, diameter_mm or length_mm", e.name), "or give stl = \"file.stl\"");
    e.diameterMm = *diameter;
    e.lengthMm = *length;
    try {
        e.shape = shapeByName(*shape);
        (void)makeProfile(e.shape, e.diameterMm, e.lengthMm);
    } catch (const core::Error& error) {
        row.fail(fmt::format("\"{}\": {}: {}", e.name, error.problem(), error.where()), error.remedy());
    }
    e.isoNumber = isoNumberOf(row, e.diameterMm);
    return e;
}

const CuttingParameters* findCuttingParameters(const BurFile& file, std::string_view name) {
    for (const BurFile::NamedCuttingParameters& a : file.abilities)
        if (a.cuttingParameters.name == name) return &a.cuttingParameters;
    return nullptr;
}

const CatalogueEntry* findIn(const BurFile& file, std::string_view name) {
    for (const CatalogueEntry& e : file.burs)
        if (e.name == name) return &e;
    const std::string plain = withoutSpaces(name);
    for (const CatalogueEntry& e : file.burs)
        if (!plain.empty() && (e.usName == name || e.isoNumber == plain)) return &e;
    return nullptr;
}

std::string listOfAbilities(const BurFile* own) {
    std::string list;
    const auto add = [&list](const BurFile& file) {
        for (const BurFile::NamedCuttingParameters& a : file.abilities)
            list += (list.empty() ? "" : ", ") + a.cuttingParameters.name;
    };
    if (own) add(*own);
    add(builtInBurs());
    return list;
}

/// In the file of one's own first, then among those shipped.
const CuttingParameters& findCuttingParameters(const BurFile* own, std::string_view name) {
    const CuttingParameters* found = own ? findCuttingParameters(*own, name) : nullptr;
    if (!found) found = findCuttingParameters(builtInBurs(), name);
    if (found) return *found;
    throw core::Error("there is no ability of this name", std::string(name), "choose one of " + listOfAbilities(own));
}

/// `shipped` is null while that itself is read.
BurFile readFile(const Table& root, const fs::path& folder, const BurFile* shipped) {
    const std::int64_t version = root.integer("format").value_or(0);
    if (version != kFormatVersion)
        root.fail(fmt::format("the file's format is {}, this program reads format {}", version, kFormatVersion),
                  version > kFormatVersion ? "use a newer Handpiece" : "add the line: format = 1", "format");
    root.allowOnly({"format", "ability", "bur"});
    BurFile file;
    if (const auto list = root.table("ability"))
        for (const std::string& name : list->keys())
            file.abilities.push_back(readCuttingParameters(name, *list->table(name)));
    std::set<std::string> names;
    for (const Table& row : root.tables("bur")) {
        CatalogueEntry e = readBur(row, folder);
        if (!names.insert(e.name).second) row.fail(fmt::format("there are two burs called \"{}\"", e.name), kRemedy);
        if (!findCuttingParameters(file, e.cuttingParameters) &&
            !(shipped && findCuttingParameters(*shipped, e.cuttingParameters)))
            row.fail(fmt::format("\"{}\": there is no ability \"{}\"", e.name, e.cuttingParameters),
                     shipped ? "choose one of " + listOfAbilities(&file) : "add it", "ability");
        file.burs.push_back(std::move(e));
    }
    return file;
}

Bur burOfMesh(const fs::path& file, const std::string& name, double mmPerUnit = 1.0) {
    return burFromMesh(name, geometry::scaled(geometry::readMesh(file), mmPerUnit));
}

Bur burOf(const CatalogueEntry& e) {
    return e.stl.empty() ? Bur(e.name, makeProfile(e.shape, e.diameterMm, e.lengthMm)) : burOfMesh(e.stl, e.name);
}

}  // namespace

const BurFile& builtInBurs() {
    static const BurFile file = readFile(Table::parse(kBursToml, "data/burs.toml"), {}, nullptr);
    return file;
}

const std::vector<CatalogueEntry>& catalogue() {
    return builtInBurs().burs;
}

const CatalogueEntry* findBur(std::string_view name) {
    return findIn(builtInBurs(), name);
}

const CuttingParameters& abilityByName(std::string_view name) {
    return findCuttingParameters(nullptr, name);
}

void validate(const CuttingParameters& cuttingParameters) {
    if (const std::string problem = problemOf(cuttingParameters); !problem.empty())
        throw core::Error(problem, "ability", kRemedy);
}

BurFile parseAbilities(std::string_view text, const std::string& where, const fs::path& folder) {
    return readFile(Table::parse(text, where), folder, &builtInBurs());
}

BurFile readAbilities(const fs::path& file) {
    return readFile(Table::read(file), file.parent_path(), &builtInBurs());
}

Instrument makeInstrument(std::string_view nameOrFile, const fs::path& abilitiesFile,
                          std::string_view cuttingParameters, double mmPerUnit) {
    std::optional<BurFile> own;
    if (!abilitiesFile.empty()) own = readAbilities(abilitiesFile);
    const BurFile* ownFile = own ? &*own : nullptr;
    const CatalogueEntry* entry = ownFile ? findIn(*ownFile, nameOrFile) : nullptr;
    if (!entry) entry = findBur(nameOrFile);
    const std::string_view abilityName = !cuttingParameters.empty() ? cuttingParameters
                                         : entry                    ? entry->cuttingParameters
                                                                    : kDefaultCuttingParameters;
    Instrument made;
    made.cuttingParameters = findCuttingParameters(ownFile, abilityName);
    if (entry) {
        made.bur = std::make_shared<const Bur>(burOf(*entry));
    } else if (const fs::path file(nameOrFile); geometry::meshFormatOf(file) != geometry::MeshFormat::unknown) {
        made.bur = std::make_shared<const Bur>(burOfMesh(file, file.filename().string(), mmPerUnit));
    } else {
        made.bur = std::make_shared<const Bur>(makeBur(nameOrFile));
    }
    return made;
}

}  // namespace handpiece::instrument
