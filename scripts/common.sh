# SPDX-License-Identifier: MIT
# What the scripts share: where the project is, and how it gets its packages and its build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

install_packages() {
  local wanted missing=() have
  wanted=$(sed -e 's/#.*//' scripts/packages.txt | tr -s ' \t\n' ' ')
  have=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $wanted 2>/dev/null | sed -n 's/^installed //p') || true
  for package in $wanted; do
    grep -qx -- "$package" <<<"$have" || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  local as_root=""
  [ "$(id -u)" -eq 0 ] || as_root=sudo
  echo "installing: ${missing[*]}"
  $as_root apt-get update -q
  DEBIAN_FRONTEND=noninteractive $as_root apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# build PRESET [target...]
build() {
  local preset=$1
  shift
  [ -f "build/$preset/build.ninja" ] || cmake --preset "$preset"
  cmake --build "build/$preset" -j "$(nproc)" ${@:+--target "$@"}
}
