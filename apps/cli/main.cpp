#include <apps/cli/commands.hpp>
#ifdef __GLIBC__
#include <malloc.h>
#endif

int main(int argc, char** argv) {
#ifdef __GLIBC__
  // Columns of a million rows are taken and given back again and again. Kept in the process, their pages need not be mapped and
  // cleared each time.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
  return stribeck::cli::run(argc, argv);
}
