#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <stribeck/core/numbers.hpp>
#include <stribeck/io/netcdf.hpp>
#include <stribeck/workflow/study/results_file.hpp>
#include <stribeck/workflow/study/study.hpp>

namespace stribeck::workflow {
namespace {

using io::NetcdfFile;

/// Runs that are written at once.
constexpr std::size_t kBlock = 512;

/// A name for programs in which variables are identifiers: "x.mass" → x_mass, "*.mass" → all_mass.
std::string identifier(const std::string& key, std::vector<std::string>& taken) {
  std::string name = key.starts_with('*') ? "all" + key.substr(1) : key;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  std::string one = name;
  for (int i = 2; std::find(taken.begin(), taken.end(), one) != taken.end(); ++i)
    one = fmt::format("{}_{}", name, i);
  taken.push_back(one);
  return one;
}

/// "max_contour_error_um" → "um".
std::string unit_of(const sim::Figure& figure) {
  const std::string key(figure.key);
  return figure.unit.empty() ? "1" : key.substr(key.rfind('_') + 1);
}

double number_of(std::string_view cell) {
  double x = kNaN;
  std::from_chars(cell.data(), cell.data() + cell.size(), x);
  return x;
}

class Table {
 public:
  Table(const Study& s, const std::string& path, const std::string& version)
      : s_(s), file_(path), cases_(s.spec.travels.size() * s.spec.controllers.size()) {
    const int run = file_.dimension("run", s.runs);
    const int each = file_.dimension("case", cases_);
    std::vector<std::string> taken{"run",        "case",   "sample",          "state",
                                   "controller", "motion", "at_limit_percent"};
    const auto number = [&](const std::string& name, const std::vector<int>& over, const std::string& units,
                            const std::string& words) {
      const int id = file_.variable(name, NetcdfFile::Type::kNumber, over);
      file_.describe(id, "units", units);
      file_.describe(id, "long_name", words);
      of_.push_back(id);
    };
    sample_ = file_.variable("sample", NetcdfFile::Type::kNumber, {run});
    file_.describe(sample_, "long_name", "number of the draw");
    for (const BoundFactor& f : s.factors)
      number(identifier(f.key, taken), {run}, f.unit.empty() ? "1" : f.unit, f.head());
    number("at_limit_percent", {run, each}, "percent",
           "share of the control periods at the limit of a drive");
    for (const StudyColumn& c : s.columns) {
      const bool per_axis = std::holds_alternative<sim::Figure::OfAxis>(c.figure->member);
      number(identifier(c.key, taken), {run, each}, unit_of(*c.figure),
             per_axis ? fmt::format("{}, axis {}", c.figure->key, s.machine.axes[s.axes[c.axis]].first)
                      : std::string(c.figure->key));
    }
    state_ = file_.variable("state", NetcdfFile::Type::kFlag, {run, each});
    file_.describe_flag(state_, {0, 1, 2}, "ok lost refused");
    const int controller = file_.variable("controller", NetcdfFile::Type::kText, {each});
    const int motion = file_.variable("motion", NetcdfFile::Type::kText, {each});
    file_.describe("title", "Study of the machine " + s.machine.name);
    file_.describe("source", "stribeck " + version);
    file_.describe("sampling", std::string(enum_name(s.file.sampling)));
    file_.begin();
    for (std::size_t i = 0; i < cases_; ++i) {
      file_.write(controller, {i}, s.spec.controllers[i % s.spec.controllers.size()].id);
      file_.write(motion, {i}, s.spec.travels[i / s.spec.controllers.size()].pace_in_words());
    }
    blocks_.resize(of_.size());
  }

  void add(const std::vector<std::string_view>& cells) {
    const std::size_t k = s_.factors.size();
    if (in_case_ == 0) {
      samples_.push_back(number_of(cells[1]));
      for (std::size_t i = 0; i < k; ++i) blocks_[i].push_back(number_of(cells[2 + i]));
    }
    const std::string_view state = cells[2 + k + 2];
    states_.push_back(static_cast<signed char>(state == kRunDone ? 0 : state == kRunLost ? 1 : 2));
    for (std::size_t i = k; i < of_.size(); ++i) blocks_[i].push_back(number_of(cells[5 + i]));
    in_case_ = (in_case_ + 1) % cases_;
    if (in_case_ == 0 && samples_.size() == kBlock) flush();
  }

  void finish() {
    flush();
    file_.finish();
  }

 private:
  void flush() {
    const std::size_t n = samples_.size();
    if (n == 0) return;
    file_.write(sample_, {done_}, {n}, samples_);
    for (std::size_t i = 0; i < of_.size(); ++i) {
      if (i < s_.factors.size()) {
        file_.write(of_[i], {done_}, {n}, blocks_[i]);
      } else {
        file_.write(of_[i], {done_, 0}, {n, cases_}, blocks_[i]);
      }
      blocks_[i].clear();
    }
    file_.write(state_, {done_, 0}, {n, cases_}, states_);
    samples_.clear();
    states_.clear();
    done_ += n;
  }

  const Study& s_;
  NetcdfFile file_;
  std::size_t cases_;
  int sample_ = 0;
  int state_ = 0;
  std::vector<int> of_;  ///< factors, share at the limit, figures
  std::vector<double> samples_;
  std::vector<std::vector<double>> blocks_;
  std::vector<signed char> states_;
  std::size_t in_case_ = 0;
  std::size_t done_ = 0;
};

}  // namespace

void write_netcdf(const Study& study, const std::string& folder, const std::string& path,
                  const std::string& version) {
  Table table(study, path, version);
  for_each_row(folder + "/results.csv",
               [&](std::uint64_t, const std::vector<std::string_view>& cells) { table.add(cells); });
  table.finish();
}

}  // namespace stribeck::workflow
