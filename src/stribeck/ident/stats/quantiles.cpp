#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <stribeck/ident/stats/quantiles.hpp>

namespace stribeck::ident::stats {

double student_factor(double freedom) {
  return boost::math::quantile(boost::math::students_t(freedom), 0.975);
}

double chi_squared_above(double sum, double freedom) {
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(freedom), sum));
}

double fisher_above(double ratio, double freedom_above, double freedom_below) {
  return boost::math::cdf(
      boost::math::complement(boost::math::fisher_f(freedom_above, freedom_below), ratio));
}

}  // namespace stribeck::ident::stats
