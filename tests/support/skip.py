"""For test scripts: ends one that cannot run here for want of what tools/test.sh sets up."""
import os
import sys


def skip_unless_required(why):
    """It is skipped, or fails where GLISS_REQUIRE=1 asks for all."""
    if os.environ.get("GLISS_REQUIRE") == "1":
        sys.exit(f"GLISS_REQUIRE, but {why}")
    print(f"skipped: {why}")
    sys.exit(77)
