#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Reads a DXF with ezdxf: prints "closed unit" and then x y z of each vertex of its one polyline."""
import sys

try:
    import ezdxf
except ImportError:
    sys.exit(77)

document = ezdxf.readfile(sys.argv[1])
faults = document.audit().errors
if faults:
    sys.exit("read_dxf: " + faults[0].message)
(line,) = list(document.modelspace())
print(int(line.is_closed), document.header.get("$INSUNITS", 0))
for vertex in line.vertices:
    print(*vertex.dxf.location)
