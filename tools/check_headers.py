#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every header stands on its own, proven without compiling each a second time: a header is the first include of some
source file, so the ordinary build compiles it before anything else, and what the precompiled headers would hide (the
standard library) is held here by name. And every header is public or private to its room: the HEADERS line of the
room's CMakeLists names the public ones, which alone are installed. Nobody else but tests and bench includes a private
one, no public one includes a private one, and a public one is included from outside or by another public one. Exit 1
with one line a breach.
    tools/check_headers.py            checks
    tools/check_headers.py --alone    lists the public headers that no source file includes first: the tests' build compiles those alone"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SRC = ROOT / "src"
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"", re.DOTALL)

# Standard header -> the names of std that need it; any one of several headers will do where a name stands in several.
NAMES = {
    "algorithm": "sort stable_sort min max clamp copy copy_n fill fill_n all_of any_of none_of find find_if lower_bound upper_bound reverse rotate transform unique remove_if count_if max_element min_element minmax nth_element partial_sort binary_search equal",
    "array": "array", "atomic": "atomic atomic_bool memory_order memory_order_relaxed memory_order_acquire memory_order_release",
    "bit": "bit_cast endian popcount countr_zero bit_ceil", "charconv": "from_chars to_chars", "chrono": "chrono",
    "cmath": "sqrt abs sin cos tan asin acos atan atan2 exp log log2 log10 pow floor ceil round lround fabs hypot isfinite isnan isinf fmod copysign cbrt",
    "complex": "complex", "condition_variable": "condition_variable",
    "cstddef": "size_t ptrdiff_t byte nullptr_t max_align_t",
    "cstdint": "int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t uintptr_t intptr_t",
    "cstring": "memcpy memcmp memset memmove strlen strcmp", "deque": "deque", "exception": "exception exception_ptr current_exception rethrow_exception terminate",
    "filesystem": "filesystem", "functional": "function less greater hash reference_wrapper ref cref invoke", "future": "future promise async",
    "initializer_list": "initializer_list", "iosfwd": "ostream istream", "istream": "istream", "ostream": "ostream", "limits": "numeric_limits", "list": "list", "map": "map multimap",
    "memory": "unique_ptr shared_ptr weak_ptr make_unique make_shared enable_shared_from_this addressof",
    "mutex": "mutex lock_guard unique_lock scoped_lock once_flag call_once recursive_mutex", "numbers": "numbers", "numeric": "accumulate iota inner_product reduce",
    "optional": "optional nullopt nullopt_t", "queue": "queue priority_queue", "random": "mt19937 mt19937_64 uniform_real_distribution normal_distribution",
    "set": "set multiset", "shared_mutex": "shared_mutex shared_lock", "span": "span as_bytes as_writable_bytes dynamic_extent",
    "stdexcept": "runtime_error logic_error invalid_argument out_of_range", "string": "string to_string stoi stod getline", "string_view": "string_view",
    "system_error": "error_code errc system_error", "thread": "thread jthread this_thread", "tuple": "tuple tie make_tuple apply",
    "type_traits": "is_same_v enable_if_t decay_t remove_cvref_t is_trivially_copyable_v is_base_of_v conditional_t is_invocable_v underlying_type_t is_integral_v is_floating_point_v invoke_result_t remove_reference_t",
    "unordered_map": "unordered_map", "unordered_set": "unordered_set",
    "utility": "move forward swap pair exchange declval in_place make_pair index_sequence make_index_sequence", "variant": "variant visit monostate get_if holds_alternative", "vector": "vector",
}
# What these bring along for certain (the standard says so, or the name is part of their own interface).
BRINGS = {
    "cstddef": set("array span string string_view vector memory map set atomic initializer_list cstring filesystem deque unordered_map bit type_traits functional".split()),
    "initializer_list": set("vector string map set array algorithm deque unordered_map optional utility".split()),
    "utility": set("map set memory algorithm vector optional variant tuple functional array string unordered_map thread mutex span".split()),
    "string_view": {"string", "filesystem"}, "string": {"filesystem", "stdexcept", "system_error"}, "exception": {"stdexcept", "system_error", "thread"}, "system_error": {"filesystem", "thread", "mutex"},
    "cstdint": {"chrono", "atomic", "random"}, "tuple": {"map", "memory", "functional"}, "iosfwd": {"string", "memory", "filesystem", "ostream", "istream"}, "type_traits": {"utility", "optional", "functional", "memory", "span", "bit"},
    "limits": {"random", "chrono"}, "functional": {"memory", "map"},
}
# The same the other way round: a name of std -> the headers of which any one will do.
NEEDS = {name: {h for h, names in NAMES.items() if name in names.split()} for names in NAMES.values() for name in names.split()}


def includes(path):
    return INCLUDE.findall(path.read_text(errors="replace"))


def standard_of(path, seen):
    """Standard headers that `path` includes, itself or through headers of the project."""
    if path in seen:
        return set()
    seen.add(path)
    found = set()
    for kind, name in includes(path):
        if kind == "<":
            found.add(name)
        elif (SRC / name).is_file():
            found |= standard_of(SRC / name, seen)
    return found


def headers():
    """Those that a room lists as its public ones."""
    found = []
    for room in (SRC / "handpiece").glob("*/*/CMakeLists.txt"):
        listed = re.search(r"HEADERS\s+((?:[\w/]+\.h\s+)+)", room.read_text())
        found += [room.parent / name for name in listed.group(1).split()] if listed else []
    return sorted(found)


def room_of(name):
    """wing/room of an include or a path below src; nothing for an application's."""
    found = re.match(r"handpiece/(\w+/\w+)/", name)
    return found.group(1) if found else None


def privacy():
    """Breaches of what is public and what is private to its room."""
    public = {h.relative_to(SRC).as_posix() for h in headers()}
    breaches = [f"src/{name}: is listed as public, and is not there" for name in sorted(public) if not (SRC / name).is_file()]
    wanted = set()
    for folder in ("src", "apps", "examples"):
        for path in sorted(p for p in (ROOT / folder).rglob("*") if p.suffix in (".h", ".cpp")):
            here = path.relative_to(SRC if folder == "src" else ROOT).as_posix()
            for kind, name in includes(path):
                if kind != '"' or not room_of(name):
                    continue
                isOutside = room_of(name) != room_of(here)
                if isOutside or here in public:
                    wanted.add(name)
                if isOutside and name not in public:
                    breaches.append(f"{path.relative_to(ROOT).as_posix()}: includes {name}, which is private to its room")
                elif here in public and name not in public:
                    breaches.append(f"{path.relative_to(ROOT).as_posix()}: is public and includes {name}, which is private")
    breaches += [f"src/{name}: is listed as public, and nobody outside of its room includes it" for name in sorted(public - wanted)]
    return breaches


def alone():
    first = set()
    for folder in ("src", "apps", "tests"):
        for source in (ROOT / folder).rglob("*.cpp"):
            named = includes(source)
            if named and named[0][0] == '"':
                first.add(named[0][1])
    return [h for h in headers() if h.relative_to(SRC).as_posix() not in first]


def main():
    if sys.argv[1:] == ["--alone"]:
        print(";".join(h.relative_to(SRC).as_posix() for h in alone()), end="")
        return 0
    breaches = privacy()
    every = sorted(h for h in SRC.rglob("*.h") if h.name != "pch.h")
    for header in every:
        has = standard_of(header, set())
        text = COMMENT.sub(" ", header.read_text(errors="replace"))
        for name in sorted(set(re.findall(r"\bstd::(\w+)", text))):
            need = NEEDS.get(name)
            if need and not need & has and not any(BRINGS.get(h, set()) & has for h in need):
                breaches.append(f"{header.relative_to(ROOT).as_posix()}: std::{name} without <{sorted(need)[0]}>")
    for line in breaches:
        print(line)
    print(f"header check: {len(every)} headers, {len(headers())} of them public, {len(breaches)} breaches")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
