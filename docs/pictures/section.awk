# SPDX-License-Identifier: MIT
# Draws section.svg: a section through a made side, and the line's place in it by the definition of docs/line.md.
#   awk -f section.awk >section.svg

# Horizontal offset of the side at height z, mm: a sole's edge up to 14 mm, then the upper's wall, which leans out.
function side(z) { return 4.2 / (1 + exp((z - 14) / 0.7)) - 0.0045 * (z - 24) * (z - 24) + (z > 14 ? 0.12 * (z - 14) : 0) }

function smoothed(z,    i, sum, weights, w) {
  for (i = -12; i <= 12; ++i) { w = exp(-0.5 * (i / 4) * (i / 4)); sum += w * side(z + 0.1 * i); weights += w }
  return sum / weights
}

function curvature(z,    h, first, second) {
  h = 0.05
  first = (smoothed(z + h) - smoothed(z - h)) / (2 * h)
  second = (smoothed(z + h) - 2 * smoothed(z) + smoothed(z - h)) / (h * h)
  return second / (1 + first * first) ^ 1.5
}

function x(o) { return 190 + 26 * o }
function y(z) { return 400 - 13 * z }
function label(px, py, text) { printf "<text x=\"%g\" y=\"%g\">%s</text>\n", px, py, text }
function curve(colour, f,    z, o) {
  printf "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"2\" points=\"", colour
  for (z = 1; z <= 28; z += 0.1) { o = f == "k" ? 22 + 14 * curvature(z) / 1.2 - 8 : side(z); printf "%.1f,%.1f ", x(o), y(z) }
  print "\"/>"
}

BEGIN {
  best = 0
  for (z = 12; z <= 18; z += 0.02) if (curvature(z) > best) { best = curvature(z); line_z = z }
  print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\" height=\"430\" font-family=\"sans-serif\" font-size=\"14\">"
  print "<rect width=\"760\" height=\"430\" fill=\"white\"/>"
  printf "<path d=\"M40 %g H720\" stroke=\"#888\" stroke-width=\"3\"/>\n", y(0)
  label(600, y(0) - 8, "table")
  curve("#224488", "o")
  curve("#aa3322", "k")
  printf "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"6\" fill=\"#118833\"/>\n", x(side(line_z)), y(line_z)
  printf "<path d=\"M%.1f %.1f H640\" stroke=\"#118833\" stroke-dasharray=\"5 4\" fill=\"none\"/>\n", x(side(line_z)), y(line_z)
  label(x(side(line_z)) + 12, y(line_z) - 8, "bite line: largest curvature")
  label(x(side(24)) + 14, y(24), "wall of the upper: o(z)")
  label(x(side(7)) + 14, y(7), "sole&#39;s edge")
  label(600, y(26), "curvature k(z)")
  print "<path d=\"M60 380 v-90 m-5 10 l5 -10 5 10\" fill=\"none\" stroke=\"black\"/><path d=\"M60 380 h70 m-10 -5 l10 5 -10 5\" fill=\"none\" stroke=\"black\"/>"
  label(50, 280, "z"); label(136, 385, "o, outwards")
  print "</svg>"
}
