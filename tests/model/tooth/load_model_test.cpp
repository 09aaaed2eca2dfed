// SPDX-License-Identifier: Apache-2.0
/// @file
/// loadModel: builds, keeps, reopens, refuses.

#include <gtest/gtest.h>

#include <cstdlib>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_cache.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "support/closed_meshes.h"
#include "support/random.h"

namespace handpiece::tooth::load_model_test {
namespace {

namespace fs = std::filesystem;

/// A tooth of enamel around dentine, in a folder of its own; XDG_CACHE_HOME points into another.
class LoadModel : public ::testing::Test {
  protected:
    LoadModel() {
        toothCase.name = "bumpy";
        toothCase.source = folder.path() / "case";
        fs::create_directories(toothCase.source);
        toothCase.outer = test::bumpyMesh(3, 2.0);
        toothCase.parts = {{"enamel", cases::Tissue::enamel, 10, toothCase.outer},
                           {"dentine", cases::Tissue::dentine, 20, test::sphereMesh(3, 1.2)}};
        settings.field.voxelMm = 0.1;
        ::setenv("XDG_CACHE_HOME", (folder.path() / "user").c_str(), 1);
    }
    ~LoadModel() override { ::unsetenv("XDG_CACHE_HOME"); }

    /// Of the distances; tissues lie beside them.
    static std::vector<fs::path> fieldsIn(const fs::path& where) {
        std::vector<fs::path> found;
        std::error_code ec;
        for (const auto& entry : fs::directory_iterator(where, ec))
            if (entry.path().extension() == ".field") found.push_back(entry.path());
        return found;
    }
    static std::size_t filesIn(const fs::path& where) { return fieldsIn(where).size(); }

    test::TemporaryFolder folder;
    cases::Case toothCase;
    tooth::LoadSettings settings;
};

TEST_F(LoadModel, BuildsThenReopensTheSame) {
    const auto built = loadModel(toothCase, settings);
    EXPECT_FALSE(built->fromCache);
    EXPECT_GT(built->buildSeconds, 0.0);
    EXPECT_EQ(built->name, "bumpy");
    EXPECT_EQ(filesIn(toothCase.source / ".handpiece-cache"), 1u);
    const auto again = loadModel(toothCase, settings);
    EXPECT_TRUE(again->fromCache);
    EXPECT_EQ(again->field.stateHash(), built->field.stateHash());
    EXPECT_EQ(again->outer.triangles, built->outer.triangles);
    const core::Vec3 p(0.3, -1.2, 1.1);
    EXPECT_EQ(again->tree.signedDistance(p), built->tree.signedDistance(p));
    EXPECT_EQ(again->field.tissueAt({0, 0, 0}), cases::Tissue::dentine);
}

TEST_F(LoadModel, OtherSettingsOrSurfacesAreBuiltAnew) {
    (void)loadModel(toothCase, settings);
    settings.field.bandInMm = 0.35;
    EXPECT_FALSE(loadModel(toothCase, settings)->fromCache);
    toothCase.outer.vertices[0] *= 1.001;
    EXPECT_FALSE(loadModel(toothCase, settings)->fromCache);
    EXPECT_TRUE(loadModel(toothCase, settings)->fromCache);
}

TEST_F(LoadModel, DamagedCacheIsRebuiltAndReplaced) {
    (void)loadModel(toothCase, settings);
    const fs::path file = fieldsIn(toothCase.source / ".handpiece-cache").front();
    std::vector<std::byte> data = core::readFile(file);
    data[data.size() / 2] ^= std::byte{1};
    core::writeFile(file, data);
    EXPECT_FALSE(loadModel(toothCase, settings)->fromCache);
    EXPECT_TRUE(loadModel(toothCase, settings)->fromCache);
}

TEST_F(LoadModel, AForgedCacheIsBuiltAnew) {
    const auto built = loadModel(toothCase, settings);
    const fs::path file = fieldsIn(toothCase.source / ".handpiece-cache").front();
    const std::vector<std::byte> good = core::readFile(file);
    // All of the surface a tenth of a millimetre too high, and every sum as it should be.
    const auto shifted = field::DistanceField::fromFunction(
        built->tree.bounds().grown(settings.field.bandOutMm + settings.field.voxelMm), settings.field,
        [&](const core::Vec3& p) { return built->tree.signedDistance(p - core::Vec3(0, 0, 0.1)); });
    const std::uint64_t key = field::cacheKey(toothCase, settings.field);
    core::writeFile(file, field::encodeField(shifted, key));
    auto again = loadModel(toothCase, settings);
    EXPECT_FALSE(again->fromCache);
    EXPECT_EQ(again->field.stateHash(), built->field.stateHash());
    EXPECT_EQ(core::readFile(file), good) << "and it is mended";
    // Another's file is let alone: the tooth is kept where this user's own caches lie.
    const fs::path theirs = folder.path() / "theirs";
    fs::rename(file, theirs);
    fs::create_symlink(theirs, file);
    again = loadModel(toothCase, settings);
    EXPECT_FALSE(again->fromCache);
    EXPECT_EQ(again->field.stateHash(), built->field.stateHash());
    EXPECT_EQ(filesIn(folder.path() / "user" / "handpiece"), 1u);
    EXPECT_TRUE(fs::is_symlink(file));
    EXPECT_TRUE(loadModel(toothCase, settings)->fromCache);
}

TEST_F(LoadModel, WithoutCacheNothingIsWritten) {
    settings.useCache = false;
    EXPECT_FALSE(loadModel(toothCase, settings)->fromCache);
    EXPECT_FALSE(loadModel(toothCase, settings)->fromCache);
    EXPECT_FALSE(fs::exists(toothCase.source / ".handpiece-cache"));
    EXPECT_FALSE(fs::exists(folder.path() / "user"));
}

TEST_F(LoadModel, TheFolderAskedForAndNoOther) {
    settings.cacheFolder = folder.path() / "asked";
    (void)loadModel(toothCase, settings);
    EXPECT_EQ(filesIn(folder.path() / "asked"), 1u);
    EXPECT_FALSE(fs::exists(toothCase.source / ".handpiece-cache"));
    EXPECT_TRUE(loadModel(toothCase, settings)->fromCache);
}

TEST_F(LoadModel, ASingleFileGoesToTheUsersCache) {
    toothCase.source = folder.path() / "tooth.stl";
    core::writeFile(toothCase.source, std::string_view("solid"));
    toothCase.parts.resize(1);
    toothCase.outer = {};
    const auto tooth = loadModel(toothCase, settings);
    EXPECT_EQ(tooth->outer.triangles, toothCase.parts[0].mesh.triangles);
    EXPECT_EQ(filesIn(folder.path() / "user" / "handpiece"), 1u);
    EXPECT_TRUE(loadModel(toothCase, settings)->fromCache);
}

TEST_F(LoadModel, AReadOnlyCaseUsesTheUsersCache) {
    // A file where the folder should be stands for a folder without permission: root may write anywhere.
    core::writeFile(toothCase.source / ".handpiece-cache", std::string_view("in the way"));
    EXPECT_FALSE(loadModel(toothCase, settings)->fromCache);
    EXPECT_EQ(filesIn(folder.path() / "user" / "handpiece"), 1u);
    EXPECT_TRUE(loadModel(toothCase, settings)->fromCache);
    // No place at all: it opens all the same.
    core::writeFile(folder.path() / "blocked", std::string_view("in the way"));
    ::setenv("XDG_CACHE_HOME", (folder.path() / "blocked").c_str(), 1);
    EXPECT_FALSE(loadModel(toothCase, settings)->fromCache);
}

TEST_F(LoadModel, SaysWhyACaseCannotBeFelt) {
    const auto complaint = [&](const cases::Case& c) -> std::string {
        try {
            (void)loadModel(c, settings);
        } catch (const core::Error& error) {
            return error.what();
        }
        return "";
    };
    cases::Case bad = toothCase;
    bad.outer = {};
    EXPECT_NE(complaint(bad).find("a case of several parts needs outer.stl"), std::string::npos);
    bad.parts.clear();
    EXPECT_NE(complaint(bad).find("no surface"), std::string::npos);
    bad = toothCase;
    bad.outer.triangles.pop_back();
    EXPECT_NE(complaint(bad).find("open"), std::string::npos);
    bad = toothCase;
    bad.parts[1].mesh.triangles.pop_back();
    EXPECT_NE(complaint(bad).find("dentine"), std::string::npos);
    EXPECT_FALSE(fs::exists(toothCase.source / ".handpiece-cache")) << "nothing is kept of what failed";
}

TEST_F(LoadModel, ProgressRisesToOneAndCancels) {
    double last = -1.0;
    bool rising = true;
    settings.useCache = false;
    core::setThreadCount(1);
    (void)loadModel(toothCase, settings, [&](double f) {
        rising = rising && f >= last - 1e-12;
        last = f;
        return true;
    });
    core::setThreadCount(0);
    EXPECT_TRUE(rising);
    EXPECT_EQ(last, 1.0);
    for (const double stop : {0.0, 0.15, 0.5})
        EXPECT_THROW((void)loadModel(toothCase, settings, [&](double f) { return f < stop; }), core::Error);
    // A cancelled opening from the cache stops too, and does not build instead.
    settings.useCache = true;
    (void)loadModel(toothCase, settings);
    int calls = 0;
    EXPECT_THROW((void)loadModel(toothCase, settings, [&](double f) { return ++calls, f < 1.0; }), core::Error);
    EXPECT_LE(calls, 3);
}

}  // namespace
}  // namespace handpiece::tooth::load_model_test
