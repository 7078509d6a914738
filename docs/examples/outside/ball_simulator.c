#include "ball_simulator.h"

#include <math.h>

int ball_simulate(double release_height, double release_time, double restitution, double gravity, int count,
                  const double* time, double* height) {
  double begin = release_time; /* of the present flight */
  double from = release_height;
  double speed = 0;
  double landing = release_time + sqrt(2 * release_height / gravity);
  int i;
  if (!(restitution >= 0 && restitution <= 1) || !(release_height > 0)) return 1;
  for (i = 0; i < count; ++i) {
    double since;
    while (time[i] > landing && landing - begin > 1e-6) {
      speed = restitution * (from > 0 ? sqrt(2 * gravity * from) : speed);
      from = 0;
      begin = landing;
      landing = begin + 2 * speed / gravity;
    }
    since = time[i] > begin ? time[i] - begin : 0;
    height[i] = time[i] > landing ? 0 : from + speed * since - 0.5 * gravity * since * since;
  }
  return 0;
}
