# SPDX-License-Identifier: MIT
# Draws check_lap.svg: from above, a shoe's outline, and the head at the begin of a scan and at its end.
#   awk -f check_lap.awk >check_lap.svg

function label(px, py, text) { printf "<text x=\"%g\" y=\"%g\">%s</text>\n", px, py, text }

# A head whose beam meets (x, y), turned by `turn` degrees from straight up, `far` from the wall; the camera goes beside it.
function head(x, y, turn, far, colour,    a, s, c, hx, hy) {
  a = turn * 3.14159265 / 180; s = sin(a); c = cos(a)
  hx = x - far * s; hy = y + far * c
  printf "<path d=\"M%.1f %.1f L%.1f %.1f\" stroke=\"%s\" stroke-width=\"2\"/>\n", hx, hy, x, y, colour
  printf "<rect x=\"%.1f\" y=\"%.1f\" width=\"36\" height=\"24\" fill=\"%s\" transform=\"rotate(%g %.1f %.1f)\"/>\n", hx - 18, hy, colour, turn, hx, hy
  printf "<path d=\"M%.1f %.1f L%.1f %.1f\" stroke=\"%s\" stroke-dasharray=\"4 4\"/>\n", x, y, hx + 75 * c, hy + 75 * s, colour
  printf "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"9\" fill=\"none\" stroke=\"%s\" stroke-width=\"3\"/>\n", hx + 82 * c, hy + 82 * s, colour
}

BEGIN {
  print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\" height=\"400\" font-family=\"sans-serif\" font-size=\"14\">"
  print "<rect width=\"760\" height=\"400\" fill=\"white\"/>"
  print "<path d=\"M120 150 C120 40 640 20 660 120 C670 210 480 190 400 205 C320 215 120 240 120 150 Z\" fill=\"#eee\" stroke=\"#444\" stroke-width=\"2\"/>"
  label(330, 130, "shoe, from above")
  print "<path d=\"M300 213 C330 214 370 210 400 205\" stroke=\"#118833\" stroke-width=\"7\" fill=\"none\"/>"
  label(300, 195, "lap: seen twice")
  head(305, 213, 14, 110, "#224488")
  head(395, 206, -14, 95, "#aa3322")
  label(50, 330, "begin: yaw one way, raised,"); label(50, 350, "coming nearer")
  label(500, 330, "end: yaw the other way, rolled,"); label(500, 350, "drawing back")
  label(50, 385, "Box: laser and its beam.  Ring: camera and its sight.  A right calibration sees one surface.")
  print "</svg>"
}
