#include <nlopt.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/simplex.hpp>

namespace stribeck::ident::stats {
namespace {

struct Problem {
  const std::function<double(const std::vector<double>&)>& f;
  std::vector<double> x;
  int evaluations = 0;
};

double evaluate(unsigned n, const double* x, double*, void* data) {
  auto& p = *static_cast<Problem*>(data);
  p.x.assign(x, x + n);
  ++p.evaluations;
  const double value = p.f(p.x);
  return std::isfinite(value) ? value : std::numeric_limits<double>::max();
}

}  // namespace

SimplexResult minimise_simplex(const std::function<double(const std::vector<double>&)>& f,
                               std::vector<double> start, std::vector<double> step,
                               const SimplexOptions& options) {
  if (start.empty() || step.size() != start.size() || !std::isfinite(f(start))) {
    throw Refused("simplex: expected a start where the function is finite, and one step for each coordinate");
  }
  Problem problem{f, {}, 0};
  const auto n = static_cast<unsigned>(start.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> search(nlopt_create(NLOPT_LN_NELDERMEAD, n),
                                                                      &nlopt_destroy);
  nlopt_set_min_objective(search.get(), evaluate, &problem);
  nlopt_set_initial_step(search.get(), step.data());
  nlopt_set_xtol_rel(search.get(), options.tolerance);
  nlopt_set_ftol_rel(search.get(), options.tolerance);
  nlopt_set_maxeval(search.get(), options.evaluations);
  SimplexResult out;
  out.x = std::move(start);
  const nlopt_result code = nlopt_optimize(search.get(), out.x.data(), &out.value);
  out.evaluations = problem.evaluations;
  out.converged = code == NLOPT_SUCCESS || code == NLOPT_FTOL_REACHED || code == NLOPT_XTOL_REACHED;
  return out;
}

}  // namespace stribeck::ident::stats
