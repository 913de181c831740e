#include <algorithm>
#include <string_view>
#include <utility>

#include <stribeck/sim/parallel.hpp>
#include <stribeck/workflow/reproduce/identification.hpp>
#include <stribeck/workflow/reproduce/sections.hpp>

namespace stribeck::workflow {
namespace {

using namespace reproduction;

bool has(const std::vector<std::string>& ids, std::string_view id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

}  // namespace

std::vector<ReproducedSection> reproduce_identification(const std::vector<std::string>& ids,
                                                        const sim::Machine& v2, const sim::Machine& v3,
                                                        std::uint64_t seed, unsigned threads) {
  std::vector<Study> table;
  std::vector<Study> tool;
  for (const sim::Machine* machine : {&v2, &v3}) {
    for (std::size_t i = 0; i < machine->axes.size(); ++i) {
      Study s;
      s.machine = machine;
      s.axis = i;
      s.biaxial = machine == &v2;
      s.seed = seed;
      s.wanted.a = s.biaxial && has(ids, "ident-A");
      s.wanted.b = has(ids, "ident-B");
      s.wanted.c = s.biaxial && has(ids, "ident-C");
      s.wanted.d = !s.biaxial && has(ids, "ident-D");
      s.wanted.verify = has(ids, "verify") && s.name() == (s.biaxial ? "x" : "y");
      (s.biaxial ? table : tool).push_back(std::move(s));
    }
  }
  // The machine tool first, because its axes take longest.
  std::vector<Study*> jobs;
  for (auto* studies : {&tool, &table}) {
    for (Study& s : *studies) jobs.push_back(&s);
  }
  sim::parallel_for(
      jobs.size(), threads, [] { return 0; }, [&](int&, std::size_t i) { run_study(*jobs[i]); });

  std::vector<ReproducedSection> sections;
  for (const std::string& id : ids) {
    if (id == "ident-A") sections.push_back(section_a(table));
    if (id == "ident-B") {
      sections.push_back(section_b_table(table));
      sections.push_back(section_b_tool(tool));
    }
    if (id == "ident-C") sections.push_back(section_c(table));
    if (id == "ident-D") sections.push_back(section_d(tool));
    if (id != "verify") continue;
    for (auto* studies : {&table, &tool}) {
      for (const Study& s : *studies) {
        if (s.wanted.verify) sections.push_back(section_verify(s));
      }
    }
  }
  return sections;
}

}  // namespace stribeck::workflow
