# For test scripts: the instruction sets of GLISS_ISA that this machine has. What it has not, the program leaves for the
# best that there is, which would be compared with itself.
has_flags() {
  for flag in "$@"; do grep -qw "$flag" /proc/cpuinfo || return 1; done
}
isas_here() {
  echo baseline
  has_flags avx2 fma bmi2 || return 0
  echo v3
  has_flags avx512f avx512dq avx512bw avx512vl || return 0
  echo v4
}
