// Settings of a thrown body.
//
//   free_body:
//     box: [0.1048, 0.1048, 0.1048]    # edges [m]
//     mass: 0.37                       # [kg]
//     inertia: [8.1e-4, 8.1e-4, 8.1e-4]  # about the box's axes [kg m2]; default: that of a solid box
//     contact: vertices                # or elastic_foundation
//     divisions: 10                    # elements along each edge of a face, elastic_foundation only
//     horizon: 0.2                     # [s] after the first touch that is compared; 0: until rest
//     window: 0                        # [s] after which the simulation starts anew; 0: never
//     gravity: 9.81                    # [m/s2]
//     transition_velocity: 0.01        # [m/s] of the friction law
//     accuracy: 1e-8                   # of the integrator, per step
//     most_steps: 0                    # of the integrator in one simulation: one that needs more has failed;
//                                      # 0: 300 and 30 for each frame
#pragma once

#include "base/error.h"
#include "base/yaml_reader.h"
#include "problems/free_body/free_body.h"

namespace sinew {

struct FreeBodySettings {
  FreeBody body;
  Vec3 edges = Vec3::Constant(0.1);  ///< [m]
  double horizon = 0.2;              ///< [s]; 0: until rest
  double window = 0;                 ///< [s]; 0: a toss is one window
};

/// @param yaml the map under the key `free_body`. Errors: unknown keys, wrong values, each with file and
/// line.
Result<FreeBodySettings> ReadFreeBodySettings(const YamlReader& yaml);

}  // namespace sinew
