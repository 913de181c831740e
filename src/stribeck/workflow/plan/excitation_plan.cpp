#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/plan/excitation_plan.hpp>
#include <utility>

namespace stribeck::workflow {
namespace {

using ident::excitation::ExcitationMethod;

constexpr std::array kMethods{ExcitationMethod::kJog, ExcitationMethod::kSine, ExcitationMethod::kPulses,
                              ExcitationMethod::kConstantAcceleration, ExcitationMethod::kMultisine};
constexpr std::array kAll{Wanted::kMass, Wanted::kFriction, Wanted::kBristles, Wanted::kDelay};

/// Weight of what is missing; static friction, where friction is wanted, counts half.
constexpr int kWhole = 2;

/// How far a set of logs is from what is wanted: first how much is missing, then how wide the rest is.
std::pair<int, double> distance(const ExpectedHalf& e, const std::vector<Wanted>& wanted) {
  int missing = 0;
  double wide = 0.0;
  for (const Wanted w : wanted) {
    if (!e.good(w)) {
      missing += kWhole;
    } else if (w == Wanted::kFriction && !e.at_rest) {
      ++missing;
    }
    wide += std::isfinite(e[w]) ? std::min(e[w], 1.0) : 2.0;
  }
  return {missing, wide};
}

/// One that has been found good is not given up for a few percent of width.
bool better(std::pair<int, double> a, double seconds_a, std::pair<int, double> b, double seconds_b) {
  if (a.first != b.first) return a.first < b.first;
  if (a.first < kWhole) return seconds_a < seconds_b;
  return a.second < b.second;
}

constexpr std::size_t kMostLogs = 3;
/// Logs that are tried at most: each method alone, then beside one, then beside two others.
constexpr std::size_t kMostTried = 3 * kMethods.size() - 3;

/// The methods that may be added to the chosen ones.
std::vector<std::size_t> fitting(const ExcitationPlan& plan) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    const CandidateLog& c = plan.candidates[i];
    const bool taken = std::find(plan.chosen.begin(), plan.chosen.end(), i) != plan.chosen.end();
    if (!taken && c.refused.empty() && plan.duration() + c.duration <= plan.options.longest) out.push_back(i);
  }
  return out;
}

/// What the chosen logs tell with each of these beside them.
std::vector<ExpectedHalf> with_each(const ExcitationPlan& plan, const StandIn& axis,
                                    const std::vector<std::size_t>& more, const Progress& progress) {
  std::vector<ExpectedHalf> out(more.size());
  if (plan.chosen.empty()) {
    for (std::size_t k = 0; k < more.size(); ++k) out[k] = plan.candidates[more[k]].expected;
    return out;
  }
  sim::parallel_for(
      more.size(), 0, [] { return 0; },
      [&](int, std::size_t k) {
        std::vector<ExcitationMethod> methods;
        for (const std::size_t i : plan.chosen) methods.push_back(plan.candidates[i].method);
        methods.push_back(plan.candidates[more[k]].method);
        out[k] = axis.together(methods);
      },
      progress);
  return out;
}

void choose(ExcitationPlan& plan, const StandIn& axis, const Progress& progress) {
  const std::vector<Wanted>& wanted = plan.options.wanted;
  std::size_t tried = plan.candidates.size();
  while (plan.chosen.size() < kMostLogs) {
    const std::vector<std::size_t> more = fitting(plan);
    const std::vector<ExpectedHalf> expected =
        with_each(plan, axis, more, [&](std::size_t done, std::size_t) {
          if (progress) progress(tried + done, kMostTried);
        });
    tried += plan.chosen.empty() ? 0 : more.size();
    const auto seconds = [&](std::size_t k) { return plan.candidates[more[k]].duration; };
    std::size_t best = 0;
    for (std::size_t k = 1; k < more.size(); ++k) {
      if (better(distance(expected[k], wanted), seconds(k), distance(expected[best], wanted), seconds(best)))
        best = k;
    }
    if (more.empty()) return;
    const auto now = distance(expected[best], wanted);
    const auto before = distance(plan.together, wanted);
    const bool gains =
        now.first < before.first || (now.first == before.first && now.second < 0.8 * before.second);
    if (!plan.chosen.empty() && !gains) return;
    plan.chosen.push_back(more[best]);
    plan.together = expected[best];
    if (now.first == 0) return;
  }
}

/// Its method and why there is no such log; most reasons begin with the method themselves.
std::string with_name(const CandidateLog& c) {
  const std::string name(enum_name(c.method));
  return c.refused.starts_with(name + ": ") ? c.refused : name + ": " + c.refused;
}

/// Why a shorter log that tells all but static friction is not the chosen one; empty: there is none.
std::string why_longer(const ExcitationPlan& plan) {
  const auto& wanted = plan.options.wanted;
  const bool asked = std::find(wanted.begin(), wanted.end(), Wanted::kFriction) != wanted.end();
  if (!asked || !plan.together.at_rest) return {};
  std::vector<std::string> shorter;
  for (const CandidateLog& c : plan.candidates) {
    const bool good = std::all_of(wanted.begin(), wanted.end(), [&](Wanted w) { return c.expected.good(w); });
    if (c.refused.empty() && good && !c.expected.at_rest && c.duration < plan.duration())
      shorter.emplace_back(enum_name(c.method));
  }
  if (shorter.empty()) return {};
  return fmt::format("Shorter, but without static friction: {}.\n", report::listed(shorter));
}

std::string shown(const ExpectedHalf& e, Wanted w) {
  if (!std::isfinite(e[w])) return "no";
  return w == Wanted::kDelay ? ident::digits(e[w], 2) : ident::digits(100.0 * e[w], 2);
}

nlohmann::ordered_json json_of(const ExpectedHalf& e) {
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  return {{"mass_percent", number(100.0 * e[Wanted::kMass])},
          {"friction_percent", number(100.0 * e[Wanted::kFriction])},
          {"break_away_distance_percent", number(100.0 * e[Wanted::kBristles])},
          {"delay_periods", number(e[Wanted::kDelay])}};
}

}  // namespace

double ExcitationPlan::duration() const {
  double sum = 0.0;
  for (const std::size_t i : chosen) sum += candidates[i].duration;
  return sum;
}

ExcitationPlan plan_excitation(const PlanOptions& given, const Progress& progress) {
  ExcitationPlan plan;
  plan.options = given;
  if (plan.options.wanted.empty()) plan.options.wanted.assign(kAll.begin(), kAll.end());
  const MachineDescription machine = read_description(given.machine);
  const std::size_t axis = axis_index(as_machine(machine), given.machine, given.axis);
  require_force_limit(machine, given.machine, axis);
  StandIn stand_in(machine, given.machine, axis, given.known);
  plan.candidates = stand_in.logs_of(kMethods, given.longest, [&](std::size_t done, std::size_t) {
    if (progress) progress(done, kMostTried);
  });
  choose(plan, stand_in, progress);
  if (plan.chosen.empty()) {
    std::string why;
    for (const CandidateLog& c : plan.candidates) why += (why.empty() ? "" : "; ") + with_name(c);
    throw ident::Refused(fmt::format("axis {}: no excitation fits: {}", given.axis, why));
  }
  return plan;
}

std::string next_log(std::vector<Wanted> open, const ident::Result& r, const std::string& machine,
                     const std::string& axis, const std::string& axis_file) {
  std::string out;
  const auto rests_open = [&](const char* name) {
    const ident::Parameter* p = r.find(name);
    return p != nullptr && !p->identifiable;
  };
  if (rests_open("static_positive") || rests_open("static_negative")) {
    // The plan weighs friction over the speeds of the axis; what rises below the slowest one is told by jogs alone.
    std::erase(open, Wanted::kFriction);
    out = fmt::format(
        "To tell static friction, record slow jogs:\n  stribeck excite {} --axis {} --method jog -o {}-jog.csv\n",
        machine, axis, axis);
  }
  if (open.empty()) return out;
  std::vector<std::string> words;
  for (const Wanted w : open) words.emplace_back(enum_name(w));
  return out +
         fmt::format(
             "To tell {} better, plan the next log:\n  stribeck excite {} --axis {} --for {}{} -o next\n",
             report::listed(words), machine, axis, fmt::join(words, ","),
             axis_file.empty() ? "" : " --known " + axis_file);
}

std::string text_of(const ExcitationPlan& plan) {
  report::TextColumn method{"method", "", {}, false};
  report::TextColumn seconds{"time", "s", {}};
  report::TextColumn mass{"mass", "+- %", {}};
  report::TextColumn friction{"friction", "+- %", {}};
  report::TextColumn bristles{"break-away distance", "+- %", {}};
  report::TextColumn delay{"delay", "+- periods", {}};
  const auto add = [&](std::string name, double duration, const ExpectedHalf& e) {
    method.entries.push_back(std::move(name));
    seconds.entries.push_back(fmt::format("{:.0f}", duration));
    mass.entries.push_back(shown(e, Wanted::kMass));
    friction.entries.push_back(shown(e, Wanted::kFriction));
    bristles.entries.push_back(shown(e, Wanted::kBristles));
    delay.entries.push_back(shown(e, Wanted::kDelay));
  };
  std::string refused;
  for (const CandidateLog& c : plan.candidates) {
    if (c.refused.empty()) {
      add(std::string(enum_name(c.method)), c.duration, c.expected);
    } else {
      refused += fmt::format("Not {}.\n", with_name(c));
    }
  }
  std::string together;
  for (const std::size_t i : plan.chosen)
    together += (together.empty() ? "" : " + ") + std::string(enum_name(plan.candidates[i].method));
  if (plan.chosen.size() > 1) add(together, plan.duration(), plan.together);
  std::string out = fmt::format(
      "What a log of axis {} is expected to tell (half of the 95 % interval; no: not determined):\n",
      plan.options.axis);
  out += report::lay_out({method, seconds, mass, friction, bristles, delay}) + refused;
  out += fmt::format("Record: {}, {:.0f} s in all.\n", together, plan.duration()) + why_longer(plan);
  for (const Wanted w : plan.options.wanted) {
    if (plan.together.good(w)) continue;
    out += std::isfinite(plan.together[w])
               ? fmt::format("Wider than is good enough, within {:.0f} s: {}.\n", plan.options.longest,
                             enum_name(w))
               : fmt::format("Not determined within {:.0f} s: {}.\n", plan.options.longest, enum_name(w));
  }
  const auto& wanted = plan.options.wanted;
  const bool asked = std::find(wanted.begin(), wanted.end(), Wanted::kFriction) != wanted.end();
  if (asked && plan.together.good(Wanted::kFriction) && !plan.together.at_rest)
    out += "Static friction is not determined by it: record slow jogs as well (--method jog).\n";
  out +=
      plan.options.known.empty()
          ? "This is computed from the rough mass and friction of the machine file; identify, and ask again with --known AXIS.toml.\n"
          : fmt::format("This is computed from {}.\n", plan.options.known);
  return out;
}

nlohmann::ordered_json to_json(const ExcitationPlan& plan) {
  nlohmann::ordered_json out{{"schema", "stribeck.plan/1"}, {"axis", plan.options.axis}};
  out["wanted"] = nlohmann::ordered_json::array();
  for (const Wanted w : plan.options.wanted) out["wanted"].push_back(enum_name(w));
  out["candidates"] = nlohmann::ordered_json::array();
  for (const CandidateLog& c : plan.candidates) {
    out["candidates"].push_back(
        {{"method", enum_name(c.method)},
         {"refused", c.refused.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(c.refused)},
         {"duration_s", c.duration},
         {"expected", json_of(c.expected)}});
  }
  out["chosen"] = nlohmann::ordered_json::array();
  for (const std::size_t i : plan.chosen) out["chosen"].push_back(enum_name(plan.candidates[i].method));
  out["duration_s"] = plan.duration();
  out["expected"] = json_of(plan.together);
  return out;
}

}  // namespace stribeck::workflow
