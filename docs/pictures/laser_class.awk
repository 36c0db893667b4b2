# SPDX-License-Identifier: MIT
# laser_class.svg: what of a line's light enters an eye: 7 mm of it at 100 mm from where it fans out.
# To scale: 3 pixels are 1 mm.
BEGIN {
  scale = 3; fan_deg = 60; distance_mm = 100; hole_mm = 7
  half_mm = distance_mm * sin(fan_deg / 2 * atan2(0, -1) / 180) / cos(fan_deg / 2 * atan2(0, -1) / 180)
  x0 = 60; y0 = 200; x1 = x0 + scale * distance_mm
  print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"400\" font-family=\"sans-serif\" font-size=\"14\">"
  print "<rect width=\"640\" height=\"400\" fill=\"white\"/>"
  printf "<path d=\"M%g %g L%g %g L%g %g Z\" fill=\"#fbb\"/>\n", x0, y0, x1, y0 - scale * half_mm, x1, y0 + scale * half_mm
  printf "<path d=\"M%g %g L%g %g L%g %g Z\" fill=\"#e44\"/>\n", x0, y0, x1, y0 - scale * hole_mm / 2, x1, y0 + scale * hole_mm / 2
  printf "<path d=\"M%g %g V%g M%g %g V%g\" stroke=\"#333\" stroke-width=\"6\"/>\n", x1 + 3, y0 - scale * half_mm - 12, y0 - scale * hole_mm / 2, x1 + 3, y0 + scale * hole_mm / 2, y0 + scale * half_mm + 12
  printf "<circle cx=\"%g\" cy=\"%g\" r=\"4\" fill=\"#333\"/>\n", x0, y0
  printf "<text x=\"%g\" y=\"%g\">the line fans out here</text>\n", x0 - 40, y0 + 46
  printf "<path d=\"M%g %g V%g\" stroke=\"#333\"/>\n", x0, y0 + 8, y0 + 30
  printf "<path d=\"M%g 386 H%g M%g 380 V392 M%g 380 V392\" stroke=\"#333\" fill=\"none\"/>\n", x0, x1, x0, x1
  printf "<text x=\"%g\" y=\"380\" text-anchor=\"middle\">100 mm</text>\n", (x0 + x1) / 2
  printf "<text x=\"%g\" y=\"%g\">hole of 7 mm: the pupil</text>\n", x1 + 20, y0 + 5
  printf "<text x=\"%g\" y=\"%g\">all of the line: %.1f mm</text>\n", x1 + 20, y0 - scale * half_mm + 20, 2 * half_mm
  printf "<text x=\"%g\" y=\"%g\">7 / %.1f of its power enter the eye</text>\n", x1 + 20, y0 + 26, 2 * half_mm
  print "</svg>"
}
