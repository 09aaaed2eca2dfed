# SPDX-License-Identifier: Apache-2.0
"""From a scan to a case: looked into, made, touched and cut; nothing of the patient in it; bad input told."""

import json
import os
import pathlib
import random
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest
import zipfile

from support import HANDPIECE, SystemTest, run, write_stl

# pydicom is a package of the system's own Python.
PYTHON = "/usr/bin/python3"
HAS_PYDICOM = subprocess.run([PYTHON, "-c", "import pydicom, numpy"], capture_output=True, check=False).returncode == 0

PATIENT = {"name": "Zwetschgenbaum", "given": "Xaveria", "id": "PX-7731-QQ", "birth": "19410703",
           "institution": "Hospital Zur Alten Muehle", "physician": "Quackenbruck", "private": "PrivNote-8842",
           "uid": "1.2.826.0.1.3680043.99.41", "comment": "Comment4711"}
MAKE_DICOM = """
import sys, numpy, pydicom
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, CTImageStorage
raw, folder, nx, ny, nz, patient = sys.argv[1], sys.argv[2], *map(int, sys.argv[3:6]), eval(sys.argv[6])
values = numpy.fromfile(raw, "<i2").reshape(nz, ny, nx)
for k in range(nz):
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CTImageStorage
    meta.MediaStorageSOPInstanceUID = patient["uid"] + ".3.%d" % k
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    d = FileDataset("", {}, file_meta=meta, preamble=bytes(128))
    d.PatientName = patient["name"] + "^" + patient["given"]
    d.PatientID, d.PatientBirthDate, d.PatientComments = patient["id"], patient["birth"], patient["comment"]
    d.InstitutionName, d.ReferringPhysicianName = patient["institution"], patient["physician"]
    d.SeriesDescription = d.StudyDescription = d.ProtocolName = patient["name"] + " molar"
    d.StudyInstanceUID, d.SeriesInstanceUID = patient["uid"] + ".1", patient["uid"] + ".2"
    d.SOPClassUID, d.SOPInstanceUID = CTImageStorage, patient["uid"] + ".3.%d" % k
    block = d.private_block(0x0011, "SECRET " + patient["name"], create=True)
    block.add_new(0x01, "LO", patient["private"])
    d.Modality, d.InstanceNumber = "CT", k + 1
    d.ImagePositionPatient, d.ImageOrientationPatient = [0, 0, 0.2 * k], [1, 0, 0, 0, 1, 0]
    d.PixelSpacing, d.SliceThickness = [0.2, 0.2], 0.2
    d.Rows, d.Columns, d.SamplesPerPixel, d.PhotometricInterpretation = ny, nx, 1, "MONOCHROME2"
    d.BitsAllocated, d.BitsStored, d.HighBit, d.PixelRepresentation = 16, 16, 15, 1
    d.RescaleIntercept, d.RescaleSlope = 0, 1
    d.PixelData = values[k].tobytes()
    d.is_little_endian, d.is_implicit_VR = True, False
    d.save_as(folder + "/%s_%04d.dcm" % (patient["name"], k), write_like_original=False)
"""


class Scan(SystemTest):
    @classmethod
    def setUpClass(cls):
        cls.phantom = pathlib.Path(tempfile.mkdtemp(prefix="handpiece-phantom-"))
        cls.addClassCleanup(shutil.rmtree, cls.phantom, ignore_errors=True)
        done = run("make", "scan", "--kind", "upper-incisor", "--scanner", "cbct", "--voxel", 200, "--faces", 8000,
                   "--format", "raw", "--out", cls.phantom / "scan")
        assert done.returncode == 0, done.stderr
        cls.scan = cls.phantom / "scan"
        cls.truth = json.loads((cls.phantom / "scan-truth" / "truth.json").read_text())

    def volumes(self, text):
        """The lines of volumes that the command prints."""
        found = {}
        for line in text[text.index("as the scan shows it"):].splitlines():
            words = line.split()
            if len(words) == 3 and words[2] == "mm3":
                found[words[0]] = float(words[1])
        return found

    def test_from_slices_to_a_tooth_that_is_cut(self):
        info = json.loads(self.ok("scan", "info", self.scan, "--json", "--pictures", self.folder / "seen").stdout)
        self.assertEqual(info["series"][0]["size"], self.truth["size"])
        self.assertEqual(info["series"][0]["spacing_mm"], [0.2, 0.2, 0.2])
        self.assertEqual((self.folder / "seen" / info["series"][0]["picture"]).read_bytes()[:4], b"\x89PNG")
        self.assertIn("0.2 x 0.2 x 0.2", self.ok("scan", "info", self.scan).stdout)
        teeth = json.loads(self.ok("scan", "info", self.scan, "--json", "--teeth").stdout)["teeth"]
        at = ",".join(f"{value:.3f}" for value in teeth[0]["at_mm"])

        case = self.folder / "case"
        done = self.ok("scan", "case", self.scan, "--at", at, "--tooth", 11, "--out", case, "--report", "--name",
                       "an incisor", "--save-job", self.folder / "job.toml")
        for tissue, mm3 in self.volumes(done.stdout).items():
            self.assertAlmostEqual(mm3, self.truth["volumes_mm3"][tissue], delta=0.03 * mm3 + 0.5, msg=tissue)
        self.assertIn("can be felt and cut", self.ok("case", "check", case).stdout)
        made = json.loads(self.ok("case", "info", case, "--json").stdout)
        self.assertEqual((made["name"], made["fdi"], made["buccal"]), ("an incisor", 11, "+y"))
        self.assertEqual([part["tissue"] for part in made["parts"]][:3], ["enamel", "dentine", "pulp"])
        self.assertGreater(made["outer"]["box_max_mm"][2], 7.0)  # the crown is up

        page = (case / "report.html").read_text()
        for word in ("Try it now", "handpiece-desktop case", "handpiece run --case case", "enamel on top of the crown",
                     "What this scan cannot show", "mesial", "two-manifold, oriented", "data:image/png;base64,"):
            self.assertIn(word, page)
        self.assertNotIn(str(self.phantom), page)
        self.assertNotRegex(page, r"https?://")

        self.ok("run", "--case", case, "--bur", "330", "--motion", "drop", "--voxel", 100, "--out", self.folder / "drop")
        touched = json.loads((self.folder / "drop" / "summary.json").read_text())
        cut = json.loads(self.ok("run", "--case", case, "--bur", "round-4", "--motion", "plunge", "--voxel", 100,
                                 "--out", self.folder / "cut", "--json").stdout)
        self.assertGreater(touched["contact_s"], 0.1)
        self.assertGreater(touched["peak_force_n"], 0.1)
        self.assertGreater(cut["removed_mm3"]["enamel"], 0.01)

        # The job does it again, bit for bit.
        again = self.folder / "again"
        self.ok("scan", "case", "--job", self.folder / "job.toml", "--out", again)
        for name in ("case.toml", "outer.stl", "enamel.stl", "dentine.stl", "pulp.stl"):
            self.assertEqual((again / name).read_bytes(), (case / name).read_bytes(), name)

    def test_what_may_be_a_mirror_image_is_told_and_turned(self):
        scan = self.folder / "unsided"
        shutil.copytree(self.scan, scan)
        toml = (scan / "scan.toml").read_text()
        (scan / "scan.toml").write_text("".join(line for line in toml.splitlines(True) if not line.startswith("axes")))
        self.assertTrue(json.loads(self.ok("scan", "info", self.scan, "--json").stdout)["series"][0]["side_known"])
        self.assertFalse(json.loads(self.ok("scan", "info", scan, "--json").stdout)["series"][0]["side_known"])
        told = self.ok("scan", "info", scan).stdout
        self.assertEqual(told.count("left and right may be swapped"), 1, told)
        self.assertIn("--reverse-slices", told)
        done = self.ok("scan", "segment", scan, "--out", self.folder / "labels.nrrd")
        self.assertEqual(done.stdout.count("left and right may be swapped"), 1, done.stdout)
        done = self.ok("scan", "segment", scan, "--reverse-slices", "--out", self.folder / "turned.nrrd", "--save-job",
                       self.folder / "job.toml")
        self.assertNotIn("may be swapped", done.stdout)
        self.assertIn("read from the other end", done.stdout)
        self.assertIn("reverse_slices = true", (self.folder / "job.toml").read_text())
        self.assertNotEqual((self.folder / "labels.nrrd").read_bytes(), (self.folder / "turned.nrrd").read_bytes())

    def test_names_that_are_no_utf8(self):
        odd = self.folder / os.fsdecode(b"caf\xe9")
        shutil.copytree(self.scan, odd)
        found = json.loads(self.ok("scan", "info", odd, "--json").stdout)
        self.assertEqual(found["series"][0]["size"], self.truth["size"])
        self.ok("scan", "segment", odd, "--out", self.folder / "labels.nrrd")
        self.refused("scan", "segment", odd, "--out", self.folder / "again.nrrd", "--save-job",
                     self.folder / "job.toml", mentions=["no UTF-8"])
        self.refused("scan", "info", self.folder / os.fsdecode(b"no\xe9ne"), mentions=["no\\xe9ne", "no such file"])

    def test_all_resolutions_labels_and_surfaces(self):
        done = self.ok("scan", "case", self.scan, "--table2", "--out", self.folder / "t.handpiece")
        faces = [json.loads(self.ok("case", "info", self.folder / f"t-{p}.handpiece", "--json").stdout)["outer"]["faces"]
                 for p in (6, 12, 25, 50, 100)]
        for share, count in zip((0.06, 0.12, 0.25, 0.5, 1.0), faces):
            self.assertAlmostEqual(count / faces[-1], share, delta=0.002)
        self.assertIn("scanned tooth (6 %)", done.stdout)

        self.ok("scan", "segment", self.scan, "--out", self.folder / "labels.nrrd")
        mine = self.volumes(done.stdout)
        again = self.volumes("as the scan shows it\n" + self.ok(
            "scan", "case", self.folder / "labels.nrrd", "--labels", "--faces", 20000, "--out",
            self.folder / "of-labels").stdout.split("as the scan shows it")[1])
        for tissue in ("enamel", "dentine", "pulp"):
            self.assertAlmostEqual(again[tissue], mine[tissue], delta=0.03 * mine[tissue] + 0.5)

        self.ok("scan", "surface", self.scan, "--percent", 25, "--lesion", self.place((0, 1.0, 6.0)) + ",0.8", "--out",
                self.folder / "meshes")
        for name in ("outer", "dentine", "pulp", "caries-authored"):
            told = json.loads(self.ok("mesh", "info", self.folder / "meshes" / f"{name}.stl", "--json").stdout)
            self.assertTrue(told["closed"] and told["oriented"], name)
            self.assertEqual(told["crossing_faces"], 0, name)

    def place(self, in_tooth):
        """A place of the tooth's frame in the scanner's (which is not turned)."""
        origin = self.truth["tooth_in_scan"]["position_mm"]
        return ",".join(f"{a + b:.4f}" for a, b in zip(in_tooth, origin))

    def test_an_intraoral_scan_becomes_the_outer_surface(self):
        data = (self.phantom / "scan-truth" / "case" / "outer.stl").read_bytes()
        count = struct.unpack_from("<I", data, 80)[0]
        crown = []
        for i in range(count):
            v = struct.unpack_from("<9f", data, 84 + 50 * i + 12)
            corners = [v[0:3], v[3:6], v[6:9]]
            if min(c[2] for c in corners) > 1.0:  # lies on its side, elsewhere
                crown.append([(c[2] + 30.0, c[0] - 12.0, c[1] + 5.0) for c in corners])
        write_stl(self.folder / "crown.stl", crown)
        done = self.ok("scan", "case", self.scan, "--intraoral", self.folder / "crown.stl", "--out", self.folder / "c")
        self.assertIn("the intraoral scan lies", done.stdout)
        self.assertIn("can be felt and cut", self.ok("case", "check", self.folder / "c").stdout)
        self.assertNotIn("crown.stl", done.stdout)
        self.refused("scan", "case", self.scan, "--intraoral", self.folder / "none.stl", "--out", self.folder / "d",
                     mentions=["none.stl"])

    @unittest.skipUnless(HAS_PYDICOM, "no pydicom on this machine (package python3-pydicom)")
    def test_nothing_of_the_patient_is_kept(self):
        folder = self.folder / f"{PATIENT['name']}_{PATIENT['given']}"
        folder.mkdir()
        (self.folder / "make.py").write_text(MAKE_DICOM)
        subprocess.run([PYTHON, self.folder / "make.py", self.scan / "scan.raw", folder, *map(str, self.truth["size"]),
                        repr(PATIENT)], check=True)
        said = [self.ok("scan", "info", folder).stdout, self.ok("scan", "info", folder, "--json").stdout]
        out = self.folder / "out"
        out.mkdir()
        for name, more in (("case", ("--report", "--scenery")), ("packed.handpiece", ("--percent", 25))):
            done = self.ok("scan", "case", folder, "--out", out / name, *more)
            said += [done.stdout, done.stderr]
        done = self.ok("scan", "segment", folder, "--out", out / "labels.nrrd")
        said.append(done.stdout)
        done = self.ok("scan", "surface", folder, "--percent", 12, "--out", out / "meshes")
        said.append(done.stdout)
        for case in ("case", "packed.handpiece"):
            done = self.ok("run", "--case", out / case, "--bur", "330", "--motion", "drop", "--voxel", 200, "--out",
                           out / f"run-{case}")
            said.append(done.stdout)
        with zipfile.ZipFile(out / "packed.handpiece") as packed:
            packed.extractall(out / "unpacked")
        with self.subTest("the files that were looked for are there"):
            for name in ("case/case.toml", "case/report.html", "unpacked/case.toml", "labels.nrrd"):
                self.assertTrue((out / name).is_file(), name)
            self.assertTrue(list(out.rglob("*.h5")) or list((out / "case" / ".handpiece-cache").iterdir()))
        traces = [text.encode(code) for text in PATIENT.values() for code in ("utf-8", "utf-16-le")]
        traces += [trace.lower() for trace in traces]
        files = [path for path in (*out.rglob("*"), *(self.folder / "cache").rglob("*")) if path.is_file()]
        self.assertGreater(len(files), 20)
        for path in files:
            self.assertEqual([t for t in traces if t in str(path.relative_to(self.folder)).encode()], [])
            held = path.read_bytes()
            self.assertEqual([t for t in traces if t in held], [], path)
        for text in said:
            self.assertEqual([t for t in traces if t in text.encode()], [], text)

    def test_interrupted_it_leaves_nothing_and_is_taken_up_again(self):
        job = self.folder / "job.toml"
        with subprocess.Popen([HANDPIECE, "scan", "case", self.scan, "--out", self.folder / "case", "--report",
                               "--save-job", job], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            for _ in range(6000):
                if job.exists() or process.poll() is not None:
                    break
                time.sleep(0.005)
            process.send_signal(signal.SIGINT)
            _, error = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 1, error)
        self.assertIn("cancelled", error)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["job.toml"])
        self.ok("scan", "case", "--job", job, "--percent", 12, "--out", self.folder / "case")
        self.assertTrue((self.folder / "case" / "case.toml").is_file())

    def test_labels_of_teeth_become_a_mouth(self):
        def written(name, labels, size, spacing):
            header = (f"NRRD0005\ntype: uchar\ndimension: 3\nsizes: {size[0]} {size[1]} {size[2]}\nencoding: raw\n"
                      f"spacings: {spacing} {spacing} {spacing}\n\n")
            (self.folder / name).write_bytes(header.encode() + bytes(labels))
            return self.folder / name

        # Pegs with a crown, side by side: 84, 85, and their neighbour of three voxels.
        size, spacing = (50, 34, 52), 0.4
        labels = bytearray(size[0] * size[1] * size[2])
        for k in range(size[2]):
            up = k * spacing - 1.5
            radius = -1 if up < 0 or up > 17 else 1 + 0.2 * up if up < 11 else 3.6 - 0.05 * (up - 14) ** 2
            for j in range(size[1]):
                for i in range(size[0]):
                    for fdi, x in ((84, 5.5), (85, 14.0)):
                        if (i * spacing - x) ** 2 + (j * spacing - 6.5) ** 2 < radius * abs(radius):
                            labels[(k * size[1] + j) * size[0] + i] = fdi
        for i in range(3):
            labels[40 + i] = 83
        teeth = written("teeth.nrrd", labels, size, spacing)
        done = self.ok("scan", "case", teeth, "--tooth", 85, "--out", self.folder / "mouth", "--save-job",
                       self.folder / "job.toml").stdout
        for words in ("83 is left out: its label has 3 voxels", "tooth 84", "not grey values", "counts as enamel"):
            self.assertIn(words, done)
        made = (self.folder / "mouth" / "case.toml").read_text()
        self.assertIn("fdi = 85", made)
        self.assertIn("fdi = 84", made)
        self.assertIn("can be felt and cut", self.ok("case", "check", self.folder / "mouth").stdout)
        self.ok("scan", "case", "--job", self.folder / "job.toml", "--out", self.folder / "again")
        self.assertEqual((self.folder / "again" / "outer.stl").read_bytes(),
                         (self.folder / "mouth" / "outer.stl").read_bytes())
        out = self.folder / "none"
        self.refused("scan", "case", teeth, "--tooth", 46, "--out", out, mentions=["46", "84, 85"])
        self.refused("scan", "case", teeth, "--numbers", "universal", "--out", out, mentions=["none of its labels"])
        through = bytes(max(0, n // 40 - 20) % 33 for n in range(40 * 40 * 40))
        counted = written("counted.nrrd", through, (40, 40, 40), 0.4)
        self.refused("scan", "case", counted, "--labels", "--out", out, mentions=["--numbers"])

    def test_bad_input_is_told_in_one_line(self):
        out = self.folder / "case"

        def bad(*arguments, mentions):
            self.refused("scan", "case", *arguments, "--out", out, mentions=mentions)

        bad(self.scan, "--at", "900,0,0", mentions=["900"])
        bad(self.scan, "--at", "1,2", mentions=["--at"])
        bad(self.scan, "--percent", "0", mentions=["0 %"])
        bad(self.scan, "--percent", "6,6", mentions=["twice"])
        bad(self.scan, "--percent", "0.001", mentions=["0.001 %", "do not make a tooth", "200"])
        bad(self.scan, "--faces", "99999999999", mentions=["99999999999", "20000000 at most"])
        bad(self.scan, "--percent", "6", "--table2", mentions=["one of"])
        bad(self.scan, "--threshold", "tooth", mentions=["--threshold"])
        bad(self.scan, "--tooth", "49", mentions=["49", "FDI"])
        bad(self.scan, "--spacing", "0", mentions=["--spacing"])
        bad(self.scan, "--labels", mentions=["label"])
        bad(self.scan, "--mark", "cheese=1,2,3,1", mentions=["cheese", "enamel"])
        bad(self.scan, "--occlusal", "0,0,0", mentions=["--occlusal"])
        bad(self.scan, "--series", "7", mentions=["7"])
        bad(self.scan, "--threshold", "tooth=30000,enamel=31000", mentions=["tooth"])
        bad(self.folder / "nothing", mentions=["nothing"])
        bad(mentions=["no scan is named"])
        (self.folder / "empty").mkdir()
        bad(self.folder / "empty", mentions=["empty"])
        for text, words in (("format = 2\n", ["format"]), ("format = 1\nsorce = 'x'\n", ["sorce"]),
                            ("format = 1\npercents = [200]\n", ["200"]), ("no toml", ["job.toml"]),
                            ("format = 1\n[segmentation]\nspacing_mm = -1\n", ["spacing_mm"]),
                            ("format = 1\n[[segmentation.mark]]\ncentre_mm = [1, 2]\n", ["centre_mm"])):
            (self.folder / "job.toml").write_text(text)
            bad("--job", self.folder / "job.toml", mentions=words)
        (self.folder / "tissues.toml").write_text("format = 1\n[enamel]\ncutting = -1\n")
        bad(self.scan, "--tissues", self.folder / "tissues.toml", mentions=["tissues.toml", "cutting"])
        self.refused("scan", "case", self.scan, "--out", self.folder / "no" / "case", mentions=["no such folder"])
        self.refused("scan", "case", self.scan, "--out", self.folder / "full", mentions=["something else"],
                     **self.full_folder())
        self.refused("scan", "segment", self.scan, "--out", self.folder / "labels.png", mentions=[".nrrd"])
        noise = self.folder / "noise"
        noise.mkdir()
        generator = random.Random(7)
        (noise / "scan.raw").write_bytes(bytes(generator.randrange(100, 110) for _ in range(30 * 30 * 30)))
        (noise / "scan.toml").write_text('format = 1\nfile = "scan.raw"\nsize = [30, 30, 30]\ntype = "uint8"\n'
                                         "byte_order = \"little\"\nspacing_mm = [0.2, 0.2, 0.2]\n")
        bad(noise, mentions=["tooth"])

    def full_folder(self):
        (self.folder / "full").mkdir()
        (self.folder / "full" / "mine.txt").write_text("mine")
        return {}


if __name__ == "__main__":
    unittest.main()
