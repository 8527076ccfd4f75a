#!/usr/bin/env python3
"""The linked firmware image: no allocator, no floating point, no exceptions, no virtual functions,
and it fits the reference parts. Usage: check_image.py IMAGE.elf. Prints the sizes; exit 1 and one
line per breach."""

import re
import subprocess
import sys

FORBIDDEN = {
    "allocator": r"_?(malloc|calloc|realloc|free)(_r)?|_?sbrk(_r)?|_Zn[wa][jm].*|_Zd[la]Pv.*",
    "soft-float routine": r"__aeabi_(c?[fd](add|sub|rsub|mul|div|neg|cmp\w*|2\w+)|u?[il]2[fd]|h2f)"
                          r"|__(add|sub|mul|div|neg|float\w*|fix\w*|extend|trunc|cmp|eq|ne|lt|le"
                          r"|gt|ge|unord|powi)\w*[hsdt]f\w*",
    "floating-point library": r"(sqrt|sin|cos|tan|atan2?|exp|log|pow|floor|ceil|round|fmod)[fl]?",
    "exception": r"__cxa_(throw|allocate_exception|begin_catch)|_Unwind_.*|__gxx_personality.*",
    "run-time type": r"_ZT[ISV].*|__dynamic_cast",
    "standard output": r".*printf.*|puts|putchar|fwrite|_write(_r)?",
}
KIB = 1024
FLASH = (0x00000000, 128 * KIB, "code and constants")
RAM = (0x20000000, 384 * KIB, "on-chip data, stacks included")
EXTERNAL = (0x60000000, 2048 * KIB, "external memory, frames only")


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def forbidden_symbols(image):
    names = [line.split()[-1] for line in run("arm-none-eabi-nm", image).splitlines()]
    for what, pattern in FORBIDDEN.items():
        for name in names:
            if re.fullmatch(pattern, name):
                yield f"{what}: {name}"


def sections(image):
    """Name, address, size of all that occupies memory; .data's load image counts as well."""
    for line in run("arm-none-eabi-readelf", "-SW", image).splitlines():
        match = re.match(r"\s*\[\s*\d+\] (\S+)\s+(\S+)\s+(\w{8}) \w+ (\w+) \w+\s+(\w*A\w*)", line)
        if match:
            yield match[1], int(match[3], 16), int(match[4], 16)
            if match[1] == ".data":
                yield ".data (initial values)", FLASH[0], int(match[4], 16)


def region_breaches(image):
    parts = list(sections(image))
    placed = 0
    for base, size, what in (FLASH, RAM, EXTERNAL):
        inside = [p for p in parts if base <= p[1] < base + size]
        placed += len(inside)
        used = sum(p[2] for p in inside)
        print(f"{what}: {used} of {size} bytes ({100 * used // size} %)")
        for name, _, bytes_used in inside:
            print(f"  {name:24} {bytes_used:8}")
        if used > size:
            yield f"{what}: {used} bytes, {size} allowed"
    if placed != len(parts):
        yield "a section lies outside the memory map"


def main():
    image = sys.argv[1]
    found = [*region_breaches(image), *forbidden_symbols(image)]
    print("\n".join(found) if found else "no allocator, no floating point, no exceptions")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
