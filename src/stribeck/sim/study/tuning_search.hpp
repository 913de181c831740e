#pragma once
/// The search of tuning.hpp for the gains of one controller: a start that keeps the limits, other shapes of the gains, then
/// COBYLA by NLopt, and a confirmation under other noise.
///
/// Inside sim/study only: includes NLopt.
/// Real time: no.

#include <nlopt.h>

#include <functional>
#include <memory>
#include <optional>
#include <stribeck/sim/study/tuning_task.hpp>
#include <utility>

namespace stribeck::sim::tuning {

/// Smallest and largest factor for a gain, and its logarithm.
inline constexpr double kFactor = 20.0;
inline constexpr double kRange = 2.995732273553991;

inline double permitted(const Quantity& q, double value) {
  if (q.permits(value)) return value;
  return value > q.max ? q.max : std::nextafter(q.min, std::numeric_limits<double>::infinity());
}

template <std::size_t N>
class Search {
 public:
  Search(Task<N>& task, const ControllerSpec& start, const Trials& search, const Trials& check,
         int evaluations, const std::function<void()>& counted)
      : task_(task), start_(start), search_(search), check_(check), left_(evaluations), counted_(counted) {}

  /// Fills gains, tuned, miss, margins, evaluations and tries of `out`.
  void run(TunedController& out) {
    const int all = left_;
    search(out);
    out.evaluations = all - left_;
    out.tries = tries_;
  }

 private:
  /// COBYLA ends within its region of a limit, on either side; it therefore gets slightly tighter limits.
  static constexpr double kInside = 0.003;
  static constexpr double kShare = 0.35;                 ///< share of the evaluations for the shapes
  static constexpr double kSpread = 0.6931471805599453;  ///< spread of the shapes: half to double
  static constexpr double kSlack = 0.6;  ///< speeds down to this share are also tried, for the other limits
  static constexpr double kFaster =
      1.3862943611198906;  ///< a shape is made up to four times faster or slower
  static constexpr double kSlower = 0.94;
  static constexpr int kSlowest = 50;                       // 0.94^50 is 1/22
  static constexpr double kSlowShape = 1.4978661367769954;  ///< ln √20: proportional gains by 20
  static constexpr unsigned kShapes = 128;                  ///< looked at for their margins alone
  static constexpr std::size_t kFewShapes = 6;              ///< of them simulated
  static constexpr double kWide = 1.3862943611198906;  ///< spread of these shapes: a quarter to four times
  static constexpr double kNear =
      0.4054651081081644;  ///< spread of those about the nearest miss: 2/3 to 1.5 times

  void search(TunedController& out) {
    best_spec_ = start_;
    if (!find_begin()) {
      out.miss = task_.broken(nearest_, search_);
      return;
    }
    find_live();
    const Point begin = best_;
    const ControllerSpec begin_spec = best_spec_;
    explore();
    // A part of the runs begins at the given gains, the others at the best ones found so far.
    minimise(begin_spec, begin, 0.3, left_ - left_ / 3);
    for (double region = 0.3; region > 0.02;) {
      const double before = best_.objective;
      if (!minimise(ControllerSpec(best_spec_), Point(best_), region, 0)) break;
      if (!(best_.objective < 0.999 * before)) region *= 0.5;
    }
    if (best_.worst() > 0.0) {
      out.miss = task_.broken(nearest_, search_);
      return;
    }
    confirm();
    if (best_.worst() > 0.0 || !std::isfinite(best_.objective)) {
      out.miss = task_.broken(best_, check_);
      out.miss->other_noise = true;
      return;
    }
    auto old = gains_of(start_, N);
    auto found = gains_of(best_spec_, N);
    for (const std::size_t i : live_)
      out.gains.push_back({old[i].name, old[i].quantity, *old[i].value, *found[i].value});
    // Settings without effect keep their values.
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (std::find(live_.begin(), live_.end(), i) == live_.end()) *found[i].value = *old[i].value;
    }
    out.tuned = best_spec_;
    out.tuned_margins = best_.margins;
  }

  /// The start, slowed until it keeps the limits. If that fails, as slow as the margins need; if that fails, another shape.
  bool find_begin() {
    for (int k = 0; k <= kSlowest; ++k) {
      const ControllerSpec c = slowed(start_, N, std::pow(kSlower, k));
      const Point looked = look_at_margins(c);
      if (!task_.keeps_margins(looked)) continue;
      if (begin_at(c)) break;
    }
    if (!found_) {
      // No speed has the margins: the ratio of the gains must change.
      for (const ControllerSpec& c : shapes_with_margins()) {
        begin_at(c);
        --left_;
        counted_();
      }
    }
    return found_ && std::isfinite(best_.objective);
  }

  /// Simulates a point whose margins are known and were counted as a try. Of several points the nearest to the limits is kept, of those that keep the limits the best. Returns whether this point keeps them.
  bool begin_at(const ControllerSpec& c) {
    if (!found_) task_.choose_substeps(c);
    const Point p = task_.evaluate(c, search_);
    const bool keeps = p.worst() <= 0.0 && std::isfinite(p.objective);
    if (keeps) kept_.emplace_back(p.objective, c);
    const bool kept = found_ && best_.worst() <= 0.0 && std::isfinite(best_.objective);
    if (!found_ || (kept ? keeps && p.objective < best_.objective : p.worst() < best_.worst())) {
      best_ = p;
      best_spec_ = c;
    }
    if (!found_ || p.far < nearest_.far) nearest_ = p;
    found_ = true;
    return keeps;
  }

  /// Computes margins only and keeps the nearest miss. A law that has no margins with these gains counts as unstable.
  Point look_at_margins(const ControllerSpec& c) {
    ++tries_;
    Point p;
    p.far = std::numeric_limits<double>::infinity();
    try {
      p = task_.only_margins(task_.margins(c));
    } catch (const Refused&) {
    }
    if (!found_ && (tries_ == 1 || (p.far < nearest_.far && (p.stable || !nearest_.stable)))) {
      nearest_ = p;
      nearest_spec_ = c;
    }
    return p;
  }

  /// Shapes that have the margins at some speed, each at its fastest: three quarters are spread widely about the start, a quarter
  /// about the nearest miss.
  std::vector<ControllerSpec> shapes_with_margins() {
    std::vector<ControllerSpec> all;
    const std::vector<std::size_t> gains = gains_of_margins();
    for (unsigned k = 1; k <= kShapes && all.size() < kFewShapes; ++k) {
      const bool near = k > kShapes - kShapes / 4;
      const ControllerSpec shape =
          near ? spread(nearest_spec_, gains, k, kNear) : spread(start_, gains, k, kWide);
      double low = -kSlowShape;
      bool keeps = false;
      for (int look = 0; look < 2 && !keeps; ++look) {
        if (look > 0) low *= 0.5;
        keeps = task_.keeps_margins(look_at_margins(ranged(slowed(shape, N, std::exp(low)))));
      }
      if (!keeps) continue;
      double high = kFaster;
      for (int b = 0; b < 8; ++b) {
        const double middle = 0.5 * (low + high);
        (task_.keeps_margins(look_at_margins(ranged(slowed(shape, N, std::exp(middle))))) ? low : high) =
            middle;
      }
      all.push_back(ranged(slowed(shape, N, std::exp(low))));
    }
    return all;
  }

  /// Clips gains to the range of the search; a loop without gain would have every margin.
  [[nodiscard]] ControllerSpec ranged(const ControllerSpec& controller) const {
    ControllerSpec c = controller;
    ControllerSpec origin = start_;
    const auto gains = gains_of(c, N);
    const auto own = gains_of(origin, N);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      *gains[i].value = permitted(
          gains[i].quantity, std::clamp(*gains[i].value, *own[i].value / kFactor, *own[i].value * kFactor));
    }
    return c;
  }

  /// Gains that change the margins when they change by a tenth.
  std::vector<std::size_t> gains_of_margins() {
    std::vector<std::size_t> all;
    const LoopMargins own = task_.margins(start_);
    const auto count = gains_of(start_, N).size();
    for (std::size_t i = 0; i < count; ++i) {
      bool moves = false;
      for (const double factor : {0.9, 1.1}) {
        ControllerSpec c = start_;
        Gain g = gains_of(c, N)[i];
        *g.value = permitted(g.quantity, factor * *g.value);
        try {
          moves = moves || !(task_.margins(c) == own);
        } catch (const Refused&) {
          moves = true;
        }
      }
      if (moves) all.push_back(i);
    }
    return all;
  }

  /// Shape k of a sequence spread evenly about `origin`, with each of these gains within a factor of exp(width).
  static ControllerSpec spread(const ControllerSpec& origin, const std::vector<std::size_t>& which,
                               unsigned k, double width) {
    ControllerSpec shape = origin;
    auto gains = gains_of(shape, N);
    for (std::size_t i = 0; i < which.size(); ++i) {
      Gain& g = gains[which[i]];
      const double even = k == 0 ? 0.0 : 2.0 * halton(k, i) - 1.0;
      *g.value = permitted(g.quantity, *g.value * std::exp(width * even));
    }
    return shape;
  }

  /// The best of the first few points that also keep the limits under other noise.
  void confirm() {
    constexpr int kFew = 6;
    std::stable_sort(kept_.begin(), kept_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    int confirmed = 0;
    bool first = true;
    for (const auto& [objective, c] : kept_) {
      const Point p = task_.evaluate(c, check_);
      const bool keeps = p.worst() <= 0.0 && std::isfinite(p.objective);
      const bool nearer = first || p.far < best_.far;
      first = false;
      if (keeps ? confirmed == 0 || p.objective < best_.objective : confirmed == 0 && nearer) {
        best_ = p;
        best_spec_ = c;
      }
      if (keeps && ++confirmed == kFew) break;
    }
  }

  /// Gains that change any result when they change by a tenth.
  void find_live() {
    auto gains = gains_of(best_spec_, N);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      ControllerSpec c = best_spec_;
      auto changed = gains_of(c, N);
      *changed[i].value = permitted(changed[i].quantity, 0.9 * *changed[i].value);
      if (*changed[i].value == *gains[i].value)
        *changed[i].value = permitted(changed[i].quantity, 1.1 * *gains[i].value);
      Point p;
      task_.run(c, search_, p);
      ++tries_;
      if (p.objective != best_.objective || p.variation != best_.variation) live_.push_back(i);
    }
  }

  /// Shapes of gains, spread evenly, each as fast as its margins permit or somewhat slower; the first is the shape of the start.
  void explore() {
    const ControllerSpec origin = best_spec_;
    const int end = left_ - static_cast<int>(kShare * left_);
    for (unsigned k = 0; left_ > end; ++k) {
      const ControllerSpec shape = spread(origin, live_, k, kSpread);
      double low = -kFaster;
      double high = kFaster;
      if (!task_.keeps_margins(look_at_margins(slowed(shape, N, std::exp(low))))) {
        // No speed of this shape has the margins. It still costs an evaluation, so that the number of shapes is bounded.
        --left_;
        counted_();
        continue;
      }
      for (int b = 0; b < 8; ++b) {
        const double middle = 0.5 * (low + high);
        (task_.keeps_margins(look_at_margins(slowed(shape, N, std::exp(middle)))) ? low : high) = middle;
      }
      // The shape of the start has been tried already.
      if (k > 0)
        low += std::log(kSlack) * halton(k, live_.size());
      else
        --tries_;
      judge(slowed(shape, N, std::exp(low)));
    }
  }

  /// Point k of Halton's sequence in dimension i, in (0, 1).
  static double halton(unsigned k, std::size_t i) {
    constexpr std::array kPrimes{2U, 3U, 5U, 7U, 11U, 13U, 17U, 19U, 23U, 29U, 31U, 37U, 41U, 43U, 47U, 53U};
    const unsigned base = kPrimes[i % kPrimes.size()];
    double value = 0.0;
    double digit = 1.0;
    for (; k > 0; k /= base) {
      digit /= base;
      value += digit * (k % base);
    }
    return value;
  }

  /// Simulates a point, counts it, and keeps it if it is the best.
  Point judge(const ControllerSpec& c) {
    const Point p = task_.evaluate(c, search_);
    ++tries_;
    --left_;
    counted_();
    const bool keeps = p.worst() <= 0.0;
    const bool kept = best_.worst() <= 0.0;
    if (std::isfinite(p.objective) && keeps) kept_.emplace_back(p.objective, c);
    if (task_.keeps_margins(p) && p.far < nearest_.far) nearest_ = p;
    if (std::isfinite(p.objective) && ((keeps && (!kept || p.objective < best_.objective)) ||
                                       (!keeps && !kept && p.worst() < best_.worst()))) {
      best_ = p;
      best_spec_ = c;
    }
    return p;
  }

  [[nodiscard]] ControllerSpec at(const double* x) {
    ControllerSpec c = centre_;
    auto gains = gains_of(c, N);
    auto origin = gains_of(start_, N);
    for (std::size_t k = 0; k < live_.size(); ++k) {
      Gain& g = gains[live_[k]];
      const double first = *origin[live_[k]].value;
      *g.value =
          permitted(g.quantity, std::clamp(*g.value * std::exp(x[k]), std::min(first / kFactor, *g.value),
                                           std::max(first * kFactor, *g.value)));
    }
    return c;
  }

  const Point& look(unsigned n, const double* x) {
    if (last_x_.size() == n && std::equal(x, x + n, last_x_.begin())) return last_;
    last_x_.assign(x, x + n);
    last_ = judge(at(x));
    if (left_ <= stop_) nlopt_force_stop(running_);
    return last_;
  }

  static double objective(unsigned n, const double* x, double*, void* data) {
    auto& s = *static_cast<Search*>(data);
    const double j = s.look(n, x).objective;
    // A point that was not simulated, or lost the path, counts as much worse than the start; the limits give its distance.
    return std::min(j / s.scale_, 5.0);
  }
  static void excess(unsigned m, double* result, unsigned n, const double* x, double*, void* data) {
    const Point& p = static_cast<Search*>(data)->look(n, x);
    for (unsigned i = 0; i < m; ++i) result[i] = p.excess[i] + kInside;
  }

  /// Runs COBYLA from a point until this number of evaluations is left; false where there are too few for it.
  bool minimise(const ControllerSpec& centre, const Point& there, double region, int stop) {
    const auto count = static_cast<unsigned>(live_.size());
    stop_ = stop;
    if (count == 0 || left_ - stop <= static_cast<int>(count) + 1) return false;
    centre_ = centre;
    const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> search(nlopt_create(NLOPT_LN_COBYLA, count),
                                                                        &nlopt_destroy);
    running_ = search.get();
    scale_ = there.objective;
    last_x_.clear();
    const auto limits = static_cast<unsigned>(best_.excess.size());
    const std::vector<double> tolerance(limits, 0.0);
    nlopt_set_min_objective(running_, objective, this);
    nlopt_add_inequality_mconstraint(running_, limits, excess, this, tolerance.data());
    nlopt_set_lower_bounds1(running_, -2.0 * kRange);
    nlopt_set_upper_bounds1(running_, 2.0 * kRange);
    nlopt_set_initial_step1(running_, region);
    nlopt_set_xtol_abs1(running_, 0.05 * region);
    nlopt_set_maxeval(running_, left_ - stop);
    std::vector<double> x(count, 0.0);
    double value = 0.0;
    nlopt_optimize(running_, x.data(), &value);  // the best point is kept in judge()
    return true;
  }

  Task<N>& task_;
  ControllerSpec start_;
  const Trials& search_;
  const Trials& check_;
  int left_;
  const std::function<void()>& counted_;
  std::vector<std::size_t> live_;
  ControllerSpec centre_;
  ControllerSpec best_spec_;
  Point best_;
  Point nearest_;  ///< nearest to the limits: of the points with the margins, else of all points
  ControllerSpec nearest_spec_;  ///< nearest to the margins
  int tries_ = 0;                ///< number of gains tried
  bool found_ = false;           ///< some gains have the margins
  std::vector<std::pair<double, ControllerSpec>>
      kept_;  ///< J of the points that keep all limits, with their gains
  std::vector<double> last_x_;
  Point last_;
  double scale_ = 1.0;
  int stop_ = 0;
  nlopt_opt running_ = nullptr;
};

}  // namespace stribeck::sim::tuning
