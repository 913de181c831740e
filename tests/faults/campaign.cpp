// What becomes of each fault (breaks.hpp) under each controller: on the machines of machines/, and through the C interface on a plant
// that shares no code with Stribeck's.
//
//   fault_campaign [--csv FILE] [--tables FILE]
//
// Prints the table; exit code 1 when an end is not the declared one. In every run each force is a number within its limit, and after a
// stop the forces are at their safe values within 50 ms.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <stribeck/sim/parallel.hpp>

#include "breaks.hpp"
#include "drill.hpp"
#include "other_machine.hpp"

namespace stribeck::test {
namespace {

constexpr double kRunIn = 1.0;   // [s]
constexpr double kWhen = 3.0;    // it breaks [s]
constexpr double kUntil = 5.5;   // [s]
constexpr double kBack = 0.2;    // a small fault is over [s]
constexpr double kSafe = 50e-3;  // from fault to safe forces [s]
constexpr double kBrake = 0.1;   // until a holding brake has closed [s]
constexpr const char* kOther = "C interface, other plant";

/// Numbers of one run.
struct Outcome {
  control::Fault fault = control::Fault::kNone;
  double stopped = -1.0;  ///< since it broke [s]; below 0: it went on
  double safe = 0.0;      ///< from the fault to the safe forces [s]
  double moved = 0.0;     ///< since it broke, the axis that moved farthest [m]
  double before = 0.0;    ///< largest tracking error without the fault [m]
  double error = 0.0;     ///< with it [m]
  double later = 0.0;     ///< the same, kBack later [m]
  double speed = 0.0;     ///< when it broke [m/s]
  bool forces_good = true;
  std::uint32_t bridged = 0;
};

/// One controller on one machine.
struct Subject {
  std::string machine;
  std::string controller;
  Sound sound;
  double before = 0.0;  ///< largest error after the run-in [m]
  std::function<Outcome(const Subject&, const Break&, std::size_t axis)> run;
};

struct Cell {
  std::size_t subject;
  std::size_t fault;
  Outcome worst;
  std::string complaint;  ///< empty: the end is the declared one
};

double begin_of(const Break& b) { return b.since == Since::kWhen ? kWhen : 0.0; }

/// From where the way of a stopped axis counts. A machine that is another one from the start has travelled by then.
double way_begins(const Break& b, double fault) { return b.since == Since::kStart ? fault : begin_of(b); }

Outcome outcome_of(const Drilled& o, const Subject& s, const Break& b) {
  const double begin = begin_of(b);
  Outcome out;
  out.fault = o.fault;
  out.forces_good = o.forces_good();
  out.before = s.before;
  out.bridged = o.bridged;
  out.speed = b.since == Since::kWhen ? s.sound.speed : 0.0;
  if (o.tripped >= 0.0) {
    out.stopped = std::max(o.tripped - begin, 0.0);
    out.safe = o.safe_after(o.tripped);
    for (std::size_t i = 0; i < s.sound.axes; ++i)
      out.moved = std::max(out.moved, o.moved(i, way_begins(b, o.tripped), o.tripped + kBrake));
  }
  out.error = o.worst(kRunIn, kUntil);
  out.later = o.worst(kWhen + kBack, kUntil);
  return out;
}

Drill broken(Drill d, const Broken& b) {
  d.duration = kUntil;
  d.encoder = b.encoder;
  d.force = b.force;
  d.friction = b.friction;
  d.mass = b.mass;
  d.command_lost = b.command_lost;
  if (b.mode) d.mode = plant::AxialMode{40.0, 0.03, 0.5};
  if (b.force_limit) {
    d.force_limit.emplace();
    std::copy(b.force_limit->begin(), b.force_limit->end(), d.force_limit->c.begin());
  }
  return d;
}

Subject subject_of(const Drill& drill) {
  Subject s;
  s.machine = drill.machine;
  s.controller = drill.controller.id + ", " + drill.controller.label;
  const sim::Machine machine = machine_of(drill.machine);
  const Drilled sound = run(broken(drill, {}));
  s.sound.period = machine.sample_time;
  s.sound.when = kWhen;
  s.sound.speed = sound.speed(kWhen);
  s.sound.axes = drill.travel.axes();
  for (std::size_t i = 0; i < s.sound.axes; ++i) {
    s.sound.resolution[i] =
        machine.axes[drill.axes.empty() ? i : drill.axes[i]].second.name_plate().encoder_resolution;
    s.sound.limit[i] = sound.limit[i];
    for (const Tick& t : sound.ticks) s.sound.peak[i] = std::max(s.sound.peak[i], std::abs(t.force[i]));
  }
  s.before = sound.worst(kRunIn, kUntil);
  s.run = [drill](const Subject& self, const Break& b, std::size_t axis) {
    Broken now;
    b.bring_about(now, self.sound, axis);
    return outcome_of(test::run(broken(drill, now)), self, b);
  };
  return s;
}

Outcome run_other(const std::string& law, const Subject& s, const Break& b, std::size_t wrong) {
  Broken now;
  b.bring_about(now, s.sound, wrong);
  OtherMachine::Odd odd;
  odd.friction = now.friction;
  odd.mass = now.mass;
  odd.mode = now.mode;
  if (now.force_limit) odd.force_limit = std::max((*now.force_limit)[0], (*now.force_limit)[1]);
  OtherMachine m(law, odd);
  m.encoder = now.encoder;
  m.acts = now.force;
  m.command_lost = now.command_lost;
  Outcome out;
  out.before = s.before;
  out.speed = b.since == Since::kWhen ? s.sound.speed : 0.0;
  const double begin = begin_of(b);
  std::vector<std::array<double, 2>> way;
  double fault = -1.0;
  std::array<double, 2> last = m.force;
  while (m.time() < kUntil) {
    const double t = m.time();
    way.push_back({m.axis[0].table(), m.axis[1].table()});
    m.period();
    if (m.result == STRIBECK_FAULT && fault < 0.0) fault = t;
    if (fault >= 0.0 && m.force != last) out.safe = t - fault;
    last = m.force;
    if (t > kRunIn) out.error = std::max(out.error, m.error);
    if (t > kWhen + kBack) out.later = std::max(out.later, m.error);
  }
  if (fault >= 0.0) {
    out.stopped = std::max(fault - begin, 0.0);
    const auto tick = [&](double t) {
      return std::min(static_cast<std::size_t>(t / m.kPeriod + 0.5), way.size() - 1);
    };
    const std::size_t from = tick(way_begins(b, fault));
    for (std::size_t k = from; k <= tick(fault + kBrake); ++k) {
      for (std::size_t i = 0; i < 2; ++i) out.moved = std::max(out.moved, std::abs(way[k][i] - way[from][i]));
    }
  }
  out.fault = static_cast<control::Fault>(m.why().fault);
  out.forces_good = m.good;
  for (std::uint32_t i = 0; i < 2; ++i) out.bridged += m.signals(i).bridged;
  return out;
}

Subject other_subject(const std::string& law) {
  Subject s;
  s.machine = kOther;
  s.controller = law;
  s.sound = {OtherMachine::kPeriod, kWhen, 10e-3, 2, {1e-7, 1e-7}, {250.0, 250.0}, {}};
  OtherMachine m(law);
  while (m.time() < kUntil) {
    m.period();
    for (std::size_t i = 0; i < 2; ++i) s.sound.peak[i] = std::max(s.sound.peak[i], std::abs(m.force[i]));
    if (m.time() > kRunIn) s.before = std::max(s.before, m.error);
  }
  s.run = [law](const Subject& self, const Break& b, std::size_t axis) {
    return run_other(law, self, b, axis);
  };
  return s;
}

/// What is not as declared; empty: nothing.
std::string complaint(const Outcome& o, const Break& b) {
  const bool went_on = o.stopped < 0.0;
  const double most = b.with_speed ? b.most * std::max(1.0, o.speed / 10e-3) : b.most;
  std::ostringstream bad;
  if (!o.forces_good) bad << "a force that is no number or above the limit; ";
  if (b.end == End::kStops && went_on) bad << "it is not stopped; ";
  if ((b.end == End::kGoesOn || b.end == End::kGoesOnSoon) && !went_on)
    bad << "it is stopped (" << name_of(o.fault) << "); ";
  if (went_on && o.error - o.before > most)
    bad << "the error grows by " << (o.error - o.before) * 1e6 << " um; ";
  // Up to what the noise of another way through it makes.
  if (b.end == End::kGoesOnSoon && went_on && o.later > 1.2 * o.before + 0.1e-6)
    bad << "0.2 s later the error is " << o.later * 1e6 << " um, before " << o.before * 1e6 << " um; ";
  if (!went_on && o.moved > most) bad << "an axis moves " << o.moved * 1e3 << " mm; ";
  if (!went_on && o.safe > kSafe) bad << "the forces are safe after " << o.safe * 1e3 << " ms; ";
  // Where a signal is lost, from its first bad sample on.
  if (!went_on && b.with_speed && o.stopped + o.safe > kSafe + 1e-9)
    bad << "the forces are safe " << (o.stopped + o.safe) * 1e3 << " ms after the first bad sample; ";
  if (b.name == "none" && o.bridged > 0) bad << o.bridged << " samples are bridged; ";
  return bad.str();
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, x < 10.0 ? "%.2g" : "%.0f", x);
  return text;
}

/// All controllers of one machine under one fault, in a few words.
std::string in_words(const std::vector<const Cell*>& cells, bool sound) {
  std::size_t on = 0;
  double grown = 0.0;
  double late = 0.0;
  double far = 0.0;
  std::map<std::string, std::size_t> reasons;
  for (const Cell* c : cells) {
    if (c->worst.stopped < 0.0) {
      ++on;
      grown = std::max(grown, c->worst.error - (sound ? 0.0 : c->worst.before));
    } else {
      ++reasons[std::string(name_of(c->worst.fault))];
      late = std::max(late, c->worst.stopped);
      far = std::max(far, c->worst.moved);
    }
  }
  std::string text;
  if (on > 0) {
    text = (on < cells.size() ? std::to_string(on) + " go on" : std::string("goes on")) +
           (sound ? ": " : ": + ") + number(grown * 1e6) + " µm";
  }
  if (on == cells.size()) return text;
  if (on > 0) text += "; others ";
  text += "stopped:";
  for (const auto& [reason, n] : reasons) text += (text.back() == ':' ? " " : ", ") + reason;
  return text + " within " + number(late * 1e3) + " ms, " + number(far * 1e3) + " mm";
}

struct Campaign {
  std::vector<Break> faults = all_breaks();
  std::vector<Subject> subjects;
  std::vector<Cell> cells;
  std::size_t runs = 0;

  void prepare() {
    const std::vector<Drill> drills = all_drills();
    const char* laws[] = {"contouring", "sliding-mode", "predictive", "learning"};
    subjects.resize(drills.size() + std::size(laws));
    sim::parallel_for(
        subjects.size(), 0, [] { return 0; },
        [&](int, std::size_t i) {
          subjects[i] = i < drills.size() ? subject_of(drills[i]) : other_subject(laws[i - drills.size()]);
        });
  }
  void play() {
    for (std::size_t f = 0; f < faults.size(); ++f) {
      for (std::size_t s = 0; s < subjects.size(); ++s) cells.push_back({s, f, {}, {}});
    }
    sim::parallel_for(
        cells.size(), 0, [] { return 0; },
        [&](int, std::size_t i) {
          Cell& c = cells[i];
          const Subject& s = subjects[c.subject];
          const Break& b = faults[c.fault];
          for (std::size_t axis = 0; axis < (b.since == Since::kStartEachAxis ? s.sound.axes : 1); ++axis) {
            const Outcome o = s.run(s, b, axis);
            if (axis == 0 || o.moved > c.worst.moved) c.worst = o;
            if (c.complaint.empty()) c.complaint = complaint(o, b);
          }
        });
    for (const Cell& c : cells)
      runs += faults[c.fault].since == Since::kStartEachAxis ? subjects[c.subject].sound.axes : 1;
  }
  [[nodiscard]] std::vector<std::string> machines() const {
    std::vector<std::string> names;
    for (const Subject& s : subjects) {
      if (std::find(names.begin(), names.end(), s.machine) == names.end()) names.push_back(s.machine);
    }
    return names;
  }
  [[nodiscard]] std::string table() const {
    std::string text = "| Fault |";
    std::string line = "|---|";
    for (const std::string& m : machines()) {
      const auto n =
          std::count_if(subjects.begin(), subjects.end(), [&](const Subject& s) { return s.machine == m; });
      text += " " + m + ", " + std::to_string(n) + " controllers |";
      line += "---|";
    }
    text += "\n" + line + "\n";
    for (std::size_t f = 0; f < faults.size(); ++f) {
      text += "| " + faults[f].name + " |";
      for (const std::string& m : machines()) {
        std::vector<const Cell*> of;
        for (const Cell& c : cells) {
          if (c.fault == f && subjects[c.subject].machine == m) of.push_back(&c);
        }
        text += " " + in_words(of, faults[f].name == "none") + " |";
      }
      text += "\n";
    }
    return text;
  }
  [[nodiscard]] std::string declared() const {
    std::string text = "| Fault | Declared end |\n|---|---|\n";
    for (const Break& b : faults) {
      const std::string most = b.most < 1e-3 ? number(b.most * 1e6) + " µm" : number(b.most * 1e3) + " mm";
      const std::string speed = b.with_speed ? " at 10 mm/s, in proportion above" : "";
      text += "| " + b.name + " | ";
      switch (b.end) {
        case End::kGoesOn:
          text += b.name == "none" ? "goes on; no sample is bridged"
                                   : "goes on; the error grows by at most " + most;
          break;
        case End::kGoesOnSoon:
          text += "goes on; the error grows by at most " + most + ", and is as before after 0.2 s";
          break;
        case End::kStops:
          text += "is stopped; no axis moves by more than " + most + speed;
          break;
        case End::kEither:
          text += "goes on, and the error grows by at most " + most +
                  "; or is stopped, and no axis moves by more than that";
          break;
      }
      text += " |\n";
    }
    return text;
  }
  void write_csv(const std::string& file) const {
    std::ofstream out(file);
    out << "fault,machine,controller,ended,stopped_ms,safe_ms,moved_mm,error_before_um,error_um,error_later_um,bridged,as_declared\n";
    for (const Cell& c : cells) {
      const Outcome& o = c.worst;
      const bool on = o.stopped < 0.0;
      out << '"' << faults[c.fault].name << "\"," << subjects[c.subject].machine << ",\""
          << subjects[c.subject].controller << "\"," << (on ? "goes-on" : name_of(o.fault)) << ',';
      if (on) {
        out << ",,,";
      } else {
        out << o.stopped * 1e3 << ',' << o.safe * 1e3 << ',' << o.moved * 1e3 << ',';
      }
      out << o.before * 1e6 << ',' << o.error * 1e6 << ',' << o.later * 1e6 << ',' << o.bridged << ','
          << (c.complaint.empty() ? "yes" : "no") << '\n';
    }
    if (!out.flush()) throw std::runtime_error("cannot write " + file);
  }
  void write_tables(const std::string& file) const;
};

void Campaign::write_tables(const std::string& file) const {
  std::ofstream out(file);
  out << runs << " runs, " << machines().size() << " machines, " << subjects.size()
      << " controllers.\n\n## Declared\n\n"
      << declared() << "\n## Measured\n\n"
      << table();
  if (!out.flush()) throw std::runtime_error("cannot write " + file);
}

int main_with(int argc, char** argv) {
  std::string csv;
  std::string tables;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--csv") == 0 && i + 1 < argc) {
      csv = argv[++i];
    } else if (std::strcmp(argv[i], "--tables") == 0 && i + 1 < argc) {
      tables = argv[++i];
    } else {
      std::cerr << "usage: fault_campaign [--csv FILE] [--tables FILE]\n";
      return 2;
    }
  }
  Campaign c;
  c.prepare();
  c.play();
  std::cout << c.table() << '\n';
  if (!csv.empty()) c.write_csv(csv);
  if (!tables.empty()) c.write_tables(tables);
  std::size_t bad = 0;
  for (const Cell& cell : c.cells) {
    if (cell.complaint.empty()) continue;
    ++bad;
    std::cout << "not as declared: " << c.faults[cell.fault].name << ", " << c.subjects[cell.subject].machine
              << " (" << c.subjects[cell.subject].controller << "): " << cell.complaint << '\n';
  }
  std::cout << c.runs << " runs, " << bad << " ends not as declared\n";
  return bad == 0 ? 0 : 1;
}

}  // namespace
}  // namespace stribeck::test

int main(int argc, char** argv) {
  try {
    return stribeck::test::main_with(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << "fault_campaign: " << e.what() << '\n';
    return 2;
  }
}
