# awk -f evaluate.awk run.log: maximum and RMS of the true radial error [um] of the second revolution in each direction, from what
# record.hal records (halsampler -t: sample number first). Circle of circle.ngc: radius 10 mm, lines 7 and 9. Its centre is that
# of the command: LinuxCNC calls zero where an axis stood when it was homed, which is not where the drives' scales have theirs.
NF != 14 { bad = 1; next }
NR > 1 && $1 != last + 1 { gaps++ }
{ last = $1 }
$14 == 7 || $14 == 9 {
  if (!n[$14]) {
    low_x[$14] = high_x[$14] = $2
    low_y[$14] = high_y[$14] = $6
  }
  if ($2 < low_x[$14]) low_x[$14] = $2
  if ($2 > high_x[$14]) high_x[$14] = $2
  if ($6 < low_y[$14]) low_y[$14] = $6
  if ($6 > high_y[$14]) high_y[$14] = $6
  i = ++n[$14]
  x[$14, i] = $4
  y[$14, i] = $8
}
END {
  if (bad || gaps || n[7] < 5000 || n[9] < 5000) {
    print "evaluate.awk: rows of another form, gaps, or no circle" > "/dev/stderr"
    exit 1
  }
  for (line = 7; line <= 9; line += 2) {
    cx = (low_x[line] + high_x[line]) / 2
    cy = (low_y[line] + high_y[line]) / 2
    most = square = 0
    for (i = 1; i <= n[line]; ++i) {
      dx = x[line, i] - cx
      dy = y[line, i] - cy
      e = (sqrt(dx * dx + dy * dy) - 10) * 1000
      if (e < 0) e = -e
      if (e > most) most = e
      square += e * e
    }
    printf "%.3f %.3f ", most, sqrt(square / n[line])
  }
  print ""
}
