# SPDX-License-Identifier: Apache-2.0
"""The stubs say what the module has: every name, every parameter, in the order and of the kind; every one is documented."""
import ast
import inspect
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

import handpiece
from handpiece import _core

PACKAGE = pathlib.Path(handpiece.__file__).resolve().parent
# What pybind11 gives every class, and what needs no words.
SILENT = {"__init__", "__repr__", "__len__", "__enter__", "__exit__"}


def parameters(arguments):
    """(name, has a default, by keyword alone) of each."""
    plain = arguments.posonlyargs + arguments.args
    optional = len(plain) - len(arguments.defaults)
    found = [(a.arg, i >= optional, False) for i, a in enumerate(plain)]
    return found + [(a.arg, d is not None, True) for a, d in zip(arguments.kwonlyargs, arguments.kw_defaults)]


def signature(thing):
    """As pybind11 writes it in the first line of a docstring."""
    line = thing.__doc__.splitlines()[0]
    line = re.sub(r"handpiece\._core\.|numpy\.|_core\.", "", line)
    return parameters(ast.parse(f"def {line}: ...").body[0].args)


class Stubs(unittest.TestCase):
    def setUp(self):
        self.tree = ast.parse((PACKAGE / "_core.pyi").read_text(encoding="utf-8"))

    def functions(self, body):
        return {node.name: node for node in body if isinstance(node, ast.FunctionDef)}

    def test_every_name(self):
        stubbed = {node.name for node in self.tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        stubbed |= {node.target.id for node in self.tree.body if isinstance(node, ast.AnnAssign)}
        there = {name for name in vars(_core) if not name.startswith("_")} | {"__version__"}
        self.assertEqual(stubbed, there)
        self.assertTrue((PACKAGE / "py.typed").exists())

    def test_functions(self):
        functions = self.functions(self.tree.body)
        self.assertGreater(len(functions), 10)
        for name, node in functions.items():
            with self.subTest(name):
                self.assertEqual(parameters(node.args), signature(getattr(_core, name)))
                self.assertIsNotNone(node.returns)

    def test_classes(self):
        for node in self.tree.body:
            if not isinstance(node, ast.ClassDef):
                continue
            real = getattr(_core, node.name)
            functions = self.functions(node.body)
            there = {name for name in vars(real) if not name.startswith("__")}
            self.assertEqual({name for name in functions if not name.startswith("__")}, there, node.name)
            for name, function in functions.items():
                with self.subTest(f"{node.name}.{name}"):
                    value = inspect.getattr_static(real, name)
                    if isinstance(value, property):
                        self.assertTrue(any(d.id == "property" for d in function.decorator_list))
                    elif name not in ("__exit__", "__len__", "__enter__"):
                        self.assertEqual(parameters(function.args), signature(value))

    def test_everything_is_documented(self):
        for name in handpiece.__all__:
            thing = getattr(handpiece, name)
            if isinstance(thing, (str, tuple)):
                continue
            self.assertGreater(len((thing.__doc__ or "").split()), 3, name)
            if inspect.isclass(thing) and thing.__module__ == "handpiece":
                for member, value in vars(thing).items():
                    if member.startswith("__") or not (callable(value) or isinstance(value, property)):
                        continue
                    text = value.fget.__doc__ if isinstance(value, property) else value.__doc__
                    text = re.sub(r"^\w+\(.*\n", "", text or "")
                    self.assertTrue(text.strip(), f"{name}.{member}")

    def test_all_is_all(self):
        public = {name for name, value in vars(handpiece).items() if not name.startswith("_") and not inspect.ismodule(value)}
        self.assertEqual(set(handpiece.__all__) - {"__version__"}, public)

    def test_types_hold(self):
        if not shutil.which("mypy"):
            self.skipTest("mypy is not installed")
        examples = sorted(str(path) for path in (pathlib.Path(__file__).resolve().parents[2] / "examples").glob("*.py"))
        done = subprocess.run(["mypy", "--strict", "--ignore-missing-imports", "--no-incremental", "--cache-dir=/dev/null",
                               "--python-executable", sys.executable, str(PACKAGE / "__init__.py")], capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue(examples)


if __name__ == "__main__":
    unittest.main()
