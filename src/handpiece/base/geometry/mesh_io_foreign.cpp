// SPDX-License-Identifier: Apache-2.0
// What is often saved under a mesh's name and is none.
#include <algorithm>
#include <array>

#include "handpiece/base/geometry/mesh_io_formats.h"

namespace handpiece::geometry::formats {
namespace {

using std::string_view_literals::operator""sv;

struct Start {
    std::string_view bytes, problem, remedy;
};
constexpr const char* kUnpack = "unpack it, and give the mesh that is in it";
constexpr const char* kConvert = "open it in the program that made it, and export STL, PLY or OBJ";
constexpr std::array kStarts{
    Start{"version https://git-lfs.github.com/spec/"sv,
          "this is a pointer of Git LFS: the mesh itself was not fetched with the repository",
          "fetch it: git lfs pull"},
    Start{"PK\x03\x04"sv, "this is a zip archive, and no mesh", kUnpack},
    Start{"PK\x05\x06"sv, "this is an empty zip archive, and no mesh", "copy or download the mesh again"},
    Start{"\x1f\x8b"sv, "this is a file packed by gzip, and no mesh", kUnpack},
    Start{"BZh"sv, "this is a file packed by bzip2, and no mesh", kUnpack},
    Start{"\xfd\x37zXZ\0"sv, "this is a file packed by xz, and no mesh", kUnpack},
    Start{"(\xb5/\xfd"sv, "this is a file packed by zstd, and no mesh", kUnpack},
    Start{"7z\xbc\xaf\x27\x1c"sv, "this is a 7z archive, and no mesh", kUnpack},
    Start{"Rar!\x1a\x07"sv, "this is a rar archive, and no mesh", kUnpack},
    Start{"%PDF-"sv, "this is a PDF, and no mesh", "export the mesh itself"},
    Start{"\x89PNG\r\n"sv, "this is a picture (PNG), and no mesh", "export the mesh itself"},
    Start{"\xff\xd8\xff"sv, "this is a picture (JPEG), and no mesh", "export the mesh itself"},
    Start{"glTF"sv, "this is a glTF file, which is not read", kConvert},
    Start{"ISO-10303-21"sv, "this is a STEP file, which is not read", kConvert},
    Start{"# vtk DataFile"sv, "this is a VTK file, which is not read", kConvert},
    Start{"{\\rtf"sv, "this is a text document (RTF), and no mesh", "export the mesh itself"},
    Start{"\x7f"
          "ELF"sv,
          "this is a program, and no mesh", "give the mesh itself"},
};

std::string lowerStart(std::string_view text) {
    const std::size_t from = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    std::string start(text.substr(from, 64));
    for (char& c : start)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
    return start;
}

// Text in units of two bytes: after a mark that says so, or every other byte zero from the first on.
bool isUtf16(std::string_view text) {
    if (text.starts_with("\xff\xfe"sv) || text.starts_with("\xfe\xff"sv)) return true;
    if (text.size() < 16) return false;
    const auto everyOther = [&](std::size_t zeros) {
        for (std::size_t i = 0; i < 16; ++i) {
            const char c = text[i];
            if (i % 2 == zeros ? c != 0 : !(c >= ' ' && c <= '~') && !Words::isSpace(c)) return false;
        }
        return true;
    };
    return everyOther(0) || everyOther(1);
}

}  // namespace

void refuseForeign(const Source& source) {
    const std::string_view text = source.text();
    for (const Start& start : kStarts)
        if (text.starts_with(start.bytes)) source.fail(std::string(start.problem), std::string(start.remedy));
    if (text.size() > 132 && text.substr(128, 4) == "DICM")
        source.fail("this is a DICOM file, and no mesh", "scans are read by handpiece scan");
    if (isUtf16(text))
        source.fail("this is text in UTF-16, which no mesh is written in",
                    "save it as plain text (ASCII or UTF-8), or export the mesh again as binary STL");
    const std::string start = lowerStart(text);
    if (start.starts_with("<!doctype html") || start.starts_with("<html") || start.starts_with("<head") ||
        start.starts_with("<body"))
        source.fail("this is a web page (HTML), and no mesh: a download that failed, or needs a log-in, leaves such",
                    "open the address in a browser, and download the mesh itself");
    if (start.starts_with('<')) source.fail("this is XML or HTML, and no STL, PLY or OBJ", kConvert);
    if (start.starts_with('{') || start.starts_with("[{"))
        source.fail("this is JSON, and no STL, PLY or OBJ: an answer of a server, or another kind of file",
                    "download or export the mesh itself");
}

}  // namespace handpiece::geometry::formats
