/* Preloaded into a program: shifts its civil clock by the seconds that the file named by
 * CIVIL_SHIFT_FILE holds (8 bytes, native), now and whenever they change. The monotonic clock and
 * what waits stay true, and the kernel does not call its clock synchronised. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/timex.h>
#include <time.h>
#include <unistd.h>

/* A time that is later than this since its clock's zero is a civil one. */
#define CIVIL_SECONDS 1000000000

static int64_t none;
static volatile int64_t* shift_seconds = &none;

__attribute__((constructor)) static void begin(void) {
  const char* name = getenv("CIVIL_SHIFT_FILE");
  const int file = name == NULL ? -1 : open(name, O_RDONLY | O_CLOEXEC);
  if (file < 0) abort();
  void* mapped = mmap(NULL, sizeof(int64_t), PROT_READ, MAP_SHARED, file, 0);
  if (mapped == MAP_FAILED) abort();
  close(file);
  shift_seconds = mapped;
}

static void* next(const char* name) { return dlsym(RTLD_NEXT, name); }

int clock_gettime(clockid_t clock, struct timespec* time) {
  static int (*real)(clockid_t, struct timespec*);
  if (real == NULL) real = next("clock_gettime");
  const int code = real(clock, time);
  if (code == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) {
    time->tv_sec += *shift_seconds;
  }
  return code;
}

int gettimeofday(struct timeval* restrict time, void* restrict zone) {
  static int (*real)(struct timeval*, void*);
  if (real == NULL) real = next("gettimeofday");
  const int code = real(time, zone);
  if (code == 0) time->tv_sec += *shift_seconds;
  return code;
}

time_t time(time_t* out) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (out != NULL) *out = now.tv_sec;
  return now.tv_sec;
}

/* The time that the kernel must get for one that was made from the shifted clock. */
static struct timespec unshifted(const struct timespec* until) {
  struct timespec real = *until;
  if (real.tv_sec > CIVIL_SECONDS) real.tv_sec -= *shift_seconds;
  return real;
}

int pthread_cond_timedwait(pthread_cond_t* restrict condition, pthread_mutex_t* restrict mutex,
                           const struct timespec* restrict until) {
  static int (*real)(pthread_cond_t*, pthread_mutex_t*, const struct timespec*);
  if (real == NULL) real = next("pthread_cond_timedwait");
  const struct timespec then = unshifted(until);
  return real(condition, mutex, &then);
}

long syscall(long number, ...) {
  static long (*real)(long, ...);
  if (real == NULL) real = next("syscall");
  va_list list;
  va_start(list, number);
  long of[6];
  for (int i = 0; i < 6; ++i) of[i] = va_arg(list, long);
  va_end(list);
  /* gRPC's library asks for the time in this way. */
  if (number == SYS_clock_gettime) return clock_gettime((clockid_t)of[0], (struct timespec*)of[1]);
  if (number == SYS_adjtimex) {
    struct timex* state = (struct timex*)of[0];
    state->status = STA_UNSYNC;
    return TIME_ERROR;
  }
  struct timespec then;
  if (number == SYS_futex && (of[1] & FUTEX_CLOCK_REALTIME) != 0 && of[3] != 0) {
    then = unshifted((const struct timespec*)of[3]);
    of[3] = (long)&then;
  }
  return real(number, of[0], of[1], of[2], of[3], of[4], of[5]);
}
