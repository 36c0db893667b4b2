#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""avahi_test.py ROOT: what a unit may tell its network is where it listens, and in the protocol that it speaks."""
import pathlib
import re
import sys
import xml.etree.ElementTree as tree

root = pathlib.Path(sys.argv[1])
group = tree.parse(root / "boards/common/avahi/biteline-sensor.service").getroot()
assert group.tag == "service-group", group.tag
name, service = group.find("name"), group.find("service")
assert name.get("replace-wildcards") == "yes" and "%h" in name.text, "two units would have one name"
kind, port = service.findtext("type"), service.findtext("port")
# RFC 6763: at most 15 letters, digits and hyphens.
assert re.fullmatch(r"_[a-z0-9-]{1,15}\._tcp", kind), kind
unit = (root / "boards/common/systemd/biteline-sensor.service").read_text()
assert re.search(r"--listen tcp://[0-9.]+:(\d+)", unit).group(1) == port, "the unit listens elsewhere"
protocol = re.search(r"k_protocol = (\d+);", (root / "common/wire/messages.hpp").read_text()).group(1)
told = dict(record.text.split("=", 1) for record in service.findall("txt-record"))
assert told == {"protocol": protocol, "keys": "needed"}, told
package = (root / "toolchains/cmake/BitelinePackage.cmake").read_text()
where = re.search(r"avahi/biteline-sensor\.service DESTINATION (\S+)", package).group(1)
assert "DATADIR" in where, "it must be off unless somebody copies it"
print(f"{kind} on port {port}")
