// SPDX-License-Identifier: Apache-2.0
// An intraoral scan as OBJ with its picture: real JPEG and PNG files by other writers than ours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include <jpeglib.h>

#include "handpiece/app/scan_case/textures.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/texture.h"
#include "handpiece/scan/volume/colour_picture.h"
#include "handpiece/senses/view/image.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::scan_case::textures_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

/// 16 x 8 pixels: red on the left, green on the right, the lowest half darker.
view::Image halves() {
    view::Image image;
    image.width = 16;
    image.height = 8;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const std::uint8_t bright = y < 4 ? 240 : 120;
            for (const std::uint8_t c : {x < 8 ? bright : std::uint8_t{0}, x < 8 ? std::uint8_t{0} : bright,
                                         std::uint8_t{0}, std::uint8_t{255}})
                image.rgba.push_back(c);
        }
    return image;
}

std::vector<std::byte> jpegOf(const view::Image& image) {
    jpeg_compress_struct state{};
    jpeg_error_mgr problem{};
    state.err = jpeg_std_error(&problem);
    jpeg_create_compress(&state);
    unsigned char* data = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&state, &data, &size);
    state.image_width = static_cast<JDIMENSION>(image.width);
    state.image_height = static_cast<JDIMENSION>(image.height);
    state.input_components = 3;
    state.in_color_space = JCS_RGB;
    jpeg_set_defaults(&state);
    jpeg_set_quality(&state, 100, TRUE);
    jpeg_start_compress(&state, TRUE);
    for (int y = 0; y < image.height; ++y) {
        std::vector<unsigned char> line;
        for (int x = 0; x < image.width; ++x)
            line.insert(line.end(), image.at(x, y), image.at(x, y) + 3);
        JSAMPROW row = line.data();
        jpeg_write_scanlines(&state, &row, 1);
    }
    jpeg_finish_compress(&state);
    std::vector<std::byte> out(reinterpret_cast<std::byte*>(data), reinterpret_cast<std::byte*>(data) + size);
    jpeg_destroy_compress(&state);
    std::free(data);
    return out;
}

class Textures : public testing::Test {
  protected:
    void SetUp() override {
        readTextures();
        view::writePng(halves(), folder_.path() / "t.png");
        core::writeFile(folder_.path() / "t.jpg", jpegOf(halves()));
        write("t.obj",
              "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0.1 0.9\nvt 0.9 0.9\nvt 0.1 0.1\nvt 0.9 0.1\n"
              "usemtl m\nf 1/1 3/3 2/2\nf 1/1 2/2 4/4\nf 1/1 4/4 3/3\nf 2/2 3/3 4/4\n");
    }
    void TearDown() override { geometry::readPicturesWith({}); }
    void write(const char* name, std::string_view text) const { std::ofstream(folder_.path() / name) << text; }
    const test::TemporaryFolder folder_;
};

TEST_F(Textures, JpegAndPngColourASurface) {
    for (const char* picture : {"t.png", "t.jpg"}) {
        write("t.mtl", std::string("newmtl m\nmap_Kd ") + picture + "\n");
        geometry::ReadNotes notes;
        const geometry::VertexColours colours = geometry::readColouredMesh(folder_.path() / "t.obj", &notes).colours;
        EXPECT_THAT(notes, IsEmpty());
        ASSERT_EQ(colours.size(), 4u) << picture;
        const geometry::Colour expected[] = {{240, 0, 0}, {0, 240, 0}, {120, 0, 0}, {0, 120, 0}};
        for (std::size_t v = 0; v < 4; ++v)
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(colours[v][k], expected[v][k], picture[2] == 'p' ? 0 : 12) << picture << v << k;
    }
}

TEST_F(Textures, DamageIsToldWithoutColours) {
    write("t.mtl", "newmtl m\nmap_Kd t.png\n");
    for (const char* picture : {"t.png", "t.jpg"}) {
        write("t.mtl", std::string("newmtl m\nmap_Kd ") + picture + "\n");
        const fs::path file = folder_.path() / picture;
        fs::resize_file(file, fs::file_size(file) / 2);
        geometry::ReadNotes notes;
        EXPECT_THAT(geometry::readColouredMesh(folder_.path() / "t.obj", &notes).colours, IsEmpty());
        ASSERT_EQ(notes.size(), 1u) << picture;
        EXPECT_THAT(notes[0], HasSubstr("damaged"));
    }
}

TEST_F(Textures, BoundsAreKept) {
    const auto read = [&](const char* name, volume::PictureBounds bounds) {
        return test::errorOf([&] { (void)volume::readColourPicture(folder_.path() / name, bounds); });
    };
    for (const char* picture : {"t.png", "t.jpg"}) {
        EXPECT_EQ(read(picture, {1 << 20, 128}), "");
        EXPECT_THAT(read(picture, {1 << 20, 127}), HasSubstr("16 x 8 pixels"));
        EXPECT_THAT(read(picture, {20, 128}), HasSubstr("more than the 20"));
    }
    EXPECT_THAT(read("t.obj", {1 << 20, 128}), HasSubstr("neither JPEG nor PNG"));
    EXPECT_NE(read("gone.png", {1 << 20, 128}), "");
}

}  // namespace
}  // namespace handpiece::scan_case::textures_test
