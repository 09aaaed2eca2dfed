# SPDX-License-Identifier: Apache-2.0
"""Help, exit codes and completion."""

import re
import shutil
import subprocess
import unittest

from support import SystemTest, run

COMMANDS = [["make"], ["make", "tooth"], ["make", "bur"], ["make", "turbine"], ["make", "plane"], ["mesh"],
            ["mesh", "info"], ["mesh", "repair"], ["case"], ["case", "info"], ["case", "check"],
            ["case", "new"], ["case", "pack"], ["probe"], ["run"], ["reproduce"], ["bench"], ["passivity"],
            ["completion"]]


class Usage(SystemTest):
    def test_help_of_everything(self):
        overview = self.ok("--help").stdout
        for command in COMMANDS:
            with self.subTest(command=command):
                done = self.ok(*command, "--help")
                description = done.stdout.strip().splitlines()[0]
                self.assertGreater(len(description), 15, "a description comes first")
                self.assertIn(f"handpiece {' '.join(command)}", done.stdout, "an example or the usage names it")
                if len(command) == 1:
                    self.assertIn(command[0], overview)

    def test_every_option_is_explained(self):
        options = 0
        for command in COMMANDS:
            lines = self.ok(*command, "--help").stdout.splitlines()
            for line, following in zip(lines, lines[1:] + [""]):
                if not re.match(r"  (-\w, )?--[a-z]", line):
                    continue
                options += 1
                beside = len(line) > 34 and line[34] != " "
                below = following.startswith(" " * 34) and following.strip()
                self.assertTrue(beside or below, f"{command}: {line}")
        self.assertGreater(options, 40)

    def test_version(self):
        self.assertRegex(self.ok("--version").stdout, r"^handpiece \d+\.\d+\.\d+\n$")

    def test_wrong_usage_is_2(self):
        for arguments in ([], ["drill"], ["make"], ["mesh"], ["make", "tooth"], ["probe"], ["run"], ["reproduce"],
                          ["run", "--tooth", "x.stl", "--out", "y", "--speed"], ["mesh", "info"],
                          ["make", "tooth", "--faces", "many", "--out", "x"], ["make", "block", "--out", "--json"],
                          ["exercise", "trials", "--out", "--help"], ["probe", "--tooth", "x", "--nonsense"],
                          ["completion", "tcsh"], ["mesh", "repair", "a.stl", "b.stl", "--weld", "-1"]):
            with self.subTest(arguments=arguments):
                done = run(*arguments, cwd=self.folder)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertTrue(done.stderr.strip(), "says why")
                self.assertEqual(done.stdout, "")
        self.assertEqual(self.listing(), {})

    def test_completion_parses_and_completes(self):
        for shell in ("bash", "zsh", "fish"):
            script = self.ok("completion", shell).stdout
            self.assertIn("reproduce", script)
            if shutil.which(shell):
                subprocess.run([shell, "-n"], input=script, text=True, check=True)
        script = self.ok("completion", "bash").stdout
        ask = script + ('\nCOMP_WORDS=(handpiece make to); COMP_CWORD=2; _handpiece; echo "${COMPREPLY[@]}"\n'
                        'COMP_WORDS=(handpiece run --mo); COMP_CWORD=2; _handpiece; echo "${COMPREPLY[@]}"\n')
        answer = subprocess.run(["bash"], input=ask, capture_output=True, text=True, check=True).stdout.splitlines()
        self.assertEqual(answer, ["tooth", "--motion"])


if __name__ == "__main__":
    unittest.main()
