/* What keeps mbk from glibc 2.34, that of Ubuntu 22.04 and of Enterprise Linux 9, are two symbols. The linker leads
 * their calls here (--wrap, target mbk_wrapped), also those in static libraries.
 *
 * hypot has a new version since 2.35, which does not set errno. Its first version computes the same to the last bit.
 * arc4random is of 2.36. Only libstdc++ calls it, where it is linked statically: for std::random_device. */
#include <stdint.h>
#include <stdlib.h>
#include <sys/random.h>

double hypot_of_first_version(double x, double y);
double __wrap_hypot(double x, double y);
uint32_t __wrap_arc4random(void);

#if defined(__x86_64__)
__asm__(".symver hypot_of_first_version, hypot@GLIBC_2.2.5");
#elif defined(__aarch64__)
__asm__(".symver hypot_of_first_version, hypot@GLIBC_2.17");
#endif

double __wrap_hypot(double x, double y) {
  return hypot_of_first_version(x, y);
}

uint32_t __wrap_arc4random(void) {
  uint32_t bits;
  if (getrandom(&bits, sizeof bits, 0) != sizeof bits)
    abort(); /* of so few bytes all come, on every Linux since 3.17 */
  return bits;
}
