# SPDX-License-Identifier: MIT
# What the scripts share: where the project is, and how it gets its packages and its build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# install_packages [LIST...]: scripts/packages.txt and the lists.
install_packages() {
  local wanted missing=() have
  wanted=$(cat scripts/packages.txt "$@" | sed -e 's/#.*//' | tr -s ' \t\n' ' ')
  have=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $wanted 2>/dev/null | sed -n 's/^installed //p') || true
  for package in $wanted; do
    grep -qx -- "$package" <<<"$have" || missing+=("$package")
  done
  if [ ${#missing[@]} -gt 0 ]; then
    local as_root=""
    [ "$(id -u)" -eq 0 ] || as_root=sudo
    echo "installing: ${missing[*]}"
    $as_root apt-get update -q
    DEBIAN_FRONTEND=noninteractive $as_root apt-get install -q -y --no-install-recommends "${missing[@]}"
  fi
  pcl_headers
}

# The headers of PCL, from Debian's own package, which is unpacked into build/pcl and not installed: apt has checked its
# signature. Nothing to do where libpcl-dev is installed.
pcl_headers() {
  compgen -G '/usr/include/pcl-*' >/dev/null || compgen -G 'build/pcl/usr/include/pcl-*' >/dev/null && return
  mkdir -p build/pcl
  (cd build/pcl && apt-get -q download libpcl-dev && dpkg-deb -x libpcl-dev_*.deb . && rm libpcl-dev_*.deb)
}

# build PRESET [target...]; it configures each time, for what the first surface takes is read from the sources as they are.
build() {
  local preset=$1
  shift
  cmake --preset "$preset"
  cmake --build "build/$preset" -j "$(nproc)" ${@:+--target "$@"}
}
