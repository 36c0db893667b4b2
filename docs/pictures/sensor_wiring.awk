# SPDX-License-Identifier: MIT
# awk -f sensor_wiring.awk >sensor_wiring.svg: what turns the laser on, and all that turns it off.
function box(at_x, at_y, w, h, style, one, two) {
  printf "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" class=\"%s\"/>\n", at_x, at_y, w, h, style
  printf "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n", at_x + w / 2, at_y + h / 2 + (two == "" ? 5 : -4), one
  if (two != "") printf "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\" class=\"small\">%s</text>\n", at_x + w / 2, at_y + h / 2 + 14, two
}
function wire(points, style) { printf "<polyline points=\"%s\" class=\"%s\" marker-end=\"url(#tip)\"/>\n", points, style }
function text(at_x, at_y, words, anchor) { printf "<text x=\"%d\" y=\"%d\" text-anchor=\"%s\" class=\"small\">%s</text>\n", at_x, at_y, anchor, words }
BEGIN {
  print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 900 560\" font-family=\"sans-serif\" font-size=\"15\">"
  print "<style>rect,polyline{fill:none;stroke:#333;stroke-width:1.5}.part{fill:#eee}.safe{fill:#fde9e7;stroke:#c00}.power{stroke:#c00;stroke-width:3}.small{font-size:12px}text{fill:#222}</style>"
  print "<defs><marker id=\"tip\" markerUnits=\"userSpaceOnUse\" markerWidth=\"9\" markerHeight=\"8\" refX=\"8\" refY=\"4\" orient=\"auto\"><path d=\"M0,0 L9,4 L0,8 z\" fill=\"#333\"/></marker></defs>"
  print "<rect x=\"0\" y=\"0\" width=\"900\" height=\"560\" style=\"fill:#fff;stroke:none\"/>"
  box(30, 120, 180, 300, "part", "board", "Linux, biteline-sensor")
  box(330, 30, 170, 60, "part", "camera", "global shutter")
  box(330, 190, 150, 60, "safe", "monostable", "74LVC1G123, 60 ms")
  box(560, 180, 110, 120, "safe", "AND", "74LVC1G11")
  box(740, 210, 130, 60, "part", "laser driver", "modulation input")
  box(740, 340, 130, 60, "part", "laser", "line, 660 nm")
  box(330, 440, 150, 60, "safe", "interlock contact", "and key switch")
  box(560, 440, 110, 60, "part", "laser supply", "5 V, its own")
  wire("210,140 270,140 270,60 330,60", ""); text(222, 134, "trigger", "start")
  wire("500,60 530,60 530,200 560,200", ""); text(540, 110, "strobe: exposure active", "start")
  wire("330,80 312,80 312,165 210,165", ""); text(222, 160, "strobe echo", "start")
  wire("210,220 330,220", ""); text(222, 214, "heartbeat", "start")
  wire("480,220 560,220", "")
  wire("210,280 560,280", ""); text(222, 274, "laser enable", "start"); text(400, 300, "10 kOhm to ground here and at the driver", "middle")
  wire("670,240 740,240", "")
  wire("805,270 805,340", "power")
  wire("670,460 700,460 700,225 740,225", "power")
  wire("480,470 560,470", "power"); text(520, 432, "24 V, in series", "middle")
  wire("120,530 300,530 300,470 330,470", "power"); text(130, 524, "24 V", "start")
  wire("330,455 250,455 250,390 210,390", ""); text(222, 384, "interlock closed, key on", "start")
  print "</svg>"
}
