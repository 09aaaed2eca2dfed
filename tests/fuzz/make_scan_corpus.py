#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Seeds of fuzz_scan_zip and fuzz_scan_dicomdir out of those of fuzz_scan: FOLDER/zip and FOLDER/dicomdir.

    python3 tests/fuzz/make_scan_corpus.py FOLDER
"""
import io
import pathlib
import struct
import sys
import zipfile

SEEDS = pathlib.Path(__file__).parent / "corpus" / "scan"


def zipped(names, method):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as archive:
        for name, data in names.items():
            archive.writestr(zipfile.ZipInfo("scan/" + name), data, method)
    return out.getvalue()


def element(group, number, vr, value):
    value += b"\0" * (len(value) % 2)
    length = b"\0\0" + struct.pack("<I", len(value)) if vr == b"SQ" else struct.pack("<H", len(value))
    return struct.pack("<HH", group, number) + vr + length + value


def dicomdir(count):
    item = b"".join(struct.pack("<HHI", 0xFFFE, 0xE000, len(e)) + e for e in
                    (element(4, 0x1430, b"CS", b"IMAGE") + element(4, 0x1500, b"CS", b"IM%d" % (i + 1))
                     for i in range(count)))
    return bytes(128) + b"DICM" + element(2, 0x10, b"UI", b"1.2.840.10008.1.2.1") + element(4, 0x1220, b"SQ", item)


def main(folder):
    files = {path.name: path.read_bytes() for path in sorted(SEEDS.iterdir())}
    for kind in ("zip", "dicomdir"):
        (folder / kind).mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        if len(data) > 8192:
            continue
        for method, word in ((zipfile.ZIP_STORED, "stored"), (zipfile.ZIP_DEFLATED, "packed")):
            (folder / "zip" / f"{name}-{word}.zip").write_bytes(zipped({name: data}, method))
    slices = {f"IM{i + 1}.dcm": files["slice_0001.dcm"] for i in range(3)}
    (folder / "zip" / "slices.zip").write_bytes(zipped(slices, zipfile.ZIP_DEFLATED))
    for name, data in files.items():
        if not name.endswith(".dcm") or len(data) > 4096:
            continue
        # As fuzz_scan.cpp takes it apart: each file behind its length, the directory first.
        parts = [dicomdir(2), data, data]
        (folder / "dicomdir" / name).write_bytes(b"".join(struct.pack("<H", len(p)) + p for p in parts))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
