/* An existing simulator: a C interface without sinew's types and without derivatives. */
#ifdef __cplusplus
extern "C" {
#endif

/* Heights [m] of a ball that falls from `release_height` [m] at `release_time` [s] and bounces, at `count`
   increasing times [s]. Returns 0, or 1 if restitution is not in 0 .. 1 or the height is not above 0. */
int ball_simulate(double release_height, double release_time, double restitution, double gravity, int count,
                  const double* time, double* height);

#ifdef __cplusplus
}
#endif
