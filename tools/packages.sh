# Debian and Ubuntu packages that Gliss needs, and how scripts of this folder get them.
# To be sourced by bash.

# What the program needs, and its pictures.
build_packages=(cmake ninja-build g++ libtbb-dev libeigen3-dev libhdf5-dev libfmt-dev libxxhash-dev
  ocl-icd-opencl-dev opencl-clhpp-headers nlohmann-json3-dev libcli11-dev libboost-dev
  libtomlplusplus-dev python3)
# For gliss report. npm from elsewhere does as well, and Debian's cannot stand beside it.
command -v npm >/dev/null || build_packages+=(nodejs npm)

# The Python package needs these in addition.
python_packages=(pybind11-dev python3-dev python3-numpy)
# gliss-mpi needs these in addition; without the last two rank 0 writes all results alone.
mpi_packages=(libopenmpi-dev openmpi-bin libhdf5-openmpi-dev pkg-config)
# The tests and benchmarks need these in addition. clang reads the kernels as OpenCL C; PoCL is an OpenCL
# device on any processor, oclgrind one that finds what others let pass; of locales one with a decimal comma is made.
test_packages=(pocl-opencl-icd oclgrind libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev libembree-dev
  make abigail-tools clang clang-format-14 stress-ng rt-tests strace locales python3-h5py "${python_packages[@]}" python3-pytest mypy
  python3-venv python3-pip python3-setuptools python3-wheel "${mpi_packages[@]}")
# Peers that tools/bench.sh compares with, where they can be had.
bench_packages=(libosd-dev libembree-dev)
# tools/fuzz.sh needs these in addition: clang with libFuzzer and its sanitizers.
fuzz_packages=(clang libclang-rt-dev libgtest-dev)
# Tests that need these are skipped without them: a browser, which on Ubuntu a snap holds, and C#.
optional_test_packages=(chromium mono-mcs mono-runtime)

# Installs those of the packages named that are missing; asks nothing and needs no network when none is.
install_packages() {
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "No apt-get here. Gliss needs what these Debian packages hold: $*" >&2
    return
  fi
  local package missing=() root=()
  for package in "$@"; do
    dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed ||
      missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      echo "Run this as root, or install: ${missing[*]}" >&2
      return 1
    fi
    root=(sudo)
  fi
  echo "Installing ${missing[*]}"
  local apt=("${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300)
  "${apt[@]}" update
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}"
}
