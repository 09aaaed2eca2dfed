# SPDX-License-Identifier: Apache-2.0
"""A tooth imaged by `make scan`: the files, and the truth beside them, read by nothing of ours."""

import array
import gzip
import json
import os
import signal
import statistics
import subprocess
import time
import unittest

from support import HANDPIECE, SystemTest, ball, write_stl


def nrrd(path):
    """Fields and bytes."""
    head, body = path.read_bytes().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    return fields, gzip.decompress(body) if fields["encoding"] == "gzip" else body


class MakeScan(SystemTest):
    def setUp(self):
        super().setUp()
        self.tooth = write_stl(self.folder / "ball.stl", ball(3.0, n=40))

    def make(self, *arguments, out="scan"):
        return self.ok("make", "scan", "--case", self.tooth, "--voxel", 250, "--out", self.folder / out, *arguments)

    def test_a_tooth_and_its_truth(self):
        self.ok("make", "scan", "--kind", "upper-incisor", "--faces", 4000, "--voxel", 150, "--format", "nrrd", "--metal",
                0.05, "--noise", 0.02, "--out", self.folder / "scan")
        self.assertEqual([p.name for p in (self.folder / "scan").iterdir()], ["scan.nrrd"])
        truth = json.loads((self.folder / "scan-truth" / "truth.json").read_text())
        fields, body = nrrd(self.folder / "scan" / "scan.nrrd")
        label_fields, labels = nrrd(self.folder / "scan-truth" / "labels.nrrd")
        for key in ("sizes", "space directions", "space origin"):
            self.assertEqual(fields[key], label_fields[key])
        self.assertEqual([int(n) for n in fields["sizes"].split()], truth["size"])
        self.assertEqual((fields["type"], fields["endian"]), ("ushort", "little"))
        values = array.array("H", body)
        self.assertEqual(len(values), len(labels))
        self.assertIn("restoration", truth["volumes_mm3"])
        for tissue, mm3 in truth["volumes_mm3"].items():
            label = truth["labels"][tissue]
            found = [values[n] for n in range(len(labels)) if labels[n] == label]
            self.assertAlmostEqual(len(found) * 0.15 ** 3 / mm3, 1.0, delta=0.15 if mm3 < 3 else 0.03, msg=tissue)
            step = truth["grey_values"]["enamel"] - truth["grey_values"]["outside"]
            self.assertAlmostEqual(statistics.median(found), truth["grey_values"][tissue],
                                   delta=(0.2 if mm3 < 3 else 0.1) * step, msg=tissue)
        # The case is one that can be cut, filling and all.
        self.ok("case", "check", self.folder / "scan-truth" / "case")
        self.assertIn("filling", (self.folder / "scan-truth" / "case" / "case.toml").read_text())

    def test_every_format_replaces_the_one_before(self):
        for form, files in (("dicom", ".dcm"), ("tiff", ".tif"), ("bmp", ".bmp"), ("jpeg", ".jpg"), ("png", ".png"),
                            ("raw", ".raw"), ("nrrd", ".nrrd"), ("metaimage", ".mha"), ("nifti", ".nii")):
            self.make("--format", form)
            left = {p.suffix for p in (self.folder / "scan").iterdir()}
            self.assertIn(files, left)
            self.assertLessEqual(left, {files, ".toml"})
        self.assertFalse([p.name for p in self.folder.iterdir() if "part" in p.name])

    def test_the_same_at_any_thread_count(self):
        for threads in (1, 2):
            self.make("--format", "raw", "--ring", 0.02, "--threads", threads, out=f"by-{threads}")
        self.make("--format", "raw", "--ring", 0.02, "--seed", 2, out="other")
        one, two, other = ((self.folder / out / "scan.raw").read_bytes() for out in ("by-1", "by-2", "other"))
        self.assertEqual(one, two)
        self.assertNotEqual(one, other)

    def test_what_makes_no_scan(self):
        out = ("--case", self.tooth, "--out", self.folder / "scan")
        for arguments, mentions in ((("--format", "gif"), ["gif", "dicom"]), (("--scanner", "MRI"), ["MRI", "cbct"]),
                                    (("--voxel", 0), ["--voxel"]), (("--voxel", 1), ["too large"]),
                                    (("--noise", -1), ["--noise"]), (("--blur", "nan"), ["--blur"]),
                                    (("--metal", 7), ["--metal"])):
            with self.subTest(arguments=arguments):
                self.refused("make", "scan", *out, *arguments, mentions=mentions)
        self.refused("make", "scan", "--case", "gone.stl", "--out", self.folder / "scan", mentions=["gone.stl"])
        half = write_stl(self.folder / "half.stl", ball(3.0)[:400])
        self.refused("make", "scan", "--case", half, "--voxel", 250, "--out", self.folder / "scan", mentions=["closed"])
        (self.folder / "mine-truth").mkdir()
        (self.folder / "mine-truth" / "letter.txt").write_text("keep me")
        self.refused("make", "scan", "--case", self.tooth, "--out", self.folder / "mine", mentions=["mine-truth"])

    def test_a_stopped_scan_leaves_nothing(self):
        program = subprocess.Popen([HANDPIECE, "make", "scan", "--kind", "upper-incisor", "--faces", "4000", "--voxel",
                                    "40", "--out", self.folder / "scan"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   env=os.environ)
        time.sleep(1.0)
        program.send_signal(signal.SIGINT)
        program.communicate(timeout=120)
        self.assertNotEqual(program.returncode, 0)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["ball.stl"])


if __name__ == "__main__":
    unittest.main()
