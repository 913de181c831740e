#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/pages/reproduction.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/path_options.hpp>
#include <stribeck/workflow/reproduce/identification.hpp>
#include <stribeck/workflow/reproduce/robustness.hpp>

namespace stribeck::cli {
namespace {

const std::vector<std::string> kIdentification{"ident-A", "ident-B", "ident-C", "ident-D", "verify"};

struct Options {
  Common common;
  std::vector<std::string> ids;
  std::string markdown;
  std::string check;
  std::uint32_t trials = 10;
  std::uint32_t machines = kRobustMachines;
  std::string vary = "all";
  std::vector<std::string> controllers;
  std::uint64_t seed = 1;
  unsigned threads = 0;
};

/// What is known of the axes of one machine, identified once for all experiments on it.
struct Known {
  sim::Machine machine;
  Needs needs;
  std::vector<bool> used;
  std::vector<sim::AxisKnowledge> identified;
};

std::vector<sim::AxisKnowledge> printed_knowledge(const sim::Machine& machine) {
  std::vector<sim::AxisKnowledge> all;
  for (const auto& [name, axis] : machine.axes)
    all.push_back({axis.published.conventional, axis.published.gaussian, axis.published.eccentric, {}});
  return all;
}

/// Every machine that the settings need, its axes identified for all of them together.
std::map<std::string, Known> learn(const std::vector<const sim::Experiment*>& chosen, const Options& o) {
  std::map<std::string, Known> all;
  for (const sim::Experiment* e : chosen) {
    for (const sim::Setting& s : e->settings) {
      Known& k = all[s.machine];
      if (k.machine.axes.empty()) k.machine = built_in_machine(s.machine);
      k.used.resize(k.machine.axes.size());
      k.identified.resize(k.machine.axes.size());
      if (s.parameters != sim::ParameterSource::kIdentified) continue;
      const Needs n = Needs::of(s.spec.controllers);
      k.needs.conventional = k.needs.conventional || n.conventional;
      k.needs.gaussian = k.needs.gaussian || n.gaussian;
      k.needs.eccentric = k.needs.eccentric || n.eccentric;
      k.needs.whole = k.needs.whole || n.whole;
      for (const std::size_t i : sim::chosen_axes(k.machine, s.spec)) k.used[i] = true;
    }
  }
  struct Job {
    Known* known;
    std::size_t axis;
  };
  std::vector<Job> jobs;
  for (auto& [name, k] : all) {
    for (std::size_t i = 0; i < k.used.size(); ++i) {
      if (k.used[i]) jobs.push_back({&k, i});
    }
  }
  Progress progress("identify", o.common.quiet);
  sim::parallel_for(
      jobs.size(), o.threads, [] { return 0; },
      [&](int&, std::size_t i) {
        Known& k = *jobs[i].known;
        k.identified[jobs[i].axis] = commission_axis(k.machine, jobs[i].axis, k.needs, o.seed).knowledge;
      },
      [&](std::size_t done, std::size_t count) { progress(done, count); });
  return all;
}

/// Words and numbers of a text, numbers apart.
struct Token {
  std::string text;
  double value = std::nan("");
};
std::vector<Token> tokens(const std::string& text) {
  std::vector<Token> all;
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    if (digit(text[i])) {
      while (end < text.size() && (digit(text[end]) || text[end] == '.')) ++end;
      all.push_back({text.substr(i, end - i), std::strtod(text.c_str() + i, nullptr)});
    } else {
      while (end < text.size() && !digit(text[end])) ++end;
      all.push_back({text.substr(i, end - i)});
    }
    i = end;
  }
  return all;
}

/// Whether two cells of measured numbers are as near as another processor's rounding explains. A loop that switches by sign
/// carries the last bit of a sine into the third digit of a figure, so numbers may differ by some per cent; near zero the sign may
/// change.
bool alike(const std::string& expected, const std::string& got) {
  constexpr double kRelative = 0.06;
  constexpr double kDecimals = 1.6;  // units of the last decimal
  const auto a = tokens(expected);
  const auto b = tokens(got);
  if (a.size() != b.size()) return false;
  bool may_change_sign = false;
  for (std::size_t i = a.size(); i-- > 0;) {
    if (!std::isfinite(a[i].value) || !std::isfinite(b[i].value)) {
      const auto without_sign = [](std::string t) {
        if (!t.empty() && t.back() == '-') t.pop_back();
        return t;
      };
      const bool same =
          a[i].text == b[i].text || (may_change_sign && without_sign(a[i].text) == without_sign(b[i].text));
      if (!same) return false;
      continue;
    }
    const auto point = a[i].text.find('.');
    const double unit =
        point == std::string::npos ? 1.0 : std::pow(10.0, -static_cast<double>(a[i].text.size() - point - 1));
    const double decimals = point == std::string::npos ? 0.0 : kDecimals * unit;
    if (std::abs(a[i].value - b[i].value) > std::max(kRelative * std::abs(a[i].value), decimals))
      return false;
    may_change_sign = std::abs(a[i].value) <= decimals && std::abs(b[i].value) <= decimals;
  }
  return true;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == at) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// The first line in which two tables differ by more than rounding, or nothing. What was printed, names and words must be the
/// same to the letter.
std::string first_difference(const std::string& expected, const std::string& got) {
  const auto a = split(expected, '\n');
  const auto b = split(got, '\n');
  bool printed = false;  // a table of printed figures: the fourth and fifth cell are ours
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const std::string line = i < a.size() ? a[i] : std::string();
    const std::string other = i < b.size() ? b[i] : std::string();
    if (line == other && i < a.size() && i < b.size()) {
      if (line.rfind("| figure |", 0) == 0) printed = true;
      if (line.empty()) printed = false;
      continue;
    }
    const auto x = split(line, '|');
    const auto y = split(other, '|');
    bool same = x.size() == y.size() && i < a.size() && i < b.size();
    for (std::size_t k = 0; same && k < x.size(); ++k) {
      const bool ours = x.size() == 1 ? line.rfind("- Cutting force", 0) == 0
                        : printed     ? k == 4 || k == 5
                                      : k > 1;
      same = x[k] == y[k] || (ours && alike(x[k], y[k]));
    }
    if (!same)
      return fmt::format("{}: expected {}, got {}", i + 1, io::in_quotes(line.substr(0, 120)),
                         io::in_quotes(other.substr(0, 120)));
  }
  return {};
}

int reproduce(const Options& o) {
  // Nothing of it is the thesis's, so "all" does not mean it.
  const bool robust = std::find(o.ids.begin(), o.ids.end(), kRobustness) != o.ids.end();
  if (!robust && !o.controllers.empty())
    refuse_option("--controller", "can be used with robustness only (add robustness to the experiments)");
  sim::RobustnessSpec varied = sim::robust_biaxial();
  varied.machines = o.machines;
  if (o.vary != "all") varied.variation = sim::vary_only(o.vary);
  varied.seed = o.seed;
  varied.threads = o.threads;
  if (!o.controllers.empty()) varied.controllers.resize(1);  // what the others are measured against
  for (const std::string& name : o.controllers)
    add_controller(varied.controllers, read_controller(name), name);
  const sim::Experiment robustness = robustness_experiment(varied);
  std::vector<std::string> inputs = o.controllers;
  inputs.push_back(o.check);
  check_distinct(inputs, {page_of(o.common), o.common.json, o.markdown});
  const std::string expected = o.check.empty() ? std::string() : io::read_text(o.check);
  const OutputFolder page_folder = check_outputs(o.common);
  io::check_writable(o.markdown);
  const auto all = sim::experiments();
  std::vector<const sim::Experiment*> chosen;
  std::vector<std::string> identification;
  const bool everything = std::find(o.ids.begin(), o.ids.end(), "all") != o.ids.end();
  const auto wanted = [&](const std::string& id) {
    return everything || std::find(o.ids.begin(), o.ids.end(), id) != o.ids.end();
  };
  for (const std::string& id : kIdentification) {
    if (wanted(id)) identification.push_back(id);
  }
  for (const sim::Experiment& e : all) {
    if (wanted(e.id)) chosen.push_back(&e);
  }

  report::ReproductionInput page;
  page.seed = o.seed;
  page.trials = chosen.empty() && identification.empty() ? 0 : o.trials;
  page.version = STRIBECK_VERSION;
  page.command = "stribeck reproduce " + report::joined(o.ids, " ");
  if (o.trials != 10) page.command += fmt::format(" --trials {}", o.trials);
  if (o.seed != 1) page.command += fmt::format(" --seed {}", o.seed);
  if (o.machines != kRobustMachines) page.command += fmt::format(" --machines {}", o.machines);
  if (o.vary != "all") page.command += " --vary " + o.vary;
  for (const std::string& name : o.controllers) page.command += " --controller " + shell_quoted(name);
  if (!identification.empty()) {
    page.sections = reproduce_identification(identification, built_in_machine("biaxial-table"),
                                             built_in_machine("triaxial-tool"), o.seed, o.threads);
  }
  auto identified = chosen;
  if (robust) identified.push_back(&robustness);
  const auto known = learn(identified, o);
  std::size_t settings = 0;
  for (const sim::Experiment* e : chosen) settings += e->settings.size();
  {
    Progress progress("reproduce", o.common.quiet);
    std::size_t done = 0;
    for (const sim::Experiment* e : chosen) {
      for (const sim::Setting& s : e->settings) {
        const Known& k = known.at(s.machine);
        const bool printed = s.parameters == sim::ParameterSource::kPrinted;
        sim::CompareSpec spec = s.spec;
        spec.trials = o.trials;
        spec.seed = o.seed;
        spec.threads = o.threads;
        const sim::CompareResult result =
            sim::compare(k.machine, printed ? printed_knowledge(k.machine) : k.identified, spec);
        page.sections.push_back(report::reproduced(
            *e, s, result,
            printed ? "printed parameters of the thesis" : "identified from logs of this machine"));
        progress(++done, settings);
      }
    }
  }

  if (robust) {
    Progress progress("robustness", o.common.quiet);
    const Known& k = known.at(robustness.settings.front().machine);
    page.sections.push_back(robustness_section(
        sim::robustness(k.machine, k.identified, varied,
                        [&](std::size_t done, std::size_t count) { progress(done, count); })));
  }

  write_json(o.common.json, report::reproduction_json(page));
  if (!o.common.report.empty()) report::write_reproduction(o.common.report, page);
  const std::string markdown = report::reproduction_markdown(page);
  if (!o.markdown.empty()) io::write_atomically(o.markdown, markdown);
  say(o.common, report::reproduction_text(page));
  if (!o.check.empty()) {
    const std::string difference = first_difference(expected, markdown);
    if (!difference.empty()) {
      fmt::print(stderr, "stribeck: {}:{} (write the table anew with --markdown)\n", o.check, difference);
      return 1;
    }
    say(o.common, fmt::format("\n{} is what comes out now.\n", o.check));
  }
  return 0;
}

}  // namespace

void add_reproduce(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "reproduce", "Repeat the experiments of the thesis and compare the results with its printed values");
  auto o = std::make_shared<Options>();
  std::vector<std::string> ids{"all"};
  for (const std::string& id : kIdentification) ids.push_back(id);
  for (const sim::Experiment& e : sim::experiments()) ids.push_back(e.id);
  ids.emplace_back(kRobustness);
  verb->add_option("ids", o->ids, "Experiments; all: every experiment of the thesis, without robustness")
      ->required()
      ->check(one_of(ids))
      ->type_name("ID");
  add_trials(*verb, o->trials, o->threads);
  add_seed(*verb, o->seed);
  verb->add_option("--machines", o->machines,
                   "Number of machines in robustness, each with different deviations")
      ->check(whole_from(1, 100000))
      ->capture_default_str();
  std::vector<std::string> factors = sim::variation_factors();
  factors.insert(factors.begin(), "all");
  verb->add_option("--vary", o->vary, "Factor in which the machines of robustness differ")
      ->check(one_of(factors))
      ->type_name("FACTOR")
      ->capture_default_str();
  verb->add_option(
          "--controller", o->controllers,
          fmt::format(
              "Controllers of robustness in place of (g) and the following, repeatable: {}, or a controller file, e.g. of tune -o",
              report::listed(built_in_controllers())))
      ->type_name("NAME|FILE.toml");
  verb->add_option("--markdown", o->markdown, "Table for a document")->type_name("FILE.md");
  verb->add_option("--check", o->check,
                   "Compare with a file that --markdown wrote; exit code 1 if they differ")
      ->type_name("FILE.md");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck reproduce all --report build/reproduction\n  stribeck reproduce smc-circle "
      "smc-free\n  stribeck reproduce robustness --machines 1000\n"
      "  stribeck reproduce robustness --controller tuned/f.toml --controller tuned/h.toml");
  verb->callback([o, &action] { action = [o] { return reproduce(*o); }; });
}

}  // namespace stribeck::cli
