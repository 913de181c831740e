#include <apps/cli/commands.hpp>

int main(int argc, char** argv) { return stribeck::cli::run(argc, argv); }
