#include <pybind11/pybind11.h>
#include <algorithm>
#include <nlohmann/json.hpp>

#include <python/parts.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/pages/reproduction.hpp>
#include <stribeck/sim/study/variation.hpp>
#include <stribeck/workflow/reproduce/reproduction.hpp>

namespace stribeck::python {
namespace {

Outcome reproduce(const py::args& ids, const py::kwargs& given) {
  Keywords keywords("reproduce", given);
  workflow::ReproduceOptions o;
  const std::vector<std::string> known = workflow::reproducible_ids();
  std::vector<std::string> wanted;
  for (const py::handle& id : ids) {
    std::string text = path_of(id, "ids");
    if (std::find(known.begin(), known.end(), text) == known.end())
      Keywords::refuse_choice("ids", text, known);
    wanted.push_back(std::move(text));
  }
  if (!wanted.empty()) o.ids = std::move(wanted);
  o.trials = trials_of(keywords, o.trials);
  o.seed = seed_of(keywords);
  o.threads = threads_of(keywords);
  o.machines = static_cast<std::uint32_t>(keywords.whole("machines", 1, 100000).value_or(o.machines));
  std::vector<std::string> factors = sim::variation_factors();
  factors.insert(factors.begin(), o.vary);
  if (const std::string vary = keywords.word("vary", factors); !vary.empty()) o.vary = vary;
  o.controllers = keywords.paths("controller");
  const std::string markdown = keywords.path("markdown");
  keywords.done();
  return unlocked([&] {
    const workflow::ReproductionPlan plan = workflow::plan_reproduction(o);
    io::check_distinct(o.controllers, {markdown});
    io::check_writable(markdown);
    const auto signals = interruptible();
    report::ReproductionInput page = workflow::reproduce(
        plan, [&](const char*, std::size_t done, std::size_t all) { signals(done, all); });
    page.version = STRIBECK_VERSION;
    page.command = "stribeck.reproduce()";
    if (!markdown.empty()) io::write_atomically(markdown, report::reproduction_markdown(page));
    return Outcome{report::reproduction_json(page), report::reproduction_text(page), std::nullopt, true};
  });
}

}  // namespace

void add_reproduction(py::module_& module) {
  module.def(
      "reproduce", &reproduce,
      "reproduce(*ids, trials=10, seed=1, threads=0, machines=100, vary='all', controller=None, markdown=None)\n--\n\n"
      "Repeats experiments of the thesis; its printed values stand beside the results.\n\n"
      "ids: e.g. \"smc-circle\"; none: all without robustness, minutes of work. machines, vary, controller: of \"robustness\". "
      "markdown: file for the table.\n"
      "Returns a Result. Ctrl-C ends it after the present run.\n"
      "Raises InputError for arguments.");
}

}  // namespace stribeck::python
