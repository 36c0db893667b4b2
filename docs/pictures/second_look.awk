# SPDX-License-Identifier: MIT
# Draws second_look.svg: a band on a wall beside the line, and what the second look compares.
#   awk -f second_look.awk >second_look.svg

function label(px, py, text) { printf "<text x=\"%g\" y=\"%g\">%s</text>\n", px, py, text }
function box(px, py, w, h, style) { printf "<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\" %s/>\n", px, py, w, h, style }
function x(along) { return 60 + 11 * along }
function y(across) { return 210 - 11 * across }

BEGIN {
  print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\" height=\"330\" font-family=\"sans-serif\" font-size=\"14\">"
  print "<rect width=\"760\" height=\"330\" fill=\"white\"/>"
  box(x(0), y(18), 11 * 56, 11 * 8.5, "fill=\"#eee\"")
  box(x(0), y(-1.5), 11 * 56, 11 * 6, "fill=\"#eee\"")
  box(x(0), y(8), 11 * 20, 11 * 8, "fill=\"#7b7\"")
  box(x(26), y(8), 11 * 12, 11 * 8, "fill=\"#7b7\"")
  box(x(38), y(8), 11 * 8, 11 * 5, "fill=\"#7b7\"")
  box(x(46), y(8), 11 * 10, 11 * 8, "fill=\"#7b7\"")
  printf "<circle cx=\"%g\" cy=\"%g\" r=\"16\" fill=\"#7b7\"/>\n", x(31), y(12.5)
  for (i = 0; i <= 56; i += 1) printf "<path d=\"M%g %g V%g\" stroke=\"#c33\" stroke-width=\"0.6\" opacity=\"0.6\"/>\n", x(i), y(18), y(-7.5)
  printf "<path d=\"M%g %g H%g\" stroke=\"#224488\" stroke-width=\"3\"/>\n", x(0), y(0), x(56)
  printf "<path d=\"M%g %g H%g M%g %g H%g\" stroke=\"#333\" stroke-dasharray=\"6 4\"/>\n", x(0), y(8), x(56), x(0), y(0.1), x(56)
  label(x(0), y(0) + 18, "the line")
  label(x(20.3), y(4), "missing")
  label(x(38.3), y(1), "narrow")
  label(x(33), y(12.5), "beside")
  label(x(1), y(4), "worked")
  label(x(1), y(14), "unworked surface: what each profile is compared against")
  label(x(1), y(-5), "likewise below")
  label(x(0), 322, "each red line: a profile of the second scan; dashed: the planned band")
  print "</svg>"
}
