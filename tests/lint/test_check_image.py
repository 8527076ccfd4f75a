#!/usr/bin/env python3
"""The image check finds what it is there to find, and nothing else."""

import re
import unittest

from check_image import FORBIDDEN


def kinds(name):
    return [what for what, pattern in FORBIDDEN.items() if re.fullmatch(pattern, name)]


class Forbidden(unittest.TestCase):
    def test_soft_float_routines(self):
        for name in ("__aeabi_fadd", "__aeabi_dmul", "__aeabi_dcmplt", "__aeabi_cdcmple",
                     "__aeabi_i2d", "__aeabi_ui2f", "__aeabi_l2d", "__aeabi_ul2f", "__aeabi_d2iz",
                     "__aeabi_f2d", "__muldf3", "__floatsidf", "__fixunssfsi"):
            self.assertEqual(kinds(name), ["soft-float routine"], name)

    def test_integer_routines_are_allowed(self):
        for name in ("__aeabi_ldivmod", "__aeabi_uldivmod", "__aeabi_idiv", "__aeabi_lmul",
                     "__aeabi_idiv0", "__udivmoddi4", "memcpy", "__aeabi_memcpy"):
            self.assertEqual(kinds(name), [], name)

    def test_allocators(self):
        for name in ("malloc", "_malloc_r", "free", "_sbrk", "_Znwj", "_Znaj", "_ZdlPv",
                     "_ZdlPvj"):
            self.assertEqual(kinds(name), ["allocator"], name)

    def test_exceptions_types_and_output(self):
        self.assertEqual(kinds("__cxa_throw"), ["exception"])
        self.assertEqual(kinds("_ZTVN5berth4TypeE"), ["run-time type"])
        self.assertEqual(kinds("vsnprintf"), ["standard output"])

    def test_own_names_are_allowed(self):
        for name in ("_ZN5berth13process_frameEv", "_ZSt9terminatev", "fault_handler"):
            self.assertEqual(kinds(name), [], name)


if __name__ == "__main__":
    unittest.main()
