// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <csetjmp>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

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

/// Into `to` when there is one; returns what is wrong, or null.
const char* decode(jpeg_decompress_struct& state, Problem& problem, const std::vector<std::byte>& data,
                   PictureInfo& info, unsigned char* line, float* to) {
    state.err = quiet(problem);
    if (setjmp(problem.out) != 0) {
        jpeg_destroy_decompress(&state);
        return problem.text;
    }
    jpeg_create_decompress(&state);
    jpeg_mem_src(&state, reinterpret_cast<const unsigned char*>(data.data()), static_cast<unsigned long>(data.size()));
    jpeg_read_header(&state, TRUE);
    if (!to) {
        info.columns = static_cast<int>(state.image_width);
        info.rows = static_cast<int>(state.image_height);
        info.isColour = state.num_components != 1;
        jpeg_destroy_decompress(&state);
        return nullptr;
    }
    if (static_cast<int>(state.image_width) != info.columns || static_cast<int>(state.image_height) != info.rows) {
        jpeg_destroy_decompress(&state);
        return "its size changed";
    }
    state.out_color_space = JCS_GRAYSCALE;
    state.dct_method = JDCT_ISLOW;
    jpeg_start_decompress(&state);
    while (state.output_scanline < state.output_height) {
        const std::size_t y = state.output_scanline;
        JSAMPROW rows[1] = {line};
        if (jpeg_read_scanlines(&state, rows, 1) != 1) break;
        float* const at = to + y * state.output_width;
        for (std::size_t x = 0; x < state.output_width; ++x)
            at[x] = static_cast<float>(line[x]);
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

}  // namespace

PictureInfo jpegInfo(Input& input) {
    const std::vector<std::byte> data = wholeOf(input);
    PictureInfo info;
    jpeg_decompress_struct state{};
    Problem problem{};
    if (const char* why = decode(state, problem, data, info, nullptr, nullptr)) throw damagedPicture(input, why);
    return info;
}

void readJpeg(Input& input, const PictureInfo& info, float* to) {
    const std::vector<std::byte> data = wholeOf(input);
    std::vector<unsigned char> line(static_cast<std::size_t>(info.columns));
    PictureInfo same = info;
    jpeg_decompress_struct state{};
    Problem problem{};
    if (const char* why = decode(state, problem, data, same, line.data(), to)) throw damagedPicture(input, why);
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
