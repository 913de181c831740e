#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/report/pages/recommendation.hpp>
#include <stribeck/report/pages/verdict.hpp>
#include <stribeck/report/plot/contour_plots.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

using RowsOfOne = std::vector<const sim::CompareRow*>;

/// The rows of a controller at every speed; empty where one is missing or not finite.
RowsOfOne rows_of_one(const std::vector<TravelBlock>& blocks, const std::string& id) {
  RowsOfOne rows;
  for (const TravelBlock& b : blocks) {
    for (const sim::CompareRow* r : b.rows) {
      if (r->controller.id == id && r->refused.empty() && std::isfinite(r->mean.max_contour_error))
        rows.push_back(r);
    }
  }
  return rows.size() == blocks.size() ? rows : RowsOfOne();
}

/// Mean logarithm of the largest error.
double size_of(const RowsOfOne& rows) {
  double sum = 0.0;
  for (const sim::CompareRow* r : rows) sum += std::log(std::fmax(r->mean.max_contour_error, 1e-15));
  return sum / static_cast<double>(rows.size());
}

bool cannot_be_told_apart(const RowsOfOne& a, const RowsOfOne& b, double trials) {
  if (!(trials > 1.0)) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double scatter =
        std::hypot(a[i]->spread.max_contour_error, b[i]->spread.max_contour_error) / std::sqrt(trials);
    if (!(std::abs(a[i]->mean.max_contour_error - b[i]->mean.max_contour_error) <= 2.0 * scatter))
      return false;
  }
  return true;
}

std::string errors_of(const std::vector<TravelBlock>& blocks, const RowsOfOne& rows) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < rows.size(); ++i)
    parts.push_back(
        fmt::format("{}\u00A0µm at {}", micrometres(rows[i]->mean.max_contour_error), blocks[i].text));
  return listed(parts);
}

/// "; only at 54 mm/s, (k) is better: 22.0 µm" for the speeds at which another controller has the smallest error; "" where there is none.
std::string smaller_at(const std::vector<TravelBlock>& blocks, const RowsOfOne& chosen) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const sim::CompareRow* best = chosen[i];
    for (const sim::CompareRow* r : blocks[i].rows) {
      if (r->refused.empty() && r->mean.max_contour_error < best->mean.max_contour_error) best = r;
    }
    if (best != chosen[i])
      parts.push_back(fmt::format("only at {}, {} is better: {}\u00A0µm", blocks[i].text, name_of(*best),
                                  micrometres(best->mean.max_contour_error)));
  }
  return parts.empty() ? std::string() : "; " + listed(parts);
}

/// The first controller without any model or observer, else the first of all.
RowsOfOne baseline(const std::vector<TravelBlock>& blocks) {
  if (blocks.front().rows.empty()) return {};
  const sim::CompareRow* first = blocks.front().rows.front();
  for (const sim::CompareRow* r : blocks.front().rows) {
    if (r->controller.friction == sim::FrictionUse::kNone &&
        r->controller.observer == control::Observer::kNone) {
      first = r;
      break;
    }
  }
  return rows_of_one(blocks, first->controller.id);
}

/// Axes on which the adaptation of this controller found another shape of friction than it was given; "" where there is none.
std::string axes_without_model(const RowsOfOne& rows, const sim::CompareResult& result) {
  std::string axes;
  for (std::size_t i = 0; i < result.axes.size(); ++i) {
    const bool other = std::any_of(rows.begin(), rows.end(), [&](const sim::CompareRow* r) {
      return i < r->drift.size() && r->drift[i].verdict == control::DriftVerdict::kAnotherShape;
    });
    if (other) axes += (axes.empty() ? "" : ", ") + result.axes[i];
  }
  return axes;
}

}  // namespace

Recommendation recommendation(const std::vector<TravelBlock>& blocks, const sim::CompareResult& result) {
  Recommendation out;
  if (blocks.empty()) return out;
  const std::string error = error_name(result);
  RowsOfOne best;
  RowsOfOne standard;
  std::size_t compared = 0;
  for (const sim::CompareRow* r : blocks.front().rows) {
    const RowsOfOne rows = rows_of_one(blocks, r->controller.id);
    if (rows.empty()) continue;
    ++compared;
    if (best.empty() || size_of(rows) < size_of(best)) best = rows;
    if (const auto rivals = rivals_of(blocks.front().rows); rivals && rivals->is_default && rivals->ours == r)
      standard = rows;
  }
  if (best.empty()) {
    out.words = "No controller gave a finite result at every speed: see the warnings.";
    return out;
  }
  const bool as_good =
      !standard.empty() && standard != best && cannot_be_told_apart(standard, best, result.spec.trials);
  const RowsOfOne& chosen = as_good ? standard : best;
  out.rows = chosen;
  const std::string smaller = as_good ? std::string() : smaller_at(blocks, chosen);
  out.words = compared == 1
                  ? fmt::format("{} has a largest {} of {}.", full_name(*chosen.front()), error,
                                errors_of(blocks, chosen))
                  : fmt::format("Use {}: its largest {} is {}, {} of {} controllers{}.",
                                full_name(*chosen.front()), error, errors_of(blocks, chosen),
                                as_good ? "not to be told from the smallest" : "the smallest", compared,
                                smaller.empty() ? "" : " over all speeds together" + smaller);
  if (!standard.empty() && !as_good && standard != best)
    out.words +=
        fmt::format(" The default, {}, leaves {}.", name_of(*standard.front()), errors_of(blocks, standard));
  if (const std::string axes = axes_without_model(chosen, result); !axes.empty())
    out.words += fmt::format(
        " Its model of friction does not hold at these speeds on axis {}: identify there first.", axes);
  for (std::size_t i = 0; i < std::min<std::size_t>(chosen.size(), 2); ++i)
    out.numbers.push_back({fmt::format("largest {} of {}, {}", error, name_of(*chosen[i]), blocks[i].text),
                           micrometres(chosen[i]->mean.max_contour_error), "µm"});
  const RowsOfOne plain = baseline(blocks);
  if (!plain.empty() && plain != chosen) {
    out.numbers.push_back({fmt::format("of the error of {} remain{}", full_name(*plain.front()),
                                       blocks.size() > 1 ? ", geometric mean over the speeds" : ""),
                           significant(100.0 * std::exp(size_of(chosen) - size_of(plain)), 2), "%"});
  }
  return out;
}

}  // namespace stribeck::report
