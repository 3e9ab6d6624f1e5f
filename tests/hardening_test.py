#!/usr/bin/env python3
"""hardening.py finds each flag that is taken away, by what a compiler makes without it."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import hardening

COMPILER = os.environ.get("MBK_CXX") or shutil.which("g++")
PROGRAM = """
#include <cstdio>
#include <cstring>
int main(int argc, char** argv) {
  char text[64];
  std::strcpy(text, argv[argc - 1]);
  return std::puts(text);
}
"""
FLAGS = ["-O1", "-fstack-protector-strong", "-fstack-clash-protection", "-fcf-protection", "-U_FORTIFY_SOURCE",
         "-D_FORTIFY_SOURCE=2", "-fPIE"]
LINK = ["-pie", "-Wl,-z,relro", "-Wl,-z,now", "-Wl,-z,noexecstack"]


class Commands(unittest.TestCase):
    def missing(self, flags):
        return list(hardening.missing_flags(["c++", *flags, "-c", "a.cpp"]))

    def test_all_there(self):
        self.assertEqual(self.missing(FLAGS), [])

    def test_each_that_is_away(self):
        for flag in FLAGS:
            if flag == "-U_FORTIFY_SOURCE" or (flag == "-fcf-protection" and len(hardening.FLAGS) < 4):
                continue
            found = self.missing([one for one in FLAGS if one != flag])
            self.assertEqual(len(found), 1, (flag, found))

    def test_each_that_is_taken_back(self):
        for flag in ("-fno-stack-protector", "-fno-stack-clash-protection", "-U_FORTIFY_SOURCE",
                     "-D_FORTIFY_SOURCE=0"):
            found = self.missing([*FLAGS, flag])
            self.assertEqual(len(found), 1, (flag, found))
            self.assertIn(flag, found[0])

    def test_a_build_without_commands(self):
        with tempfile.TemporaryDirectory() as folder:
            build = pathlib.Path(folder)
            (build / "compile_commands.json").write_text(json.dumps([{"file": "a.S", "command": "cc -c a.S"}]))
            self.assertEqual(len(list(hardening.problems(build, []))), 1)


@unittest.skipUnless(COMPILER and sys.platform == "linux", "no compiler to try it on")
class Programs(unittest.TestCase):
    def problems(self, compile_flags, link_flags):
        with tempfile.TemporaryDirectory() as folder:
            source, program = pathlib.Path(folder, "a.cpp"), pathlib.Path(folder, "a")
            source.write_text(PROGRAM)
            subprocess.run([COMPILER, *compile_flags, source, "-o", program, *link_flags], check=True)
            return list(hardening.program_problems(program, True))

    def assert_one(self, found, *words):
        self.assertEqual(len(found), 1, found)
        for word in words:
            self.assertIn(word, found[0])

    def test_a_hardened_one(self):
        self.assertEqual(self.problems(FLAGS, LINK), [])

    def test_each_flag(self):
        without = lambda flags, flag, *others: [one for one in flags if one != flag] + list(others)
        self.assert_one(self.problems(without(FLAGS, "-fstack-protector-strong", "-fno-stack-protector"), LINK),
                        "__stack_chk_fail")
        self.assert_one(self.problems(without(FLAGS, "-D_FORTIFY_SOURCE=2"), LINK), "_FORTIFY_SOURCE")
        self.assert_one(self.problems(without(FLAGS, "-fPIE", "-fno-pie"), without(LINK, "-pie", "-no-pie")), "PIE")
        self.assert_one(self.problems(FLAGS, without(LINK, "-Wl,-z,now", "-Wl,-z,lazy")), "BIND_NOW")
        self.assert_one(self.problems(FLAGS, without(LINK, "-Wl,-z,relro", "-Wl,-z,norelro")), "GNU_RELRO")
        self.assert_one(self.problems(FLAGS, without(LINK, "-Wl,-z,noexecstack", "-Wl,-z,execstack")), "executable")

    def test_a_program_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            build = pathlib.Path(folder)
            (build / "compile_commands.json").write_text(
                json.dumps([{"file": "a.cpp", "command": "c++ " + " ".join(FLAGS) + " -c a.cpp"}]))
            self.assert_one(list(hardening.problems(build, [build / "mbk"])), "was it built?")


if __name__ == "__main__":
    unittest.main()
