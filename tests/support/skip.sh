# For test scripts that cannot run here, or not all of it, for want of what tools/test.sh installs.

# Says that a part is left out, or fails where GLISS_REQUIRE=1 asks for all.
leave_out_unless_required() {
  if [ "${GLISS_REQUIRE-}" = 1 ]; then
    echo "GLISS_REQUIRE, but $1" >&2
    exit 1
  fi
  echo "skipped: $1"
}

# Ends the test, skipped or failed.
skip_unless_required() {
  leave_out_unless_required "$1"
  exit 77
}
