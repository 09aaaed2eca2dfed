# SPDX-License-Identifier: Apache-2.0
"""Session files as others read them: with plain h5py, after kill -9 at random moments, and as CSV."""

import concurrent.futures
import os
import random
import statistics
import subprocess
import sys
import threading
import time
import unittest

try:
    import h5py
    import numpy
except ImportError:  # another Python than Debian's, which has python3-h5py
    if sys.executable != "/usr/bin/python3" and os.path.exists("/usr/bin/python3"):
        os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])
    print("skipped: there is no h5py (python3-h5py)")
    sys.exit(0)

from support import SystemTest, rows_of

CHILD = os.environ["HANDPIECE_SESSION_CHILD"]
KILLS = int(os.environ.get("HANDPIECE_SESSION_KILLS", "50"))
AT_ONCE, FEW_AT_ONCE = 13, 5
SEED = int(os.environ.get("HANDPIECE_TEST_SEED", "20261121"))


class Victim(threading.Thread):
    """Starts a recorder, kills it `seconds` after it has handed over so many ticks, and notes what it had handed over
    by then."""

    def __init__(self, path, manner, ticks, seconds=0.0):
        super().__init__()
        self.path, self.manner, self.ticks, self.seconds = path, manner, ticks, seconds
        self.told = []  # ticks handed over, ms for which the machine has kept threads waiting
        self.begun_s = 0.0

    @property
    def handed(self):
        return self.told[-1][0] if self.told else 0

    def most_lost(self):
        """A second, and what the machine took from the recorder in the last two."""
        before = [held for handed, held in self.told if handed <= self.handed - 2000]
        return 1000 + self.told[-1][1] - (before[-1] if before else 0) if self.told else 0

    def run(self):
        start = time.monotonic()
        with subprocess.Popen([CHILD, str(self.path), self.manner], stdout=subprocess.PIPE, text=True) as child:
            killer = threading.Timer(self.seconds, child.kill)
            waits = self.ticks > 0
            if not waits:
                killer.start()
            for line in child.stdout:
                if not line.endswith("\n"):
                    break
                self.begun_s = self.begun_s or time.monotonic() - start
                self.told.append(tuple(map(int, line.split())))
                if waits and self.handed >= self.ticks:
                    waits = False
                    killer.start()
            child.kill()
        killer.cancel()


def is_begun(test, victim):
    """False for one that was killed before its file was in its place: nothing was handed over then."""
    if not victim.path.exists():
        test.assertEqual(victim.handed, 0, victim.path)
    return victim.path.exists()


def read_all(file):
    """Every dataset of an open file, to the length of the shortest."""
    ticks = file["samples/tick"][:]
    for name, dataset in file["samples"].items():
        assert len(dataset) >= len(ticks), name
        dataset[:]
    return ticks


class Session(SystemTest):
    def kill(self, victims, at_once=AT_ONCE):
        """All of them, so many at a time."""
        with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
            list(pool.map(Victim.run, victims))
        for victim in victims:
            self.assertGreaterEqual(victim.handed, victim.ticks, victim.path)
        return victims

    def victims(self, count, manner, least, most):
        """That are killed somewhere about a number of ticks, between any two of them."""
        generator = random.Random(f"{SEED}-{manner}")
        return [Victim(self.folder / f"{manner}-{i}.h5", manner, generator.randrange(least, most),
                       generator.uniform(0.0, 0.02)) for i in range(count)]

    def one(self, name, ticks):
        return self.kill([Victim(self.folder / name, "steady", ticks)])[0]

    def wait_until(self, is_so, what):
        deadline = time.monotonic() + 60
        while not is_so():
            self.assertLess(time.monotonic(), deadline, what)
            time.sleep(0.01)

    def test_kill_loses_at_most_a_second(self):
        """The machine may be busy: what a late child has not handed over is not lost by the recorder, and how long
        its threads were kept waiting is counted."""
        worst = 0
        for victim in self.kill(self.victims((KILLS + 1) // 2, "steady", 500, 3000), FEW_AT_ONCE):
            if not is_begun(self, victim):
                continue
            with h5py.File(victim.path, "r") as file:
                ticks = read_all(file)
                self.assertEqual(file["closed"][()], 0)
                self.assertEqual(list(ticks), list(range(len(ticks))))
                frames = file["key_frames/index"][:]
                for frame in frames:
                    data = file["key_frames/data"][int(frame["offset"]):int(frame["offset"] + frame["bytes"])]
                    self.assertTrue(len(data) == 300000 and (data == 3).all())
                worst = max(worst, victim.handed - len(ticks))
                self.assertLessEqual(victim.handed - len(ticks), victim.most_lost(), victim.path)
        print(f"worst loss {worst} ms", flush=True)

    def test_kill_while_it_writes_all_the_time(self):
        lengths = []
        for victim in self.kill(self.victims(KILLS // 2, "fast", 5000, 30000)):
            if not is_begun(self, victim):
                continue
            with h5py.File(victim.path, "r") as file:
                ticks = read_all(file)
                self.assertEqual(list(ticks), list(range(len(ticks))))
                self.assertTrue((numpy.diff(file["events"]["tick"].astype(int)) > 0).all())
                lengths.append(len(ticks))
            done = self.ok("export", victim.path, "--csv", "--events")
            self.assertEqual(done.stdout.splitlines()[0], "tick,t_s,name,text")
            os.remove(victim.path)
        self.assertGreater(max(lengths), 10000)

    def test_kill_in_the_first_instant(self):
        """There is a file that can be read or there is none."""
        first = [Victim(self.folder / f"first-{i}.h5", "steady", 1) for i in range(AT_ONCE)]
        takes_s = statistics.median(victim.begun_s for victim in self.kill(first))  # here and now
        generator = random.Random(f"{SEED}-instant")
        victims = self.kill([Victim(self.folder / f"instant-{i}.h5", "steady", 0, generator.uniform(0.0, 2 * takes_s))
                             for i in range(KILLS - AT_ONCE)]) + first
        begun = [victim for victim in victims if is_begun(self, victim)]
        for victim in begun:
            with h5py.File(victim.path, "r") as file:
                read_all(file)
        print(f"{len(begun)} of {len(victims)} had begun, which took {takes_s:.3f} s", flush=True)
        self.assertGreaterEqual(len(begun), len(first))

    def test_h5py_reads_what_the_readme_says(self):
        victim = self.one("whole.h5", 2500)
        with h5py.File(victim.path, "r") as file:
            readme = file["README"][()].decode()
            self.assertIn("h5py.File", readme)
            self.assertEqual(file.attrs["format"].decode(), "handpiece-session")
            self.assertEqual(int(file.attrs["format_version"]), 4)
            self.assertEqual(file.attrs["code"].decode(), "child")
            n = len(file["samples/tick"])
            x = file["samples/position"][:n] * 2.0**-20
            self.assertTrue((numpy.abs(x) < 10).all())
            xyz = file["samples/orientation"][:n].astype(numpy.int64)
            code = file["samples/orientation_w"][:n].astype(numpy.int64)
            w = numpy.sqrt(1 - (xyz.astype(float)**2).sum(axis=1) * 2.0**-60) * numpy.where(code & 1, -1, 1)
            self.assertTrue((numpy.abs(code) < 20).all())
            self.assertTrue((w > 0.9).all())
            for name, dataset in file["samples"].items():
                self.assertTrue(dataset.attrs["unit"].decode(), name)
                self.assertTrue(dataset.attrs["description"].decode(), name)
            self.assertEqual(set(file["events"]["name"]), {b"stroke begin"})
            force = file["samples/force"][:n]
        rows = rows_of(self.ok("export", victim.path, "--csv").stdout)
        self.assertEqual(len(rows), n)
        for i in (0, 17, n - 1):
            self.assertEqual(int(rows[i]["tick"]), i)
            self.assertAlmostEqual(float(rows[i]["t_s"]), i / 1000)
            self.assertAlmostEqual(float(rows[i]["x_mm"]), x[i, 0], places=6)
            self.assertAlmostEqual(float(rows[i]["qw"]), w[i], places=8)
            self.assertAlmostEqual(float(rows[i]["fz_N"]), float(force[i, 2]), places=3)

    def test_a_reader_is_welcome_while_it_is_written(self):
        victim = Victim(self.folder / "live.h5", "steady", 5000)
        victim.start()
        seen = []
        for handed in (1500, 2500, 3500):
            self.wait_until(lambda: victim.handed >= handed, f"{handed} ticks")
            with h5py.File(victim.path, "r") as file:
                seen.append(len(read_all(file)))
        victim.join()
        self.assertGreater(seen[0], 0)
        self.assertGreater(seen[2], seen[0])

    def test_bad_sessions_are_one_message(self):
        victim = self.one("whole.h5", 1500)
        whole = victim.path.read_bytes()
        newer = self.folder / "newer.h5"
        newer.write_bytes(whole)
        with h5py.File(newer, "r+") as file:
            file.attrs.modify("format_version", numpy.int32(99))
        other = self.folder / "other.h5"
        with h5py.File(other, "w") as file:
            file["x"] = 1
        typed = self.folder / "typed.h5"
        typed.write_bytes(whole)
        with h5py.File(typed, "r+") as file:
            del file["samples/force"]
            file["samples/force"] = numpy.zeros((5, 3))
        linked = self.folder / "linked.h5"
        linked.write_bytes(whole)
        with h5py.File(linked, "r+") as file:
            del file["events"]
            file["events"] = h5py.ExternalLink("newer.h5", "events")
        half = self.folder / "half.h5"
        half.write_bytes(whole[:len(whole) // 2])
        self.refused("export", newer, "--csv", mentions=["newer", "format 99"])
        self.refused("export", other, "--csv", mentions=["no session"])
        self.refused("export", typed, "--csv", mentions=["force"])
        self.refused("export", linked, "--csv", mentions=["events"])
        self.refused("export", half, "--csv", mentions=["damaged"])
        self.refused("export", self.folder / "none.h5", "--csv", mentions=["no such file"])
        self.refused("export", victim.path, mentions=["--csv"])
        self.refused("replay", victim.path, mentions=["tooth"])  # the child records none
        self.refused("replay", newer, mentions=["newer", "format 99"])


if __name__ == "__main__":
    unittest.main()
