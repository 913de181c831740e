/* Stands between the program and the kernel (LD_PRELOAD) and counts the calls that change files.
 *
 *   STRIBECK_TEST_KILL=N     the process is killed (SIGKILL) in place of the N-th call
 *   STRIBECK_TEST_FULL=N     from the N-th call on, nothing more can be written (ENOSPC)
 *   STRIBECK_TEST_PIECE=N    of more than N bytes, one call writes half; otherwise of more than 4096
 *   STRIBECK_TEST_NAMED=1    the file system knows no files without a name
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static long calls;

static long limit_of(const char* name) {
  const char* text = getenv(name);
  return text == NULL ? 0 : atol(text);
}

/* Whether the disk is full. */
static int count(void) {
  ++calls;
  if (calls == limit_of("STRIBECK_TEST_KILL")) kill(getpid(), SIGKILL);
  const long full = limit_of("STRIBECK_TEST_FULL");
  return full > 0 && calls >= full;
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int fd, const void* bytes, size_t n) {
  struct stat info;
  const int error = errno;
  if (fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && fd > 2 && count()) {
    errno = ENOSPC;
    return -1;
  }
  errno = error;
  /* In pieces, so that there is something between them. */
  const long piece = limit_of("STRIBECK_TEST_PIECE");
  return NEXT(write)(fd, bytes, n > (size_t)(piece > 0 ? piece : 4096) && fd > 2 ? n / 2 : n);
}

int fsync(int fd) {
  if (count()) {
    errno = ENOSPC;
    return -1;
  }
  return NEXT(fsync)(fd);
}

int rename(const char* from, const char* to) {
  count();
  return NEXT(rename)(from, to);
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
  count();
  return NEXT(linkat)(from_folder, from, to_folder, to, flags);
}

int mkdir(const char* path, mode_t mode) {
  count();
  return NEXT(mkdir)(path, mode);
}

int fchmod(int fd, mode_t mode) {
  count();
  return NEXT(fchmod)(fd, mode);
}

int open(const char* path, int flags, ...) {
  mode_t mode = 0;
  if ((flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE) {
    va_list rest;
    va_start(rest, flags);
    mode = va_arg(rest, mode_t);
    va_end(rest);
    count();
  }
  if ((flags & O_TMPFILE) == O_TMPFILE && limit_of("STRIBECK_TEST_NAMED") != 0) {
    errno = EOPNOTSUPP;
    return -1;
  }
  return NEXT(open)(path, flags, mode);
}

int open64(const char* path, int flags, ...) __attribute__((alias("open")));
