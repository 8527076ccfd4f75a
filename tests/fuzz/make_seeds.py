#!/usr/bin/env python3
"""Writes the seeds from which fuzzing starts: targets in poses, near misses, textures."""
import pathlib

HERE = pathlib.Path(__file__).parent / "corpus"


def header(size=0, kind=0, distortion=0, background=100, noise=20, seed=1, blur=1, soil=0):
    return bytes([size, kind, distortion, background, noise, seed, blur, soil])


def command(op, *octets):
    return bytes([op, *octets]).ljust(16, b"\0")


def target(distance=28, turn=20, tilt=128, axis=30, u=128, v=128, white=200, black=30):
    return command(6, distance, 0, turn, tilt, axis, u, 0, v, 0, white, black)


SEEDS = {
    "near": header() + target(12),
    "tilted": header() + target(20, tilt=170),
    "steep": header(noise=10) + target(16, tilt=210, axis=100),
    "far": header(noise=30, size=3) + target(60, tilt=150),
    "black_on_white": header(kind=1) + target(24, tilt=140),
    "flat": header(kind=2) + target(24, tilt=150),
    "quarter": header(kind=0x10, size=1) + target(24),
    "fourfold": header(kind=0x20, size=2, soil=7) + target(24),
    "two": header(size=3) + target(40, u=80, v=90) + target(60, u=190, v=180, white=120),
    "hidden": header() + target(20) + command(0, 128, 0, 170, 0, 20, 30, 0, 40),
    "cut": header() + target(20, u=30),
    "dim": header(noise=60, blur=4) + target(20, white=70, black=30),
    "saturated": header() + target(20, white=255) + command(3, 200, 160, 128, 200),
    "full_size": header(size=5, distortion=255) + target(20, tilt=170),
    "waves": header(size=3) + command(2, 128, 0, 128, 0, 30, 120, 0, 1),
    "checkers": header() + command(2, 0, 0, 0, 0, 10, 120, 0, 2),
    "rings": header() + command(1, 128, 0, 128, 0, 80, 255, 0, 200, 200)
    + command(1, 60, 0, 60, 0, 30, 200, 0, 20, 200),
    "noise": header(noise=255),
    "raw": header() + command(4, 20, 20, 200, *range(0, 240, 20)),
}

for name, octets in SEEDS.items():
    (HERE / name).write_bytes(octets)
