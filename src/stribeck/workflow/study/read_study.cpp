#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <stribeck/io/sha256.hpp>
#include <stribeck/path/curve.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/sim/in_order.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <stribeck/workflow/study/study.hpp>
#include <stribeck/workflow/study/uncertain_models.hpp>
#include <system_error>

namespace stribeck::workflow {
namespace {

/// Keys of a study by the options that other verbs have for the same.
const std::map<std::string, std::string, std::less<>> kKeys{{"--experiment", "motion.experiment"},
                                                            {"--path", "motion.path"},
                                                            {"--size", "motion.size"},
                                                            {"--laps", "motion.laps"},
                                                            {"--speed", "motion.speeds"},
                                                            {"--controller", "controllers"},
                                                            {"--axis-file", "axis_files"},
                                                            {"--parameters", "parameters"}};

std::size_t line_of_key(const io::Node& root, std::string_view key) {
  const io::Node* at = &root;
  while (!key.empty()) {
    const std::size_t dot = std::min(key.find('.'), key.size());
    const io::Node* const child = at->find(key.substr(0, dot));
    if (child == nullptr) break;
    at = child;
    key.remove_prefix(std::min(dot + 1, key.size()));
  }
  return at->line;
}

class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file), root_(io::load_toml(file)) {}

  Study operator()() {
    Study s;
    s.source = file_;
    io::Problems problems(file_);
    s.file = io::read<StudyFile>(root_, problems);
    problems.throw_if_any();
    s.inputs.push_back(file_);
    s.machine_file = beside(s.file.machine);
    s.inputs.push_back(s.machine_file);
    as_keys([&] {
      for (const std::string& text : s.file.axis_files) {
        const auto [axis, file] = axis_and_file(text);
        s.parameters.axis_files.push_back(axis + '=' + beside(file));
        s.inputs.push_back(beside(file));
      }
      s.machine = read_virtual_machine(s.machine_file, s.parameters.axis_files, AxisWithoutTruth::kLeftOut);
      set_up(s);
    });
    const std::vector<KnownAxis> known = known_axes(s);
    s.machine = with_models(s.machine, s.file, s.axes, known);
    s.factors = bind_factors(s.file, root_, file_, s.machine, s.axes, known);
    find_columns(s);
    count(s);
    return s;
  }

 private:
  [[noreturn]] void refuse(std::string_view key, const std::string& message) const {
    throw io::InputError(io::Problem{file_, line_of_key(root_, key), std::string(key), message});
  }

  /// A path that counts from the folder of the file.
  [[nodiscard]] std::string beside(const std::string& path) const {
    return (std::filesystem::path(file_).parent_path() / path).string();
  }

  /// Problems with what is an option elsewhere get file, line and key.
  template <class Act>
  void as_keys(Act&& act) const {
    try {
      act();
    } catch (const io::InputError& e) {
      const io::Problem& p = e.problems().front();
      const std::string& option = p.file.starts_with("--") ? p.file : p.key;
      const std::string first = option.substr(0, option.find_first_of(", "));
      const auto known = kKeys.find(first);
      if (!first.starts_with("--")) throw;
      refuse(known == kKeys.end() ? std::string_view("motion") : std::string_view(known->second), p.message);
    }
  }

  PathOptions path_options(Study& s) const {
    const StudyMotion& m = s.file.motion;
    PathOptions p;
    p.laps = m.laps;
    p.size = m.size;
    if (!m.path.empty()) p.path = enum_value<path::Shape>(m.path) ? m.path : beside(m.path);
    if (is_file(p)) {
      s.inputs.push_back(p.path);
      s.path_checksum = io::sha256_of_file(p.path);
    }
    return p;
  }

  void set_up(Study& s) const {
    const StudyMotion& m = s.file.motion;
    const PathOptions path = path_options(s);
    const std::string experiment =
        m.experiment.empty() ? default_experiment(s.machine, path, m.speeds) : m.experiment;
    const std::vector<std::string> known = experiment_ids();
    if (std::find(known.begin(), known.end(), experiment) == known.end()) {
      refuse("motion.experiment",
             fmt::format("got {}, expected one of {}", io::in_quotes(experiment), report::listed(known)));
    }
    s.spec = experiment_spec(experiment, path, m.speeds, s.machine, s.machine_file);
    s.parameters.source = enum_name(s.file.parameters);
    add_beyond(s.spec.controllers, experiment, s.parameters);
    std::vector<sim::ControllerSpec> chosen;
    for (const std::string& name : s.file.controllers) {
      std::error_code ignored;
      const bool is_file = std::filesystem::is_regular_file(beside(name), ignored);
      if (is_file) s.inputs.push_back(beside(name));
      sim::ControllerSpec c = chosen_controller(s.spec.controllers, is_file ? beside(name) : name);
      const auto same = [&](const sim::ControllerSpec& other) { return other.id == c.id; };
      if (std::any_of(chosen.begin(), chosen.end(), same))
        refuse("controllers",
               fmt::format("{} stands there twice, expected each controller once", io::in_quotes(c.id)));
      chosen.push_back(std::move(c));
    }
    s.spec.controllers = std::move(chosen);
    s.spec.seed = s.file.seed;
    for (sim::Travel& t : s.spec.travels) {
      if (m.settle_laps > 0.0 && t.part() != nullptr)
        refuse("motion.settle_laps", "a part program is scored from end to end (leave it out)");
      t.settle_laps += m.settle_laps;
    }
    check_travel(s.machine, s.machine_file, s.spec);
    s.axes = sim::chosen_axes(s.machine, s.spec);
    for (const std::string& text : s.parameters.axis_files)
      static_cast<void>(axis_index(s.machine, s.machine_file, axis_and_file(text).first));
  }

  /// The axis files that factors may need.
  [[nodiscard]] static std::vector<KnownAxis> known_axes(const Study& s) {
    std::vector<KnownAxis> known;
    const auto& factors = s.file.factors;
    if (std::none_of(factors.begin(), factors.end(), [](const StudyFactor& f) { return f.is_uncertainty(); }))
      return known;
    for (const std::string& text : s.parameters.axis_files) {
      const auto [axis, file] = axis_and_file(text);
      known.push_back(
          {axis_index(s.machine, s.machine_file, axis), file, io::read_toml<sim::AxisFile>(file)});
    }
    return known;
  }

  void find_columns(Study& s) const {
    for (const std::string& name : s.file.figures) {
      std::vector<std::string_view> names;
      const sim::Figure* found = nullptr;
      for (const sim::Figure& f : sim::kFigures) {
        names.push_back(f.key);
        if (f.key == name) found = &f;
      }
      if (found == nullptr) {
        const std::string_view near = io::nearest(name, names);
        const std::vector<std::string> all(names.begin(), names.end());
        refuse("figures",
               fmt::format("got {}, expected {}", io::in_quotes(name),
                           near.empty() ? "some of " + report::joined(all, ", ")
                                        : "a figure of merit (meant " + io::in_quotes(near) + "?)"));
      }
      const auto same = [&](const StudyColumn& c) { return c.figure == found; };
      if (std::any_of(s.columns.begin(), s.columns.end(), same))
        refuse("figures", fmt::format("{} stands there twice", io::in_quotes(name)));
      if (std::holds_alternative<sim::Figure::OfRun>(found->member)) {
        s.columns.push_back({name, found, 0});
        continue;
      }
      for (std::size_t i = 0; i < s.axes.size(); ++i)
        s.columns.push_back({name + '.' + s.machine.axes[s.axes[i]].first, found, i});
    }
  }

  void count(Study& s) const {
    if (s.file.sampling == sim::Sampling::kGrid) {
      s.samples = 1;
      for (const BoundFactor& f : s.factors) {
        const std::uint64_t n = sim::number_of_values(f.distribution);
        if (n > kMostRuns / s.samples) {
          refuse("factors", fmt::format("the grid has too many runs, expected at most {} (take fewer points, "
                                        "or another sampling)",
                                        kMostRuns));
        }
        s.samples *= n;
      }
    } else {
      s.samples = s.file.samples;
    }
    if (s.samples > kMostRuns / s.runs_per_sample()) {
      refuse("samples",
             fmt::format("{} samples with {} runs each are more than {} runs, expected at most that",
                         s.samples, s.runs_per_sample(), kMostRuns));
    }
    s.runs = s.samples * s.runs_per_sample();
  }

  std::string file_;
  io::Node root_;
};

}  // namespace

Study read_study(const std::string& file) { return Reader(file)(); }

double StudyColumn::of(const sim::Metrics& metrics) const {
  if (const auto* run = std::get_if<sim::Figure::OfRun>(&figure->member))
    return metrics.*(*run) * figure->key_scale;
  return (metrics.*std::get<sim::Figure::OfAxis>(figure->member))[axis] * figure->key_scale;
}

sim::Design Study::design() const {
  const sim::Sampling sampling =
      file.sampling == sim::Sampling::kGrid ? sim::Sampling::kRandom : file.sampling;
  return {sampling, samples, (file.indices ? 2 : 1) * factors.size(), file.seed};
}

std::vector<double> Study::values(const sim::Design& design, std::uint64_t run) const {
  const std::size_t k = factors.size();
  std::vector<double> all(k);
  if (file.sampling == sim::Sampling::kGrid) {
    for (std::size_t i = k; i-- > 0;) {
      const std::uint64_t n = sim::number_of_values(factors[i].distribution);
      all[i] = sim::value_number(factors[i].distribution, run % n);
      run /= n;
    }
    return all;
  }
  const std::uint64_t sample = run / runs_per_sample();
  const std::uint64_t matrix = run % runs_per_sample();  // A, B, AB_1, …
  for (std::size_t i = 0; i < k; ++i) {
    const bool of_b = matrix == 1 || matrix == i + 2;
    all[i] = sim::value_at(factors[i].distribution, design.share(sample, of_b ? k + i : i));
  }
  return all;
}

void check_machines(const Study& s, const sim::Design& design, std::uint64_t from, unsigned threads) {
  sim::in_order(
      from, s.runs, threads,
      [&](std::uint64_t run) {
        return why_impossible(with_values(s.machine, s.factors, s.values(design, run)), s.axes);
      },
      [&](std::uint64_t run, const std::string& wrong) {
        if (wrong.empty()) return;
        std::vector<std::string> drawn;
        const std::vector<double> values = s.values(design, run);
        for (std::size_t i = 0; i < values.size(); ++i)
          drawn.push_back(fmt::format("{} = {}", s.factors[i].head(),
                                      report::significant(s.factors[i].shown(values[i]), 4)));
        throw io::InputError(io::Problem{
            s.source, 0, "factors",
            fmt::format("run {} ({}) makes a machine that cannot be: {} (narrow the distributions)", run,
                        report::joined(drawn, ", "), wrong)});
      });
}

}  // namespace stribeck::workflow
