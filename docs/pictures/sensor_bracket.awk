# SPDX-License-Identifier: MIT
# awk -f sensor_bracket.awk >sensor_bracket.svg: the head's geometry and its side plate, seen along the stripe, 1 mm as 2 px.
# Numbers follow from those in BEGIN; docs/build-a-sensor.md tells the same ones.
function x(mm) { return 260 + 2 * mm }
function y(mm) { return 610 - 2 * mm }
function line(x1, y1, x2, y2, style) { printf "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" class=\"%s\"/>\n", x(x1), y(y1), x(x2), y(y2), style }
function text(at_x, at_y, words, anchor) { printf "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n", x(at_x), y(at_y), anchor, words }
function circle(at_x, at_y, r, style) { printf "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" class=\"%s\"/>\n", x(at_x), y(at_y), 2 * r, style }
# A box of width w along a direction (degrees from upright), length l, its front's middle at (at_x, at_y).
function body(at_x, at_y, degrees, w, l) {
  printf "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" class=\"part\" transform=\"rotate(%.1f %.1f %.1f)\"/>\n",
    x(at_x) - w, y(at_y) - 2 * l, 2 * w, 2 * l, degrees, x(at_x), y(at_y)
}
BEGIN {
  distance = 200; angle = 45; emitter = 190; range = 39
  rad = angle * atan2(0, -1) / 180
  cam_x = distance * sin(rad); cam_y = distance * cos(rad)
  print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 900 700\" font-family=\"sans-serif\" font-size=\"14\">"
  print "<style>line,rect,circle,polygon{fill:none;stroke:#333;stroke-width:1.5}.beam{stroke:#c00;stroke-width:2}.axis{stroke-dasharray:8 4}"
  print ".size{stroke:#06c;stroke-width:1}.part{fill:#eee}.plate{fill:#dde8f3}.hole{fill:#fff}text{fill:#222}.zone{stroke:#c00;stroke-width:5}</style>"
  print "<rect x=\"0\" y=\"0\" width=\"900\" height=\"700\" style=\"fill:#fff;stroke:none\"/>"
  # The plate, from the flange down to both mounts.
  split("-45 265 45 265 186 221 221 186 156 126 -45 195", corner, " ")
  printf "<polygon class=\"plate\" points=\""
  for (i = 1; i < 12; i += 2) printf "%.1f,%.1f ", x(corner[i]), y(corner[i + 1])
  print "\"/>"
  for (i = 1; i < 12; i += 2) text(corner[i] + (i == 7 ? 4 : 0), corner[i + 1] + (i == 11 ? -8 : i == 9 ? -8 : 2), corner[i] ", " corner[i + 1], i == 1 || i == 11 ? "end" : "start")
  line(-45, 268, 45, 268, "part"); line(-45, 274, 45, 274, "part"); line(-45, 268, -45, 274, "part"); line(45, 268, 45, 274, "part")
  text(0, 280, "tool plate: 4 x M6 on a 50 mm circle (ISO 9409-1-50-4-M6)", "middle")
  body(0, emitter, 0, 12, 60)
  body(cam_x + 12, cam_y + 12, angle, 29, 60)
  text(10, 232, "laser, barrel 12 mm", "start")
  text(cam_x + 62, cam_y + 95, "camera 29 x 29 mm, lens", "start")
  # Beam, axis, and where they meet.
  line(0, emitter, 0, -25, "beam"); line(cam_x, cam_y, -20, -20, "axis")
  line(0, -range / 2, 0, range / 2, "zone")
  circle(0, 0, 2, "hole")
  text(8, -12, "working point", "start"); text(-8, range / 2 - 3, range " mm of depth", "end"); text(-8, range / 2 - 12, "in 320 rows", "end")
  circle(cam_x, cam_y, 2, "hole"); circle(0, emitter, 2, "hole")
  # Sizes.
  line(-100, 0, -100, emitter, "size"); line(-105, 0, -95, 0, "size"); line(-105, emitter, -95, emitter, "size")
  text(-97, emitter / 2, emitter " mm", "start")
  line(0, -35, cam_x, -35, "size"); line(0, -32, 0, -38, "size"); line(cam_x, -32, cam_x, -38, "size")
  text(cam_x / 2 + 5, -33, sprintf("%.1f mm", cam_x), "middle")
  line(cam_x + 90, 0, cam_x + 90, cam_y, "size"); line(cam_x + 85, 0, cam_x + 95, 0, "size"); line(cam_x + 85, cam_y, cam_x + 95, cam_y, "size")
  text(cam_x + 94, cam_y / 2, sprintf("%.1f mm", cam_y), "start")
  text(cam_x / 2 + 8, cam_y / 2 - 8, distance " mm to the lens", "start")
  text(6, 60, angle "&#176;", "start")
  text(40, 20, "plate: 6 mm aluminium, plane within 0.1 mm", "start")
  text(40, 10, "angle within 1&#176;, distances within 2 mm:", "start")
  text(40, 0, "calibration finds the rest", "start")
  print "</svg>"
}
