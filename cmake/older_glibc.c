/* glibc 2.35 gave hypot a new version, which does not set errno. It is the only symbol by which mbk would need more than
 * glibc 2.34, that of Ubuntu 22.04 and of Enterprise Linux 9. The linker leads calls of hypot here (--wrap, see
 * mbk_runs_on_older_glibc), also those in static libraries, and from here to the first version, which computes the same
 * to the last bit. */
double hypot_of_first_version(double x, double y);
double __wrap_hypot(double x, double y);

#if defined(__x86_64__)
__asm__(".symver hypot_of_first_version, hypot@GLIBC_2.2.5");
#elif defined(__aarch64__)
__asm__(".symver hypot_of_first_version, hypot@GLIBC_2.17");
#endif

double __wrap_hypot(double x, double y) {
  return hypot_of_first_version(x, y);
}
