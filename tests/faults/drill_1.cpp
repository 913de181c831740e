#include "drill_run.hpp"

template stribeck::test::Drilled stribeck::test::run_axes<1>(const Drill&);
