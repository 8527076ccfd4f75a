#!/bin/sh
# Every C++ source is as clang-format leaves it. Usage: check_format.sh ROOT
cd "$1" || exit 1
tool=$(command -v clang-format-14 || command -v clang-format) || {
  echo "clang-format is not installed: apt-get install clang-format-14" >&2
  exit 1
}
find algo hal firmware host_sim tests \( -name '*.hpp' -o -name '*.cpp' \) -print0 |
  xargs -0 "$tool" --dry-run --Werror
