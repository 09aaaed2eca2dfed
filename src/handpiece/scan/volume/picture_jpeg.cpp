// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <csetjmp>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

#include "handpiece/scan/volume/picture_orientation.h"
#include "handpiece/scan/volume/pictures.h"

namespace handpiece::volume {
namespace {

constexpr int kQuality = 95;

/// libjpeg calls back where it would end the program: we jump out, and no object with a destructor stands between.
struct Problem {
    jpeg_error_mgr manager;
    std::jmp_buf out;
    char text[JMSG_LENGTH_MAX];
};

[[noreturn]] void onError(j_common_ptr state) {
    auto* problem = reinterpret_cast<Problem*>(state->err);
    state->err->format_message(state, problem->text);
    std::longjmp(problem->out, 1);
}
void onMessage(j_common_ptr /*state*/) {}

jpeg_error_mgr* quiet(Problem& problem) {
    jpeg_std_error(&problem.manager);
    problem.manager.error_exit = onError;
    problem.manager.output_message = onMessage;
    problem.text[0] = '\0';
    return &problem.manager;
}

/// As the picture lies in the file.
struct Lies {
    int columns = 0, rows = 0, orientation = 1;
    bool isColour = false;
    double xMm = 0.0, yMm = 0.0;  ///< by the density; 0: none is told
};

/// libjpeg makes no grey of inks. Adobe's programs write them upside down, and those alone write them.
bool isInks(const jpeg_decompress_struct& state) {
    return state.jpeg_color_space == JCS_CMYK || state.jpeg_color_space == JCS_YCCK;
}

/// Into `to` when there is one; returns what is wrong, or null.
const char* decode(jpeg_decompress_struct& state, Problem& problem, const std::vector<std::byte>& data, Lies& lies,
                   unsigned char* line, float* to) {
    state.err = quiet(problem);
    if (setjmp(problem.out) != 0) {
        jpeg_destroy_decompress(&state);
        return problem.text;
    }
    jpeg_create_decompress(&state);
    jpeg_mem_src(&state, reinterpret_cast<const unsigned char*>(data.data()), static_cast<unsigned long>(data.size()));
    if (!to) jpeg_save_markers(&state, JPEG_APP0 + 1, 0xffff);
    jpeg_read_header(&state, TRUE);
    if (!to) {
        lies.columns = static_cast<int>(state.image_width);
        lies.rows = static_cast<int>(state.image_height);
        lies.isColour = state.num_components != 1;
        const double unitMm = state.density_unit == 1 ? 25.4 : state.density_unit == 2 ? 10.0 : 0.0;
        if (state.saw_JFIF_marker && state.X_density > 0 && state.Y_density > 0) {
            lies.xMm = unitMm / state.X_density;
            lies.yMm = unitMm / state.Y_density;
        }
        for (jpeg_saved_marker_ptr one = state.marker_list; one && lies.orientation == 1; one = one->next)
            lies.orientation = exifOrientation({one->data, one->data_length});
        jpeg_destroy_decompress(&state);
        return nullptr;
    }
    if (static_cast<int>(state.image_width) != lies.columns || static_cast<int>(state.image_height) != lies.rows) {
        jpeg_destroy_decompress(&state);
        return "its size changed";
    }
    const bool hasInks = isInks(state), isUpsideDown = state.saw_Adobe_marker;
    state.out_color_space = hasInks ? JCS_CMYK : JCS_GRAYSCALE;
    state.dct_method = JDCT_ISLOW;
    jpeg_start_decompress(&state);
    while (state.output_scanline < state.output_height) {
        const std::size_t y = state.output_scanline;
        JSAMPROW rows[1] = {line};
        if (jpeg_read_scanlines(&state, rows, 1) != 1) break;
        float* const at = to + y * state.output_width;
        for (std::size_t x = 0; x < state.output_width; ++x) {
            const auto ink = [&](std::size_t n) {
                const unsigned value = line[4 * x + n];
                return isUpsideDown ? 255 - value : value;
            };
            at[x] = hasInks ? greyOfInks(ink(0), ink(1), ink(2), ink(3)) : static_cast<float>(line[x]);
        }
    }
    const long warnings = state.err->num_warnings;
    jpeg_destroy_decompress(&state);
    return warnings > 0 ? "its pixel data is truncated or damaged" : nullptr;
}

/// Red, green and blue into `to`; returns what is wrong, or null.
const char* decodeColours(jpeg_decompress_struct& state, Problem& problem, const std::vector<std::byte>& data,
                          const Lies& lies, std::uint8_t* to) {
    state.err = quiet(problem);
    if (setjmp(problem.out) != 0) {
        jpeg_destroy_decompress(&state);
        return problem.text;
    }
    jpeg_create_decompress(&state);
    jpeg_mem_src(&state, reinterpret_cast<const unsigned char*>(data.data()), static_cast<unsigned long>(data.size()));
    jpeg_read_header(&state, TRUE);
    const bool isSame =
        static_cast<int>(state.image_width) == lies.columns && static_cast<int>(state.image_height) == lies.rows;
    if (!isSame || isInks(state)) {
        jpeg_destroy_decompress(&state);
        return isSame ? "it is made of inks" : "its size changed";
    }
    state.out_color_space = JCS_RGB;
    state.dct_method = JDCT_ISLOW;
    jpeg_start_decompress(&state);
    while (state.output_scanline < state.output_height) {
        JSAMPROW rows[1] = {to + 3 * static_cast<std::size_t>(state.output_scanline) * state.output_width};
        if (jpeg_read_scanlines(&state, rows, 1) != 1) break;
    }
    const long warnings = state.err->num_warnings;
    jpeg_destroy_decompress(&state);
    return warnings > 0 ? "its pixel data is truncated or damaged" : nullptr;
}

const char* encode(jpeg_compress_struct& state, Problem& problem, const std::uint8_t* grey, int columns, int rows,
                   unsigned char** data, unsigned long* size) {
    state.err = quiet(problem);
    if (setjmp(problem.out) != 0) {
        jpeg_destroy_compress(&state);
        return problem.text;
    }
    jpeg_create_compress(&state);
    jpeg_mem_dest(&state, data, size);
    state.image_width = static_cast<JDIMENSION>(columns);
    state.image_height = static_cast<JDIMENSION>(rows);
    state.input_components = 1;
    state.in_color_space = JCS_GRAYSCALE;
    jpeg_set_defaults(&state);
    jpeg_set_quality(&state, kQuality, TRUE);
    state.dct_method = JDCT_ISLOW;
    jpeg_start_compress(&state, TRUE);
    while (state.next_scanline < state.image_height) {
        JSAMPROW line[1] = {const_cast<JSAMPROW>(grey + static_cast<std::size_t>(state.next_scanline) *
                                                            static_cast<std::size_t>(columns))};
        jpeg_write_scanlines(&state, line, 1);
    }
    jpeg_finish_compress(&state);
    jpeg_destroy_compress(&state);
    return nullptr;
}

Lies liesIn(Input& input, const std::vector<std::byte>& data) {
    Lies lies;
    jpeg_decompress_struct state{};
    Problem problem{};
    if (const char* why = decode(state, problem, data, lies, nullptr, nullptr)) throw damagedPicture(input, why);
    return lies;
}

}  // namespace

PictureInfo jpegInfo(Input& input) {
    const Lies lies = liesIn(input, wholeOf(input));
    const bool isTransposed = Orientation(lies.orientation).isTransposed();
    PictureInfo info;
    info.columns = isTransposed ? lies.rows : lies.columns, info.rows = isTransposed ? lies.columns : lies.rows;
    info.isColour = lies.isColour;
    if (lies.xMm > 0.0 && lies.yMm > 0.0)
        info.densityMm = isTransposed ? core::Vec2(lies.yMm, lies.xMm) : core::Vec2(lies.xMm, lies.yMm);
    return info;
}

void readJpeg(Input& input, const PictureInfo& info, float* to) {
    const std::vector<std::byte> data = wholeOf(input);
    Lies lies = liesIn(input, data);
    const Orientation orientation(lies.orientation);
    const bool isSame = orientation.isTransposed() ? lies.rows == info.columns && lies.columns == info.rows
                                                   : lies.columns == info.columns && lies.rows == info.rows;
    if (!isSame) throw damagedPicture(input, "its size changed");
    std::vector<unsigned char> line(4 * static_cast<std::size_t>(lies.columns));  // four where they are inks
    std::vector<float> turned;
    if (!orientation.isUpright())
        turned.resize(static_cast<std::size_t>(lies.columns) * static_cast<std::size_t>(lies.rows));
    float* const into = turned.empty() ? to : turned.data();
    jpeg_decompress_struct state{};
    Problem problem{};
    if (const char* why = decode(state, problem, data, lies, line.data(), into)) throw damagedPicture(input, why);
    if (!turned.empty()) orientation.turn(turned.data(), lies.columns, lies.rows, to);
}

void readJpegColours(Input& input, const AllocateColours& allocate) {
    const std::vector<std::byte> data = wholeOf(input);
    const Lies lies = liesIn(input, data);
    std::uint8_t* const to = allocate(lies.columns, lies.rows);
    jpeg_decompress_struct state{};
    Problem problem{};
    if (const char* why = decodeColours(state, problem, data, lies, to)) throw damagedPicture(input, why);
}

std::vector<std::byte> jpegBytes(std::span<const std::uint8_t> grey, int columns, int rows) {
    unsigned char* data = nullptr;
    unsigned long size = 0;
    jpeg_compress_struct state{};
    Problem problem{};
    const char* why = encode(state, problem, grey.data(), columns, rows, &data, &size);
    std::vector<std::byte> out(reinterpret_cast<std::byte*>(data),
                               reinterpret_cast<std::byte*>(data) + (why ? 0 : size));
    std::free(data);
    if (why) throw core::Error(fmt::format("cannot be made a JPEG: {}", why), "slice", "choose another format");
    return out;
}

}  // namespace handpiece::volume
