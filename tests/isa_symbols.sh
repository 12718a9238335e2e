#!/bin/sh
# Objects for newer instruction sets define no weak symbol: the linker could take it for everyone, and the program would
# end on an older processor. usage: isa_symbols.sh OBJECT ...
set -eu
for object; do
  if nm -C "$object" | grep ' [WVu] '; then
    echo "$object defines these for any processor"
    exit 1
  fi
done
[ $# -gt 0 ]
