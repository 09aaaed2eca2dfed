# SPDX-License-Identifier: Apache-2.0
"""The module's numbers are those of the command line, and of closed forms."""
import csv
import io
import json
import struct
import unittest
import zlib

import numpy as np

from support import FOLDER, Test, block, box, command, hp, molar, plunge, poses, tooth


def png(rows):
    """A picture of 8-bit colours."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    lines = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


class Probing(Test):
    def rows(self, path, given, *more):
        text = "x,y,z,qw,qx,qy,qz\n" + "".join(",".join(map(repr, row)) + "\n" for row in given.tolist())
        return list(csv.DictReader(io.StringIO(command("probe", "--tooth", path, "--voxel", "100", "--poses", "-", *more,
                                                       stdin=text))))

    def compare(self, method):
        given = poses()
        probe = hp.Contact(tooth(), "330", method).probe(given)
        rows = self.rows(molar(), given, "--bur", "330", "--method", method)
        self.assertEqual(len(rows), len(probe))
        self.assertGreater(np.count_nonzero(probe.depth_mm > 0), 50)
        self.assertGreater(np.count_nonzero(probe.depth_mm < 0), 50)
        for row, depth, normal, area, tissue in zip(rows, probe.depth_mm, probe.normal, probe.area_mm2, probe.tissue):
            self.assertEqual(row["depth_mm"], f"{depth:.9f}")
            self.assertEqual([row[c] for c in ("nx", "ny", "nz")], [f"{n:.9f}" for n in normal])
            self.assertEqual(row["area_mm2"], f"{area:.6f}")
            self.assertEqual(row["tissue"], hp.TISSUES[tissue])

    def test_field(self):
        self.compare("field")

    def test_hull(self):
        self.compare("hull")

    def test_a_cut_tooth(self):
        given = np.array([[0, 0, -0.3, 1, 0, 0, 0], [0.4, 0, 0.1, 1, 0, 0, 0], [0, 0, -1, 1, 0, 0, 0]], float)
        session = plunge().session
        cut = hp.prepare(session)
        self.assertTrue(cut.is_cut)
        probe = hp.Contact(cut, "330").probe(given)
        rows = self.rows(session, given, "--bur", "330")
        self.assertEqual([row["depth_mm"] for row in rows], [f"{d:.9f}" for d in probe.depth_mm])
        self.assertLess(probe.depth_mm[0], 0.2)  # 0.3 before the cut
        self.assertError("field", hp.Contact, cut, "330", "hull")

    def test_a_ball_on_a_face(self):
        cube = FOLDER / "cube.stl"
        box((-4, -4, -8), (4, 4, 4)).write(cube)
        gaps = np.array([3.0, 1.0, 0.1, 0.0, -0.01, -0.4])
        given = np.zeros((len(gaps), 7))
        given[:, 2], given[:, 3] = 4 + gaps, 1
        probe = hp.Contact(hp.prepare(cube, 0.2), "round:1.0x1.0").probe(given)
        np.testing.assert_allclose(probe.depth_mm, -gaps, atol=1e-6)
        np.testing.assert_allclose(probe.normal, np.tile([0, 0, 1.0], (len(gaps), 1)), atol=1e-6)

    def test_patches(self):
        probe = hp.Contact(tooth(), "round-4").probe(poses())
        starts = probe.patch_starts
        self.assertEqual((len(starts), starts[0], starts[-1]), (len(probe) + 1, 0, len(probe.patch_area_mm2)))
        touching = np.flatnonzero(np.diff(starts))
        self.assertGreater(len(touching), 50)
        for i in touching:
            of = slice(starts[i], starts[i + 1])
            self.assertAlmostEqual(probe.patch_pressure_share[of].sum(), 1.0)
            self.assertAlmostEqual(probe.patch_area_mm2[of].sum(), probe.area_mm2[i])
        bare = hp.Contact(tooth(), "round-4").probe(poses(), patches=False)
        np.testing.assert_array_equal(bare.depth_mm, probe.depth_mm)
        self.assertEqual((len(bare.patch_starts), len(bare.patch_area_mm2)), (0, 0))

    def test_any_number_of_threads(self):
        """Also along a way, where a method begins with what it found at the pose before."""
        self.addCleanup(hp.set_threads, 0)
        ends = poses(9, seed=5)
        way = np.vstack([a + (b - a) * np.linspace(0, 1, 250)[:, None] for a, b in zip(ends, ends[1:])])
        way[:, 3:] /= np.linalg.norm(way[:, 3:], axis=1, keepdims=True)
        for method in ("field", "hull"):
            every = []
            for threads in (1, 2, 3, 0):
                hp.set_threads(threads)
                contact = hp.Contact(tooth(), "round-4", method)
                first = contact.probe(way)
                contact.probe(way[::-1])  # whatever was asked before
                every += [first, contact.probe(way)]
            for other in every[1:]:
                for name in ("depth_mm", "normal", "tooth_point_mm", "area_mm2", "tissue", "status", "patch_centre_mm",
                             "patch_area_mm2", "patch_starts"):
                    self.assertEqual(getattr(every[0], name).tobytes(), getattr(other, name).tobytes(), f"{method}: {name}")

    def test_matrices_are_the_same_poses(self):
        given = poses(50)
        matrices = np.zeros((50, 4, 4))
        for m, p in zip(matrices, given):
            m[:3, :3], m[:3, 3], m[3, 3] = hp.rotation(p), p[:3], 1
        contact = hp.Contact(tooth(), "330")
        np.testing.assert_allclose(contact.probe(matrices).depth_mm, contact.probe(given).depth_mm, atol=1e-9)


class Meshes(Test):
    def test_inspect_and_repair(self):
        whole = box((0, 0, 0), (2, 3, 4))
        path, mended = FOLDER / "open.ply", FOLDER / "mended.ply"
        hp.Mesh(whole.vertices, whole.faces[:-1]).write(path)
        mesh = hp.read_mesh(path)
        told = json.loads(command("mesh", "info", path, "--json"))
        mine = mesh.inspect()
        self.assertEqual(mine, {key: told[key] for key in mine})
        self.assertFalse(mine["closed"])
        self.assertEqual(set(told) - set(mine), {"file", "notes", "repair", "colours"})
        closed, report = mesh.repair()
        told = json.loads(command("mesh", "repair", path, mended, "--json"))
        self.assertEqual(report, {key: told[key] for key in report})
        np.testing.assert_array_equal(closed.vertices, hp.read_mesh(mended).vertices)
        np.testing.assert_array_equal(closed.faces, hp.read_mesh(mended).faces)
        self.assertAlmostEqual(closed.volume_mm3, 24)
        self.assertEqual(len(mesh.faces), 11)  # as it was

    def test_units(self):
        path = FOLDER / "inches.ply"
        box((0, 0, 0), (1, 1, 1)).write(path)
        self.assertEqual(hp.read_mesh(path, "inch").vertices.max(), 25.4)

    def test_colours(self):
        whole = box((0, 0, 0), (2, 3, 4))
        self.assertIsNone(whole.colours)
        given = np.arange(24, dtype=np.uint8).reshape(8, 3) * 10
        path, again, mended = (FOLDER / name for name in ("coloured.ply", "again.ply", "coloured-mended.ply"))
        path.write_text("ply\nformat ascii 1.0\nelement vertex 8\n" +
                        "".join(f"property float {axis}\n" for axis in "xyz") +
                        "".join(f"property uchar {name}\n" for name in ("red", "green", "blue")) +
                        "element face 11\nproperty list uchar int vertex_indices\nend_header\n" +
                        "".join(" ".join(map(str, [*p, *c])) + "\n" for p, c in zip(whole.vertices.tolist(), given.tolist())) +
                        "".join("3 " + " ".join(map(str, f)) + "\n" for f in whole.faces[:-1].tolist()))
        mesh = hp.read_mesh(path)
        np.testing.assert_array_equal(mesh.colours, given)
        self.assertEqual((mesh.colours.dtype, mesh.colours.flags.writeable), (np.uint8, False))
        mesh.write(again)
        np.testing.assert_array_equal(hp.read_mesh(again).colours, given)
        command("mesh", "repair", path, mended)
        closed, _ = mesh.repair()
        np.testing.assert_array_equal(closed.colours, hp.read_mesh(mended).colours)
        np.testing.assert_array_equal(hp.read_case(mended).outer.colours, closed.colours)

    def test_colours_of_a_picture(self):
        folder = FOLDER / "textured"
        folder.mkdir()
        (folder / "two.png").write_bytes(png([[(255, 0, 0), (0, 0, 255)]]))
        (folder / "a.mtl").write_text("newmtl skin\nmap_Kd two.png\n")
        (folder / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl skin\n"
                                      "f 1/1 2/2 3/3\n")
        np.testing.assert_array_equal(hp.read_mesh(folder / "a.obj").colours, [[255, 0, 0], [0, 0, 255], [255, 0, 0]])


class Fields(Test):
    def test_distance_is_that_of_the_nodes(self):
        field = tooth().field
        bricks = field.bricks
        self.assertEqual(bricks.shape[1:], (9, 9, 9))
        index = field.brick_index
        z, y, x = np.argwhere(index >= 0)[len(bricks) // 2]
        stored = index[z, y, x]
        nodes = np.array([[2, 3, 4], [0, 8, 5], [7, 7, 7]])
        points = field.origin_mm + field.voxel_mm * (8 * np.array([x, y, z]) + nodes)
        np.testing.assert_allclose(field.distance(points), [bricks[stored, n[2], n[1], n[0]] for n in nodes], atol=1e-6)
        np.testing.assert_allclose(tooth().distance(points), field.distance(points), atol=1e-4)
        self.assertEqual(field.coarse.shape, index.shape)

    def test_normals_and_tissues(self):
        top = tooth().outer.vertices[tooth().outer.vertices[:, 2].argmax()]
        field = tooth().field
        self.assertEqual(hp.TISSUES[field.tissue_at(top - [0, 0, 0.05])[0]], "enamel")
        self.assertGreater(field.normal(top)[0, 2], 0.5)
        np.testing.assert_array_equal(field.normal([[50, 0, 0]]), [[0, 0, 0]])

    def test_a_made_case_is_prepared_as_a_read_one(self):
        case = hp.make_tooth(faces=6000)
        made, read = hp.prepare(case, 0.2), hp.prepare(molar(), 0.2)
        self.assertAlmostEqual(sum(made.volumes_mm3.values()), sum(read.volumes_mm3.values()), places=2)
        self.assertIn("enamel", [part.tissue for part in case.parts])
        self.assertIsNone(case.path)
        self.assertEqual(hp.read_case(molar()).path, str(molar()))


class Work(Test):
    def test_a_cut(self):
        told = json.loads(command("run", "--tooth", block(), "--motion", "plunge", "--voxel", "100", "--depth", "0.6", "--dwell",
                                  "0.3", "--tremor", "20", "--seed", "7", "--json", "--out", FOLDER / "by-command"))
        mine = plunge().summary
        measured = {"late_ticks", "work_us", "lateness_us", "scheduling", "scheduling_class", "session"}
        self.assertEqual(list(mine), list(told))
        for key in set(told) - measured:
            self.assertEqual(mine[key], told[key], key)
        self.assertEqual(plunge().state_hash, told["state_hash"])
        self.assertGreater(mine["removed_mm3"]["enamel"], 0.01)
        self.assertEqual(json.loads((plunge().out / "summary.json").read_text()), mine)
        self.assertEqual((plunge().out / "cut.stl").read_bytes(), (FOLDER / "by-command" / "cut.stl").read_bytes())
        self.assertEqual(hp.prepare(plunge().session).state_hash, told["state_hash"])
        other = hp.run(block(), "plunge", voxel_mm=0.1, depth_mm=0.6, dwell_s=0.3, tremor_um=20, seed=8)
        self.assertNotEqual(other.state_hash, told["state_hash"])
        self.assertFalse((other.out / "cut.stl").exists())

    def test_a_touch(self):
        done = hp.run(molar(), "drop", voxel_mm=0.1, out=FOLDER / "drop")
        told = json.loads(command("run", "--tooth", molar(), "--motion", "drop", "--voxel", "100", "--json", "--out",
                                  FOLDER / "drop-by-command"))
        for key in ("ticks", "peak_force_n", "deepest_mm", "contact_s", "largest_area_mm2", "method", "hand"):
            self.assertEqual(done.summary[key], told[key])
        with open(FOLDER / "drop-by-command" / "trace.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["depth_mm"] for row in rows], [f"{d:.9f}" for d in done.samples["depth_mm"]])
        self.assertEqual([row["fz_n"] for row in rows], [f"{f:.7f}" for f in done.samples["force_n"][:, 2]])
        self.assertEqual((done.session, done.state_hash), (None, ""))

    def test_a_motion_of_ones_own(self):
        given = np.array([[0, 0, 0, 1, 1, 0, 0, 0], [0.5, 0, 0, -0.2, 1, 0, 0, 0], [1, 0, 0, 1, 1, 0, 0, 0]], float)
        path = FOLDER / "motion.csv"
        path.write_text("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n" + "\n".join(",".join(map(repr, row)) for row in given.tolist()))
        by_array = hp.run(block(), given, voxel_mm=0.1, pedal=1.0)
        by_file = hp.run(block(), path, voxel_mm=0.1, pedal=1.0)
        self.assertEqual(by_array.state_hash, by_file.state_hash)
        self.assertEqual(by_array.summary["motion"], "motion")
        self.assertError("does not come after", hp.run, block(), given[::-1], voxel_mm=0.1)

    def test_a_session(self):
        told = json.loads(command("replay", plunge().session, "--json"))
        mine = hp.replay(plunge().session)
        self.assertEqual(mine, told)
        self.assertTrue(mine["matches"])
        with hp.Session(plunge().session) as session:
            samples, run = session.samples(), plunge().samples
            self.assertEqual(len(session), len(run["tick"]))
            for name in ("tick", "time_s", "position_mm", "orientation", "flags", "tissue"):
                np.testing.assert_array_equal(samples[name], run[name], name)
            np.testing.assert_allclose(samples["removed_mm3"], run["removed_mm3"], atol=1e-5)
            np.testing.assert_allclose(samples["force_n"], run["force_n"], atol=1e-3)
            some = session.samples(100, 50)
            np.testing.assert_array_equal(some["position_mm"], samples["position_mm"][100:150])
            self.assertEqual(len(session.samples(len(session))["tick"]), 0)
            names = [event["name"] for event in session.events()]
            self.assertIn("stroke begin", names)
            self.assertEqual(names[-1], "end")
            self.assertEqual(session.key_frame(-1).tick, session.key_frame_ticks[-1])
            self.assertGreater(len(session.key_frame(-1).state), 100)
            self.assertEqual(session.tooth_at().state_hash, told["state_hash"])
            self.assertNotEqual(session.tooth_at(0.0).state_hash, told["state_hash"])
            self.assertEqual(session.settings["bur"]["name"] if isinstance(session.settings["bur"], dict) else "330", "330")

    def test_a_score(self):
        exercise = hp.open_exercise("dexterity-line")
        done = hp.run(exercise.case.path, "plunge", voxel_mm=exercise.voxel_mm, depth_mm=0.5, dwell_s=0.1)
        told = json.loads(command("score", done.session, "--exercise", exercise.path, "--json", "--anew"))
        mine = hp.score(done.session, exercise, anew=True)
        self.assertIn("cut again", mine.pop("proof"))
        self.assertEqual(mine, told)
        self.assertFalse(hp.score(done.session, exercise, prove=False)["proven"])


if __name__ == "__main__":
    unittest.main()
