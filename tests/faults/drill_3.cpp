#include "drill_run.hpp"

template stribeck::test::Drilled stribeck::test::run_axes<3>(const Drill&);
