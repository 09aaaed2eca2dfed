# SPDX-License-Identifier: Apache-2.0
"""Wrong use gives a Python exception that says what is wrong, and never ends the interpreter."""
import _thread
import copy
import gc
import pickle
import sys
import threading
import time
import unittest

import numpy as np

from support import FOLDER, Test, block, box, hp, molar, plunge, poses, tooth


class Arrays(Test):
    def test_shapes(self):
        contact = hp.Contact(tooth(), "330")
        for wrong in (np.zeros((3, 6)), np.zeros((7, 1)), np.zeros((2, 2, 7)), np.zeros((3, 3)), np.zeros(()), np.zeros((4, 5, 4))):
            with self.assertRaisesRegex(ValueError, r"poses must have the shape \(n, 7\) or \(n, 4, 4\), not"):
                contact.probe(wrong)
        for wrong in (np.zeros((3, 2)), np.zeros(4), 1.0):
            with self.assertRaisesRegex(ValueError, r"points must have the shape"):
                tooth().field.distance(wrong)
        self.assertEqual(len(contact.probe(np.zeros((0, 7)))), 0)
        self.assertEqual(contact.probe(np.zeros((0, 7))).patch_centre_mm.shape, (0, 3))
        self.assertEqual(tooth().field.distance(np.zeros((0, 3))).shape, (0,))
        self.assertEqual(len(contact.probe(poses()[0])), 1)  # one by itself

    def test_types(self):
        contact = hp.Contact(tooth(), "330")
        ragged = [[1, 2], [3]]
        for wrong in ("poses", None, np.full((2, 7), "a"), np.zeros((2, 7), complex), np.array([[object()] * 7]), np.zeros((2, 7), bool),
                      ragged, {1: 2}):
            with self.assertRaisesRegex(TypeError, "poses must be an array of real numbers"):
                contact.probe(wrong)
        self.assertIsNone(sys.exc_info()[0])

    def test_numbers_that_are_no_poses(self):
        contact = hp.Contact(tooth(), "330")
        for column, value in ((0, np.nan), (2, np.inf), (3, np.nan)):
            wrong = poses(5)
            wrong[3, column] = value
            with self.assertRaisesRegex(ValueError, r"poses\[3\] is not finite"):
                contact.probe(wrong)
        wrong = poses(5)
        wrong[2, 3:] *= 2
        with self.assertRaisesRegex(ValueError, r"poses\[2\]: the quaternion's length is 2, not 1"):
            contact.probe(wrong)
        mirror, scaled, low = np.tile(np.eye(4), (2, 1, 1)), np.tile(np.eye(4), (2, 1, 1)), np.tile(np.eye(4), (2, 1, 1))
        mirror[1, 0, 0], scaled[1, :3, :3], low[1, 3] = -1, 2 * np.eye(3), (0, 0, 1, 1)
        for wrong in (mirror, scaled, low):
            with self.assertRaisesRegex(ValueError, r"poses\[1\] is no rigid placement"):
                contact.probe(wrong)

    def test_any_memory_will_do(self):
        given = poses(200)
        expected = hp.Contact(tooth(), "330").probe(given).depth_mm
        wide = np.zeros((200, 14))
        wide[:, ::2] = given
        fixed = given.copy()
        fixed.setflags(write=False)
        contact = hp.Contact(tooth(), "330")
        for same in (wide[:, ::2], np.asfortranarray(given), given[::-1][::-1], fixed, given.astype(">f8"), given.tolist()):
            np.testing.assert_array_equal(contact.probe(same).depth_mm, expected)
        np.testing.assert_allclose(contact.probe(given.astype(np.float32)).depth_mm, expected, atol=1e-5)
        unaligned = np.frombuffer(b"\0" + given.tobytes(), np.uint8)[1:].view(np.float64).reshape(given.shape)
        np.testing.assert_array_equal(contact.probe(unaligned).depth_mm, expected)

    def test_meshes(self):
        vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        for error, v, f in ((ValueError, vertices, [(0, 1, 3)]), (ValueError, vertices, [(0, 1, -1)]), (ValueError, vertices, [0, 1, 2]),
                            (TypeError, vertices, [(0.0, 1.0, 2.0)]), (TypeError, vertices, "faces"), (TypeError, None, [(0, 1, 2)]),
                            (ValueError, [(0, 0, np.nan)] * 3, [(0, 1, 2)]), (TypeError, vertices, [])):
            with self.assertRaises(error):
                hp.Mesh(v, f)
        faces = np.frombuffer(b"\0" + np.array([[0, 1, 2]]).tobytes(), np.uint8)[1:].view(np.int64).reshape(1, 3)  # not aligned
        np.testing.assert_array_equal(hp.Mesh(vertices, faces).faces, [[0, 1, 2]])
        empty = hp.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))
        self.assertEqual((empty.vertices.shape, empty.faces.shape), ((0, 3), (0, 3)))
        self.assertError("", empty.repair)
        self.assertError("weld_mm", box((0, 0, 0), (1, 1, 1)).repair, -1.0)
        self.assertError("weld_mm", box((0, 0, 0), (1, 1, 1)).repair, float("nan"))


class Names(Test):
    def test_values(self):
        for voxel in (-0.05, 0.0, float("nan"), float("inf"), 1e9):
            self.assertError("voxel", hp.prepare, molar(), voxel)
        self.assertError("no contact method", hp.Contact, tooth(), "330", "guess")
        self.assertError("", hp.Contact, tooth(), "no-such-bur")
        self.assertError("", hp.prepare, FOLDER / "nothing")
        self.assertError("", hp.read_mesh, FOLDER / "nothing.stl")
        self.assertError("unit", hp.read_mesh, block(), "mile")
        self.assertError("", hp.make_tooth, "dragon")
        self.assertError("", hp.make_tooth, fdi=99)
        self.assertError("fdi", hp.make_tooth, fdi=46, scene=True)
        self.assertError("", hp.make_tooth, faces=3)
        self.assertError("faces are not possible", hp.make_mouth, faces=2 * 10**9)
        self.assertError("", hp.Session, block())
        self.assertError("", hp.replay, block())
        self.assertError("", hp.score, plunge().session, "no-such-exercise")
        self.assertError("1024", hp.set_threads, 10**6)
        for wrong in (None, 3, tooth()):
            with self.assertRaises(TypeError):
                hp.prepare(wrong)
        for call in (lambda: hp.set_threads(-1), lambda: hp.make_tooth(faces=-1), lambda: hp.prepare(molar(), "thin"),
                     lambda: hp.make_tooth(progress=3), lambda: hp.Contact(molar(), "330"), lambda: hp.Bur(), lambda: hp.Field()):
            with self.assertRaises(TypeError):
                call()

    def test_runs(self):
        for name, value in (("rate_hz", 3.0), ("pedal", 2.0), ("load_n", 0.0), ("depth_mm", -1.0), ("tremor_um", 1e9), ("drive", "steam"),
                            ("hand", "third"), ("force", "dark"), ("device_model", "x"), ("voxel_mm", -0.1), ("at_mm", (1.0,)),
                            ("duration_s", float("nan")), ("bur", "x"), ("method", "x"), ("tissues", str(FOLDER / "nothing.toml"))):
            self.assertError("", hp.run, block(), "plunge", **{name: value})
        self.assertError("", hp.run, block(), "dance")
        self.assertError("cut with field", hp.run, block(), "plunge", method="hull")
        for name, value in (("rate_hz", "fast"), ("pedal", []), ("at_mm", ("a", "b")), ("seed", -1), ("seed", 1.5), ("code", 3)):
            with self.assertRaises(TypeError):
                hp.run(block(), "plunge", **{name: value})
        for wrong in (np.zeros((2, 7)), np.zeros(8), np.full((2, 8), np.nan)):
            with self.assertRaises(ValueError):
                hp.run(block(), wrong)
        with self.assertRaises(TypeError):
            hp.run(block(), "drop", speed=3)  # no such name

    def test_an_error_has_parts(self):
        error = self.assertError("there is no contact method called \"guess\"", hp.Contact, tooth(), "330", "guess")
        self.assertEqual((error.where, error.todo.split()[0], error.id), ("method", "choose", ""))
        self.assertEqual(str(error), f"{error.where}: {error.what} ({error.todo})")
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((again.what, again.where, again.todo, str(again)), (error.what, error.where, error.todo, str(error)))
        self.assertIsInstance(error, Exception)


class Lives(Test):
    def test_a_view_outlives_its_owner(self):
        def views():
            probe = hp.Contact(hp.prepare(molar(), 0.2), "330").probe(poses(100))
            prepared = hp.prepare(molar(), 0.2)
            case = hp.read_case(molar())
            session = hp.Session(plunge().session)
            samples = session.samples()
            run = hp.run(block(), "plunge", voxel_mm=0.1, depth_mm=0.2, dwell_s=0.1)
            return [prepared.field.bricks, prepared.field.brick_index, prepared.field.coarse, prepared.outer.vertices, case.outer.faces,
                    case.parts[0].mesh.vertices, probe.depth_mm, probe.normal, probe.patch_centre_mm, samples["force_n"],
                    samples["removed_mm3"], run.samples["position_mm"], hp.Bur("330").mesh.vertices]

        kept = views()
        before = [view.tobytes() for view in kept]
        gc.collect()
        filler = [np.full(1 << 20, 255, np.uint8) for _ in range(20)]
        self.assertEqual(before, [view.tobytes() for view in kept])
        del filler
        for view in kept:
            with self.assertRaises(ValueError):
                view[...] = 0
            with self.assertRaises(ValueError):
                view.setflags(write=True)
            self.assertGreater(view.size, 0)

    def test_a_runs_folder_goes_with_it(self):
        run = hp.run(block(), "plunge", voxel_mm=0.1, depth_mm=0.2, dwell_s=0.1)
        place, samples = run.out, run.samples
        self.assertTrue((place / "session.h5").exists())
        del run
        gc.collect()
        self.assertFalse(place.exists())
        self.assertGreater(np.ptp(samples["position_mm"][:, 2]), 0.5)

    def test_copies_and_pickles(self):
        session = hp.Session(plunge().session)
        for thing in (tooth(), tooth().field, hp.Bur("330"), hp.Contact(tooth(), "330"), session, tooth().outer, hp.read_case(molar()),
                      hp.Contact(tooth(), "330").probe(poses(3))):
            for call in (pickle.dumps, copy.copy, copy.deepcopy):
                with self.assertRaisesRegex(TypeError, "pickle"):
                    call(thing)

    def test_one_that_was_never_made(self):
        for kind in (hp.Contact, hp.Mesh, hp.Bur, hp.Session, hp.Tooth, hp.Field):
            empty = kind.__new__(kind)
            names = [name for name in dir(kind) if not name.startswith("_")]
            self.assertTrue(names)
            for name in names:
                with self.assertRaises((TypeError, ValueError, RuntimeError), msg=f"{kind.__name__}.{name}"):
                    value = getattr(empty, name)
                    if callable(value):
                        value()

    def test_a_closed_session(self):
        session = hp.Session(plunge().session)
        samples = session.samples()
        session.close()
        session.close()
        for call in (session.samples, session.events, lambda: len(session), lambda: session.key_frame(0), session.tooth_at,
                     lambda: session.rate_hz):
            self.assertEqual(self.assertError("closed", call).id, "session-closed")
        self.assertGreater(np.ptp(samples["position_mm"][:, 2]), 0)

    def test_places_in_a_session(self):
        with hp.Session(plunge().session) as session:
            for wrong in (10**6, -10**6):
                with self.assertRaises(IndexError):
                    session.key_frame(wrong)
            for call in (lambda: session.samples(-1), lambda: session.samples(0, -1), lambda: session.tooth_at(-1.0),
                         lambda: session.tooth_at(float("nan"))):
                with self.assertRaises(ValueError):
                    call()
            self.assertEqual(len(session.samples(2**62, 2**62)["tick"]), 0)


class Threads(Test):
    def test_two_threads_on_one_contact(self):
        contact = hp.Contact(tooth(), "330")
        given = poses(20000)
        expected = contact.probe(given).depth_mm
        caught, right = [], []

        def ask():
            for _ in range(5):
                try:
                    right.append(np.array_equal(contact.probe(given).depth_mm, expected))
                except hp.Error as error:
                    caught.append(error.id)

        threads = [threading.Thread(target=ask) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(right and all(right))
        self.assertEqual(set(caught), {"contact-busy"})
        self.assertEqual(len(right) + len(caught), 20)
        self.assertTrue(np.array_equal(contact.probe(given).depth_mm, expected))  # free again

    def test_threads_side_by_side(self):
        """One tooth, a Contact a thread; others read sessions and fields."""
        given, wrong = poses(2000), []
        expected = hp.Contact(tooth(), "330").probe(given).depth_mm
        session = hp.Session(plunge().session)
        count = len(session)

        def ask():
            mine = hp.Contact(tooth(), "330")
            for _ in range(3):
                if not np.array_equal(mine.probe(given).depth_mm, expected) or len(session.samples()["tick"]) != count:
                    wrong.append(1)
                tooth().field.distance(given[:, :3])

        threads = [threading.Thread(target=ask) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_others_work_meanwhile(self):
        """The lock of Python is free while C++ works."""
        counted = [0]
        stop = threading.Event()

        def count():
            while not stop.is_set():
                counted[0] += 1
                time.sleep(0.001)

        contact, given = hp.Contact(tooth(), "330"), poses(40000)
        thread = threading.Thread(target=count)
        thread.start()
        counted[0] = 0
        contact.probe(given)
        meanwhile = counted[0]
        stop.set()
        thread.join()
        self.assertGreater(meanwhile, 3)


class Long(Test):
    def test_progress(self):
        seen = []
        hp.prepare(molar(), 0.1, cache=False, progress=seen.append)
        self.assertEqual(seen[-1], 1.0)
        self.assertEqual(seen, sorted(seen))
        for call in (lambda p: hp.prepare(molar(), 0.05, cache=False, progress=p), lambda p: hp.make_tooth(faces=20000, progress=p),
                     lambda p: hp.Contact(tooth(), "330").probe(poses(5000), progress=p),
                     lambda p: hp.run(block(), "plunge", voxel_mm=0.1, progress=p), lambda p: hp.replay(plunge().session, progress=p)):
            self.assertError("cancelled", call, lambda fraction: False)
            with self.assertRaisesRegex(ZeroDivisionError, "division"):
                call(lambda fraction: 1 / 0)
        self.assertTrue(hp.replay(plunge().session)["matches"])  # nothing is left of it

    def test_ctrl_c(self):
        contact, given = hp.Contact(tooth(), "330"), poses(400000)
        for call in (lambda: contact.probe(given), lambda: hp.run(block(), "class-one", voxel_mm=0.1, dwell_s=600.0, length_mm=2.0)):
            timer = threading.Timer(0.3, _thread.interrupt_main)
            begun = time.monotonic()
            timer.start()
            with self.assertRaises(KeyboardInterrupt):
                call()
                time.sleep(30)
            self.assertLess(time.monotonic() - begun, 10)
        self.assertEqual(len(contact.probe(given[:10])), 10)


class Flat(hp.Method):
    """The tooth as a table at z = 1, the bur as a point."""

    name = "flat"

    def depth(self, pose):
        return 1.0 - pose[2], (0, 0, 1), (pose[0], pose[1], 1.0)


def own(answer):
    """A method that gives or raises this."""
    class Own(hp.Method):
        def depth(self, pose):
            if isinstance(answer, BaseException):
                raise answer
            return answer
    return Own()


class OwnMethods(Test):
    def test_right(self):
        given = poses(100)
        probe = hp.Contact(tooth(), "330", Flat()).probe(given)
        np.testing.assert_array_equal(probe.depth_mm, 1.0 - given[:, 2])
        np.testing.assert_array_equal(probe.normal, np.tile([0, 0, 1.0], (100, 1)))
        for answer in (0.5, 1, np.float32(0.5), np.float64(0.5), np.array(0.5), (0.5, [0, 0, 1]), (0.5, np.array([1, 0, 0]))):
            depth = answer[0] if isinstance(answer, tuple) else answer
            self.assertEqual(hp.Contact(tooth(), "330", own(answer)).probe(given).depth_mm[7], float(depth))
        self.assertEqual(hp.Contact(tooth(), "330", Flat()).method, "flat")

    def test_nonsense(self):
        for answer in ("deep", None, [0.5], (0.5,), (0.5, [0, 0, 1], [0, 0, 0], 1), {}, (None, [0, 0, 1]), ("x", [0, 0, 1]), (0.5, "up"), 1j):
            with self.assertRaises(TypeError, msg=repr(answer)):
                hp.Contact(tooth(), "330", own(answer)).probe(poses(10))
        for answer in (float("nan"), float("inf"), (0.5, [0, 0, 2]), (0.5, [0, 0]), (0.5, [[0, 0, 1], [0, 0, 1]]), (0.5, [0, 0, np.nan])):
            with self.assertRaises(ValueError, msg=repr(answer)):
                hp.Contact(tooth(), "330", own(answer)).probe(poses(10))
        for wrong in (None, 3, object(), Flat):
            with self.assertRaises(TypeError):
                hp.Contact(tooth(), "330", wrong).probe(poses(2))

    def test_what_it_raises_comes_out(self):
        given = poses(100)
        for error in (KeyError("x"), hp.Error("mine"), KeyboardInterrupt(), SystemExit(3)):
            contact = hp.Contact(tooth(), "330", own(error))
            for _ in range(2):  # and the next call begins anew
                with self.assertRaises(type(error)):
                    contact.probe(given)
        with self.assertRaises(NotImplementedError):
            hp.Contact(tooth(), "330", hp.Method()).probe(given)

    def test_one_that_asks_its_own_contact(self):
        holder = []

        class Greedy(hp.Method):
            def depth(self, pose):
                return float(holder[0].probe(pose).depth_mm[0])

        holder.append(hp.Contact(tooth(), "330", Greedy()))
        self.assertEqual(self.assertError("another thread", holder[0].probe, poses(3)).id, "contact-busy")

    def test_in_a_run(self):
        done = hp.run(block(), "drop", method=Flat(), voxel_mm=0.1, duration_s=0.3)
        self.assertEqual(done.summary["method"], "flat")
        np.testing.assert_allclose(done.samples["depth_mm"], 1.0 - done.samples["position_mm"][:, 2], atol=1e-9)
        self.assertGreater(done.summary["peak_force_n"], 0.1)
        for answer, error in ((0.5, ValueError), ("x", TypeError), (KeyError("x"), KeyError), (KeyboardInterrupt(), KeyboardInterrupt)):
            with self.assertRaises(error):
                hp.run(block(), "drop", method=own(answer), voxel_mm=0.1)


if __name__ == "__main__":
    unittest.main()
