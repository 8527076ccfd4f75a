#!/usr/bin/env python3
"""Includes point one way: algo to itself and to earlier folders only, the HAL to the core of algo,
firmware to both; no flight code includes a header that allocates, prints or computes in floating
point. Usage: check_includes.py ROOT. Exit 1 and one line per breach."""

import pathlib
import re
import sys

ALGO_ORDER = ["core", "fixed", "image", "camera", "edge", "circle", "target", "marker", "pose",
              "track", "pipeline"]
# What each flight folder may include in quotes, by the first part of the path.
ALLOWED = {
    "hal/include": {"hal", "core"},
    "hal/mps2_an500": {"hal", "mps2_an500", "core"},
    "firmware/tmtc": {"tmtc", "hal", *ALGO_ORDER},
    "firmware/app": {"app", "tmtc", "hal", *ALGO_ORDER},
    "firmware/storage": {"storage", "app", "tmtc", "hal", *ALGO_ORDER},
    "firmware/main": {"storage", "app", "tmtc", "hal", *ALGO_ORDER},
}
ALLOWED.update({f"algo/{folder}": set(ALGO_ORDER[:place + 1])
                for place, folder in enumerate(ALGO_ORDER)})
# Headers in angle brackets that the flight code may use; <new> for placement: there is no heap.
SYSTEM = re.compile(r"^(Eigen/(Core|LU|Geometry)|gsl/span|cstdint|cstddef|cstring|type_traits|limits|"
                    r"algorithm|array|utility|tuple|exception|new|arm_acle\.h)$")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def flight_files(root):
    for folder in ("algo", "hal/include", "hal/mps2_an500", "firmware"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".hpp", ".cpp"):
                yield path


def folder_of(path, root):
    parts = path.relative_to(root).parts
    return "/".join(parts[:2])


def breaches(path, root):
    folder = folder_of(path, root)
    allowed = ALLOWED.get(folder)
    if allowed is None:
        yield f"{path.relative_to(root)}: folder {folder} has no place in the include order"
        return
    for bracket, name in INCLUDE.findall(path.read_text()):
        bad = (not SYSTEM.match(name)) if bracket == "<" else name.split("/")[0] not in allowed
        if bad:
            yield f"{path.relative_to(root)}: may not include {name}"


def main():
    root = pathlib.Path(sys.argv[1])
    files = list(flight_files(root))
    found = [line for path in files for line in breaches(path, root)]
    print("\n".join(found) if found else f"includes of {len(files)} flight files point one way")
    return 1 if found or not files else 0


if __name__ == "__main__":
    sys.exit(main())
