# awk -v limit=N -v ramp=MS -v together=0|1 -f faults.awk play.out run.log: what the controllers did in each case of play.py, against
# what is declared; a table, and exit code 1 when something is not as declared. Rows of run.log: machine.hal, sample number first.
#
#   limit     force limit [N]           ramp  ramp-time [ms]
#   together  1: every axis goes to zero with the one that failed (stribeck_contour)
function abs(x) { return x < 0 ? -x : x }
function finite(x) { return x !~ /[nN][aA][nN]|[iI][nN][fF]/ }
function miss(c, what) { if (!((c, what) in said)) { said[c, what] = 1; why[c] = why[c] (why[c] == "" ? "" : "; ") what } }
# One period of a force on its way to zero, `after` periods after the beginning.
function ramps(c, axis, force, before, after) {
  if (abs(force) > abs(before) + 1e-6) miss(c, axis " rises while it should fall")
  if (after >= ramp && force != 0) miss(c, axis " is not zero after the ramp")
  if (force != 0 && after + 1 > zero[c]) zero[c] = after + 1
}
BEGIN {
  split("nan-feedback frozen-encoder jump enable-toggled saturated nan-command", name)
  split("1 4 3 0 5 2", declared)
  split("feedback-not-finite feedback-frozen feedback-jumped none following-error command-not-finite", word)
}
# play.py: NUMBER NAME
FNR == NR { if ($1 == "play.py:" && NF == 3) played[$2] = 1; next }
NF != 14 { print "faults.awk: a row of another form" > "/dev/stderr"; exit 2 }
{
  if (last && $1 != last + 1) gaps++
  last = $1
  c = $2 % 10
  again = $2 > 10
  enable = $3; cmd = $4; fb = $5; force = $6; fault = $7; saturated = $9; yforce = $11
  if (!finite(force) || !finite(yforce)) miss(c, "a force is not finite")
  if (abs(force) > most[c]) most[c] = abs(force)
  if (abs(yforce) > most[c]) most[c] = abs(yforce)
  if (abs(force) > limit + 1e-6 || abs(yforce) > limit + 1e-6) miss(c, "force beyond the limit")
}
c && !again {
  if (!rows[c]++) {
    moving = $1
    moving_cmd = cmd0
    if (!(abs(cmd0 - cmd00) > 0.009)) miss(c, "x was not at speed")
  }
  if (!finite(fb) || !finite(cmd) || c == 3 && abs(fb - fb0) > 0.5) { if (!bad[c]) bad[c] = $1 }
  if (c == 2 && fb != fb0 && !caught[c]) { moving_cmd = cmd; moving = $1 }
  if (c == 5 && saturated && !bad[c]) bad[c] = $1
  if (c == 4) {
    if (fault) miss(c, "fault " fault)
    if (!enable && enable0) { off = 0; toggles++ }
    if (!enable) ramps(c, "x", force, force0, off++)
    if (!enable && together) ramps(c, "y", yforce, yforce0, off - 1)
    if (enable && !enable0) { on = 0; if (force0 != 0) miss(c, "enabled before the ramp had ended") }
    if (enable && ++on > 200 && abs(cmd - fb) > 0.02) miss(c, "x is not back on its command")
    if (enable && on > 200) settled = 1
  } else {
    if (fault && !caught[c]) {
      caught[c] = $1
      got[c] = fault
      late[c] = $1 - (c == 2 ? moving : bad[c])
      if (c == 2 && abs(cmd - moving_cmd) > 0.22) miss(c, "seen later than the command had gone on by frozen-limit")
      if (c == 5 && !bad[c]) miss(c, "never saturated")
      if (c == 5 && abs(cmd - fb) < 1) miss(c, "before the following error was ferror-limit")
    }
    if (caught[c]) {
      if (fault != got[c]) miss(c, "the fault did not stay")
      ramps(c, "x", force, force0, $1 - caught[c])
      if (together) ramps(c, "y", yforce, yforce0, $1 - caught[c])
    } else if (bad[c] && c != 5) miss(c, "a bad value went in unseen")
  }
  end_x[c] = force
  end_y[c] = yforce
}
c && again {
  if (fault && running[c]) miss(c, "fault " fault " after it was switched on again")
  if (enable) running[c]++
  if (!running[c] && fault != got[c]) miss(c, "the fault did not stay")
  if (enable && running[c] > 500 && (abs(cmd - fb) > 0.02 || abs($12 - $13) > 0.02))
    miss(c, "off its command after it was switched on again")
}
{ cmd00 = cmd0; cmd0 = cmd; force0 = force; yforce0 = yforce; enable0 = enable; fb0 = fb }
END {
  if (gaps) { print "faults.awk: " gaps " gaps in the log" > "/dev/stderr"; exit 2 }
  printf "%-16s %-24s %9s %9s %13s  %s\n", "case", "declared", "seen [ms]", "zero [ms]", "most |f| [N]", "result"
  for (c = 1; c <= 6; ++c) {
    if (!played[c]) miss(c, "LinuxCNC did not get this far")
    if (rows[c] < 100 || running[c] < 1000) miss(c, "not recorded")
    if (c != 4 && got[c] != declared[c]) miss(c, "fault " got[c] + 0)
    if (c == 4 && (toggles < 5 || !settled)) miss(c, "not toggled")
    if (end_x[c] != 0 || end_y[c] != 0) miss(c, "a force is left")
    if (why[c] != "") missed++
    result = why[c] == "" ? "as declared" : "MISS: " why[c]
    printf "%-16s %-24s %9s %9d %13.1f  %s\n", name[c], declared[c] " " word[c], c == 4 ? "" : late[c], zero[c], most[c], result
  }
  if (why[0] != "") { print "between the cases: MISS: " why[0]; missed++ }
  exit missed ? 1 : 0
}
